// SPDX-License-Identifier: MIT
/// The match of motions and texts in the space of a matching network: R-precision and matching score ("multimodal
/// distance", MM-Dist) of Guo et al.
///
///     MatchingMetric metric;
///     for (const auto& [texts, motions] : batches) metric.add(texts, motions);  // rows of one batch of 32, paired
///     use(metric.r_precision(3), metric.matching_score());
///
/// For each query, the answers of the batch are sorted by distance. The right one is a hit at k if it is among the
/// first k. Hits and distances of the right ones are summed over batches and divided by the number of queries.
/// Source  Guo et al. (CVPR 2022), section 5.2; references: text-to-motion final_evaluations.py, TM2T
///         final_evaluations_m2t.py, utils/metrics.py; TM2T (ECCV 2022), appendix C
/// Differs from the paper: the 31 distractors are the rest of a shuffled batch, and may have the same caption. In
/// motion-to-text, TM2T's code ranks texts for each motion, while its paper ranks motions for each text. Here the first
/// argument has the queries
#pragma once

#include <array>    // depths
#include <cmath>    // isnan
#include <numeric>  // iota

#include <motionlang/metrics/rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// For each row of a table the columns in ascending order; equal ones keep their order. Throws nothing.
inline std::vector<Index> nearest_first(const Rows<double>& table) {
  std::vector<Index> out;
  for (Index i = 0; i < table.size(); ++i) {
    const auto row = table[i];
    std::vector<Index> order(row.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
      return row[static_cast<std::size_t>(a)] < row[static_cast<std::size_t>(b)];
    });
    out.insert(out.end(), order.begin(), order.end());
  }
  return out;
}

class MatchingMetric {
 public:
  static constexpr int depths = 3;

  /// Adds a batch; row i of both belongs together. Throws shape_error 204, and numeric_error 301 for NaN, because no
  /// distance is smaller than NaN.
  template <Scalar S, Scalar T>
  void add(const Rows<S>& queries, const Rows<T>& answers) {
    detail::require_same_count("MatchingMetric: queries against answers", queries.size(), answers.size());
    const Index n = queries.size();
    const auto table = distances(queries, answers);
    for (const double d : table) {
      if (std::isnan(d)) raise<numeric_error>(301, "MatchingMetric: a distance is NaN");
    }
    for (Index i = 0; i < n; ++i) {
      const auto row = std::span(table).subspan(static_cast<std::size_t>(i * n), static_cast<std::size_t>(n));
      const double own = row[static_cast<std::size_t>(i)];
      Index rank = 0;  // of equal ones the first comes first
      for (Index j = 0; j < n; ++j) {
        const double d = row[static_cast<std::size_t>(j)];
        rank += d < own || (d == own && j < i) ? 1 : 0;
      }
      for (Index k = rank; k < depths; ++k) ++hits_[static_cast<std::size_t>(k)];
      distance_ += own;
    }
    queries_ += n;
  }

  Index queries() const { return queries_; }
  /// The number of queries whose right answer is among the first k. Throws config_error 101 unless 1 <= k <= 3.
  Index hits(int k) const {
    if (k < 1 || k > depths) raise<config_error>(101, "MatchingMetric: precision at ", k);
    return hits_[static_cast<std::size_t>(k - 1)];
  }
  /// The share of those, 0 to 1. Throws config_error 101, and numeric_error 302 without queries
  double r_precision(int k) const { return static_cast<double>(hits(k)) / count(); }
  /// Mean distance of the right answers. Throws numeric_error 302 without queries
  double matching_score() const { return distance_ / count(); }

 private:
  double count() const {
    if (queries_ == 0) raise<numeric_error>(302, "MatchingMetric: no queries");
    return static_cast<double>(queries_);
  }

  std::array<Index, depths> hits_{};
  double distance_ = 0;
  Index queries_ = 0;
};

MOTIONLANG_NAMESPACE_END
