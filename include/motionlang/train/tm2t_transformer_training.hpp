// SPDX-License-Identifier: MIT
/// The third stage of TM2T with a transformer instead of the recurrent network, and without inverse alignment: the
/// baseline (T) of the paper. `motionlang train-tm2t --stage text-to-motion --set text_to_motion.network=transformer`
/// calls it; train/tm2t_describer_training.hpp shows how to use it.
///
/// Source   TM2T (Guo et al., ECCV 2022), table 2, "baseline (T)"; networks/transformer.py TransformerV1,
///          train_seq2seq_t2m.py
#pragma once

#include <filesystem>  // folders
#include <map>         // the record of a training
#include <string>      // the record of a training
#include <utility>     // pairs
#include <vector>      // vectors of words

#include <motionlang/nn/seq2seq_transformer.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/tm2t_tokens.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

inline Seq2SeqConfig transformer_writer_sizes(const Tm2tWriterConfig& c, const MotionVocabulary& tokens,
                                              Index word_width) {
  Seq2SeqConfig out = detail::tm2t_transformer_sizes(c);
  out.source_symbols = 0;
  out.source_width = word_width;
  out.target_symbols = tokens.size();
  out.source_positions = 50;
  out.target_positions = 100;
  return out;
}

template <AutodiffBackend A>
class Tm2tTransformerTraining : public TokenTask<Seq2SeqTransformer<A>, Seq2SeqTransformer<typename A::inner>> {
 public:
  using Base = TokenTask<Seq2SeqTransformer<A>, Seq2SeqTransformer<typename A::inner>>;
  using typename Base::B;

  Tm2tTransformerTraining(const Tm2tTrainingConfig& config, const DescribedMotions& data,
                          const TokenizedData<B>& tokens)
      : Base("tm2t text-to-motion transformer", config, data, tokens), vectors_(word_table(tokens.words)) {
    auto init = Philox{.seed = this->seed()}.split("init");
    this->begin(Seq2SeqTransformer<B>(
        transformer_writer_sizes(config_.text_to_motion, tokens.model.vocabulary(), tokens.words.width()), init));
  }

  /// The sum over the tokens of the batch, as published. The decoder sees the true tokens.
  LossTerms<A> loss(const Philox& rng, Index step, const Context& context) const {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(const Philox& rng, Index step, const BatchPart& part, const Context& context) const {
    const auto b = this->batch(rng, step, part);
    LossTerms<A> out;
    out.add("tokens", 1, next_symbol_loss(logits_of(learner_.model, b, context), b.tokens));
    return out;
  }
  std::vector<Measure> validate() {
    return this->measured("loss of a token", [&](const TokenizedBatch& b) {
      return std::pair(logits_of(learner_.average, b, {}), b.tokens);
    });
  }
  /// Writes the folder of the model. `about`: license and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about) {
    const auto& known = tokens_->model;
    save_tm2t<B>(folder, config_, data_->fps, about,
                 {known.tokenizer, known.statistics, &tokens_->words, nullptr, nullptr, &this->result()});
  }

 private:
  template <Backend T>
  Tensor<T, 2> logits_of(const Seq2SeqTransformer<T>& model, const TokenizedBatch& b, const Context& context) const {
    const auto words = word_rows<T>(vectors_, tokens_->words.width(), b.words);
    return model.logits(b.tokens.without_ends(0, 1), model.encode(words, context), context);
  }

  using Base::config_, Base::data_, Base::learner_, Base::tokens_;
  std::vector<float> vectors_;  // of the words, by id
};

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::Tm2tTransformerTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::Tm2tTransformerTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
