// SPDX-License-Identifier: MIT
/// The Gaussian diffusion process: the coefficients of a schedule, noising, the posterior, and conversions between the
/// four quantities that a network may predict.
///
/// Notation (Ho et al. 2020)   beta_t, alpha_t = 1 - beta_t, abar_t = prod_{s <= t} alpha_s, abarp_t = abar_{t-1} (1
///                             for t = 0), abarn_t = abar_{t+1} (0 for the last). Index t stands for t + 1 applications
///                             of noise.
/// Precision   Tables are built in double, and the entry for t is rounded to the tensor's scalar. Each term then takes
///             one multiplication and one addition in the order written, as in the published code. Parity needs this.
#pragma once

#include <cmath>   // sqrt
#include <span>    // one step per sample
#include <vector>  // coefficients

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/diffusion/schedule.hpp>
#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The quantity that a network predicts from x_t.
enum class Prediction { x0, eps, score, x_prev };

/// The amount of noise that an ancestral step adds.
///   posterior_std        the standard deviation of q(x_{t-1} | x_t, x0), 0 at t = 0: DDPM as written in the papers
///   posterior_variance   the variance itself: a quirk of the released STMC code, which made all its results
enum class NoiseScale { posterior_std, posterior_variance };

/// fixed_small: the posterior variance; fixed_large: beta_t (and the posterior variance at t = 1 for t = 0).
enum class Variance { fixed_small, fixed_large };

class GaussianDiffusion {
 public:
  /// Throws config_error 104 if a beta is outside (0, 1].
  template <Schedule S>
  explicit GaussianDiffusion(const S& schedule) {
    std::vector<double> betas;
    for (Index t = 0; t < static_cast<Index>(schedule.steps); ++t) betas.push_back(schedule.beta(t));
    build(std::move(betas));
    for (Index t = 0; t < steps(); ++t) network_t_.push_back(t);
  }
  /// The process that keeps only some steps (respacing.hpp): beta'_i = 1 - abar[S_i] / abar[S_{i-1}]. The network still
  /// receives the original numbers. Throws config_error 104, 105.
  GaussianDiffusion respaced(std::span<const Index> kept) const;

  Index steps() const { return static_cast<Index>(beta_.size()); }
  /// The number that the network receives at index t of this process.
  Index network_t(Index t) const { return network_t_[at(t)]; }

  double beta(Index t) const { return beta_[at(t)]; }
  double alpha(Index t) const { return 1 - beta_[at(t)]; }
  double abar(Index t) const { return abar_[at(t)]; }
  /// 1 / abar. Throws config_error 104 if nothing of x0 is left, since then neither noise nor score determine it.
  double inverse_abar(Index t) const;
  double abarp(Index t) const { return t == 0 ? 1 : abar_[at(t) - 1]; }
  double abarn(Index t) const { return t + 1 == steps() ? 0 : abar_[at(t) + 1]; }
  /// Variance of the posterior (thesis eq. 6.4): beta_t (1 - abarp_t) / (1 - abar_t); 0 at t = 0.
  double posterior_variance(Index t) const { return beta(t) * (1 - abarp(t)) / (1 - abar(t)); }
  /// Its logarithm. Index 0 takes the value of index 1.
  double posterior_log_variance(Index t) const;
  double large_variance(Index t) const;
  /// Weights of x0 and x_t in the posterior mean (thesis eq. 6.3).
  double c0(Index t) const { return beta(t) * std::sqrt(abarp(t)) / (1 - abar(t)); }
  double ct(Index t) const { return (1 - abarp(t)) * std::sqrt(alpha(t)) / (1 - abar(t)); }

  /// Factor of the noise in an ancestral step; 0 at t = 0.
  double noise_factor(Index t, NoiseScale scale, Variance variance = Variance::fixed_small) const;

 private:
  void build(std::vector<double> betas);
  std::size_t at(Index t) const {
    if (t < 0 || t >= steps()) raise<shape_error>(203, "GaussianDiffusion: step ", t, " of ", steps());
    return static_cast<std::size_t>(t);
  }

  std::vector<double> beta_, abar_;
  std::vector<Index> network_t_;
};

/// One coefficient per sample (leading index) as a tensor that broadcasts over the rest; rounded to the scalar.
template <Backend B, int R, class F>
Tensor<B, R> coefficients(std::span<const Index> t, F f) {
  PoolVector<typename B::scalar> values;
  for (Index i : t) values.push_back(static_cast<typename B::scalar>(f(i)));
  Shape s{static_cast<Index>(t.size())};
  for (int i = 1; i < R; ++i) s.push_back(1);
  return Tensor<B, R>::from(std::span<const typename B::scalar>(values), s);
}

/// x_t = sqrt(abar_t) x0 + sqrt(1 - abar_t) eps. This is steps 0 ... t of thesis eq. 6.1 at once (Ho et al. 2020, eq.
/// 4). One t per leading index, or one for all.
template <Backend B, int R>
Tensor<B, R> q_sample(const GaussianDiffusion& d, const Tensor<B, R>& x0, std::span<const Index> t,
                      const Tensor<B, R>& eps) {
  return coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.abar(i)); }) * x0 +
         coefficients<B, R>(t, [&](Index i) { return std::sqrt(1 - d.abar(i)); }) * eps;
}

/// Mean of q(x_{t-1} | x_t, x0): c0 x0 + ct x_t.   (thesis eq. 6.3; Ho et al. 2020, eq. 7)
template <Backend B, int R>
Tensor<B, R> posterior_mean(const GaussianDiffusion& d, const Tensor<B, R>& x0, const Tensor<B, R>& x_t,
                            std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return d.c0(i); }) * x0 +
         coefficients<B, R>(t, [&](Index i) { return d.ct(i); }) * x_t;
}
/// The same mean from the noise: (x_t - beta_t / sqrt(1 - abar_t) eps) / sqrt(alpha_t).   (Ho et al. 2020, eq. 11)
template <Backend B, int R>
Tensor<B, R> posterior_mean_from_eps(const GaussianDiffusion& d, const Tensor<B, R>& eps, const Tensor<B, R>& x_t,
                                     std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return 1 / std::sqrt(d.alpha(i)); }) * x_t -
         coefficients<B, R>(t, [&](Index i) {
           return d.beta(i) / (std::sqrt(1 - d.abar(i)) * std::sqrt(d.alpha(i)));
         }) * eps;
}
/// The same mean from the score: (x_t + beta_t score) / sqrt(alpha_t).
template <Backend B, int R>
Tensor<B, R> posterior_mean_from_score(const GaussianDiffusion& d, const Tensor<B, R>& score, const Tensor<B, R>& x_t,
                                       std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return 1 / std::sqrt(d.alpha(i)); }) * x_t +
         coefficients<B, R>(t, [&](Index i) { return d.beta(i) / std::sqrt(d.alpha(i)); }) * score;
}

/// x0 from any prediction of the network.
///     eps:    sqrt(1/abar) x_t - sqrt(1/abar - 1) eps
///     score:  x_t / sqrt(abar) + (1 - abar) / sqrt(abar) score
///     x_prev: x_prev / c0 - ct / c0 x_t
template <Backend B, int R>
Tensor<B, R> to_x0(const GaussianDiffusion& d, Prediction from, const Tensor<B, R>& value, const Tensor<B, R>& x_t,
                   std::span<const Index> t) {
  auto k = [&](auto f) { return coefficients<B, R>(t, f); };
  switch (from) {
    case Prediction::x0:
      return value;
    case Prediction::eps:
      return k([&](Index i) { return std::sqrt(d.inverse_abar(i)); }) * x_t -
             k([&](Index i) { return std::sqrt(d.inverse_abar(i) - 1); }) * value;
    case Prediction::score:
      return k([&](Index i) { return 1 / std::sqrt(d.abar(i)); }) * x_t +
             k([&](Index i) { return (1 - d.abar(i)) / std::sqrt(d.abar(i)); }) * value;
    case Prediction::x_prev:
      return k([&](Index i) { return 1 / d.c0(i); }) * value - k([&](Index i) { return d.ct(i) / d.c0(i); }) * x_t;
  }
  return value;
}
/// The noise that x_t contains if x0 is right: (sqrt(1/abar) x_t - x0) / sqrt(1/abar - 1).
template <Backend B, int R>
Tensor<B, R> eps_from_x0(const GaussianDiffusion& d, const Tensor<B, R>& x0, const Tensor<B, R>& x_t,
                         std::span<const Index> t) {
  return (coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.inverse_abar(i)); }) * x_t - x0) /
         coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.inverse_abar(i) - 1); });
}
/// The score that belongs to x0: sqrt(abar) / (1 - abar) x0 - x_t / (1 - abar).
template <Backend B, int R>
Tensor<B, R> score_from_x0(const GaussianDiffusion& d, const Tensor<B, R>& x0, const Tensor<B, R>& x_t,
                           std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.abar(i)) / (1 - d.abar(i)); }) * x0 -
         coefficients<B, R>(t, [&](Index i) { return 1 / (1 - d.abar(i)); }) * x_t;
}
/// Converts any prediction into any other (except x_prev, which is a sample).
template <Backend B, int R>
Tensor<B, R> convert_prediction(const GaussianDiffusion& d, Prediction from, Prediction to, const Tensor<B, R>& value,
                                const Tensor<B, R>& x_t, std::span<const Index> t) {
  if (from == to) return value;
  if (from == Prediction::eps && to == Prediction::score) {
    return value * coefficients<B, R>(t, [&](Index i) { return -1 / std::sqrt(1 - d.abar(i)); });
  }
  if (from == Prediction::score && to == Prediction::eps) {
    return value * coefficients<B, R>(t, [&](Index i) { return -std::sqrt(1 - d.abar(i)); });
  }
  const auto x0 = to_x0(d, from, value, x_t, t);
  switch (to) {
    case Prediction::x0:
      return x0;
    case Prediction::eps:
      return eps_from_x0(d, x0, x_t, t);
    case Prediction::score:
      return score_from_x0(d, x0, x_t, t);
    case Prediction::x_prev:
      raise<config_error>(102, "convert_prediction: x_prev is a sample, which does not predict x0");
  }
  return x0;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/diffusion/gaussian.ipp>
#endif
