// SPDX-License-Identifier: MIT
/// The common part of the text encoders of TEACH and SINC: a sequence of several parts, separated by a learned token.
///
///     [mu token, logvar token, part, separation token, part, ...] -> encoder -> mu, logvar
#pragma once

#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Learned tokens, projection and transformer, under the names of the published state dicts (the systems spell the
/// third token differently). Unlike TEMOS' encoder it has no positions over the whole sequence: parts that need
/// positions get their own (`placed`).
/// Source  thesis A.2.2, B.3.3; TEACH teach/model/textencoder/text_hist.py, SINC sinc/model/textencoder/text_space.py
template <Backend B, class Keys>
struct PartedTextEncoder {
  Tensor<B, 1> mu_token, logvar_token, separation_token;  // (width)
  Linear<B> projection;
  TransformerEncoder<B> seqTransEncoder;
  PositionTable<B> positions;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = PartedTextEncoder;
    return motionlang::fields("mu_token", &M::mu_token, "logvar_token", &M::logvar_token, Keys::separation_token,
                              &M::separation_token, "projection.1", &M::projection, "seqTransEncoder",
                              &M::seqTransEncoder, "positions", &M::positions, "dropout_p", &M::dropout_p);
  }
  PartedTextEncoder() = default;
  PartedTextEncoder(Index text_dim, const TransformerConfig& c, Index max_len, Rng auto& rng)
      : mu_token(normal_init<B, 1>({c.d_model}, 1, rng)),
        logvar_token(normal_init<B, 1>({c.d_model}, 1, rng)),
        separation_token(normal_init<B, 1>({c.d_model}, 1, rng)),
        projection(text_dim, c.d_model, rng),
        seqTransEncoder(copied_layers<TransformerEncoder<B>>(c, rng)),
        positions(max_len, c.d_model),
        dropout_p(c.dropout) {}

  /// The tokens that start a sequence, (2, width).
  Tensor<B, 2> beginning() const { return concat(0, row(mu_token), row(logvar_token)); }
  /// The token between two parts, (1, width).
  Tensor<B, 2> separation() const { return row(separation_token); }
  ///     W max(states, 0)
  Sequences<B> projected(const Sequences<B>& states) const {
    return projection(states.with(activate(states.rows, Activation::relu)));
  }
  /// A part with positions that count from its own first row.
  Sequences<B> placed(const Sequences<B>& part, const Context& context = {}) const {
    const auto x = add_positions(part, positions.rows());
    return x.with(dropout(x.rows, dropout_p, context));
  }
  /// `sequence` begins with the tokens of mu and logvar.
  LatentGaussian<B> encode(const Sequences<B>& sequence, const Context& context = {}) const {
    return gaussian_of_tokens(encode_tokens(seqTransEncoder, sequence, 2, 0, context));
  }

 private:
  static Tensor<B, 2> row(const Tensor<B, 1>& t) { return reshape<2>(t, {1, t.size(0)}); }
};

MOTIONLANG_NAMESPACE_END
