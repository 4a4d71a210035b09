// SPDX-License-Identifier: MIT
/// Texts that no motion shows, made of words at random. A search model learns that no motion is near them, and its
/// similarities are compared with theirs.
///
///     const StrangerTexts strangers(tokenizer, vectors);
///     strangers.draw(16, rng);                              // "a person senate", "budget violin", "gomu tikasa"
#pragma once

#include <string>  // words
#include <vector>  // texts

#include <motionlang/core/rng.hpp>
#include <motionlang/text/word_piece.hpp>
#include <motionlang/text/word_vectors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class StrangerTexts {
 public:
  /// Takes the words of `vectors` that are far from all words of captions: from each piece of three letters or more,
  /// their likeness (word_likeness) is at most `most_alike`.
  explicit StrangerTexts(const WordPiece& pieces, const WordVectors& vectors = {}, double most_alike = 0.6);

  const std::vector<std::string>& words() const { return words_; }
  /// One to four words each. A third of the texts are made of words that do not exist, all of them if there are no
  /// vectors. Half of the texts begin with a person.
  std::vector<std::string> draw(Index count, Philox rng) const;
  /// The text with one or two such words put in, which do not change what it says: "walk slowly with a budget".
  std::string disturb(const std::string& text, Philox rng) const;

 private:
  std::string word(bool invented, Philox& rng) const;

  std::vector<std::string> words_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/stranger_texts.ipp>
#endif
