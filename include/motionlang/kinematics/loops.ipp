// SPDX-License-Identifier: MIT
// Bodies of loops.hpp.
#pragma once

#include <numbers>  // pi

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/loops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<Vec3<double>> poses_in_place(const Motion& motion) {
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

MOTIONLANG_BODY std::optional<Loop> find_loop(const Motion& motion, Index least, double most) {
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

MOTIONLANG_BODY Motion go_round(const Motion& motion, const Loop& loop, Index frames, Index blend) {
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
      // The frame that is due (last, in the present round) and the frame that replaces it (first).
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
