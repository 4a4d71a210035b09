// SPDX-License-Identifier: MIT
/// One figure and its spread from repeated evaluations, as printed in the tables of ACTOR and of Guo et al.
#pragma once

#include <span>         // values
#include <string_view>  // names

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// mean +- half_width
struct MeanInterval {
  double mean = 0, half_width = 0;
};

/// mean +- 1.96 std / sqrt(n), the std of the population: Guo et al., over 20 replications.
/// Source  text-to-motion final_evaluations.py get_metric_statistics. Throws numeric_error 302.
MeanInterval replication_interval(std::span<const double> values);

/// mean +- 1.96 variance, rounded to 2 places. The mean of an accuracy, in percent, is rounded to 1 place. A metric is
/// an accuracy if its name contains "accuracy", as in ACTOR's files of results ("accuracy_gen", "fid_gt2").
/// Source  thesis 3.3.1; ACTOR src/evaluate/tables/easy_table.py format_values. Throws numeric_error 302.
/// Differs from the paper, which speaks of a 95 % confidence interval; that would need std / sqrt(n) instead of the
/// variance
MeanInterval actor_summary(std::string_view metric, std::span<const double> values);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/summary.ipp>
#endif
