// SPDX-License-Identifier: MIT
/// From a motion on any joints to the rows of named features.
///
///     const auto rows = rows_of_motion(motion_features("guoh3d"), read_motion("dance.bvh"), 20);
#pragma once

#include <motionlang/features/motion_features.hpp>
#include <motionlang/kinematics/on_smpl.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if a motion has exactly the joints of these features, SMPL's or MMM's: rows are then made of it as it is.
bool has_joints_of(const MotionFeatures& features, const Motion& motion);
/// True if a motion has the joints of any of the known features, in their order: a reader of a joint array, which has
/// no names, takes it for what it is.
bool has_joints_of_arrays(const Motion& motion);
/// The motion as it is if it has the joints of these features, otherwise on SMPL's. Throws what on_smpl throws.
Motion on_joints_of(const MotionFeatures& features, const Motion& motion);

/// The rows of a motion on any joints, (frames, features.width), not normalised.
/// fps     frames per second of the rows, above 0
/// Throws  what on_smpl, resample and MotionFeatures::from_motion throw
std::vector<double> rows_of_motion(const MotionFeatures& features, const Motion& motion, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/feature_rows.ipp>
#endif
