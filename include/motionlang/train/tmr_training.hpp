// SPDX-License-Identifier: MIT
/// The training of TMR: texts and motions in one space.
///
///     using A = Autodiff<EigenBackend<float>>;
///     const TextMotionConfig config = tmr_preset("small");
///     const auto data = read_described_motions({.data = "clips", .captions = "captions.tsv"}, config.data,
///                                              row_maker(config.features));
///     train(TmrTraining<A>(config, data), {.out = "run"}, {{"license", "MIT"}, {"provenance", "own recordings"}});
///
/// `motionlang train-tmr` calls it.
/// Source   TMR (Petrovich, Black, Varol, ICCV 2023), sections 3.2 to 3.4; thesis 5.2
#pragma once

#include <filesystem>  // folders
#include <span>        // numbers of motions
#include <utility>     // move
#include <vector>      // measures

#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/systems/tmr.hpp>
#include <motionlang/train/measured_similarity.hpp>
#include <motionlang/train/text_motion_task.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The losses of a configuration. Throws config_error 102, 103.
TmrLossOptions tmr_loss_options(const TextMotionConfig& c);

template <AutodiffBackend A>
class TmrTraining : public TextMotionTask<A, Tmr> {
 public:
  using Base = TextMotionTask<A, Tmr>;
  using typename Base::B;

  /// `texts` holds all texts of `data`, which must outlive the training.
  /// statistics   a folder with those of the features; empty: those of the training motions
  /// Throws       config_error 101, 102, 103 for an invalid configuration
  TmrTraining(TextMotionConfig config, const DescribedMotions& data, TextMotionTexts<B> texts,
              const std::filesystem::path& statistics = {});
  /// With the word pieces of the data (text.encoder = word_pieces). Texts about the same frames count as alike.
  TmrTraining(const TextMotionConfig& config, const DescribedMotions& data)
      : TmrTraining(config, data, text_motion_texts<B>(config.text, {}, data)) {}

  LossTerms<A> loss(Philox rng, Index step, const Context& context) const;
  /// The loss without dropout, of first captions and always with the same noise; recalls among the motions of the
  /// validation part. A motion also counts as found if it has a text with the same meaning.
  std::vector<Measure> validate();
  /// As for TextTask, with the scale of its similarities. Models that read the states of a language model get a scale
  /// that does not tell if a text is shown.
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about);

 private:
  /// The batch, some of whose texts got words of other subjects.
  TextMotionBatch<A> disturbed(TextMotionBatch<A> batch, Philox rng) const {
    if (config_.text.strange_words == 0) return batch;
    for (std::size_t i = 0; i < batch.texts.size(); ++i) {
      if (rng.uniform() < config_.text.strange_words)
        batch.texts[i] = strangers_->disturb(batch.texts[i], rng.split(static_cast<std::uint64_t>(i)));
    }
    return batch;
  }
  template <Backend T>
  TextMotionBranches<T> branches_of(const TmrModel<T>& model, const TextMotionBatch<T>& batch, const Philox& rng,
                                    const Context& context) const;
  template <Backend T>
  LossTerms<T> loss_of(const TmrModel<T>& model, const TextMotionBatch<T>& batch, const TextMotionBranches<T>& branches,
                       const Tensor<T, 2>* strangers = nullptr) const;

  using Base::config_, Base::data_, Base::learner_, Base::texts_;
  std::optional<StrangerTexts> strangers_{};
};

template <AutodiffBackend A>
TmrTraining<A>::TmrTraining(TextMotionConfig config, const DescribedMotions& data, TextMotionTexts<B> texts,
                            const std::filesystem::path& statistics)
    : Base(std::move(config), data, std::move(texts)) {
  tmr_loss_options(config_);
  if (config_.validation.watch != "loss" && config_.validation.watch != "retrieval")
    raise<config_error>(103, "validation.watch '", config_.validation.watch, "' is not loss or retrieval");
  Base::begin_with_texts(statistics);
  const auto& words = learner_.average.words;
  if (words) strangers_.emplace(words->tokenizer, words->vectors);
  if ((config_.losses.strangers > 0 || config_.text.strange_words > 0) && !strangers_)
    raise<config_error>(102, "losses.strangers and text.strange_words are for text.encoder word_pieces, not for '",
                        config_.text.encoder, "'");
}

template <AutodiffBackend A>
LossTerms<A> TmrTraining<A>::loss(Philox rng, Index step, const Context& context) const {
  const auto& model = learner_.model;
  const auto batch = Base::training_batch(step, rng.split("captions"));
  const auto branches = branches_of(model, disturbed(batch, rng.split("strange words")), rng.split("noise"), context);
  if (config_.losses.strangers == 0) return loss_of(model, batch, branches);
  const auto texts = strangers_->draw(config_.losses.strangers, rng.split("strangers"));
  const auto strangers = model.system.encode_text(model.tokens(texts, nullptr, context), context).mu;
  return loss_of(model, batch, branches, &strangers);
}

template <AutodiffBackend A>
void TmrTraining<A>::save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about) {
  const auto& model = Base::result();
  const auto scale = measured_similarity(model, *data_, texts_.states ? &*texts_.states : nullptr, texts_.sentences,
                                         strangers_ ? &*strangers_ : nullptr);
  save_text_motion(folder, model, config_, data_->fps, about, &scale);
}

template <AutodiffBackend A>
std::vector<Measure> TmrTraining<A>::validate() {
  LatentTable table;
  const double loss = Base::over_validation([&](std::span<const Index> which, const Philox& rng) {
    const auto& model = learner_.average;
    const auto batch = Base::validation_batch(which);
    const auto branches = branches_of(model, batch, rng, {});
    table.add(batch.texts, branches.text.distribution.mu, branches.motion->distribution.mu);
    return static_cast<double>(loss_of(model, batch, branches).total().item());
  });
  std::vector<Measure> out{{"loss", loss}};
  const auto e = texts_.sentences.template encode<B>(table.texts).tokens.rows;
  const auto r = retrieve(RetrievalProtocol::threshold, Rows(std::span<const float>(table.text), table.width),
                          Rows(std::span<const float>(table.motion), table.width), Rows(e.span(), e.size(1)));
  double sum = 0;
  for (const auto* m : {&r.text_to_motion, &r.motion_to_text}) {
    for (const double recall : m->recall) sum += recall;
  }
  out.push_back({"t2m R@1", r.text_to_motion.recall[0], true});
  out.push_back({"m2t R@1", r.motion_to_text.recall[0], true});
  const Measure recalls{"sum of recalls", sum, true};
  out.insert(config_.validation.watch == "retrieval" ? out.begin() : out.end(), recalls);
  return out;
}

template <AutodiffBackend A>
template <Backend T>
TextMotionBranches<T> TmrTraining<A>::branches_of(const TmrModel<T>& model, const TextMotionBatch<T>& batch,
                                                  const Philox& rng, const Context& context) const {
  return model.system.branches(Base::tokens(model, batch, context), batch.motions, Base::noise(batch, rng), context,
                               config_.losses.recons > 0);
}

template <AutodiffBackend A>
template <Backend T>
LossTerms<T> TmrTraining<A>::loss_of(const TmrModel<T>& model, const TextMotionBatch<T>& batch,
                                     const TextMotionBranches<T>& branches, const Tensor<T, 2>* strangers) const {
  const auto sentences = texts_.sentences.template encode<T>(batch.texts).tokens.rows;
  std::optional<Tensor<T, 0>> temperature;
  if (model.log_temperature) temperature = exp(*model.log_temperature);
  return tmr_losses(branches, batch.motions, &sentences, tmr_loss_options(config_),
                    temperature ? &*temperature : nullptr, strangers);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/tmr_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::TmrTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::TmrTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
