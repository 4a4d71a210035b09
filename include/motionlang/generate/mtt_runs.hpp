// SPDX-License-Identifier: MIT
/// Makes the motions of STMC's tables with any model of timelines, and measures them: STMC and its baselines on the
/// timelines of MTT.
///
///     const auto texts = parse_mtt_texts(read_file("texts.txt"));
///     const auto timelines = mtt_timelines(texts, {.count = 8});
///     const TmrSearchEncoder<B> tmr(load_tmr<B>("examples/models/tmr_free"));
///     const auto model = load_motion_model<B>("examples/models/stmc_free.safetensors");
///     const auto rows = mtt_rows(*model, tmr, mtt_reference(tmr, texts), texts, timelines, mtt_method_runs());
///     use(mtt_table(rows, {.flavour = MttFlavour::as_coded}));
///
/// Motions are what the model itself calculates: texts are not cut, nothing is smoothed, floor and feet are not fixed.
/// Source  thesis 6.3; STMC (Petrovich et al., CVPR workshops 2024) generate_mtt.py
/// Differs from the program: noise comes from our generator, so figures differ by what another seed changes
#pragma once

#include <cstdint>   // seed
#include <optional>  // what the caller leaves to the model
#include <span>      // timelines
#include <string>    // modes
#include <vector>    // rows

#include <motionlang/generate/motion_model.hpp>
#include <motionlang/train/mtt_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct MttRunOptions {
  std::uint64_t seed = 1234;
  Index batch = 50;                         // timelines that are sampled together
  std::optional<Index> steps{};             // of denoising, 0: all; the default is the model's
  std::optional<double> guidance{};         // the default is the model's
  std::optional<NoiseScale> noise_scale{};  // the default is the model's
  AnyCommunicator communicator{};           // processes that share the batches; all get the motions of all
};

/// The rows of methods with one overlap, and those of STMC with other overlaps. Seconds.
/// modes  of the methods, as parse_stmc_mode names them; none: all
std::vector<MttRun> mtt_runs(std::span<const std::string> modes, double overlap, std::span<const double> overlaps);

/// HumanML3D's features of the motion of each timeline.
/// Throws  config_error 102 for a model of another frame rate or other features. option_error 102 for a model that does
///         not take timelines. timeline_error 508, before anything is made, if the model cannot make a crop of one.
///         `cancelled`
std::vector<std::vector<double>> mtt_made(const MotionModel& model, std::span<const TimelineInSeconds> timelines,
                                          const MttRun& run, const MttRunOptions& options = {}, Progress progress = {});

/// Throws timeline_error 508 if a crop of a timeline is longer in one of the runs than the model takes, 504 for a text
/// of the last frame alone.
void require_mtt_crops(const MotionModel& model, std::span<const TimelineInSeconds> timelines,
                       std::span<const MttRun> runs);

/// A row for each run, behind that of the recorded motions if there are any.
/// timelines  of these texts. Throws config_error 102 for one with another text, and what mtt_made throws
/// progress   counts hundredths of timelines
template <Backend B>
std::vector<MttRow> mtt_rows(const MotionModel& model, const TmrSearchEncoder<B>& tmr,
                             const MttReference<double>& reference, std::span<const MttText> texts,
                             std::span<const TimelineInSeconds> timelines, std::span<const MttRun> runs,
                             const MttRunOptions& options = {}, Progress progress = {}) {
  require_mtt_crops(model, timelines, runs);
  std::vector<MttMotion<double>> motions;
  for (const TimelineInSeconds& t : timelines) motions.push_back({to_frames(t, model.fps()), mtt_labels(texts, t), {}});
  std::vector<MttRow> out;
  if (!reference.motion_latents.empty()) out.push_back(mtt_recorded_row(reference));
  constexpr Index parts = 100;  // of a timeline
  const Index each = parts * std::ssize(timelines), all = each * std::ssize(runs);
  Index before = 0;
  for (const MttRun& run : runs) {
    const auto step = [&](Index done, Index total) { return progress(before + each * done / total, all), true; };
    auto made = mtt_made(model, timelines, run, options, step);
    for (std::size_t m = 0; m < motions.size(); ++m) motions[m].features = std::move(made[m]);
    out.push_back(mtt_row(tmr, reference, run, std::span<const MttMotion<double>>(motions)));
    before += each;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/mtt_runs.ipp>
#endif
