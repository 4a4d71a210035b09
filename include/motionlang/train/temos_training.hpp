// SPDX-License-Identifier: MIT
/// The training of TEMOS: motions from texts. `motionlang train-temos` calls it; train/tmr_training.hpp shows how to
/// use it.
///
/// Source   TEMOS (Petrovich, Black, Varol, ECCV 2022), section 3.3; thesis 4.2.3
#pragma once

#include <filesystem>  // folders
#include <span>        // numbers of motions
#include <utility>     // move
#include <vector>      // measures

#include <motionlang/systems/temos.hpp>
#include <motionlang/train/text_motion_task.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The losses of a configuration. Throws config_error 102 for a contrastive loss.
TemosLossOptions temos_loss_options(const TextMotionConfig& c);

template <AutodiffBackend A>
class TemosTraining : public TextMotionTask<A, Temos> {
 public:
  using Base = TextMotionTask<A, Temos>;
  using typename Base::B;

  /// `texts` holds all texts of `data`, which must outlive the training.
  /// statistics   a folder with those of the features; empty: those of the training motions
  /// Throws       config_error 101, 102, 103 for an invalid configuration
  TemosTraining(TextMotionConfig config, const DescribedMotions& data, TextMotionTexts<B> texts,
                const std::filesystem::path& statistics = {});
  /// With the word pieces of the data (text.encoder = word_pieces).
  TemosTraining(const TextMotionConfig& config, const DescribedMotions& data)
      : TemosTraining(config, data, text_motion_texts<B>(config.text, {}, data)) {}

  LossTerms<A> loss(Philox rng, Index step, const Context& context) const {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const;
  /// The loss without dropout, of first captions and always with the same noise.
  std::vector<Measure> validate();

 private:
  /// first: the number of the batch's first motion in the batch of the step;   longest: frames of that batch
  template <Backend T>
  LossTerms<T> loss_of(const TemosModel<T>& model, const TextMotionBatch<T>& batch, const Philox& rng,
                       const Context& context, Index first = 0, Index longest = 0) const;

  using Base::config_, Base::learner_;
};

template <AutodiffBackend A>
TemosTraining<A>::TemosTraining(TextMotionConfig config, const DescribedMotions& data, TextMotionTexts<B> texts,
                                const std::filesystem::path& statistics)
    : Base(std::move(config), data, std::move(texts)) {
  temos_loss_options(config_);
  if (config_.validation.watch != "loss")
    raise<config_error>(103, "validation.watch '", config_.validation.watch, "' is not loss");
  Base::begin_with_texts(statistics);
}

template <AutodiffBackend A>
LossTerms<A> TemosTraining<A>::part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const {
  const auto chosen = Base::training_texts_of(step, rng.split("captions"));
  const auto batch = text_motion_batch<A>(part.of(chosen), learner_.model.motion_normalizer);
  return weighted(loss_of(learner_.model, batch, rng.split("noise"), context, part.first, longest_of(chosen)),
                  part.share(std::ssize(chosen)));
}

template <AutodiffBackend A>
std::vector<Measure> TemosTraining<A>::validate() {
  return {{"loss", Base::over_validation([&](std::span<const Index> which, const Philox& rng) {
             const auto batch = Base::validation_batch(which);
             return static_cast<double>(loss_of(learner_.average, batch, rng, {}).total().item());
           })}};
}

template <AutodiffBackend A>
template <Backend T>
LossTerms<T> TemosTraining<A>::loss_of(const TemosModel<T>& model, const TextMotionBatch<T>& batch, const Philox& rng,
                                       const Context& context, Index first, Index longest) const {
  const auto branches = model.system.branches(Base::tokens(model, batch, context), batch.motions,
                                              Base::noise(batch, rng, first), context);
  auto options = temos_loss_options(config_);
  options.padded_frames = longest;
  return temos_losses(branches, batch.motions, options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/temos_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::TemosTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::TemosTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
