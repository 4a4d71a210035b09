// Training of TEMOS and TMR: what a step computes, and what a validation measures.
#pragma once

#include <algorithm>
#include <set>

#include <motionlang/metrics/retrieval.hpp>

#include "epoch_task.hpp"
#include "motion_batch.hpp"
#include "text_motion_model.hpp"

namespace program {

/// Motions with one text each, as a model takes them.
template <ml::Backend B>
struct TextMotionBatch {
  std::vector<std::string> texts;
  ml::Sequences<B> motions;  // normalised
};
/// `which` are numbers of motions; text(motion) chooses one of its texts.
template <ml::Backend B, class Choose>
TextMotionBatch<B> text_motion_batch(const std::vector<DescribedMotion>& motions, std::span<const ml::Index> which,
                                     const ml::Normalizer<B>& normalizer, Choose text) {
  TextMotionBatch<B> out;
  MotionBatch<B> batch(normalizer);
  for (const ml::Index i : which) {
    const DescribedMotion& m = motions[static_cast<std::size_t>(i)];
    const DescribedText& t = m.texts[text(m)];
    out.texts.push_back(t.text);
    batch.add(m.rows, t.frames);
  }
  out.motions = batch.normalized();
  return out;
}

/// Means of the latents of motions and of their first texts, (motions, latent) row by row: what retrieval compares.
struct LatentTable {
  std::vector<std::string> texts;
  std::vector<float> text, motion;
  ml::Index width = 0;

  template <ml::Backend B>
  void add(const std::vector<std::string>& more, const ml::Tensor<B, 2>& of_texts, const ml::Tensor<B, 2>& of_motions) {
    texts.insert(texts.end(), more.begin(), more.end());
    text.insert(text.end(), of_texts.span().begin(), of_texts.span().end());
    motion.insert(motion.end(), of_motions.span().begin(), of_motions.span().end());
    width = of_texts.size(1);
  }
};
/// seen(batch)  motions in place of those of the batch, normalised
template <template <class> class System, ml::Backend B, class Seen>
LatentTable latents_of(const TextMotionModel<B, System>& model, const std::vector<DescribedMotion>& motions,
                       const ml::EmbeddingCache* states, Seen seen) {
  LatentTable out;
  constexpr ml::Index at_once = 32;
  for (ml::Index at = 0; at < std::ssize(motions); at += at_once) {
    std::vector<ml::Index> which;
    for (ml::Index i = at; i < std::min(at + at_once, std::ssize(motions)); ++i) which.push_back(i);
    const auto batch = text_motion_batch<B>(motions, which, model.motion_normalizer, [](const auto&) { return 0u; });
    out.add(batch.texts, model.system.encode_text(model.tokens(batch.texts, states)).mu,
            model.system.encode_motion(seen(batch)).mu);
  }
  return out;
}
template <template <class> class System, ml::Backend B>
LatentTable latents_of(const TextMotionModel<B, System>& model, const std::vector<DescribedMotion>& motions,
                       const ml::EmbeddingCache* states) {
  return latents_of(model, motions, states, [](const TextMotionBatch<B>& batch) { return batch.motions; });
}

template <template <class> class System>
class TextMotionTask : public EpochTask<TextMotionConfig, TextMotionModel<TrainingTape, System>,
                                        TextMotionModel<TrainingBackend, System>> {
 public:
  using Base =
      EpochTask<TextMotionConfig, TextMotionModel<TrainingTape, System>, TextMotionModel<TrainingBackend, System>>;
  using Base::seed;
  using typename Base::A, typename Base::B;
  static constexpr bool retrieves = std::is_same_v<System<B>, ml::Tmr<B>>;

  /// `states` (null with word pieces or a language model) and `sentences` have all texts of `data`. All three outlive
  /// the task.
  /// statistics   a folder with those of the features; empty: of the motions to train on
  /// language     trained with the model
  TextMotionTask(TextMotionConfig config, const DescribedMotions& data, const ml::EmbeddingCache* states,
                 const ml::EmbeddingCache& sentences, const std::filesystem::path& statistics = {},
                 std::optional<LanguageModel<B>> language = {})
      : Base(system_name<System>(), std::move(config), data), states_(states), sentences_(&sentences) {
    losses(config_);
    if (config_.validation.watch != "loss" && !(retrieves && config_.validation.watch == "retrieval"))
      ml::raise<ml::config_error>(103, "validation.watch '", config_.validation.watch,
                                  retrieves ? "' is not loss or retrieval" : "' is not loss");
    std::optional<ml::WordPiece> pieces;
    if (language) {
      config_.text.width = language->files.sizes.width;
    } else if (states_ == nullptr) {
      std::vector<std::string> texts;
      for (const DescribedMotion& m : data.training) {
        for (const DescribedText& t : m.texts) texts.push_back(t.text);
      }
      pieces = ml::WordPiece::learn(texts, config_.text.vocabulary);
    } else {
      config_.text.width = states_->width();
    }
    auto model = make_text_motion<System, B>(config_, data.width, pieces, ml::Philox{.seed = seed()}.split("init"));
    model.language = std::move(language);
    model.motion_normalizer = statistics_of(statistics, data);
    Base::begin(std::move(model));
  }

  /// The loss of a configuration. Throws config_error 102, 103.
  static auto losses(const TextMotionConfig& c) {
    const auto& l = c.losses;
    if constexpr (retrieves) {
      const auto kind = l.contrastive_loss == "info_nce" ? ml::ContrastiveLoss::info_nce
                        : l.contrastive_loss == "margin" ? ml::ContrastiveLoss::margin
                                                         : ml::ContrastiveLoss::none;
      if (kind == ml::ContrastiveLoss::none && l.contrastive_loss != "none")
        ml::raise<ml::config_error>(103, "losses.contrastive_loss '", l.contrastive_loss,
                                    "' is not info_nce, margin or none");
      if (l.learned_temperature && kind != ml::ContrastiveLoss::info_nce)
        ml::raise<ml::config_error>(102, "losses.learned_temperature is for info_nce; losses.contrastive_loss is '",
                                    l.contrastive_loss, "'");
      return ml::TmrLossOptions{.recons = l.recons,
                                .kl = l.kl,
                                .latent = l.embedding ? l.latent : 0,
                                .contrastive = l.contrastive,
                                .contrastive_loss = kind,
                                .temperature = l.temperature,
                                .threshold = l.threshold,
                                .margin = l.margin,
                                .cross_modal_kl = l.cross_modal_kl,
                                .gaussian_kl = l.gaussian_kl};
    } else {
      if (l.contrastive_loss != "none" || l.learned_temperature)
        ml::raise<ml::config_error>(102, "TEMOS has no contrastive loss; losses.contrastive_loss is '",
                                    l.contrastive_loss, "', losses.learned_temperature ", l.learned_temperature);
      return ml::TemosLossOptions{.recons = l.recons,
                                  .kl = l.kl,
                                  .latent = l.latent,
                                  .cross_modal_kl = l.cross_modal_kl,
                                  .gaussian_kl = l.gaussian_kl,
                                  .embedding = l.embedding};
    }
  }

  ml::LossTerms<A> loss(ml::Philox rng, ml::Index step, const ml::Context& context) const {
    auto choose = rng.split("captions");
    const auto batch = text_motion_batch<A>(
        data_->training, batches_(step, seed()), learner_.model.motion_normalizer,
        [&](const DescribedMotion& m) { return choose.below(static_cast<std::uint32_t>(m.texts.size())); });
    return loss_of(learner_.model, batch, branches_of(learner_.model, batch, rng.split("noise"), context));
  }
  /// The loss without dropout, of first captions and with the same noise every time; of TMR also recalls among the
  /// motions of the validation part, where motions with a text that means the same count as found.
  std::vector<Measure> validate() {
    LatentTable table;
    const double loss = Base::over_validation([&](std::span<const ml::Index> which, const ml::Philox& rng) {
      const auto& model = learner_.average;
      const auto batch =
          text_motion_batch<B>(data_->validation, which, model.motion_normalizer, [](const auto&) { return 0u; });
      const auto branches = branches_of(model, batch, rng, {});
      if constexpr (retrieves) table.add(batch.texts, branches.text.distribution.mu, branches.motion->distribution.mu);
      return static_cast<double>(loss_of(model, batch, branches).total().item());
    });
    std::vector<Measure> out{{"loss", loss}};
    if constexpr (retrieves) {
      const auto e = sentences_->encode<B>(table.texts).tokens.rows;
      const auto r =
          ml::retrieve(ml::RetrievalProtocol::threshold, ml::Rows(std::span<const float>(table.text), table.width),
                       ml::Rows(std::span<const float>(table.motion), table.width), ml::Rows(e.span(), e.size(1)));
      double sum = 0;
      for (const auto* m : {&r.text_to_motion, &r.motion_to_text}) {
        for (const double recall : m->recall) sum += recall;
      }
      out.push_back({"t2m R@1", r.text_to_motion.recall[0], true});
      out.push_back({"m2t R@1", r.motion_to_text.recall[0], true});
      const Measure recalls{"sum of recalls", sum, true};
      out.insert(config_.validation.watch == "retrieval" ? out.begin() : out.end(), recalls);
    }
    return out;
  }

  std::map<std::string, std::string> settings() const {
    auto out = Base::settings();
    add_pieces(out, learner_.average.words);
    return out;
  }

 private:
  template <ml::Backend T>
  ml::TextMotionBranches<T> branches_of(const TextMotionModel<T, System>& model, const TextMotionBatch<T>& batch,
                                        const ml::Philox& rng, const ml::Context& context) const {
    const auto noise = ml::TextMotionNoise<T>::draw(batch.motions.count(), config_.network.latent_dim, rng);
    const auto tokens = model.tokens(batch.texts, states_, context);
    if constexpr (retrieves)
      return model.system.branches(tokens, batch.motions, noise, context, config_.losses.recons > 0);
    else
      return model.system.branches(tokens, batch.motions, noise, context);
  }
  template <ml::Backend T>
  ml::LossTerms<T> loss_of(const TextMotionModel<T, System>& model, const TextMotionBatch<T>& batch,
                           const ml::TextMotionBranches<T>& branches) const {
    if constexpr (retrieves) {
      const auto sentences = sentences_->encode<T>(batch.texts).tokens.rows;
      std::optional<ml::Tensor<T, 0>> temperature;
      if (model.log_temperature) temperature = exp(*model.log_temperature);
      return ml::tmr_losses(branches, batch.motions, &sentences, losses(config_),
                            temperature ? &*temperature : nullptr);
    } else {
      return ml::temos_losses(branches, batch.motions, losses(config_));
    }
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  const ml::EmbeddingCache* states_;
  const ml::EmbeddingCache* sentences_;
};

}  // namespace program
