// SPDX-License-Identifier: MIT
/// One unit vector for each text from the words in it: which texts say nearly the same, where there is no network that
/// knows.
///
///     v_w = count of w in the text * (ln((1 + texts) / (1 + texts with w)) + 1/100),   then length 1
/// so that words which stand in every text ("a", "person") weigh next to nothing. Order and synonyms are not seen.
/// Source  Salton, Buckley: "Term-weighting approaches in automatic text retrieval" (1988)
#pragma once

#include <cmath>  // log, sqrt
#include <map>    // words
#include <set>    // words of one text

#include <motionlang/text/text_encoder.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class BagOfWords {
 public:
  /// Counts each different text once. Words as WordPiece sees them.
  explicit BagOfWords(std::span<const std::string> texts) {
    const std::set<std::string> different(texts.begin(), texts.end());
    std::map<std::string, Index> counts;
    for (const std::string& t : different) {
      const auto words = WordPiece::words(t);
      for (const std::string& w : std::set<std::string>(words.begin(), words.end())) ++counts[w];
    }
    for (const auto& [word, count] : counts) {
      const double rare = std::log((1.0 + static_cast<double>(different.size())) / (1.0 + static_cast<double>(count)));
      words_.emplace(word, Word{static_cast<Index>(words_.size()), rare + 0.01});
    }
  }

  /// Words, and one for all that are not known.
  Index width() const { return static_cast<Index>(words_.size()) + 1; }

  std::vector<double> vector(std::string_view text) const {
    std::vector<double> out(static_cast<std::size_t>(width()));
    for (const std::string& w : WordPiece::words(text)) {
      const auto found = words_.find(w);
      if (found == words_.end())
        out.back() += 1;
      else
        out[static_cast<std::size_t>(found->second.number)] += found->second.weight;
    }
    double squares = 0;
    for (const double x : out) squares += x * x;
    for (double& x : out) x /= std::max(std::sqrt(squares), 1e-12);
    return out;
  }

  /// A text without words is all zero.
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
