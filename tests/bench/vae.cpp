// The variational autoencoders (width 256, feed-forward 1024, 4 heads): TMR's motion encoder, the decoders of TEMOS and
// ACTOR, and a training step of TMR with the memory that it takes.
//
// usage: bench_vae [THREADS] [--bf16] [tmr_encoder temos_decoder actor_decoder train_tmr train_tmr_memory ...]
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/optim/adamw.hpp>

#include "models.hpp"

namespace {

using namespace bench;
using B = ml::EigenBackend<float>;

/// Alone and 32 together.
template <class Model>
void one_and_many(const std::string& work, Index frames) {
  for (Index n : {1, 32}) {
    const Model run(n);
    report(work, shape(n, frames), run.gflop(), run);
  }
}

struct Training {
  using A = ml::Autodiff<B>;
  static constexpr Index batch = 32, frames = 200, words = 32;
  ml::Philox rng{.seed = 1};
  ml::Tmr<A> model{ml::TmrConfig{}, rng};
  ml::AdamW<A> adam{{.lr = 1e-4}};
  ml::Sequences<A> motion{ml::Tensor<A, 2>::randn({batch * frames, guo}, rng), ml::Offsets::equal(batch, frames)};
  ml::Sequences<A> text{ml::Tensor<A, 2>::randn({batch * words, 768}, rng), ml::Offsets::equal(batch, words)};
  std::uint64_t k = 0;

  void operator()() {
    const auto noise = rng.split("step").split(k++);
    const ml::Context context{.dropout = noise.split("dropout")};
    const auto branches = model.branches(text, motion, ml::TextMotionNoise<A>::draw(batch, width, noise), context);
    adam.step(model, ml::backward(ml::tmr_losses(branches, motion).total()));
  }
  static double gflop() {
    return 3 * batch *
           (encoder_gflop_of(frames, guo) + encoder_gflop_of(words, 768) + 2 * decoder_gflop_of(frames, guo, 6));
  }
};

}  // namespace

int main(int argc, char** argv) {
  const Arguments asked_for(argc, argv);
  const auto asked = [&](const char* work) { return asked_for.asked(work); };
  const std::string training_config = shape(Training::batch, Training::frames) + " dropout 0.1";
  if (asked("train_tmr_memory")) {  // first: before others have made the program larger
    Training run;
    for (int i = 0; i < 3; ++i) run();
    report_value("train_tmr_memory", training_config, peak_memory());
  }
  if (asked("tmr_encoder")) one_and_many<TmrEncoding<B>>("tmr_encoder", 200);
  if (asked("temos_decoder")) one_and_many<TemosDecoding<B>>("temos_decoder", 200);
  if (asked("actor_decoder")) one_and_many<ActorDecoding<B>>("actor_decoder", 60);
  if (asked("train_tmr")) {
    Training run;
    report("train_tmr", training_config, Training::gflop(), [&] { run(); }, {.seconds = 12, .least = 4});
  }
}
