// The number of threads changes no bit: a denoiser, an autoencoder and a training step of each, large enough that
// several threads get work, on one thread, two, three and sixteen.
#include <doctest/doctest.h>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/systems/tmr.hpp>

#include "../support/threads.hpp"

namespace {

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;

/// f() is a list of numbers; the same ones for each number of threads.
template <class F>
void same_on_all(F f) {
  std::vector<std::vector<float>> results;
  for (int threads : {1, 2, 3, 16}) {
    const Threads scope(threads);
    results.push_back(f());
  }
  REQUIRE(!results[0].empty());
  CHECK(results[1] == results[0]);
  CHECK(results[2] == results[0]);
  CHECK(results[3] == results[0]);
}

template <ml::Backend C, int R>
void append(std::vector<float>& to, const ml::Tensor<C, R>& x) {
  const auto numbers = x.span();
  to.insert(to.end(), numbers.begin(), numbers.end());
}
template <class M>
std::vector<float> parameters(const M& model) {
  std::vector<float> out;
  ml::visit_tensors(model, [&](const std::string&, const auto& p) { append(out, p); });
  return out;
}

const std::vector<Index> lengths{60, 7, 33, 60, 21};
constexpr ml::MdmSmplConfig denoiser{
    .nfeats = 37, .tx_dim = 24, .latent_dim = 96, .ff_size = 160, .num_layers = 2, .num_heads = 4};
constexpr ml::TmrConfig tmr{
    .motion_nfeats = 37, .text_nfeats = 24, .latent_dim = 64, .ff_size = 96, .num_layers = 2, .num_heads = 4};

template <ml::Backend C>
ml::Sequences<C> frames(ml::Philox rng) {
  return {ml::Tensor<C, 2>::randn({ml::Offsets(lengths).rows(), 37}, rng), ml::Offsets(lengths)};
}

}  // namespace

TEST_CASE("a denoising step") {
  same_on_all([] {
    ml::Philox rng{.seed = 1};
    ml::MdmSmplDenoiser<B> model(denoiser, rng);
    ml::prepare(model);
    const auto text = ml::TextFeatures<B>::pooled(ml::Tensor<B, 2>::randn({std::ssize(lengths), 24}, rng));
    std::vector<float> out;
    append(out, model(frames<B>(rng), std::vector<Index>(lengths.size(), 20), text).rows);
    return out;
  });
}

TEST_CASE("two training steps of a denoiser, with dropout") {
  same_on_all([] {
    ml::Philox rng{.seed = 1};
    ml::MdmSmplDenoiser<A> model(denoiser, rng);
    ml::AdamW<A> adam{{.lr = 1e-3}};
    const auto x = frames<A>(rng);
    const auto text = ml::TextFeatures<A>::pooled(ml::Tensor<A, 2>::randn({std::ssize(lengths), 24}, rng));
    for (std::uint64_t k = 0; k < 2; ++k) {
      const ml::Context context{.dropout = rng.split("dropout").split(k)};
      adam.step(model,
                ml::backward(ml::mse(model(x, std::vector<Index>(lengths.size(), 20), text, context).rows, x.rows)));
    }
    return parameters(model);
  });
}

TEST_CASE("two training steps of TMR: encoders, decoder, contrastive loss") {
  same_on_all([] {
    ml::Philox rng{.seed = 1};
    ml::Tmr<A> model(tmr, rng);
    ml::AdamW<A> adam{{.lr = 1e-3}};
    const auto motion = frames<A>(rng);
    const ml::Sequences<A> text(ml::Tensor<A, 2>::randn({5 * 9, 24}, rng), ml::Offsets::equal(5, 9));
    for (std::uint64_t k = 0; k < 2; ++k) {
      const auto noise = rng.split("step").split(k);
      const ml::Context context{.dropout = noise.split("dropout")};
      const auto branches = model.branches(text, motion, ml::TextMotionNoise<A>::draw(5, 64, noise), context);
      adam.step(model, ml::backward(ml::tmr_losses(branches, motion).total()));
    }
    return parameters(model);
  });
}
