// SPDX-License-Identifier: MIT
// Bodies of known_words.hpp.
#pragma once

#include <algorithm>  // find
#include <set>        // words, each once

#include <motionlang/core/utf8.hpp>
#include <motionlang/file/key_report.hpp>
#include <motionlang/text/known_words.hpp>
#include <motionlang/text/unicode.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A known word that differs in a third of its letters at most; "" if there is none.
inline std::string near_word(const std::string& word, const std::vector<std::string>& known) {
  const std::string like = nearest_name(word, known);
  return 3 * edit_distance(word, like, word.size()) <= word.size() ? like : "";
}

}  // namespace detail

MOTIONLANG_BODY std::string listed_words(std::span<const std::string> captions) {
  std::set<std::string> words;
  for (const std::string& c : captions) {
    for (std::string& w : WordPiece::words(c)) words.insert(std::move(w));
  }
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : "\n") + w;
  return out;
}

MOTIONLANG_BODY std::vector<std::string> known_words(const std::map<std::string, std::string>& metadata) {
  const auto found = metadata.find(known_words_entry);
  return found == metadata.end() ? std::vector<std::string>() : WordPiece::words(found->second);
}

MOTIONLANG_BODY std::vector<UnknownWord> unknown_words(std::string_view text, const std::vector<std::string>& known) {
  std::vector<UnknownWord> out;
  if (known.empty()) return out;
  std::set<std::string> seen;
  for (const std::string& word : WordPiece::words(text)) {
    if (std::find(known.begin(), known.end(), word) != known.end() || !seen.insert(word).second) continue;
    out.push_back({word, detail::near_word(word, known)});
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> unreadable_words(std::string_view text) {
  std::vector<std::string> out;
  for_each_word(text, [&](std::string_view word) {
    bool readable = true;
    for (std::size_t at = 0; at < word.size();) {
      const char32_t c = decode_utf8(word, at);
      readable &= c < 0x80 || (char_class(c) & (CharClass::letter | CharClass::number)) == 0;
    }
    if (!readable) out.emplace_back(word);
  });
  return out;
}

MOTIONLANG_NAMESPACE_END
