// SPDX-License-Identifier: MIT
// Bodies of statistics.hpp.
#pragma once

#include <numeric>  // accumulate

#include <motionlang/features/statistics.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<double> FeatureStatistics::deviation(Index least) const {
  if (count_ < least) raise<numeric_error>(302, "FeatureStatistics: a deviation of ", count_, " frames");
  std::vector<double> out;
  for (double s : squares_) out.push_back(std::sqrt(s / static_cast<double>(count_ + 1 - least)));
  return out;
}

MOTIONLANG_BODY std::vector<double> group_means(std::vector<double> values, std::span<const IndexRange> groups) {
  for (const IndexRange& g : groups) {
    if (g.begin < 0 || g.size() <= 0 || g.end > std::ssize(values)) {
      raise<shape_error>(203, "group_means: the group ", g.begin, ":", g.end, " of ", values.size(), " values");
    }
    const auto first = values.begin() + g.begin, last = values.begin() + g.end;
    std::fill(first, last, std::accumulate(first, last, 0.0) / static_cast<double>(g.size()));
  }
  return values;
}

MOTIONLANG_NAMESPACE_END
