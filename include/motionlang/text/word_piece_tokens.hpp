// SPDX-License-Identifier: MIT
/// Word pieces as token vectors: a small vocabulary and a table that is trained together with the model. In TEMOS and
/// TMR it replaces the last states of DistilBERT; their own transformer then reads the pieces.
///
///     WordPieceTokens<B> tokens(WordPiece::learn(captions, 800), 128, rng);
///     const auto latent = tmr.encode_text(tokens(captions).tokens);
#pragma once

#include <motionlang/nn/embedding.hpp>
#include <motionlang/text/text_encoder.hpp>
#include <motionlang/text/tokenizer.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct WordPieceTokens {
  Embedding<B> embedding;  // (pieces, width)
  WordPiece tokenizer;

  static constexpr auto fields() {
    using M = WordPieceTokens;
    return motionlang::fields("embedding", &M::embedding, "tokenizer", &M::tokenizer);
  }
  WordPieceTokens() = default;
  WordPieceTokens(WordPiece pieces, Index width, Rng auto& rng)
      : embedding(pieces.size(), width, rng), tokenizer(std::move(pieces)) {}

  Index width() const { return embedding.weight.size(1); }

  /// A row for every piece, including those of start and end.
  TextFeatures<B> operator()(std::span<const std::string> texts) const {
    const ModuleScope scope(*this);
    const TokenBatch batch = tokenize(tokenizer, texts);
    return {{embedding(batch.ids), Offsets(std::span<const Index>(batch.lengths))}};
  }
  template <Backend C>
  requires std::same_as<C, B> TextFeatures<C> encode(std::span<const std::string> texts)
  const { return (*this)(texts); }
};

MOTIONLANG_NAMESPACE_END
