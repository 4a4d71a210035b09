// SPDX-License-Identifier: MIT
/// From noise to a sample: ancestral (DDPM), DDIM with its inversion, and PLMS.
///
/// The loops know nothing of motion. They call
///    network(x, t) -> the network's prediction at index t of the process (already guided), with the shape of x
///    noise(draw)   -> standard normal values of that shape; draw 0 is the first after the initial tensor
///    fix(x0, t)    -> the clean estimate to use (inpainting, stitching); identity if not given
#pragma once

#include <algorithm>    // min
#include <array>        // names
#include <cmath>        // sqrt
#include <cstddef>      // sizes
#include <string_view>  // names
#include <vector>       // old values

#include <motionlang/core/progress.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/diffusion/gaussian.hpp>
#include <motionlang/tensor/index.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct StepOptions {
  Prediction prediction = Prediction::x0;
  NoiseScale noise_scale = NoiseScale::posterior_std;
  Variance variance = Variance::fixed_small;
  bool clip = false;  // x0 to [-1, 1]
};

/// The process with this many of its steps, evenly chosen; 0: all of them. Throws config_error 105.
GaussianDiffusion with_steps(const GaussianDiffusion& process, Index steps);

/// Standard normal values (sequences, frames, features). Every sequence has its own stream, so it sees the same noise
/// alone and in a batch.
/// draw   0 for the initial tensor, 1, 2, ... for the steps
/// first  the place of the first sequence, if these are a part of a longer list
template <Backend B>
Tensor<B, 3> sequence_noise(const Philox& rng, Index draw, const Shape& shape, Index first = 0) {
  using S = typename B::scalar;
  PoolVector<S> values(static_cast<std::size_t>(shape.count()));
  const auto size = static_cast<std::size_t>(shape[1] * shape[2]);
  for (Index m = 0; m < shape[0]; ++m) {
    auto stream =
        rng.split("noise").split(static_cast<std::uint64_t>(first + m)).split(static_cast<std::uint64_t>(draw));
    stream.normal(std::span<S>(values).subspan(static_cast<std::size_t>(m) * size, size));
  }
  return Tensor<B, 3>::from(std::span<const S>(values), shape);
}

/// Options of a whole reverse process.
struct SamplingOptions {
  enum class Sampler { ddpm, ddim, plms };
  Sampler sampler = Sampler::ddpm;
  double eta = 0;  // of ddim
  int order = 4;   // of plms: 2 to 4
  /// As thesis eq. 6.2 has it: N(mu, Sigma) is mu + sqrt(Sigma) noise.
  NoiseScale noise_scale = NoiseScale::posterior_std;
  bool clip = false;
};
/// As STMC's released code samples MDM-SMPL, and all of its published results: the factor of the noise is Sigma itself.
/// Differs from thesis eq. 6.2: as Sigma is below 1, motions have less noise than the distribution says.
inline constexpr SamplingOptions published_stmc_sampling{.noise_scale = NoiseScale::posterior_variance};
/// In the order of SamplingOptions::Sampler.
inline constexpr std::array<std::string_view, 3> sampler_names{"ddpm", "ddim", "plms"};
static_assert(static_cast<std::size_t>(SamplingOptions::Sampler::plms) + 1 == sampler_names.size());
std::string_view to_string(SamplingOptions::Sampler sampler);
/// "ddpm", "ddim" or "plms". Throws config_error 103.
SamplingOptions::Sampler parse_sampler(std::string_view name, std::string_view where = "sampler");
/// "paper": posterior_std, as thesis eq. 6.2 has it; "published": that of published_stmc_sampling. Throws config_error
/// 103.
NoiseScale parse_noise_scale(std::string_view name, std::string_view where = "noise scale");

/// Names of the steps in the literature: x0 (clean estimate), mean of the posterior, x_{t-1}.
template <Backend B, int R>
struct AncestralStep {
  Tensor<B, R> x0, mean, x_prev;
};

namespace detail {

struct KeepX0 {
  template <class T>
  T operator()(T x0, Index) const {
    return x0;
  }
};

template <Backend B, int R>
Tensor<B, R> clipped(const Tensor<B, R>& x) {
  return -maximum(-maximum(x, Tensor<B, R>(-1.0)), Tensor<B, R>(-1.0));
}
template <Backend B, int R, class Fix>
Tensor<B, R> clean_estimate(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output,
                            std::span<const Index> t, const StepOptions& options, const Fix& fix) {
  auto x0 = to_x0(d, options.prediction, output, x, t);
  if (options.clip) x0 = clipped(x0);
  return fix(std::move(x0), t.front());
}

}  // namespace detail

/// One step of Ho et al. (2020), algorithm 2: x_{t-1} = mean + factor noise, a sample of thesis eq. 6.2. t: one index
/// per sample, or one for all. If the network predicts x_{t-1}, this is the mean. Differs from thesis eq. 6.2 with
/// NoiseScale::posterior_variance: the factor is the variance, as in STMC's code.
template <Backend B, int R, class Fix = detail::KeepX0>
AncestralStep<B, R> ancestral_step(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output,
                                   const Tensor<B, R>& noise, std::span<const Index> t, const StepOptions& options = {},
                                   const Fix& fix = {}) {
  auto x0 = detail::clean_estimate(d, x, output, t, options, fix);
  auto mean = options.prediction == Prediction::x_prev ? output : posterior_mean(d, x0, x, t);
  // thesis eq. 6.2
  auto x_prev = mean + coefficients<B, R>(t, [&](Index i) {
                         return d.noise_factor(i, options.noise_scale, options.variance);
                       }) * noise;
  return {std::move(x0), std::move(mean), std::move(x_prev)};
}

/// Called after every step with the new index and the tensors of that step. Does nothing by default.
struct IgnoreSteps {
  void operator()(Index, const auto&) const {}
};

/// All steps from index `first` (-1: the last of the process) down to 0. Returns the x0 of the last step. It equals the
/// last x, because c0 is 1 and the noise factor 0 at t = 0. If the network predicts x_{t-1}, returns its last
/// prediction. Throws `cancelled` if progress returns false.
template <Backend B, int R, class Network, class Noise, class Fix = detail::KeepX0, class Watch = IgnoreSteps>
Tensor<B, R> sample_ancestral(const GaussianDiffusion& d, Tensor<B, R> x, Network&& network, Noise&& noise,
                              const StepOptions& options = {}, const Fix& fix = {}, Progress progress = {},
                              Index first = -1, const Watch& watch = {}) {
  if (first < 0) first = d.steps() - 1;
  for (Index t = first; t >= 0; --t) {
    const auto step = ancestral_step(d, x, network(x, t), noise(first - t), std::span(&t, 1), options, fix);
    watch(t, step);
    x = t > 0 || options.prediction == Prediction::x_prev ? step.x_prev : step.x0;
    progress(first - t + 1, first + 1);
  }
  return x;
}

/// One step of DDIM (Song et al. 2021, eq. 12): eta = 0 is deterministic, eta = 1 is ancestral sampling.
///     sigma = eta sqrt((1 - abarp) / (1 - abar)) sqrt(1 - abar / abarp)
///     x_{t-1} = sqrt(abarp) x0 + sqrt(1 - abarp - sigma^2) eps + [t > 0] sigma noise
/// Throws config_error 101 unless 0 <= eta <= 1.
template <Backend B, int R, class Fix = detail::KeepX0>
AncestralStep<B, R> ddim_step(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output,
                              const Tensor<B, R>* noise, Index t, double eta, const StepOptions& options = {},
                              const Fix& fix = {}) {
  if (!(eta >= 0 && eta <= 1)) raise<config_error>(101, "ddim_step: eta = ", eta, " is not in [0, 1]");
  const std::span<const Index> at(&t, 1);
  auto x0 = detail::clean_estimate(d, x, output, at, options, fix);
  const auto eps = eps_from_x0(d, x0, x, at);
  const double sigma = eta * std::sqrt((1 - d.abarp(t)) / (1 - d.abar(t))) * std::sqrt(1 - d.abar(t) / d.abarp(t));
  auto mean = x0 * std::sqrt(d.abarp(t)) + eps * std::sqrt(1 - d.abarp(t) - sigma * sigma);
  auto x_prev = noise != nullptr && t > 0 && sigma > 0 ? mean + *noise * sigma : mean;
  return {std::move(x0), std::move(mean), std::move(x_prev)};
}

/// A whole DDIM run, from index `first` on (-1: the last of the process). It saves time only on a respaced process.
/// `noise` is called only if eta > 0, but then at every step.
template <Backend B, int R, class Network, class Noise, class Fix = detail::KeepX0, class Watch = IgnoreSteps>
Tensor<B, R> sample_ddim(const GaussianDiffusion& d, Tensor<B, R> x, Network&& network, Noise&& noise, double eta,
                         const StepOptions& options = {}, const Fix& fix = {}, Progress progress = {},
                         const Watch& watch = {}, Index first = -1) {
  if (first < 0) first = d.steps() - 1;
  for (Index t = first; t >= 0; --t) {
    const auto output = network(x, t);
    const auto step = [&] {
      if (eta == 0) return ddim_step<B, R>(d, x, output, nullptr, t, eta, options, fix);
      const Tensor<B, R> z = noise(first - t);
      return ddim_step(d, x, output, &z, t, eta, options, fix);
    }();
    watch(t, step);
    x = step.x_prev;
    progress(first - t + 1, first + 1);
  }
  return x;
}

/// From a sample towards its noise: one step of DDIM from index t to t + 1 (eta = 0, backwards).
///     x_{t+1} = sqrt(abarn) x0 + sqrt(1 - abarn) eps
template <Backend B, int R>
Tensor<B, R> ddim_inversion_step(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output, Index t,
                                 const StepOptions& options = {}) {
  const std::span<const Index> at(&t, 1);
  const auto x0 = detail::clean_estimate(d, x, output, at, options, detail::KeepX0{});
  return x0 * std::sqrt(d.abarn(t)) + eps_from_x0(d, x0, x, at) * std::sqrt(1 - d.abarn(t));
}

/// Pseudo linear multistep (Liu et al. 2022) of order 2 ... 4: DDIM steps with an extrapolated eps. The first step
/// averages the eps at (x, t) and at the Euler prediction. Later steps use as many old values as there are. Returns the
/// x0 of the last step. Throws config_error 101 for another order.
template <Backend B, int R, class Network, class Watch = IgnoreSteps>
Tensor<B, R> sample_plms(const GaussianDiffusion& d, Tensor<B, R> x, Network&& network, int order,
                         const StepOptions& options = {}, Progress progress = {}, const Watch& watch = {}) {
  if (order < 2 || order > 4) raise<config_error>(101, "sample_plms: order ", order, " is not 2, 3 or 4");
  using T = Tensor<B, R>;
  auto predict = [&](const T& at_x, Index t) {
    const std::span<const Index> at(&t, 1);
    return eps_from_x0(d, detail::clean_estimate(d, at_x, network(at_x, t), at, options, detail::KeepX0{}), at_x, at);
  };
  auto advance = [&](const T& from, const T& eps, Index t) {
    auto x0 = to_x0(d, Prediction::eps, eps, from, std::span<const Index>(&t, 1));
    auto next = x0 * std::sqrt(d.abarp(t)) + eps * std::sqrt(1 - d.abarp(t));
    return AncestralStep<B, R>{std::move(x0), next, next};
  };
  std::vector<T> old;  // newest first
  for (Index t = d.steps() - 1; t >= 0; --t) {
    const T e = predict(x, t);
    T used = e;
    switch (t == 0 ? 0 : std::min<std::size_t>(old.size() + 1, static_cast<std::size_t>(order))) {
      case 0:  // the last step returns the network's own x0
        break;
      case 1:
        used = (e + predict(advance(x, e, t).x_prev, t - 1)) * 0.5;
        break;
      case 2:
        used = (e * 3.0 - old[0]) * (1.0 / 2);
        break;
      case 3:
        used = (e * 23.0 - old[0] * 16.0 + old[1] * 5.0) * (1.0 / 12);
        break;
      default:
        used = (e * 55.0 - old[0] * 59.0 + old[1] * 37.0 - old[2] * 9.0) * (1.0 / 24);
        break;
    }
    const auto step = advance(x, used, t);
    watch(t, step);
    x = t > 0 ? step.x_prev : step.x0;
    old.insert(old.begin(), e);
    if (old.size() >= static_cast<std::size_t>(order)) old.pop_back();
    progress(d.steps() - t, d.steps());
  }
  return x;
}

/// The whole reverse process with the sampler of the options. noise(0) is the initial x; noise(1), noise(2), ... belong
/// to the steps of a sampler that adds noise.
template <Backend B, int R, class Network, class Noise, class Watch = IgnoreSteps>
Tensor<B, R> sample(const GaussianDiffusion& d, Network&& network, Noise&& noise, const SamplingOptions& options,
                    Prediction prediction = Prediction::x0, Progress progress = {}, const Watch& watch = {}) {
  using enum SamplingOptions::Sampler;
  const auto of_step = [&](Index draw) { return noise(draw + 1); };
  const StepOptions step{.prediction = prediction, .noise_scale = options.noise_scale, .clip = options.clip};
  if (options.sampler == plms) return sample_plms<B, R>(d, noise(0), network, options.order, step, progress, watch);
  if (options.sampler == ddim)
    return sample_ddim<B, R>(d, noise(0), network, of_step, options.eta, step, detail::KeepX0{}, progress, watch);
  return sample_ancestral<B, R>(d, noise(0), network, of_step, step, detail::KeepX0{}, progress, -1, watch);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/diffusion/sampler.ipp>
#endif
