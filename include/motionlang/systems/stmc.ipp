// SPDX-License-Identifier: MIT
// Bodies of the templates of stmc.hpp, for every backend, denoiser and text encoder. Any header may include them.
#pragma once

#include <algorithm>  // fill_n
#include <string>     // texts
#include <vector>     // lengths

#include <motionlang/compose/collage.hpp>
#include <motionlang/systems/detail/stmc_parts.hpp>
#include <motionlang/systems/stmc.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <class T>
struct StmcBodies {};

}  // namespace detail

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate(std::span<const Timeline> timelines, const Philox& rng,
                                                  const StmcOptions& options) const {
  return generate_from(
      timelines, [&](Index draw, const Shape& shape) { return noise(rng, draw, shape, options.first); }, options);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Tensor<B, 2> Stmc<B, D, E>::generate(const Timeline& timeline, const Philox& rng, const StmcOptions& options) const {
  return generate(std::span(&timeline, 1), rng, options).front();
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
PlanOptions Stmc<B, D, E>::plan_options(const StmcOptions& options) const {
  return {.overlap = options.overlap,
          .gaps = options.gaps,
          .hidden = options.hidden,
          .longest_crop = denoiser.traits().longest()};
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
template <class Noise, bool>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                                       const StmcOptions& options) const {
  return generate_from(
      timelines, noise, options,
      [](const auto& collage, const auto& whole, const Tensor<B, 2>& x, Index t) { return whole(collage, x, t); });
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
template <class Noise, class Estimate, bool>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                                       const StmcOptions& options, Estimate&& estimate) const {
  return generate_from(plan_timelines(timelines, plan_options(options)), noise, options, estimate);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
template <class Noise, class Estimate, bool>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate_from(BatchPlan plan, Noise&& noise, const StmcOptions& options,
                                                       Estimate&& estimate) const {
  return separate(sample(plan, noise, options, estimate), plan);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
template <class Noise, class Estimate, bool>
CleanMotions<B> Stmc<B, D, E>::sample(BatchPlan plan, Noise&& noise, const StmcOptions& options,
                                      Estimate&& estimate) const {
  if (!(options.recall >= 0 && options.recall <= 1))
    raise<config_error>(101, "Stmc: a recall of ", options.recall, " is not in 0 ... 1");
  const auto [text, null] = encode(plan);
  if (options.first > 0)
    detail::require_own_motions(denoiser.traits().mates, /*one_token=*/text.tokens.offsets.longest() <= 1);
  Collage<B, D> collage(denoiser, std::move(plan), layout, text, null, options.guidance.value_or(guidance),
                        options.rows_at_once);
  const auto sequences = static_cast<Index>(collage.plan().timelines.size());
  const Shape shape{sequences, collage.stride(), layout.size};
  auto rows = [&](Index draw) {
    const Tensor<B, 3> z = noise(draw, shape);
    if (z.shape() != shape) raise<shape_error>(204, "Stmc: noise ", z.shape(), " where ", shape, " is needed");
    return reshape<2>(z, {sequences * collage.stride(), layout.size});
  };
  const Tensor<B, 2> first = rows(0);
  if (memory && options.recall > 0)
    collage.follow(recalled_motions(*memory, collage.plan(), first, collage.stride(), motion_normalizer),
                   options.recall);
  const GaussianDiffusion kept = process(options.steps);
  const auto whole = [&](const Collage<B, D>& c, const Tensor<B, 2>& x, Index t) {
    return clean_motion(c, kept, denoiser.traits().prediction, x, t);
  };
  auto x0 = sample_clean_motions<B>(
      kept, [&](const Tensor<B, 2>& x, Index t) { return estimate(collage, whole, x, t); },
      [&](Index draw) { return draw == 0 ? first : rows(draw); }, options.sampling.value_or(sampling),
      options.progress);
  return {std::move(x0), collage.stride()};
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::separate(const CleanMotions<B>& clean, const BatchPlan& plan) const {
  std::vector<Tensor<B, 2>> out;
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    const Index first = static_cast<Index>(m) * clean.stride;
    out.push_back(motion_normalizer.denormalize(slice(clean.rows, 0, first, first + plan.timelines[m].frames)));
  }
  return out;
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Tensor<B, 3> Stmc<B, D, E>::noise(const Philox& rng, Index draw, const Shape& shape, Index first) const {
  return sequence_noise<B>(rng, draw, shape, first);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
GaussianDiffusion Stmc<B, D, E>::process(std::optional<Index> wanted) const {
  return with_steps(diffusion, wanted.value_or(steps));
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
auto Stmc<B, D, E>::encode(const BatchPlan& plan) const -> PlanTexts {
  const detail::DifferentTexts different(plan);
  auto features = text_encoder.template encode<B>(std::span<const std::string>(different.texts));
  features.tokens.rows = text_normalizer.normalize(features.tokens.rows);
  if (denoiser.traits().empty_text_is_null) {
    std::vector<typename B::scalar> keep(static_cast<std::size_t>(features.tokens.rows.size(0)), 1);
    std::fill_n(keep.begin(), features.tokens.offsets.length(0), typename B::scalar{0});
    features.tokens.rows = features.tokens.rows * Tensor<B, 2>::from(keep, {std::ssize(keep), 1});
  }
  return {gather(features, different.which), gather(features, std::vector<Index>{0})};
}

template <Backend B>
Motion stmc_motion(const Tensor<B, 2>& features, double fps) {
  const std::vector<double> values(features.span().begin(), features.span().end());
  return detail::published_motion(values, fps);
}

/// The same model over another backend, with copies of all numbers.
template <Backend To, Backend From, template <class> class D, template <class> class E>
Stmc<To, D<To>, E<To>> convert_stmc(const Stmc<From, D<From>, E<From>>& m) {
  return {.denoiser = convert<To>(m.denoiser),
          .text_encoder = convert<To>(m.text_encoder),
          .motion_normalizer = convert<To>(m.motion_normalizer),
          .text_normalizer = convert<To>(m.text_normalizer),
          .diffusion = m.diffusion,
          .layout = m.layout,
          .guidance = m.guidance,
          .sampling = m.sampling,
          .steps = m.steps,
          .fps = m.fps,
          .memory = m.memory};
}

/// Weights packed for inference. The model must not be changed afterwards.
template <Backend B, class D, class E>
void prepare(Stmc<B, D, E>& stmc) {
  prepare(stmc.denoiser);
  if constexpr (Module<E>) prepare(stmc.text_encoder);
}

MOTIONLANG_NAMESPACE_END
