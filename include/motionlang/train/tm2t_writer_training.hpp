// SPDX-License-Identifier: MIT
/// The third stage of TM2T: the recurrent network from texts to motions, with inverse alignment.
/// `motionlang train-tm2t --stage text-to-motion` calls it; train/tm2t_describer_training.hpp shows how to use it.
///
/// Source   TM2T (Guo et al., ECCV 2022), section 3.3; networks/trainers.py Seq2SeqT2MJointTrainer
#pragma once

#include <algorithm>   // max
#include <filesystem>  // folders
#include <map>         // the record of a training
#include <optional>    // a describer
#include <string>      // words
#include <utility>     // pairs
#include <vector>      // vectors of words

#include <motionlang/nn/seq2seq_gru.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/tm2t_tokens.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <AutodiffBackend A>
class Tm2tWriterTraining : public TokenTask<Seq2SeqGru<A>, Seq2SeqGru<typename A::inner>> {
 public:
  using Base = TokenTask<Seq2SeqGru<A>, Seq2SeqGru<typename A::inner>>;
  using typename Base::B;

  /// For inverse alignment, `tokens` holds the transformer from motions to texts.
  Tm2tWriterTraining(const Tm2tTrainingConfig& config, const DescribedMotions& data, const TokenizedData<B>& tokens);

  /// As published, a step has two updates. The first uses the true tokens. The second uses the describer's loss on the
  /// tokens that the writer predicts with the weights of the first. The describer has dropout and is not trained.
  Index updates(Index step) const { return step < first_alignment() ? 1 : 2; }
  /// Makes the first of two updates. The terms are those of both; the gradient is that of the last.
  LossTerms<A> loss(const Philox& rng, Index step, const Context& context);
  LossTerms<A> part_loss(const Philox& rng, Index step, const BatchPart& part, const Context& context,
                         Index update = 0);
  /// The model reads its own output.
  std::vector<Measure> validate() {
    return this->measured("loss of a token", [&](const TokenizedBatch& b) {
      return std::pair(learner_.average.logits(vectors_of<B>(b.words), b.tokens.without_ends(0, 1), false), b.tokens);
    });
  }
  void load(const SafetensorsFile& file, Index steps_done) {
    Base::load(file, steps_done + std::max<Index>(0, steps_done - first_alignment()));  // updates
  }
  /// Writes the folder of the model. `about`: license and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about) {
    const auto& known = tokens_->model;
    save_tm2t<B>(folder, config_, data_->fps, about,
                 {known.tokenizer, known.statistics, &tokens_->words,
                  config_.text_to_motion.aligned() ? &known.m2t_transformer : nullptr, &this->result()});
  }

 private:
  template <Backend T>
  Sequences<T> vectors_of(const IdSequences& words) const {
    return word_rows<T>(vectors_, tokens_->words.width(), words);
  }
  Index first_alignment() const {
    return describer_ ? config_.text_to_motion.alignment_from * batches_.per_epoch() : this->steps();
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_, Base::tokens_;
  std::vector<float> vectors_;  // of the words, by id
  std::optional<Seq2SeqTransformer<A>> describer_;
};

template <AutodiffBackend A>
Tm2tWriterTraining<A>::Tm2tWriterTraining(const Tm2tTrainingConfig& config, const DescribedMotions& data,
                                          const TokenizedData<B>& tokens)
    : Base("tm2t text-to-motion", config, data, tokens) {
  const auto& c = config_.text_to_motion;
  vectors_ = word_table(tokens.words);
  if (c.aligned()) describer_ = convert<A>(tokens.model.m2t_transformer);
  auto init = Philox{.seed = this->seed()}.split("init");
  this->begin(Seq2SeqGru<B>({.word = tokens.words.width(),
                             .text_hidden = c.text_hidden,
                             .motion_hidden = c.motion_hidden,
                             .layers = c.layers,
                             .symbols = tokens.model.vocabulary().size(),
                             .late = c.late},
                            init));
}

template <AutodiffBackend A>
LossTerms<A> Tm2tWriterTraining<A>::loss(const Philox& rng, Index step, const Context& context) {
  const BatchPart all{0, this->samples(step)};
  LossTerms<A> out = part_loss(rng, step, all, context);
  if (updates(step) == 1) return out;
  this->update(backward(out.total()), step);
  for (auto& term : out.terms) term.value = Tensor<A, 0>(static_cast<double>(term.value.item()));
  out.append(part_loss(rng, step, all, context, 1));
  return out;
}

template <AutodiffBackend A>
LossTerms<A> Tm2tWriterTraining<A>::part_loss(const Philox& rng, Index step, const BatchPart& part,
                                              const Context& context, Index update) {
  const auto& c = config_.text_to_motion;
  const auto b = this->batch(rng, step, part);
  const auto words = vectors_of<A>(b.words);
  const MotionVocabulary vocabulary = tokens_->model.vocabulary();
  LossTerms<A> out;
  if (update == 0) {
    const TeacherForcing forcing{c.forced_first, c.forced_last, c.forced_epochs};
    const bool forced = rng.split("forced").uniform() < forcing(step / batches_.per_epoch());
    const auto logits = learner_.model.logits(words, b.tokens.without_ends(0, 1), forced, b.longest);
    out.add("tokens", 1, next_symbol_loss(logits, b.tokens));
    return out;
  }
  const GumbelNoise noise{rng.split("noise"), this->samples(step), vocabulary.size()};
  out.add("words", 1,
          inverse_alignment_loss(
              learner_.model, *describer_, words, b.words,
              {.begin = vocabulary.begin(), .end = vocabulary.end(), .longest = b.longest},
              [&](Index t) { return noise.template rows<A>(t, part.first, part.count()); }, context));
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::Tm2tWriterTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::Tm2tWriterTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
