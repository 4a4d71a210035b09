// SPDX-License-Identifier: MIT
// Bodies of summary.hpp.
#pragma once

#include <cmath>    // sqrt
#include <numeric>  // accumulate
#include <vector>   // percent

#include <motionlang/core/rounding.hpp>
#include <motionlang/core/shape.hpp>
#include <motionlang/metrics/summary.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Mean, and variance divided by the number of values. Throws numeric_error 302 of no values.
inline MeanInterval mean_and_variance(const char* function, std::span<const double> values) {
  if (values.empty()) raise<numeric_error>(302, function, ": no values");
  const auto n = static_cast<double>(values.size());
  MeanInterval out{std::accumulate(values.begin(), values.end(), 0.0) / n, 0};
  for (const double v : values) out.half_width += (v - out.mean) * (v - out.mean) / n;
  return out;
}

}  // namespace detail

MOTIONLANG_BODY MeanInterval replication_interval(std::span<const double> values) {
  const auto [mean, variance] = detail::mean_and_variance("replication_interval", values);
  return {mean, 1.96 * std::sqrt(variance / static_cast<double>(values.size()))};
}

MOTIONLANG_BODY MeanInterval actor_summary(std::string_view metric, std::span<const double> values) {
  const bool percent = metric.find("accuracy") != metric.npos;
  std::vector<double> scaled(values.begin(), values.end());
  if (percent) {
    for (double& v : scaled) v *= 100;
  }
  const auto [mean, variance] = detail::mean_and_variance("actor_summary", scaled);
  return {numpy_round(mean, percent ? 1 : 2), numpy_round(1.96 * variance, 2)};
}

MOTIONLANG_NAMESPACE_END
