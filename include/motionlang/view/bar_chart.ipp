// SPDX-License-Identifier: MIT
// Bodies of bar_chart.hpp.
#pragma once

#include <algorithm>  // max
#include <cmath>      // isfinite

#include <motionlang/core/error.hpp>
#include <motionlang/view/bar_chart.hpp>
#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/detail/plot_axes.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The end of the axis: the longest bar or interval.
inline double longest_bar(const BarChart& chart) {
  double out = std::max(chart.mark, 0.0);
  for (const BarGroup& g : chart.groups) {
    double sum = 0;
    if (g.values.size() != chart.series.size())
      raise<config_error>(101, "bar chart: '", g.name, "' has ", counted(g.values.size(), "value"), " for ",
                          chart.series.size(), " series");
    for (const double v : g.values) {
      if (!(v >= 0 && std::isfinite(v))) raise<config_error>(101, "bar chart: '", g.name, "' has the value ", v);
      sum += v;
      out = std::max(out, v);
    }
    if (chart.stacked) out = std::max(out, sum);
    if (g.high > g.low) out = std::max(out, g.high);
  }
  return out > 0 ? out : 1;
}

}  // namespace detail

MOTIONLANG_BODY std::string bar_chart_svg(const BarChart& chart) {
  using namespace detail;
  constexpr double width = 1000, left = 210, right = 40, top = 66, bar = 16, gap = 12;
  const double longest = longest_bar(chart), unit = (width - left - right) / longest;
  const auto bars = chart.stacked ? 1.0 : std::max(1.0, static_cast<double>(chart.series.size()));
  const double row = bars * bar + gap, end = top + row * static_cast<double>(chart.groups.size());
  std::string out = concat_text("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 ", fixed(width), " ",
                                fixed(end + 34), "'><rect width='100%' height='100%' fill='white'/>");
  out += curves::label(16, 24, escape_markup(chart.title), "#222");
  double legend = left;
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const char* colour = curves::colours[s % curves::colours.size()];
    out += concat_text("<rect x='", fixed(legend), "' y='36' width='12' height='12' fill='", colour, "'/>");
    out += curves::label(legend + 17, 47, escape_markup(chart.series[s]));
    legend += 40 + 7.5 * static_cast<double>(chart.series[s].size());
  }
  for (const double t : plot_ticks(0, longest)) {
    const double x = left + t * unit;
    out += concat_text("<path d='M", fixed(x), " ", fixed(top - 4), "V", fixed(end), "' stroke='#e2e6ea'/>");
    out += curves::label(x - 8, end + 18, curves::number(t));
  }
  for (std::size_t g = 0; g < chart.groups.size(); ++g) {
    const BarGroup& group = chart.groups[g];
    const double y = top + row * static_cast<double>(g);
    out += curves::label(16, y + bars * bar / 2 + 5, escape_markup(group.name));
    double x = left;
    for (std::size_t s = 0; s < group.values.size(); ++s) {
      const double at = chart.stacked ? y : y + bar * static_cast<double>(s);
      out += concat_text("<rect class='bar' x='", fixed(x, 2), "' y='", fixed(at), "' width='",
                         fixed(group.values[s] * unit, 2), "' height='", fixed(bar - 1), "' fill='",
                         curves::colours[s % curves::colours.size()], "'/>");
      if (chart.stacked) x += group.values[s] * unit;
    }
    if (group.high > group.low) {
      const double a = left + group.low * unit, b = left + group.high * unit, middle = y + bars * bar / 2;
      out += concat_text("<path class='interval' d='M", fixed(a), " ", fixed(middle - 5), "v10m0 -5H", fixed(b),
                         "m0 -5v10' fill='none' stroke='#222' stroke-width='1.5'/>");
    }
  }
  if (chart.mark >= 0)
    out += concat_text("<path d='M", fixed(left + chart.mark * unit), " ", fixed(top - 6), "V", fixed(end + 4),
                       "' stroke='#d1495b' stroke-width='1.5' stroke-dasharray='5 4'/>");
  return out + "</svg>\n";
}

MOTIONLANG_NAMESPACE_END
