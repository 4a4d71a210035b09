// SPDX-License-Identifier: MIT
/// The common part of the trainings of diffusion models, of texts (diffusion_training.hpp) and of actions
/// (mdm_action_training.hpp): the number of steps, the motions of a step, and the noise.
#pragma once

#include <algorithm>  // max
#include <map>        // settings
#include <string>     // names
#include <utility>    // move
#include <vector>     // draws

#include <motionlang/train/batch_parts.hpp>
#include <motionlang/train/diffusion_losses.hpp>
#include <motionlang/train/epoch_task.hpp>
#include <motionlang/weights/diffusion_folder.hpp>
#include <motionlang/weights/diffusion_training_config.hpp>
#include <motionlang/weights/trained_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The process of a configuration.
GaussianDiffusion diffusion_of(const DiffusionProcessConfig& c);

namespace detail {

/// The number of a training's steps: that of all epochs if `updates` is 0. Otherwise it is the first end of an epoch
/// after `updates` steps, as in MDM.
Index training_steps(Index updates, Index epochs, Index per_epoch);

/// The place of a step in batches that leave out the last one of an epoch: the step that `EpochBatches` with all of
/// them gives this batch.
Index step_with_last(Index step, Index per_epoch, Index with_last);

/// The folder of a model, from what the reader of published models takes.
ModelFolder described_diffusion(const std::string& system, const DiffusionRun& run,
                                const std::map<std::string, std::string>& about);

/// The draws for motions of a batch.
struct DiffusionDraws {
  std::vector<Index> t;
  std::vector<bool> kept;  // false: without its condition
};
/// All draws of the first motions are made, and those of the last `count` are returned.
/// steps  of the process;   drop  the probability that a condition is dropped
DiffusionDraws diffusion_draws(const Philox& rng, Index first, Index count, Index steps, double drop);

}  // namespace detail

/// `Base` is an EpochTask whose configuration has updates, optimiser, diffusion and require_consistent.
/// drops_last  the last batch of an epoch is left out if it is smaller
template <class Base, bool drops_last>
class DiffusionTask : public Base {
 public:
  using typename Base::A, typename Base::B, typename Base::Config;

  Index steps() const { return detail::training_steps(config_.updates, config_.optimiser.epochs, steps_per_epoch()); }
  void update(const Gradients<A>& gradients, Index step) {
    learner_.update(gradients, config_.optimiser.rate(step, steps()), step);
  }
  ValidationPlan validation() const {
    ValidationPlan plan = Base::validation();
    plan.every = config_.validation.every * steps_per_epoch() * (plan.every > 0 ? 1 : 0);
    return plan;
  }
  std::map<std::string, std::string> settings() const {
    auto out = Base::settings();
    out.erase("updates");  // a run may be extended
    return out;
  }
  Index samples(Index step) const { return std::ssize(motions_of(step)); }

 protected:
  template <class... More>
  DiffusionTask(std::string system, Config config, const DescribedMotions& data, More&&... more)
      : Base(std::move(system), std::move(config), data, std::forward<More>(more)...),
        diffusion_(diffusion_of(config_.diffusion)) {
    config_.require_consistent();
  }
  Index steps_per_epoch() const {
    return drops_last ? std::max<Index>(1, std::ssize(data_->training) / config_.optimiser.batch)
                      : batches_.per_epoch();
  }
  /// The numbers of the motions of a step.
  std::vector<Index> motions_of(Index step) const {
    return batches_(detail::step_with_last(step, steps_per_epoch(), batches_.per_epoch()), this->seed());
  }
  detail::DiffusionDraws draws(const Philox& rng, Index first, Index count, double drop) const {
    return detail::diffusion_draws(rng, first, count, diffusion_.steps(), drop);
  }
  /// first_row  of x0 in the batch from which the noise is drawn
  template <Backend T>
  static NoisedMotions<T> with_noise(const Sequences<T>& x0, Index first_row, const Philox& rng, std::vector<Index> t) {
    return {x0, normal_rows<T>(first_row, x0.rows.size(0), x0.width(), rng.split("noise")), std::move(t)};
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  GaussianDiffusion diffusion_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/diffusion_task.ipp>
#endif
