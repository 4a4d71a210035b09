// SPDX-License-Identifier: MIT
/// A figure in the pose of a frame: where its cones are, and the floor on which it stands.
#pragma once

#include <limits>  // heights

#include <motionlang/io/figure.hpp>
#include <motionlang/kinematics/motion.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

struct ConeEnds {
  Vec3<double> from, to;
};

inline ConeEnds cone_ends(const JointTransforms<double>& world, const RoundCone& c) {
  const auto j = static_cast<std::size_t>(c.joint);
  return {world.position[j] + world.rotation[j] * c.from, world.position[j] + world.rotation[j] * c.to};
}

/// Lowest and highest point of the body in all frames.
struct Heights {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
};
inline Heights heights(const Motion& motion, const Figure& figure) {
  Heights h;
  JointTransforms<double> world;
  for (Index frame = 0; frame < motion.frames(); ++frame) {
    motion.world(frame, world);
    for (const RoundCone& c : figure.cones) {
      const auto [from, to] = cone_ends(world, c);
      h.low = std::min({h.low, from.y - c.radius_from, to.y - c.radius_to});
      h.high = std::max({h.high, from.y + c.radius_from, to.y + c.radius_to});
    }
  }
  return h;
}

}  // namespace detail

}  // namespace motionlang::inline MOTIONLANG_ABI
