// SPDX-License-Identifier: MIT
// Bodies of figure_pose.hpp.
#pragma once

#include <algorithm>  // min, max
#include <cmath>      // abs

#include <motionlang/core/quantile.hpp>
#include <motionlang/formats/detail/figure_pose.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY Heights heights(const Motion& motion, const Figure& figure) {
  const auto require_near = [&](const Vec3<double>& p, int joint, Index frame) {
    const double most = std::numeric_limits<float>::max();
    if (!(std::abs(p.x) <= most && std::abs(p.y) <= most && std::abs(p.z) <= most))
      raise<numeric_error>(301, "Motion '", motion.name, "': joint '", motion.skeleton.name(joint), "' of frame ",
                           frame, " or one of its children is at (", p.x, ", ", p.y, ", ", p.z,
                           "), too far to be drawn");
  };
  Heights h;
  std::vector<double> lows;
  JointTransforms<double> world;
  for (Index frame = 0; frame < motion.frames(); ++frame) {
    motion.world(frame, world);
    for (int j = 0; j < motion.skeleton.size(); ++j)
      require_near(world.position[static_cast<std::size_t>(j)], j, frame);
    double low = std::numeric_limits<double>::max();
    for (const RoundCone& c : figure.cones) {
      const auto [from, to] = cone_ends(world, c);
      require_near(from, c.joint, frame), require_near(to, c.joint, frame);
      low = std::min({low, from.y - c.radius_from, to.y - c.radius_to});
      h.high = std::max({h.high, from.y + c.radius_from, to.y + c.radius_to});
    }
    lows.push_back(low);
  }
  if (lows.empty()) return h;
  const std::size_t quarter = lows.size() / 4;
  h.floor = nth_smallest(std::move(lows), quarter);
  return h;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
