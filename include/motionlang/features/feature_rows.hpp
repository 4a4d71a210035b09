// SPDX-License-Identifier: MIT
/// From a motion on any joints to the rows of named features.
///
///     const auto rows = rows_of_motion(motion_features("guoh3d"), read_motion("dance.bvh"), 20);
#pragma once

#include <motionlang/features/motion_features.hpp>
#include <motionlang/kinematics/on_smpl.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if a motion has exactly the joints of these features, SMPL's or MMM's. Its rows then need no retargeting.
bool has_joints_of(const MotionFeatures& features, const Motion& motion);
/// True if a motion has the joints of any known features, in their order. A joint array has no names, so its reader
/// recognises it by its joints.
bool has_joints_of_arrays(const Motion& motion);
/// The motion itself if it has the joints of these features, otherwise the motion on SMPL's. Throws what on_smpl
/// throws.
Motion on_joints_of(const MotionFeatures& features, const Motion& motion);

/// The rows of a motion on any joints, (frames, features.width), not normalised.
/// fps     frames per second of the rows, above 0
/// Throws  what on_smpl, resample and MotionFeatures::from_motion throw
std::vector<double> rows_of_motion(const MotionFeatures& features, const Motion& motion, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/feature_rows.ipp>
#endif
