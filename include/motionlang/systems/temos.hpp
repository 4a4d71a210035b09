// SPDX-License-Identifier: MIT
/// TEMOS: diverse motions from a text. This header assembles it from vae/ and nn/sequence_vae.hpp.
///
///     const Sequences<B> states = distilbert(tokenize(tokenizer, texts)).tokens;              // text/bert.hpp
///     const auto motions = text_to_motion(temos, states, Offsets{60}, Philox{.seed = 7}, 10);  // ten for each text
///     const auto joints = temos_joints(normalizer, motions[0][0]);
///
/// Source  Petrovich, Black, Varol: "TEMOS: Generating diverse human motions from textual descriptions" (ECCV 2022);
///         thesis, chapter 4
#pragma once

#include <motionlang/features/normalizer.hpp>
#include <motionlang/features/rifke.hpp>
#include <motionlang/features/smplvelp.hpp>
#include <motionlang/vae/temos_encoder.hpp>
#include <motionlang/vae/temos_gru.hpp>
#include <motionlang/vae/text_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class TemosNetwork { transformer, gru, none };  // none: no motion encoder (thesis table 4.3)

/// Published sizes.
struct TemosConfig {
  static constexpr bool is_option = true;  // holds no tensors
  Index nfeats = 64;                       // 135 for SMPL
  Index text_dim = 768;
  Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  Index text_layers = 0, text_heads = 0;  // of the text encoder; 0: as many
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  bool vae = true;
  TemosNetwork motion_encoder = TemosNetwork::transformer, motion_decoder = TemosNetwork::transformer;
  Index max_len = 5000;
  bool operator==(const TemosConfig&) const = default;
};

/// The names are those of the published checkpoints, which also contain DistilBERT (textencoder.text_model.*, frozen,
/// read separately), tables of positions and sums of losses.
template <Backend B>
struct Temos {
  TemosTextEncoder<B> textencoder;
  std::optional<TemosMotionEncoder<B>> motionencoder;
  std::optional<TemosGruEncoder<B>> gru_encoder;
  std::optional<SequenceDecoder<B>> motiondecoder;
  std::optional<TemosGruDecoder<B>> gru_decoder;
  TemosConfig config;

  static constexpr auto fields() {
    using M = Temos;
    return motionlang::fields("textencoder", &M::textencoder, "motionencoder", &M::motionencoder, "motionencoder",
                              &M::gru_encoder, "motiondecoder", &M::motiondecoder, "motiondecoder", &M::gru_decoder,
                              "config", &M::config);
  }
  static std::string official_key(const std::string& path) { return gru_key(path); }

  Temos() = default;
  /// Throws config_error 101 for a model without decoder.
  Temos(const TemosConfig& c, Rng auto& rng)
      : textencoder(c.text_dim, c.vae, text_transformer_of(c), c.max_len, rng), config(c) {
    if (c.motion_encoder == TemosNetwork::transformer)
      motionencoder.emplace(c.nfeats, c.vae, transformer_of(c), c.max_len, rng);
    if (c.motion_encoder == TemosNetwork::gru) gru_encoder.emplace(c.nfeats, c.vae, c.latent_dim, c.num_layers, rng);
    if (c.motion_decoder == TemosNetwork::none) raise<config_error>(101, "Temos: a model needs a motion decoder");
    if (c.motion_decoder == TemosNetwork::gru)
      gru_decoder.emplace(c.nfeats, c.latent_dim, c.num_layers, rng);
    else
      motiondecoder.emplace(c.nfeats, transformer_of(c), c.max_len, rng);
  }

  bool has_motion_encoder() const { return config.motion_encoder != TemosNetwork::none; }

  /// tokens: the last states of the language model, with those of [CLS] and [SEP].
  LatentGaussian<B> encode_text(const Sequences<B>& tokens, const Context& context = {}) const {
    return textencoder(tokens, context);
  }
  /// motion: normalised features. Throws config_error 101 if the model has no motion encoder.
  LatentGaussian<B> encode_motion(const Sequences<B>& motion, const Context& context = {}) const {
    if (!has_motion_encoder()) raise<config_error>(101, "Temos: this model has no motion encoder");
    return gru_encoder ? (*gru_encoder)(motion, context) : (*motionencoder)(motion, context);
  }
  /// z (motions, latent) -> normalised features
  Sequences<B> decode(const Tensor<B, 2>& z, const Offsets& lengths, const Context& context = {}) const {
    return gru_decoder ? (*gru_decoder)(z, lengths, context) : (*motiondecoder)(z, lengths, context);
  }
  /// Both branches of a training step, for temos_losses.
  TextMotionBranches<B> branches(const Sequences<B>& tokens, const Sequences<B>& motion,
                                 const TextMotionNoise<B>& noise, const Context& context = {}) const {
    auto to_frames = [&](const Tensor<B, 2>& z) { return decode(z, motion.offsets, context); };
    TextMotionBranches<B> out{latent_branch(encode_text(tokens, context), noise.text, noise.fact, to_frames), {}};
    if (has_motion_encoder())
      out.motion = latent_branch(encode_motion(motion, context), noise.motion, noise.fact, to_frames);
    return out;
  }
};

/// Normalised features of one motion, (frames, 64), to the 21 joints of MMM: millimetres of its body, Y up, 12.5 frames
/// per second.
template <Backend B>
std::vector<Vec3<typename B::scalar>> temos_joints(const Normalizer<B>& normalizer, const Tensor<B, 2>& features) {
  const auto rows = normalizer.denormalize(features);
  return rifke_joints(temos_rifke(), rows.span());
}
/// The same for an SMPL model, (frames, 135): rotations of 22 joints and translation, metres, Z up.
template <Backend B>
SmplVelpMotion<typename B::scalar> temos_smpl(const Normalizer<B>& normalizer, const Tensor<B, 2>& features) {
  const auto rows = normalizer.denormalize(features);
  return smplvelp_inverse(rows.span());
}

MOTIONLANG_NAMESPACE_END
