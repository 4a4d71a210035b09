// SPDX-License-Identifier: MIT
/// The 1 euro filter: removes jitter from a stream of values, frame by frame and without looking ahead.
///
///     const Motion calm = one_euro_filter(motion);
///     OneEuroFilter height(60);                          // frames per second
///     for (const double y : heights) shown.push_back(height(y));
///
/// A low-pass filter whose cutoff frequency grows with speed: slow values lose jitter, fast ones lag little. With the
/// interval T between frames and smoothed values y:
///     y_i = a(f) x_i + (1 - a(f)) y_{i-1},   a(f) = 1 / (1 + 1 / (2 pi f T))
///     f = min_cutoff + beta |v_i|,   v_i = a(derivative_cutoff) (x_i - y_{i-1}) / T + (1 - ...) v_{i-1}
/// Rotations take the same step along the arc from the smoothed rotation to the new one, and their speed is that of
/// its angle. To remove jitter from a whole clip without any lag see smooth_motion.hpp.
/// Source   Casiez, Roussel, Vogel: "1 euro filter: a simple speed-based low-pass filter for noisy input in interactive
///          systems" (CHI 2012), equations and algorithm 1 there
/// Differs  the defaults of min_cutoff and beta are for motions in metres and radians; the paper tunes them by hand
#pragma once

#include <optional>  // before the first value

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct OneEuroOptions {
  double min_cutoff = 1.5;       // Hz, for what does not move: lower values remove more jitter
  double beta = 2;               // Hz per metre (or radian) and second: higher values lag less
  double derivative_cutoff = 1;  // Hz, of the speed
};

/// The filter of one stream of numbers.
class OneEuroFilter {
 public:
  /// Throws config_error 101 unless fps and both cutoffs are above 0, and beta is 0 or more.
  explicit OneEuroFilter(double fps, const OneEuroOptions& options = {});

  /// The next value, smoothed. The first one is returned as it is.
  double operator()(double x);

 private:
  OneEuroOptions options_;
  double fps_;
  std::optional<double> last_{};  // smoothed
  double speed_ = 0;              // smoothed, per second
};

/// The clip with the coordinates of its root and its local rotations filtered. Throws config_error 101 as
/// OneEuroFilter.
Motion one_euro_filter(const Motion& motion, const OneEuroOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/one_euro_filter.ipp>
#endif
