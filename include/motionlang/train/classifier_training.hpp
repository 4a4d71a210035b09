// SPDX-License-Identifier: MIT
/// The training of a classifier of actions, which judges generated motions. `motionlang train-classifier` calls it; see
/// train/actor_training.hpp for its use.
///
/// Source   ACTOR (Petrovich, Black, Varol, ICCV 2021), its evaluation; thesis 3.3.1
#pragma once

#include <cstdint>     // streams
#include <functional>  // reading again
#include <optional>    // a generator
#include <span>        // numbers of motions
#include <utility>     // move
#include <vector>      // measures

#include <motionlang/loss/cross_entropy.hpp>
#include <motionlang/metrics/accuracy.hpp>
#include <motionlang/train/action_task.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/trainer.hpp>
#include <motionlang/weights/classifier_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Throws config_error 101 to 103 for invalid settings of generated motions. `generated`: true if there is a model that
/// makes them.
void require_generated_settings(const ClassifierConfig& config, bool generated);
/// The form of the clips for a generator that reads recorded motions.
ActorClipsConfig clips_for_generator(const ClassifierConfig& config, const ActorClipsConfig& generator);

template <AutodiffBackend A>
class ClassifierTraining : public ActionTask<ClassifierConfig, Classifier<A>, Classifier<typename A::inner>> {
 public:
  using Base = ActionTask<ClassifierConfig, Classifier<A>, Classifier<typename A::inner>>;
  using typename Base::B;
  using Read = std::function<DescribedMotions(const RowMaker&)>;

  /// data       must outlive the training
  /// generator  an ACTOR that makes config.generated_share of the training motions; its labels are used
  /// read       the same data in other rows, for an ACTOR of another pose representation that reads recorded motions
  ClassifierTraining(const ClassifierConfig& config, const DescribedMotions& data,
                     std::optional<ActorModel<B>> generator = {}, const Read& read = {});

  LossTerms<A> loss(Philox rng, Index step, const Context& context) {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) {
    const auto whole = generator_ ? partly_generated(rng, step) : this->batch(rng, step);
    const auto b = part_of(whole, part);
    const auto logits = learner_.model.train(b.x, config_.clips, rng, {part.first, whole.x.count()}, context).logits;
    LossTerms<A> out;
    out.add("cross entropy", part.share(whole.x.count()), cross_entropy(logits, b.classes));
    return out;
  }
  /// True for ST-GCN, whose norms use the statistics of the whole batch.
  bool parts_meet(Index) const { return learner_.model.stgcn.has_value(); }
  std::vector<ModuleTensor<A>> batch_statistics() { return untrained<A>(this->parameters()); }
  std::vector<Measure> validate();

 private:
  /// The batch of a step. Generated motions replace some of its motions at random. They are kept for the next part of
  /// the batch.
  const ActionBatch<A>& partly_generated(const Philox& rng, Index step);
  /// Motions of the generator in the places of recorded ones.
  ActionBatch<B> generated(std::span<const Index> which, const Philox& rng) const;

  using Base::batches_, Base::classes_, Base::config_, Base::data_, Base::labels_, Base::learner_;
  std::optional<ActorModel<B>> generator_;
  ActorClipsConfig known_clips_;           // windows in the generator's form
  std::optional<DescribedMotions> known_;  // the data in its rows, if these differ
  struct Made {
    Made(Index s, std::uint64_t r, ActionBatch<A> b) : step(s), stream(r), batch(std::move(b)) {}
    Index step;
    std::uint64_t stream;
    ActionBatch<A> batch;
  };
  std::optional<Made> made_;
};

template <AutodiffBackend A>
ClassifierTraining<A>::ClassifierTraining(const ClassifierConfig& config, const DescribedMotions& data,
                                          std::optional<ActorModel<B>> generator, const Read& read)
    : Base("classifier", config, data, generator ? generator->file.labels : labels_of(data)),
      generator_(std::move(generator)),
      known_clips_(config_.clips) {
  require_generated_settings(config_, generator_.has_value());
  if (generator_) {
    known_clips_ = clips_for_generator(config_, generator_->file.config.clips);
    if (known_clips_.pose != config_.clips.pose || known_clips_.width() != config_.clips.width() ||
        known_clips_.camera != config_.clips.camera)
      known_ = read(actor_row_maker(known_clips_));
  }
  this->begin(Classifier<B>(config_, std::ssize(labels_), Philox{.seed = this->seed()}.split("init")));
}

template <AutodiffBackend A>
std::vector<Measure> ClassifierTraining<A>::validate() {
  double right = 0;
  const double loss = this->over_validation([&](std::span<const Index> which, const Philox& rng) {
    const auto b = this->validation_batch(which, rng);
    const auto logits = learner_.average(b.x, config_.clips, rng).logits;
    const auto confusion = confusion_matrix(Rows(logits.span(), logits.size(1)), std::span<const Index>(b.classes));
    right += accuracy(confusion) * static_cast<double>(b.classes.size());
    return static_cast<double>(cross_entropy(logits, b.classes).item());
  });
  return {{"loss", loss}, {"accuracy", right / static_cast<double>(data_->validation.size()), true}};
}

template <AutodiffBackend A>
const ActionBatch<A>& ClassifierTraining<A>::partly_generated(const Philox& rng, Index step) {
  if (made_ && made_->step == step && made_->stream == rng.stream) return made_->batch;
  auto draw = rng.split("generated");
  std::vector<Index> kept, replaced;
  for (const Index i : batches_(step, this->seed()))
    (draw.uniform() < config_.generated_share ? replaced : kept).push_back(i);
  std::vector<ActionBatch<B>> parts;
  if (!kept.empty())
    parts.push_back(action_batch<B>(data_->training, classes_, kept, config_.clips, rng.split("windows")));
  if (!replaced.empty()) parts.push_back(generated(replaced, draw));
  ActionBatch<A> out;
  std::vector<typename B::scalar> values;
  std::vector<Index> lengths;
  for (const ActionBatch<B>& part : parts) {
    values.insert(values.end(), part.x.rows.span().begin(), part.x.rows.span().end());
    for (Index i = 0; i < part.x.count(); ++i) lengths.push_back(part.x.offsets.length(i));
    out.classes.insert(out.classes.end(), part.classes.begin(), part.classes.end());
  }
  const Offsets offsets{std::span<const Index>(lengths)};
  out.x = {Tensor<A, 2>::from(values, {offsets.rows(), config_.clips.width()}), offsets};
  return made_.emplace(step, rng.stream, std::move(out)).batch;
}

template <AutodiffBackend A>
ActionBatch<typename ClassifierTraining<A>::B> ClassifierTraining<A>::generated(std::span<const Index> which,
                                                                                const Philox& rng) const {
  const RecognitionSets<B> sets{*generator_, known_ ? known_->training : data_->training, classes_, known_clips_,
                                config_.clips};
  const auto windows = rng.split("windows"), noise = rng.split("noise");
  if (config_.generated_kind == "denoised") return sets.denoised(which, windows);
  if (config_.generated_kind == "interpolated") return sets.interpolated(which, windows, rng.split("others"), noise);
  return sets.sampled(which, windows, noise);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/classifier_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::ClassifierTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::ClassifierTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
