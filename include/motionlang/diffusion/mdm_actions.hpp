// SPDX-License-Identifier: MIT
/// MDM for actions: generates motions for classes, with an action instead of a text.
///
///     const GaussianDiffusion diffusion(CosineSchedule{.steps = 1000});
///     const MdmActions<B> mdm{.denoiser = network, .diffusion = diffusion};
///     // Frames of rotations and path, as in ACTOR.
///     const auto motions = mdm.generate(actions, Philox{.seed = 7});
///
/// An unconstrained model (HumanAct12 without its classes) has one class, which it ignores.
/// Source  Tevet et al., "Human motion diffusion model" (ICLR 2023), section 4.2; MDM model/mdm.py
#pragma once

#include <motionlang/core/rng.hpp>
#include <motionlang/diffusion/guidance.hpp>
#include <motionlang/diffusion/mdm.hpp>
#include <motionlang/diffusion/sampler.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct MdmActionOptions {
  Index steps = 0;                   // evenly chosen from the model's; 0: all
  std::optional<double> guidance{};  // the model's own unless given
  SamplingOptions::Sampler sampler = SamplingOptions::Sampler::ddpm;
  Progress progress{};
};

template <Backend B>
struct MdmActions {
  MdmDenoiser<B> denoiser;  // conditioned on actions, or on nothing
  GaussianDiffusion diffusion;
  double guidance = 1;  // the published models were trained without empty actions, so they have no guidance

  /// A motion of the denoiser's `crop_frames` for each action. The noise of a motion depends on the generator and on
  /// its place.
  /// Throws  shape_error 203 for an action that is not a class; config_error 102 for a denoiser of texts; `cancelled`
  Sequences<B> generate(std::span<const Index> actions, const Philox& rng, const MdmActionOptions& options = {}) const {
    using S = typename B::scalar;
    const MdmConfig& c = denoiser.config;
    if (c.condition == MdmCondition::text)
      raise<config_error>(102, "MdmActions: the denoiser is not conditioned on actions");
    const Index n = std::ssize(actions), frames = c.crop_frames;
    const double weight = c.condition == MdmCondition::none ? 1 : options.guidance.value_or(guidance);
    std::vector<S> one_hot(static_cast<std::size_t>(n * c.num_actions));
    for (Index i = 0; i < n; ++i) {
      const Index action = actions[static_cast<std::size_t>(i)];
      if (action < 0 || action >= c.num_actions)
        raise<shape_error>(203, "MdmActions: action ", action, " of ", c.num_actions);
      one_hot[static_cast<std::size_t>(i * c.num_actions + action)] = 1;
    }
    const auto wanted = TextFeatures<B>::pooled(Tensor<B, 2>::from(one_hot, {n, c.num_actions}));
    const auto nothing = TextFeatures<B>::pooled(Tensor<B, 2>::zeros({n, c.num_actions}));
    const Offsets offsets = Offsets::equal(n, frames);
    const GaussianDiffusion process = with_steps(diffusion, options.steps);

    const auto network = [&](const Tensor<B, 2>& x, Index t) {
      const std::vector<Index> at(static_cast<std::size_t>(n), process.network_t(t));
      const auto of = [&](const TextFeatures<B>& f) { return denoiser(Sequences<B>(x, offsets), at, f).rows; };
      // Two calls, because the GRU runs over its batch.
      return weight == 1 ? of(wanted) : guide(of(wanted), of(nothing), weight);
    };
    const auto noise = [&](Index draw) {
      return reshape<2>(sequence_noise<B>(rng, draw, {n, frames, c.nfeats}), {n * frames, c.nfeats});
    };
    return {sample<B, 2>(process, network, noise, {.sampler = options.sampler}, denoiser.traits().prediction,
                         options.progress),
            offsets};
  }
};

MOTIONLANG_NAMESPACE_END
