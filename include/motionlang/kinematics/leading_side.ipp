// SPDX-License-Identifier: MIT
// Bodies of leading_side.hpp.
#pragma once

#include <algorithm>  // equal, max, min
#include <numbers>    // pi

#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/leading_side.hpp>
#include <motionlang/kinematics/loops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Left or right, where the left one of two values is larger or smaller by at least `least`.
inline Side larger_side(double left, double right, double least) {
  return left - right >= least ? Side::left : right - left >= least ? Side::right : Side::middle;
}

/// Radians to the left in all.
inline double whole_turn(const Motion& motion) {
  double sum = 0;
  for (Index f = 1; f < motion.frames(); ++f) {
    const double step = heading(motion.rotations(f)[0]) - heading(motion.rotations(f - 1)[0]);
    sum += std::remainder(step, 2 * std::numbers::pi);
  }
  return sum;
}

}  // namespace detail

MOTIONLANG_BODY Side leading_side(const Motion& motion, BodyParts parts) {
  const auto &names = motion.skeleton.names, &known = humanml3d22_skeleton().names;
  if (names.size() < known.size() || !std::equal(known.begin(), known.end(), names.begin()))
    raise<config_error>(103, "leading_side: '", motion.name, "' does not begin with SMPL's 22 joints");
  const double turned = detail::whole_turn(motion);
  if (std::abs(turned) > std::numbers::pi / 3) return turned > 0 ? Side::left : Side::right;

  struct LimbPath {
    double way = 0, height = 0, lowest = 1e9, highest = -1e9;
  };
  const auto poses = detail::poses_in_place(motion);
  const Index joints = motion.skeleton.size(), frames = motion.frames();
  const auto limb = [&](Index joint) {
    LimbPath out;
    for (Index f = 0; f < frames; ++f) {
      const auto& at = poses[static_cast<std::size_t>(f * joints + joint)];
      if (f > 0) out.way += norm(at - poses[static_cast<std::size_t>((f - 1) * joints + joint)]);
      out.height += at.y / static_cast<double>(frames);
      out.lowest = std::min(out.lowest, at.y), out.highest = std::max(out.highest, at.y);
    }
    return out;
  };
  if (parts.has(BodyPart::left_arm) || parts.has(BodyPart::right_arm)) {
    const LimbPath left = limb(20), right = limb(21);
    const double further = std::max(0.3, 0.5 * std::min(left.way, right.way));
    const Side moves = detail::larger_side(left.way, right.way, further);
    if (moves != Side::middle) return moves;
    const Side raised = detail::larger_side(left.height, right.height, 0.25);
    if (raised != Side::middle) return raised;
  }
  if (parts.has(BodyPart::legs)) {
    const LimbPath left = limb(7), right = limb(8);
    return detail::larger_side(left.highest - left.lowest, right.highest - right.lowest, 0.2);
  }
  return Side::middle;
}

MOTIONLANG_NAMESPACE_END
