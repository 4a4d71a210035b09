// SPDX-License-Identifier: MIT
/// Blends clips: one into another, the end of a clip into its start, so that it can be repeated for ever, and frames
/// into their neighbours.
///
///     Motion both = blend_into(walk, run, 10);      // half a second at 20 frames per second
///     Motion cycle = make_loop(in_place(walk), 8).motion;
///    Motion whole = without_jump(motion, 20, 30);  // frame 20 continues frame 19, frame 30 is unchanged
#pragma once

#include <motionlang/kinematics/root_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// `second` after `first`. The first clip blends into the second over `frames` frames. The second clip is turned and
/// moved over the floor until both roots have the same place and heading in the middle of these frames. Heights are
/// only blended. The result has frames(first) + frames(second) - frames frames. Throws config_error 102 if skeletons or
/// frame rates differ, and 101 unless 1 <= frames <= those of each clip.
Motion blend_into(const Motion& first, const Motion& second, Index frames);

/// The clip without the jump into frame `from`. That frame moves to where the frames before it lead, and the correction
/// fades away until frame `to`, which is unchanged. With to < from it works backwards in time, for the jump out of
/// frame `from`. k is the frame before `from`, and k' the one before that (k if there is none).
///     r'_i = r_i + w_i (2 r_k - r_k' - r_from),   q'_i = q_i exp(w_i log(q_from^-1 q_k q_k'^-1 q_k)),
///     w_i = 1 - smoothstep(|i - from| / |to - from|)
/// Source  "Inertialization", D. Bollo, GDC 2018; here with the weights of the other blends
/// Throws  config_error 101 unless `from` and k are frames, and -1 <= to <= frames
Motion without_jump(const Motion& motion, Index from, Index to);

/// One round of a loop.
struct LoopRound {
  Motion motion;
  Placement next;  // moves the clip of one round to the next round
};

/// The clip as one round of a loop. Its last `frames` frames are blended into its first ones and then cut off. So after
/// the last frame, the first one, moved by `next`, continues the motion. `next` only turns and moves over the floor: it
/// brings the middle of the first frames over the middle of the last. A walk goes on from round to round. For a clip in
/// place, `next` is at most a turn. Throws config_error 101 unless 1 <= frames and 2 frames <= those of the clip.
LoopRound make_loop(const Motion& motion, Index frames);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/blend.ipp>
#endif
