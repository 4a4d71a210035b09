// A trained ACTOR, and a trained classifier of actions: how they are made, and their folders.
//
//     config.json            weights/model_folder.hpp: "system" actor or classifier, the configuration of the training,
//                            "labels"
//     weights.safetensors    the published names; motions are not normalised
//
// And ACTOR as it was published: a folder with opt.yaml and checkpoint_5000.pth.tar in the place of one of ours.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/metrics/gru_classifier.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/systems/actor.hpp>
#include <motionlang/weights/actor_file.hpp>
#include <motionlang/weights/run_folder.hpp>

#include "actor_config.hpp"
#include "model_description.hpp"

namespace program {

ml::ActorConfig actor_sizes(const ActorTrainingConfig& config, ml::Index classes);

/// One of the two classifiers.
template <ml::Backend B>
struct Classifier {
  std::optional<ml::GruClassifier<B>> gru;
  std::optional<ml::StGcn<B>> stgcn;
  bool drawn_state = false;  // of the GRU
  /// The points that the GRU reads of windows, unless they are those of our own skeleton.
  std::function<ml::Sequences<B>(const ml::Sequences<B>&, const ActorClipsConfig&)> points{};

  static constexpr auto fields() {
    return ml::fields("", &Classifier::gru, "", &Classifier::stgcn, "drawn_state", &Classifier::drawn_state);
  }
  static std::string official_key(const std::string& path) {
    return path.starts_with("recurrent") ? ml::GruClassifier<B>::official_key(path) : path;
  }
  Classifier() = default;
  /// Throws config_error 102, 103.
  Classifier(const ClassifierConfig& c, ml::Index classes, ml::Philox rng) : drawn_state(c.drawn_state) {
    if (c.kind == "gru") {
      gru.emplace(
          ml::GruClassifierConfig{
              .input_size = 72, .hidden_size = c.hidden_size, .num_layers = c.num_layers, .num_classes = classes},
          rng);
    } else if (c.kind == "stgcn") {
      if (c.clips.is_xyz() || c.clips.translation)
        ml::raise<ml::config_error>(102, "ST-GCN reads rotations alone: clips.pose = rot6d, clips.translation = false");
      const ml::Index w = c.width;
      ml::StGcnConfig sizes{.in_channels = c.clips.numbers(),
                            .num_classes = classes,
                            .channels = {w, w, w, w, 2 * w, 2 * w, 2 * w, 4 * w, 4 * w, 4 * w}};
      if (!c.clips.global) sizes.parents = ml::StGcnConfig::without_root(sizes.parents);
      stgcn.emplace(sizes, rng);
    } else {
      ml::raise<ml::config_error>(103, "kind '", c.kind, "' is not gru or stgcn");
    }
  }
  /// x: windows as `clips` describes them;   rng: of a state that is drawn
  ml::Recognition<B> operator()(const ml::Sequences<B>& x, const ActorClipsConfig& clips, const ml::Philox& rng) const {
    return gru ? by_gru(x, clips, rng) : (*stgcn)(x);
  }
  ml::Recognition<B> train(const ml::Sequences<B>& x, const ActorClipsConfig& clips, const ml::Philox& rng) {
    return gru ? by_gru(x, clips, rng) : stgcn->train(x);
  }

 private:
  ml::Recognition<B> by_gru(const ml::Sequences<B>& x, const ActorClipsConfig& clips, const ml::Philox& rng) const {
    const auto read = points ? points(x, clips) : joint_points(x, clips);
    if (!drawn_state) return (*gru)(read);
    auto own = rng.split("state");
    const auto h0 = gru->initial_state(x.count(), own);
    return (*gru)(read, &h0);
  }
};

/// What config.json says of either.
template <class Config>
struct ActionModelFile {
  Config config;
  std::vector<std::string> labels;
};
/// `system` is "actor" or "classifier". Throws io_error 401, 403, config_error 102 for another system, 103, 107.
template <class Config>
ActionModelFile<Config> read_action_config(const std::filesystem::path& folder, const char* system) {
  const auto path = (folder / "config.json").string();
  const auto model = ml::read_model_folder(folder);
  if (model.system != system)
    ml::raise<ml::config_error>(102, path, ": a model of '", model.system, "', not of '", system, "'");
  const nlohmann::json config = model.config, others = model.others;
  ActionModelFile<Config> file{{}, ml::JsonView(others, path)["labels"].template as<std::vector<std::string>>()};
  read_config(file.config, ml::JsonView(config, path + ": config"));
  return file;
}
/// `about`: license, provenance, data, command, ...
template <ml::Module M, class Config>
void save_action_model(const std::filesystem::path& folder, const M& weights, const char* system,
                       const ActionModelFile<Config>& file, const std::map<std::string, std::string>& about) {
  ml::TensorStore store;
  store.add_module(weights);
  auto model = described_model(system, about);
  model.features = "actor";
  model.fps = file.config.clips.fps;
  model.config = config_json(file.config);
  model.others["labels"] = file.labels;
  overwrite_model(folder, model, store);
}
inline ml::SafetensorsFile open_action_weights(const std::filesystem::path& folder) {
  return ml::SafetensorsFile::open(folder / "weights.safetensors");
}
template <ml::Module M>
void load_action_weights(M& model, const ml::SafetensorsFile& weights) {
  ml::load_module(model, weights);
  ml::prepare(model);
}

/// ACTOR as it was published: 60 frames as in its evaluation, 20 a second, which is what its viewer shows; rotations in
/// the world of a camera, however figures face. Classes of HumanAct12 have its names, others their numbers.
/// Throws what load_actor_run throws, config_error 102 for a model without the rotation of joint 0.
struct PublishedActor {
  ActionModelFile<ActorTrainingConfig> file;
  ml::Actor<ml::EigenBackend<float>> actor;
};
PublishedActor read_published_actor(const ml::RunFolder& run);
/// What the classes of a published model are called.
std::vector<std::string> class_names(std::string_view dataset, ml::Index classes);

/// A trained ACTOR, or a published one, with what its folder says.
template <ml::Backend B>
struct ActorModel {
  ActionModelFile<ActorTrainingConfig> file;
  ml::Actor<B> actor;

  /// Throws what the readers throw.
  explicit ActorModel(const std::filesystem::path& folder) {
    if (const ml::RunFolder run = ml::find_run(folder); run.system == "actor") {
      auto published = read_published_actor(run);
      file = std::move(published.file), actor = std::move(published.actor);
      return;
    }
    file = read_action_config<ActorTrainingConfig>(folder, "actor");
    const auto weights = open_action_weights(folder);
    const ml::ActorConfig sizes = actor_sizes(file.config, std::ssize(file.labels));
    const auto room = ml::detail::room_of(weights);
    ml::NoInit zeros;
    actor = ml::Actor<B>(sizes, zeros);
    load_action_weights(actor, weights);
  }

  /// Motions in the pose representation of a classifier, without the way of the root where it (ST-GCN) does not read
  /// it.
  ml::Sequences<B> seen_by(const ml::Sequences<B>& x, const ActorClipsConfig& seen) const {
    const ActorClipsConfig& clips = file.config.clips;
    if (clips.pose == seen.pose && clips.camera == seen.camera && clips.global == seen.global)
      return clips.width() == seen.width() ? x : x.with(ml::slice(x.rows, 1, 0, seen.width()));
    if (seen.is_xyz()) return joint_points(x, clips);
    ActorClipsConfig as_they_are = seen;
    as_they_are.turned_ahead = false;
    const RowMaker maker = actor_row_maker(as_they_are);
    const std::vector<float> rows(x.rows.span().begin(), x.rows.span().end());
    std::vector<typename B::scalar> values;
    for (ml::Index s = 0; s < x.count(); ++s) {
      const auto own = std::span(rows).subspan(static_cast<std::size_t>(x.offsets.begin(s) * clips.width()),
                                               static_cast<std::size_t>(x.offsets.length(s) * clips.width()));
      for (const double v : maker.rows(actor_motion(own, clips))) values.push_back(static_cast<typename B::scalar>(v));
    }
    return x.with(ml::Tensor<B, 2>::from(values, {x.offsets.rows(), seen.width()}));
  }
  /// For each motion of x one of the same length, at a random place on the line between two latents: that of the motion
  /// and that of another motion of its class.
  ml::Sequences<B> between(const ml::Sequences<B>& x, const ml::Sequences<B>& others,
                           std::span<const ml::Index> classes, ml::Philox& rng) const {
    std::vector<typename B::scalar> places(classes.size());
    rng.uniform(std::span(places));
    const auto share = ml::Tensor<B, 2>::from(places, {x.count(), 1});
    const auto z = actor.encode(x, classes).mu * (1.0 - share) + actor.encode(others, classes).mu * share;
    return actor.decode(z, classes, x.offsets);
  }
};
/// Throws config_error 102 if a classifier of these clips cannot judge or learn from the motions of a model.
void require_same_clips(const ActorClipsConfig& model, const ActorClipsConfig& seen);
/// Throws config_error 102 if a model's frames are no rows that the settings of clips make.
void require_same_rows(const ActorClipsConfig& model, const ActorClipsConfig& clips);
/// The numbers that a classifier gives to the actions of a model. Throws config_error 102 unless both know the same.
std::vector<ml::Index> numbers_of(std::span<const std::string> actions, std::span<const std::string> classifier);

/// A batch of windows.
template <ml::Backend B>
struct ActionBatch {
  ml::Sequences<B> x;
  std::vector<ml::Index> classes;
};
/// Every window is drawn with a generator of its own, so that it does not depend on the others.
template <ml::Backend B>
ActionBatch<B> action_batch(const std::vector<DescribedMotion>& motions, std::span<const ml::Index> classes,
                            std::span<const ml::Index> which, const ActorClipsConfig& clips, ml::Philox rng) {
  ActionBatch<B> out;
  std::vector<typename B::scalar> values;
  std::vector<ml::Index> lengths;
  for (const ml::Index i : which) {
    ml::PythonRandom random(std::uint64_t{rng.bits()});
    const auto window = actor_window(motions[static_cast<std::size_t>(i)], clips, random);
    values.insert(values.end(), window.begin(), window.end());
    lengths.push_back(std::ssize(window) / clips.width());
    out.classes.push_back(classes[static_cast<std::size_t>(i)]);
  }
  const ml::Offsets offsets{std::span<const ml::Index>(lengths)};
  out.x = {ml::Tensor<B, 2>::from(values, {offsets.rows(), clips.width()}), offsets};
  return out;
}

/// For each of these motions a random other one of its class, or itself where there is no other.
std::vector<ml::Index> others_of_class(std::span<const ml::Index> which, std::span<const ml::Index> classes,
                                       ml::Philox& rng);

/// Recorded motions and what an ACTOR makes of them, as a classifier reads them: the sets of thesis table 3.8. Every
/// call gives one motion for each that is asked for, of its action, as long as its window.
template <ml::Backend B>
struct RecognitionSets {
  using Numbers = std::span<const ml::Index>;

  const ActorModel<B>& model;
  const std::vector<DescribedMotion>& motions;
  Numbers classes;                // of the motions
  const ActorClipsConfig& clips;  // of the motions: the model's; any for `sampled`, which takes lengths alone
  const ActorClipsConfig& seen;   // by the classifier

  ActionBatch<B> recorded(Numbers which, const ml::Philox& windows) const {
    return shown(which, windows, [](const ActionBatch<B>& b) { return b.x; });
  }
  ActionBatch<B> denoised(Numbers which, const ml::Philox& windows) const {
    return shown(which, windows, [&](const ActionBatch<B>& b) { return ml::denoise(model.actor, b.x, b.classes); });
  }
  /// Between each motion and another of its action.
  ActionBatch<B> interpolated(Numbers which, const ml::Philox& windows, const ml::Philox& windows_of_others,
                              ml::Philox rng) const {
    return shown(which, windows, [&](const ActionBatch<B>& b) {
      const auto others = others_of_class(which, classes, rng);
      return model.between(b.x, batch(others, windows_of_others).x, b.classes, rng);
    });
  }
  ActionBatch<B> sampled(Numbers which, const ml::Philox& windows, ml::Philox noise) const {
    return shown(which, windows, [&](const ActionBatch<B>& b) {
      std::vector<ml::Index> lengths;
      for (ml::Index i = 0; i < b.x.count(); ++i) lengths.push_back(b.x.offsets.length(i));
      return ml::generate(model.actor, b.classes, lengths, noise);
    });
  }

 private:
  ActionBatch<B> batch(Numbers which, const ml::Philox& windows) const {
    return action_batch<B>(motions, classes, which, clips, windows);
  }
  template <class Make>
  ActionBatch<B> shown(Numbers which, const ml::Philox& windows, Make make) const {
    auto b = batch(which, windows);
    b.x = model.seen_by(make(b), seen);
    return b;
  }
};

}  // namespace program
