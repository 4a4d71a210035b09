// SPDX-License-Identifier: MIT
/// A small text encoder of our own: word pieces, a transformer, one vector per caption. It is below 2 MB, so it can be
/// part of a motion model and be trained together with it. With word vectors it also understands words that no training
/// caption contains.
#pragma once

#include <utility>  // pair

#include <motionlang/core/fields.hpp>
#include <motionlang/core/require_value.hpp>
#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/positional_encoding.hpp>
#include <motionlang/nn/transformer_encoder.hpp>
#include <motionlang/text/heard_words.hpp>
#include <motionlang/text/text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct CaptionEncoderConfig {
  Index width = 128;
  Index heads = 4;
  Index d_ff = 256;
  Index layers = 2;
  Index out = 128;
  double dropout = 0.1;
  Index longest = 64;         // word pieces of a caption, with the tokens of start and end
  double hidden_words = 0.3;  // training: probability that only the vector of a word is used, if it has one

  void require_sound() const {
    for (const auto& [name, size] : {std::pair("width", width), {"heads", heads}, {"d_ff", d_ff}, {"out", out}})
      require_value(name, size, size >= 1 && size <= 65'536, "1 to 65536");
    require_value("layers", layers, layers >= 1 && layers <= 256, "1 to 256");
    require_value("longest", longest, longest >= 3, "3 or more");
    require_value("dropout", dropout, dropout >= 0 && dropout < 1, "0 or more, and less than 1");
    require_value("hidden_words", hidden_words, hidden_words >= 0 && hidden_words <= 1, "0 to 1");
  }
  static constexpr auto fields() {
    using C = CaptionEncoderConfig;
    return motionlang::fields("width", &C::width, "heads", &C::heads, "d_ff", &C::d_ff, "layers", &C::layers, "out",
                              &C::out, "dropout", &C::dropout, "longest", &C::longest, "hidden_words",
                              &C::hidden_words);
  }
};

/// Pieces -> embedding (+ projected word vectors) + positions -> pre-norm transformer -> norm -> the row of [CLS] ->
/// linear.
template <Backend B>
struct CaptionEncoder {
  Embedding<B> embedding;
  TransformerEncoder<B> encoder;
  LayerNorm<B> norm;
  Linear<B> projection;
  std::optional<LinearMap<B>> vector_projection;  // (width, vectors.width()); none without vectors
  PositionTable<B> positions;
  WordPiece tokenizer;
  WordVectors vectors;
  double hidden_words = 0;

  static constexpr auto fields() {
    using M = CaptionEncoder;
    return motionlang::fields("embedding", &M::embedding, "encoder", &M::encoder, "norm", &M::norm, "projection",
                              &M::projection, "vector_projection", &M::vector_projection, "positions", &M::positions,
                              "tokenizer", &M::tokenizer, "vectors", &M::vectors, "hidden_words", &M::hidden_words);
  }
  CaptionEncoder() = default;
  CaptionEncoder(const CaptionEncoderConfig& c, WordPiece pieces, Rng auto& rng, WordVectors words = {})
      : embedding(pieces.size(), c.width, rng, 0.5),
        encoder({.d_model = c.width,
                 .heads = c.heads,
                 .d_ff = c.d_ff,
                 .layers = c.layers,
                 .norm_first = true,
                 .dropout = c.dropout},
                rng),
        norm(c.width),
        projection(c.width, c.out, rng),
        positions(c.longest, c.width),
        tokenizer(std::move(pieces)),
        vectors(std::move(words)),
        hidden_words(c.hidden_words) {
    if (!vectors.empty()) vector_projection.emplace(vectors.width(), c.width, rng);
  }

  /// (texts, out)
  Tensor<B, 2> operator()(std::span<const std::string> texts, const Context& context = {}) const {
    const ModuleScope scope(*this);
    HeardWords words = heard_words(tokenizer, vectors, texts, positions.rows().size(0));
    if (context.dropout && vector_projection) {
      auto rng = context.next_mask();
      hide_words(words, hidden_words, rng);
    }
    auto rows = embedding(words.ids);
    if (vector_projection) rows = rows + (*vector_projection)(word_rows<B>(words, vectors));
    const Offsets offsets(words.lengths);
    std::vector<Index> first;
    for (Index s = 0; s < offsets.count(); ++s) first.push_back(offsets.begin(s));
    const auto tokens = add_positions(Sequences<B>(std::move(rows), offsets), positions.rows());
    return projection(norm(gather(encoder(tokens, context).rows, first)));
  }
  template <Backend C>
  requires std::same_as<C, B> TextFeatures<C> encode(std::span<const std::string> texts)
  const { return TextFeatures<C>::pooled((*this)(texts)); }
};

MOTIONLANG_NAMESPACE_END
