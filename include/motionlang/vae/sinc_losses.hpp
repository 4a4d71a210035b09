// SPDX-License-Identifier: MIT
/// The losses of SINC: those of TEMOS, and their forms for labels that each have a latent of their own.
#pragma once

#include <motionlang/vae/text_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Published weights: divergences weigh 32 times as much as in TEMOS.
/// Source   SINC sinc/model/losses/compute_sinc.py, with the weights of its released options
/// Differs  from thesis eq. B.1, where every term has weight 1: here divergences weigh 32e-5, the latents' term 1e-5
inline TemosLossOptions sinc_loss_options() { return {.kl = 32e-5, .feats = "rfeats"}; }

/// texts    the number of latents for the text of each motion; if 1 for all, these are temos_losses
///
///     kl_text2motion_multi, kl_motion2text_multi, kl_text_multi     the mean over the texts of a motion, then over
///     motions
///     latent_manifold_multi     smooth_l1 of each text against its motion: the sum over all texts / (motions * most
///                               texts of one)
/// The other terms, recons_rfeats2rfeats, recons_text2rfeats and kl_motion, are those of TEMOS.
/// separate_latents   the names end in _multi, even if every motion of the batch has one text
/// Source  thesis B.2.2, thesis eq. B.1; SINC sinc/model/losses/compute_sinc.py. A motion with fewer texts than another
///         has empty latents, which count as 0 in the mean, as published
template <Backend B>
LossTerms<B> sinc_losses(const TextMotionBranches<B>& branches, const Sequences<B>& motion, const Offsets& texts,
                         bool separate_latents, const TemosLossOptions& options = sinc_loss_options()) {
  if (!separate_latents) return temos_losses(branches, motion, options);
  auto out = reconstruction_losses(branches, motion, options);
  const auto& t = branches.text.distribution;
  std::vector<typename B::scalar> share;  // of each text in the mean
  for (Index m : sequence_of_row(texts))
    share.push_back(static_cast<typename B::scalar>(1.0 / static_cast<double>(texts.length(m) * texts.count())));
  const auto weights = Tensor<B, 1>::from(share, {texts.rows()});
  auto averaged = [&](const std::string& name, const Tensor<B, 1>& of_texts) {
    out.add(name, options.kl, sum(of_texts * weights));
  };
  if (branches.motion && options.cross_modal_kl) {
    const auto& m = branches.motion->distribution;
    const auto mu = repeat_for_rows(m.mu, texts), logvar = repeat_for_rows(m.logvar, texts);
    averaged("kl_text2motion_multi", kl_divergence_of_rows(t.mu, t.logvar, mu, logvar));
    averaged("kl_motion2text_multi", kl_divergence_of_rows(mu, logvar, t.mu, t.logvar));
  }
  if (options.gaussian_kl) {
    averaged("kl_text_multi", kl_to_standard_normal_of_rows(t.mu, t.logvar));
    if (branches.motion) {
      const auto& m = branches.motion->distribution;
      out.add("kl_motion", options.kl, kl_to_standard_normal(m.mu, m.logvar));
    }
  }
  if (branches.motion && options.embedding) {
    const double slots = static_cast<double>(texts.count() * texts.longest());
    out.add("latent_manifold_multi", options.latent,
            smooth_l1(branches.text.z, repeat_for_rows(branches.motion->z, texts)) *
                (static_cast<double>(texts.rows()) / slots));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
