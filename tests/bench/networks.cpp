// The other networks at their published sizes, with random weights: a denoising step of MotionDiffuse, the evaluator of
// Guo et al., TM2T's tokenizer and writer of motions, ST-GCN; training of the tokenizer and of ST-GCN.
//
// usage: bench_networks [THREADS] [--bf16] [motiondiffuse guo_evaluator tm2t_tokenizer train_tokenizer tm2t_write stgcn
// train_stgcn ...]
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/optim/adamw.hpp>

#include "networks.hpp"

namespace {

using namespace bench;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;

void times(const std::string& work, const std::string& config, const auto& run) {
  report(work, config, run.gflop(), run);
}
/// Steps of AdamW on the loss of a model.
void training(const std::string& work, const std::string& config, auto& model, auto loss) {
  ml::AdamW<A> adam{{.lr = 1e-4}};
  report(work, config, 0, [&] { adam.step(model, ml::backward(loss())); }, {.seconds = 8, .least = 4});
}
void train_tokenizer() {
  ml::Philox rng{.seed = 1};
  ml::MotionTokenizer<A> model(ml::MotionTokenizerConfig{}, rng);
  const auto x = drawn<A>(32, 64, guo, rng);
  training("train_tokenizer", shape(32, 64), model, [&] {
    const auto result = model(x);
    return ml::mse(result.reconstruction.rows, x.rows) + result.quantized.loss;
  });
}
void train_stgcn() {
  ml::Philox rng{.seed = 1};
  ml::StGcn<A> model(ml::StGcnConfig{}, rng);
  const auto x = drawn<A>(16, 60, 144, rng);
  training("train_stgcn", shape(16, 60), model, [&] { return ml::mean(ml::square(model.train(x).logits)); });
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments asked_for(argc, argv);
  const auto asked = [&](const char* work) { return asked_for.asked(work); };
  if (asked("motiondiffuse")) {
    for (Index n : {1, 8}) times("motiondiffuse", shape(n, longest), MotionDiffuseStep<B>(n));
  }
  if (asked("guo_evaluator")) {
    times("guo_evaluator", "32 motions T=196", GuoMotions<B>());
    times("guo_evaluator", "32 texts T=12", GuoTexts<B>());
  }
  if (asked("tm2t_tokenizer")) {
    for (Index n : {1, 32}) {
      times("tm2t_tokenizer", shape(n, longest) + " to tokens", ToTokens<B>(n));
      times("tm2t_tokenizer", shape(n, longest) + " from tokens", FromTokens<B>(n));
    }
  }
  if (asked("train_tokenizer")) train_tokenizer();
  if (asked("tm2t_write")) {
    for (Index n : {1, 32}) times("tm2t_write", "B=" + std::to_string(n) + " 49 tokens", Writing<B>(n));
  }
  if (asked("stgcn")) {
    for (Index n : {1, 32}) times("stgcn", shape(n, 60), StGcnRun<B>(n));
  }
  if (asked("train_stgcn")) train_stgcn();
}
