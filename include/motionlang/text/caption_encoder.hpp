// SPDX-License-Identifier: MIT
/// A small text encoder of our own: word pieces, a transformer, one vector per caption. Below 2 MB, so that it can come
/// with a motion model and be trained together with it.
#pragma once

#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/positional_encoding.hpp>
#include <motionlang/nn/transformer_encoder.hpp>
#include <motionlang/text/text_encoder.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct CaptionEncoderConfig {
  Index width = 128;
  Index heads = 4;
  Index d_ff = 256;
  Index layers = 2;
  Index out = 128;
  double dropout = 0.1;
  Index longest = 64;  // word pieces of a caption, with begin and end
};

/// Pieces -> embedding + positions -> pre-norm transformer -> norm -> the row of [CLS] -> linear.
template <Backend B>
struct CaptionEncoder {
  Embedding<B> embedding;
  TransformerEncoder<B> encoder;
  LayerNorm<B> norm;
  Linear<B> projection;
  PositionTable<B> positions;
  WordPiece tokenizer;

  static constexpr auto fields() {
    using M = CaptionEncoder;
    return motionlang::fields("embedding", &M::embedding, "encoder", &M::encoder, "norm", &M::norm, "projection",
                              &M::projection, "positions", &M::positions, "tokenizer", &M::tokenizer);
  }
  CaptionEncoder() = default;
  CaptionEncoder(const CaptionEncoderConfig& c, WordPiece pieces, Rng auto& rng)
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
        tokenizer(std::move(pieces)) {}

  /// (texts, out)
  Tensor<B, 2> operator()(std::span<const std::string> texts, const Context& context = {}) const {
    const ModuleScope scope(*this);
    std::vector<Index> ids, lengths, first;
    for (const std::string& t : texts) {
      const auto pieces = tokenizer.encode(t, positions.rows().size(0));
      first.push_back(static_cast<Index>(ids.size()));
      ids.insert(ids.end(), pieces.begin(), pieces.end());
      lengths.push_back(static_cast<Index>(pieces.size()));
    }
    const auto tokens = add_positions(Sequences<B>(embedding(ids), Offsets(lengths)), positions.rows());
    return projection(norm(gather(encoder(tokens, context).rows, first)));
  }
  template <Backend C>
  requires std::same_as<C, B> TextFeatures<C> encode(std::span<const std::string> texts)
  const { return TextFeatures<C>::pooled((*this)(texts)); }
};

MOTIONLANG_NAMESPACE_END
