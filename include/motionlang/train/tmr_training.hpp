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

  LossTerms<A> loss(Philox rng, Index step, const Context& context) const {
    return loss_of_one_part(*this, rng, step, context);
  }
  /// The samples of the latents of texts and motions, and the latents of a share of the strangers.
  ComparedPart<A> compared_part(Philox rng, Index step, const BatchPart& part, const Context& context) const;
  LossTerms<A> compared_loss(Philox rng, Index step, const std::vector<Tensor<A, 2>>& rows) const;
  /// The loss without dropout, of first captions and always with the same noise; recalls among the motions of the
  /// validation part. A motion also counts as found if it has a text with the same meaning.
  std::vector<Measure> validate();
  /// As for TextTask, with the scale of its similarities. Models that read the states of a language model get a scale
  /// that does not tell if a text is shown.
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about);

 private:
  /// The texts of a batch, some of which got words of other subjects.
  std::vector<std::string> disturbed(std::vector<std::string> texts, Philox rng) const {
    if (config_.text.strange_words == 0) return texts;
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (rng.uniform() < config_.text.strange_words)
        texts[i] = strangers_->disturb(texts[i], rng.split(static_cast<std::uint64_t>(i)));
    }
    return texts;
  }
  /// first: the number of the batch's first motion in the batch of the step.
  template <Backend T>
  TextMotionBranches<T> branches_of(const TmrModel<T>& model, const TextMotionBatch<T>& batch, const Philox& rng,
                                    const Context& context, Index first = 0) const;
  /// longest: frames of the longest motion, if it may be in another part
  template <Backend T>
  LossTerms<T> own_loss(const TextMotionBatch<T>& batch, const TextMotionBranches<T>& branches,
                        Index longest = 0) const {
    auto options = tmr_loss_options(config_);
    options.contrastive_loss = ContrastiveLoss::none, options.padded_frames = longest;
    return tmr_losses<T>(branches, batch.motions, nullptr, options);
  }
  template <Backend T>
  LossTerms<T> contrastive_loss(const TmrModel<T>& model, const std::vector<std::string>& texts, const Tensor<T, 2>& x,
                                const Tensor<T, 2>& y, const Tensor<T, 2>* strangers = nullptr) const {
    const auto sentences = texts_.sentences.template encode<T>(texts).tokens.rows;
    std::optional<Tensor<T, 0>> temperature;
    if (model.log_temperature) temperature = exp(*model.log_temperature);
    return tmr_contrastive_loss(x, y, &sentences, tmr_loss_options(config_), temperature ? &*temperature : nullptr,
                                strangers);
  }

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
ComparedPart<A> TmrTraining<A>::compared_part(Philox rng, Index step, const BatchPart& part,
                                              const Context& context) const {
  const auto& model = learner_.model;
  const auto chosen = Base::training_texts_of(step, rng.split("captions"));
  const Index all = std::ssize(chosen), width = config_.network.latent_dim;
  const auto batch = text_motion_batch<A>(part.of(chosen), model.motion_normalizer);
  std::vector<std::string> texts;
  for (const ChosenText& c : chosen) texts.push_back(c.text->text);
  texts = disturbed(std::move(texts), rng.split("strange words"));
  const auto own = part.of(texts);
  const auto branches = branches_of(model, TextMotionBatch<A>{{own.begin(), own.end()}, batch.motions},
                                    rng.split("noise"), context, part.first);
  ComparedPart<A> out;
  if (tmr_loss_options(config_).contrastive_loss != ContrastiveLoss::none)
    out.compared = {{branches.text.z, width, part.first, all}, {branches.motion->z, width, part.first, all}};
  if (const Index count = config_.losses.strangers; count > 0) {
    const auto drawn = strangers_->draw(count, rng.split("strangers"));
    const BatchPart share{count * part.first / all, count * part.last / all};
    ComparedRows<A> rows{{}, width, share.first, count};
    if (const auto mine = share.of(drawn); !mine.empty())
      rows.rows =
          model.system
              .encode_text(model.tokens(std::vector<std::string>(mine.begin(), mine.end()), nullptr, context), context)
              .mu;
    out.compared.push_back(std::move(rows));
  }
  out.terms = weighted(own_loss(batch, branches, longest_of(chosen)), part.share(all));
  return out;
}

template <AutodiffBackend A>
LossTerms<A> TmrTraining<A>::compared_loss(Philox rng, Index step, const std::vector<Tensor<A, 2>>& rows) const {
  if (rows.empty()) return {};
  std::vector<std::string> texts;
  for (const ChosenText& c : Base::training_texts_of(step, rng.split("captions"))) texts.push_back(c.text->text);
  return contrastive_loss(learner_.model, texts, rows[0], rows[1], rows.size() > 2 ? &rows[2] : nullptr);
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
    auto terms = own_loss(batch, branches);
    terms.append(contrastive_loss(model, batch.texts, branches.text.z, branches.motion->z));
    return static_cast<double>(terms.total().item());
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
                                                  const Philox& rng, const Context& context, Index first) const {
  return model.system.branches(Base::tokens(model, batch, context), batch.motions, Base::noise(batch, rng, first),
                               context, config_.losses.recons > 0);
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
