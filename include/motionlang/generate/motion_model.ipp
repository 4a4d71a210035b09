// SPDX-License-Identifier: MIT
// Bodies of motion_model.hpp.
#pragma once

#include <algorithm>  // find
#include <charconv>   // numbers of actions

#include <motionlang/generate/detail/kept_clip.hpp>
#include <motionlang/generate/motion_model.hpp>
#include <motionlang/generate/shared_motions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void check_options(const MotionModel& model, const GenerateOptions& o) {
  const auto is_given = [](const FilePath& file) { return !file.string().empty(); };
  if (!model.takes_timelines()) {
    if (o.mode != StmcMode::stmc)
      raise<option_error>(102, "`mode` is for diffusion models of texts (STMC, MDM, MotionDiffuse); this is ",
                          model.system());
    if (is_given(o.noise)) raise<option_error>(102, "`noise` is for diffusion models of texts; this one takes a seed");
    if (is_given(o.record) || is_given(o.reuse))
      raise<option_error>(
          102, "`record` and `reuse` are for diffusion models of texts; this one makes every motion in one step");
    if (o.recall)
      raise<option_error>(102, "`recall` is for diffusion models of texts, which may remember motions; this is ",
                          model.system());
    if (o.keep)
      raise<option_error>(
          102, "`keep` is for diffusion models of texts (STMC, MDM, MotionDiffuse); this one makes whole motions");
  }
  if (model.steps() == 0 && (o.steps || o.guidance || o.sampler || o.noise_scale))
    raise<option_error>(
        102, "`steps`, `sampler`, `noise_scale` and `guidance` are for diffusion models; this one takes no such steps");
  if (model.steps() > 0) detail::require_steps(o, model.steps());
  if (o.fact && !model.draws_latents())
    raise<option_error>(102, "`fact` is for models that draw a latent (ACTOR, TEMOS, TMR, SINC, TEACH); this is ",
                        model.system(), ", which draws none");
}

MOTIONLANG_BODY const KnownWords& MotionModel::words() const {
  static const KnownWords none;
  return none;
}
MOTIONLANG_BODY const KnownCaptions& MotionModel::captions() const {
  static const KnownCaptions none;
  return none;
}

MOTIONLANG_BODY std::vector<Motion> MotionModel::generate(std::span<const Timeline> timelines,
                                                          const GenerateOptions& options) const {
  check_options(*this, options);
  if (options.communicator.size() == 1) return make(timelines, options);
  return shared_motions(
      timelines, options, [&](std::span<const Timeline> part, const GenerateOptions& how) { return make(part, how); },
      [&] { require_shareable(timelines, options); });
}

MOTIONLANG_BODY std::vector<Motion> generate_motions(const MotionModel& model, std::span<const Timeline> timelines,
                                                     const GenerateOptions& options) {
  return model.generate(timelines, options);
}
MOTIONLANG_BODY Motion generate_motion(const MotionModel& model, const Timeline& timeline,
                                       const GenerateOptions& options) {
  return model.generate(std::span(&timeline, 1), options).front();
}

MOTIONLANG_BODY std::vector<Motion> SeparateMotionModel::make(std::span<const Timeline> timelines,
                                                              const GenerateOptions& options) const {
  std::vector<Motion> motions;
  const std::uint64_t before = options.before.size();
  for (std::size_t m = 0; m < timelines.size(); ++m) {
    motions.push_back(finish_motion(motion(timelines[m], noise_of(options, before + m), options), options));
    options.progress(static_cast<Index>(m) + 1, std::ssize(timelines));
  }
  return motions;
}

MOTIONLANG_BODY Timeline whole_body_timeline(std::string text, Index frames) {
  return {{{std::move(text), 0, frames, BodyParts::all()}}};
}

MOTIONLANG_BODY const Interval& only_text(const Timeline& timeline) {
  if (timeline.intervals.size() != 1)
    raise<timeline_error>(509, counted(timeline.intervals.size(), "text"),
                          " in a timeline; this model takes one, with a duration");
  return timeline.intervals.front();
}

MOTIONLANG_BODY Index action_of(const std::string& text, std::span<const std::string> labels, Index classes) {
  const auto found = std::find(labels.begin(), labels.end(), text);
  if (found != labels.end()) return found - labels.begin();
  Index number = -1;
  const char* const end = text.data() + text.size();
  if (std::from_chars(text.data(), end, number).ptr == end && number >= 0 && number < classes) return number;
  const std::string known = labels.empty() ? "" : "; they are called " + join_text(labels);
  raise<config_error>(103, "action '", text, "' is not one of 0 ... ", classes - 1, known);
}

MOTIONLANG_NAMESPACE_END
