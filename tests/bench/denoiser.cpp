// The MDM shape (8 layers, width 512, feed-forward 1024, 4 heads): one denoising step on crops of equal and of
// different lengths, and one training step with the memory that it takes.
//
// usage: bench_denoiser [THREADS] [--bf16 | --bf16x3] [mdm_step mdm_ragged train_mdm train_mdm_memory ...]
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/optim/adamw.hpp>

#include "models.hpp"

namespace {

using namespace bench;

void step(const std::string& work, const std::string& config, const std::vector<Index>& lengths) {
  const MdmStep<ml::EigenBackend<float>> run(lengths);
  report(work, config, run.gflop(), run);
}

struct Training {
  using A = ml::Autodiff<ml::EigenBackend<float>>;
  ml::Philox rng{.seed = 1};
  ml::MdmSmplDenoiser<A> model{mdm, rng};
  ml::AdamW<A> adam{{.lr = 1e-4}};
  MdmBatch<A> batch{equal(16, 200), rng};
  std::uint64_t k = 0;

  void operator()() {
    const ml::Context context{.dropout = rng.split("dropout").split(k++)};
    const auto loss = ml::mse(model(batch.x, batch.t, batch.text, context).rows, batch.x.rows);
    adam.step(model, ml::backward(loss));
  }
};

}  // namespace

int main(int argc, char** argv) {
  const Arguments asked_for(argc, argv);
  const auto asked = [&](const char* work) { return asked_for.asked(work); };
  const std::string training_config = "B=16 T=200 dropout 0.1";
  if (asked("train_mdm_memory")) {  // first: before others have made the program larger
    Training run;
    for (int i = 0; i < 3; ++i) run();
    report_value("train_mdm_memory", training_config, peak_memory());
  }
  if (asked("mdm_step")) {
    for (Index b : {1, 3, 8}) step("mdm_step", "B=" + std::to_string(b) + " (2B crops) T=200", equal(b, 200));
  }
  if (asked("mdm_ragged")) {
    step("mdm_ragged", "16 crops 40..200 frames (mean 111)", {200, 52, 163, 97, 71, 120, 44, 139});
  }
  if (asked("train_mdm")) {
    Training run;
    report("train_mdm", training_config, 3 * run.batch.gflop(), [&] { run(); }, {.seconds = 12, .least = 4});
  }
}
