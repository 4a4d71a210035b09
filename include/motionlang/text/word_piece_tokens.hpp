// SPDX-License-Identifier: MIT
/// Word pieces as token vectors: a small vocabulary and a table that is trained together with the model. In TEMOS and
/// TMR it replaces the last states of DistilBERT; their own transformer then reads the pieces.
///
///     WordPieceTokens<B> tokens(WordPiece::learn(captions, 800), 128, rng);
///     const auto latent = tmr.encode_text(tokens(captions).tokens);
///
/// With vectors of words it also hears words that no training text contains, as text/caption_encoder.hpp does.
#pragma once

#include <optional>  // no vectors

#include <motionlang/nn/embedding.hpp>
#include <motionlang/text/heard_words.hpp>
#include <motionlang/text/text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct WordPieceTokens {
  static constexpr Index longest = 64;  // pieces of a text, with those of start and end

  Embedding<B> embedding;                         // (pieces, width)
  std::optional<LinearMap<B>> vector_projection;  // (width, vectors.width()); none without vectors
  WordPiece tokenizer;
  WordVectors vectors;
  double hidden_words = 0;  // training: probability that only the vector of a word is used, if it has one

  static constexpr auto fields() {
    using M = WordPieceTokens;
    return motionlang::fields("embedding", &M::embedding, "vector_projection", &M::vector_projection, "tokenizer",
                              &M::tokenizer, "vectors", &M::vectors, "hidden_words", &M::hidden_words);
  }
  WordPieceTokens() = default;
  WordPieceTokens(WordPiece pieces, Index width, Rng auto& rng, WordVectors words = {}, double hidden = 0)
      : embedding(pieces.size(), width, rng, words.empty() ? 1 : 0.5),
        tokenizer(std::move(pieces)),
        vectors(std::move(words)),
        hidden_words(hidden) {
    if (!vectors.empty()) vector_projection.emplace(vectors.width(), width, rng);
  }

  Index width() const { return embedding.weight.size(1); }

  /// A row for every piece, including those of start and end.
  TextFeatures<B> operator()(std::span<const std::string> texts, const Context& context = {}) const {
    const ModuleScope scope(*this);
    HeardWords words = heard_words(tokenizer, vectors, texts, longest);
    if (context.dropout && vector_projection) {
      auto rng = context.next_mask();
      hide_words(words, hidden_words, rng);
    }
    auto rows = embedding(words.ids);
    if (vector_projection) rows = rows + (*vector_projection)(word_rows<B>(words, vectors));
    return {{std::move(rows), Offsets(std::span<const Index>(words.lengths))}};
  }
  template <Backend C>
  requires std::same_as<C, B> TextFeatures<C> encode(std::span<const std::string> texts)
  const { return (*this)(texts); }
};

MOTIONLANG_NAMESPACE_END
