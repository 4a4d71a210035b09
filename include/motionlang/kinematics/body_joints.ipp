// SPDX-License-Identifier: MIT
// Bodies of body_joints.hpp.
#pragma once

#include <motionlang/kinematics/body_joints.hpp>
#include <motionlang/kinematics/skeleton_tables.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::optional<BodyJoints> find_body_joints(const Skeleton& skeleton) {
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
