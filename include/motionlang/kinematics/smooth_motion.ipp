// SPDX-License-Identifier: MIT
// Bodies of smooth_motion.hpp.
#pragma once

#include <algorithm>  // max, min
#include <array>      // moments
#include <cmath>      // exp

#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The weights c of x_{first} ... x_{last} (0 is the frame itself) in the value at 0 of the best parabola, with errors
/// weighted by exp(-k^2 / (2 sigma^2)). They sum to 1. A parabola is its own fit, so peaks stay sharp and ends stay in
/// place. With fewer than three values: the frame itself.
///     c_k = w_k (1 0 0) M^-1 (1, k, k^2)^T,   M_ab = sum_k w_k k^(a + b)
/// Source  Savitzky and Golay (1964); with Gaussian weights local regression, Cleveland (1979)
inline std::vector<double> parabola_weights(Index first, Index last, double sigma) {
  std::vector<double> c;
  std::array<double, 5> s{};
  for (Index k = first; k <= last; ++k) {
    const auto x = static_cast<double>(k);
    c.push_back(std::exp(-0.5 * x * x / (sigma * sigma)));
    double power = c.back();
    for (double& sum : s) sum += power, power *= x;
  }
  const std::array<double, 3> row{s[2] * s[4] - s[3] * s[3], s[2] * s[3] - s[1] * s[4], s[1] * s[3] - s[2] * s[2]};
  const double determinant = s[0] * row[0] + s[1] * row[1] + s[2] * row[2];
  for (Index k = first; k <= last; ++k) {
    const auto x = static_cast<double>(k);
    double& weight = c[static_cast<std::size_t>(k - first)];
    if (last - first < 2)
      weight = k == 0 ? 1 : 0;
    else
      weight *= (row[0] + row[1] * x + row[2] * x * x) / determinant;
  }
  return c;
}

}  // namespace detail

MOTIONLANG_BODY Motion smooth_motion(const Motion& motion, const SmoothOptions& options) {
  const double sigma = options.sigma * motion.fps;  // frames
  if (!(sigma >= 0) || !std::isfinite(sigma)) raise<config_error>(101, "smooth_motion: sigma ", options.sigma, " s");
  const auto radius = static_cast<Index>(std::min(4 * sigma + 0.5, static_cast<double>(motion.frames())));
  if (radius < 2) return motion;
  const auto inner = detail::parabola_weights(-radius, radius, sigma);
  Motion out = motion;
  for (Index f = 0; f < motion.frames(); ++f) {
    const Index first = std::max(-radius, -f), last = std::min(radius, motion.frames() - 1 - f);
    const auto c = last - first == 2 * radius ? inner : detail::parabola_weights(first, last, sigma);
    auto weight = [&](Index k) { return c[static_cast<std::size_t>(k - first)]; };
    Vec3<double> root{};
    for (Index k = first; k <= last; ++k) root = root + weight(k) * motion.root_at(f + k);
    out.root[static_cast<std::size_t>(f)] = root;
    const auto here = motion.rotations(f);
    for (std::size_t j = 0; j < here.size(); ++j) {
      const Quaternion<double> undo = inverse(here[j]);
      Vec3<double> turn{};
      for (Index k = first; k <= last; ++k) {
        if (k != 0) turn = turn + weight(k) * log_so3(undo * motion.rotations(f + k)[j]);
      }
      out.rotations(f)[j] = normalized(here[j] * to_quaternion(AxisAngle<double>{turn}));
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
