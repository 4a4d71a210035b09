// SPDX-License-Identifier: MIT
/// The first stage of Guo's evaluator: the autoencoder of movements. `motionlang train-evaluator --stage movement`
/// calls it.
///
///     const auto config = guo_preset("small", GuoStage::movement);
///     train(GuoMovementTraining<A>(config, data, tm2t_statistics<B>(data, {}, config.movement.feature_bias)),
///           {.out = "movement"}, about);
///
/// Source   Guo et al. (CVPR 2022), section 5.2; text-to-motion train_decomp_v3.py, networks/trainers.py
///          DecompTrainerV3
/// Differs  the published program writes the deviations of root and contacts divided by 25, because its two data sets
///          share them. Here they are divided twice on purpose. The last batch of an epoch is kept, and validation is
///          without dropout
#pragma once

#include <filesystem>  // folders
#include <map>         // the record of a training
#include <string>      // the record of a training
#include <utility>     // move
#include <vector>      // windows

#include <motionlang/metrics/guo_movement.hpp>
#include <motionlang/train/guo_config.hpp>
#include <motionlang/train/guo_model_folder.hpp>
#include <motionlang/train/tm2t_tokenizer_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws config_error 102 if no training motion is long enough for a window.
std::vector<ClipWindow> guo_training_windows(const GuoTrainingConfig& config, const DescribedMotions& data);

}  // namespace detail

template <AutodiffBackend A>
class GuoMovementTraining
    : public EpochTask<GuoTrainingConfig, MovementAutoencoder<A>, MovementAutoencoder<typename A::inner>> {
 public:
  using Base = EpochTask<GuoTrainingConfig, MovementAutoencoder<A>, MovementAutoencoder<typename A::inner>>;
  using typename Base::B;

  /// data        must outlive the training
  /// statistics  with reduced deviations of root and contacts: tm2t_statistics
  /// Throws      config_error 101, 102, 103 for an invalid configuration
  GuoMovementTraining(const GuoTrainingConfig& config, const DescribedMotions& data, Normalizer<B> statistics)
      : GuoMovementTraining(config, data, std::move(statistics), detail::guo_training_windows(config, data)) {}

  LossTerms<A> loss(const Philox& rng, Index step, const Context& context) {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(const Philox&, Index step, const BatchPart& part, const Context& context) {
    MotionBatch<B> batch(statistics_);
    const auto which = batches_(step, this->seed());
    for (const Index i : part.of(which)) {
      const ClipWindow& w = windows_[static_cast<std::size_t>(i)];
      batch.add(data_->training[static_cast<std::size_t>(w.clip)].rows, {w.start, config_.movement.window});
    }
    const auto x = detail::constants<A>(batch.normalized());
    return weighted(
        movement_losses<A>(learner_.model(x, context), x, config_.movement.sparsity, config_.movement.smooth),
        part.share(std::ssize(which)));
  }
  /// The loss of whole motions.
  std::vector<Measure> validate() {
    double reconstruction = 0;
    const double loss = this->over_validation([&](std::span<const Index> which, const Philox&) {
      MotionBatch<B> batch(statistics_);
      for (const Index i : which) {
        const auto& rows = data_->validation[static_cast<std::size_t>(i)].rows;
        batch.add(rows, {0, std::ssize(rows) / data_->width / 4 * 4});
      }
      const auto x = batch.normalized();
      const auto terms = movement_losses<B>(learner_.average(x), x, config_.movement.sparsity, config_.movement.smooth);
      reconstruction += static_cast<double>(terms.terms.at(0).value.item()) * static_cast<double>(which.size());
      return static_cast<double>(terms.total().item());
    });
    return {{"loss", loss}, {"reconstruction", reconstruction / static_cast<double>(data_->validation.size())}};
  }
  /// Writes the folder that the second stage reads, and the published programs: latest.tar and meta. `about`: license
  /// and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about) {
    save_guo_folder<B>(folder, "guo movement", config_, data_->fps, about, statistics_, nullptr);
    write_movement_autoencoder<B>(folder / "latest.tar", this->result(), config_.optimiser.epochs, this->steps());
  }

 private:
  GuoMovementTraining(const GuoTrainingConfig& config, const DescribedMotions& data, Normalizer<B> statistics,
                      std::vector<ClipWindow> windows)
      : Base("guo movement", config, data, std::ssize(windows)),
        windows_(std::move(windows)),
        statistics_(std::move(statistics)) {
    const auto& m = config_.movement;
    auto init = Philox{.seed = this->seed()}.split("init");
    this->begin(MovementAutoencoder<B>(data.width, m.hidden, m.latent, init, m.dropout));
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  std::vector<ClipWindow> windows_;
  Normalizer<B> statistics_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/guo_movement_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::GuoMovementTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::GuoMovementTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
