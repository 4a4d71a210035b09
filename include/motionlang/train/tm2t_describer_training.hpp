// SPDX-License-Identifier: MIT
/// The second stage of TM2T: the transformer from motions to texts.
/// `motionlang train-tm2t --stage motion-to-text` calls it.
///
///     TokenizedData<B> tokens{load_tm2t_tokenizer<B>(find_run("tokenizer/model")), words};
///     tokens.tokenize(data);
///     train(Tm2tDescriberTraining<A>(config, data, tokens), {.out = "describer"}, about);
///
/// With motion_to_text.tokens = false it reads features instead of tokens, as "ours w/o MT" in table 1. The paper does
/// not say how; here four frames side by side take the place of a token, so that both have equally many positions.
/// Source   TM2T (Guo et al., ECCV 2022), section 3.2, appendix B
#pragma once

#include <filesystem>  // folders
#include <map>         // the record of a training
#include <string>      // the record of a training
#include <utility>     // pairs
#include <vector>      // measures

#include <motionlang/nn/seq2seq_transformer.hpp>
#include <motionlang/train/motion_batch.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/tm2t_tokens.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// width: of the features
inline Seq2SeqConfig describer_sizes(const Tm2tDescriberConfig& c, const MotionVocabulary& tokens, const GloVe& words,
                                     Index width) {
  Seq2SeqConfig out = detail::tm2t_transformer_sizes(c);
  out.source_symbols = c.tokens ? tokens.size() : 0;
  out.source_width = c.tokens ? 0 : 4 * width;
  out.target_symbols = words.size() + 1;
  return out;
}

template <AutodiffBackend A>
class Tm2tDescriberTraining : public TokenTask<Seq2SeqTransformer<A>, Seq2SeqTransformer<typename A::inner>> {
 public:
  using Base = TokenTask<Seq2SeqTransformer<A>, Seq2SeqTransformer<typename A::inner>>;
  using typename Base::B;

  Tm2tDescriberTraining(const Tm2tTrainingConfig& config, const DescribedMotions& data, const TokenizedData<B>& tokens)
      : Base("tm2t motion-to-text", config, data, tokens) {
    auto init = Philox{.seed = this->seed()}.split("init");
    this->begin(Seq2SeqTransformer<B>(
        describer_sizes(config_.motion_to_text, tokens.model.vocabulary(), tokens.words, data.width), init));
  }

  /// The sum over the words of the batch, as published.
  LossTerms<A> loss(const Philox& rng, Index step, const Context& context) const {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(const Philox& rng, Index step, const BatchPart& part, const Context& context) const {
    LossTerms<A> out;
    const auto add = [&](const Tensor<A, 2>& logits, const IdSequences& words) {
      out.add("words", 1, next_symbol_loss(logits, words, config_.motion_to_text.smoothing));
    };
    if (config_.motion_to_text.tokens) {
      const auto b = this->batch(rng, step, part);
      add(logits_of(learner_.model, b, context), b.words);
    } else {
      auto draw = rng.split("texts");
      const auto all = features_batch(data_->training, tokens_->training, this->batches_(step, this->seed()), &draw);
      const FeaturesBatch b{motionlang::part_of(all.units, part), motionlang::part_of(all.words, part)};
      add(logits_of(learner_.model, b, context), b.words);
    }
    return out;
  }
  std::vector<Measure> validate() {
    if (!config_.motion_to_text.tokens) return validate_features();
    return this->measured("loss of a word", [&](const TokenizedBatch& b) {
      return std::pair(logits_of(learner_.average, b, {}), b.words);
    });
  }
  /// Writes the folder of the model. `about`: license and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about) {
    const auto& known = tokens_->model;
    save_tm2t<B>(folder, config_, data_->fps, about,
                 {known.tokenizer, known.statistics, &tokens_->words, &this->result()});
  }

 private:
  /// Without motion tokens: four frames side by side, normalised.
  struct FeaturesBatch {
    Sequences<B> units;
    IdSequences words;
  };
  /// draw  chooses a text and the first frame; null: the first ones
  FeaturesBatch features_batch(const std::vector<DescribedMotion>& motions, const TokenizedMotions& of,
                               std::span<const Index> which, Philox* draw) const {
    const auto below = [&](std::size_t n) { return draw == nullptr ? 0 : draw->below(static_cast<std::uint32_t>(n)); };
    MotionBatch<B> batch(tokens_->model.statistics);
    std::vector<std::vector<Index>> words;
    for (const Index i : which) {
      const DescribedMotion& m = motions[static_cast<std::size_t>(i)];
      const auto& texts = of[static_cast<std::size_t>(i)];
      const std::size_t text = below(texts.size());
      const FrameSlice frames = m.texts[text].frames;
      const Index first = static_cast<Index>(below(texts[text].lines.size()));
      batch.add(m.rows, {frames.first + first, std::min(frames.length / 4 * 4, tm2t_longest)});
      words.push_back(texts[text].words);
    }
    return {four_frame_rows(batch.normalized()), IdSequences::from(words)};
  }
  template <Backend T>
  static Tensor<T, 2> logits_of(const Seq2SeqTransformer<T>& model, const FeaturesBatch& b, const Context& context) {
    const auto x = b.units.rows.span();
    const Sequences<T> units{
        Tensor<T, 2>::from(std::vector<typename T::scalar>(x.begin(), x.end()), b.units.rows.shape()), b.units.offsets};
    return model.logits(b.words.without_ends(0, 1), model.encode(units, context), context);
  }
  std::vector<Measure> validate_features() {
    double right = 0;
    const double loss = this->over_validation([&](std::span<const Index> which, const Philox&) {
      const auto b = features_batch(data_->validation, tokens_->validation, which, nullptr);
      const auto logits = logits_of(learner_.average, b, {});
      right += right_symbols(logits, b.words) * static_cast<double>(which.size());
      return static_cast<double>(next_symbol_loss(logits, b.words).item()) / written_symbols(b.words);
    });
    return {{"loss of a word", loss}, {"accuracy", right / static_cast<double>(data_->validation.size()), true}};
  }
  template <Backend T>
  static Tensor<T, 2> logits_of(const Seq2SeqTransformer<T>& model, const TokenizedBatch& b, const Context& context) {
    return model.logits(b.words.without_ends(0, 1), model.encode(b.tokens, context), context);
  }

  using Base::config_, Base::data_, Base::learner_, Base::tokens_;
};

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::Tm2tDescriberTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::Tm2tDescriberTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
