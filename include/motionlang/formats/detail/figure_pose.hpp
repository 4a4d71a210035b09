// SPDX-License-Identifier: MIT
/// A figure in the pose of a frame: the places of its cones, and the floor.
#pragma once

#include <limits>  // heights

#include <motionlang/formats/figure.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

struct ConeEnds {
  Vec3<double> from, to;
};

inline ConeEnds cone_ends(const JointTransforms<double>& world, const RoundCone& c) {
  const auto j = static_cast<std::size_t>(c.joint);
  return {world.position[j] + world.rotation[j] * c.from, world.position[j] + world.rotation[j] * c.to};
}

/// The floor under a body, and its highest point in all frames. The floor is the height of the lowest point in most
/// frames (the lower quartile). The minimum would be too low, because the tip of a foot that pushes off dips for a
/// moment.
struct Heights {
  double floor = 0, high = std::numeric_limits<double>::lowest();
};
/// Throws numeric_error 301 for a place that does not fit into single precision, which pages use.
Heights heights(const Motion& motion, const Figure& figure);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/detail/figure_pose.ipp>
#endif
