// SPDX-License-Identifier: MIT
/// How many negatives TMR's contrastive loss leaves out because their texts mean nearly the same, and how many pairs of
/// texts count as the same in an evaluation.
///
///     filtered_negatives<B>(data.training, sentences, 0.8, 32);          // percent of a batch's negatives
///     similar_pairs(Rows(e.span(), e.size(1)), 0.95);                    // of all pairs of test texts
///     filtered_negatives_table(filtered_shares<B>(data.training, sentences));  // table 5.5
///
/// Source  TMR (Petrovich, Black, Varol, ICCV 2023), section 3.3; thesis 5.3.1 and table 5.5
#pragma once

#include <cstdint>  // seed
#include <string>   // texts
#include <vector>   // motions

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/loss/false_negatives.hpp>
#include <motionlang/metrics/rows.hpp>
#include <motionlang/train/epoch_batches.hpp>
#include <motionlang/weights/embedding_cache.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The mean percentage of the negatives of a batch that are filtered, over an epoch with a random text for each motion.
/// Batches of one motion have no negatives. Throws numeric_error 302 if there are none, and as false_negatives.
template <Backend B>
double filtered_negatives(const std::vector<DescribedMotion>& motions, const EmbeddingCache& sentences,
                          double threshold, Index batch, std::uint64_t seed = 0) {
  const EpochBatches batches(std::ssize(motions), batch);
  auto draw = Philox{.seed = seed}.split("texts");
  double sum = 0;
  Index count = 0;
  for (Index k = 0; k < batches.per_epoch(); ++k) {
    std::vector<std::string> texts;
    for (const Index i : batches(k, seed)) {
      const auto& own = motions[static_cast<std::size_t>(i)].texts;
      texts.push_back(own[draw.below(static_cast<std::uint32_t>(own.size()))].text);
    }
    const auto n = static_cast<double>(texts.size());
    if (texts.size() < 2) continue;
    double filtered = 0;
    for (const unsigned char f : false_negatives(sentences.encode<B>(texts).tokens.rows, threshold)) filtered += f;
    sum += 100 * filtered / (n * (n - 1));
    ++count;
  }
  if (count == 0) raise<numeric_error>(302, "filtered_negatives: no batch has two motions");
  return sum / static_cast<double>(count);
}

/// Table 5.5: such percentages by threshold, with one size of a batch, and by size, with one threshold.
struct FilteredShares {
  std::vector<double> thresholds{0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95};
  std::vector<Index> batches{16, 32, 64, 128};
  Index batch = 32;
  double threshold = 0.8;
  std::vector<double> by_threshold{}, by_batch{};
};
/// Throws as filtered_negatives.
template <Backend B>
FilteredShares filtered_shares(const std::vector<DescribedMotion>& motions, const EmbeddingCache& sentences) {
  FilteredShares out;
  for (const double t : out.thresholds)
    out.by_threshold.push_back(filtered_negatives<B>(motions, sentences, t, out.batch));
  for (const Index b : out.batches) out.by_batch.push_back(filtered_negatives<B>(motions, sentences, out.threshold, b));
  return out;
}
/// The table as text.
std::string filtered_negatives_table(const FilteredShares& shares);

/// Pairs of different places in a list of texts.
struct SimilarPairs {
  Index similar = 0, all = 0;
  double percent() const { return all == 0 ? 0 : 100 * static_cast<double>(similar) / static_cast<double>(all); }
};
/// sentences  (n, d) unit rows;   threshold  from 0 to 1, like scores
template <Scalar S>
SimilarPairs similar_pairs(const Rows<S>& sentences, double threshold) {
  const Index n = sentences.size();
  SimilarPairs out{0, n * (n - 1) / 2};
  detail::each_dot_product(sentences, sentences, [&](Index i, Index j, double product) {
    if (i < j && product > 2 * threshold - 1) ++out.similar;
  });
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/filtered_negatives.ipp>
#endif
