// SPDX-License-Identifier: MIT
// Bodies of mirror_caption.hpp.
#pragma once

#include <array>   // words
#include <vector>  // pieces

#include <motionlang/core/text_lines.hpp>
#include <motionlang/text/mirror_caption.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Letters and digits; bytes of characters outside ASCII belong to words.
constexpr bool in_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         static_cast<unsigned char>(c) >= 0x80;
}

constexpr bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

/// The word for the other side, in small letters; empty if a word has no side.
inline std::string word_of_other_side(std::string_view word) {
  if (word == "clockwise") return "counterclockwise";
  if (word == "counterclockwise" || word == "anticlockwise") return "clockwise";
  constexpr std::array<std::string_view, 7> endings{"", "s", "ward", "wards", "most", "hand", "handed"};
  const bool left = word.starts_with("left");
  if (!left && !word.starts_with("right")) return {};
  const std::string_view ending = word.substr(left ? 4 : 5);
  for (const std::string_view e : endings) {
    if (ending == e) return (left ? "right" : "left") + std::string(ending);
  }
  return {};
}

/// The capitals of `like`: all, the first one, or none.
inline std::string with_capitals(std::string word, std::string_view like) {
  const bool all = like.size() > 1 && is_capital(like[0]) && is_capital(like[1]);
  for (std::size_t i = 0; i < word.size() && (all || (i == 0 && is_capital(like[0]))); ++i) {
    word[i] = static_cast<char>(word[i] - 'a' + 'A');
  }
  return word;
}

/// Words and the gaps between them, alternating, beginning with a word (perhaps an empty one).
inline std::vector<std::string_view> words_and_gaps(std::string_view text) {
  std::vector<std::string_view> out;
  for (bool word = true; !text.empty(); word = !word) {
    std::size_t n = 0;
    while (n < text.size() && in_word(text[n]) == word) ++n;
    out.push_back(text.substr(0, n));
    text.remove_prefix(n);
  }
  return out;
}

/// Words `first`, first + 2, ... of `count` in small letters as one; empty if more than a hyphen or a blank is between
/// them.
inline std::string joined_words(const std::vector<std::string_view>& pieces, std::size_t first, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < 2 * count - 1; ++i) {
    if (first + i >= pieces.size()) return {};
    const std::string_view piece = pieces[first + i];
    if (i % 2 == 1 && piece != "-" && piece != " ") return {};
    if (i % 2 == 0) {
      for (const char c : piece) out += lower(c);
    }
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::string mirror_caption(std::string_view caption) {
  const auto pieces = detail::words_and_gaps(caption);
  std::string out;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    std::size_t words = i % 2 == 0 ? 3 : 0;  // "counter clock-wise" is one word in three
    std::string other;
    for (; words > 0; --words) {
      const std::string word = detail::joined_words(pieces, i, words);
      if (words > 1 && !word.ends_with("clockwise")) continue;
      if (other = detail::word_of_other_side(word); !other.empty()) break;
    }
    if (words == 0) {
      out += pieces[i];
    } else {
      out += detail::with_capitals(other, pieces[i]);
      i += 2 * words - 2;
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
