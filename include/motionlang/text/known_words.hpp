// SPDX-License-Identifier: MIT
/// The words of a model's training texts, and the words of a text that are not among them. A motion for unknown words
/// looks as good as others, but does not show those words.
///
///     const KnownWords known(known_words(SafetensorsFile::open("stmc_free.safetensors").metadata()));
///     for (const UnknownWord& w : unknown_words("Walk forwad", known))
///       std::cout << w.word << ", like " << w.like << '\n';                           // forwad, like forward
#pragma once

#include <map>          // metadata
#include <memory>       // copies share the words
#include <span>         // captions
#include <string>       // words
#include <string_view>  // texts
#include <vector>       // words

#include <motionlang/core/error.hpp>
#include <motionlang/text/word_vectors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The entry of the words in the metadata of weights.
inline constexpr const char* known_words_entry = "text.words";

/// All words of the captions for the metadata: without duplicates, in alphabetical order, one on each line.
std::string listed_words(std::span<const std::string> captions);

/// The words in the metadata of weights. None if they are not listed.
std::vector<std::string> known_words(const std::map<std::string, std::string>& metadata);

/// The words that a model knows: those of its training texts, and those with a vector. Copies share them.
class KnownWords {
 public:
  /// Nothing is known about the words of the model.
  KnownWords() = default;
  explicit KnownWords(std::vector<std::string> listed, WordVectors vectors = {});

  /// True if no training texts are listed. Nothing can be said about words then.
  bool empty() const { return !listed_; }
  /// True for a word in lower case that the training texts say, or that has a vector in one of its forms.
  bool knows(const std::string& word) const;
  /// A word of the training texts that differs in at most a third of its letters; "" if there is none.
  std::string like(const std::string& word) const;

 private:
  std::shared_ptr<const std::vector<std::string>> listed_{};  // sorted
  WordVectors vectors_{};
};

/// A word that a model does not know.
struct UnknownWord {
  std::string word{}, like{};  // like: KnownWords::like
};
/// All of them without duplicates, in the order of the text. None if no words are known.
std::vector<UnknownWord> unknown_words(std::string_view text, const KnownWords& known);

/// The words of a text with letters or digits beyond a-z and 0-9, which our tokenizer skips.
std::vector<std::string> unreadable_words(std::string_view text);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/known_words.ipp>
#endif
