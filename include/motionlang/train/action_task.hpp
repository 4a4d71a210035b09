// SPDX-License-Identifier: MIT
/// The common part of the trainings of ACTOR and of classifiers of actions: windows of motions with the class of each,
/// and the folder of the model.
#pragma once

#include <filesystem>  // folders
#include <map>         // settings
#include <span>        // numbers of motions
#include <string>      // labels
#include <utility>     // move
#include <vector>      // classes

#include <motionlang/train/action_batch.hpp>
#include <motionlang/train/epoch_task.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// `Configuration` has clips, optimiser, validation and data.
template <class Configuration, Module Taped, Module Plain>
class ActionTask : public EpochTask<Configuration, Taped, Plain> {
 public:
  using Base = EpochTask<Configuration, Taped, Plain>;
  using typename Base::A, typename Base::B;

  std::map<std::string, std::string> settings() const {
    auto out = Base::settings();
    for (const std::string& l : labels_) out["labels"] += l + "\n";
    return out;
  }
  ActionModelFile<Configuration> file() const { return {config_, labels_}; }
  /// Writes the folder of the model. `about`: license and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about) {
    save_action_model(folder, this->result(), this->system_.c_str(), file(), about);
  }

 protected:
  ActionTask(std::string system, Configuration config, const DescribedMotions& data, std::vector<std::string> labels)
      : Base(std::move(system), std::move(config), data),
        labels_(std::move(labels)),
        classes_(classes_of(data.training, labels_)),
        validation_classes_(classes_of(data.validation, labels_)) {}
  ActionBatch<A> batch(const Philox& rng, Index step) const {
    return action_batch<A>(data_->training, classes_, batches_(step, this->seed()), config_.clips,
                           rng.split("windows"));
  }
  /// The same windows in every call.
  ActionBatch<B> validation_batch(std::span<const Index> which, const Philox& rng) const {
    return action_batch<B>(data_->validation, validation_classes_, which, config_.clips, rng.split("windows"));
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  std::vector<std::string> labels_;
  std::vector<Index> classes_, validation_classes_;
};

MOTIONLANG_NAMESPACE_END
