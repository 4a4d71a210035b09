// SPDX-License-Identifier: MIT
/// One latent space for texts and motions: the two branches of a training step, their losses, and motions from texts.
/// TEMOS and TMR use it; TEACH and SINC build on it.
///
///     text   -> N_T -> z_T -> frames      the same decoder for both, to the lengths of the motions
///     motion -> N_M -> z_M -> frames
#pragma once

#include <motionlang/loss/info_nce.hpp>
#include <motionlang/loss/kl.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/loss/margin.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The results for one modality of a batch.
template <Backend B>
struct LatentBranch {
  LatentGaussian<B> distribution;
  Tensor<B, 2> z;         // a sample for each sequence
  Tensor<B, 2> frames{};  // decoded, packed like the motions; empty if nothing is reconstructed
};
/// A sample of a distribution, and the frames that decode(z) makes of it.
template <Backend B, class Decode>
LatentBranch<B> latent_branch(LatentGaussian<B> distribution, const Tensor<B, 2>& eps, double fact, Decode decode) {
  const auto z = distribution.sample(eps, fact);
  return {std::move(distribution), z, decode(z).rows};
}
template <Backend B>
struct TextMotionBranches {
  LatentBranch<B> text;
  std::optional<LatentBranch<B>> motion;  // empty for a model without a motion encoder
};

/// Standard normal noise for both branches, (sequences, latent) each; z = mu + fact eps std.
template <Backend B>
struct TextMotionNoise {
  Tensor<B, 2> text, motion;
  double fact = 1;

  static TextMotionNoise draw(Index sequences, Index width, const Philox& rng, double fact = 1) {
    auto for_text = rng.split("text"), for_motion = rng.split("motion");
    return {Tensor<B, 2>::randn({sequences, width}, for_text), Tensor<B, 2>::randn({sequences, width}, for_motion),
            fact};
  }
};

/// The transformers of a model, from option names that all these systems share.
template <class Config>
TransformerConfig transformer_of(const Config& c) {
  return {.d_model = c.latent_dim,
          .heads = c.num_heads,
          .d_ff = c.ff_size,
          .layers = c.num_layers,
          .activation = c.activation,
          .dropout = c.dropout};
}

/// That of the text encoder, which may have layers and heads of its own (thesis table 4.8).
template <class Config>
TransformerConfig text_transformer_of(const Config& c) {
  TransformerConfig out = transformer_of(c);
  if (c.text_layers > 0) out.layers = c.text_layers;
  if (c.text_heads > 0) out.heads = c.text_heads;
  return out;
}

/// How a reconstruction is averaged: over the padded batch (TEMOS, TMR, SINC), or over each sequence and then over all
/// sequences (TEACH).
enum class ReconstructionMean { padded_batch, sequences };

/// Weights and switches of TEMOS' loss. The rows of thesis table 4.3 switch off `cross_modal_kl`, `gaussian_kl` and
/// `embedding`, or take a model without a motion encoder.
struct TemosLossOptions {
  double recons = 1, kl = 1e-5, latent = 1e-5;
  bool cross_modal_kl = true, gaussian_kl = true;
  bool embedding = true;         // the term between z_T and z_M; a deterministic model always has it
  std::string feats = "jfeats";  // in the names of the reconstructions: "rfeats" for rotations
  ReconstructionMean mean = ReconstructionMean::padded_batch;
  Index padded_frames = 0;  // of that batch, if it is padded beyond its longest motion
};

/// recons_F2F, recons_text2F: the terms whose frames exist. Their sum is thesis eq. 4.1 = TEMOS eq. 1.
template <Backend B>
LossTerms<B> reconstruction_losses(const TextMotionBranches<B>& branches, const Sequences<B>& motion,
                                   const TemosLossOptions& options) {
  LossTerms<B> out;
  auto reconstruct = [&](const std::string& from, const Tensor<B, 2>& frames) {
    if (frames.count() == 0) return;
    out.add("recons_" + from + "2" + options.feats, options.recons,
            options.mean == ReconstructionMean::sequences ? smooth_l1_of_sequences(motion, frames)
                                                          : padded_smooth_l1(motion, frames, options.padded_frames));
  };
  if (branches.motion) reconstruct(options.feats, branches.motion->frames);
  reconstruct("text", branches.text.frames);
  return out;
}

///     recons_text2F, recons_F2F          smooth_l1, averaged over the padded batch or over sequences
///     kl_text2motion, kl_motion2text     KL(T || M), KL(M || T)
///     kl_text, kl_motion                 KL(T || N(0, 1)), KL(M || N(0, 1))
///     latent_manifold                    smooth_l1(z_T, z_M)
/// Terms exist only if the model and the options have them; the names are the published ones.
/// Source  TEMOS, section 3.3; thesis 4.2.3: the sum of thesis eq. 4.1, thesis eq. 4.2 and thesis eq. 4.3, weighted;
///         TEMOS temos/model/losses/compute.py
template <Backend B>
LossTerms<B> temos_losses(const TextMotionBranches<B>& branches, const Sequences<B>& motion,
                          const TemosLossOptions& options = {}) {
  auto out = reconstruction_losses(branches, motion, options);
  const auto& [text, other] = branches;
  const auto& t = text.distribution;
  if (!t.deterministic()) {  // the four terms of thesis eq. 4.2 = TEMOS eq. 2
    if (other && options.cross_modal_kl) {
      const auto& m = other->distribution;
      out.add("kl_text2motion", options.kl, kl_divergence(t.mu, t.logvar, m.mu, m.logvar));
      out.add("kl_motion2text", options.kl, kl_divergence(m.mu, m.logvar, t.mu, t.logvar));
    }
    if (options.gaussian_kl) {
      out.add("kl_text", options.kl, kl_to_standard_normal(t.mu, t.logvar));
      if (other)
        out.add("kl_motion", options.kl, kl_to_standard_normal(other->distribution.mu, other->distribution.logvar));
    }
  }
  if (other && (options.embedding || t.deterministic()))  // thesis eq. 4.3 = TEMOS eq. 3
    out.add("latent_manifold", options.latent, smooth_l1(text.z, other->z));
  return out;
}

enum class ContrastiveLoss { none, info_nce, margin };

/// Weights of TMR's loss. Table 5.3 of the thesis varies `contrastive_loss`, and sets `recons` to 0 with a
/// deterministic model.
struct TmrLossOptions {
  double recons = 1, kl = 1e-5, latent = 1e-5, contrastive = 0.1;
  ContrastiveLoss contrastive_loss = ContrastiveLoss::info_nce;
  double temperature = 0.1;
  double threshold = 0.8;  // of similar texts, see false_negatives; 0: no filter
  double margin = 10;
  bool cross_modal_kl = true, gaussian_kl = true;  // of the four divergences of TEMOS, which TMR also has
  Index padded_frames = 0;                         // as in TemosLossOptions
};

/// contrastive: the term that compares all samples of a batch; none if the options have none.
/// x, y         samples of the latents of texts and motions, (batch, latent) each
/// For sentences, temperature and strangers, see tmr_losses.
template <Backend B>
LossTerms<B> tmr_contrastive_loss(const Tensor<B, 2>& x, const Tensor<B, 2>& y, const Tensor<B, 2>* sentences,
                                  const TmrLossOptions& options, const Tensor<B, 0>* temperature = nullptr,
                                  const Tensor<B, 2>* strangers = nullptr) {
  LossTerms<B> out;
  if (options.contrastive_loss == ContrastiveLoss::none) return out;
  const auto filtered =
      sentences == nullptr ? std::vector<unsigned char>() : false_negatives(*sentences, options.threshold);
  out.add("contrastive", options.contrastive,
          options.contrastive_loss == ContrastiveLoss::margin ? margin_loss(x, y, options.margin, filtered)
          : temperature != nullptr                            ? info_nce(x, y, *temperature, filtered, strangers)
                                   : info_nce(x, y, options.temperature, filtered, strangers));
  return out;
}

/// recons and kl (the sums of TEMOS' terms), latent, contrastive: only those that the model and the options have.
/// sentences    (batch, width), rows of length 1, to find texts with the same meaning. Null: nothing is filtered
/// temperature  a learned one for InfoNCE, instead of that of the options. Null: that of the options
/// strangers    (any, latent): for InfoNCE, texts that no motion shows (text/stranger_texts.hpp). Null: none
/// Throws config_error 101 for a contrastive loss without a motion encoder.
/// Source     TMR, section 3.2; thesis 5.2.2; TMR src/model/tmr.py compute_loss
template <Backend B>
LossTerms<B> tmr_losses(const TextMotionBranches<B>& branches, const Sequences<B>& motion,
                        const Tensor<B, 2>* sentences = nullptr, const TmrLossOptions& options = {},
                        const Tensor<B, 0>* temperature = nullptr, const Tensor<B, 2>* strangers = nullptr) {
  const auto parts = temos_losses(branches, motion,
                                  TemosLossOptions{.cross_modal_kl = options.cross_modal_kl,
                                                   .gaussian_kl = options.gaussian_kl,
                                                   .padded_frames = options.padded_frames});
  LossTerms<B> out;
  if (branches.text.frames.count() > 0) out.add("recons", options.recons, parts.sum_of("recons_"));
  if (!branches.text.distribution.deterministic()) out.add("kl", options.kl, parts.sum_of("kl_"));
  out.add("latent", options.latent, parts.sum_of("latent_"));
  if (options.contrastive_loss == ContrastiveLoss::none) return out;
  if (!branches.motion) raise<config_error>(101, "tmr_losses: contrastive without the latents of a motion encoder");
  out.append(tmr_contrastive_loss(branches.text.z, branches.motion->z, sentences, options, temperature, strangers));
  return out;
}

struct LatentSampling {
  double fact = 1;    // scales the noise
  bool mean = false;  // mu, without noise
};

/// The latents of texts for sample `i` of text_to_motion. All texts share one noise vector.
template <Backend B>
Tensor<B, 2> sampled_latents(const LatentGaussian<B>& texts, const Philox& rng, Index i,
                             const LatentSampling& sampling = {}) {
  if (sampling.mean) return texts.mu;
  auto noise = rng.split(static_cast<std::uint64_t>(i));
  const auto eps = Tensor<B, 2>::randn({1, texts.mu.size(1)}, noise);
  return texts.sample(broadcast_to<2>(eps, texts.mu.shape()), sampling.fact);
}

/// Motions from texts: `samples` for each, as the features that the model was trained on. `model` has
/// encode_text(tokens) and decode(z, lengths).
/// tokens  a sequence for each text;   lengths  of the motions, one for each text
/// Noise   one vector for each sample, the same for all texts, as published: a text gives the same motion alone and
///         with other texts
template <Backend B, class Model>
std::vector<Sequences<B>> text_to_motion(const Model& model, const Sequences<B>& tokens, const Offsets& lengths,
                                         const Philox& rng, Index samples = 1, const LatentSampling& sampling = {}) {
  const auto latent = model.encode_text(tokens);
  std::vector<Sequences<B>> out;
  for (Index i = 0; i < samples; ++i) out.push_back(model.decode(sampled_latents(latent, rng, i, sampling), lengths));
  return out;
}

/// Motions between two texts: `steps` latents on the line between the latents of both, all of `length` frames. The
/// first and the last are those of text_to_motion. Throws what interpolate_rows throws.
template <Backend B, class Model>
Sequences<B> interpolate_texts(const Model& model, const Sequences<B>& two_texts, Index steps, Index length,
                               const Philox& rng, const LatentSampling& sampling = {}) {
  const auto z = sampled_latents(model.encode_text(two_texts), rng, 0, sampling);
  return model.decode(interpolate_rows(slice(z, 0, 0, 1), slice(z, 0, 1, 2), steps), Offsets::equal(steps, length));
}
/// The same between the means of both texts.
template <Backend B, class Model>
Sequences<B> interpolate_texts(const Model& model, const Sequences<B>& two_texts, Index steps, Index length) {
  return interpolate_texts(model, two_texts, steps, length, Philox{}, {.mean = true});
}

MOTIONLANG_NAMESPACE_END
