// SPDX-License-Identifier: MIT
/// Smooths curves over time.
#pragma once

#include <algorithm>  // clamp
#include <cmath>      // exp
#include <span>       // curves
#include <vector>     // kernel

#include <motionlang/core/concepts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// From 0 at 0 to 1 at 1, level at both ends: s^2 (3 - 2 s).
constexpr double smoothstep(double s) { return s * s * (3 - 2 * s); }

/// Gaussian filter along time.
///     y_t = sum_k w_k x_{t+k},   w_k ~ exp(-k^2 / (2 sigma^2)),   |k| <= floor(4 sigma + 1/2),   sum w = 1
/// Beyond the ends, the first and last frame are repeated. The sum is computed in double, as in scipy.
/// Source  scipy.ndimage.gaussian_filter1d, mode "nearest"; MotionDiffuse smooths joints with sigma 1
/// Shapes  values (frames, width) -> the same
/// Throws  config_error 101 (sigma), shape_error 205 (size)
template <Scalar S>
std::vector<S> gaussian_smooth(std::span<const S> values, Index width, double sigma) {
  if (!(sigma > 0) || !std::isfinite(sigma)) raise<config_error>(101, "gaussian_smooth: sigma ", sigma);
  if (width <= 0 || std::ssize(values) % width != 0) {
    raise<shape_error>(205, "gaussian_smooth: ", values.size(), " values are not rows of ", width);
  }
  if (values.empty()) return {};
  const auto radius = static_cast<Index>(4 * sigma + 0.5);  // NOLINT(bugprone-incorrect-roundings): as scipy does
  std::vector<double> kernel;
  double sum = 0;
  for (Index k = -radius; k <= radius; ++k) {
    kernel.push_back(std::exp(-0.5 * static_cast<double>(k * k) / (sigma * sigma)));
    sum += kernel.back();
  }
  for (double& w : kernel) w /= sum;
  const Index frames = std::ssize(values) / width, size = frames * width;
  std::vector<double> longer, sums(values.size());  // the values with repeated ends
  for (Index t = -radius; t < frames + radius; ++t) {
    const auto row = values.subspan(static_cast<std::size_t>(std::clamp<Index>(t, 0, frames - 1) * width));
    for (Index c = 0; c < width; ++c) longer.push_back(static_cast<double>(row[static_cast<std::size_t>(c)]));
  }
  for (Index k = 0; k <= radius; ++k) {  // the kernel is the same on both sides
    const double w = kernel[static_cast<std::size_t>(radius + k)] / (k == 0 ? 2 : 1);
    const double *before = longer.data() + (radius - k) * width, *after = longer.data() + (radius + k) * width;
    for (Index i = 0; i < size; ++i) sums[static_cast<std::size_t>(i)] += w * (before[i] + after[i]);
  }
  return std::vector<S>(sums.begin(), sums.end());
}

MOTIONLANG_NAMESPACE_END
