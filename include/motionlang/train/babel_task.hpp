// SPDX-License-Identifier: MIT
/// The common part of the trainings of SINC and TEACH: a model that reads word pieces or the states of a language
/// model, and is called many times.
#pragma once

#include <filesystem>  // folders
#include <string>      // labels
#include <utility>     // move
#include <vector>      // labels

#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/train/motion_batch.hpp>
#include <motionlang/train/text_task.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <AutodiffBackend A, template <class> class System>
class BabelTask : public TextTask<A, System> {
 public:
  using Base = TextTask<A, System>;
  using typename Base::B, typename Base::Config;

 protected:
  template <Backend T>
  using Model = TextMotionModel<T, System>;

  /// states       none: word pieces, learned from `words`
  /// statistics   a folder with those of the features; empty: those of the training motions
  BabelTask(Config config, const DescribedMotions& data, TextStates states, const std::vector<std::string>& words,
            const std::filesystem::path& statistics)
      : Base(std::move(config), data), states_(std::move(states)) {
    if (config_.validation.watch != "loss")
      raise<config_error>(103, "validation.watch '", config_.validation.watch, "' is not loss");
    std::optional<Index> width;
    if (states_) width = states_(std::span(&data.training.front().texts.front().text, 1)).width();
    Base::begin_model(width, words, statistics);
  }

  template <Backend T>
  Sequences<T> tokens(const Model<T>& model, const std::vector<std::string>& texts) const {
    if (!states_) return model.tokens(texts, nullptr);
    const EmbeddingCache states = states_(texts);
    return model.tokens(texts, &states);
  }

  using Base::config_;
  TextStates states_;
};

MOTIONLANG_NAMESPACE_END
