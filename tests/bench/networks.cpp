// The other networks at their published sizes, with random weights: a denoising step of MotionDiffuse, the evaluator of Guo et al., TM2T's
// tokenizer and writer of motions, ST-GCN and its training.
//
// usage: bench_networks [THREADS] [--bf16] [motiondiffuse guo_evaluator tm2t_tokenizer train_tokenizer tm2t_write stgcn train_stgcn ...]
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/diffusion/motiondiffuse.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/nn/seq2seq_gru.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

#include "models.hpp"

namespace {

using namespace bench;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;

constexpr Index frames = 196;  // HumanML3D's longest

template <ml::Backend X>
ml::Sequences<X> drawn(Index sequences, Index length, Index numbers, ml::Philox& rng) {
  return {ml::Tensor<X, 2>::randn({sequences * length, numbers}, rng), ml::Offsets::equal(sequences, length)};
}
template <class Model>
Model prepared(const auto& config, ml::Philox& rng) {
  Model m(config, rng);
  ml::prepare(m);
  return m;
}
template <class F>
void times(const std::string& work, const std::string& config, F f) {
  report(work, config, 0, f);
}
/// Steps of AdamW on the loss of a model.
template <class Model, class F>
void training(const std::string& work, const std::string& config, Model& model, F loss) {
  ml::AdamW<A> adam{{.lr = 1e-4}};
  report(work, config, 0, [&] { adam.step(model, ml::backward(loss())); }, {.seconds = 8, .least = 4});
}

void motiondiffuse(ml::Philox rng) {
  const auto model = prepared<ml::MotionDiffuseDenoiser<B>>(ml::MotionDiffuseConfig{}, rng);
  for (Index n : {1, 8}) {
    const auto x = drawn<B>(n, frames, guo, rng);
    const ml::MotionDiffuseDenoiser<B>::EncodedText text{ml::Tensor<B, 2>::randn({n, 2048}, rng),
                                                         drawn<B>(n, 77, 256, rng)};
    const auto t = equal(n, 50);
    times("motiondiffuse", shape(n, frames), [&] { model(x, t, text); });
  }
}
void guo_evaluator(ml::Philox rng) {
  const auto model = prepared<ml::GuoEvaluator<B>>(ml::GuoEvaluatorConfig{}, rng);
  const auto motions = drawn<B>(32, frames, guo, rng), words = drawn<B>(32, 12, 315, rng);
  times("guo_evaluator", "32 motions T=196", [&] { model.embed_motions(motions); });
  times("guo_evaluator", "32 texts T=12", [&] { model.embed_texts(words); });
}
void tm2t_tokenizer(ml::Philox rng) {
  const auto model = prepared<ml::MotionTokenizer<B>>(ml::MotionTokenizerConfig{}, rng);
  for (Index n : {1, 32}) {
    const auto x = drawn<B>(n, frames, guo, rng);
    const auto tokens = model.tokens(x);
    times("tm2t_tokenizer", shape(n, frames) + " to tokens", [&] { model.tokens(x); });
    times("tm2t_tokenizer", shape(n, frames) + " from tokens", [&] { model.motions(tokens); });
  }
}
void train_tokenizer(ml::Philox rng) {
  ml::MotionTokenizer<A> model(ml::MotionTokenizerConfig{}, rng);
  const auto x = drawn<A>(32, 64, guo, rng);
  training("train_tokenizer", shape(32, 64), model, [&] {
    const auto result = model(x);
    return ml::mse(result.reconstruction.rows, x.rows) + result.quantized.loss;
  });
}
void tm2t_write(ml::Philox rng) {
  const auto model = prepared<ml::Seq2SeqGru<B>>(ml::Seq2SeqGruConfig{}, rng);
  for (Index n : {1, 32}) {
    const auto words = drawn<B>(n, 12, 300, rng);
    times("tm2t_write", "B=" + std::to_string(n) + " 49 tokens", [&] {
      auto state = model.start(words);
      auto last = equal(n, 1024);
      for (int i = 0; i < 49; ++i) last = ml::arg_max(model.step(last, state).logits);
    });
  }
}
void stgcn(ml::Philox rng) {
  const auto model = prepared<ml::StGcn<B>>(ml::StGcnConfig{}, rng);
  for (Index n : {1, 32}) {
    const auto x = drawn<B>(n, 60, 144, rng);
    times("stgcn", shape(n, 60), [&] { model(x); });
  }
}
void train_stgcn(ml::Philox rng) {
  ml::StGcn<A> model(ml::StGcnConfig{}, rng);
  const auto x = drawn<A>(16, 60, 144, rng);
  training("train_stgcn", shape(16, 60), model, [&] { return ml::mean(ml::square(model.train(x).logits)); });
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments asked_for(argc, argv);
  const ml::Philox rng{.seed = 1};
  constexpr std::pair<const char*, void (*)(ml::Philox)> works[] = {
      {"motiondiffuse", motiondiffuse},     {"guo_evaluator", guo_evaluator}, {"tm2t_tokenizer", tm2t_tokenizer},
      {"train_tokenizer", train_tokenizer}, {"tm2t_write", tm2t_write},       {"stgcn", stgcn},
      {"train_stgcn", train_stgcn}};
  for (const auto& [work, run] : works) {
    if (asked_for.asked(work)) run(rng);
  }
}
