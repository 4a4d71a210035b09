// What trainings on BABEL have in common: a model that reads word pieces or the states of a language model, and a loss.
#pragma once

#include <memory>

#include "babel_model.hpp"
#include "babel_motions.hpp"
#include "epoch_task.hpp"
#include "motion_batch.hpp"
#include "text_sources.hpp"

namespace program {

template <template <class> class System, class Config>
class BabelTask
    : public EpochTask<Config, TextMotionModel<TrainingTape, System>, TextMotionModel<TrainingBackend, System>> {
 public:
  using Base = EpochTask<Config, TextMotionModel<TrainingTape, System>, TextMotionModel<TrainingBackend, System>>;
  using Base::seed;
  using typename Base::A, typename Base::B;

  std::map<std::string, std::string> settings() const {
    auto out = Base::settings();
    add_pieces(out, learner_.average.words);
    return out;
  }

 protected:
  template <ml::Backend T>
  using Model = TextMotionModel<T, System>;

  /// states       none: word pieces, learnt from `words`
  /// statistics   a folder with those of the features; empty: of the motions to train on
  BabelTask(Config config, const DescribedMotions& data, TextStates states, const std::vector<std::string>& words,
            const std::filesystem::path& statistics)
      : Base(system_name<System>(), std::move(config), data), states_(std::move(states)) {
    if (config_.validation.watch != "loss")
      ml::raise<ml::config_error>(103, "validation.watch '", config_.validation.watch, "' is not loss");
    std::optional<ml::WordPiece> pieces;
    if (states_)
      config_.text.width = states_(std::span(&data.training.front().texts.front().text, 1)).width();
    else
      pieces = ml::WordPiece::learn(words, config_.text.vocabulary);
    auto model = make_babel_model<System, B>(config_, data.width, pieces, ml::Philox{.seed = seed()}.split("init"));
    const double eps = model.motion_normalizer.eps;
    model.motion_normalizer = statistics_of(statistics, data);
    model.motion_normalizer.eps = eps;
    Base::begin(std::move(model));
  }

  template <ml::Backend T>
  ml::Sequences<T> tokens(const Model<T>& model, const std::vector<std::string>& texts) const {
    if (!states_) return model.tokens(texts, nullptr);
    const ml::EmbeddingCache states = states_(texts);
    return model.tokens(texts, &states);
  }

  const DescribedMotion& training_motion(ml::Index i) const { return data_->training[static_cast<std::size_t>(i)]; }
  const DescribedMotion& validation_motion(ml::Index i) const { return data_->validation[static_cast<std::size_t>(i)]; }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  TextStates states_;
};

}  // namespace program
