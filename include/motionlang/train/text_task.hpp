// SPDX-License-Identifier: MIT
/// The common part of the trainings of TMR, TEMOS, SINC and TEACH: a model that reads word pieces or the states of a
/// language model, and its folder.
#pragma once

#include <filesystem>  // folders
#include <map>         // settings
#include <optional>    // word pieces
#include <string>      // texts
#include <utility>     // move
#include <vector>      // texts

#include <motionlang/train/batch_parts.hpp>
#include <motionlang/train/epoch_task.hpp>
#include <motionlang/train/feature_statistics.hpp>
#include <motionlang/weights/text_motion_model.hpp>
#include <motionlang/weights/text_states.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The noise of a part of a batch: rows of that of the whole batch, from row `first` on.
template <Backend B>
TextMotionNoise<B> noise_rows(Index first, Index rows, Index width, const Philox& rng) {
  return {.text = normal_rows<B>(first, rows, width, rng.split("text")),
          .motion = normal_rows<B>(first, rows, width, rng.split("motion"))};
}

template <AutodiffBackend A, template <class> class System>
class TextTask : public EpochTask<typename TrainedSystem<System>::Config, TextMotionModel<A, System>,
                                  TextMotionModel<typename A::inner, System>> {
 public:
  using Base = EpochTask<typename TrainedSystem<System>::Config, TextMotionModel<A, System>,
                         TextMotionModel<typename A::inner, System>>;
  using typename Base::B, typename Base::Config;

  std::map<std::string, std::string> settings() const {
    auto out = Base::settings();
    if (const auto& words = learner_.average.words) {
      std::string& pieces = out["text.pieces"];
      for (const auto& p : words->tokenizer.vocabulary()) pieces += p + "\n";
      if (!words->vectors.empty()) out["text.word_vectors"] = words->vectors.checksum();
    }
    return out;
  }
  /// Writes the folder of the model. `about`: license and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about) {
    save_text_motion(folder, this->result(), config_, data_->fps, about);
  }

 protected:
  template <Backend T>
  using Model = TextMotionModel<T, System>;

  TextTask(Config config, const DescribedMotions& data) : Base(TrainedSystem<System>::name, std::move(config), data) {}

  /// Draws the initial weights.
  /// width       of the states of a language model; none: word pieces are learned from `words`
  /// statistics  a folder with those of the features; empty: those of the training motions
  /// language    trained with the model
  /// vectors     of words, for a model of word pieces: each word that `words` say twice is a piece then
  void begin_model(std::optional<Index> width, const std::vector<std::string>& words,
                   const std::filesystem::path& statistics, std::optional<LanguageModel<B>> language = {},
                   WordVectors vectors = {}) {
    std::optional<WordPiece> pieces;
    if (width)
      config_.text.width = *width;
    else
      pieces = vectors.empty() ? WordPiece::learn(words, config_.text.vocabulary) : WordPiece::of_words(words);
    auto model = make_text_motion<System, B>(config_, data_->width, pieces, Philox{.seed = this->seed()}.split("init"),
                                             std::move(vectors));
    model.language = std::move(language);
    model.motion_normalizer = statistics_of<B>(statistics, *data_);
    model.motion_normalizer.eps = TrainedSystem<System>::normalizer_eps;
    this->begin(std::move(model));
  }

  /// Every text of the training motions, as often as it occurs.
  std::vector<std::string> training_texts() const {
    std::vector<std::string> texts;
    for (const DescribedMotion& m : data_->training) {
      for (const DescribedText& t : m.texts) texts.push_back(t.text);
    }
    return texts;
  }
  const DescribedMotion& training_motion(Index i) const { return data_->training[static_cast<std::size_t>(i)]; }
  const DescribedMotion& validation_motion(Index i) const { return data_->validation[static_cast<std::size_t>(i)]; }

  using Base::config_, Base::data_, Base::learner_;
};

MOTIONLANG_NAMESPACE_END
