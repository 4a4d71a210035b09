// SPDX-License-Identifier: MIT
/// An encoder of texts for tests: how often a text says each of a few words.
#pragma once

#include <algorithm>  // count

#include <motionlang/text/known_captions.hpp>
#include <motionlang/text/word_piece.hpp>

namespace counted {

namespace ml = motionlang;

inline std::vector<float> vectors(std::span<const std::string> texts) {
  const std::vector<std::string> heard{"walk", "raise", "right", "left", "kick", "again", "hard", "sit"};
  std::vector<float> out;
  for (const std::string& text : texts) {
    const auto words = ml::WordPiece::words(text);
    for (const std::string& word : heard)
      out.push_back(static_cast<float>(std::count(words.begin(), words.end(), word)));
  }
  return out;
}

/// The captions of a model that walks, kicks and sits down.
inline ml::KnownCaptions captions() {
  const std::vector<std::string> texts{"walk", "kick", "sit"};
  return {ml::TextTable::encoded(texts, vectors),
          {{3, true, ""}, {1.5, false, "stand still"}, {2, false, "sit quietly"}},
          0.5};
}

}  // namespace counted
