// The words that a model of ours learned its texts from, as its weights list them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <motionlang/core/utf8.hpp>
#include <motionlang/file/key_report.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/text/unicode.hpp>
#include <motionlang/text/word_piece.hpp>

namespace program {

namespace ml = motionlang;

/// Where the metadata of weights list them.
inline constexpr const char* known_words_entry = "text.words";

/// Each word of the captions once, for the metadata: in alphabetical order, one a line.
inline std::string listed_words(std::span<const std::string> captions) {
  std::set<std::string> words;
  for (const std::string& c : captions) {
    for (std::string& w : ml::WordPiece::words(c)) words.insert(std::move(w));
  }
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : "\n") + w;
  return out;
}

/// Those of a file of weights; none where it does not list them.
inline std::vector<std::string> known_words(const std::filesystem::path& model) {
  const auto file = ml::SafetensorsFile::open(model);
  const auto found = file.metadata().find(known_words_entry);
  return found == file.metadata().end() ? std::vector<std::string>() : ml::WordPiece::words(found->second);
}

/// A known word that differs in a third of its letters at most; "" if there is none.
inline std::string near_word(const std::string& word, const std::vector<std::string>& known) {
  const std::string like = ml::nearest_name(word, known);
  return 3 * ml::edit_distance(word, like, word.size()) <= word.size() ? like : "";
}

/// The words of a text with letters or digits beyond a-z and 0-9, which our tokenizer passes over.
inline std::vector<std::string> unreadable_words(std::string_view text) {
  std::vector<std::string> out;
  ml::for_each_word(text, [&](std::string_view word) {
    bool readable = true;
    for (std::size_t at = 0; at < word.size();) {
      const char32_t c = ml::decode_utf8(word, at);
      readable &= c < 0x80 || (ml::char_class(c) & (ml::CharClass::letter | ml::CharClass::number)) == 0;
    }
    if (!readable) out.emplace_back(word);
  });
  return out;
}

/// A line about the words of a text that the model does not know; "" if it knows all, or does not list any.
/// Their pieces make a motion as well, which looks as good as others but is of something else.
inline std::string told_unknown_words(const std::string& text, const std::vector<std::string>& known) {
  if (known.empty() || text.empty()) return "";
  const auto words = ml::WordPiece::words(text);
  if (words.empty()) return "'" + text + "': the model reads no word of it; it knows those of a-z and 0-9\n";
  std::string unreadable;
  for (const std::string& word : unreadable_words(text)) unreadable += (unreadable.empty() ? "'" : ", '") + word + "'";
  if (!unreadable.empty()) unreadable = "'" + text + "': the model reads a-z and 0-9, not all of " + unreadable + "\n";
  std::set<std::string> unknown;
  std::string list;
  for (const std::string& word : words) {
    if (std::ranges::find(known, word) != known.end() || !unknown.insert(word).second) continue;
    const std::string like = near_word(word, known);
    list += (list.empty() ? "'" : ", '") + word + "'" + (like.empty() ? "" : " (did you mean '" + like + "'?)");
  }
  if (list.empty()) return unreadable;
  return unreadable + "'" + text + "': the model never learned the word" + (unknown.size() == 1 ? " " : "s ") + list +
         "\n";
}

}  // namespace program
