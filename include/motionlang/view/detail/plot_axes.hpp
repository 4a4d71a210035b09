// SPDX-License-Identifier: MIT
/// Common parts of plots: colours, numbers, letters, and round values for the marks of an axis.
#pragma once

#include <array>   // colours
#include <cmath>   // floor, log10
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

/// From 4 to 10 multiples of 1, 2 or 5 times a power of ten between two values.
inline std::vector<double> plot_ticks(double low, double high) {
  std::vector<double> out;
  const double size = high - low;
  if (!(size > 0 && std::isfinite(size))) return {low};
  double step = std::pow(10, std::floor(std::log10(size)));
  step *= size / step < 2 ? 0.2 : size / step < 5 ? 0.5 : 1;
  const double slack = 1e-9 * step;
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; ++k) out.push_back(k == 0 ? 0 : k * step);
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
