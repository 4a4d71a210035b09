// SPDX-License-Identifier: MIT
/// How well descriptions fit their motions, by the networks of Guo et al.: R-precision and distance, the first columns
/// of TM2T's table 1.
///
///     const CommonTags tags(data.training);
///     const MatchingMetric m = description_match(judge, entries, tags.tagged(said), data.width, Philox{.seed = 0});
///     use(m.r_precision(1), m.matching_score());
///
/// Source   TM2T (Guo et al., ECCV 2022), table 1; final_evaluations_m2t.py: for each motion, the descriptions of its
///          batch are ranked
/// Differs  spaCy tags the words of a description there. Here each gets the tag that it has most often in the training
///          texts, and "OTHER" if it occurs in none
#pragma once

#include <algorithm>  // min
#include <map>        // tags
#include <span>       // texts
#include <string>     // texts
#include <vector>     // motions

#include <motionlang/train/guo_evaluation.hpp>
#include <motionlang/train/text_entries.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The most frequent part of speech of every word.
class CommonTags {
 public:
  explicit CommonTags(const std::vector<DescribedMotion>& motions);

  /// True if the texts have no parts of speech. Sentences then stay as they are.
  bool empty() const { return tags_.empty(); }
  /// "word/TAG word/TAG". Among equally frequent tags the first in the alphabet is taken.
  std::string tagged(const std::string& sentence) const;
  std::vector<std::string> tagged(std::span<const std::string> sentences) const;

 private:
  std::map<std::string, std::string> tags_;
};

/// The entries in random batches of 32; an incomplete last one is left out, unless it is the only one.
/// texts   one for each entry, as GloVe::encode reads them
/// Throws  shape_error 204 for another number of texts
template <Backend B>
MatchingMetric description_match(const GuoJudge<B>& judge, std::span<const TextEntry> entries,
                                 std::span<const std::string> texts, Index width, Philox rng) {
  detail::require_same_count("description_match: texts against motions", std::ssize(texts), std::ssize(entries));
  std::vector<Index> order(entries.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[rng.below(static_cast<std::uint32_t>(i))]);
  const Index batch = std::min<Index>(32, std::ssize(entries));
  MatchingMetric out;
  for (Index at = 0; at + batch <= std::ssize(entries) && batch > 0; at += batch) {
    std::vector<typename B::scalar> values;
    std::vector<Index> frames;
    std::vector<std::string> said;
    for (Index i = at; i < at + batch; ++i) {
      const auto which = static_cast<std::size_t>(order[static_cast<std::size_t>(i)]);
      const TextEntry& e = entries[which];
      const auto rows = entry_rows(e, 0, e.frames.length, width);
      values.insert(values.end(), rows.begin(), rows.end());
      frames.push_back(e.frames.length);
      said.push_back(texts[which]);
    }
    const Offsets offsets(frames);
    const auto motions = judge.motions({Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets});
    const auto words = judge.texts(said);
    out.add(Rows(motions.span(), motions.size(1)), Rows(words.span(), words.size(1)));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/description_evaluation.ipp>
#endif
