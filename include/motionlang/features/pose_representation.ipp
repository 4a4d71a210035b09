// SPDX-License-Identifier: MIT
// Bodies of pose_representation.hpp.
#pragma once

#include <motionlang/features/pose_representation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY PoseRepresentation parse_pose_representation(std::string_view name) {
  for (std::size_t i = 0; i < pose_representation_names.size(); ++i) {
    if (name == pose_representation_names[i]) return static_cast<PoseRepresentation>(i);
  }
  raise<config_error>(103, "parse_pose_representation: '", name, "' is not rotvec, rotquat, rotmat or rot6d");
}

MOTIONLANG_BODY FeatureLayout actor_layout(std::span<const BodyPart> part_of_joint, const ActorFeatureOptions& options,
                                           const BodyPartition& body) {
  const Index joints = std::ssize(part_of_joint), numbers = motionlang::size(options.rotations);
  if (joints < 1) raise<config_error>(101, "actor_layout: no joints");
  return FeatureLayout::from_owner("actor", options.rows(joints) * numbers, body, [&](Index i) {
    const Index joint = i / numbers + (options.global ? 0 : 1);
    return joint < joints ? part_of_joint[static_cast<std::size_t>(joint)] : body.path();
  });
}

MOTIONLANG_NAMESPACE_END
