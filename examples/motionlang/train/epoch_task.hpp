// What trainings on described motions have in common: epochs of shuffled batches, a learner, validation, what decides a
// run.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "config_json.hpp"
#include "described_motions.hpp"
#include "learner.hpp"
#include "optimiser_config.hpp"

namespace program {

/// `Config` has optimiser and validation; `Plain` is the model, `Tape` the same on the tape. A task for Trainer adds
/// loss and validate, which may use `over_validation`.
template <class Config, ml::Module Tape, ml::Module Plain>
class EpochTask {
 public:
  using B = TrainingBackend;
  using A = TrainingTape;

  const Config& config() const { return config_; }
  std::uint64_t seed() const { return config_.optimiser.seed; }
  ml::Index steps() const { return config_.optimiser.epochs * batches_.per_epoch(); }
  void update(const ml::Gradients<A>& gradients, ml::Index step) {
    learner_.update(gradients, config_.optimiser.rate(step, steps()), step);
  }
  ValidationPlan validation() const {
    const auto& v = config_.validation;
    if (data_->validation.empty()) return {};
    return {.every = v.every * batches_.per_epoch(), .patience = v.patience, .keep_best = v.keep_best};
  }
  void keep_best() { learner_.best = learner_.average; }
  void add_to(ml::TensorStore& store) const { learner_.add_to(store); }
  void load(const ml::SafetensorsFile& file, ml::Index steps_done) { learner_.load(file, steps_done); }
  /// Everything that decides what a step computes; what may be changed on the way begins with "training.".
  std::map<std::string, std::string> settings() const {
    std::map<std::string, std::string> out{{"model", system_ + " training"},
                                           {"data.motions", std::to_string(data_->training.size())}};
    for (const auto& [name, value] : config_texts(config_)) {
      if (name == "optimiser.epochs" || name.starts_with("validation.")) continue;
      const bool free = name.starts_with("optimiser.") || name.starts_with("losses.");
      out[free ? "training." + name : name] = value;
    }
    return out;
  }
  /// The weights that are worth keeping: of the best validation where that is wanted, else the last.
  const Plain& result() {
    learner_.follow();
    return learner_.best ? *learner_.best : learner_.average;
  }

 protected:
  EpochTask(std::string system, Config config, const DescribedMotions& data)
      : EpochTask(std::move(system), std::move(config), data, std::ssize(data.training)) {}
  /// items: of an epoch, where they are not the motions. Throws config_error 103 for an unknown schedule.
  EpochTask(std::string system, Config config, const DescribedMotions& data, ml::Index items)
      : system_(std::move(system)), config_(std::move(config)), data_(&data), batches_(items, config_.optimiser.batch) {
    config_.optimiser.rate(0, steps());
  }
  /// The weights that training begins with.
  void begin(Plain model) {
    learner_.average = std::move(model);
    ml::detail::convert_module(learner_.model, learner_.average);
    learner_.adam.config = config_.optimiser.adamw();
    learner_.ema = config_.optimiser.ema;
    learner_.clip_norm = config_.optimiser.clip_norm;
  }

  /// Calls f(numbers of motions, generator) for the batches of the validation part, the same every time. Returns the
  /// mean of what it gives, weighted by motions.
  template <class F>
  double over_validation(F f) {
    learner_.follow();
    const auto motions = std::ssize(data_->validation);
    const EpochBatches batches(motions, config_.optimiser.batch);
    double total = 0;
    for (ml::Index k = 0; k < batches.per_epoch(); ++k) {
      const std::vector<ml::Index> which = batches(k, 0);
      const auto rng = ml::Philox{.seed = seed()}.split("validation").split(static_cast<std::uint64_t>(k));
      total += f(std::span<const ml::Index>(which), rng) * static_cast<double>(which.size());
    }
    return total / static_cast<double>(motions);
  }

  std::string system_;
  Config config_;
  const DescribedMotions* data_;
  EpochBatches batches_;
  Learner<Tape, Plain> learner_;
};

}  // namespace program
