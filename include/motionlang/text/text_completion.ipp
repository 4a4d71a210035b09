// SPDX-License-Identifier: MIT
// Bodies of text_completion.hpp.
#pragma once

#include <algorithm>  // all_of, any_of, equal, find
#include <span>       // words
#include <sstream>    // words

#include <motionlang/core/text_lines.hpp>
#include <motionlang/text/text_completion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The words of a text with small letters.
inline std::vector<std::string> small_words(std::string text) {
  for (char& c : text) c = lower(c);
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

/// 0: the text begins with what is begun; 1: it has its words, and one that begins with its last word; 2: neither.
inline int completion_rank(const std::vector<std::string>& text, const std::vector<std::string>& begun) {
  if (begun.empty()) return 0;
  const std::span whole(begun.data(), begun.size() - 1);
  if (text.size() >= begun.size() && std::equal(whole.begin(), whole.end(), text.begin()) &&
      text[whole.size()].starts_with(begun.back()))
    return 0;
  const bool has_all = std::all_of(whole.begin(), whole.end(), [&](const std::string& w) {
    return std::find(text.begin(), text.end(), w) != text.end();
  });
  const bool has_begun =
      std::any_of(text.begin(), text.end(), [&](const std::string& w) { return w.starts_with(begun.back()); });
  return has_all && has_begun ? 1 : 2;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<KnownText> known_texts(const KnownCaptions& captions, const std::string& begun,
                                                   Index count) {
  std::vector<KnownText> out;
  const std::size_t known = captions.actions().size();  // texts that were tried follow the captions
  const auto add = [&](std::size_t row, const std::string& text) {
    const bool again = std::any_of(out.begin(), out.end(), [&](const KnownText& k) { return k.text == text; });
    if (!again && std::ssize(out) < count) out.push_back({text, captions.actions()[row]});
  };
  if (known == 0) return out;
  const auto words = detail::small_words(begun);
  const auto& texts = captions.table().texts();
  for (int rank = 0; rank < 2; ++rank) {
    for (std::size_t row = 0; row < known && std::ssize(out) < count; ++row) {
      if (detail::completion_rank(detail::small_words(texts[row]), words) == rank) add(row, texts[row]);
    }
  }
  if (words.empty() || std::ssize(out) >= count) return out;
  for (const NearText& near : captions.nearest(begun, count)) add(static_cast<std::size_t>(near.row), near.text);
  return out;
}

MOTIONLANG_NAMESPACE_END
