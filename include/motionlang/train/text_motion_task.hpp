// SPDX-License-Identifier: MIT
/// The common part of the trainings of TMR and TEMOS: texts as vectors, batches of motions with a text each.
#pragma once

#include <algorithm>    // max
#include <filesystem>   // folders
#include <optional>     // width
#include <span>         // numbers of motions
#include <string_view>  // measures to watch
#include <utility>      // move
#include <vector>       // texts of a batch

#include <motionlang/train/presets.hpp>
#include <motionlang/train/text_motion_batch.hpp>
#include <motionlang/train/text_motion_texts.hpp>
#include <motionlang/train/text_task.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The frames of the longest of these motions.
inline Index longest_of(const std::vector<ChosenText>& chosen) {
  Index out = 0;
  for (const ChosenText& c : chosen) out = std::max(out, c.text->frames.length);
  return out;
}

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
  std::vector<ChosenText> training_texts_of(Index step, Philox captions) const {
    return chosen_texts(data_->training, batches_(step, this->seed()), [&](const DescribedMotion& m) {
      return captions.below(static_cast<std::uint32_t>(m.texts.size()));
    });
  }
  /// Motions of the validation part with their first texts.
  TextMotionBatch<B> validation_batch(std::span<const Index> which) const {
    return text_motion_batch<B>(data_->validation, which, learner_.average.motion_normalizer,
                                [](const auto&) { return 0u; });
  }

  template <Backend T>
  TextMotionNoise<T> noise(const TextMotionBatch<T>& batch, const Philox& rng, Index first = 0) const {
    return noise_rows<T>(first, batch.motions.count(), config_.network.latent_dim, rng);
  }
  template <Backend T>
  Sequences<T> tokens(const Model<T>& model, const TextMotionBatch<T>& batch, const Context& context) const {
    return model.tokens(batch.texts, texts_.states ? &*texts_.states : nullptr, context);
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  TextMotionTexts<B> texts_;
};

MOTIONLANG_NAMESPACE_END
