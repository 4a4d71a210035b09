// SPDX-License-Identifier: MIT
/// The training of MDM on motions of actions. The model folder has the form that the reader of the published models
/// takes (weights/mdm_action_run.hpp).
///
///     const auto config = mdm_action_preset("small");
///     const auto data = read_described_motions({.data = "clips", .labels = "labels.tsv", .actions = true},
///                                              config.data, actor_row_maker(config.clips));
///     train(MdmActionTraining<A>(config, data), {.out = "run"}, {{"license", "MIT"}, {"provenance", "own"}});
///
/// `motionlang train-mdm-actions` calls it.
/// Source   Tevet et al. (ICLR 2023), section 4.2; GuyTevet/motion-diffusion-model train/train_mdm.py
/// Differs  The joints of the geometric terms are those of the library's own skeleton, not of an SMPL file
#pragma once

#include <filesystem>  // folders
#include <span>        // numbers of motions
#include <utility>     // move
#include <vector>      // measures

#include <motionlang/train/action_task.hpp>
#include <motionlang/train/diffusion_presets.hpp>
#include <motionlang/train/diffusion_systems.hpp>
#include <motionlang/train/diffusion_task.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
template <AutodiffBackend Tape>
using ActionDiffusionTask =
    DiffusionTask<ActionTask<MdmActionTrainingConfig, MdmDenoiser<Tape>, MdmDenoiser<typename Tape::inner>>,
                  /*drops_last=*/true>;

MdmConfig network_sizes(const MdmActionTrainingConfig& c, Index actions);

/// Writes what the reader of the folder takes.
ModelFolder described_mdm_actions(const MdmActionTrainingConfig& c, const MdmConfig& sizes,
                                  const std::vector<std::string>& labels,
                                  const std::map<std::string, std::string>& about);

/// Positions of the joints relative to the root of their frame, (frames, 72).
template <Backend B>
Sequences<B> joints_in_place(const Sequences<B>& x, ActorClipsConfig clips) {
  const Index way = clips.way();
  clips.translation = false;
  return joint_points(x.with(slice(x.rows, 1, 0, way)), clips);
}
}  // namespace detail

template <AutodiffBackend Tape>
class MdmActionTraining : public detail::ActionDiffusionTask<Tape> {
 public:
  using Base = detail::ActionDiffusionTask<Tape>;
  using typename Base::A, typename Base::B;

  /// data    must outlive the training
  /// Throws  config_error 101 to 103 for an invalid configuration
  MdmActionTraining(const MdmActionTrainingConfig& config, const DescribedMotions& data);

  LossTerms<A> loss(Philox rng, Index step, const Context& context) const {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const;
  /// The loss without dropout, of the same windows and noise in every call.
  std::vector<Measure> validate();

  /// Writes the folder of the model. `about`: license and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about);

 private:
  /// The loss of a part of a batch.
  template <Backend T>
  LossTerms<T> loss_of(const MdmDenoiser<T>& model, const ActionBatch<T>& whole, const BatchPart& part,
                       const Philox& rng, double drop, const Context& context) const;

  using Base::classes_, Base::config_, Base::data_, Base::diffusion_, Base::labels_, Base::learner_;
};

template <AutodiffBackend Tape>
MdmActionTraining<Tape>::MdmActionTraining(const MdmActionTrainingConfig& config, const DescribedMotions& data)
    : Base("mdm of actions", config, data, labels_of(data)) {
  this->begin(detail::new_mdm<B>(detail::network_sizes(config_, std::ssize(labels_)),
                                 Philox{.seed = this->seed()}.split("init")));
}

template <AutodiffBackend Tape>
auto MdmActionTraining<Tape>::part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const
    -> LossTerms<A> {
  const auto batch =
      action_batch<A>(data_->training, classes_, this->motions_of(step), config_.clips, rng.split("windows"));
  return loss_of(learner_.model, batch, part, rng, config_.drop, context);
}

template <AutodiffBackend Tape>
std::vector<Measure> MdmActionTraining<Tape>::validate() {
  return {{"loss", this->over_validation([&](std::span<const Index> which, const Philox& rng) {
             const auto batch = this->validation_batch(which, rng);
             const BatchPart all{0, batch.x.count()};
             return static_cast<double>(loss_of(learner_.average, batch, all, rng, 0, {}).total().item());
           })}};
}

template <AutodiffBackend Tape>
template <Backend T>
LossTerms<T> MdmActionTraining<Tape>::loss_of(const MdmDenoiser<T>& model, const ActionBatch<T>& whole,
                                              const BatchPart& part, const Philox& rng, double drop,
                                              const Context& context) const {
  using S = typename T::scalar;
  const ActionBatch<T> batch = part_of(whole, part);
  const auto drawn = this->draws(rng, part.first, std::ssize(batch.classes), drop);
  const NoisedMotions<T> noised = this->with_noise(batch.x, whole.x.offsets.begin(part.first), rng, drawn.t);
  const Index actions = model.config.num_actions;
  std::vector<S> one_hot(batch.classes.size() * static_cast<std::size_t>(actions));
  for (std::size_t row = 0; row < batch.classes.size(); ++row) {
    if (!config_.unconstrained && drawn.kept[row])
      one_hot[row * static_cast<std::size_t>(actions) + static_cast<std::size_t>(batch.classes[row])] = 1;
  }
  const auto action = TextFeatures<T>::pooled(Tensor<T, 2>::from(one_hot, {std::ssize(batch.classes), actions}));
  const auto said = model(noised.at_t(diffusion_), noised.t, action, context);
  const auto& l = config_.losses;
  const bool joints = l.rcxyz > 0 || l.fc > 0;
  const auto of = [&](const Sequences<T>& x) {
    return joints ? detail::joints_in_place(x, config_.clips) : Sequences<T>();
  };
  auto out = mdm_action_losses(batch.x, said, of(batch.x), of(said), config_.clips.numbers(),
                               {.rcxyz = l.rcxyz, .vel = l.vel, .fc = l.fc});
  for (auto& term : out.terms) term.weight *= part.share(whole.x.count());
  return out;
}

template <AutodiffBackend Tape>
void MdmActionTraining<Tape>::save(const std::filesystem::path& folder,
                                   const std::map<std::string, std::string>& about) {
  const auto& model = this->result();
  TensorStore store;
  store.add_module(model);
  overwrite_model(folder, detail::described_mdm_actions(config_, model.config, labels_, about), store);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/mdm_action_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::MdmActionTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::MdmActionTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
