// SPDX-License-Identifier: MIT
/// The second stage of Guo's evaluator: the pair of encoders that put a text and its motion close to each other.
/// `motionlang train-evaluator --stage matching` calls it.
///
///     const GuoMatchingParts<B> parts{load_movement_autoencoder<B>("movement/model").movement_enc, statistics, words};
///     train(GuoMatchingTraining<A>(guo_preset("small", GuoStage::matching), data, parts), {.out = "evaluator"},
///           about);
///
/// Source   Guo et al. (CVPR 2022), section 5.2; text-to-motion train_tex_mot_match.py, networks/trainers.py
///          TextMotionMatchTrainer, data/dataset.py Text2MotionDatasetV2
/// Differs  from the published program: parts of clips are cut at the frame rate of the data. That is 12.5 for KIT,
///          where the program takes 20. An incomplete last batch is filled with items of the first one. Validation
///          draws its negatives from a seed, so that its losses can be compared
#pragma once

#include <algorithm>   // max
#include <filesystem>  // folders
#include <map>         // the record of a training
#include <string>      // the record of a training
#include <utility>     // move
#include <vector>      // entries

#include <motionlang/datasets/guo_clip.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/loss/margin.hpp>
#include <motionlang/metrics/matching.hpp>
#include <motionlang/train/guo_config.hpp>
#include <motionlang/train/guo_model_folder.hpp>
#include <motionlang/train/text_entries.hpp>
#include <motionlang/train/tm2t_tokenizer_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The parts that the stage starts from. They must outlive the training.
template <Backend B>
struct GuoMatchingParts {
  MovementEncoder<B> movements;  // trained by the first stage
  Normalizer<B> statistics;
  GloVe words;
};

/// The two networks that this stage trains.
template <Backend B>
struct GuoPair {
  GuoTextEncoder<B> text_encoder;
  GuoMotionEncoder<B> motion_encoder;

  static constexpr auto fields() {
    return motionlang::fields("text_encoder", &GuoPair::text_encoder, "motion_encoder", &GuoPair::motion_encoder);
  }
};

/// A text with tags where the data set has them, as GloVe::encode reads it.
std::string tagged_text(const DescribedText& t);

/// The entries that the loader of Guo et al. takes: texts with 40 (KIT: 24) to 199 frames, the shortest first.
std::vector<TextEntry> guo_entries(const std::vector<DescribedMotion>& part, Index width);

/// A text of an entry, and the frames that go with it: whole units of four, in one case of three one unit less, from a
/// random start.
struct GuoSample {
  const DescribedText* text;
  FrameSlice frames;
};
GuoSample guo_sample(const TextEntry& e, Philox& rng);

namespace detail {

/// The entries to train on. Throws config_error 102 if there are fewer than two.
std::vector<TextEntry> guo_training_entries(const DescribedMotions& data);
/// Throws config_error 102 unless an encoder of this width reads the motions without their four contacts, and the
/// statistics are of the motions.
void require_guo_widths(Index motions, Index encoder, Index statistics);

}  // namespace detail

template <AutodiffBackend A>
class GuoMatchingTraining : public EpochTask<GuoTrainingConfig, GuoPair<A>, GuoPair<typename A::inner>> {
 public:
  using Base = EpochTask<GuoTrainingConfig, GuoPair<A>, GuoPair<typename A::inner>>;
  using typename Base::B;

  /// data, parts  must outlive the training
  /// Throws       config_error 101, 102 for an invalid configuration; 102 for parts of other features than the data
  GuoMatchingTraining(const GuoTrainingConfig& config, const DescribedMotions& data, const GuoMatchingParts<B>& parts)
      : GuoMatchingTraining(config, data, parts, detail::guo_training_entries(data)) {}

  LossTerms<A> loss(const Philox& rng, Index step, const Context& context) {
    return loss_of_one_part(*this, rng, step, context);
  }
  Index samples(Index step) const { return std::ssize(filled_batch(step)); }
  /// The embeddings of texts and motions, which the loss compares. There are no other terms.
  ComparedPart<A> compared_part(const Philox& rng, Index step, const BatchPart& part, const Context&) {
    auto draw = rng.split("texts");
    const auto which = filled_batch(step);
    const Index all = std::ssize(which), width = config_.matching.embedding;
    const auto [words, movements] = this->batch(entries_, which, draw, part);
    ComparedPart<A> out;
    out.compared.push_back({learner_.model.text_encoder(detail::constants<A>(words)), width, part.first, all});
    out.compared.push_back({learner_.model.motion_encoder(detail::constants<A>(movements)), width, part.first, all});
    return out;
  }
  LossTerms<A> compared_loss(const Philox& rng, Index step, const std::vector<Tensor<A, 2>>& rows) const {
    auto draw = rng.split("texts");
    for (const Index i : filled_batch(step)) guo_sample(entries_[static_cast<std::size_t>(i)], draw);
    return terms_of(rows[0], rows[1], draw);
  }
  /// One step of each of the two optimisers. Each network's gradient is clipped by its own norm.
  void update(const Gradients<A>& gradients, Index step) {
    const double rate = config_.optimiser.rate(step, this->steps());
    const auto step_of = [&](AdamW<A>& adam, auto& network) {
      adam.config.lr = rate;
      const double longest = config_.optimiser.clip_norm;
      adam.step(network, gradients, longest > 0 ? clip_scale(gradient_norm<A>(network, gradients), longest) : 1.0);
    };
    step_of(text_adam_, learner_.model.text_encoder);
    step_of(motion_adam_, learner_.model.motion_encoder);
    if (learner_.ema > 0) update_ema(learner_.average, learner_.model, learner_.ema, step);
  }
  ValidationPlan validation() const { return validation_.size() < 2 ? ValidationPlan{} : Base::validation(); }
  /// The loss, and R-precision of texts in batches of 32.
  std::vector<Measure> validate();

  void add_to(TensorStore& store) const {
    Base::add_to(store);
    add_moments(store, "text_adam.", text_adam_);
    add_moments(store, "motion_adam.", motion_adam_);
  }
  void load(const SafetensorsFile& file, Index steps_done) {
    Base::load(file, steps_done);
    restore_moments(text_adam_, learner_.model.text_encoder, file, "text_adam.", steps_done);
    restore_moments(motion_adam_, learner_.model.motion_encoder, file, "motion_adam.", steps_done);
  }
  std::map<std::string, std::string> settings() const {
    auto out = Base::settings();
    const auto weights = parts_->movements.out_net.weight.span();
    out["movement encoder"] = detail::hexadecimal(detail::content_hash(std::as_bytes(weights)));
    std::string& all = out["words"];
    for (const std::string& word : parts_->words.words()) all += word + "\n";
    return out;
  }
  /// Writes the folder of the evaluator in its published form: finest.tar, its words, its statistics. `about`: license
  /// and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about) {
    save_guo_folder<B>(folder, "guo evaluator", config_, data_->fps, about, parts_->statistics, &parts_->words);
    GuoEvaluator<B> whole = networks_;
    whole.text_encoder = this->result().text_encoder, whole.motion_encoder = this->result().motion_encoder;
    write_guo_evaluator<B>(folder / "finest.tar", whole, config_.optimiser.epochs);
  }

 private:
  struct Batch {
    Sequences<B> words, movements;
  };

  GuoMatchingTraining(const GuoTrainingConfig& config, const DescribedMotions& data, const GuoMatchingParts<B>& parts,
                      std::vector<TextEntry> entries)
      : Base("guo matching", config, data, std::ssize(entries)),
        parts_(&parts),
        entries_(std::move(entries)),
        validation_(guo_entries(data.validation, data.width)) {
    detail::require_guo_widths(data.width, tensors_of(parts.movements).at(0).shape()[1], parts.statistics.mean.size(0));
    const auto& m = config_.matching;
    auto init = Philox{.seed = this->seed()}.split("init");
    GuoPair<B> pair{GuoTextEncoder<B>(parts.words.width(), speech_tags, m.text_hidden, m.embedding, init),
                    GuoMotionEncoder<B>(parts.movements.out_net.out(), m.motion_hidden, m.embedding, init)};
    networks_.movement_encoder = parts.movements;
    this->begin(std::move(pair));
    text_adam_.config = motion_adam_.config = config_.optimiser.adamw();
  }

  /// The numbers of the entries of a step. The last batch of an epoch is filled with entries of the first one.
  std::vector<Index> filled_batch(Index step) const {
    auto which = batches_(step, this->seed());
    if (std::ssize(which) < config_.optimiser.batch) {
      const auto first = batches_(step - step % batches_.per_epoch(), this->seed());
      for (std::size_t i = 0; i < first.size() && std::ssize(which) < config_.optimiser.batch; ++i)
        which.push_back(first[i]);
    }
    return which;
  }
  /// Some of the entries `which`. All are drawn.
  Batch batch(const std::vector<TextEntry>& of, std::span<const Index> which, Philox& draw,
              const BatchPart& part) const {
    std::vector<std::string> texts;
    MotionBatch<B> motions(parts_->statistics);
    Index longest = 0, number = 0;
    for (const Index i : which) {
      const TextEntry& e = of[static_cast<std::size_t>(i)];
      const GuoSample sample = guo_sample(e, draw);
      if (const Index at = number++; at < part.first || at >= part.last) continue;
      texts.push_back(tagged_text(*sample.text));
      motions.add(e.motion->rows, {e.frames.first + sample.frames.first, sample.frames.length});
      longest = std::max(longest, sample.frames.length);
    }
    // As published, zeros follow up to frame 196. Only the two behind a motion matter.
    return {parts_->words.template encode<B>(std::span<const std::string>(texts)).tokens,
            networks_.movements(motions.normalized(), std::min<Index>(196, longest + 4))};
  }
  template <Backend T>
  LossTerms<T> terms_of(const Tensor<T, 2>& texts, const Tensor<T, 2>& motions, Philox& draw) const {
    const auto n = static_cast<std::uint32_t>(texts.size(0));
    const Index shift = static_cast<Index>(draw.below(n - 1)) + (config_.matching.zero_shift ? 0 : 1);
    return shifted_margin_loss(texts, motions, shift, config_.matching.margin);
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  const GuoMatchingParts<B>* parts_;
  std::vector<TextEntry> entries_, validation_;
  GuoEvaluator<B> networks_;  // of which only the movement encoder is set
  AdamW<A> text_adam_{}, motion_adam_{};
};

template <AutodiffBackend A>
std::vector<Measure> GuoMatchingTraining<A>::validate() {
  learner_.follow();
  const EpochBatches batches(std::ssize(validation_), 32);
  MatchingMetric matching;
  double loss = 0;
  for (Index k = 0; k < batches.per_epoch(); ++k) {
    const std::vector<Index> which = batches(k, 0);
    if (which.size() < 2) continue;
    auto draw = Philox{.seed = this->seed()}.split("validation").split(static_cast<std::uint64_t>(k));
    const auto [words, movements] = this->batch(validation_, which, draw, {0, std::ssize(which)});
    const auto texts = learner_.average.text_encoder(words), motions = learner_.average.motion_encoder(movements);
    loss += static_cast<double>(terms_of(texts, motions, draw).total().item()) * static_cast<double>(which.size());
    matching.add(Rows(texts.span(), texts.size(1)), Rows(motions.span(), motions.size(1)));
  }
  return {{"loss", loss / static_cast<double>(matching.queries())},
          {"R@1", matching.r_precision(1), true},
          {"R@3", matching.r_precision(3), true}};
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/guo_matching_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::GuoMatchingTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::GuoMatchingTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
