// SPDX-License-Identifier: MIT
// Bodies of stranger_texts.hpp.
#pragma once

#include <algorithm>  // all_of
#include <cmath>      // sqrt
#include <set>        // rows

#include <motionlang/core/parallel.hpp>
#include <motionlang/text/stranger_texts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// All vectors with length 1, row by row; zeros stay zeros.
inline std::vector<float> unit_word_vectors(const WordVectors& vectors) {
  std::vector<float> out;
  for (Index row = 0; row < vectors.size(); ++row) {
    auto v = vectors.vector(row);
    float squares = 0;
    for (const float x : v) squares += x * x;
    for (const float x : v) out.push_back(squares > 0 ? x / std::sqrt(squares) : 0);
  }
  return out;
}

/// "gomu", "tikasa": two or three syllables.
inline std::string invented_word(Philox& rng) {
  constexpr std::string_view consonants = "bdfghjklmnprstvwxz", vowels = "aeiou";
  std::string out;
  for (std::uint32_t syllables = 2 + rng.below(2); syllables > 0; --syllables) {
    out += consonants[rng.below(static_cast<std::uint32_t>(consonants.size()))];
    out += vowels[rng.below(static_cast<std::uint32_t>(vowels.size()))];
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY StrangerTexts::StrangerTexts(const WordPiece& pieces, const WordVectors& vectors, double most_alike) {
  std::set<Index> rows;
  for (const std::string& piece : pieces.vocabulary()) {
    if (piece.size() < 3 || piece.front() == '#' || piece.front() == '[') continue;
    if (const auto row = vectors.find(piece)) rows.insert(*row);
  }
  const std::vector<Index> said(rows.begin(), rows.end());
  const auto unit = detail::unit_word_vectors(vectors);
  const auto row_of = [&](Index row) {
    const auto width = static_cast<std::size_t>(vectors.width());
    return std::span(unit).subspan(static_cast<std::size_t>(row) * width, width);
  };
  std::vector<unsigned char> far(static_cast<std::size_t>(vectors.size()));
  parallel_for(vectors.size(), [&](Index i) {
    const auto v = row_of(i);
    far[static_cast<std::size_t>(i)] = std::all_of(said.begin(), said.end(), [&](Index other) {
      const auto w = row_of(other);
      float likeness = 0;
      for (std::size_t k = 0; k < v.size(); ++k) likeness += v[k] * w[k];
      return static_cast<double>(likeness) <= most_alike;
    });
  });
  for (std::size_t i = 0; i < far.size(); ++i) {
    const std::string& word = vectors.words()[i];
    if (far[i] != 0 && !pieces.find(word)) words_.push_back(word);
  }
}

MOTIONLANG_BODY std::string StrangerTexts::word(bool invented, Philox& rng) const {
  if (invented || words_.empty()) return detail::invented_word(rng);
  return words_[rng.below(static_cast<std::uint32_t>(words_.size()))];
}

MOTIONLANG_BODY std::string StrangerTexts::disturb(const std::string& text, Philox rng) const {
  constexpr std::string_view links[] = {"", "at a ", "with a ", "on the ", "in the ", "like a "};
  auto words = WordPiece::words(text);
  for (std::uint32_t left = 1 + rng.below(2); left > 0; --left) {
    const auto last = static_cast<std::uint32_t>(words.size());
    const std::uint32_t at = rng.below(2) == 0 ? last : rng.below(last + 1);
    const std::string link(links[rng.below(6)]);
    words.insert(words.begin() + at, link + word(false, rng));
  }
  return join_text(words, " ");
}

MOTIONLANG_BODY std::vector<std::string> StrangerTexts::draw(Index count, Philox rng) const {
  constexpr const char* people[] = {"a person", "someone", "a man", "a woman"};
  std::vector<std::string> out;
  for (Index i = 0; i < count; ++i) {
    const bool invented = rng.below(3) == 0;
    std::string text = rng.below(2) == 0 ? people[rng.below(4)] : "";
    for (std::uint32_t left = 1 + rng.below(4); left > 0; --left) {
      if (!text.empty()) text += ' ';
      text += word(invented, rng);
    }
    out.push_back(std::move(text));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
