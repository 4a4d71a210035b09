// SPDX-License-Identifier: MIT
/// Blending clips: one into another, the end of a clip into its start, so that it can be repeated for ever, and frames
/// into those beside them.
///
///     Motion both = blend_into(walk, run, 10);      // half a second at 20 frames per second
///     Motion cycle = make_loop(in_place(walk), 8).motion;
///     Motion whole = without_jump(motion, 20, 30);  // frame 20 follows on frame 19, frame 30 is as it was
#pragma once

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/root_motion.hpp>

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

/// `second` after `first`, with `frames` frames in which both play and one gives way to the other. The second clip is
/// turned and moved over the floor so that in the middle of these frames both roots stand over one place and have one
/// heading; heights are only blended. The result has frames(first) + frames(second) - frames frames.
/// Throws config_error 102 if skeletons or frame rates differ, 101 unless 1 <= frames <= those of each clip.
inline Motion blend_into(const Motion& first, const Motion& second, Index frames) {
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

/// The clip without the jump into frame `from`: that frame goes where the ones before it lead, and what this moves it
/// by fades away until frame `to`, which is as it was. With to < from the same backwards in time: for the jump out of
/// frame `from`. k is the frame before `from`, k' the one before that (k, where the clip has none).
///     r'_i = r_i + w_i (2 r_k - r_k' - r_from),   q'_i = q_i exp(w_i log(q_from^-1 q_k q_k'^-1 q_k)),
///     w_i = 1 - smoothstep(|i - from| / |to - from|)
/// Source  "Inertialization", D. Bollo, GDC 2018; here with the weights of the other blends
/// Throws  config_error 101 unless `from` and k are frames, and -1 <= to <= frames
inline Motion without_jump(const Motion& motion, Index from, Index to) {
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

/// One round of a loop.
struct LoopRound {
  Motion motion;
  Placement next;  // moves the clip of one round to that of the next
};

/// The clip as one round of a loop: its last `frames` frames are blended into its first ones and then cut off, so that
/// after the last frame the first one, moved by `next`, is the natural following one. `next` turns and moves over the
/// floor only; it is what brings the middle of the first frames over the middle of the last. A walk so goes on from
/// round to round; make a clip in place first and `next` is at most a turn.
/// Throws config_error 101 unless 1 <= frames and 2 frames <= those of the clip.
inline LoopRound make_loop(const Motion& motion, Index frames) {
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
