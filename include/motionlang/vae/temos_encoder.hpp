// SPDX-License-Identifier: MIT
/// The encoders of TEMOS, one class for motions and texts; TEACH and SINC use the same motion encoder.
#pragma once

#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The names of the published state dict, and the differences between motions and texts.
struct TemosMotionKeys {
  static constexpr const char* projection = "skel_embedding";
  static constexpr bool relu = false;
};
struct TemosTextKeys {
  static constexpr const char* projection = "projection.1";  // number 0 is a ReLU
  static constexpr bool relu = true;
};

///     rows = W x (texts: W max(x, 0));   [mu token, logvar token, rows] + positions -> encoder -> mu, logvar
/// Source  TEMOS (Petrovich, Black, Varol, ECCV 2022), section 3.2; thesis 4.2.2; TEMOS
///         temos/model/motionencoder/actor.py, temos/model/textencoder/distilbert_actor.py
template <Backend B, class Keys>
struct TemosEncoder {
  std::optional<Tensor<B, 1>> mu_token, logvar_token;  // of the variational encoder, (width)
  std::optional<Tensor<B, 1>> emb_token;               // of the deterministic one
  Linear<B> projection;
  TransformerEncoder<B> seqTransEncoder;
  PositionTable<B> positions;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = TemosEncoder;
    return motionlang::fields("mu_token", &M::mu_token, "logvar_token", &M::logvar_token, "emb_token", &M::emb_token,
                              Keys::projection, &M::projection, "seqTransEncoder", &M::seqTransEncoder, "positions",
                              &M::positions, "dropout_p", &M::dropout_p);
  }
  TemosEncoder() = default;
  TemosEncoder(Index nfeats, bool vae, const TransformerConfig& c, Index max_len, Rng auto& rng)
      : projection(nfeats, c.d_model, rng),
        seqTransEncoder(copied_layers<TransformerEncoder<B>>(c, rng)),
        positions(max_len, c.d_model),
        dropout_p(c.dropout) {
    auto token = [&] { return normal_init<B, 1>({c.d_model}, 1, rng); };
    if (vae) {
      mu_token = token();
      logvar_token = token();
    } else {
      emb_token = token();
    }
  }

  Sequences<B> embed(const Sequences<B>& x) const {
    return projection(Keys::relu ? x.with(activate(x.rows, Activation::relu)) : x);
  }
  /// The input of the first layer.
  Sequences<B> sequence(const Sequences<B>& x) const {
    return token_sequence(repeat_sequence(tokens(), x.count()), embed(x), positions.rows());
  }
  LatentGaussian<B> operator()(const Sequences<B>& x, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return gaussian_of_tokens(encode_tokens(seqTransEncoder, sequence(x), emb_token ? 1 : 2, dropout_p, context));
  }

 private:
  Tensor<B, 2> tokens() const {
    auto row = [](const Tensor<B, 1>& t) { return reshape<2>(t, {1, t.size(0)}); };
    return emb_token ? row(*emb_token) : concat(0, row(*mu_token), row(*logvar_token));
  }
};

template <Backend B>
using TemosMotionEncoder = TemosEncoder<B, TemosMotionKeys>;
template <Backend B>
using TemosTextEncoder = TemosEncoder<B, TemosTextKeys>;

MOTIONLANG_NAMESPACE_END
