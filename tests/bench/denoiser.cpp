// The published MDM shape (8 layers, width 512, feed-forward 1024, 4 heads): one denoising step, and one training step.
// Peer: peer_torch.py; run.py compares.   usage: bench_denoiser [threads] [mdm_step train_mdm ...]
#include <cstdlib>
#include <cstring>
#include <set>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/optim/adamw.hpp>

#include "bench.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

constexpr ml::MdmSmplConfig published{.nfeats = 205,
                                      .tx_dim = 512,
                                      .latent_dim = 512,
                                      .ff_size = 1024,
                                      .num_layers = 8,
                                      .num_heads = 4,
                                      .nb_registers = 2};

template <ml::Backend B>
struct Batch {
  ml::Sequences<B> x;
  std::vector<Index> t;
  ml::TextFeatures<B> text;

  Batch(const std::vector<Index>& lengths, ml::Philox rng)
      : x(ml::Tensor<B, 2>::randn({ml::Offsets(lengths).rows(), published.nfeats}, rng), ml::Offsets(lengths)),
        t(lengths.size(), 50),
        text(ml::TextFeatures<B>::pooled(ml::Tensor<B, 2>::randn({std::ssize(lengths), published.tx_dim}, rng))) {}
  double gflop() const {
    double total = 0;
    for (Index i = 0; i < x.count(); ++i) {
      const auto n = static_cast<double>(x.offsets.length(i));
      total += bench::encoder_gflop(n + 4, 512, 1024, 8) + 4 * n * 205 * 512e-9;
    }
    return total;
  }
};

void step(const std::string& work, const std::string& config, const std::vector<Index>& lengths) {
  using B = ml::EigenBackend<float>;
  ml::Philox rng{.seed = 1};
  ml::MdmSmplDenoiser<B> model(published, rng);
  ml::prepare(model);
  const Batch<B> batch(lengths, rng);
  bench::report(work, config, "motionlang", batch.gflop(), [&] { model(batch.x, batch.t, batch.text); });
}

void train() {
  using A = ml::Autodiff<ml::EigenBackend<float>>;
  ml::Philox rng{.seed = 1};
  ml::MdmSmplDenoiser<A> model(published, rng);
  ml::AdamW<A> adam{{.lr = 1e-4}};
  const Batch<A> batch(std::vector<Index>(16, 200), rng);
  std::uint64_t k = 0;
  bench::report(
      "train_mdm", "B=16 T=200 dropout 0.1", "motionlang", 3 * batch.gflop(),
      [&] {
        const ml::Context context{.dropout = rng.split("dropout").split(k++)};
        const auto loss = ml::mse(model(batch.x, batch.t, batch.text, context).rows, batch.x.rows);
        adam.step(model, ml::backward(loss));
      },
      12, 4);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) ml::set_thread_count(std::atoi(argv[1]));
  const std::set<std::string> wanted(argv + std::min(argc, 2), argv + argc);
  auto asked = [&](const char* name) { return wanted.empty() || wanted.contains(name); };
  if (asked("mdm_step")) {
    for (Index b : {1, 3, 8})
      step("mdm_step", "B=" + std::to_string(b) + " (2B crops) T=200",
           std::vector<Index>(static_cast<std::size_t>(2 * b), 200));
  }
  if (asked("mdm_ragged")) {
    std::vector<Index> lengths;
    for (int i = 0; i < 2; ++i) lengths.insert(lengths.end(), {200, 52, 163, 97, 71, 120, 44, 139});
    step("mdm_ragged", "16 crops 40..200 frames (mean 111) padding mask", lengths);
  }
  if (asked("train_mdm")) train();
}
