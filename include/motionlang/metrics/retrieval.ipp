// SPDX-License-Identifier: MIT
// Bodies of retrieval.hpp.
#pragma once

#include <motionlang/core/numpy_random.hpp>
#include <motionlang/core/rounding.hpp>
#include <motionlang/metrics/retrieval.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY RetrievalMetrics retrieval_metrics(std::vector<double> ranks) {
  if (ranks.empty()) raise<numeric_error>(302, "retrieval_metrics: no queries");
  std::sort(ranks.begin(), ranks.end());
  RetrievalMetrics out;
  const std::size_t n = ranks.size();
  for (std::size_t k = 0; k < out.depths.size(); ++k) {
    const auto found = std::lower_bound(ranks.begin(), ranks.end(), out.depths[k]) - ranks.begin();
    out.recall[k] = 100 * static_cast<double>(found) / static_cast<double>(n);
  }
  out.median_rank = (ranks[(n - 1) / 2] + ranks[n / 2]) / 2 + 1;
  out.queries = static_cast<double>(n);
  return out;
}

MOTIONLANG_BODY std::vector<std::pair<std::string, double>> named(const RetrievalTable& table) {
  std::vector<std::pair<std::string, double>> out;
  for (const auto& [direction, m] : {std::pair{"t2m/", table.text_to_motion}, {"m2t/", table.motion_to_text}}) {
    for (std::size_t k = 0; k < m.depths.size(); ++k) {
      out.emplace_back(concat_text(direction, m.depths[k] < 10 ? "R0" : "R", m.depths[k]), m.recall[k]);
    }
    out.emplace_back(concat_text(direction, "MedR"), m.median_rank);
    out.emplace_back(concat_text(direction, "len"), m.queries);
  }
  return out;
}

namespace detail {

template <class F>
RetrievalTable with_each_number(RetrievalTable table, F change) {
  for (RetrievalMetrics* m : {&table.text_to_motion, &table.motion_to_text}) {
    for (double& r : m->recall) change(r);
    change(m->median_rank);
    change(m->queries);
  }
  return table;
}

MOTIONLANG_BODY RetrievalTable mean_table(std::span<const RetrievalTable> tables) {
  std::vector<double> sums;
  for (const RetrievalTable& t : tables) {
    std::size_t at = 0;
    with_each_number(t, [&](double& x) {
      if (at == sums.size()) sums.push_back(0);
      sums[at++] += x;
    });
  }
  std::size_t at = 0;
  return with_each_number({}, [&](double& x) { x = sums[at++] / static_cast<double>(tables.size()); });
}

}  // namespace detail

MOTIONLANG_BODY RetrievalTable rounded(const RetrievalTable& table, int places) {
  return detail::with_each_number(table, [&](double& x) { x = python_round(x, places); });
}

MOTIONLANG_BODY std::vector<std::vector<Index>> guo_batches(Index n, Index batch) {
  if (batch < 1) raise<config_error>(101, "guo_batches: batches of ", batch);
  NumpyRandom rng(0);
  const std::vector<Index> order = rng.permutation(n);
  std::vector<std::vector<Index>> out;
  for (auto at = order.begin(); order.end() - at >= batch; at += batch) out.emplace_back(at, at + batch);
  return out;
}

MOTIONLANG_BODY std::vector<FrameSlice> moment_windows(Index frames, Index width, Index stride) {
  if (width < 1 || stride < 1) raise<config_error>(101, "moment_windows: ", width, " frames, stride ", stride);
  std::vector<FrameSlice> out;
  for (Index middle = 0; middle < frames; middle += stride) {
    const Index start = middle - width / 2, first = std::max<Index>(0, start);
    out.push_back({first, std::min(frames, start + width) - first});
  }
  return out;
}

MOTIONLANG_BODY FrameSlice best_moment(std::span<const FrameSlice> windows, std::span<const double> similarities) {
  detail::require_same_count("best_moment: windows against similarities", std::ssize(windows),
                             std::ssize(similarities));
  if (windows.empty()) raise<numeric_error>(302, "best_moment: no windows");
  return windows[static_cast<std::size_t>(std::max_element(similarities.begin(), similarities.end()) -
                                          similarities.begin())];
}

MOTIONLANG_BODY double temporal_iou(const FrameSlice& a, const FrameSlice& b) {
  const Index common = std::min(a.first + a.length, b.first + b.length) - std::max(a.first, b.first);
  const Index both = std::max<Index>(0, common), either = a.length + b.length - both;
  return either > 0 ? static_cast<double>(both) / static_cast<double>(either) : 0;
}

MOTIONLANG_BODY double localisation_accuracy(std::span<const FrameSlice> found, std::span<const FrameSlice> wanted,
                                             double least_iou) {
  detail::require_same_count("localisation_accuracy: found against wanted", std::ssize(found), std::ssize(wanted));
  if (found.empty()) raise<numeric_error>(302, "localisation_accuracy: no queries");
  Index right = 0;
  for (std::size_t i = 0; i < found.size(); ++i) right += temporal_iou(found[i], wanted[i]) >= least_iou ? 1 : 0;
  return static_cast<double>(right) / static_cast<double>(found.size());
}

MOTIONLANG_NAMESPACE_END
