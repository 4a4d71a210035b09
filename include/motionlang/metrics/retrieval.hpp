// SPDX-License-Identifier: MIT
/// Text-to-motion and motion-to-text retrieval: ranks, recall, median rank, and TMR's four protocols.
///
///     const auto m = retrieve(RetrievalProtocol::normal, texts, motions, {});        // Rows of latents, paired
///     for (const auto& [name, value] : named(m)) std::printf("%s %.2f\n", name.c_str(), value);   // t2m/R01 ...
///
/// The rank of a query is the number of answers that are closer than the right one. Answers at exactly the same
/// distance share their ranks: each gets the mean.
///     R@k  = 100 |{i : r_i < k}| / n   [percent],      MedR = median(r) + 1
/// Source  TMR (Petrovich, Black, Varol, ICCV 2023), section 4.1; thesis 5.3.1; reference: Mathux/TMR
///         src/model/metrics.py and retrieval.py
/// Differs from the paper, which does not say that ties share their ranks. This matters if captions are repeated: two
/// equal best answers have rank 1/2 each, and both count for R@1
#pragma once

#include <algorithm>  // sort, lower_bound
#include <array>      // depths
#include <cstdint>    // flags
#include <limits>     // infinity
#include <numeric>    // iota
#include <string>     // ids
#include <utility>    // names with values

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/metrics/rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The direction of a search. Tables have texts as rows and motions as columns.
enum class RetrievalDirection { text_to_motion, motion_to_text };

/// Pairs of texts with the same meaning, (n, n), 1 = yes:  i = j, or e_i . e_j > 2 threshold - 1.
/// sentences  (n, d) unit rows
/// threshold  from 0 to 1, like scores; TMR uses 0.95
template <Scalar S>
std::vector<std::uint8_t> texts_alike(const Rows<S>& sentences, double threshold) {
  const Index n = sentences.size();
  std::vector<std::uint8_t> out(static_cast<std::size_t>(n * n));
  detail::each_dot_product(sentences, sentences, [&](Index i, Index j, double product) {
    out[static_cast<std::size_t>(i * n + j)] = i == j || product > 2 * threshold - 1 ? 1 : 0;
  });
  return out;
}

/// The rank of every query, from 0 on.
/// similarities  (n, n), texts by motions; pair i belongs together
/// alike         from `texts_alike`: the closest of the answers with such a text counts as the right one. Empty: only
///               the own one
/// Throws        shape_error 205, 204; numeric_error 301 for a NaN
template <Scalar S>
std::vector<double> retrieval_ranks(const Rows<S>& similarities, RetrievalDirection direction,
                                    std::span<const std::uint8_t> alike = {}) {
  detail::require_square("retrieval_ranks", similarities);
  const Index n = similarities.size();
  if (!alike.empty()) detail::require_same_count("retrieval_ranks: pairs of texts", std::ssize(alike), n * n);
  const bool by_text = direction == RetrievalDirection::text_to_motion;
  auto at = [&](Index query, Index answer) {
    const Index place = by_text ? query * n + answer : answer * n + query;
    return similarities.values()[static_cast<std::size_t>(place)];
  };
  std::vector<S> right;
  for (Index i = 0; i < n; ++i) {
    right.push_back(at(i, i));
    for (Index j = 0; j < n && !alike.empty(); ++j) {
      if (alike[static_cast<std::size_t>(i * n + j)] != 0) right.back() = std::max(right.back(), at(i, j));
    }
  }
  std::vector<Index> closer(right.size(), 0), equal(right.size(), 0), farther(right.size(), 0);
  for (Index row = 0; row < n; ++row) {  // in the order of the table, for both directions
    for (Index column = 0; column < n; ++column) {
      const auto query = static_cast<std::size_t>(by_text ? row : column);
      const S s = similarities[row][static_cast<std::size_t>(column)];
      closer[query] += s > right[query] ? 1 : 0;
      equal[query] += s == right[query] ? 1 : 0;
      farther[query] += s < right[query] ? 1 : 0;
    }
  }
  std::vector<double> ranks;
  for (std::size_t i = 0; i < right.size(); ++i) {
    if (closer[i] + equal[i] + farther[i] != n)
      raise<numeric_error>(301, "retrieval_ranks: a similarity of query ", i, " is NaN");
    ranks.push_back(static_cast<double>(closer[i]) + static_cast<double>(equal[i] - 1) / 2);
  }
  return ranks;
}

struct RetrievalMetrics {
  static constexpr std::array<int, 5> depths{1, 2, 3, 5, 10};
  std::array<double, 5> recall{};  // percent, at each depth
  double median_rank = 0;          // the best is 1
  double queries = 0;
};
/// The metrics of all queries. Throws numeric_error 302 without queries.
RetrievalMetrics retrieval_metrics(std::vector<double> ranks);

/// Both directions.
struct RetrievalTable {
  RetrievalMetrics text_to_motion, motion_to_text;
};
template <Scalar S>
RetrievalTable retrieval_table(const Rows<S>& similarities, std::span<const std::uint8_t> alike = {}) {
  using enum RetrievalDirection;
  return {retrieval_metrics(retrieval_ranks(similarities, text_to_motion, alike)),
          retrieval_metrics(retrieval_ranks(similarities, motion_to_text, alike))};
}

/// "t2m/R01", "t2m/R02", "t2m/R03", "t2m/R05", "t2m/R10", "t2m/MedR", "t2m/len", then the same for "m2t": the keys of
/// TMR's files.
std::vector<std::pair<std::string, double>> named(const RetrievalTable& table);

namespace detail {

/// Plain mean over tables.
RetrievalTable mean_table(std::span<const RetrievalTable> tables);

}  // namespace detail

/// As TMR prints them: two decimal places.
RetrievalTable rounded(const RetrievalTable& table, int places = 2);

/// The batches of protocol `guo`: positions 0 ... n-1 of the sorted ids, shuffled by NumPy with seed 0, in groups. The
/// last incomplete group is dropped. Throws config_error 101 for a batch below 1.
std::vector<std::vector<Index>> guo_batches(Index n, Index batch = 32);

/// normal     all pairs
/// threshold  all pairs; answers whose text has the same meaning are right, too
/// nsim       the pairs of a list of ids, chosen to be dissimilar
/// guo        the mean over batches of 32: the protocol of Guo et al. (CVPR 2022)
enum class RetrievalProtocol { normal, threshold, nsim, guo };

struct RetrievalOptions {
  double threshold = 0.95;
  Index batch = 32;
  std::vector<std::string> ids{};       // of the pairs, for nsim and guo
  std::vector<std::string> nsim_ids{};  // those without a pair are skipped, as published
  bool euclidean = false;               // the closest is the nearest, as for Guo's evaluator, not the most parallel
};

/// texts, motions  (n, latent); pair i belongs together
/// sentences       (n, d) unit rows, for `threshold`: their similarity decides which texts have the same meaning
/// Throws          shape_error 204 if counts differ, numeric_error 302 if nothing is left, config_error 101, 103 (a
///                 duplicate id)
template <Scalar S, Scalar E>
RetrievalTable retrieve(RetrievalProtocol protocol, const Rows<S>& texts, const Rows<S>& motions,
                        const Rows<E>& sentences, const RetrievalOptions& options = {}) {
  const Index n = texts.size();
  detail::require_same_count("retrieve: texts against motions", n, motions.size());
  auto table_of = [&](const Rows<S>& x, const Rows<S>& y, std::span<const std::uint8_t> alike = {}) {
    if (x.size() == 0) raise<numeric_error>(302, "retrieve: no pairs");
    if (options.euclidean) {
      auto nearness = distances(x, y);
      for (double& d : nearness) d = -d;
      return retrieval_table(Rows(std::span<const double>(nearness), y.size()), alike);
    }
    return retrieval_table(Rows(cosine_similarities(x, y), y.size()), alike);
  };
  auto table_at = [&](std::span<const Index> positions) {
    const auto x = rows_at(texts, positions), y = rows_at(motions, positions);
    return table_of(Rows(x, texts.width()), Rows(y, motions.width()));
  };
  if (protocol == RetrievalProtocol::normal) return table_of(texts, motions);
  if (protocol == RetrievalProtocol::threshold) {
    detail::require_same_count("retrieve: texts against sentences", n, sentences.size());
    return table_of(texts, motions, texts_alike(sentences, options.threshold));
  }

  detail::require_same_count("retrieve: texts against ids", n, std::ssize(options.ids));
  const auto& ids = options.ids;
  auto id_at = [&](Index i) -> const std::string& { return ids[static_cast<std::size_t>(i)]; };
  std::vector<Index> by_id(ids.size());
  std::iota(by_id.begin(), by_id.end(), Index{0});
  std::sort(by_id.begin(), by_id.end(), [&](Index a, Index b) { return id_at(a) < id_at(b); });
  for (std::size_t i = 1; i < by_id.size(); ++i) {
    if (id_at(by_id[i - 1]) == id_at(by_id[i]))
      raise<config_error>(103, "retrieve: the id '", id_at(by_id[i]), "' is duplicated");
  }
  if (protocol == RetrievalProtocol::nsim) {
    std::vector<Index> chosen;
    for (const std::string& id : options.nsim_ids) {
      const auto place =
          std::lower_bound(by_id.begin(), by_id.end(), id, [&](Index i, const std::string& s) { return id_at(i) < s; });
      if (place != by_id.end() && id_at(*place) == id) chosen.push_back(*place);
    }
    return table_at(chosen);
  }
  std::vector<RetrievalTable> tables;
  for (std::vector<Index>& batch : guo_batches(n, options.batch)) {
    for (Index& i : batch) i = by_id[static_cast<std::size_t>(i)];
    tables.push_back(table_at(batch));
  }
  if (tables.empty()) raise<numeric_error>(302, "retrieve: ", n, " pairs make no batch of ", options.batch);
  return detail::mean_table(tables);
}
/// The same for protocols that do not need sentences.
template <Scalar S>
RetrievalTable retrieve(RetrievalProtocol protocol, const Rows<S>& texts, const Rows<S>& motions,
                        const RetrievalOptions& options = {}) {
  return retrieve(protocol, texts, motions, Rows<S>(std::span<const S>{}, 1), options);
}

/// Chooses texts that are far from each other, for protocol `nsim`. It begins with the least similar pair. Then it adds
/// the text with the smallest sum of similarities to the chosen ones; among equals, the one with the first id. The
/// program that chose TMR's lists is not published. The paper says that it approximates a quadratic knapsack problem.
/// sentences  (n, d) unit rows
/// result     positions in the order in which they were chosen
/// Throws     shape_error 204; config_error 101 unless 2 <= count <= n
template <Scalar E>
std::vector<Index> dissimilar_subset(const Rows<E>& sentences, std::span<const std::string> ids, Index count) {
  const Index n = sentences.size();
  detail::require_same_count("dissimilar_subset: sentences against ids", n, std::ssize(ids));
  if (count < 2 || count > n) raise<config_error>(101, "dissimilar_subset: ", count, " of ", n, " texts");
  std::vector<Index> by_id(ids.size());
  std::iota(by_id.begin(), by_id.end(), Index{0});
  std::stable_sort(by_id.begin(), by_id.end(), [&](Index a, Index b) {
    return ids[static_cast<std::size_t>(a)] < ids[static_cast<std::size_t>(b)];
  });
  const auto ordered_values = rows_at(sentences, by_id);
  const Rows ordered(ordered_values, sentences.width());

  std::pair<Index, Index> pair{0, 1};
  double least = std::numeric_limits<double>::infinity();
  detail::each_dot_product(ordered, ordered, [&](Index i, Index j, double s) {
    if (i < j && (s < least || (s == least && std::pair(i, j) < pair))) least = s, pair = {i, j};
  });
  std::vector<bool> chosen(by_id.size(), false);
  std::vector<double> sums(by_id.size(), 0);
  std::vector<Index> out;
  auto choose = [&](Index k) {
    chosen[static_cast<std::size_t>(k)] = true;
    out.push_back(by_id[static_cast<std::size_t>(k)]);
    for (Index i = 0; i < n; ++i) sums[static_cast<std::size_t>(i)] += detail::dot_product(ordered[i], ordered[k]);
  };
  choose(pair.first), choose(pair.second);
  while (std::ssize(out) < count) {
    std::size_t best = by_id.size();
    for (std::size_t k = 0; k < by_id.size(); ++k) {
      if (!chosen[k] && (best == by_id.size() || sums[k] < sums[best])) best = k;
    }
    choose(static_cast<Index>(best));
  }
  return out;
}

// ---- moments: the place of a text in a long motion
// Source  Petrovich's thesis (2024), section 5.3.6. There is no published code. So it is a choice made here that
//         windows are cut at the ends of the motion and follow each other by `stride` frames.

/// Windows of `width` frames. The k-th has its middle at frame k * stride, and is cut at the ends of the motion. Throws
/// config_error 101 unless width and stride are positive.
std::vector<FrameSlice> moment_windows(Index frames, Index width, Index stride = 1);

/// The window with the largest similarity, the first among equals. A list may contain windows of several widths. Throws
/// shape_error 204, and numeric_error 302 without windows.
FrameSlice best_moment(std::span<const FrameSlice> windows, std::span<const double> similarities);

/// a intersected with b| / |a united with b| in frames; 0 if both are empty.
double temporal_iou(const FrameSlice& a, const FrameSlice& b);

/// The share of queries, 0 to 1, that are found with at least this intersection over union; the thesis uses 0.4. Throws
/// shape_error 204, and numeric_error 302 without queries.
double localisation_accuracy(std::span<const FrameSlice> found, std::span<const FrameSlice> wanted,
                             double least_iou = 0.4);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/retrieval.ipp>
#endif
