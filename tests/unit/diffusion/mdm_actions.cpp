// MDM for actions: the classes reach the network, guidance is applied, a motion does not depend on the others.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/diffusion/mdm_actions.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<double>;

namespace {

ml::MdmActions<B> small(Index steps, double guidance = 1, ml::MdmArch arch = ml::MdmArch::trans_enc) {
  ml::Philox rng{.seed = 4};
  return {.denoiser = ml::MdmDenoiser<B>({.nfeats = 6,
                                          .arch = arch,
                                          .condition = ml::MdmCondition::action,
                                          .num_actions = 3,
                                          .latent_dim = 8,
                                          .ff_size = 12,
                                          .num_layers = 2,
                                          .num_heads = 2,
                                          .crop_frames = 5},
                                         rng),
          .diffusion = ml::GaussianDiffusion(ml::CosineSchedule{.steps = steps}),
          .guidance = guidance};
}

}  // namespace

TEST_CASE(
    "one step is what the network makes of the noise: without action, with it, and guided from one to the other") {
  const auto mdm = small(1);
  const ml::Philox rng{.seed = 9};
  auto stream = rng.split("noise").split(std::uint64_t{0}).split(std::uint64_t{0});
  const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({5, 6}, stream), ml::Offsets{5});
  const auto said = [&](std::vector<double> action) {
    return mdm.denoiser(x, std::vector<Index>{0}, ml::TextFeatures<B>::pooled(ml::Tensor<B, 2>::from(action, {1, 3})))
        .rows;
  };
  const auto null = said({0, 0, 0}), jump = said({0, 0, 1});
  CHECK(tensors::distance(null, jump) > 1e-3);
  const std::vector<Index> action{2};
  CHECK(tensors::distance(mdm.generate(action, rng).rows, jump) < 1e-12);
  CHECK(tensors::distance(mdm.generate(action, rng, {.guidance = 2.5}).rows, null + (jump - null) * 2.5) < 1e-12);
  CHECK(tensors::distance(small(1, 0).generate(action, rng).rows, null) < 1e-12);
}

TEST_CASE(
    "the published GRU, which runs over its batch, is asked for the motions with actions and without in two calls") {
  const auto mdm = small(1, 1, ml::MdmArch::gru);
  REQUIRE(mdm.denoiser.config.gru_over_batch);
  const std::vector<Index> actions{2, 0};
  const ml::Philox rng{.seed = 9};
  const auto with = [&](double guidance) { return mdm.generate(actions, rng, {.guidance = guidance}).rows; };
  CHECK(tensors::distance(with(2.5), with(0) + (with(1) - with(0)) * 2.5) < 1e-12);
  CHECK(tensors::distance(with(0), with(1)) > 1e-3);
  const std::vector<Index> first{2};
  CHECK(tensors::distance(ml::slice(with(0), 0, 0, 5), mdm.generate(first, rng, {.guidance = 0}).rows) < 1e-12);
}

TEST_CASE("an unconstrained model makes motions of nothing, and is not guided") {
  auto mdm = small(1, 2.5);
  mdm.denoiser.config.condition = ml::MdmCondition::none;
  mdm.denoiser.config.num_actions = 1;
  mdm.denoiser.action_embedding.reset();
  const ml::Philox rng{.seed = 9};
  auto stream = rng.split("noise").split(std::uint64_t{0}).split(std::uint64_t{0});
  const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({5, 6}, stream), ml::Offsets{5});
  const auto said = mdm.denoiser(x, std::vector<Index>{0}, ml::TextFeatures<B>{}).rows;
  const std::vector<Index> any{0}, other{1};
  CHECK(tensors::distance(mdm.generate(any, rng).rows, said) < 1e-12);
  CHECK(tensors::distance(mdm.generate(any, rng, {.guidance = 7}).rows, said) < 1e-12);
  CHECK_ERROR(mdm.generate(other, rng), "[motionlang.shape.203]");
}

TEST_CASE("a motion is the same alone and before others; fewer steps, other samplers") {
  const auto mdm = small(12, 2.5);
  const ml::Philox rng{.seed = 9};
  const std::vector<Index> one{1}, two{1, 0};
  const auto alone = mdm.generate(one, rng), both = mdm.generate(two, rng);
  CHECK(both.offsets == ml::Offsets{5, 5});
  CHECK(tensors::distance(both[0], alone.rows) < 1e-12);
  CHECK(tensors::distance(both[0], both[1]) > 1e-3);
  CHECK(tensors::distance(mdm.generate(one, rng, {.steps = 4}).rows, alone.rows) > 1e-6);
  const auto ddim = ml::SamplingOptions::Sampler::ddim;
  CHECK(tensors::distance(mdm.generate(one, rng, {.sampler = ddim}).rows, alone.rows) > 1e-6);
  Index steps = 0;
  const auto count = [&](Index done, Index) { return steps = done, true; };
  mdm.generate(one, rng, {.steps = 4, .progress = count});
  CHECK(steps == 4);
  const std::vector<Index> none{3};
  CHECK_ERROR(mdm.generate(none, rng), "[motionlang.shape.203] MdmActions: action 3 of 3");
  auto texts = small(2);
  texts.denoiser.config.condition = ml::MdmCondition::text;
  CHECK_ERROR(texts.generate(one, rng), "[motionlang.config.102]");
}
