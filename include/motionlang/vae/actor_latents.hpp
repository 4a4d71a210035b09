// SPDX-License-Identifier: MIT
/// The latents of generated motions. Motions may share their noise, so that they differ only in the action, or share
/// the action, so that they differ only in the noise.
#pragma once

#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// How latents share their noise. interpolate: one vector, scaled from -1 to 1 over the samples.
enum class NoiseSharing { random, same, interpolate };
struct ActorSampling {
  Index samples = 1;  // of each action
  NoiseSharing across_samples = NoiseSharing::random;
  NoiseSharing across_actions = NoiseSharing::random;  // random or same
  double fact = 1;                                     // scales all noise

  /// The number of rows of noise for the samples of this many actions.
  Index noise_rows(Index actions) const {
    return (across_samples == NoiseSharing::random ? samples : 1) *
           (across_actions == NoiseSharing::random ? actions : 1);
  }
};

/// Latents in the order sample, action: noise (noise_rows, latent) -> (samples actions, latent).
/// Source  ACTOR src/models/modeltype/cae.py generate
/// Throws  config_error 101 for invalid options, shape_error 204 for another number of rows
template <Backend B>
Tensor<B, 2> actor_latents(const Tensor<B, 2>& noise, Index actions, const ActorSampling& o = {}) {
  if (o.samples < 1 || o.across_actions == NoiseSharing::interpolate)
    raise<config_error>(101, "actor_latents: ", o.samples, " samples; noise is not interpolated across actions");
  if (noise.size(0) != o.noise_rows(actions))
    raise<shape_error>(204, "actor_latents: noise ", noise.shape(), ", ", o.noise_rows(actions), " rows are needed");
  const bool per_action = o.across_actions == NoiseSharing::random;
  PoolVector<Index> rows;
  std::vector<typename B::scalar> scale;
  for (Index s = 0; s < o.samples; ++s) {
    const double at = o.samples == 1 ? -1 : -1 + 2 * static_cast<double>(s) / static_cast<double>(o.samples - 1);
    for (Index a = 0; a < actions; ++a) {
      const Index sample = o.across_samples == NoiseSharing::random ? s : 0;
      rows.push_back(per_action ? sample * actions + a : sample);
      scale.push_back(
          static_cast<typename B::scalar>(o.across_samples == NoiseSharing::interpolate ? o.fact * at : o.fact));
    }
  }
  return gather(noise, rows) * Tensor<B, 2>::from(scale, {std::ssize(scale), 1});
}

MOTIONLANG_NAMESPACE_END
