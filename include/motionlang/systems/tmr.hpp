// SPDX-License-Identifier: MIT
/// TMR: texts and motions in one space, so that one finds the other. This header assembles it from vae/ and
/// nn/sequence_vae.hpp.
///
///     const auto text = tmr.encode_text(states).mu, motion = tmr.encode_motion(features).mu;
///     const auto similarity = cosine_similarity(text, motion);        // (texts, motions), for ranks
///     const auto score = tmr_score(similarity);                       // in [0, 1], for people
///
/// Source  Petrovich, Black, Varol: "TMR: Text-to-motion retrieval using contrastive 3D human motion synthesis" (ICCV
///         2023); thesis, chapter 5. It also covers TEMOS in the form of TMR's repository: losses without the
///         contrastive term
#pragma once

#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/vae/text_motion.hpp>
#include <motionlang/vae/tmr_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Published sizes (16,130,823 parameters).
struct TmrConfig {
  static constexpr bool is_option = true;  // holds no tensors
  Index motion_nfeats = 263, text_nfeats = 768;
  Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  Index text_layers = 0, text_heads = 0;  // of the text encoder; 0: as many
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  bool vae = true;
  Index max_len = 5000;
  bool operator==(const TmrConfig&) const = default;
};

/// The names are those of the published checkpoints.
template <Backend B>
struct Tmr {
  TmrEncoder<B> motion_encoder, text_encoder;
  SequenceDecoder<B> motion_decoder;
  TmrConfig config;

  static constexpr auto fields() {
    using M = Tmr;
    return motionlang::fields("motion_encoder", &M::motion_encoder, "text_encoder", &M::text_encoder, "motion_decoder",
                              &M::motion_decoder, "config", &M::config);
  }
  Tmr() = default;
  Tmr(const TmrConfig& c, Rng auto& rng)
      : motion_encoder(c.motion_nfeats, c.vae, transformer_of(c), c.max_len, rng),
        text_encoder(c.text_nfeats, c.vae, text_transformer_of(c), c.max_len, rng),
        motion_decoder(c.motion_nfeats, transformer_of(c), c.max_len, rng),
        config(c) {}

  /// tokens: the last states of the language model, with those of [CLS] and [SEP].
  LatentGaussian<B> encode_text(const Sequences<B>& tokens, const Context& context = {}) const {
    return text_encoder(tokens, context);
  }
  /// motion: normalised features.
  LatentGaussian<B> encode_motion(const Sequences<B>& motion, const Context& context = {}) const {
    return motion_encoder(motion, context);
  }
  /// Encodes either; the width decides which. Throws config_error 101 if both modalities have it, shape_error 204 if
  /// none has.
  LatentGaussian<B> encode(const Sequences<B>& x, const Context& context = {}) const {
    const Index motion = config.motion_nfeats, text = config.text_nfeats;
    if (motion == text) raise<config_error>(101, "Tmr: motions and texts are both ", text, " wide: say which is meant");
    if (x.width() != motion && x.width() != text)
      raise<shape_error>(204, "Tmr: features ", x.rows.shape(), "; motions are ", motion, " wide, texts ", text);
    return x.width() == motion ? encode_motion(x, context) : encode_text(x, context);
  }
  /// z (motions, latent) -> normalised features
  Sequences<B> decode(const Tensor<B, 2>& z, const Offsets& lengths, const Context& context = {}) const {
    return motion_decoder(z, lengths, context);
  }
  /// Both branches of a training step, for tmr_losses. Without `reconstruct` nothing is decoded (thesis table 5.3).
  TextMotionBranches<B> branches(const Sequences<B>& tokens, const Sequences<B>& motion,
                                 const TextMotionNoise<B>& noise, const Context& context = {},
                                 bool reconstruct = true) const {
    auto branch = [&](LatentGaussian<B> g, const Tensor<B, 2>& eps) {
      LatentBranch<B> out{std::move(g), {}};
      out.z = out.distribution.sample(eps, noise.fact);
      if (reconstruct) out.frames = decode(out.z, motion.offsets, context).rows;
      return out;
    };
    return {branch(encode_text(tokens, context), noise.text), branch(encode_motion(motion, context), noise.motion)};
  }
};

/// cos / 2 + 1/2, in [0, 1].
template <Backend B>
Tensor<B, 2> tmr_score(const Tensor<B, 2>& similarity) {
  return similarity * 0.5 + 0.5;
}

/// Normalised features of one motion, (frames, 263), to 22 joints: metres, Z up, 20 frames per second.
template <Backend B>
std::vector<Vec3<typename B::scalar>> tmr_joints(const Normalizer<B>& normalizer, const Tensor<B, 2>& features) {
  const auto rows = normalizer.denormalize(features);
  auto joints = guoh3d_joints(rows.span());
  for (auto& p : joints) p = {p.x, -p.z, p.y};
  return joints;
}

MOTIONLANG_NAMESPACE_END
