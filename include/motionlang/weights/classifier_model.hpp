// SPDX-License-Identifier: MIT
/// A classifier of actions, which judges generated motions: a GRU over the positions of joints, or ST-GCN over
/// rotations.
/// Its folder has the form of weights/actor_model.hpp.
///
///     const auto file = read_action_config<ClassifierConfig>(folder, "classifier");
///     Classifier<B> classifier(file.config, std::ssize(file.labels), Philox{});
///     load_action_weights(classifier, open_action_weights(folder));
#pragma once

#include <algorithm>   // max
#include <functional>  // points of a body
#include <optional>    // one of two

#include <motionlang/metrics/gru_classifier.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/weights/actor_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One of the two classifiers.
template <Backend B>
struct Classifier {
  std::optional<GruClassifier<B>> gru;
  std::optional<StGcn<B>> stgcn;
  bool drawn_state = false;  // of the GRU
  /// The points of windows that the GRU reads, if they are not those of our own skeleton.
  std::function<Sequences<B>(const Sequences<B>&, const ActorClipsConfig&)> points{};

  static constexpr auto fields() {
    return motionlang::fields("", &Classifier::gru, "", &Classifier::stgcn, "drawn_state", &Classifier::drawn_state);
  }
  static std::string official_key(const std::string& path) {
    return path.starts_with("recurrent") ? GruClassifier<B>::official_key(path) : path;
  }
  Classifier() = default;
  /// Throws config_error 102, 103.
  Classifier(const ClassifierConfig& c, Index classes, Philox rng) : drawn_state(c.drawn_state) {
    if (c.kind == "gru") {
      gru.emplace(
          GruClassifierConfig{
              .input_size = 72, .hidden_size = c.hidden_size, .num_layers = c.num_layers, .num_classes = classes},
          rng);
    } else if (c.kind == "stgcn") {
      if (c.clips.is_xyz() || c.clips.translation)
        raise<config_error>(102, "ST-GCN reads rotations alone: clips.pose = rot6d, clips.translation = false");
      const Index w = c.width;
      StGcnConfig sizes{.in_channels = c.clips.numbers(),
                        .num_classes = classes,
                        .channels = {w, w, w, w, 2 * w, 2 * w, 2 * w, 4 * w, 4 * w, 4 * w}};
      if (!c.clips.global) sizes.parents = StGcnConfig::without_root(sizes.parents);
      stgcn.emplace(sizes, rng);
    } else {
      raise<config_error>(103, "kind '", c.kind, "' is not gru or stgcn");
    }
  }
  /// x: windows as `clips` describes them;   rng: for a random initial state
  Recognition<B> operator()(const Sequences<B>& x, const ActorClipsConfig& clips, const Philox& rng) const {
    return gru ? by_gru(x, clips, rng, {}) : (*stgcn)(x);
  }
  /// The place of windows in the batch for which initial states are drawn.
  struct Place {
    Index first = 0, all = 0;  // all = 0: these windows are the batch
  };
  Recognition<B> train(const Sequences<B>& x, const ActorClipsConfig& clips, const Philox& rng, Place place = {},
                       const Context& context = {}) {
    return gru ? by_gru(x, clips, rng, place) : stgcn->train(x, context);
  }

 private:
  Recognition<B> by_gru(const Sequences<B>& x, const ActorClipsConfig& clips, const Philox& rng, Place place) const {
    const auto read = points ? points(x, clips) : joint_points(x, clips);
    if (!drawn_state) return (*gru)(read);
    auto own = rng.split("state");
    auto h0 = gru->initial_state(std::max(place.all, x.count()), own);
    if (h0.size(1) != x.count()) h0 = slice(h0, 1, place.first, place.first + x.count());
    return (*gru)(read, &h0);
  }
};

MOTIONLANG_NAMESPACE_END
