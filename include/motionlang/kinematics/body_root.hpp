// SPDX-License-Identifier: MIT
/// The root of a body in a skeleton that has more than a body. Files put control bones, cameras and props above or
/// beside the hips. The hips walk, so they must be the root of a motion's skeleton.
#pragma once

#include <span>    // movements
#include <vector>  // joints

#include <motionlang/kinematics/skeleton_tables.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The lowest joint with all joints of the table at or below it: the pelvis, unless trunk and legs start at another
/// joint. -1 if the skeleton lacks one of them.
int body_root(const Skeleton& skeleton, const SkeletonTable& table);
/// The same for the built-in table that fits. 0, the root of the skeleton, if none fits.
int body_root(const Skeleton& skeleton);

/// The movement of a joint relative to the joint before it, in a whole file.
struct JointMovement {
  double way = 0;      // the extent of its positions, in the unit of the offsets
  bool turns = false;  // its rotation changes
};
/// The root of a body if names do not help. From the root down it follows the only child that moves, or the moving
/// child that has most of the joints below it. Below a moving joint, and beside joints that turn (as legs do beside a
/// spine), only a large movement counts: more than the length of its longest chain of bones. A bone that stretches is
/// not a root.
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
