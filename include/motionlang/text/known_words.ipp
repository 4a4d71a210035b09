// SPDX-License-Identifier: MIT
// Bodies of known_words.hpp.
#pragma once

#include <algorithm>  // binary_search, sort, unique
#include <set>        // words, each once

#include <motionlang/core/utf8.hpp>
#include <motionlang/file/key_report.hpp>
#include <motionlang/text/known_words.hpp>
#include <motionlang/text/unicode.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

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

MOTIONLANG_BODY KnownWords::KnownWords(std::vector<std::string> listed, WordVectors vectors)
    : vectors_(std::move(vectors)) {
  if (listed.empty()) return;
  std::sort(listed.begin(), listed.end());
  listed.erase(std::unique(listed.begin(), listed.end()), listed.end());
  listed_ = std::make_shared<const std::vector<std::string>>(std::move(listed));
}

MOTIONLANG_BODY bool KnownWords::knows(const std::string& word) const {
  return (listed_ && std::binary_search(listed_->begin(), listed_->end(), word)) || vectors_.find(word).has_value();
}

MOTIONLANG_BODY std::string KnownWords::like(const std::string& word) const {
  if (!listed_) return "";
  const std::string like = nearest_name(word, *listed_);
  return 3 * edit_distance(word, like, word.size()) <= word.size() ? like : "";
}

MOTIONLANG_BODY std::vector<UnknownWord> unknown_words(std::string_view text, const KnownWords& known) {
  std::vector<UnknownWord> out;
  if (known.empty()) return out;
  std::set<std::string> seen;
  for (const std::string& word : WordPiece::words(text)) {
    if (known.knows(word) || !seen.insert(word).second) continue;
    out.push_back({word, known.like(word)});
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
