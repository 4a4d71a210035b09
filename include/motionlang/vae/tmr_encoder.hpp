// SPDX-License-Identifier: MIT
/// The encoder of TMR, the same for motions and texts.
#pragma once

#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     [tokens, W x] + positions -> encoder -> mu, logvar
/// Source   TMR (Petrovich, Black, Varol, ICCV 2023), section 3.2; thesis 5.2.2; TMR src/model/actor.py
///          ACTORStyleEncoder
/// Differs  from TEMOS: both tokens are one parameter, and texts pass through no ReLU
template <Backend B>
struct TmrEncoder {
  Tensor<B, 2> tokens;  // (2, width), or (1, width) for a deterministic latent
  Linear<B> projection;
  TransformerEncoder<B> seqTransEncoder;
  PositionTable<B> positions;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = TmrEncoder;
    return motionlang::fields("tokens", &M::tokens, "projection", &M::projection, "seqTransEncoder",
                              &M::seqTransEncoder, "positions", &M::positions, "dropout_p", &M::dropout_p);
  }
  TmrEncoder() = default;
  TmrEncoder(Index nfeats, bool vae, const TransformerConfig& c, Index max_len, Rng auto& rng)
      : tokens(normal_init<B, 2>({vae ? 2 : 1, c.d_model}, 1, rng)),
        projection(nfeats, c.d_model, rng),
        seqTransEncoder(copied_layers<TransformerEncoder<B>>(c, rng)),
        positions(max_len, c.d_model),
        dropout_p(c.dropout) {}

  /// The input of the first layer.
  Sequences<B> sequence(const Sequences<B>& x) const {
    return token_sequence(repeat_sequence(tokens, x.count()), projection(x), positions.rows());
  }
  LatentGaussian<B> operator()(const Sequences<B>& x, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return gaussian_of_tokens(encode_tokens(seqTransEncoder, sequence(x), tokens.size(0), dropout_p, context));
  }
};

MOTIONLANG_NAMESPACE_END
