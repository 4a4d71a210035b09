// SPDX-License-Identifier: MIT
// Bodies of bag_of_words.hpp.
#pragma once

#include <algorithm>  // max
#include <cmath>      // log, sqrt
#include <set>        // words of one text

#include <motionlang/text/bag_of_words.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY BagOfWords::BagOfWords(std::span<const std::string> texts) {
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

MOTIONLANG_BODY std::vector<double> BagOfWords::vector(std::string_view text) const {
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

MOTIONLANG_NAMESPACE_END
