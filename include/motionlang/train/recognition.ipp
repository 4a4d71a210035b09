// SPDX-License-Identifier: MIT
// Bodies of recognition.hpp.
#pragma once

#include <numeric>  // accumulate

#include <motionlang/core/formatted.hpp>
#include <motionlang/metrics/summary.hpp>
#include <motionlang/train/recognition.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::pair<std::vector<Index>, Index> present_classes(std::span<const Index> classes, Index kinds) {
  std::vector<Index> numbered, number(static_cast<std::size_t>(kinds), -1);
  Index present = 0;
  for (const Index y : classes) {
    Index& n = number[static_cast<std::size_t>(y)];
    if (n < 0) n = present++;
    numbered.push_back(n);
  }
  return {numbered, present};
}

MOTIONLANG_BODY std::string recognition_cell(std::string_view name, std::span<const double> of_seeds) {
  const MeanInterval r = actor_summary(name, of_seeds);
  return formatted("%.2f +-%.2f", r.mean, r.half_width);
}

namespace detail {
inline double mean_of_seeds(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}
}  // namespace detail

MOTIONLANG_BODY std::string duration_table(std::span<const DurationResult> results) {
  const auto panel = [&](const char* title, auto value) {
    std::string out = concat_text("# ", title, "\nframes\tgenerated\n");
    for (const DurationResult& r : results) out += formatted("%td\t%.4g\n", r.frames, value(r));
    return out + "\n";
  };
  return panel("accuracy %", [](const DurationResult& r) { return 100 * detail::mean_of_seeds(r.accuracy); }) +
         panel("FID", [](const DurationResult& r) { return detail::mean_of_seeds(r.fid); });
}

MOTIONLANG_BODY std::string recognition_table(const std::map<std::string, std::vector<double>>& results) {
  std::string out =
      formatted("  %-25s %-12s %-12s %-12s %-12s\n", "", "accuracy %", "FID", "diversity", "multimodality");
  for (const auto& [name, what] : {std::pair{"gt", "recorded"},
                                   {"gt2", "recorded, other windows"},
                                   {"gen", "generated"},
                                   {"made", "of another program"},
                                   {"denoised", "denoised"},
                                   {"between", "between two of an action"}}) {
    if (name == std::string_view("made") && !results.contains("accuracy_made")) continue;
    out += formatted("  %-25s", what);
    for (const char* measure : {"accuracy_", "fid_", "diversity_", "multimodality_"}) {
      const auto found = results.find(std::string(measure) + name);
      out += formatted(" %-12s", found == results.end() ? "-" : recognition_cell(found->first, found->second).c_str());
    }
    out += "\n";
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
