// SPDX-License-Identifier: MIT
/// Several motions of one timeline, which differ in their noise; motions between two texts; and names for them.
///
///     const auto five = generate_samples(stmc, timelines, 5, {.seed = 7});   // five[t][s]: sample s of timeline t
///     const auto names = sample_names("walk", timelines.size(), 5);          // walk_0_1, walk_0_2, ...
#pragma once

#include <concepts>     // results
#include <span>         // timelines
#include <string>       // names
#include <string_view>  // texts
#include <vector>       // motions

#include <motionlang/compose/timeline.hpp>
#include <motionlang/generate/generate_options.hpp>
#include <motionlang/generate/latent_motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Makes `samples` motions of each timeline in one run. The first sample of each timeline equals the motion of a run
/// without further samples. Throws option_error 101 unless samples is 1 or more, and what generate_motions throws.
/// model  a Stmc or a MotionModel, whose header you include
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

/// A motion and what it shows.
struct LabelledMotion {
  Motion motion{};
  Timeline timeline{};
};
/// LatentMotionModel::between of two texts or actions. Motions between them show "walk 75 %, run 25 %".
std::vector<LabelledMotion> generate_between(const LatentMotionModel& model, const Timeline& from, const Timeline& to,
                                             Index count, const GenerateOptions& options = {});

/// A text as the name of a file: its letters and digits of any script, the rest as '_', at most 40 bytes. "motion" if
/// there are none.
std::string result_name(std::string_view text);

/// The names of all samples, those of a timeline one after the other: NAME, or NAME_TIMELINE_SAMPLE with whatever there
/// are several of. Timelines count from 0, samples from 1.
std::vector<std::string> sample_names(const std::string& name, std::size_t timelines, Index samples);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/samples.ipp>
#endif
