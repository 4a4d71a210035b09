// SPDX-License-Identifier: MIT
/// The second stage of TM2T: the transformer from motions to texts.
/// `motionlang train-tm2t --stage motion-to-text` calls it.
///
///     TokenizedData<B> tokens{load_tm2t_tokenizer<B>(find_run("tokenizer/model")), words};
///     tokens.tokenize(data);
///     train(Tm2tDescriberTraining<A>(config, data, tokens), {.out = "describer"}, about);
///
/// Source   TM2T (Guo et al., ECCV 2022), section 3.2, appendix B
#pragma once

#include <filesystem>  // folders
#include <map>         // the record of a training
#include <string>      // the record of a training
#include <utility>     // pairs
#include <vector>      // measures

#include <motionlang/nn/seq2seq_transformer.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/tm2t_tokens.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

inline Seq2SeqConfig describer_sizes(const Tm2tDescriberConfig& c, const MotionVocabulary& tokens, const GloVe& words) {
  return {.source_symbols = tokens.size(),
          .target_symbols = words.size() + 1,
          .d_model = c.latent_dim,
          .d_inner = c.ff_size,
          .heads = c.num_heads,
          .head_width = c.latent_dim / c.num_heads,
          .encoder_layers = c.num_layers,
          .decoder_layers = c.num_layers,
          .dropout = c.dropout};
}

template <AutodiffBackend A>
class Tm2tDescriberTraining : public TokenTask<Seq2SeqTransformer<A>, Seq2SeqTransformer<typename A::inner>> {
 public:
  using Base = TokenTask<Seq2SeqTransformer<A>, Seq2SeqTransformer<typename A::inner>>;
  using typename Base::B;

  Tm2tDescriberTraining(const Tm2tTrainingConfig& config, const DescribedMotions& data, const TokenizedData<B>& tokens)
      : Base("tm2t motion-to-text", config, data, tokens) {
    auto init = Philox{.seed = this->seed()}.split("init");
    this->begin(
        Seq2SeqTransformer<B>(describer_sizes(config_.motion_to_text, tokens.model.vocabulary(), tokens.words), init));
  }

  /// The sum over the words of the batch, as published.
  LossTerms<A> loss(const Philox& rng, Index step, const Context& context) const {
    const auto b = this->batch(rng, step);
    LossTerms<A> out;
    out.add("words", 1,
            next_symbol_loss(logits_of(learner_.model, b, context), b.words, config_.motion_to_text.smoothing));
    return out;
  }
  std::vector<Measure> validate() {
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
