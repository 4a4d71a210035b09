// SPDX-License-Identifier: MIT
/// The training of TEACH: two actions in sequence. `motionlang train-teach` calls it; train/sinc_training.hpp shows how
/// to use it.
///
/// Source   TEACH (Athanasiou et al., 3DV 2022); thesis A.2.3
#pragma once

#include <algorithm>   // max
#include <filesystem>  // folders
#include <memory>      // states of all labels
#include <span>        // numbers of motions
#include <string>      // labels
#include <vector>      // labels

#include <motionlang/train/babel_task.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/trainer.hpp>
#include <motionlang/vae/teach_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <AutodiffBackend A>
class TeachTraining : public BabelTask<A, Teach> {
 public:
  using Base = BabelTask<A, Teach>;
  using typename Base::B;

  /// states       the states of a language model, called once for all texts; none: word pieces of the data
  /// statistics   a folder with those of the features; empty: those of the training motions
  TeachTraining(TeachTrainingConfig config, const DescribedMotions& data, const TextStates& states = {},
                const std::filesystem::path& statistics = {})
      : Base(std::move(config), data, kept(states, data), labels(data), statistics) {}

  LossTerms<A> loss(Philox rng, Index step, const Context& context) const {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const;
  /// The loss without dropout, always with the same noise.
  std::vector<Measure> validate();

 private:
  static std::vector<std::string> labels(const DescribedMotions& data) {
    std::vector<std::string> out;
    for (const DescribedMotion& m : data.training) {
      for (const DescribedText& t : m.texts) out.push_back(t.text);
    }
    return out;
  }
  static TextStates kept(const TextStates& states, const DescribedMotions& data) {
    if (!states) return states;
    return [all = std::make_shared<const EmbeddingCache>(states(all_texts(data)))](std::span<const std::string> texts) {
      return states_of<B>(*all, texts);
    };
  }

  /// The terms of some of the motions `which`.
  template <Backend T>
  LossTerms<T> loss_of(const TextMotionModel<T, Teach>& model, const std::vector<DescribedMotion>& motions,
                       std::span<const Index> which, const BatchPart& part, const Philox& rng,
                       const Context& context) const;

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
};

template <AutodiffBackend A>
LossTerms<A> TeachTraining<A>::part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const {
  const auto which = batches_(step, this->seed());
  return weighted(loss_of(learner_.model, data_->training, which, part, rng.split("noise"), context),
                  part.share(std::ssize(which)));
}

template <AutodiffBackend A>
std::vector<Measure> TeachTraining<A>::validate() {
  return {{"loss", Base::over_validation([&](std::span<const Index> which, const Philox& rng) {
             const auto terms = loss_of(learner_.average, data_->validation, which, {0, std::ssize(which)}, rng, {});
             return static_cast<double>(terms.total().item());
           })}};
}

template <AutodiffBackend A>
template <Backend T>
LossTerms<T> TeachTraining<A>::loss_of(const TextMotionModel<T, Teach>& model,
                                       const std::vector<DescribedMotion>& motions, std::span<const Index> which,
                                       const BatchPart& part, const Philox& rng, const Context& context) const {
  std::vector<std::string> first_texts, second_texts;
  MotionBatch<T> first(model.motion_normalizer), second(model.motion_normalizer);
  std::vector<Index> transitions;
  Index number = 0, longest_first = 0, longest_second = 0;  // of all
  for (const Index i : which) {
    const DescribedMotion& m = motions[static_cast<std::size_t>(i)];
    const DescribedText &a = m.texts[0], &b = m.texts[1];
    const Index cut = a.frames.length, action = b.frames.first, rest = action + b.frames.length - cut;
    longest_first = std::max(longest_first, cut), longest_second = std::max(longest_second, rest);
    if (const Index at = number++; at < part.first || at >= part.last) continue;
    first_texts.push_back(a.text), second_texts.push_back(b.text);
    first.add(m.rows, a.frames);
    second.add(m.rows, {cut, rest});
    transitions.push_back(action - cut);
  }
  const TeachPairs<T> pairs{Base::tokens(model, first_texts),
                            Base::tokens(model, second_texts),
                            first.normalized(),
                            second.normalized(),
                            Offsets(std::span<const Index>(transitions)),
                            longest_first,
                            longest_second};
  const Index width = config_.network.latent_dim;
  const TeachNoise<T> noise{noise_rows<T>(part.first, part.count(), width, rng.split("first")),
                            noise_rows<T>(part.first, part.count(), width, rng.split("second"))};
  const auto& l = config_.losses;
  TeachLossOptions options{.loss_on_transition = l.loss_on_transition, .velocity = l.velocity};
  options.each.recons = l.recons, options.each.kl = l.kl, options.each.latent = l.latent;
  return teach_losses(model.system.branches(pairs, noise, context, config_.network.teacher_forcing), pairs, options);
}

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::TeachTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::TeachTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
