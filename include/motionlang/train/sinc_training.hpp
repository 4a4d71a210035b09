// SPDX-License-Identifier: MIT
/// The training of SINC: single actions, simultaneous actions, and actions that are combined from two motions.
/// `motionlang train-sinc` calls it.
///
///     const auto data = read_babel_motions({.data = "AMASS", .babel = "train.json"}, config.features,
///                                          split_config(config.data), sinc_reader(config.data), {});
///     train(SincTraining<A>(config, data, text_states<B>("distilbert-base-uncased")), {.out = "run"}, about);
///
/// Source   SINC (Athanasiou et al., ICCV 2023); thesis B.2.1 to B.2.3
#pragma once

#include <filesystem>  // folders
#include <optional>    // items
#include <set>         // labels
#include <span>        // numbers of motions
#include <string>      // labels
#include <vector>      // labels

#include <motionlang/datasets/sinc_items.hpp>
#include <motionlang/text/joined_labels.hpp>
#include <motionlang/train/babel_task.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Every label of the training motions with itself in every sentence, so that all words occur.
std::vector<std::string> sinc_sentences(const DescribedMotions& data);
/// Throws config_error 103 for a label that the table lacks.
SincItems sinc_training_items(const DescribedMotions& data, const BodyPartTable& table);
/// Combines rows of two motions, turned to face ahead again.
std::vector<float> composed_rows(std::span<const float> a, const SincParts& parts_a, std::span<const float> b,
                                 const SincParts& parts_b, bool exact_yaw);

}  // namespace detail

template <AutodiffBackend A>
class SincTraining : public BabelTask<A, Sinc> {
 public:
  using Base = BabelTask<A, Sinc>;
  using typename Base::B;

  /// states       of a language model; none: word pieces of the data
  /// statistics   a folder with those of the features; empty: those of the training motions
  /// table        body parts of all labels; null if no actions are combined. Outlives the training, as `data` does.
  /// Throws       config_error 103 for a label that the table lacks, 102 if table and data.proportion contradict each
  ///              other
  SincTraining(SincTrainingConfig config, const DescribedMotions& data, TextStates states = {},
               const std::filesystem::path& statistics = {}, const BodyPartTable* table = nullptr);

  LossTerms<A> loss(Philox rng, Index step, const Context& context) const;
  /// The loss without dropout, of whole motions and the published evaluation's sentences, always with the same noise.
  std::vector<Measure> validate();

 private:
  template <Backend T>
  LossTerms<T> loss_of(const TextMotionModel<T, Sinc>& model, const std::vector<std::string>& texts,
                       const Sequences<T>& motions, const Philox& rng, const Context& context) const;

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  std::optional<SincItems> items_;
};

template <AutodiffBackend A>
SincTraining<A>::SincTraining(SincTrainingConfig config, const DescribedMotions& data, TextStates states,
                              const std::filesystem::path& statistics, const BodyPartTable* table)
    : Base(std::move(config), data, std::move(states), detail::sinc_sentences(data), statistics) {
  if ((table == nullptr) != (config_.data.proportion == 0))
    raise<config_error>(102, table == nullptr
                                 ? "data.proportion above 0 needs `body_parts`, a table of the body parts of "
                                   "labels; without one: data.proportion = 0"
                                 : "`body_parts` is for data.proportion above 0");
  if (table != nullptr) items_ = detail::sinc_training_items(data, *table);
}

template <AutodiffBackend A>
LossTerms<A> SincTraining<A>::loss(Philox rng, Index step, const Context& context) const {
  auto draws = rng.split("items"), conjunctions = rng.split("conjunctions");
  const SincDrawOptions options{.proportion = config_.data.proportion,
                                .random = config_.data.random,
                                .window = {.request = config_.data.window, .shortest = config_.data.shortest}};
  std::vector<std::string> texts;
  MotionBatch<A> batch(learner_.model.motion_normalizer);
  for (const Index k : batches_(step, this->seed())) {
    const DescribedMotion& m = this->training_motion(k);
    SincElement e{{}, labels_of(m), {}, {}};
    if (items_)
      e = items_->draw(k, options, draws);
    else
      e.window = options.window.of(std::ssize(m.rows) / data_->width, [&](Index n) {
        return static_cast<Index>(draws.below(static_cast<std::uint32_t>(n)));
      });
    texts.push_back(join_labels(e.labels, static_cast<Conjunction>(conjunctions.below(5))));
    if (e.partner)
      batch.add(detail::composed_rows(m.rows, e.parts[0], this->training_motion(*e.partner).rows, e.parts[1],
                                      config_.features == "smplvelp"));
    else
      batch.add(m.rows, e.window);
  }
  return loss_of(learner_.model, texts, batch.normalized(), rng.split("noise"), context);
}

template <AutodiffBackend A>
std::vector<Measure> SincTraining<A>::validate() {
  return {{"loss", Base::over_validation([&](std::span<const Index> which, const Philox& rng) {
             std::vector<std::string> texts;
             MotionBatch<B> batch(learner_.average.motion_normalizer);
             for (const Index i : which) {
               const DescribedMotion& m = this->validation_motion(i);
               texts.push_back(join_labels(labels_of(m), Conjunction::same_time));
               batch.add(m.rows);
             }
             const auto terms = loss_of(learner_.average, texts, batch.normalized(), rng, {});
             return static_cast<double>(terms.total().item());
           })}};
}

template <AutodiffBackend A>
template <Backend T>
LossTerms<T> SincTraining<A>::loss_of(const TextMotionModel<T, Sinc>& model, const std::vector<std::string>& texts,
                                      const Sequences<T>& motions, const Philox& rng, const Context& context) const {
  const auto& l = config_.losses;
  const SincTexts<T> states{Base::tokens(model, texts)};
  const auto noise = TextMotionNoise<T>::draw(motions.count(), config_.network.latent_dim, rng);
  auto options = sinc_loss_options();
  options.recons = l.recons, options.kl = l.kl, options.latent = l.latent;
  return model.system.losses(model.system.branches(states, motions, noise, context), states, motions, options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/sinc_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::SincTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::SincTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
