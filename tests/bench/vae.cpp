// The variational autoencoders at their published sizes (width 256, feed-forward 1024, 4 heads), with random weights: TMR's motion encoder,
// the decoders of TEMOS and ACTOR, and a training step of TMR. Peer: peer_torch.py; run.py compares.
//
// usage: bench_vae [THREADS] [tmr_encoder temos_decoder actor_decoder train_tmr ...]
#include <cstdlib>
#include <set>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/systems/tmr.hpp>
#include <motionlang/vae/actor_decoder.hpp>

#include "bench.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;

namespace {

constexpr Index width = 256, feed_forward = 1024, guo = 263;  // 263: HumanML3D's features

/// What is computed with padding and without any of the exact savings: so that figures of all programs compare.
double gflop_of_encoder(double frames, double features) {
  return bench::encoder_gflop(frames + 2, width, feed_forward, 6) + 2e-9 * frames * features * width;
}
double gflop_of_decoder(double frames, double features, double layers) {
  return bench::encoder_gflop(frames, width, feed_forward, layers) + 4e-9 * layers * frames * width * width +
         2e-9 * frames * features * width;
}
std::string shape(Index motions, Index frames) {
  return "B=" + std::to_string(motions) + " T=" + std::to_string(frames);
}

void tmr_encoder() {
  ml::Philox rng{.seed = 1};
  ml::TmrEncoder<B> model(guo, true, ml::transformer_of(ml::TmrConfig{}), 5000, rng);
  ml::prepare(model);
  for (Index n : {1, 32}) {
    const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({n * 200, guo}, rng), ml::Offsets::equal(n, 200));
    bench::report("tmr_encoder", shape(n, 200), "motionlang", static_cast<double>(n) * gflop_of_encoder(200, guo),
                  [&] { model(x); });
  }
}

void temos_decoder() {
  ml::Philox rng{.seed = 1};
  ml::SequenceDecoder<B> model(guo, ml::transformer_of(ml::TmrConfig{}), 5000, rng);
  ml::prepare(model);
  for (Index n : {1, 32}) {
    const auto z = ml::Tensor<B, 2>::randn({n, width}, rng);
    bench::report("temos_decoder", shape(n, 200), "motionlang", static_cast<double>(n) * gflop_of_decoder(200, guo, 6),
                  [&] { model(z, ml::Offsets::equal(n, 200)); });
  }
}

void actor_decoder() {
  ml::Philox rng{.seed = 1};
  const ml::TransformerConfig eight{.d_model = width, .heads = 4, .d_ff = feed_forward, .layers = 8};
  ml::ActorDecoder<B> model(150, 12, eight, 5000, ml::ActorConditioning::action_bias, rng);
  ml::prepare(model);
  for (Index n : {1, 32}) {
    const auto z = ml::Tensor<B, 2>::randn({n, width}, rng);
    const std::vector<Index> labels(static_cast<std::size_t>(n), 3);
    bench::report("actor_decoder", shape(n, 60), "motionlang", static_cast<double>(n) * gflop_of_decoder(60, 150, 8),
                  [&] { model(z, labels, ml::Offsets::equal(n, 60)); });
  }
}

void train_tmr() {
  constexpr Index batch = 32, frames = 200, words = 32;
  ml::Philox rng{.seed = 1};
  ml::Tmr<A> model(ml::TmrConfig{}, rng);
  ml::AdamW<A> adam{{.lr = 1e-4}};
  const ml::Sequences<A> motion(ml::Tensor<A, 2>::randn({batch * frames, guo}, rng), ml::Offsets::equal(batch, frames));
  const ml::Sequences<A> text(ml::Tensor<A, 2>::randn({batch * words, 768}, rng), ml::Offsets::equal(batch, words));
  const double forward =
      batch * (gflop_of_encoder(frames, guo) + gflop_of_encoder(words, 768) + 2 * gflop_of_decoder(frames, guo, 6));
  std::uint64_t k = 0;
  bench::report(
      "train_tmr", shape(batch, frames) + " dropout 0.1", "motionlang", 3 * forward,
      [&] {
        const auto noise = rng.split("step").split(k++);
        const ml::Context context{.dropout = noise.split("dropout")};
        const auto branches = model.branches(text, motion, ml::TextMotionNoise<A>::draw(batch, width, noise), context);
        adam.step(model, ml::backward(ml::tmr_losses(branches, motion).total()));
      },
      12, 4);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) ml::set_thread_count(std::atoi(argv[1]));
  const std::set<std::string> wanted(argv + std::min(argc, 2), argv + argc);
  auto asked = [&](const char* name) { return wanted.empty() || wanted.contains(name); };
  if (asked("tmr_encoder")) tmr_encoder();
  if (asked("temos_decoder")) temos_decoder();
  if (asked("actor_decoder")) actor_decoder();
  if (asked("train_tmr")) train_tmr();
}
