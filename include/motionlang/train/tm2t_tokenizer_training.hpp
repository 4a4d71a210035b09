// SPDX-License-Identifier: MIT
/// The first stage of TM2T: the motion tokenizer. `motionlang train-tm2t --stage tokenizer` calls it.
///
///     const auto config = tm2t_preset("small", Tm2tStage::tokenizer);
///     train(Tm2tTokenizerTraining<A>(config, data, tm2t_statistics<B>(data, {}, config.tokenizer.feature_bias)),
///           {.out = "tokenizer"}, about);
///
/// Source   TM2T (Guo et al., ECCV 2022), section 3.1, appendix B
/// Differs  from the published program: parts of clips with texts of their own count as motions; the last batch of an
///          epoch is kept; and validation uses whole motions
#pragma once

#include <algorithm>    // max
#include <filesystem>   // folders
#include <map>          // the record of a training
#include <optional>     // a discriminator
#include <span>         // numbers of motions
#include <string_view>  // names of settings
#include <utility>      // move
#include <vector>       // windows

#include <motionlang/datasets/tm2t_data.hpp>
#include <motionlang/train/epoch_task.hpp>
#include <motionlang/train/feature_statistics.hpp>
#include <motionlang/train/motion_batch.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/tm2t_model_folder.hpp>
#include <motionlang/train/trainer.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Values as constants of another backend.
template <Backend T, Backend B>
Sequences<T> constants(const Sequences<B>& x) {
  const auto numbers = x.rows.span();
  return {Tensor<T, 2>::from(std::vector<typename B::scalar>(numbers.begin(), numbers.end()), x.rows.shape()),
          x.offsets};
}

/// The windows of this many frames of all training motions. Throws config_error 102, with the name of the setting, if
/// no motion is long enough for a window.
std::vector<ClipWindow> training_windows(const DescribedMotions& data, Index window, std::string_view setting);
/// The deviations as the tokenizer uses them. grouped: true if each is the mean of its group already.
std::vector<double> tm2t_training_deviation(std::vector<double> std, double bias, bool grouped);

}  // namespace detail

/// Mean and deviation as the tokenizer uses them. They are those of the features, but each deviation is the mean of its
/// group, as in HumanML3D. It is then reduced for root and contacts.
/// folder   with Mean.npy and Std.npy, already averaged by group; empty: those of these motions
template <Backend B>
Normalizer<B> tm2t_statistics(const DescribedMotions& data, const std::filesystem::path& folder, double bias) {
  auto out = statistics_of<B>(folder, data);
  const auto std = detail::tm2t_training_deviation({out.std.span().begin(), out.std.span().end()}, bias,
                                                   /*grouped=*/!folder.empty());
  out.std = Tensor<B, 1>::from(std::vector<typename B::scalar>(std.begin(), std.end()), {data.width});
  out.eps = 0;
  return out;
}

template <AutodiffBackend A>
class Tm2tTokenizerTraining
    : public EpochTask<Tm2tTrainingConfig, MotionTokenizer<A>, MotionTokenizer<typename A::inner>> {
 public:
  using Base = EpochTask<Tm2tTrainingConfig, MotionTokenizer<A>, MotionTokenizer<typename A::inner>>;
  using typename Base::B;

  /// data    must outlive the training
  /// Throws  config_error 101, 102 for an invalid configuration
  Tm2tTokenizerTraining(const Tm2tTrainingConfig& config, const DescribedMotions& data, Normalizer<B> statistics)
      : Tm2tTokenizerTraining(config, data, std::move(statistics),
                              detail::training_windows(data, config.tokenizer.window, "tokenizer.window")) {}

  const Normalizer<B>& statistics() const { return statistics_; }

  /// As published, the discriminator makes an update before the tokenizer, on the same output of the tokenizer.
  bool judges(Index step) const { return step >= first_adversarial(); }
  Index updates(Index step) const { return judges(step) ? 2 : 1; }
  LossTerms<A> loss(const Philox& rng, Index step, const Context& context);
  LossTerms<A> part_loss(const Philox&, Index step, const BatchPart& part, const Context& context, Index update = 0);
  std::vector<ModuleTensor<A>> judge_parameters() { return tensors_of(*discriminator_); }
  void update_judge(const Gradients<A>& gradients, Index step) {
    judge_.config.lr = config_.optimiser.rate(step, this->steps());
    judge_.step(*discriminator_, gradients);
  }
  /// The discriminator normalises by the statistics of the whole batch.
  bool parts_meet(Index step) const { return judges(step); }
  std::vector<ModuleTensor<A>> batch_statistics() { return untrained<A>(judge_parameters()); }
  /// The loss without the discriminator, and the perplexity, which is the effective number of codes in use.
  std::vector<Measure> validate();

  void add_to(TensorStore& store) const;
  void load(const SafetensorsFile& file, Index steps_done);
  /// Writes the folder of the model. `about`: license and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about) {
    save_tm2t<B>(folder, config_, data_->fps, about, {this->result(), statistics_});
  }

 private:
  Tm2tTokenizerTraining(const Tm2tTrainingConfig& config, const DescribedMotions& data, Normalizer<B> statistics,
                        std::vector<ClipWindow> windows);
  Sequences<A> windows_of(Index step, const BatchPart& part) const;
  LossTerms<A> judge_loss(const Sequences<A>& x, const Sequences<A>& reconstruction, const Context& context);
  Index first_adversarial() const {
    return discriminator_ ? config_.tokenizer.adversarial_from * batches_.per_epoch() : this->steps();
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  std::vector<ClipWindow> windows_;
  Normalizer<B> statistics_;
  std::optional<VqDiscriminator<A>> discriminator_;
  AdamW<A> judge_{};
};

template <AutodiffBackend A>
Tm2tTokenizerTraining<A>::Tm2tTokenizerTraining(const Tm2tTrainingConfig& config, const DescribedMotions& data,
                                                Normalizer<B> statistics, std::vector<ClipWindow> windows)
    : Base("tm2t tokenizer", config, data, std::ssize(windows)),
      windows_(std::move(windows)),
      statistics_(std::move(statistics)) {
  const auto& t = config_.tokenizer;
  auto init = Philox{.seed = this->seed()}.split("init"), other = Philox{.seed = this->seed()}.split("discriminator");
  this->begin(MotionTokenizer<B>({.features = data.width,
                                  .channels = t.channels,
                                  .codes = t.codes,
                                  .residual_blocks = t.residual_blocks,
                                  .beta = t.beta},
                                 init));
  if (t.adversarial == 0) return;
  discriminator_ = convert<A>(VqDiscriminator<B>(data.width, t.discriminator, 2, other));
  judge_.config = config_.optimiser.adamw();
}

template <AutodiffBackend A>
Sequences<A> Tm2tTokenizerTraining<A>::windows_of(Index step, const BatchPart& part) const {
  MotionBatch<B> batch(statistics_);
  const auto which = batches_(step, this->seed());
  for (const Index i : part.of(which)) {
    const ClipWindow& w = windows_[static_cast<std::size_t>(i)];
    batch.add(data_->training[static_cast<std::size_t>(w.clip)].rows, {w.start, config_.tokenizer.window});
  }
  return detail::constants<A>(batch.normalized());
}

template <AutodiffBackend A>
LossTerms<A> Tm2tTokenizerTraining<A>::judge_loss(const Sequences<A>& x, const Sequences<A>& reconstruction,
                                                  const Context& context) {
  const auto made = x.with(stop_gradient(reconstruction.rows));
  const auto real = discriminator_->train(x, context).logits, generated = discriminator_->train(made, context).logits;
  LossTerms<A> out;
  out.add("judge", config_.tokenizer.adversarial, hinge_discriminator_loss(real, generated));
  return out;
}

template <AutodiffBackend A>
LossTerms<A> Tm2tTokenizerTraining<A>::loss(const Philox& rng, Index step, const Context& context) {
  const BatchPart all{0, this->samples(step)};
  if (!judges(step)) return part_loss(rng, step, all, context);
  const auto x = windows_of(step, all);
  const auto result = learner_.model(x);
  update_judge(backward(judge_loss(x, result.reconstruction, context).total()), step);
  return tokenizer_losses<A>(result, x, &*discriminator_, config_.tokenizer.adversarial, context);
}

template <AutodiffBackend A>
LossTerms<A> Tm2tTokenizerTraining<A>::part_loss(const Philox&, Index step, const BatchPart& part,
                                                 const Context& context, Index update) {
  const auto x = windows_of(step, part);
  const double share = part.share(this->samples(step));
  const auto result = learner_.model(x);
  if (!judges(step)) return weighted(tokenizer_losses<A>(result, x), share);
  if (update == 0) return weighted(judge_loss(x, result.reconstruction, context), share);
  return weighted(tokenizer_losses<A>(result, x, &*discriminator_, config_.tokenizer.adversarial, context), share);
}

template <AutodiffBackend A>
std::vector<Measure> Tm2tTokenizerTraining<A>::validate() {
  double perplexity = 0;
  const double loss = this->over_validation([&](std::span<const Index> which, const Philox&) {
    MotionBatch<B> batch(statistics_);
    for (const Index i : which) {
      const auto& rows = data_->validation[static_cast<std::size_t>(i)].rows;
      batch.add(rows, {0, std::ssize(rows) / data_->width / 4 * 4});
    }
    const auto x = batch.normalized();
    const auto result = learner_.average(x);
    perplexity += result.quantized.perplexity * static_cast<double>(which.size());
    return static_cast<double>(tokenizer_losses<B>(result, x).total().item());
  });
  return {{"loss", loss}, {"perplexity", perplexity / static_cast<double>(data_->validation.size()), true}};
}

template <AutodiffBackend A>
void Tm2tTokenizerTraining<A>::add_to(TensorStore& store) const {
  Base::add_to(store);
  if (!discriminator_) return;
  store.add_module(*discriminator_, "discriminator.");
  add_moments(store, "discriminator_adam.", judge_);
}

template <AutodiffBackend A>
void Tm2tTokenizerTraining<A>::load(const SafetensorsFile& file, Index steps_done) {
  Base::load(file, steps_done);
  if (!discriminator_) return;
  load_module(*discriminator_, file, "discriminator.");
  restore_moments(judge_, *discriminator_, file, "discriminator_adam.",
                  std::max<Index>(0, steps_done - first_adversarial()));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/tm2t_tokenizer_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::Tm2tTokenizerTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::Tm2tTokenizerTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
