// SPDX-License-Identifier: MIT
/// The hips, knees, feet, shoulders, elbows, wrists and the head of a known skeleton, from the tables of retargeting.
#pragma once

#include <optional>  // unknown skeletons

#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Numbers of joints; -1 if the skeleton lacks one.
struct BodyJoints {
  struct Pair {
    int left = -1, right = -1;
    bool known() const { return left >= 0 && right >= 0; }
  };
  int pelvis = -1, head = -1;
  Pair hip, knee, ankle, toe, shoulder, elbow, wrist;
};

/// Nothing for a skeleton that no table fits.
std::optional<BodyJoints> find_body_joints(const Skeleton& skeleton);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/body_joints.ipp>
#endif
