// SPDX-License-Identifier: MIT
/// Removes jitter from a clip. It preserves slow movement, peaks and the ends of the clip.
#pragma once

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct SmoothOptions {
  /// Seconds. At 20 frames per second and 0.04 s, a movement of 2.5 Hz keeps 98 % of its size, one of 5 Hz 82 %, and
  /// one of 10 Hz 35 %. Heels and toes strike the floor at such rates, so more smoothing makes feet slide.
  double sigma = 0.04;
};

/// The clip with its root positions and local rotations smoothed along time by local parabolas. Rotations are averaged
/// in their own frames: as rotation vectors relative to the frame itself.
///    p'_f = sum_k c_k p_{f+k},   q'_f = q_f exp(sum_k c_k log(q_f^-1 q_{f+k})),   |k| <= floor(4 sigma fps + 1/2)
/// A frame with fewer than two neighbours on each side within reach does not change. Throws config_error 101 unless
/// sigma >= 0.
Motion smooth_motion(const Motion& motion, const SmoothOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/smooth_motion.ipp>
#endif
