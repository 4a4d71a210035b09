// SPDX-License-Identifier: MIT
/// One figure with its spread out of repeated evaluations, as the tables of ACTOR and of Guo et al. print them.
#pragma once

#include <cmath>        // sqrt
#include <numeric>      // accumulate
#include <span>         // values
#include <string_view>  // names
#include <vector>       // percent

#include <motionlang/core/rounding.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// mean +- half_width
struct MeanInterval {
  double mean = 0, half_width = 0;
};

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

/// mean +- 1.96 std / sqrt(n), the std of the population: Guo et al., over 20 replications.
/// Source  text-to-motion final_evaluations.py get_metric_statistics; spec evaluation-guo.md 4. Throws numeric_error
///         302.
inline MeanInterval replication_interval(std::span<const double> values) {
  const auto [mean, variance] = detail::mean_and_variance("replication_interval", values);
  return {mean, 1.96 * std::sqrt(variance / static_cast<double>(values.size()))};
}

/// mean +- 1.96 variance, rounded: to 2 places, the mean of an accuracy, in percent, to 1. The name tells which:
/// whether it contains "accuracy", as in ACTOR's files of results ("accuracy_gen", "fid_gt2").
/// Source  ACTOR src/evaluate/tables/easy_table.py; spec actor.md 7.1. Throws numeric_error 302.
/// Differs from the paper: it speaks of a 95 % confidence interval, which would need std / sqrt(n) in place of the
/// variance
inline MeanInterval actor_summary(std::string_view metric, std::span<const double> values) {
  const bool percent = metric.find("accuracy") != metric.npos;
  std::vector<double> scaled(values.begin(), values.end());
  if (percent) {
    for (double& v : scaled) v *= 100;
  }
  const auto [mean, variance] = detail::mean_and_variance("actor_summary", scaled);
  return {numpy_round(mean, percent ? 1 : 2), numpy_round(1.96 * variance, 2)};
}

MOTIONLANG_NAMESPACE_END
