// SPDX-License-Identifier: MIT
/// The counts of a perceptual study as bars: preferences, ranks or ratings.
///
///     write_file("study.svg", bar_chart_svg(study_chart(study, count_study(study, answers))));
///
/// Source  TEMOS, figure 3 (thesis 4.3); thesis figure 6.6; TM2T, figure 4
#pragma once

#include <motionlang/metrics/study_counts.hpp>
#include <motionlang/view/bar_chart.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Per cent. Pairs: a bar for each, with the items for the first system, ties, and those for the second. There is a
/// line at 50, and each bar has the interval of the preference. Rankings and ratings: a bar for each system, with the
/// share of each rank or rating.
BarChart study_chart(const Study& study, const StudyCounts& counts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/study_chart.ipp>
#endif
