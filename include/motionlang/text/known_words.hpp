// SPDX-License-Identifier: MIT
/// The words of a model's training texts, and the words of a text that are not among them. A motion for unknown words
/// looks as good as others, but does not show those words.
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

/// The entry of the words in the metadata of weights.
inline constexpr const char* known_words_entry = "text.words";

/// All words of the captions for the metadata: without duplicates, in alphabetical order, one on each line.
std::string listed_words(std::span<const std::string> captions);

/// The words in the metadata of weights. None if they are not listed.
std::vector<std::string> known_words(const std::map<std::string, std::string>& metadata);

/// A word that a model does not know.
struct UnknownWord {
  std::string word{}, like{};  // like: a known word that differs in at most a third of its letters, or ""
};
/// All of them without duplicates, in the order of the text. None if no words are known.
std::vector<UnknownWord> unknown_words(std::string_view text, const std::vector<std::string>& known);

/// The words of a text with letters or digits beyond a-z and 0-9, which our tokenizer skips.
std::vector<std::string> unreadable_words(std::string_view text);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/known_words.ipp>
#endif
