// SPDX-License-Identifier: MIT
/// Walks on the spot, as games have them, that become walks over the floor.
///
///     const Motion walk = off_treadmill(read_glb("hero.glb", {.animation = "Walking"}));
#pragma once

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TreadmillOptions {
  double floor = 0;
  double low = 0.04;      // m; a joint that is this near to the height at which it rests touches the floor
  double slowest = 0.25;  // m/s; a floor that slides less does not slide
  double spot = 0.15;     // m; a root that ends farther from where it began walks already
};

/// Metres per second at which the floor slides under the body. It is the mean velocity of the joint that is nearest to
/// the floor, over all frames in which one touches it. y is 0. So are x and z if nothing touches the floor.
/// Throws config_error 103 if the skeleton does not have the feet of SMPL.
Vec3<double> floor_speed(const Motion& motion, const TreadmillOptions& options = {});

/// The clip with a root that moves as fast as the floor slides, but the other way. A clip that goes somewhere, or whose
/// floor does not slide, stays as it is. Throws what floor_speed throws.
Motion off_treadmill(const Motion& motion, const TreadmillOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/treadmill.ipp>
#endif
