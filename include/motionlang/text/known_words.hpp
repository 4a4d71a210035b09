// SPDX-License-Identifier: MIT
/// The words that a model learned its texts from, and the words of a text that are not among them. A motion of unknown
/// words looks as good as others, but is of something else.
///
///     const auto known = known_words(SafetensorsFile::open("stmc_free.safetensors").metadata());
///     for (const UnknownWord& w : unknown_words("Walk forwad", known))
///       std::cout << w.word << ", like " << w.like << '\n';                           // forwad, like forward
#pragma once

#include <map>          // metadata
#include <span>         // captions
#include <string>       // words
#include <string_view>  // texts
#include <vector>       // words

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Where the metadata of weights list the words.
inline constexpr const char* known_words_entry = "text.words";

/// Each word of the captions once, for the metadata: in alphabetical order, one on each line.
std::string listed_words(std::span<const std::string> captions);

/// Those of the metadata of weights; none where these do not list them.
std::vector<std::string> known_words(const std::map<std::string, std::string>& metadata);

/// A word that a model does not know.
struct UnknownWord {
  std::string word{}, like{};  // like: a known word that differs in a third of its letters at most, or ""
};
/// Each of them once, in the order of the text. None if no words are known.
std::vector<UnknownWord> unknown_words(std::string_view text, const std::vector<std::string>& known);

/// The words of a text with letters or digits beyond a-z and 0-9, which our tokenizer passes over.
std::vector<std::string> unreadable_words(std::string_view text);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/known_words.ipp>
#endif
