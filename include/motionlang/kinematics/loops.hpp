// SPDX-License-Identifier: MIT
/// Cycles in a clip (steps, waving, breathing) and clips made longer by going round them.
#pragma once

#include <algorithm>  // min
#include <numbers>    // pi
#include <optional>   // clips without a cycle

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Frames first and last look alike, so that after `last - 1` the clip may go on at `first`.
struct Loop {
  Index first = 0, last = 0;
  double cost = 0;  // mean distance of joints, metres, velocities included
};

namespace detail {

/// Rotation about the vertical that a quaternion contains.
inline double heading(const Quaternion<double>& q) { return 2 * std::atan2(q.y, q.w); }
inline Quaternion<double> turn(double angle) { return from_axis_angle(Vec3<double>{0, 1, 0}, angle); }

/// Joint positions with the root's place and heading removed, (frames, joints).
inline std::vector<Vec3<double>> poses_in_place(const Motion& motion) {
  std::vector<Vec3<double>> out;
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); ++f) {
    motion.world(f, world);
    const auto back = turn(-heading(motion.rotations(f)[0]));
    const Vec3<double> place{motion.root_at(f).x, 0, motion.root_at(f).z};
    for (const auto& p : world.position) out.push_back(rotate(back, p - place));
  }
  return out;
}

}  // namespace detail

/// The best cycle of at least `least` frames, if its cost is below `most` metres.
///     cost(a, b) = mean over joints of |p_a - p_b| + 0.1 s |v_a - v_b|
/// Throws config_error 101 unless least >= 1.
inline std::optional<Loop> find_loop(const Motion& motion, Index least, double most = 0.08) {
  if (least < 1) raise<config_error>(101, "find_loop: a cycle of ", least, " frames");
  const auto poses = detail::poses_in_place(motion);
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  auto at = [&](Index frame, std::size_t joint) { return poses[static_cast<std::size_t>(frame) * joints + joint]; };
  std::optional<Loop> best;
  for (Index a = 0; a + least + 1 < motion.frames(); ++a) {
    for (Index b = a + least; b + 1 < motion.frames(); ++b) {
      double cost = 0;
      for (std::size_t j = 0; j < joints; ++j) {
        cost +=
            norm(at(a, j) - at(b, j)) + 0.1 * motion.fps * norm((at(a + 1, j) - at(a, j)) - (at(b + 1, j) - at(b, j)));
      }
      cost /= static_cast<double>(joints);
      if (cost < (best ? best->cost : most)) best = Loop{a, b, cost};
    }
  }
  return best;
}

/// The clip up to loop.last, then round the loop until there are `frames` frames. Each round goes on from where the
/// last one was, in its direction; what is left of the difference between the ends fades away over `blend` frames.
inline Motion go_round(const Motion& motion, const Loop& loop, Index frames, Index blend = 8) {
  if (loop.first < 0 || loop.last <= loop.first || loop.last >= motion.frames()) {
    raise<config_error>(101, "go_round: loop ", loop.first, " ... ", loop.last, " in ", motion.frames(), " frames");
  }
  Motion out{motion.skeleton, motion.fps, {}, {}, motion.name};
  Quaternion<double> turned = Quaternion<double>::identity();  // of the present round in the world
  Vec3<double> place{};
  std::vector<Quaternion<double>> difference(static_cast<std::size_t>(motion.skeleton.size()),
                                             Quaternion<double>::identity());
  double height = 0;
  Index since = blend;  // frames since the last seam
  for (Index from = 0; out.frames() < frames; ++from, ++since) {
    if (from == loop.last) {
      // The frame that is due (last, in the present round) and the one that comes instead (first).
      const auto due = motion.rotations(loop.last), comes = motion.rotations(loop.first);
      const Vec3<double> at = place + rotate(turned, motion.root_at(loop.last));
      const auto spin = detail::turn(detail::heading(due[0]) - detail::heading(comes[0]));
      turned = turned * spin;
      const Vec3<double> start = rotate(turned, motion.root_at(loop.first));
      place = {at.x - start.x, 0, at.z - start.z};
      height = motion.root_at(loop.last).y - motion.root_at(loop.first).y;
      for (std::size_t j = 0; j < difference.size(); ++j) difference[j] = due[j] * inverse(comes[j]);
      difference[0] = inverse(spin) * difference[0];
      from = loop.first;
      since = 0;
    }
    const double left =
        since >= blend
            ? 0
            : 0.5 * (1 + std::cos(std::numbers::pi * static_cast<double>(since) / static_cast<double>(blend)));
    Vec3<double> root = place + rotate(turned, motion.root_at(from));
    root.y = motion.root_at(from).y + left * height;
    out.root.push_back(root);
    const auto pose = motion.rotations(from);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      const auto faded = slerp(Quaternion<double>::identity(), difference[j], left) * pose[j];
      out.local.push_back(j == 0 ? turned * faded : faded);
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
