// SPDX-License-Identifier: MIT
/// Which joints of a known skeleton are the hips, knees, feet, shoulders, elbows, wrists and the head. The tables of
/// retargeting say so.
#pragma once

#include <optional>  // unknown skeletons

#include <motionlang/kinematics/skeleton_tables.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Numbers of joints; -1 where the skeleton has none.
struct BodyJoints {
  struct Pair {
    int left = -1, right = -1;
    bool known() const { return left >= 0 && right >= 0; }
  };
  int pelvis = -1, head = -1;
  Pair hip, knee, ankle, toe, shoulder, elbow, wrist;
};

/// Nothing for a skeleton that no table fits.
inline std::optional<BodyJoints> find_body_joints(const Skeleton& skeleton) {
  const SkeletonTable* table = find_skeleton_table(skeleton);
  if (table == nullptr) return std::nullopt;
  auto joint = [&](std::string_view smpl) {
    const MappedJoint* row = table->find(smpl);
    return row == nullptr ? -1 : find_joint(skeleton, row->source);
  };
  auto pair = [&](const std::string& smpl) { return BodyJoints::Pair{joint("left_" + smpl), joint("right_" + smpl)}; };
  return BodyJoints{joint("pelvis"), joint("head"),    pair("hip"),   pair("knee"), pair("ankle"),
                    pair("foot"),    pair("shoulder"), pair("elbow"), pair("wrist")};
}

MOTIONLANG_NAMESPACE_END
