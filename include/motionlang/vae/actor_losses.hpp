// SPDX-License-Identifier: MIT
/// The loss of ACTOR.
#pragma once

#include <motionlang/loss/kl.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Weights of the loss; rcxyz is 0 for models that were trained without a body. Published models do not use vel and
/// velxyz.
struct ActorLossWeights {
  double rc = 1, rcxyz = 1, kl = 1e-5, vel = 0, velxyz = 0;
};
/// The points that rcxyz and velxyz compare: `actor_points` of the motions, and of those that the model wrote.
/// Published models take vertices without the translation.
template <Backend B>
struct ActorLossPoints {
  Sequences<B> wanted, written;
};

///     rc, rcxyz     mean square over all frames and features (the padding of the translation's row counts), or over
///                   points
///     kl            KL(N(mu, exp(logvar)) || N(0, 1)), or from the prior that is given, SUMMED over batch and
///                   coordinates: its weight grows with the batch. Latents of frames are summed over frames, too
///     vel, velxyz   mean square of the steps from frame to frame
/// Terms whose weight is not 0. Source  thesis 3.2.2; ACTOR src/models/tools/losses.py
/// Throws  config_error 102 if a term needs points that are missing
template <Backend B>
LossTerms<B> actor_losses(const LatentGaussian<B>& latent, const Sequences<B>& x, const Sequences<B>& written,
                          const ActorLossWeights& w = {}, const std::optional<ActorLossPoints<B>>& points = {},
                          const std::optional<LatentGaussian<B>>& prior = {}) {
  if ((w.rcxyz != 0 || w.velxyz != 0) && !points)
    raise<config_error>(102, "actor_losses: weights ", w.rcxyz, " of rcxyz and ", w.velxyz,
                        " of velxyz without points");
  LossTerms<B> out;
  if (w.rc != 0) out.add("rc", w.rc, mse(x.rows, written.rows));
  if (w.rcxyz != 0) out.add("rcxyz", w.rcxyz, mse(points->wanted.rows, points->written.rows));
  if (w.kl != 0) {
    const auto mean = prior ? kl_divergence(latent.mu, latent.logvar, prior->mu, prior->logvar)
                            : kl_to_standard_normal(latent.mu, latent.logvar);
    out.add("kl", w.kl, mean * static_cast<double>(latent.mu.count()));
  }
  if (w.vel != 0) out.add("vel", w.vel, velocity_mse(x, written));
  if (w.velxyz != 0) out.add("velxyz", w.velxyz, velocity_mse(points->wanted, points->written));
  return out;
}

MOTIONLANG_NAMESPACE_END
