// SPDX-License-Identifier: MIT
// Bodies of known_skeletons.hpp.
#pragma once

#include <motionlang/kinematics/known_skeletons.hpp>

MOTIONLANG_NAMESPACE_BEGIN

// clang-format off
MOTIONLANG_BODY const Skeleton& smpl24_skeleton() {
  static const Skeleton skeleton = Skeleton::from_joints({
      {"pelvis", "", {0, 0.95, 0}},
      {"left_hip", "pelvis", {0.09, -0.06, 0}},        {"right_hip", "pelvis", {-0.09, -0.06, 0}},
      {"spine1", "pelvis", {0, 0.11, 0}},
      {"left_knee", "left_hip", {0, -0.41, 0}},        {"right_knee", "right_hip", {0, -0.41, 0}},
      {"spine2", "spine1", {0, 0.13, 0}},
      {"left_ankle", "left_knee", {0, -0.41, 0}},      {"right_ankle", "right_knee", {0, -0.41, 0}},
      {"spine3", "spine2", {0, 0.06, 0}},
      {"left_foot", "left_ankle", {0, -0.06, 0.14}},   {"right_foot", "right_ankle", {0, -0.06, 0.14}},
      {"neck", "spine3", {0, 0.22, 0}},
      {"left_collar", "spine3", {0.07, 0.13, 0}},      {"right_collar", "spine3", {-0.07, 0.13, 0}},
      {"head", "neck", {0, 0.10, 0.02}},
      {"left_shoulder", "left_collar", {0.11, 0.03, 0}},  {"right_shoulder", "right_collar", {-0.11, 0.03, 0}},
      {"left_elbow", "left_shoulder", {0.27, 0, 0}},   {"right_elbow", "right_shoulder", {-0.27, 0, 0}},
      {"left_wrist", "left_elbow", {0.25, 0, 0}},      {"right_wrist", "right_elbow", {-0.25, 0, 0}},
      {"left_hand", "left_wrist", {0.08, 0, 0}},       {"right_hand", "right_wrist", {-0.08, 0, 0}},
  });
  return skeleton;
}

MOTIONLANG_BODY const Skeleton& humanml3d22_skeleton() {
  static const Skeleton skeleton = [] {
    Skeleton s = smpl24_skeleton();
    s.names.resize(22), s.parents.resize(22), s.offsets.resize(22);
    return s;
  }();
  return skeleton;
}

MOTIONLANG_BODY const Skeleton& kit21_skeleton() {
  static const Skeleton skeleton = Skeleton::from_joints({
      {"root", "", {0, 0.95, 0}},
      {"BP", "root", {0, 0.11, 0}},     {"BT", "BP", {0, 0.19, 0}},     {"BLN", "BT", {0, 0.22, 0}},      {"BUN", "BLN", {0, 0.10, 0}},
      {"LS", "BLN", {0.18, -0.06, 0}},  {"LE", "LS", {0.27, 0, 0}},     {"LW", "LE", {0.25, 0, 0}},
      {"RS", "BLN", {-0.18, -0.06, 0}}, {"RE", "RS", {-0.27, 0, 0}},    {"RW", "RE", {-0.25, 0, 0}},
      {"LH", "root", {0.09, -0.06, 0}}, {"LK", "LH", {0, -0.41, 0}},    {"LA", "LK", {0, -0.41, 0}},
      {"LMrot", "LA", {0, -0.06, 0.04}},{"LF", "LMrot", {0, 0, 0.10}},
      {"RH", "root", {-0.09, -0.06, 0}},{"RK", "RH", {0, -0.41, 0}},    {"RA", "RK", {0, -0.41, 0}},
      {"RMrot", "RA", {0, -0.06, 0.04}},{"RF", "RMrot", {0, 0, 0.10}},
  });
  return skeleton;
}
// clang-format on

MOTIONLANG_NAMESPACE_END
