// SPDX-License-Identifier: MIT
/// ACTOR's encoder, and the encoder without tokens with which it is compared.
#pragma once

#include <algorithm>  // max

#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     [muQuery[y], sigmaQuery[y], W frames] + positions -> encoder -> rows 0 and 1 are mu and logvar
/// Source  thesis 3.2.1, "Encoder"; ACTOR (ICCV 2021) src/models/architectures/transformer.py Encoder_TRANSFORMER
template <Backend B>
struct ActorEncoder {
  Tensor<B, 2> muQuery, sigmaQuery;  // (classes, width)
  Linear<B> skelEmbedding;
  TransformerEncoder<B> seqTransEncoder;
  PositionTable<B> positions;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = ActorEncoder;
    return motionlang::fields("muQuery", &M::muQuery, "sigmaQuery", &M::sigmaQuery, "skelEmbedding", &M::skelEmbedding,
                              "seqTransEncoder", &M::seqTransEncoder, "positions", &M::positions, "dropout_p",
                              &M::dropout_p);
  }
  ActorEncoder() = default;
  ActorEncoder(Index nfeats, Index classes, const TransformerConfig& c, Index max_len, Rng auto& rng)
      : muQuery(normal_init<B, 2>({classes, c.d_model}, 1, rng)),
        sigmaQuery(normal_init<B, 2>({classes, c.d_model}, 1, rng)),
        skelEmbedding(nfeats, c.d_model, rng),
        seqTransEncoder(copied_layers<TransformerEncoder<B>>(c, rng)),
        positions(max_len, c.d_model),
        dropout_p(c.dropout) {}

  /// The input of the first layer.
  /// Throws shape_error 203 for a label that is not a class, 204 unless there is one label for each motion.
  Sequences<B> sequence(const Sequences<B>& x, std::span<const Index> labels) const {
    auto token = [&](const Tensor<B, 2>& of_class) {
      return Sequences<B>(gather(of_class, labels), Offsets::equal(std::ssize(labels), 1));
    };
    return token_sequence(concat_tokens(token(muQuery), token(sigmaQuery)), skelEmbedding(x), positions.rows());
  }
  LatentGaussian<B> operator()(const Sequences<B>& x, std::span<const Index> labels,
                               const Context& context = {}) const {
    const ModuleScope scope(*this);
    return gaussian_of_tokens(encode_tokens(seqTransEncoder, sequence(x, labels), 2, dropout_p, context));
  }
};

///     W frames + positions -> encoder -> mean over the frames -> mu and logvar by a linear layer each
/// Source  thesis 3.3.2, table 3.4 b; ACTOR src/models/architectures/transformer.py, ablation "average_encoder"
/// The mean includes padding, as published: frames of zeros up to the longest motion of the batch, which attend to the
/// real ones. So the latent of a short motion depends on the motions that are encoded with it.
template <Backend B>
struct ActorAverageEncoder {
  Linear<B> mu_layer, sigma_layer, skelEmbedding;
  TransformerEncoder<B> seqTransEncoder;
  PositionTable<B> positions;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = ActorAverageEncoder;
    return motionlang::fields("mu_layer", &M::mu_layer, "sigma_layer", &M::sigma_layer, "skelEmbedding",
                              &M::skelEmbedding, "seqTransEncoder", &M::seqTransEncoder, "positions", &M::positions,
                              "dropout_p", &M::dropout_p);
  }
  ActorAverageEncoder() = default;
  ActorAverageEncoder(Index nfeats, const TransformerConfig& c, Index max_len, Rng auto& rng)
      : mu_layer(c.d_model, c.d_model, rng),
        sigma_layer(c.d_model, c.d_model, rng),
        skelEmbedding(nfeats, c.d_model, rng),
        seqTransEncoder(copied_layers<TransformerEncoder<B>>(c, rng)),
        positions(max_len, c.d_model),
        dropout_p(c.dropout) {}

  Sequences<B> sequence(const Sequences<B>& x) const { return add_positions(skelEmbedding(x), positions.rows()); }

  /// padded_frames  of the batch, if it is padded beyond its longest motion, because padding counts. Throws shape_error
  ///                203 for more frames than positions
  LatentGaussian<B> operator()(const Sequences<B>& x, const Context& context = {}, Index padded_frames = 0) const {
    const ModuleScope scope(*this);
    auto dropped = [&](const Sequences<B>& s) { return s.with(dropout(s.rows, dropout_p, context)); };
    const Index longest = std::max(padded_frames, x.offsets.longest());
    auto frames = dropped(sequence(x)), padding = dropped(padding_of(x.offsets, longest));
    for (const auto& layer : seqTransEncoder.layers) {
      const auto next = frames.with(layer(frames.rows, frames.offsets, context));
      if (padding.offsets.rows() > 0) padding = detail::layer_of_readers(layer, padding, frames, context);
      frames = next;
    }
    auto total = [](const Sequences<B>& s) { return scatter_add(s.rows, sequence_of_row(s.offsets), s.count()); };
    const auto mean = (total(frames) + total(padding)) / static_cast<double>(longest);
    return {mu_layer(mean), sigma_layer(mean)};
  }

 private:
  /// Embedded frames of zeros at the positions after the end of each sequence, up to `longest`.
  Sequences<B> padding_of(const Offsets& offsets, Index longest) const {
    detail::require_positions("ActorAverageEncoder", positions.rows(), longest);
    PoolVector<Index> at, lengths;
    for (Index s = 0; s < offsets.count(); ++s) {
      for (Index t = offsets.length(s); t < longest; ++t) at.push_back(t);
      lengths.push_back(longest - offsets.length(s));
    }
    return {gather(positions.rows(), at) + skelEmbedding.bias, Offsets(std::span<const Index>(lengths))};
  }
};

MOTIONLANG_NAMESPACE_END
