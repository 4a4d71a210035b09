// SPDX-License-Identifier: MIT
// Bodies of study_chart.hpp.
#pragma once

#include <numeric>  // accumulate

#include <motionlang/view/study_chart.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <class Counts>
std::vector<double> per_cent(const Counts& counts) {
  const double all = std::accumulate(counts.begin(), counts.end(), 0.0);
  std::vector<double> out;
  out.reserve(counts.size());
  for (const auto n : counts) out.push_back(all > 0 ? 100 * static_cast<double>(n) / all : 0);
  return out;
}

}  // namespace detail

MOTIONLANG_BODY BarChart study_chart(const Study& study, const StudyCounts& counts) {
  const auto name = [&](int system) { return study.systems[static_cast<std::size_t>(system)]; };
  BarChart out{.title = "", .series = {}, .groups = {}, .stacked = true};
  if (study.kind == StudyKind::pairs) {
    out.title = "preferred by the majority, % of the items";
    out.series = {"the first", "neither", "the second"};
    out.mark = 50;
    for (const PairCount& p : counts.pairs)
      out.groups.push_back({name(p.a) + " : " + name(p.b),
                            detail::per_cent(std::vector<std::size_t>{p.items_a, p.items_tied, p.items_b}),
                            100 * p.preferred.low, 100 * p.preferred.high});
  } else if (study.kind == StudyKind::ranking) {
    out.title = "ranks, % of the answers";
    for (std::size_t place = 1; place <= study.systems.size(); ++place)
      out.series.push_back(concat_text("rank ", place));
    for (const RankCount& r : counts.ranks) out.groups.push_back({name(r.system), detail::per_cent(r.places)});
  } else {
    out.title = "agreement from 1 to 5, % of the answers";
    out.series = {"1", "2", "3", "4", "5"};
    for (const RatingCount& r : counts.ratings) out.groups.push_back({name(r.system), detail::per_cent(r.ratings)});
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
