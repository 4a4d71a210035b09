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

#include <algorithm>   // max, min
#include <filesystem>  // folders
#include <optional>    // items
#include <set>         // labels
#include <span>        // numbers of motions
#include <string>      // labels
#include <vector>      // labels

#include <motionlang/datasets/label_tags.hpp>
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
  /// tags         words of all labels, for the -ing forms of sentences; null: words stay as they are
  /// Throws       config_error 103 for a label that the table or the tags lack, 102 if table and data.proportion
  ///              contradict each other, or tags are given to a model that reads labels apart
  SincTraining(SincTrainingConfig config, const DescribedMotions& data, TextStates states = {},
               const std::filesystem::path& statistics = {}, const BodyPartTable* table = nullptr,
               const LabelTags* tags = nullptr);

  LossTerms<A> loss(Philox rng, Index step, const Context& context) const {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const;
  /// The loss without dropout, of whole motions and the published evaluation's sentences, always with the same noise.
  std::vector<Measure> validate();

 private:
  using LabelsOfMotions = std::vector<std::vector<std::string>>;

  /// The terms of a part of a batch.
  /// labels     of all motions of the batch
  /// sentence   sentence(labels): one text of them, for a model that reads them so
  /// motions    of the part
  /// longest    frames of the longest motion of the batch, if it may be in another part
  template <Backend T, class Sentence>
  LossTerms<T> loss_of(const TextMotionModel<T, Sinc>& model, const LabelsOfMotions& labels, const BatchPart& part,
                       Sentence sentence, const Sequences<T>& motions, const Philox& rng, const Context& context,
                       Index longest = 0) const;

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  std::optional<SincItems> items_;
  const LabelTags* tags_;
};

template <AutodiffBackend A>
SincTraining<A>::SincTraining(SincTrainingConfig config, const DescribedMotions& data, TextStates states,
                              const std::filesystem::path& statistics, const BodyPartTable* table,
                              const LabelTags* tags)
    : Base(std::move(config), data, std::move(states), detail::sinc_sentences(data), statistics), tags_(tags) {
  if ((table == nullptr) != (config_.data.proportion == 0))
    raise<config_error>(102, table == nullptr
                                 ? "data.proportion above 0 needs `body_parts`, a table of the body parts of "
                                   "labels; without one: data.proportion = 0"
                                 : "`body_parts` is for data.proportion above 0");
  if (table != nullptr) items_ = detail::sinc_training_items(data, *table);
  if (tags == nullptr) return;
  if (config_.network.texts != "joined")
    raise<config_error>(102, "`tags` are for sentences; with network.texts = ", config_.network.texts,
                        " labels are read apart");
  tags->require(data.training);
}

template <AutodiffBackend A>
LossTerms<A> SincTraining<A>::part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const {
  auto draws = rng.split("items"), conjunctions = rng.split("conjunctions"), order = rng.split("order");
  const SincDrawOptions options{.proportion = config_.data.proportion,
                                .random = config_.data.random,
                                .window = {.request = config_.data.window, .shortest = config_.data.shortest}};
  LabelsOfMotions labels;
  Index longest = 0;
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
    for (std::size_t i = config_.data.shuffle ? e.labels.size() : 0; i > 1; --i)
      std::swap(e.labels[i - 1], e.labels[order.below(static_cast<std::uint32_t>(i))]);
    const Index number = std::ssize(labels);
    labels.push_back(std::move(e.labels));
    const DescribedMotion& other = e.partner ? this->training_motion(*e.partner) : m;
    const Index shorter = std::min(std::ssize(m.rows), std::ssize(other.rows)) / data_->width;  // of a combined motion
    longest = std::max(longest, e.partner ? shorter : e.window.length);
    if (number < part.first || number >= part.last) continue;
    if (e.partner)
      batch.add(detail::composed_rows(m.rows, e.parts[0], other.rows, e.parts[1], config_.features == "smplvelp"));
    else
      batch.add(m.rows, e.window);
  }
  for (Index i = 0; i < part.first; ++i) conjunctions.below(5);
  const auto sentence = [&](const std::vector<std::string>& of) {
    const auto conjunction = static_cast<Conjunction>(conjunctions.below(5));
    return tags_ == nullptr ? join_labels(of, conjunction) : tags_->join(of, conjunction);
  };
  return loss_of(learner_.model, labels, part, sentence, batch.normalized(), rng.split("noise"), context, longest);
}

template <AutodiffBackend A>
std::vector<Measure> SincTraining<A>::validate() {
  return {{"loss", Base::over_validation([&](std::span<const Index> which, const Philox& rng) {
             LabelsOfMotions labels;
             MotionBatch<B> batch(learner_.average.motion_normalizer);
             for (const Index i : which) {
               const DescribedMotion& m = this->validation_motion(i);
               labels.push_back(labels_of(m));
               batch.add(m.rows);
             }
             const auto sentence = [](const std::vector<std::string>& of) {
               return join_labels(of, Conjunction::same_time);
             };
             const auto terms =
                 loss_of(learner_.average, labels, {0, std::ssize(labels)}, sentence, batch.normalized(), rng, {});
             return static_cast<double>(terms.total().item());
           })}};
}

template <AutodiffBackend A>
template <Backend T, class Sentence>
LossTerms<T> SincTraining<A>::loss_of(const TextMotionModel<T, Sinc>& model, const LabelsOfMotions& labels,
                                      const BatchPart& part, Sentence sentence, const Sequences<T>& motions,
                                      const Philox& rng, const Context& context, Index longest) const {
  const auto& l = config_.losses;
  const SincTexts<T> states =
      sinc_texts<T>(model.system.config.mode, part.of(labels), sentence,
                    [&](const std::vector<std::string>& texts) { return Base::tokens(model, texts); });
  const bool apart = model.system.config.mode == SincMode::separate_latents;
  const auto latents = [&](std::size_t motion) { return apart ? std::ssize(labels[motion]) : Index{1}; };
  Index before = 0, all = 0, most = 0, most_here = 0;  // latents of the texts: before this part, of all, of one motion
  for (std::size_t m = 0; m < labels.size(); ++m) {
    const auto number = static_cast<Index>(m);
    if (number < part.first) before += latents(m);
    if (number >= part.first && number < part.last) most_here = std::max(most_here, latents(m));
    all += latents(m), most = std::max(most, latents(m));
  }
  const Index width = config_.network.latent_dim, count = std::ssize(labels);
  auto noise = noise_rows<T>(part.first, part.count(), width, rng);
  if (all != count)
    noise.text = noise_rows<T>(before, model.system.latents(states).rows(), width, rng.split("labels")).text;
  auto options = sinc_loss_options();
  options.recons = l.recons, options.kl = l.kl, options.latent = l.latent, options.padded_frames = longest;
  auto out =
      weighted(model.system.losses(model.system.branches(states, motions, noise, context), states, motions, options),
               part.share(count));
  for (auto& term : out.terms) {  // divided by the most latents of a motion, which may be in another part
    if (term.name == "latent_manifold_multi") term.weight *= static_cast<double>(most_here) / static_cast<double>(most);
  }
  return out;
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
