// SPDX-License-Identifier: MIT
// Bodies of loss_curves.hpp.
#pragma once

#include <algorithm>  // max, min
#include <array>      // colours
#include <cmath>      // log10
#include <cstdio>     // numbers as %.4g
#include <limits>     // empty ranges

#include <motionlang/core/error.hpp>
#include <motionlang/view/loss_curves.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail::curves {

inline constexpr double width = 1000, height = 300, left = 70, right = 250, top = 34, bottom = 34;
inline constexpr std::array<const char*, 8> colours{"#2676ba", "#d1495b", "#3a7d44", "#8a5aa8",
                                                    "#d98324", "#4b4e53", "#17a2a8", "#b0a12f"};

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double x) {
    if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
  }
  double size() const { return std::max(high - low, 1e-12); }
};

inline std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

inline std::string label(double x, double y, const std::string& text, const char* colour = "#555") {
  return concat_text("<text x='", x, "' y='", y, "' font-family='sans-serif' font-size='13' fill='", colour, "'>", text,
                     "</text>");
}

inline std::string panel_svg(const CurvePanel& panel, double y0) {
  Range steps, values, positive;
  for (const Curve& c : panel.curves) {
    for (const double s : c.steps) steps.add(s);
    for (const double v : c.values) {
      values.add(v);
      if (v > 0) positive.add(v);
    }
  }
  if (!(values.low <= values.high)) return label(left, y0 + top, panel.title + ": no values yet");
  const bool logarithmic = values.low >= 0 && values.high > 10 * positive.low;
  if (logarithmic) values = positive;
  auto scaled = [&](double v) { return logarithmic ? std::log10(std::max(v, values.low)) : v; };
  Range shown;
  shown.add(scaled(values.low)), shown.add(scaled(values.high));
  std::string out = concat_text("<rect x='", left, "' y='", y0 + top, "' width='", width - left - right, "' height='",
                                height - top - bottom, "' fill='none' stroke='#ddd'/>");
  out += label(left, y0 + 22, panel.title + (logarithmic ? " (logarithmic)" : ""));
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& c = panel.curves[i];
    std::string points;
    for (std::size_t k = 0; k < c.values.size(); ++k) {
      if (!std::isfinite(c.values[k])) continue;
      points +=
          concat_text(left + (width - left - right) * (c.steps[k] - steps.low) / steps.size(), ",",
                      y0 + top + (height - top - bottom) * (shown.high - scaled(c.values[k])) / shown.size(), " ");
    }
    const char* colour = colours[i % colours.size()];
    out += concat_text("<polyline points='", points, "' fill='none' stroke='", colour, "' stroke-width='2'/>");
    const double line = y0 + top + 12 + 20 * static_cast<double>(i);
    out += label(width - right + 12, line, c.name + (c.values.empty() ? "" : " " + number(c.values.back())), colour);
  }
  out += label(4, y0 + top + 12, number(values.high)) + label(4, y0 + height - bottom, number(values.low));
  return out + label(left, y0 + height - 12, "step " + number(steps.low)) +
         label(width - right - 90, y0 + height - 12, "step " + number(steps.high));
}

}  // namespace detail::curves

MOTIONLANG_BODY Curve curve_of_steps(std::string name, std::span<const float> values, std::size_t before) {
  Curve out{std::move(name), {}, {}};
  const std::size_t groups = std::min<std::size_t>(200, values.size());
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t a = values.size() * g / groups, b = values.size() * (g + 1) / groups;
    double total = 0;
    for (std::size_t i = a; i < b; ++i) total += static_cast<double>(values[i]);
    out.steps.push_back(static_cast<double>(2 * before + a + b + 1) / 2);
    out.values.push_back(total / static_cast<double>(b - a));
  }
  return out;
}

MOTIONLANG_BODY std::string curves_svg(std::span<const CurvePanel> panels) {
  using namespace detail::curves;
  std::string out =
      concat_text("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 ", width, " ",
                  height * static_cast<double>(panels.size()), "'><rect width='100%' height='100%' fill='white'/>");
  for (std::size_t i = 0; i < panels.size(); ++i) out += panel_svg(panels[i], height * static_cast<double>(i));
  return out + "</svg>\n";
}

MOTIONLANG_NAMESPACE_END
