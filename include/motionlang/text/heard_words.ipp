// SPDX-License-Identifier: MIT
// Bodies of heard_words.hpp.
#pragma once

#include <motionlang/text/heard_words.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY HeardWords heard_words(const WordPiece& pieces, const WordVectors& vectors,
                                       std::span<const std::string> texts, Index longest) {
  if (longest < 2) raise<config_error>(101, "heard_words: at most ", longest, " tokens, the frame has 2");
  HeardWords out;
  for (const std::string& text : texts) {
    const std::size_t first = out.ids.size(), end = first + static_cast<std::size_t>(longest) - 1;
    out.ids.push_back(WordPiece::begin_id);
    for (const std::string& word : WordPiece::words(text)) {
      const auto row = vectors.find(word);
      out.rows.resize(out.ids.size(), HeardWords::no_vector);
      if (const auto id = pieces.find(word); id || row)
        out.ids.push_back(id.value_or(WordPiece::unknown_id));
      else
        pieces.append_word(out.ids, word);
      if (row) out.rows.push_back(*row);
    }
    out.ids.resize(std::min(out.ids.size(), end));
    out.ids.push_back(WordPiece::end_id);
    out.rows.resize(std::min(out.rows.size(), end));
    out.rows.resize(out.ids.size(), HeardWords::no_vector);
    out.lengths.push_back(static_cast<Index>(out.ids.size() - first));
  }
  return out;
}

MOTIONLANG_BODY void hide_words(HeardWords& words, double chance, Philox& rng) {
  for (std::size_t i = 0; i < words.ids.size(); ++i) {
    if (words.rows[i] != HeardWords::no_vector && rng.uniform() < chance) words.ids[i] = WordPiece::unknown_id;
  }
}

MOTIONLANG_NAMESPACE_END
