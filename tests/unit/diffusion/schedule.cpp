// Schedules and respacing: end values, the published and the corrected noise, what is refused. The laws are in
// tests/laws.
#include <motionlang/diffusion/gaussian.hpp>
#include <motionlang/diffusion/respacing.hpp>
#include <motionlang/diffusion/schedule.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index;
using Steps = std::vector<Index>;

TEST_CASE("the ends of the published schedules") {
  const ml::LinearSchedule linear{.steps = 1000};
  CHECK(linear.beta(0) == doctest::Approx(1e-4));
  CHECK(linear.beta(999) == doctest::Approx(0.02));
  CHECK(ml::LinearSchedule{.steps = 100}.beta(99) ==
        doctest::Approx(0.2));  // any number of steps ends in the same noise
  const ml::ScaledLinearSchedule scaled{};
  CHECK(scaled.beta(0) == doctest::Approx(0.00085));
  CHECK(scaled.beta(999) == doctest::Approx(0.012));
  const ml::CosineSchedule cosine{.steps = 100};
  CHECK(cosine.beta(0) < 1e-3);
  CHECK(cosine.beta(99) == 0.999);
  const ml::GaussianDiffusion stmc(cosine);
  CHECK(stmc.abar(0) > 0.999);
  CHECK(stmc.abar(99) < 1e-6);
  CHECK(stmc.abarp(0) == 1);
  CHECK(stmc.abarn(99) == 0);
}

TEST_CASE("the released noise is the variance, the corrected one the standard deviation") {
  const ml::GaussianDiffusion d(ml::CosineSchedule{.steps = 100});
  for (Index t : {1, 50, 99}) {
    const double variance = d.posterior_variance(t);
    CHECK(d.noise_factor(t, ml::NoiseScale::posterior_variance) == variance);
    CHECK(d.noise_factor(t, ml::NoiseScale::posterior_std) == doctest::Approx(std::sqrt(variance)));
    CHECK(d.noise_factor(t, ml::NoiseScale::posterior_std, ml::Variance::fixed_large) ==
          doctest::Approx(std::sqrt(d.beta(t))));
  }
  CHECK(d.large_variance(0) == d.posterior_variance(1));
  for (ml::NoiseScale scale : {ml::NoiseScale::posterior_variance, ml::NoiseScale::posterior_std})
    CHECK(d.noise_factor(0, scale, ml::Variance::fixed_large) == 0);
}

TEST_CASE("respacing: sections, strides, the published rounding") {
  CHECK(ml::respace(10, "") == Steps{0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  CHECK(ml::respace(10, "5") == Steps{0, 2, 4, 7, 9});  // halves to even
  CHECK(ml::respace(10, "1") == Steps{0});
  CHECK(ml::respace(10, "2,3") == Steps{0, 4, 5, 7, 9});
  CHECK(ml::respace(10, " 2, 3 ") == Steps{0, 4, 5, 7, 9});
  CHECK(ml::respace(11, "2,2") == Steps{0, 5, 6, 10});  // the first section is the longer one
  CHECK(ml::respace(10, "0,3") == Steps{5, 7, 9});      // of a section nothing
  CHECK(ml::respace(10, "ddim5") == Steps{0, 2, 4, 6, 8});
  CHECK(ml::respace(1000, "ddim50").size() == 50);
  for (const char* wrong : {"0", "0,0", "ddim0", "11", "3,", "5,6", "ddim", "ddim7", "ddimx", "1.5", "-2", "five"})
    CHECK_ERROR(ml::respace(10, wrong), "[motionlang.config.105] respacing");
  CHECK_ERROR(ml::respace(10, Steps{}), "[motionlang.config.105]");
}

TEST_CASE("a respaced process tells the network the original steps") {
  const ml::GaussianDiffusion d(ml::CosineSchedule{.steps = 100});
  const auto few = d.respaced(ml::respace(100, "4"));
  CHECK(few.steps() == 4);
  CHECK(few.network_t(3) == 99);
  CHECK(few.respaced(Steps{0, 3}).network_t(1) == 99);
  CHECK_ERROR(d.respaced(Steps{0, 100}), "[motionlang.config.105] respacing: step 100 of 100");
  CHECK_ERROR(d.respaced(Steps{-1}), "[motionlang.config.105]");
  CHECK_ERROR(d.respaced(Steps{5, 5}), "[motionlang.config.104]");  // a step twice would add no noise
}

TEST_CASE("steps that a process lacks, and one that keeps nothing") {
  const ml::GaussianDiffusion twenty(ml::LinearSchedule{.steps = 20});  // the last beta is 1
  CHECK(twenty.abar(19) == 0);
  CHECK_ERROR(twenty.inverse_abar(19), "[motionlang.config.104] GaussianDiffusion: step 19 keeps nothing of x0");
  CHECK(twenty.inverse_abar(18) == 1 / twenty.abar(18));
  for (const Index t : {Index{-1}, Index{20}})
    CHECK_ERROR(twenty.abar(t), "[motionlang.shape.203] GaussianDiffusion: step");
}

TEST_CASE("schedules that cannot be are refused") {
  CHECK_ERROR(ml::GaussianDiffusion(ml::LinearSchedule{.steps = 2}),
              "[motionlang.config.104] diffusion schedule: beta[1] = 10");
  CHECK_ERROR(ml::GaussianDiffusion(ml::BetaList{{0.5, 0}}), "beta[1] = 0 is not in (0, 1]");
  CHECK_ERROR(ml::GaussianDiffusion(ml::BetaList{{std::nan("")}}), "[motionlang.config.104]");
  CHECK_ERROR(ml::GaussianDiffusion(ml::BetaList{}), "[motionlang.config.104] diffusion schedule: no steps");
}
