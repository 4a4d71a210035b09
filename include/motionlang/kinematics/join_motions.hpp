// SPDX-License-Identifier: MIT
/// Joins motions: each is turned and moved over the floor to start where the one before it ends.
///
///     const Motion both = join_motions(read_motion("walk.bvh"), read_motion("sit.bvh"), 0.3);
#pragma once

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The second motion after the first, on its skeleton and at its rate (match_motion), blended into it (blend_into).
/// blend   seconds during which both play; at least one frame
/// Throws  option_error 101 for a motion shorter than the blend, and what match_motion throws
Motion join_motions(const Motion& first, Motion second, double blend);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/join_motions.ipp>
#endif
