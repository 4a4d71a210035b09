// SPDX-License-Identifier: MIT
/// One unit vector for each text, computed from its words. It finds texts that mean nearly the same if there is no
/// network that does so.
///
///     v_w = count of w in the text * (ln((1 + texts) / (1 + texts with w)) + 1/100),   then length 1
/// Words in every text ("a", "person") have almost no weight. Order and synonyms are ignored.
/// Source  Salton, Buckley: "Term-weighting approaches in automatic text retrieval" (1988)
#pragma once

#include <map>          // words
#include <string>       // words
#include <string_view>  // texts
#include <vector>       // rows

#include <motionlang/text/text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class BagOfWords {
 public:
  /// Counts each different text once. Words are those of WordPiece.
  explicit BagOfWords(std::span<const std::string> texts);

  /// The number of words, plus one for all unknown words.
  Index width() const { return static_cast<Index>(words_.size()) + 1; }

  std::vector<double> vector(std::string_view text) const;

  /// The vector of a text without words is zero.
  template <Backend B>
  TextFeatures<B> encode(std::span<const std::string> texts) const {
    std::vector<typename B::scalar> rows;
    for (const std::string& t : texts) {
      for (const double x : vector(t)) rows.push_back(static_cast<typename B::scalar>(x));
    }
    return TextFeatures<B>::pooled(Tensor<B, 2>::from(rows, {std::ssize(texts), width()}));
  }

 private:
  struct Word {
    Index number;
    double weight;
  };
  std::map<std::string, Word> words_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/bag_of_words.ipp>
#endif
