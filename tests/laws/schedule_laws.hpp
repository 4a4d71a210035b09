// SPDX-License-Identifier: MIT
/// Laws of Schedule, and of the process that is deduced from one (diffusion/gaussian.hpp):
///
///     betas       0 < beta_t <= 1
///     decay       abar_t = (1 - beta_t) abarp_t, hence 0 <= abar_t < abarp_t <= 1
///     mean        c0 + ct sqrt(abar_t) = sqrt(abarp_t): a noiseless x_t leads to the noiseless x_{t-1}
///     variance    ct^2 (1 - abar_t) + posterior variance = 1 - abarp_t: the marginal of x_{t-1} is the forward one
///     end         c0 = 1, ct = 0 and no noise at t = 0
///     respacing   keeping all steps changes nothing; keeping some keeps their abar
#pragma once

#include <doctest/doctest.h>

#include <motionlang/diffusion/gaussian.hpp>

namespace laws {

namespace ml = motionlang;
using ml::Index;

template <ml::Schedule S>
void schedule_laws(const S& schedule) {
  const ml::GaussianDiffusion d(schedule);
  REQUIRE(d.steps() == static_cast<Index>(schedule.steps));
  std::vector<Index> all, some;
  for (Index t = 0; t < d.steps(); ++t) {
    const double beta = schedule.beta(t);
    CHECK((beta > 0 && beta <= 1));
    CHECK(d.abar(t) == doctest::Approx((1 - beta) * d.abarp(t)).epsilon(1e-14));
    CHECK(d.abar(t) < d.abarp(t));
    CHECK(d.abar(t) >= 0);
    CHECK(d.c0(t) + d.ct(t) * std::sqrt(d.abar(t)) == doctest::Approx(std::sqrt(d.abarp(t))).epsilon(1e-9));
    CHECK(d.ct(t) * d.ct(t) * (1 - d.abar(t)) + d.posterior_variance(t) ==
          doctest::Approx(1 - d.abarp(t)).epsilon(1e-9));
    all.push_back(t);
    if (t % 3 == 1) some.push_back(t);
  }
  CHECK(d.c0(0) == doctest::Approx(1).epsilon(1e-9));
  CHECK(d.ct(0) == 0);
  for (ml::NoiseScale scale : {ml::NoiseScale::posterior_std, ml::NoiseScale::posterior_variance})
    CHECK(d.noise_factor(0, scale) == 0);

  const auto same = d.respaced(all), fewer = d.steps() > 3 ? d.respaced(some) : d;
  for (Index t = 0; t < d.steps(); ++t) {
    CHECK(same.beta(t) == doctest::Approx(d.beta(t)).epsilon(1e-9));
    CHECK(same.network_t(t) == t);
  }
  for (Index i = 0; d.steps() > 3 && i < fewer.steps(); ++i) {
    const Index t = some[static_cast<std::size_t>(i)];
    CHECK(fewer.network_t(i) == t);
    CHECK(fewer.abar(i) == doctest::Approx(d.abar(t)).epsilon(1e-9));
  }
}

}  // namespace laws
