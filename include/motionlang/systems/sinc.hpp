// SPDX-License-Identifier: MIT
/// SINC: several actions at the same time. This header assembles it from vae/, nn/sequence_vae.hpp and
/// compose/sinc_composition.hpp.
///
///     const std::string text = join_labels(labels, Conjunction::same_time);            // text/joined_labels.hpp
///     const Sequences<B> states = distilbert(tokenize(tokenizer, std::vector{text})).tokens;      // text/bert.hpp
///     const auto motions = text_to_motion(sinc, states, Offsets{90}, Philox{.seed = 7});
///     const auto motion = sinc_motion(normalizer, motions[0][0]);  // rotations and translation, 30 frames per second
///
/// Source  Athanasiou, Petrovich, Black, Varol: "SINC: Spatial composition of 3D human motions for simultaneous action
///         generation" (ICCV 2023); thesis, annex B
#pragma once

#include <motionlang/compose/sinc_composition.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/vae/sinc_losses.hpp>
#include <motionlang/vae/sinc_text_encoder.hpp>
#include <motionlang/vae/temos_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Published sizes. (The published configuration has six heads under a name that is never read; there are four.)
struct SincConfig {
  static constexpr bool is_option = true;  // holds no tensors
  Index nfeats = 135, text_dim = 768;
  Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  SincMode mode = SincMode::single;
  bool legacy_ste_mask = true;  // of separate texts, see SincTextEncoder::joined
  bool motion_encoder = true;   // for training
  Index max_len = 5000;
  bool operator==(const SincConfig&) const = default;
};

/// eps of SINC's Normalizer, both ways. (TEACH: 1e-12.)
inline constexpr double sinc_eps = 1e-5;

/// The names are those of the published checkpoints, which also contain DistilBERT (textencoder.text_model.*) and, in
/// old ones, eval_model.* and metrics.*.
template <Backend B>
struct Sinc {
  SincTextEncoder<B> textencoder;
  std::optional<TemosMotionEncoder<B>> motionencoder;
  SequenceDecoder<B> motiondecoder;
  SincConfig config;

  static constexpr auto fields() {
    using M = Sinc;
    return motionlang::fields("textencoder", &M::textencoder, "motionencoder", &M::motionencoder, "motiondecoder",
                              &M::motiondecoder, "config", &M::config);
  }
  Sinc() = default;
  Sinc(const SincConfig& c, Rng auto& rng)
      : textencoder(c.text_dim, transformer_of(c), c.max_len, rng),
        motiondecoder(c.nfeats, transformer_of(c), c.max_len, rng),
        config(c) {
    if (c.motion_encoder) motionencoder.emplace(c.nfeats, true, transformer_of(c), c.max_len, rng);
  }

  /// A distribution for each motion, or for each text in mode separate_latents.
  LatentGaussian<B> encode_text(const SincTexts<B>& texts, const Context& context = {}) const {
    return textencoder(texts, config.mode, config.legacy_ste_mask, context);
  }
  /// One text for each motion.
  LatentGaussian<B> encode_text(const Sequences<B>& states, const Context& context = {}) const {
    return encode_text(SincTexts<B>{states}, context);
  }
  /// motion: normalised features. Throws config_error 101 if the model has no motion encoder.
  LatentGaussian<B> encode_motion(const Sequences<B>& motion, const Context& context = {}) const {
    if (!motionencoder) raise<config_error>(101, "Sinc: this model has no motion encoder");
    return (*motionencoder)(motion, context);
  }
  /// z (motions, latent) -> normalised features
  Sequences<B> decode(const Tensor<B, 2>& z, const Offsets& lengths, const Context& context = {}) const {
    return motiondecoder(z, lengths, context);
  }
  /// z: one or several latents for each motion.
  Sequences<B> decode(const Sequences<B>& z, const Offsets& lengths, const Context& context = {}) const {
    return motiondecoder(z, lengths, context);
  }
  /// The number of latents for the texts of each motion.
  Offsets latents(const SincTexts<B>& texts) const {
    const Offsets of_motion = texts.per_motion();
    return config.mode == SincMode::separate_latents ? of_motion : Offsets::equal(of_motion.count(), 1);
  }

  /// Both branches of a training step, for `losses`.
  TextMotionBranches<B> branches(const SincTexts<B>& texts, const Sequences<B>& motion, const TextMotionNoise<B>& noise,
                                 const Context& context = {}) const {
    auto to_frames = [&](const Offsets& slots) {
      return [&, slots](const Tensor<B, 2>& z) { return decode(Sequences<B>(z, slots), motion.offsets, context); };
    };
    TextMotionBranches<B> out{
        latent_branch(encode_text(texts, context), noise.text, noise.fact, to_frames(latents(texts))), {}};
    if (motionencoder)
      out.motion = latent_branch(encode_motion(motion, context), noise.motion, noise.fact,
                                 to_frames(Offsets::equal(motion.count(), 1)));
    return out;
  }
  LossTerms<B> losses(const TextMotionBranches<B>& branches, const SincTexts<B>& texts, const Sequences<B>& motion,
                      const TemosLossOptions& options = sinc_loss_options()) const {
    return sinc_losses(branches, motion, latents(texts), config.mode == SincMode::separate_latents, options);
  }

  /// Motions from texts, normalised features. eps: standard normal, (latents, width).
  Sequences<B> generate(const SincTexts<B>& texts, const Offsets& lengths, const Tensor<B, 2>& eps,
                        double fact = 1) const {
    return decode(Sequences<B>(encode_text(texts).sample(eps, fact), latents(texts)), lengths);
  }
};

/// The input of the text encoder for the labels of some motions.
/// sentence(labels)   joins those of a motion, in mode single; the other modes read them apart
/// tokens(texts)      the rows of texts
template <Backend B, class Sentence, class Tokens>
SincTexts<B> sinc_texts(SincMode mode, std::span<const std::vector<std::string>> labels, Sentence sentence,
                        Tokens tokens) {
  std::vector<std::string> texts;
  std::vector<Index> motion;
  for (std::size_t m = 0; m < labels.size(); ++m) {
    if (mode == SincMode::single) {
      texts.push_back(sentence(labels[m]));
      continue;
    }
    texts.insert(texts.end(), labels[m].begin(), labels[m].end());
    motion.insert(motion.end(), labels[m].size(), static_cast<Index>(m));
  }
  return {tokens(texts), std::move(motion)};
}

/// text_to_motion for the texts of any mode: `samples` motions for each.
template <Backend B>
std::vector<Sequences<B>> labels_to_motion(const Sinc<B>& model, const SincTexts<B>& texts, const Offsets& lengths,
                                           const Philox& rng, Index samples = 1, const LatentSampling& sampling = {}) {
  const auto latent = model.encode_text(texts);
  const Offsets slots = model.latents(texts);
  std::vector<Sequences<B>> out;
  for (Index i = 0; i < samples; ++i)
    out.push_back(model.decode(Sequences<B>(sampled_latents(latent, rng, i, sampling), slots), lengths));
  return out;
}

/// Normalised features of one motion, (frames, 135), to rotations of 22 joints and translation: metres, Z up, 30 frames
/// per second.
template <Backend B>
SmplVelpMotion<typename B::scalar> sinc_motion(const Normalizer<B>& normalizer, const Tensor<B, 2>& features) {
  const auto rows = normalizer.denormalize(features);
  return smplvelp_inverse(rows.span());
}

/// The baseline that composes two motions, each generated from one label, by the body parts of the labels (published as
/// "gpt").
/// Source  thesis B.2.1 and B.3.2; SINC sinc/model/sinc.py text_to_motion_forward
template <Backend B>
SmplVelpMotion<typename B::scalar> sinc_composed(const Normalizer<B>& normalizer, const Tensor<B, 2>& first,
                                                 SincParts first_parts, const Tensor<B, 2>& second,
                                                 SincParts second_parts) {
  return compose_motions(sinc_motion(normalizer, first), first_parts, sinc_motion(normalizer, second), second_parts,
                         SincTrim::both_ends);
}

MOTIONLANG_NAMESPACE_END
