// SPDX-License-Identifier: MIT
/// The baseline of STMC: every text of a timeline is sampled alone, from its own noise. The motions are stitched once
/// at the end, body part by body part, with hard cuts.
///
///     const auto motions = sinc_baseline(stmc, std::span(&timeline, 1), Philox{.seed = 7});
///     const auto soft = sinc_baseline(stmc, std::span(&timeline, 1), Philox{.seed = 7}, {}, SincCuts::interpolated);
///
/// Source  SINC (Athanasiou et al. 2023) on a timeline, as in section 4.2 of STMC (Petrovich et al. 2024)
#pragma once

#include <motionlang/systems/stmc.ipp>

MOTIONLANG_NAMESPACE_BEGIN

/// The transition at which a body part changes from one text to another: none, or an interpolation around the cut.
enum class SincCuts { hard, interpolated };

namespace detail {

/// Frames of all crops, in batch order.
std::vector<Index> crop_lengths(const BatchPlan& plan);

}  // namespace detail

/// The options for planning timelines for the baseline: intervals do not reach into each other.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
PlanOptions sinc_plan_options(const Stmc<B, D, E>& stmc, const StmcOptions& options) {
  PlanOptions out = stmc.plan_options(options);
  out.extend = out.transition_crops = false;
  return out;
}

/// Takes a plan made with `sinc_plan_options`, and the caller's noise and clean estimates like Stmc::generate_from.
/// Every text is a sequence, and the collage is that of the texts alone. Returns one motion for each timeline, (frames,
/// features), not normalised.
template <Backend B, Denoiser<B> D, TextEncoder<B> E, class Noise, class Estimate>
std::vector<Tensor<B, 2>> sinc_baseline_from(const Stmc<B, D, E>& stmc, const BatchPlan& plan, Noise&& noise,
                                             const StmcOptions& options, SincCuts cuts, Estimate&& estimate) {
  const DenoiserTraits traits = stmc.denoiser.traits();
  const auto alone =
      stmc.sample(independent_plan(plan, traits.uses_lengths ? 0 : traits.crop_frames), noise, options, estimate);
  const std::vector<Index> lengths = detail::crop_lengths(plan);
  const auto texts = reshape<3>(alone.rows, {std::ssize(lengths), alone.stride, stmc.layout.size});
  const auto clips = from_padded(texts, std::span<const Index>(lengths));
  CleanMotions<B> whole{Stitcher<B>(plan, stmc.layout, clips.offsets, plan.frames)(clips.rows), plan.frames};
  if (cuts == SincCuts::interpolated) whole.rows = interpolate_transitions(plan, stmc.layout, whole.rows, whole.stride);
  return stmc.separate(whole, plan);
}

/// The same with the model's own estimates.
template <Backend B, Denoiser<B> D, TextEncoder<B> E, class Noise>
std::vector<Tensor<B, 2>> sinc_baseline_from(const Stmc<B, D, E>& stmc, const BatchPlan& plan, Noise&& noise,
                                             const StmcOptions& options = {}, SincCuts cuts = SincCuts::hard) {
  return sinc_baseline_from(
      stmc, plan, noise, options, cuts,
      [](const auto& collage, const auto& whole, const Tensor<B, 2>& x, Index t) { return whole(collage, x, t); });
}
/// The same from timelines and a generator. `first` of the options counts texts. Throws what Stmc::generate throws.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> sinc_baseline(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                                        const Philox& rng, const StmcOptions& options = {},
                                        SincCuts cuts = SincCuts::hard) {
  return sinc_baseline_from(
      stmc, plan_timelines(timelines, sinc_plan_options(stmc, options)),
      [&](Index draw, const Shape& shape) { return stmc.noise(rng, draw, shape, options.first); }, options, cuts);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/systems/sinc_baseline.ipp>
#endif
