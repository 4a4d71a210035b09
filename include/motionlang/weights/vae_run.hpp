// SPDX-License-Identifier: MIT
/// ACTOR, TEMOS, TEACH and SINC from the folders of their repositories.
///
///     const auto actor = load_actor_run<B>("exps/humanact12");                  // opt.yaml, checkpoint_5000.pth.tar
///     const auto temos = load_temos_run<B>("kit-amass-xyz/5xp9647f", {.text_encoder = "distilbert-base-uncased",
///                                                                     .statistics = "deps/.../kit-amass-xyz"});
///
/// Sizes    from the shapes of the tensors; options that state them must agree. Heads and representation come from the
///          options
/// ACTOR    all networks of its repository (weights/actor_file.hpp)
/// TEMOS, TEACH, SINC  with DistilBERT inside the checkpoint; no run folder holds tokenizer and statistics. Their
///                     folders look alike: `lightning_system` tells them apart by their tensors
/// Source   what the training programs of ACTOR, TEMOS, TEACH and SINC write
/// Throws   io_error 401 with the name of a missing file; 404 for unsupported variants; 406, 407 for tensors;
///          config_error 101, 102 if options and tensors differ, 103, 107
#pragma once

#include <optional>  // rotations

#include <motionlang/datasets/action_names.hpp>
#include <motionlang/weights/actor_file.hpp>
#include <motionlang/weights/teach_sinc_file.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct ActorRun {
  Actor<B> model;
  std::optional<ActorFeatureOptions> features{};  // of rotations; none: frames have the position of each joint
  ActorPoints points = ActorPoints::vertices;     // that its loss compared
  ActorFrameOptions frames{};                     // of a training clip; their number: `longest`
  bool camera = true;                             // the figure is upside down: Y down, as in a camera's coordinates
  Index longest = 60;                             // frames of its training motions
  std::vector<std::string> labels;                // of the classes; empty if they are numbers
};

/// A model from texts to motions, with everything that it needs.
template <Backend B, class Model>
struct TextMotionRun {
  Model model;
  Normalizer<B> normalizer;
  AnyTextEncoder<B> text_encoder;
  double fps = 12.5;

  Index width() const { return normalizer.mean.count(); }
};
template <Backend B>
using TemosRun = TextMotionRun<B, Temos<B>>;
template <Backend B>
using TeachRun = TextMotionRun<B, Teach<B>>;
template <Backend B>
using SincRun = TextMotionRun<B, Sinc<B>>;

struct TemosRunOptions {
  // A folder of distilbert-base-uncased, or one with its tokenizer; by default searched beside the model.
  FilePath text_encoder = "";
  FilePath statistics = "";  // folder with jfeats_mean.pt and jfeats_std.pt (rfeats_ of SMPL models)
};

namespace detail {

void require_checkpoint(const RunFolder& run, const char* system, const char* wanted);

/// The folder of its tokenizer, or of the whole text encoder. Throws io_error 401.
std::filesystem::path temos_text_folder(const RunFolder& run, const TemosRunOptions& options);

/// The DistilBERT of the checkpoint with a tokenizer from another folder, or a whole encoder from another folder.
template <Backend B>
AnyTextEncoder<B> temos_text_encoder(const RunFolder& run, const TensorSet& weights, const TemosRunOptions& options) {
  const bool inside = weights.find("textencoder.text_model.embeddings.word_embeddings.weight") != nullptr;
  const std::filesystem::path folder = temos_text_folder(run, options);
  if (!inside) return load_text_encoder<B>(folder);
  AnyTokenizer tokenizer = tokenizer_of(folder, {}, false);
  RenamedTensors own(weights);  // the eval_model of older checkpoints of SINC also has a DistilBERT
  for (const TensorView& t : weights.tensors()) {
    if (t.name.starts_with("textencoder.text_model.")) own.add(t, t.name);
  }
  AnyTextNetwork<B> network{load_text_network<DistilBert<B>>(distilbert_config(own), own)};
  check_vocabulary(tokenizer, network, folder.string());
  return {std::move(tokenizer), std::move(network), {}};
}

}  // namespace detail

template <Backend B>
ActorRun<B> load_actor_run(const RunFolder& run) {
  detail::require_checkpoint(run, "actor", "checkpoint_0000.pth.tar");
  const WeightFile weights = open_weights(run.weights);
  const detail::RunReader r(run, weights, "");
  ActorRun<B> out;
  out.model = actor_network<B>(weights, run);
  out.longest = actor_longest(run, weights, out.model.config);
  if (!actor_has_positions(run, weights)) out.features = actor_point_options(run, weights).features;
  out.points = actor_loss_points(run, weights);
  out.frames = actor_frame_options(run, weights);
  const Index joints = out.features ? out.features->rows(24) : 24;
  if (out.model.config.njoints != joints && !out.features)
    raise<io_error>(404, run.options_file.string(), ": pose_rep is xyz, and ", weights.name(), " has ",
                    counted(out.model.config.njoints, "joint"), "; positions are supported for the 24 of SMPL");
  if (out.model.config.njoints != joints)
    raise<config_error>(102, run.options_file.string(), ": glob and translation make ", counted(joints, "row"),
                        " a frame, ", weights.name(), " has ", out.model.config.njoints);
  out.labels = action_labels(r.text("dataset", ""), out.model.config.num_classes);
  prepare_loaded(out.model);
  return out;
}
template <Backend B>
ActorRun<B> load_actor_run(const FilePath& folder) {
  return load_actor_run<B>(find_run(folder));
}

/// "temos", "teach" or "sinc", by the token between texts.
std::string lightning_system(const TensorSet& weights);
/// The system of a folder. Runs of TEACH and SINC look like those of TEMOS to weights/run_folder.hpp and differ in
/// their weights. Throws what find_run and open_weights throw.
std::string system_of_run(const FilePath& folder);

namespace detail {

/// The statistics in the options' folder, else in the weights of a packed run, else in the run's folder. Throws
/// io_error 401, 407.
template <Backend B>
Normalizer<B> temos_normalizer(const RunFolder& run, const TensorSet& weights, const TemosRunOptions& options) {
  const Index nfeats = RunReader(run, weights, "").size("motiondecoder.final_layer.weight", 0);
  return run_normalizer<B>(
      run, weights, nfeats, {"", "stats.", "motion_stats."},
      concat_text("the motions: put ",
                  nfeats == 135 ? "rfeats_mean.pt and rfeats_std.pt" : "jfeats_mean.pt and jfeats_std.pt",
                  " (deps/transforms/... of TEMOS) there, or name their folder"),
      options.statistics);
}

/// The statistics and the text encoder of a model. eps: of the inverse normalisation.
template <Backend B, class Model>
TextMotionRun<B, Model> text_motion_run(const RunFolder& run, const TensorSet& weights, Model model, double fps,
                                        double eps, const TemosRunOptions& options) {
  const RunReader r(run, weights, "");
  auto normalizer = temos_normalizer<B>(run, weights, options);
  normalizer.eps = eps;
  TextMotionRun<B, Model> out{.model = std::move(model),
                              .normalizer = std::move(normalizer),
                              .text_encoder = temos_text_encoder<B>(run, weights, options),
                              .fps = r.real("data/framerate", fps)};
  prepare_loaded(out.model);
  return out;
}
WeightFile lightning_weights(const RunFolder& run, const char* system);

}  // namespace detail

template <Backend B>
TemosRun<B> load_temos_run(const RunFolder& run, const TemosRunOptions& options = {}) {
  const WeightFile weights = detail::lightning_weights(run, "temos");
  return detail::text_motion_run<B>(run, weights, temos_network<B>(weights, run), 12.5, 0, options);
}
template <Backend B>
TeachRun<B> load_teach_run(const RunFolder& run, const TemosRunOptions& options = {}) {
  const WeightFile weights = detail::lightning_weights(run, "teach");
  return detail::text_motion_run<B>(run, weights, teach_network<B>(weights, run), 30, 0, options);
}
template <Backend B>
SincRun<B> load_sinc_run(const RunFolder& run, const TemosRunOptions& options = {}) {
  const WeightFile weights = detail::lightning_weights(run, "sinc");
  return detail::text_motion_run<B>(run, weights, sinc_network<B>(weights, run), 30, sinc_eps, options);
}
template <Backend B>
TemosRun<B> load_temos_run(const FilePath& folder, const TemosRunOptions& options = {}) {
  return load_temos_run<B>(find_run(folder), options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/vae_run.ipp>
#endif
