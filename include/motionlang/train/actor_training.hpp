// SPDX-License-Identifier: MIT
/// The training of ACTOR, which makes motions for actions. `motionlang train-actor` calls it.
///
///     const auto config = actor_preset("small");
///     const auto data = read_described_motions({.data = "clips", .labels = "labels.tsv", .actions = true},
///                                              config.data, actor_row_maker(config.clips));
///     train(ActorTraining<A>(config, data), {.out = "run"}, {{"license", "MIT"}, {"provenance", "own recordings"}});
///
/// Source   ACTOR (Petrovich, Black, Varol, ICCV 2021); thesis 3.2.2
#pragma once

#include <filesystem>  // files of a body
#include <optional>    // what may be missing
#include <span>        // numbers of motions
#include <string>      // names of points
#include <utility>     // move
#include <vector>      // measures

#include <motionlang/systems/actor.hpp>
#include <motionlang/train/action_task.hpp>
#include <motionlang/train/body_points.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A body whose points are compared; "": the joints of the library's own skeleton.
struct ActorBodyFiles {
  std::filesystem::path body{};
  std::filesystem::path regressor{};  // J_regressor_extra.npy, for points that need it
};

/// With a body, its vertices are compared instead of joints, as published (L_P + L_V).
void choose_points(ActorTrainingConfig& config, const ActorBodyFiles& files);
/// The points that the losses compare, for people.
std::string points_text(const ActorTrainingConfig& config, const ActorBodyFiles& files);
/// Throws config_error 102 if losses.points and the files contradict each other.
void require_body_files(const ActorTrainingConfig& config, const ActorBodyFiles& files);

template <AutodiffBackend A>
class ActorTraining : public ActionTask<ActorTrainingConfig, Actor<A>, Actor<typename A::inner>> {
 public:
  using Base = ActionTask<ActorTrainingConfig, Actor<A>, Actor<typename A::inner>>;
  using typename Base::B;

  /// data    must outlive the training
  /// from    a model to start from, whose labels are used
  /// files   of a body, unless losses.points is "joints"
  /// Throws  config_error 101 to 103 for an invalid configuration, and what the readers of a body throw
  ActorTraining(const ActorTrainingConfig& config, const DescribedMotions& data, std::optional<ActorModel<B>> from = {},
                const ActorBodyFiles& files = {});

  LossTerms<A> loss(Philox rng, Index step, const Context& context) const {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const {
    return loss_of(learner_.model, this->batch(rng, step), part, rng, context);
  }
  std::vector<Measure> validate();

 private:
  template <Backend T>
  LossTerms<T> loss_of(const Actor<T>& model, const ActionBatch<T>& whole, const BatchPart& part, const Philox& rng,
                       const Context& context) const;
  template <Backend T>
  Sequences<T> points_of(const Sequences<T>& x) const {
    if (!points_) return joint_points(x, config_.clips);
    if constexpr (AutodiffBackend<T>)
      return (*taped_points_)(x, config_.clips, config_.losses.vertstrans);
    else
      return (*points_)(x, config_.clips, config_.losses.vertstrans);
  }

  using Base::batches_, Base::config_, Base::labels_, Base::learner_;
  std::optional<BodyPoints<B>> points_;
  std::optional<BodyPoints<A>> taped_points_;  // the same
};

template <AutodiffBackend A>
ActorTraining<A>::ActorTraining(const ActorTrainingConfig& config, const DescribedMotions& data,
                                std::optional<ActorModel<B>> from, const ActorBodyFiles& files)
    : Base("actor", config, data, from ? from->file.labels : labels_of(data)) {
  require_body_files(config_, files);
  if (!files.body.empty()) {
    points_.emplace(config_.losses.points, files.body, files.regressor);
    taped_points_.emplace(*points_);
  }
  auto rng = Philox{.seed = this->seed()}.split("init");
  Actor<B> model(actor_sizes(config_, std::ssize(labels_)), rng);
  if (from) {
    require_same_rows(from->file.config.clips, config_.clips);
    zip_tensors(model, from->actor, [](const auto& to, const auto& given) {
      if (to.shape() != given.shape())
        raise<config_error>(102, "`from`: '", to.path, "' is ", given.shape(), ", the settings make it ", to.shape());
      *to.data = *given.data;
    });
  }
  this->begin(std::move(model));
}

template <AutodiffBackend A>
std::vector<Measure> ActorTraining<A>::validate() {
  return {{"loss", this->over_validation([&](std::span<const Index> which, const Philox& rng) {
             const auto b = this->validation_batch(which, rng);
             const BatchPart all{0, b.x.count()};
             return static_cast<double>(loss_of(learner_.average, b, all, rng, {}).total().item()) /
                    static_cast<double>(b.classes.size()) * static_cast<double>(config_.optimiser.batch);
           })}};
}

/// Means over frames, or over steps from frame to frame, count by their number. The KL divergence is a sum.
template <AutodiffBackend A>
template <Backend T>
LossTerms<T> ActorTraining<A>::loss_of(const Actor<T>& model, const ActionBatch<T>& whole, const BatchPart& part,
                                       const Philox& rng, const Context& context) const {
  const ActionBatch<T> b = part_of(whole, part);
  const auto latent = model.encode(b.x, b.classes, context);
  const Index first = model.frames ? whole.x.offsets.begin(part.first) : part.first;  // row of noise
  const auto noise = normal_rows<T>(first, latent.mu.size(0), latent.mu.size(1), rng.split("noise"));
  const auto written = model.teach(latent.sample(noise), b.classes, b.x, context);
  const auto& l = config_.losses;
  std::optional<ActorLossPoints<T>> points;
  if (l.rcxyz != 0 || l.velxyz != 0) points = {points_of(b.x), points_of(written)};
  auto out =
      actor_losses(latent, b.x, written, {.rc = l.rc, .rcxyz = l.rcxyz, .kl = l.kl, .vel = l.vel, .velxyz = l.velxyz},
                   points, model.prior(b.x, b.classes));
  std::vector<Index> frames, steps;
  for (Index s = 0; s < whole.x.count(); ++s) {
    frames.push_back(whole.x.offsets.length(s));
    steps.push_back(frames.back() - 1);
  }
  for (auto& term : out.terms) {
    if (term.name != "kl")
      term.weight *= part.share(std::span<const Index>(term.name.starts_with("vel") ? steps : frames));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/actor_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::ActorTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::ActorTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
