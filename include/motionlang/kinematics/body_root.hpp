// SPDX-License-Identifier: MIT
/// Where a body begins in a skeleton that has more than a body. Files put control bones, cameras and props above or
/// beside the hips; the hips walk, so that they must be the root of a motion's skeleton.
#pragma once

#include <span>    // movements
#include <vector>  // joints

#include <motionlang/kinematics/skeleton_tables.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The lowest joint with all those at or below it that the table needs: the pelvis, unless trunk and legs hang on
/// another joint. -1 if the skeleton lacks one of them.
int body_root(const Skeleton& skeleton, const SkeletonTable& table);
/// The same by the built-in table that fits; 0, the root of the skeleton, if none fits.
int body_root(const Skeleton& skeleton);

/// How a joint moves against the joint before it, in a whole file.
struct JointMovement {
  double way = 0;      // across which its position goes, in the unit of the offsets
  bool turns = false;  // whether its rotation changes
};
/// Where a body begins if names tell nothing: from the root down, the only child that moves, or the one that moves and
/// has most of the joints below it. Below a joint that moves itself, and beside joints that turn, as legs do beside a
/// spine, it has to move farther than its longest chain of bones is long: a bone that stretches is not a root.
/// movements  of each joint
int moving_root(const Skeleton& skeleton, std::span<const JointMovement> movements);

/// A joint and all joints below it, ascending.
std::vector<int> joints_from(const Skeleton& skeleton, int joint);
/// The skeleton of these joints. Its root keeps its place at rest: its offset is the joint's rest position.
Skeleton skeleton_from(const Skeleton& skeleton, int joint);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/body_root.ipp>
#endif
