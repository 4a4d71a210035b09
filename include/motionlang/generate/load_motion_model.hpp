// SPDX-License-Identifier: MIT
/// Loads any model that makes motions from its file or folder: one of ours, or a published one.
///
///     const auto model = load_motion_model<EigenBackend<float>>("exps/humanact12");
///     const Motion motion = generate_motion(*model, whole_body_timeline("walk", 60), {.seed = 7});
///
/// Ours       a .safetensors file of STMC, or a folder with one; a folder of train-actor, train-temos, train-tmr,
///            train-sinc or train-teach, if `trained` of the options is load_trained_motion_model
/// Published  the folder of STMC, MDM, MotionDiffuse, ACTOR, TEMOS, TMR, TEACH, SINC, TM2T (weights/run_folder.hpp)
/// Compiling  this header compiles every system. If you need only one, include its own header: stmc_motion_model.hpp,
///            actor_latents.hpp, text_latents.hpp, babel_latents.hpp
#pragma once

#include <functional>  // models that are trained elsewhere

#include <motionlang/datasets/actor_clips.hpp>
#include <motionlang/generate/actor_latents.hpp>
#include <motionlang/generate/babel_latents.hpp>
#include <motionlang/generate/motion_model_place.hpp>
#include <motionlang/generate/stmc_motion_model.hpp>
#include <motionlang/text/known_words.hpp>
#include <motionlang/weights/mdm_action_run.hpp>
#include <motionlang/weights/stmc_checkpoint.hpp>
#include <motionlang/weights/text_motion_checkpoint.hpp>
#include <motionlang/weights/tm2t_run.hpp>
#include <motionlang/weights/vae_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A function that loads the folder of a model of our trainings, or of TMR.
using TrainedModelLoader =
    std::function<std::unique_ptr<MotionModel>(const MotionModelPlace& place, const ModelSources& sources)>;

struct MotionModelOptions {
  ModelSources sources{};
  TrainedModelLoader trained{};  // none: such models are refused
};

/// STMC of our own, and published STMC, MDM and MotionDiffuse. Throws config_error 103 for another system, and what
/// load_stmc throws.
template <Backend B>
std::unique_ptr<MotionModel> load_diffusion_motion_model(const MotionModelPlace& place,
                                                         const ModelSources& sources = {}) {
  if (!place.is_diffusion())
    raise<config_error>(103, place.path.string(), ": '", place.system, "' is not a diffusion model of texts");
  if (place.system.empty()) require_no_sources(place, sources);
  auto stmc =
      load_stmc<B>(FilePath(place.path), {.text_encoder = sources.text_encoder, .statistics = sources.statistics});
  if (!place.system.empty()) return stmc_motion_model(std::move(stmc));
  const FilePath file(stmc_model_file(place.path));
  KnownCaptions captions = load_known_captions<B>(file, stmc);
  return stmc_motion_model(std::move(stmc), known_words(SafetensorsFile::open(file).metadata()), std::move(captions));
}

/// ACTOR whose frames are rows of these clips.
template <Backend B>
std::unique_ptr<MotionModel> actor_motion_model_of_clips(Actor<B> actor, const std::vector<std::string>& labels,
                                                         const ActorClipsConfig& clips, Index longest) {
  return actor_motion_model<B>({.model = std::move(actor),
                                .labels = labels,
                                .fps = clips.fps,
                                .longest = longest,
                                .motion_of =
                                    [=](std::span<const typename B::scalar> rows) {
                                      Motion out = actor_motion(std::vector<float>(rows.begin(), rows.end()), clips);
                                      place_on_floor(out);  // its path starts at the first frame
                                      return out;
                                    },
                                .rows_of = actor_row_maker(clips).rows});
}

/// Published ACTOR.
template <Backend B>
std::unique_ptr<MotionModel> load_actor_motion_model(const FilePath& run) {
  auto actor = load_actor_run<B>(run);
  if (!actor.features) {
    return actor_motion_model_of_clips<B>(std::move(actor.model), actor.labels, published_actor_clips({}),
                                          actor.longest);
  }
  const ActorFeatureOptions options = *actor.features;
  const double fps = 20;  // the viewer's rate in the repository; the data state none
  return actor_motion_model<B>(
      {.model = std::move(actor.model),
       .labels = std::move(actor.labels),
       .fps = fps,
       .longest = actor.longest,
       .motion_of =
           [=](std::span<const typename B::scalar> rows) {
             return motion_of_actor(actor_inverse(rows, 24, options), fps);
           },
       .rows_of = [=](const Motion& motion) { return actor_rows_of_motion(motion, options); }});
}

/// Published TEMOS, TEACH or SINC.
template <Backend B>
std::unique_ptr<MotionModel> load_lightning_motion_model(const MotionModelPlace& place, const ModelSources& sources) {
  const CheckpointOptions options{.text_encoder = sources.text_encoder, .statistics = sources.statistics};
  const auto latents = [&](auto run) {
    return text_latents(detail::checkpoint_of<B>(std::move(run), place.path, options));
  };
  const RunFolder run = find_run(place.path);
  const TemosRunOptions files{options.text_encoder, options.statistics};
  if (place.system == "teach") return teach_motion_model(latents(load_teach_run<B>(run, files)));
  if (place.system == "sinc") return sinc_motion_model(latents(load_sinc_run<B>(run, files)));
  return text_motion_model(latents(load_temos_run<B>(run, files)));
}

/// Published MDM models of actions: one action for each motion.
template <Backend B>
class MdmActionMotionModel final : public SeparateMotionModel {
 public:
  explicit MdmActionMotionModel(MdmActionRun<B> run) : run_(std::move(run)) {}

  double fps() const override { return run_.fps; }
  std::string system() const override { return "a diffusion model"; }
  Index steps() const override { return run_.model.diffusion.steps(); }
  bool takes_actions() const override { return true; }

 private:
  Motion motion(const Timeline& timeline, Philox noise, const GenerateOptions& o) const override {
    const Interval& wanted = only_text(timeline);
    const MdmConfig& c = run_.model.denoiser.config;
    const Index action = action_of(wanted.text, run_.labels, c.num_actions), frames = wanted.end - wanted.start;
    if (frames > c.crop_frames)
      raise<timeline_error>(508, "'", wanted.text, "' has ", counted(frames, "frame"), ", the model makes ",
                            c.crop_frames);
    const auto made = run_.model.generate(std::span(&action, 1), noise,
                                          {.steps = o.steps.value_or(0),
                                           .guidance = o.guidance,
                                           .sampler = o.sampler.value_or(SamplingOptions::Sampler::ddpm)});
    const auto rows = slice(made.rows, 0, 0, frames);  // generated with the length of the training, and cut
    return motion_of_actor(actor_inverse(rows.span(), 24, run_.features), run_.fps);
  }

  MdmActionRun<B> run_;
};

/// Published TM2T: one text for each motion. The model decides the length.
template <Backend B>
class Tm2tMotionModel final : public SeparateMotionModel {
 public:
  explicit Tm2tMotionModel(Tm2tRun<B> run) : run_(std::move(run)) {}

  double fps() const override { return run_.fps; }
  std::string system() const override { return "TM2T"; }

 private:
  Motion motion(const Timeline& timeline, Philox noise, const GenerateOptions&) const override {
    const Interval& wanted = only_text(timeline);
    const auto words = run_.words.template encode<B>(std::span(&wanted.text, 1));
    const auto rows = run_.model.generate(words, noise).rows;
    if (rows.size(0) == 0)
      raise<numeric_error>(302, "the model ends its motion for '", wanted.text,
                           "' before the first frame; try another seed");
    const std::vector<double> numbers(rows.span().begin(), rows.span().end());
    return motion_of_features("guoh3dfeats", numbers, run_.width(), run_.fps);
  }

  Tm2tRun<B> run_;
};

template <Backend B>
std::unique_ptr<MotionModel> load_mdm_action_motion_model(const FilePath& run) {
  return std::make_unique<MdmActionMotionModel<B>>(load_mdm_action_run<B>(find_run(run)));
}
template <Backend B>
std::unique_ptr<MotionModel> load_tm2t_motion_model(const FilePath& run, const ModelSources& sources) {
  return std::make_unique<Tm2tMotionModel<B>>(
      load_tm2t_run<B>(find_run(run), {.tokenizer = sources.tokenizer, .words = sources.text_encoder}));
}

/// The model at a place, for any system. Throws config_error 103 for models of our trainings and TMR if the options
/// have no loader for them, option_error 102 for sources that the model does not take, and what its loader throws.
template <Backend B>
std::unique_ptr<MotionModel> load_motion_model(const MotionModelPlace& place, const MotionModelOptions& options = {}) {
  const std::string& system = place.system;
  const ModelSources& sources = options.sources;
  if (system == "actor") return load_actor_motion_model<B>(place.path);
  if (system == "temos" || system == "teach" || system == "sinc") return load_lightning_motion_model<B>(place, sources);
  if (system == "tm2t") return load_tm2t_motion_model<B>(place.path, sources);
  if (system == "mdm of actions") return load_mdm_action_motion_model<B>(place.path);
  if (place.is_trained()) {
    if (options.trained) return options.trained(place, sources);
    raise<config_error>(103, place.path.string(), ": no loader for '", system, "' was given");
  }
  return load_diffusion_motion_model<B>(place, sources);
}
template <Backend B>
std::unique_ptr<MotionModel> load_motion_model(const FilePath& path, const MotionModelOptions& options = {}) {
  return load_motion_model<B>(find_motion_model(path.string()), options);
}

MOTIONLANG_NAMESPACE_END
