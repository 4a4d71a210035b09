// SPDX-License-Identifier: MIT
/// Several motions of one timeline, which differ in their noise.
///
///     const auto five = generate_samples(stmc, timelines, 5, {.seed = 7});   // five[t][s]: sample s of timeline t
#pragma once

#include <concepts>  // results
#include <span>      // timelines
#include <vector>    // motions

#include <motionlang/compose/timeline.hpp>
#include <motionlang/generate/generate_options.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// `samples` motions of each timeline. All are made in one run. The first sample of each timeline is the motion of a
/// run without further samples. Throws option_error 101 unless samples is 1 or more, and what generate_motions throws.
/// model  a Stmc or a MotionModel, with its header
template <class Model>
std::vector<std::vector<Motion>> generate_samples(const Model& model, std::span<const Timeline> timelines,
                                                  Index samples, const GenerateOptions& options = {}) {
  if (samples < 1) raise<option_error>(101, "generate_samples: ", samples, " motions of a timeline");
  std::vector<Timeline> all;
  for (Index s = 0; s < samples; ++s) all.insert(all.end(), timelines.begin(), timelines.end());
  std::vector<Motion> motions = generate_motions(model, all, options);
  std::vector<std::vector<Motion>> out(timelines.size());
  for (std::size_t i = 0; i < motions.size(); ++i) out[i % timelines.size()].push_back(std::move(motions[i]));
  return out;
}

MOTIONLANG_NAMESPACE_END
