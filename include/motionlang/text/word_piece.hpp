// SPDX-License-Identifier: MIT
/// A small word-piece tokenizer that learns its vocabulary from the captions of a training set.
///
/// It is for plain captions: ASCII letters are lower-cased, and characters that are neither letters nor digits separate
/// words. Other headers have the tokenizers of BERT and CLIP, with their Unicode rules.
#pragma once

#include <memory>       // piece -> id
#include <optional>     // words of several pieces
#include <span>         // texts
#include <string>       // pieces
#include <string_view>  // lookups
#include <vector>       // pieces

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
struct WordPieceIds;
}  // namespace detail

/// Pieces that continue a word begin with "##". The first three ids are fixed.
class WordPiece {
 public:
  static constexpr bool is_option = true;  // holds no tensors
  static constexpr Index begin_id = 0, end_id = 1, unknown_id = 2;

  WordPiece() = default;
  /// Throws config_error 107 unless the vocabulary begins with [CLS], [SEP], [UNK] and has no duplicate piece. Messages
  /// name `source`.
  explicit WordPiece(std::vector<std::string> vocabulary, std::string_view source = "WordPiece");

  /// Learns a vocabulary: all letters, then the merges with the largest count(ab) / (count(a) count(b)) that occur at
  /// least `least` times, up to `size` pieces. Among equals the alphabetically first wins.
  /// Source  the WordPiece criterion as described for BERT (Schuster and Nakajima 2012)
  static WordPiece learn(std::span<const std::string> texts, Index size, Index least = 2);

  /// All letters and digits of the texts, and each word that they say at least `least` times. Encoders with vectors of
  /// words (text/word_vectors.hpp) know the other words by those.
  static WordPiece of_words(std::span<const std::string> texts, Index least = 2);

  const std::vector<std::string>& vocabulary() const { return pieces_; }
  Index size() const { return static_cast<Index>(pieces_.size()); }

  /// [CLS] pieces [SEP], at most `longest` ids. Every word is split greedily into the longest known pieces; a word that
  /// cannot be split is [UNK]. Throws config_error 101 if `longest` leaves no room for [CLS] and [SEP].
  std::vector<Index> encode(std::string_view text, Index longest = 64) const;

  /// The id of a word that is one piece.
  std::optional<Index> find(const std::string& word) const;
  /// Adds the pieces of a word to ids.
  void append_word(std::vector<Index>& ids, const std::string& word) const;

  /// Lower-case runs of letters and digits.
  static std::vector<std::string> words(std::string_view text);

 private:
  std::vector<std::string> pieces_;
  std::shared_ptr<const detail::WordPieceIds> ids_;  // of the pieces; copies share it
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/word_piece.ipp>
#endif
