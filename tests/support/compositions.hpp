// SPDX-License-Identifier: MIT
/// STMC and the baselines that it is compared with, by the same calls.
#pragma once

#include <motionlang/systems/sinc_baseline.hpp>

namespace compositions {

namespace ml = motionlang;

enum class Composition { stmc, sinc, sinc_lerp };
inline constexpr Composition all[] = {Composition::stmc, Composition::sinc, Composition::sinc_lerp};

inline ml::SincCuts cuts_of(Composition how) {
  return how == Composition::sinc ? ml::SincCuts::hard : ml::SincCuts::interpolated;
}

template <class Model>
auto generate(Composition how, const Model& model, std::span<const ml::Timeline> timelines, const ml::Philox& rng,
              const ml::StmcOptions& options = {}) {
  return how == Composition::stmc ? model.generate(timelines, rng, options)
                                  : ml::sinc_baseline(model, timelines, rng, options, cuts_of(how));
}
template <class Model, class Noise>
auto generate_from(Composition how, const Model& model, std::span<const ml::Timeline> timelines, const Noise& noise,
                   const ml::StmcOptions& options = {}) {
  return how == Composition::stmc
             ? model.generate_from(timelines, noise, options)
             : ml::sinc_baseline_from(model, ml::plan_timelines(timelines, ml::sinc_plan_options(model, options)),
                                      noise, options, cuts_of(how));
}

}  // namespace compositions
