// SPDX-License-Identifier: MIT
/// The common part of the trainings of TMR and TEMOS: texts as vectors, batches of motions with a text each.
#pragma once

#include <filesystem>   // folders
#include <optional>     // width
#include <span>         // numbers of motions
#include <string_view>  // measures to watch
#include <utility>      // move

#include <motionlang/train/presets.hpp>
#include <motionlang/train/text_motion_batch.hpp>
#include <motionlang/train/text_motion_texts.hpp>
#include <motionlang/train/text_task.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <AutodiffBackend A, template <class> class System>
class TextMotionTask : public TextTask<A, System> {
 public:
  using Base = TextTask<A, System>;
  using typename Base::B;

 protected:
  template <Backend T>
  using Model = TextMotionModel<T, System>;

  TextMotionTask(TextMotionConfig config, const DescribedMotions& data, TextMotionTexts<B> texts)
      : Base(std::move(config), data), texts_(std::move(texts)) {}

  /// Draws the weights that training begins with; statistics as for TextTask::begin_model.
  void begin_with_texts(const std::filesystem::path& statistics) {
    std::optional<Index> width;
    if (texts_.language)
      width = texts_.language->files.sizes.width;
    else if (texts_.states)
      width = texts_.states->width();
    Base::begin_model(width, Base::training_texts(), statistics, std::exchange(texts_.language, {}), texts_.vectors);
  }

  /// The motions of a step, each with one of its texts that `captions` draws.
  TextMotionBatch<A> training_batch(Index step, Philox captions) const {
    return text_motion_batch<A>(
        data_->training, batches_(step, this->seed()), learner_.model.motion_normalizer,
        [&](const DescribedMotion& m) { return captions.below(static_cast<std::uint32_t>(m.texts.size())); });
  }
  /// Motions of the validation part with their first texts.
  TextMotionBatch<B> validation_batch(std::span<const Index> which) const {
    return text_motion_batch<B>(data_->validation, which, learner_.average.motion_normalizer,
                                [](const auto&) { return 0u; });
  }

  template <Backend T>
  TextMotionNoise<T> noise(const TextMotionBatch<T>& batch, const Philox& rng) const {
    return TextMotionNoise<T>::draw(batch.motions.count(), config_.network.latent_dim, rng);
  }
  template <Backend T>
  Sequences<T> tokens(const Model<T>& model, const TextMotionBatch<T>& batch, const Context& context) const {
    return model.tokens(batch.texts, texts_.states ? &*texts_.states : nullptr, context);
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  TextMotionTexts<B> texts_;
};

MOTIONLANG_NAMESPACE_END
