// SPDX-License-Identifier: MIT
/// Where a body begins in a skeleton that has more than a body. Files put control bones, cameras and props above or
/// beside the hips; the hips walk, so that they must be the root of a motion's skeleton.
#pragma once

#include <vector>  // joints

#include <motionlang/kinematics/skeleton_tables.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The lowest joint with all those at or below it that the table needs: the pelvis, unless trunk and legs hang on
/// another joint. -1 if the skeleton lacks one of them.
int body_root(const Skeleton& skeleton, const SkeletonTable& table);
/// The same by the built-in table that fits; 0, the root of the skeleton, if none fits.
int body_root(const Skeleton& skeleton);

/// A joint and all joints below it, ascending.
std::vector<int> joints_from(const Skeleton& skeleton, int joint);
/// The skeleton of these joints. Its root keeps its place at rest: its offset is the joint's rest position.
Skeleton skeleton_from(const Skeleton& skeleton, int joint);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/body_root.ipp>
#endif
