// SPDX-License-Identifier: MIT
// Bodies of treadmill.hpp.
#pragma once

#include <algorithm>  // max
#include <cmath>      // hypot
#include <optional>   // a step
#include <vector>     // heights

#include <motionlang/kinematics/floor_fix.hpp>
#include <motionlang/kinematics/treadmill.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Vec3<double> floor_speed(const Motion& motion, const TreadmillOptions& options) {
  detail::require_legs("floor_speed", motion.skeleton, smpl_legs);
  const FloorFixOptions rest;
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  std::vector<double> rests(joints, rest.body_rests);  // heights at which they touch the floor
  for (const Leg& leg : smpl_legs) {
    rests[static_cast<std::size_t>(leg.limb.end)] = rest.ankle_stands;
    rests[static_cast<std::size_t>(leg.toe)] = rest.toe_stands;
  }
  const auto positions = motion.positions();
  Vec3<double> sum{};
  double touching = 0;
  for (std::size_t now = 0; now + joints < positions.size(); now += joints) {
    double lowest = options.floor + options.low;
    std::optional<Vec3<double>> step;  // of the lowest joint
    for (std::size_t j = 0; j < joints; ++j) {
      const Vec3<double>&from = positions[now + j], &to = positions[now + joints + j];
      const double height = std::max(from.y, to.y) - rests[j];
      if (height < lowest) lowest = height, step = to - from;
    }
    if (step) sum = sum + *step, touching += 1;
  }
  if (touching == 0) return {};
  return {sum.x * motion.fps / touching, 0, sum.z * motion.fps / touching};
}

MOTIONLANG_BODY Motion off_treadmill(const Motion& motion, const TreadmillOptions& options) {
  const Vec3<double> speed = floor_speed(motion, options);
  if (motion.frames() == 0 || std::hypot(speed.x, speed.z) < options.slowest) return motion;
  const Vec3<double> way = motion.root.back() - motion.root.front();
  if (std::hypot(way.x, way.z) > options.spot) return motion;
  Motion out = motion;
  for (Index f = 0; f < out.frames(); ++f)
    out.root[static_cast<std::size_t>(f)] = out.root_at(f) - (static_cast<double>(f) / out.fps) * speed;
  return out;
}

MOTIONLANG_NAMESPACE_END
