// SPDX-License-Identifier: MIT
/// The tokens of a text for an encoder that has an embedding of its own and, if wanted, vectors of many words.
///
/// A word that is one piece is that piece. Another word with a vector is [UNK], and its vector says which word it is.
/// Every other word is split into pieces. A token has the vector of its word, or zeros.
#pragma once

#include <motionlang/core/context.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/text/word_piece.hpp>
#include <motionlang/text/word_vectors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct HeardWords {
  static constexpr Index no_vector = -1;
  std::vector<Index> ids{};      // of pieces, those of all texts
  std::vector<Index> rows{};     // of vectors, or no_vector
  std::vector<Index> lengths{};  // tokens of each text, with begin and end
};

/// At most `longest` tokens of each text. Throws config_error 101 if `longest` leaves no room for [CLS] and [SEP].
HeardWords heard_words(const WordPiece& pieces, const WordVectors& vectors, std::span<const std::string> texts,
                       Index longest);

/// For training: each word that has a vector becomes [UNK] with this chance, so that the encoder learns to do with the
/// vector alone.
void hide_words(HeardWords& words, double chance, Philox& rng);

/// (tokens, vectors.width())
template <Backend B>
Tensor<B, 2> word_rows(const HeardWords& words, const WordVectors& vectors) {
  using S = typename B::scalar;
  const auto width = static_cast<std::size_t>(vectors.width());
  std::vector<S> values(words.rows.size() * width);
  for (std::size_t i = 0; i < words.rows.size(); ++i) {
    if (words.rows[i] == HeardWords::no_vector) continue;
    const auto vector = vectors.vector(words.rows[i]);
    std::copy(vector.begin(), vector.end(), values.begin() + static_cast<std::ptrdiff_t>(i * width));
  }
  return Tensor<B, 2>::from(values, {std::ssize(words.rows), vectors.width()});
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/heard_words.ipp>
#endif
