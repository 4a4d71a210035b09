// SPDX-License-Identifier: MIT
/// Common parts of plots: colours, numbers, letters, and round values for the marks of an axis.
#pragma once

#include <array>   // colours
#include <cmath>   // ceil, floor, log10
#include <cstdio>  // numbers as %.4g
#include <string>  // SVG
#include <vector>  // marks

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

namespace curves {

inline constexpr std::array<const char*, 8> colours{"#2676ba", "#d1495b", "#3a7d44", "#8a5aa8",
                                                    "#d98324", "#4b4e53", "#17a2a8", "#b0a12f"};

inline std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

inline std::string label(double x, double y, const std::string& text, const char* colour = "#555") {
  return concat_text("<text x='", x, "' y='", y, "' font-family='sans-serif' font-size='13' fill='", colour, "'>", text,
                     "</text>");
}

}  // namespace curves

/// From 4 to 11 multiples of 1, 2 or 5 times a power of ten between two values. There are fewer if doubles so large are
/// farther apart than the multiples.
inline std::vector<double> plot_ticks(double low, double high) {
  std::vector<double> out;
  const double size = high - low;
  if (!(size > 0 && std::isfinite(size))) return {low};
  double step = std::pow(10, std::floor(std::log10(size)));
  step *= size / step < 2 ? 0.2 : size / step < 5 ? 0.5 : 1;
  const double slack = 1e-9 * step;
  const double first = std::ceil((low - slack) / step);
  for (int i = 0; i <= 11; ++i) {
    const double t = (first + i) * step;
    if (t > high + slack) break;
    if (out.empty() || t > out.back()) out.push_back(t == 0 ? 0 : t);
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
