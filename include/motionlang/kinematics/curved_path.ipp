// SPDX-License-Identifier: MIT
// Bodies of curved_path.hpp.
#pragma once

#include <cmath>  // hypot

#include <motionlang/kinematics/curved_path.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/loops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double path_length(const Motion& motion) {
  double length = 0;
  for (Index f = 1; f < motion.frames(); ++f) {
    const Vec3<double> step = motion.root_at(f) - motion.root_at(f - 1);
    length += std::hypot(step.x, step.z);
  }
  return length;
}

MOTIONLANG_BODY Motion curved_path(const Motion& motion, double curvature) {
  Motion out = motion;
  double angle = 0;
  for (Index f = 0; f < motion.frames(); ++f) {
    if (f > 0) {
      const Vec3<double> step = motion.root_at(f) - motion.root_at(f - 1);
      angle += curvature * std::hypot(step.x, step.z);
      out.root[static_cast<std::size_t>(f)] = out.root_at(f - 1) + rotate(detail::turn(angle), step);
    }
    out.rotations(f)[0] = detail::turn(angle) * motion.rotations(f)[0];
  }
  return lock_feet(out, smpl_legs, {.speed = 1.2});  // m/s; the turn adds to the speed of a standing foot
}

MOTIONLANG_NAMESPACE_END
