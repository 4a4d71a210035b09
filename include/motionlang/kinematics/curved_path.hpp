// SPDX-License-Identifier: MIT
/// Bends the path of a clip. Y up, metres.
///
///     Motion circle = curved_path(walk, 1 / 1.5);   // to the left, on a circle of 1.5 m
#pragma once

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The clip, turned by `curvature` radians for every metre of its path over the floor: to the left if it is above 0.
/// Standing feet stay where they are. Throws config_error 103 if the skeleton lacks SMPL's legs.
Motion curved_path(const Motion& motion, double curvature);

/// The length of the path of the root over the floor, in metres.
double path_length(const Motion& motion);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/curved_path.ipp>
#endif
