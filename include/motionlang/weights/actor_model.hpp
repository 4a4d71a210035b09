// SPDX-License-Identifier: MIT
/// A trained ACTOR with everything that belongs to it, and its folder. The folder of a classifier of actions
/// (weights/classifier_model.hpp) has the same form.
///
///     config.json            weights/model_folder.hpp: "system" actor or classifier, the configuration of the
///                            training, "labels"
///     weights.safetensors    the published names; motions are not normalised
///
///     const ActorModel<B> model(folder);   // ours, or as published: opt.yaml and checkpoint_5000.pth.tar
#pragma once

#include <filesystem>  // folders
#include <map>         // the record of a training
#include <optional>    // labels
#include <span>        // classes
#include <string>      // labels
#include <vector>      // labels

#include <motionlang/file/fields_json.hpp>
#include <motionlang/systems/actor.hpp>
#include <motionlang/weights/actor_file.hpp>
#include <motionlang/weights/actor_training_config.hpp>
#include <motionlang/weights/trained_model.hpp>
#include <motionlang/weights/vae_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The sizes of the network. Throws config_error 103 for unknown names.
ActorConfig actor_sizes(const ActorTrainingConfig& config, Index classes);

/// The contents of config.json for both.
template <class Config>
struct ActionModelFile {
  Config config;
  std::vector<std::string> labels;
};
/// `system` is "actor" or "classifier". Throws io_error 401, 403, config_error 102 for another system, 103, 107.
template <class Config>
ActionModelFile<Config> read_action_config(const std::filesystem::path& folder, const char* system) {
  const auto path = (folder / "config.json").string();
  const auto model = read_model_folder(folder);
  if (model.system != system)
    raise<config_error>(102, path, ": a model of '", model.system, "', not of '", system, "'");
  const nlohmann::json config = model.config, others = model.others;
  ActionModelFile<Config> file{{}, JsonView(others, path)["labels"].template as<std::vector<std::string>>()};
  read_config(file.config, JsonView(config, path + ": config"));
  return file;
}
/// `about`: license, provenance, data, command, ...
template <Module M, class Config>
void save_action_model(const std::filesystem::path& folder, const M& weights, const char* system,
                       const ActionModelFile<Config>& file, const std::map<std::string, std::string>& about) {
  TensorStore store;
  store.add_module(weights);
  auto model = described_model(system, about);
  model.features = "actor";
  model.fps = file.config.clips.fps;
  model.config = config_json(file.config);
  model.others["labels"] = file.labels;
  overwrite_model(folder, model, store);
}
inline SafetensorsFile open_action_weights(const std::filesystem::path& folder) {
  return SafetensorsFile::open(folder / "weights.safetensors");
}
template <Module M>
void load_action_weights(M& model, const SafetensorsFile& weights) {
  load_module(model, weights);
  prepare(model);
}

/// The settings of clips and losses of a published ACTOR: 60 frames as in its evaluation, 20 a second as in its viewer,
/// rotations in the world of a camera, and no common heading. Classes of HumanAct12 have its names, others their
/// numbers.
/// Throws config_error 102 for a model without the rotation of joint 0.
/// rotations  none: frames have the position of each joint
/// name       of the file that gives the settings, for messages
ActionModelFile<ActorTrainingConfig> published_actor_file(const ActorConfig& sizes,
                                                          const std::optional<ActorFeatureOptions>& rotations,
                                                          const ActorFrameOptions& frames, ActorPoints points,
                                                          std::vector<std::string> labels, const std::string& name);
/// The names of the classes of a published model.
std::vector<std::string> class_names(std::string_view dataset, Index classes);

/// A trained or published ACTOR, with what its folder says.
template <Backend B>
struct ActorModel {
  ActionModelFile<ActorTrainingConfig> file;
  Actor<B> actor;

  /// Throws what the readers throw.
  explicit ActorModel(const std::filesystem::path& folder) {
    if (const RunFolder run = find_run(folder); run.system == "actor") {
      auto published = load_actor_run<B>(run);
      file = published_actor_file(published.model.config, published.features, published.frames, published.points,
                                  std::move(published.labels), run.options_file.string());
      actor = std::move(published.model);
      return;
    }
    file = read_action_config<ActorTrainingConfig>(folder, "actor");
    const auto weights = open_action_weights(folder);
    const ActorConfig sizes = actor_sizes(file.config, std::ssize(file.labels));
    const auto room = detail::room_of(weights);
    NoInit zeros;
    actor = Actor<B>(sizes, zeros);
    load_action_weights(actor, weights);
  }

  /// Motions in the pose representation of a classifier, without the path of the root if it (ST-GCN) does not read it.
  Sequences<B> seen_by(const Sequences<B>& x, const ActorClipsConfig& seen) const {
    const ActorClipsConfig& clips = file.config.clips;
    if (clips.pose == seen.pose && clips.camera == seen.camera && clips.global == seen.global)
      return clips.width() == seen.width() ? x : x.with(slice(x.rows, 1, 0, seen.width()));
    if (seen.is_xyz()) return joint_points(x, clips);
    ActorClipsConfig as_they_are = seen;
    as_they_are.turned_ahead = false;
    const RowMaker maker = actor_row_maker(as_they_are);
    const std::vector<float> rows(x.rows.span().begin(), x.rows.span().end());
    std::vector<typename B::scalar> values;
    for (Index s = 0; s < x.count(); ++s) {
      const auto own = std::span(rows).subspan(static_cast<std::size_t>(x.offsets.begin(s) * clips.width()),
                                               static_cast<std::size_t>(x.offsets.length(s) * clips.width()));
      for (const double v : maker.rows(actor_motion(own, clips))) values.push_back(static_cast<typename B::scalar>(v));
    }
    return x.with(Tensor<B, 2>::from(values, {x.offsets.rows(), seen.width()}));
  }
  /// For each motion of x one of the same length, at a random place on the line between two latents: that of the motion
  /// and that of another motion of its class.
  Sequences<B> between(const Sequences<B>& x, const Sequences<B>& others, std::span<const Index> classes,
                       Philox& rng) const {
    actor.require_one_latent("motions between two others");
    std::vector<typename B::scalar> places(classes.size());
    rng.uniform(std::span(places));
    const auto share = Tensor<B, 2>::from(places, {x.count(), 1});
    const auto z = actor.encode(x, classes).mu * (1.0 - share) + actor.encode(others, classes).mu * share;
    return actor.decode(z, classes, x.offsets);
  }
};
/// Throws config_error 102 if a classifier of these clips cannot judge or learn from the motions of a model.
void require_same_clips(const ActorClipsConfig& model, const ActorClipsConfig& seen);
/// Throws config_error 102 if a model's frames are not rows that the settings of clips make.
void require_same_rows(const ActorClipsConfig& model, const ActorClipsConfig& clips);
/// A classifier's numbers for the actions of a model. Throws config_error 102 unless both have the same actions.
std::vector<Index> numbers_of(std::span<const std::string> actions, std::span<const std::string> classifier);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/actor_model.ipp>
#endif
