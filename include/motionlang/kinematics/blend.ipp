// SPDX-License-Identifier: MIT
// Bodies of blend.hpp.
#pragma once

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Adds the mix of two frames to a clip: roots in a line, rotations on the shortest arc.
inline void add_mixed_frame(Motion& out, const Motion& a, Index in_a, const Motion& b, Index in_b, double share_of_b) {
  out.root.push_back((1 - share_of_b) * a.root_at(in_a) + share_of_b * b.root_at(in_b));
  const auto from = a.rotations(in_a), to = b.rotations(in_b);
  for (std::size_t j = 0; j < from.size(); ++j) out.local.push_back(slerp(from[j], to[j], share_of_b));
}

/// Share of the second clip in frame i of n blended frames.
inline double share_of_second(Index i, Index n) {
  return smoothstep(static_cast<double>(i + 1) / static_cast<double>(n + 1));
}

}  // namespace detail

MOTIONLANG_BODY Motion blend_into(const Motion& first, const Motion& second, Index frames) {
  detail::require_same_kind("blend_into", first, second);
  if (frames < 1 || frames > std::min(first.frames(), second.frames())) {
    raise<config_error>(101, "blend_into: ", frames, " frames of clips of ", first.frames(), " and ", second.frames());
  }
  const Index start = first.frames() - frames, middle = frames / 2;
  const Motion next = placed(second, placement_between(second, middle, first, start + middle));
  Motion out = crop(first, 0, start);
  for (Index i = 0; i < frames; ++i) {
    detail::add_mixed_frame(out, first, start + i, next, i, detail::share_of_second(i, frames));
  }
  return concatenate(out, crop(next, frames, next.frames()));
}

MOTIONLANG_BODY Motion without_jump(const Motion& motion, Index from, Index to) {
  const Index step = to < from ? -1 : 1, k = from - step, last = motion.frames() - 1;
  if (std::min(from, k) < 0 || std::max(from, k) > last || to < -1 || to > last + 1) {
    raise<config_error>(101, "without_jump: frames ", from, " to ", to, " of a clip of ", motion.frames());
  }
  const Index before = k - step < 0 || k - step > last ? k : k - step;
  const Vec3<double> way = 2 * motion.root_at(k) - motion.root_at(before) - motion.root_at(from);
  std::vector<Vec3<double>> turns;
  for (std::size_t j = 0; j < motion.rotations(k).size(); ++j) {
    const auto of = [&](Index frame) { return motion.rotations(frame)[j]; };
    turns.push_back(log_so3(inverse(of(from)) * of(k) * inverse(of(before)) * of(k)));
  }
  Motion out = motion;
  for (Index i = from; i != to; i += step) {
    const double w = 1 - smoothstep(static_cast<double>(i - from) / static_cast<double>(to - from));
    out.root[static_cast<std::size_t>(i)] = motion.root_at(i) + w * way;
    const auto q = out.rotations(i);
    for (std::size_t j = 0; j < q.size(); ++j) q[j] = normalized(q[j] * to_quaternion(AxisAngle<double>{w * turns[j]}));
  }
  return out;
}

MOTIONLANG_BODY LoopRound make_loop(const Motion& motion, Index frames) {
  if (frames < 1 || frames > motion.frames() / 2) {
    raise<config_error>(101, "make_loop: ", frames, " frames to blend in a clip of ", motion.frames(), " at ",
                        motion.fps, " per second: at most half of it");
  }
  const Index last = motion.frames() - frames, middle = frames / 2;
  const Motion end = placed(motion, placement_between(motion, last + middle, motion, middle));
  LoopRound loop{crop(motion, 0, 0), placement_between(motion, middle, motion, last + middle)};
  for (Index i = 0; i < frames; ++i) {
    detail::add_mixed_frame(loop.motion, end, last + i, motion, i, detail::share_of_second(i, frames));
  }
  loop.motion = concatenate(loop.motion, crop(motion, frames, last));
  return loop;
}

MOTIONLANG_NAMESPACE_END
