// SPDX-License-Identifier: MIT
/// The common part of trainings on described motions: epochs of shuffled batches, a learner, validation, and the
/// settings that determine a run.
#pragma once

#include <map>      // settings
#include <string>   // names
#include <utility>  // move
#include <vector>   // parameters

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/file/fields_json.hpp>
#include <motionlang/optim/optimiser_config.hpp>
#include <motionlang/train/epoch_batches.hpp>
#include <motionlang/train/learner.hpp>
#include <motionlang/train/training_record.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// All settings that determine a step. The names of those that may change during a training begin with "training.".
std::map<std::string, std::string> task_settings(const std::string& system, std::size_t motions,
                                                 const std::map<std::string, std::string>& config);

}  // namespace detail

/// `Configuration` has the members optimiser and validation; `Plain` is the model, `Taped` the same on the tape. A task
/// for Trainer adds loss and validate, which may use `over_validation`.
template <class Configuration, Module Taped, Module Plain>
class EpochTask {
 public:
  using Config = Configuration;
  using B = module_backend<Plain>;
  using A = module_backend<Taped>;

  const Config& config() const { return config_; }
  std::uint64_t seed() const { return config_.optimiser.seed; }
  Index steps() const { return config_.optimiser.epochs * batches_.per_epoch(); }
  /// The number of motions in the batch of a step.
  Index samples(Index step) const { return batches_.size(step); }
  void update(const Gradients<A>& gradients, Index step) {
    learner_.update(gradients, config_.optimiser.rate(step, steps()), step);
  }
  std::vector<ModuleTensor<A>> parameters() { return tensors_of(learner_.model); }
  ValidationPlan validation() const {
    const auto& v = config_.validation;
    if (data_->validation.empty()) return {};
    return {.every = v.every * batches_.per_epoch(), .patience = v.patience, .keep_best = v.keep_best};
  }
  void keep_best() { learner_.best = learner_.average; }
  void add_to(TensorStore& store) const { learner_.add_to(store); }
  void load(const SafetensorsFile& file, Index steps_done) { learner_.load(file, steps_done); }
  std::map<std::string, std::string> settings() const {
    return detail::task_settings(system_, data_->training.size(), config_texts(config_));
  }
  /// The weights to keep: those of the best validation if that is wanted, otherwise the last.
  const Plain& result() {
    learner_.follow();
    return learner_.best ? *learner_.best : learner_.average;
  }

 protected:
  /// data  must outlive the task
  EpochTask(std::string system, Config config, const DescribedMotions& data)
      : EpochTask(std::move(system), std::move(config), data, std::ssize(data.training)) {}
  /// items: of an epoch, if they are not the motions. Throws config_error 103 for an unknown schedule.
  EpochTask(std::string system, Config config, const DescribedMotions& data, Index items)
      : system_(std::move(system)), config_(std::move(config)), data_(&data), batches_(items, config_.optimiser.batch) {
    config_.optimiser.rate(0, steps());
  }
  /// Sets the initial weights.
  void begin(Plain model) {
    learner_.average = std::move(model);
    detail::convert_module(learner_.model, learner_.average);
    learner_.adam.config = config_.optimiser.adamw();
    learner_.ema = config_.optimiser.ema;
    learner_.clip_norm = config_.optimiser.clip_norm;
  }

  /// Calls f(numbers of motions, generator) for the batches of the validation part, the same in every call. Returns the
  /// mean of its results, weighted by motions.
  template <class F>
  double over_validation(F f) {
    learner_.follow();
    const auto motions = std::ssize(data_->validation);
    const EpochBatches batches(motions, config_.optimiser.batch);
    double total = 0;
    for (Index k = 0; k < batches.per_epoch(); ++k) {
      const std::vector<Index> which = batches(k, 0);
      const auto rng = Philox{.seed = seed()}.split("validation").split(static_cast<std::uint64_t>(k));
      total += f(std::span<const Index>(which), rng) * static_cast<double>(which.size());
    }
    return total / static_cast<double>(motions);
  }

  std::string system_;
  Config config_;
  const DescribedMotions* data_;
  EpochBatches batches_;
  Learner<Taped, Plain> learner_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/epoch_task.ipp>
#endif
