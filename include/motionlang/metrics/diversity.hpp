// SPDX-License-Identifier: MIT
/// The differences among generated motions: diversity (all motions) and multimodality (those of one action or text).
///
///     NumpyRandom rng(seed);
///     const double actor_diversity = mean_pair_distance(features, random_pairs(features.size(), 200, rng));
///     const double actor_modes = mean_pair_distance(features, pairs_within_classes(labels, 12, 20, rng));
///     const double guo_diversity = mean_pair_distance(embeddings, disjoint_draws(embeddings.size(), 300, rng));
///     const double guo_modes = multimodality(embeddings, 30, disjoint_draws(30, 10, rng));
///
/// Each is the mean of |x_a - x_b| over pairs, in the unit of the features. The systems differ in how they choose
/// pairs.
/// Source  Guo et al., "Action2Motion" (ACM MM 2020) and CVPR 2022; thesis 3.3.1; TM2T (ECCV 2022), appendix C;
///         references: ACTOR src/evaluate/action2motion/diversity.py, text-to-motion utils/metrics.py
#pragma once

#include <motionlang/core/numpy_random.hpp>
#include <motionlang/metrics/rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Row first[i] is compared with row second[i].
struct IndexPairs {
  std::vector<Index> first, second;
};

/// ACTOR's diversity: `count` pairs out of n. Both are uniform and may be equal. All first members are drawn before the
/// second ones. Throws config_error 101 if there is nothing to draw from.
IndexPairs random_pairs(Index n, Index count, NumpyRandom& rng);

/// Guo's diversity: two draws of `count` different ones out of n; the draws may overlap. Throws config_error 101 unless
/// count < n.
IndexPairs disjoint_draws(Index n, Index count, NumpyRandom& rng);

/// ACTOR's multimodality: `quota` pairs of each class. A first member is drawn from all samples, and skipped if its
/// class has enough pairs. Second members are drawn until the class is the same; this may be the first one itself.
/// Throws config_error 101, shape_error 203 for a label that is not a class, and numeric_error 302 if a class is
/// absent, for which the published loop would not end
IndexPairs pairs_within_classes(std::span<const Index> labels, Index classes, Index quota, NumpyRandom& rng);

/// Mean of |x_first - x_second|. Throws shape_error 204, 203; numeric_error 302 without pairs
template <Scalar S>
double mean_pair_distance(const Rows<S>& rows, const IndexPairs& pairs) {
  detail::require_same_count("mean_pair_distance: pairs", std::ssize(pairs.first), std::ssize(pairs.second));
  if (pairs.first.empty()) raise<numeric_error>(302, "mean_pair_distance: no pairs");
  double sum = 0;
  for (std::size_t i = 0; i < pairs.first.size(); ++i) {
    sum += detail::euclidean_distance(rows.slice(pairs.first[i], 1).values(), rows.slice(pairs.second[i], 1).values());
  }
  return sum / static_cast<double>(pairs.first.size());
}

/// Guo's multimodality: the mean over texts, each with `repeats` rows, with the same pairs for every text.
/// rows    (texts repeats, d)
/// Throws  shape_error 204, 203, 205 unless all texts have their rows; numeric_error 302 without texts
template <Scalar S>
double multimodality(const Rows<S>& rows, Index repeats, const IndexPairs& pairs) {
  if (repeats < 1 || rows.size() % repeats != 0)
    raise<shape_error>(205, "multimodality: ", rows.size(), " rows of ", repeats, " for each text");
  if (rows.size() == 0) raise<numeric_error>(302, "multimodality: no texts");
  double sum = 0;
  for (Index at = 0; at < rows.size(); at += repeats) sum += mean_pair_distance(rows.slice(at, repeats), pairs);
  return sum * static_cast<double>(repeats) / static_cast<double>(rows.size());
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/diversity.ipp>
#endif
