// SPDX-License-Identifier: MIT
// Bodies of gaussian.hpp.
#pragma once

#include <algorithm>  // min

#include <motionlang/diffusion/gaussian.hpp>
#include <motionlang/diffusion/respacing.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GaussianDiffusion GaussianDiffusion::respaced(std::span<const Index> kept) const {
  std::vector<double> betas;
  double last = 1;
  for (Index t : kept) {
    if (t < 0 || t >= steps()) raise<config_error>(105, "respacing: step ", t, " of ", steps());
    betas.push_back(1 - abar(t) / last);
    last = abar(t);
  }
  GaussianDiffusion d{BetaList{betas}};
  d.network_t_.clear();
  for (Index t : kept) d.network_t_.push_back(network_t(t));
  return d;
}

MOTIONLANG_BODY double GaussianDiffusion::inverse_abar(Index t) const {
  if (!(abar(t) > 0)) raise<config_error>(104, "GaussianDiffusion: step ", t, " keeps nothing of x0 (abar is 0)");
  return 1 / abar(t);
}

MOTIONLANG_BODY double GaussianDiffusion::posterior_log_variance(Index t) const {
  return steps() == 1 ? std::log(1e-20) : std::log(posterior_variance(t == 0 ? 1 : t));
}

MOTIONLANG_BODY double GaussianDiffusion::large_variance(Index t) const {
  return t == 0 ? posterior_variance(std::min<Index>(1, steps() - 1)) : beta(t);
}

MOTIONLANG_BODY double GaussianDiffusion::noise_factor(Index t, NoiseScale scale, Variance variance) const {
  if (t == 0) return 0;
  if (scale == NoiseScale::posterior_variance)
    return variance == Variance::fixed_small ? posterior_variance(t) : large_variance(t);
  return std::exp(0.5 * (variance == Variance::fixed_small ? posterior_log_variance(t) : std::log(large_variance(t))));
}

MOTIONLANG_BODY void GaussianDiffusion::build(std::vector<double> betas) {
  double product = 1;
  for (std::size_t t = 0; t < betas.size(); ++t) {
    if (!(betas[t] > 0 && betas[t] <= 1))
      raise<config_error>(104, "diffusion schedule: beta[", t, "] = ", betas[t], " is not in (0, 1]");
    product *= 1 - betas[t];
    abar_.push_back(product);
  }
  if (betas.empty()) raise<config_error>(104, "diffusion schedule: no steps");
  beta_ = std::move(betas);
}

MOTIONLANG_NAMESPACE_END
