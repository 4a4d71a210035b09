// SPDX-License-Identifier: MIT
/// The recurrent encoder and decoder with which TEMOS is compared (thesis table 4.3, first row).
#pragma once

#include <motionlang/nn/gru.hpp>
#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     h = GRU(W x);   mu and logvar from the last frame's h
/// Source  thesis 4.3.3, table 4.3; TEMOS temos/model/motionencoder/gru.py
template <Backend B>
struct TemosGruEncoder {
  Linear<B> skel_embedding;
  Gru<B> gru;
  std::optional<Linear<B>> mu, logvar;  // of the variational encoder
  std::optional<Linear<B>> final;       // of the deterministic one

  static constexpr auto fields() {
    using M = TemosGruEncoder;
    return motionlang::fields("skel_embedding", &M::skel_embedding, "gru", &M::gru, "mu", &M::mu, "logvar", &M::logvar,
                              "final", &M::final);
  }
  static std::string official_key(const std::string& path) { return gru_key(path); }

  TemosGruEncoder() = default;
  TemosGruEncoder(Index nfeats, bool vae, Index width, Index layers, Rng auto& rng)
      : skel_embedding(nfeats, width, rng), gru(width, width, layers, rng) {
    if (vae) {
      mu.emplace(width, width, rng);
      logvar.emplace(width, width, rng);
    } else {
      final.emplace(width, width, rng);
    }
  }
  /// Throws shape_error 203 for a sequence without frames.
  LatentGaussian<B> operator()(const Sequences<B>& x, const Context& = {}) const {
    const ModuleScope scope(*this);
    const auto last = last_row(gru(skel_embedding(x)));
    if (final) return {(*final)(last), {}};
    return {(*mu)(last), (*logvar)(last)};
  }
};

///     h = GRU(W [z, t / (length - 1)]);   frame t = V h_t
/// Source   thesis 4.3.3, table 4.3; TEMOS temos/model/motiondecoder/gru.py
/// Differs  for a single frame: its time is 0, where the published code divides by 0
template <Backend B>
struct TemosGruDecoder {
  Linear<B> emb_layer;
  Gru<B> gru;
  Linear<B> final_layer;

  static constexpr auto fields() {
    using M = TemosGruDecoder;
    return motionlang::fields("emb_layer", &M::emb_layer, "gru", &M::gru, "final_layer", &M::final_layer);
  }
  static std::string official_key(const std::string& path) { return gru_key(path); }

  TemosGruDecoder() = default;
  TemosGruDecoder(Index nfeats, Index width, Index layers, Rng auto& rng)
      : emb_layer(width + 1, width, rng), gru(width, width, layers, rng), final_layer(width, nfeats, rng) {}

  /// z (sequences, width)
  Sequences<B> operator()(const Tensor<B, 2>& z, const Offsets& lengths, const Context& = {}) const {
    const ModuleScope scope(*this);
    const auto rows = concat(1, repeat_for_rows(z, lengths), relative_time<B>(lengths));
    return final_layer(gru(emb_layer(Sequences<B>(rows, lengths))));
  }
};

MOTIONLANG_NAMESPACE_END
