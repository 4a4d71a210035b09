// The other networks at their published sizes, in the manner of models.hpp. Nobody has counted their multiplications.
#pragma once

#include <motionlang/diffusion/motiondiffuse.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/nn/seq2seq_gru.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

#include "models.hpp"

namespace bench {

inline constexpr Index longest = 196;  // frames in HumanML3D

template <ml::Backend B>
ml::Sequences<B> drawn(Index sequences, Index length, Index numbers, ml::Philox& rng) {
  return {ml::Tensor<B, 2>::randn({sequences * length, numbers}, rng), ml::Offsets::equal(sequences, length)};
}
/// A model with random weights, ready for use.
template <class Model>
struct Prepared {
  ml::Philox rng{.seed = 1};
  Model model;

  explicit Prepared(const auto& config) : model(config, rng) { ml::prepare(model); }
  static double gflop() { return 0; }
};

/// A denoising step of MotionDiffuse, of texts that are encoded already.
template <ml::Backend B>
struct MotionDiffuseStep : Prepared<ml::MotionDiffuseDenoiser<B>> {
  ml::Sequences<B> x;
  typename ml::MotionDiffuseDenoiser<B>::EncodedText text;
  std::vector<Index> t;

  explicit MotionDiffuseStep(Index n)
      : Prepared<ml::MotionDiffuseDenoiser<B>>(ml::MotionDiffuseConfig{}),
        x(drawn<B>(n, longest, guo, this->rng)),
        text{ml::Tensor<B, 2>::randn({n, 2048}, this->rng), drawn<B>(n, 77, 256, this->rng)},
        t(equal(n, 50)) {}
  void operator()() const { this->model(x, t, text); }
};

/// The evaluator of Guo et al. on motions or texts.
template <ml::Backend B>
struct GuoMotions : Prepared<ml::GuoEvaluator<B>> {
  ml::Sequences<B> motions = drawn<B>(32, longest, guo, this->rng);

  GuoMotions() : Prepared<ml::GuoEvaluator<B>>(ml::GuoEvaluatorConfig{}) {}
  void operator()() const { this->model.embed_motions(motions); }
};
template <ml::Backend B>
struct GuoTexts : Prepared<ml::GuoEvaluator<B>> {
  ml::Sequences<B> words = drawn<B>(32, 12, 315, this->rng);

  GuoTexts() : Prepared<ml::GuoEvaluator<B>>(ml::GuoEvaluatorConfig{}) {}
  void operator()() const { this->model.embed_texts(words); }
};

/// TM2T's tokenizer.
template <ml::Backend B>
struct ToTokens : Prepared<ml::MotionTokenizer<B>> {
  ml::Sequences<B> x;

  explicit ToTokens(Index n)
      : Prepared<ml::MotionTokenizer<B>>(ml::MotionTokenizerConfig{}), x(drawn<B>(n, longest, guo, this->rng)) {}
  void operator()() const { this->model.tokens(x); }
};
template <ml::Backend B>
struct FromTokens : Prepared<ml::MotionTokenizer<B>> {
  ml::IdSequences tokens;

  explicit FromTokens(Index n)
      : Prepared<ml::MotionTokenizer<B>>(ml::MotionTokenizerConfig{}),
        tokens(this->model.tokens(drawn<B>(n, longest, guo, this->rng))) {}
  void operator()() const { this->model.motions(tokens); }
};

/// TM2T's writer of motion tokens, the most probable one each time.
template <ml::Backend B>
struct Writing : Prepared<ml::Seq2SeqGru<B>> {
  ml::Sequences<B> words;

  explicit Writing(Index n)
      : Prepared<ml::Seq2SeqGru<B>>(ml::Seq2SeqGruConfig{}), words(drawn<B>(n, 12, 300, this->rng)) {}
  void operator()() const {
    auto state = this->model.start(words);
    auto last = equal(words.count(), 1024);
    for (int i = 0; i < 49; ++i) last = ml::arg_max(this->model.step(last, state).logits);
  }
};

template <ml::Backend B>
struct StGcnRun : Prepared<ml::StGcn<B>> {
  ml::Sequences<B> x;

  explicit StGcnRun(Index n) : Prepared<ml::StGcn<B>>(ml::StGcnConfig{}), x(drawn<B>(n, 60, 144, this->rng)) {}
  void operator()() const { this->model(x); }
};

}  // namespace bench
