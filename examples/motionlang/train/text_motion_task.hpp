// Training of TEMOS and TMR: what a step computes, and what a validation measures.
#pragma once

#include <algorithm>
#include <set>

#include <motionlang/features/statistics.hpp>
#include <motionlang/metrics/retrieval.hpp>

#include "epoch_task.hpp"
#include "text_motion_model.hpp"

namespace program {

/// All different texts.
inline std::vector<std::string> all_texts(const DescribedMotions& data) {
  std::set<std::string> texts;
  for (const auto* part : data.parts()) {
    for (const DescribedMotion& m : *part) {
      for (const DescribedText& t : m.texts) texts.insert(t.text);
    }
  }
  return {texts.begin(), texts.end()};
}

/// Mean and unbiased deviation of every feature over the frames of all motions; 1 where a feature never changes.
inline ml::Normalizer<TrainingBackend> statistics_of(const std::vector<DescribedMotion>& motions, ml::Index width) {
  ml::FeatureStatistics statistics;
  for (const DescribedMotion& m : motions) statistics.add(std::span<const float>(m.rows), width);
  std::vector<float> mean, std;
  for (const double x : statistics.mean()) mean.push_back(static_cast<float>(x));
  for (const double x : statistics.standard_deviation()) std.push_back(x < 1e-5 ? 1.0f : static_cast<float>(x));
  return {ml::Tensor<TrainingBackend, 1>::from(mean, {width}), ml::Tensor<TrainingBackend, 1>::from(std, {width})};
}

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
  std::vector<typename B::scalar> values;
  std::vector<ml::Index> lengths;
  const ml::Index width = normalizer.mean.size(0);
  for (const ml::Index i : which) {
    const DescribedMotion& m = motions[static_cast<std::size_t>(i)];
    const DescribedText& t = m.texts[text(m)];
    out.texts.push_back(t.text);
    values.insert(values.end(), m.rows.begin() + t.frames.first * width,
                  m.rows.begin() + (t.frames.first + t.frames.length) * width);
    lengths.push_back(t.frames.length);
  }
  const ml::Offsets offsets{std::span<const ml::Index>(lengths)};
  out.motions = {normalizer.normalize(ml::Tensor<B, 2>::from(values, {offsets.rows(), width})), offsets};
  return out;
}

/// Means of the latents of motions and of their first texts, (motions, latent) row by row: what retrieval compares.
struct LatentTable {
  std::vector<std::string> texts;
  std::vector<float> text, motion;
  ml::Index width = 0;
};
template <template <class> class System, ml::Backend B>
LatentTable latents_of(const TextMotionModel<B, System>& model, const std::vector<DescribedMotion>& motions,
                       const ml::EmbeddingCache* states) {
  LatentTable out;
  constexpr ml::Index at_once = 32;
  for (ml::Index at = 0; at < std::ssize(motions); at += at_once) {
    std::vector<ml::Index> which;
    for (ml::Index i = at; i < std::min(at + at_once, std::ssize(motions)); ++i) which.push_back(i);
    const auto batch = text_motion_batch<B>(motions, which, model.motion_normalizer, [](const auto&) { return 0u; });
    const auto text = model.system.encode_text(model.tokens(batch.texts, states)).mu,
               motion = model.system.encode_motion(batch.motions).mu;
    out.texts.insert(out.texts.end(), batch.texts.begin(), batch.texts.end());
    out.text.insert(out.text.end(), text.span().begin(), text.span().end());
    out.motion.insert(out.motion.end(), motion.span().begin(), motion.span().end());
    out.width = text.size(1);
  }
  return out;
}

template <template <class> class System>
class TextMotionTask : public EpochTask<TextMotionConfig, TextMotionModel<TrainingTape, System>,
                                        TextMotionModel<TrainingBackend, System>> {
 public:
  using Base = EpochTask<TextMotionConfig, TextMotionModel<TrainingTape, System>, TextMotionModel<TrainingBackend, System>>;
  using typename Base::A, typename Base::B;
  using Base::seed;
  static constexpr bool retrieves = std::is_same_v<System<B>, ml::Tmr<B>>;

  /// `states` (null with word pieces) and `sentences` have all texts of `data`. All three outlive the task.
  TextMotionTask(TextMotionConfig config, const DescribedMotions& data, const ml::EmbeddingCache* states,
                 const ml::EmbeddingCache& sentences)
      : Base(system_name<System>(), std::move(config), data), states_(states), sentences_(&sentences) {
    losses(config_);
    if (config_.validation.watch != "loss" && !(retrieves && config_.validation.watch == "retrieval"))
      ml::raise<ml::config_error>(103, "validation.watch '", config_.validation.watch,
                                  retrieves ? "' is not loss or retrieval" : "' is not loss");
    std::optional<ml::WordPiece> pieces;
    if (states_ == nullptr) {
      std::vector<std::string> texts;
      for (const DescribedMotion& m : data.training) {
        for (const DescribedText& t : m.texts) texts.push_back(t.text);
      }
      pieces = ml::WordPiece::learn(texts, config_.text.vocabulary);
    } else {
      config_.text.width = states_->width();
    }
    auto model = make_text_motion<System, B>(config_, data.width, pieces, ml::Philox{.seed = seed()}.split("init"));
    model.motion_normalizer = statistics_of(data.training, data.width);
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
      return ml::TmrLossOptions{.recons = l.recons,
                                .kl = l.kl,
                                .latent = l.latent,
                                .contrastive = l.contrastive,
                                .contrastive_loss = kind,
                                .temperature = l.temperature,
                                .threshold = l.threshold,
                                .margin = l.margin};
    } else {
      if (l.contrastive_loss != "none")
        ml::raise<ml::config_error>(102, "TEMOS has no contrastive loss; losses.contrastive_loss is '",
                                    l.contrastive_loss, "'");
      return ml::TemosLossOptions{.recons = l.recons,
                                  .kl = l.kl,
                                  .latent = l.latent,
                                  .cross_modal_kl = l.cross_modal_kl,
                                  .gaussian_kl = l.gaussian_kl,
                                  .embedding = l.embedding};
    }
  }

  ml::Tensor<A, 0> loss(ml::Philox rng, ml::Index step) const {
    auto choose = rng.split("captions");
    const auto batch = text_motion_batch<A>(
        data_->training, batches_(step, seed()), learner_.model.motion_normalizer,
        [&](const DescribedMotion& m) { return choose.below(static_cast<std::uint32_t>(m.texts.size())); });
    return loss_of(learner_.model, batch, rng.split("noise"), {.dropout = rng.split("dropout")});
  }
  /// The loss without dropout, of first captions and with the same noise every time; of TMR also recalls among the motions of
  /// the validation part, where motions with a text that means the same count as found.
  std::vector<Measure> validate() {
    learner_.follow();
    double total = 0;
    const auto& motions = data_->validation;
    const EpochBatches batches(std::ssize(motions), config_.optimiser.batch);
    for (ml::Index k = 0; k < batches.per_epoch(); ++k) {
      const auto which = batches(k, 0);
      const auto batch =
          text_motion_batch<B>(motions, which, learner_.average.motion_normalizer, [](const auto&) { return 0u; });
      const auto rng = ml::Philox{.seed = seed()}.split("validation").split(static_cast<std::uint64_t>(k));
      total +=
          static_cast<double>(loss_of(learner_.average, batch, rng, {}).item()) * static_cast<double>(which.size());
    }
    std::vector<Measure> out{{"loss", total / static_cast<double>(motions.size())}};
    if constexpr (retrieves) {
      const auto table = latents_of(learner_.average, motions, states_);
      const auto e = sentences_->encode<B>(table.texts).tokens.rows;
      const auto r = ml::retrieve(ml::RetrievalProtocol::threshold, ml::Rows(std::span(table.text), table.width),
                                  ml::Rows(std::span(table.motion), table.width), ml::Rows(e.span(), e.size(1)));
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
    if (learner_.average.words) {
      std::string& pieces = out["text.pieces"];
      for (const auto& p : learner_.average.words->tokenizer.vocabulary()) pieces += p + "\n";
    }
    return out;
  }

 private:
  template <ml::Backend T>
  ml::Tensor<T, 0> loss_of(const TextMotionModel<T, System>& model, const TextMotionBatch<T>& batch,
                           const ml::Philox& rng, const ml::Context& context) const {
    const auto noise = ml::TextMotionNoise<T>::draw(batch.motions.count(), config_.network.latent_dim, rng);
    const auto tokens = model.tokens(batch.texts, states_);
    if constexpr (retrieves) {
      const auto branches = model.system.branches(tokens, batch.motions, noise, context, config_.losses.recons > 0);
      const auto sentences = sentences_->encode<T>(batch.texts).tokens.rows;
      return ml::tmr_losses(branches, batch.motions, &sentences, losses(config_)).total();
    } else {
      return ml::temos_losses(model.system.branches(tokens, batch.motions, noise, context), batch.motions,
                              losses(config_))
          .total();
    }
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  const ml::EmbeddingCache* states_;
  const ml::EmbeddingCache* sentences_;
};

}  // namespace program
