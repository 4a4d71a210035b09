// SPDX-License-Identifier: MIT
/// BERTScore of descriptions from token embeddings. The caller supplies the language model: TM2T uses layer 17 of
/// roberta-large, on sentences that are stripped and get a leading blank.
///
///     BertWeights weights;
///     for (const auto& ids : ids_of_references) weights.add(ids);        // every reference of the test set
///     const BertScore s = bert_score(candidate, references, weights, tm2t_bert_baseline);
///
/// With unit embeddings x_i of the candidate and y_j of a reference and weights w of their tokens:
///     P = sum_i w_i max_j x_i . y_j / sum_i w_i,   R = sum_j w_j max_i x_i . y_j / sum_j w_j,   F = 2 P R / (P + R)
///     w = log((N + 1) / (c + 1)),   c = references with this token, of N
///    With several references: the largest P, R and F, each on its own; then (x - b) / (1 - b) with a baseline b
/// Source  Zhang et al., "BERTScore: evaluating text generation with BERT" (ICLR 2020), sections 3 and 4; the package
///         bert-score, bert_score/utils.py greedy_cos_idf
/// The package counts pairs with padding as similarity 0. This only matters if all similarities of a token are
/// negative: with padding (BertPadding) the largest is then 0.
#pragma once

#include <algorithm>  // max
#include <map>        // counts
#include <set>        // tokens of a sentence

#include <motionlang/metrics/rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Weights of tokens. Tokens in every sentence, such as its start and end, have weight 0.
class BertWeights {
 public:
  void add(std::span<const Index> reference) {
    for (const Index id : std::set<Index>(reference.begin(), reference.end())) ++with_[id];
    ++references_;
  }
  double operator()(Index id) const {
    const auto found = with_.find(id);
    const Index count = found == with_.end() ? 0 : found->second;
    return std::log(static_cast<double>(references_ + 1) / static_cast<double>(count + 1));
  }

 private:
  std::map<Index, Index> with_;
  Index references_ = 0;
};

/// A sentence: its tokens and one row for each.
template <Scalar S>
struct BertSentence {
  std::vector<Index> ids;
  Rows<S> embeddings;
};

/// The number of tokens to which the sentences of a batch are padded; 0: no padding.
struct BertPadding {
  Index candidate = 0, reference = 0;
};

struct BertScore {
  double precision = 0, recall = 0, f = 0;
};
/// roberta-large, layer 17, English.
inline constexpr BertScore tm2t_bert_baseline{0.83150584, 0.8314941, 0.83122575};

/// The score against one reference, without a baseline. All values are 0 if a sentence has only its start and end, two
/// tokens. A side whose tokens have no weight is 0. Throws shape_error 204 unless every token has its row and all rows
/// have the same width
template <Scalar S>
BertScore bert_score(const BertSentence<S>& candidate, const BertSentence<S>& reference, const BertWeights& weights,
                     const BertPadding& padding = {}) {
  for (const BertSentence<S>* s : {&candidate, &reference})
    detail::require_same_count("bert_score: tokens against rows", std::ssize(s->ids), s->embeddings.size());
  if (candidate.ids.size() <= 2 || reference.ids.size() <= 2) return {};
  const auto similarity = cosine_similarities(candidate.embeddings, reference.embeddings);
  auto side = [&](const std::vector<Index>& ids, std::size_t others, Index padded, auto at) {
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      double best = at(i, std::size_t{0});
      if (static_cast<Index>(others) < padded) best = std::max(best, 0.0);
      for (std::size_t j = 1; j < others; ++j) best = std::max(best, at(i, j));
      sum += weights(ids[i]) * best, all += weights(ids[i]);
    }
    return all > 0 ? sum / all : 0;
  };
  const std::size_t n = candidate.ids.size(), m = reference.ids.size();
  BertScore out;
  out.precision =
      side(candidate.ids, m, padding.reference, [&](std::size_t i, std::size_t j) { return similarity[i * m + j]; });
  out.recall =
      side(reference.ids, n, padding.candidate, [&](std::size_t j, std::size_t i) { return similarity[i * m + j]; });
  const double sum = out.precision + out.recall;
  out.f = sum != 0 ? 2 * out.precision * out.recall / sum : 0;
  return out;
}

/// The score for several references. Throws shape_error 204, and numeric_error 302 without references
template <Scalar S>
BertScore bert_score(const BertSentence<S>& candidate, std::span<const BertSentence<S>> references,
                     const BertWeights& weights, const BertScore& baseline = {}, const BertPadding& padding = {}) {
  if (references.empty()) raise<numeric_error>(302, "bert_score: no reference");
  BertScore out = bert_score(candidate, references.front(), weights, padding);
  for (const BertSentence<S>& r : references.subspan(1)) {
    const BertScore s = bert_score(candidate, r, weights, padding);
    out = {std::max(out.precision, s.precision), std::max(out.recall, s.recall), std::max(out.f, s.f)};
  }
  auto rescaled = [](double x, double b) { return (x - b) / (1 - b); };
  return {rescaled(out.precision, baseline.precision), rescaled(out.recall, baseline.recall),
          rescaled(out.f, baseline.f)};
}

MOTIONLANG_NAMESPACE_END
