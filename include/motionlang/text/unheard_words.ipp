// SPDX-License-Identifier: MIT
// Bodies of unheard_words.hpp.
#pragma once

#include <set>  // words, each once

#include <motionlang/text/unheard_words.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<UnknownWord> unheard_words(const WordPiece& pieces, const WordVectors& vectors,
                                                       std::string_view text) {
  std::vector<UnknownWord> out;
  if (vectors.empty()) return out;
  std::vector<std::string> unheard;
  std::set<std::string> seen;
  for (const std::string& word : WordPiece::words(text)) {
    if (!pieces.find(word) && !vectors.find(word) && seen.insert(word).second) unheard.push_back(word);
  }
  if (!unheard.empty()) {
    std::vector<std::string> said;
    for (const std::string& piece : pieces.vocabulary()) {
      if (piece.size() >= 3 && piece.front() != '#' && piece.front() != '[') said.push_back(piece);
    }
    for (const std::string& word : unheard) {
      auto like = unknown_words(word, said);
      if (!like.empty() && like.front().like.empty()) like = unknown_words(word, vectors.words());
      out.push_back(like.empty() ? UnknownWord{word, ""} : std::move(like.front()));
    }
  }
  for (std::string& word : unreadable_words(text)) out.push_back({std::move(word), ""});
  return out;
}

MOTIONLANG_NAMESPACE_END
