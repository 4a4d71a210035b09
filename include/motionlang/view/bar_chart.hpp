// SPDX-License-Identifier: MIT
/// Horizontal bars as a picture: shares that add up to one bar, or values beside each other.
#pragma once

#include <string>  // names
#include <vector>  // values

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A line of the picture, or several below each other if the chart is not stacked.
struct BarGroup {
  std::string name;
  std::vector<double> values;  // of each series; 0 or more
  double low = 0, high = 0;    // an interval on the axis, drawn as a line with ends; the same: none
};
struct BarChart {
  std::string title;
  std::vector<std::string> series;  // names of the values
  std::vector<BarGroup> groups;
  bool stacked = false;  // the values of a group continue each other
  double mark = -1;      // a dashed line at this value, below 0: none
};

/// The picture as SVG. Throws config_error 101 for a group with another number of values than there are series, and for
/// a value that is negative or not finite.
std::string bar_chart_svg(const BarChart& chart);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/bar_chart.ipp>
#endif
