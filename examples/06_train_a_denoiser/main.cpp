// Trains a small text-conditioned diffusion model: "left" and "right" are slopes of a line. Then samples both.
#include <cstdio>
#include <vector>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/diffusion/sampler.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/weights/module_file.hpp>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;
using ml::Index;

constexpr Index frames = 12, sequences = 16;
constexpr ml::MdmSmplConfig config{
    .nfeats = 1, .tx_dim = 2, .latent_dim = 32, .ff_size = 64, .num_layers = 2, .num_heads = 2, .dropout = 0};

/// Sequence i goes left if i is even: x[frame] = -frame / frames, else to the right. One feature.
template <ml::Backend T>
ml::Sequences<T> lines() {
  std::vector<float> values;
  for (Index i = 0; i < sequences; ++i) {
    for (Index f = 0; f < frames; ++f)
      values.push_back(static_cast<float>((i % 2 == 0 ? -2.0 : 2.0) * static_cast<double>(f) / frames));
  }
  return {ml::Tensor<T, 2>::from(values, {sequences * frames, 1}), ml::Offsets::equal(sequences, frames)};
}
template <ml::Backend T>
ml::TextFeatures<T> words() {
  std::vector<float> values;
  for (Index i = 0; i < sequences; ++i)
    values.insert(values.end(), {i % 2 == 0 ? 1.0f : 0.0f, i % 2 == 0 ? 0.0f : 1.0f});
  return ml::TextFeatures<T>::pooled(ml::Tensor<T, 2>::from(values, {sequences, 2}));
}

int main() {
  ml::Philox rng{.seed = 3};
  const ml::GaussianDiffusion diffusion(ml::CosineSchedule{.steps = 50});
  ml::MdmSmplDenoiser<A> model(config, rng);
  ml::AdamW<A> adam{{.lr = 3e-3}};
  const auto x0 = lines<A>();
  double first = 0, last = 0;  // mean loss of the first and of the last twenty steps
  for (int step = 0; step < 300; ++step) {
    std::vector<Index> t, t_of_row;  // a step of the process for each sequence
    for (Index i = 0; i < sequences; ++i) {
      t.push_back(static_cast<Index>(rng.below(50)));
      t_of_row.insert(t_of_row.end(), static_cast<std::size_t>(frames), t.back());
    }
    const auto noise = ml::Tensor<A, 2>::randn(x0.rows.shape(), rng);
    const auto noisy = x0.with(ml::q_sample(diffusion, x0.rows, t_of_row, noise));
    const auto loss = ml::mse(model(noisy, t, words<A>()).rows, x0.rows);  // the network predicts x0
    adam.step(model, ml::backward(loss));
    if (step < 20) first += static_cast<double>(loss.item()) / 20;
    if (step >= 280) last += static_cast<double>(loss.item()) / 20;
  }
  std::printf("the loss fell to less than a tenth: %s\n", last < first / 10 ? "yes" : "no");

  ml::save_module("lines.safetensors", model);
  ml::NoInit no_numbers;                               // the values come from the file
  ml::MdmSmplDenoiser<B> trained(config, no_numbers);  // without a tape
  ml::load_module(trained, "lines.safetensors");
  const auto x = ml::Tensor<B, 2>::randn({sequences * frames, 1}, rng);
  const auto sample = ml::sample_ancestral(
      diffusion, x,
      [&](const ml::Tensor<B, 2>& now, Index t) {
        const std::vector<Index> steps(static_cast<std::size_t>(sequences), t);
        return trained(lines<B>().with(now), steps, words<B>()).rows;
      },
      [&](Index) { return ml::Tensor<B, 2>::randn(x.shape(), rng); });
  int right = 0;
  for (Index i = 0; i < sequences; ++i) {
    const float end = sample.span()[static_cast<std::size_t>(i * frames + frames - 1)];
    right += (end < 0) == (i % 2 == 0) ? 1 : 0;
  }
  std::printf("%d of %td samples go where their text says\n", right, sequences);
}
