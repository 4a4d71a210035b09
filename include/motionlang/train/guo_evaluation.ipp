// SPDX-License-Identifier: MIT
// Bodies of guo_evaluation.hpp.
#pragma once

#include <motionlang/core/formatted.hpp>
#include <motionlang/metrics/summary.hpp>
#include <motionlang/train/guo_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string guo_cell(const GuoFigures::Row& row, const char* column) {
  const auto found = row.find(column);
  if (found == row.end()) return "-";
  const MeanInterval r = replication_interval(found->second);
  return formatted("%.3f +-%.3f", r.mean, r.half_width);
}

MOTIONLANG_BODY void require_guo_figure_options(const GuoFigureOptions& options) {
  if (options.replications < 1)
    raise<config_error>(101, "`replications` is ", options.replications, ", and one is needed");
  if (options.repeats != 0 && options.repeats <= compared_repeats)
    raise<config_error>(101, "multimodality by ", options.repeats, " motions of a text: more than ", compared_repeats,
                        " are needed, or `repeats` 0");
}

}  // namespace detail

MOTIONLANG_BODY std::string guo_table(const GuoFigures& figures) {
  constexpr const char* columns[] = {"R@1", "R@2", "R@3", "FID", "MM-Dist", "diversity", "multimodality"};
  std::string out = formatted("  %-24s", "");
  for (const char* column : columns) out += formatted(" %-17s", column);
  for (const char* row : {"recorded", "recorded, of other texts", "generated"}) {
    out += formatted("\n  %-24s", row);
    for (const char* column : columns)
      out += formatted(" %-17s", detail::guo_cell(figures.values.at(row), column).c_str());
  }
  return out + "\n";
}

MOTIONLANG_NAMESPACE_END
