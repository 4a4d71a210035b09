// SPDX-License-Identifier: MIT
// Bodies of mtt_runs.hpp.
#pragma once

#include <algorithm>  // min

#include <motionlang/compose/plan.hpp>
#include <motionlang/generate/mtt_runs.hpp>
#include <motionlang/train/shared_items.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline void require_mtt_rate(const MotionModel& model) {
  if (model.fps() != 20)
    raise<config_error>(102, "mtt_made: a model of ", model.fps(), " frames per second; timelines are measured at 20");
}

}  // namespace detail

MOTIONLANG_BODY void require_mtt_crops(const MotionModel& model, std::span<const TimelineInSeconds> timelines,
                                       std::span<const MttRun> runs) {
  detail::require_mtt_rate(model);
  for (const TimelineInSeconds& t : timelines) {
    const Timeline frames = to_frames(t, model.fps());
    for (const Interval& i : frames.intervals) {  // features describe one frame less than the motion has
      if (std::min(i.end, frames.end() - 1) <= i.start)
        raise<timeline_error>(504, "'", i.text, "' lasts for the last frame alone, which has no features to measure");
    }
  }
  for (const MttRun& run : runs) {
    const bool hard = run.mode == StmcMode::sinc || run.mode == StmcMode::sinc_lerp;
    const PlanOptions how{.overlap = frame_at(run.overlap, model.fps()),
                          .extend = !hard,
                          .transition_crops = !hard,
                          .hidden = HiddenTexts::ignore,
                          .longest_crop = model.longest_crop()};
    for (const TimelineInSeconds& t : timelines)
      plan_timeline(timeline_of_mode(run.mode, to_frames(t, model.fps()), model.fps()), how);
  }
}

MOTIONLANG_BODY std::vector<std::vector<double>> mtt_made(const MotionModel& model,
                                                          std::span<const TimelineInSeconds> timelines,
                                                          const MttRun& run, const MttRunOptions& options,
                                                          Progress progress) {
  detail::require_mtt_rate(model);
  if (options.batch < 1) raise<config_error>(101, "mtt_made: batches of ", options.batch, " timelines");
  const Index count = std::ssize(timelines), batches = count / options.batch + (count % options.batch != 0 ? 1 : 0);
  const auto made = [&](Index b, const Progress& of_batch) {
    const Index begin = b * options.batch, own = std::min(options.batch, count - begin);
    std::vector<Timeline> batch;
    for (Index i = begin; i < begin + own; ++i)
      batch.push_back(to_frames(timelines[static_cast<std::size_t>(i)], model.fps()));
    auto rng = Philox{.seed = options.seed}.split("mtt").split(static_cast<std::uint64_t>(begin));
    GenerateNotes notes;
    generate_motions(model, batch,
                     {.seed = begin == 0 ? options.seed : rng.below(0xFFFFFFFFu),
                      .steps = options.steps,
                      .noise_scale = options.noise_scale,
                      .guidance = options.guidance,
                      .mode = run.mode,
                      .overlap = run.overlap,
                      .cut_texts = false,
                      .smooth = false,
                      .fix_feet = false,
                      .fix_floor = false,
                      .progress = of_batch,
                      .notes = &notes});
    if (std::ssize(notes.features) != own)
      raise<option_error>(102, "mtt_made: timelines are for diffusion models of texts; this is ", model.system());
    MessageWriter rows;
    for (const auto& of_motion : notes.features)
      rows.list(std::span<const double>(mtt_features_of_rows(notes.layout, of_motion)));
    return rows.bytes();
  };
  std::vector<std::vector<double>> out;
  for (const std::string& message : shared_items(options.communicator, batches, made, progress)) {
    for (MessageReader in(message); !in.at_end();) out.push_back(in.list<double>());
  }
  return out;
}

MOTIONLANG_BODY std::vector<MttRun> mtt_runs(std::span<const std::string> modes, double overlap,
                                             std::span<const double> overlaps) {
  std::vector<MttRun> out;
  for (const MttRun& run : mtt_method_runs(overlap)) {
    if (modes.empty() || std::find(modes.begin(), modes.end(), to_string(run.mode)) != modes.end()) out.push_back(run);
  }
  for (const MttRun& run : mtt_overlap_runs(overlaps)) out.push_back(run);
  return out;
}

MOTIONLANG_NAMESPACE_END
