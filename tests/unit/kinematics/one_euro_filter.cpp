// The 1 euro filter: jitter goes, fast movement stays.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include <motionlang/core/rng.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/one_euro_filter.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

/// The mean of |x_{i+1} - 2 x_i + x_{i-1}|.
double roughness(const std::vector<double>& x) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) sum += std::abs(x[i + 1] - 2 * x[i] + x[i - 1]);
  return sum / static_cast<double>(x.size() - 2);
}

}  // namespace

TEST_CASE("1 euro filter: the numbers of its formulas") {
  ml::OneEuroFilter filter(10, {.min_cutoff = 2, .beta = 0.5, .derivative_cutoff = 1});
  CHECK(filter(3) == 3);
  const double tau = 2 * std::numbers::pi, slow = 1 / (1 + 10 / tau);
  double speed = slow * (5.0 - 3.0) * 10;
  double share = 1 / (1 + 10 / (tau * (2 + 0.5 * speed)));
  double y = share * 5 + (1 - share) * 3;
  CHECK(std::abs(filter(5) - y) < 1e-12);
  speed = slow * (4 - y) * 10 + (1 - slow) * speed;
  share = 1 / (1 + 10 / (tau * (2 + 0.5 * std::abs(speed))));
  y = share * 4 + (1 - share) * y;
  CHECK(std::abs(filter(4) - y) < 1e-12);
}

TEST_CASE("1 euro filter: a constant stays, jitter shrinks, a larger beta lags less") {
  ml::OneEuroFilter still(30);
  for (int i = 0; i < 5; ++i) CHECK(still(2.5) == 2.5);
  std::vector<double> noise(300), calm, ramp_slow, ramp_fast;
  ml::Philox rng{.seed = 3};
  rng.normal(std::span(noise));
  ml::OneEuroFilter filter(30), slow(30, {.beta = 0}), fast(30, {.beta = 5});
  for (double& x : noise) calm.push_back(filter(x *= 0.01));
  CHECK(roughness(calm) < 0.3 * roughness(noise));
  for (int i = 0; i < 60; ++i) ramp_slow.push_back(slow(0.1 * i)), ramp_fast.push_back(fast(0.1 * i));  // 3 m/s
  CHECK(5.9 - ramp_fast.back() < 0.3 * (5.9 - ramp_slow.back()));
  CHECK(ramp_fast.back() < 5.9);
}

TEST_CASE("1 euro filter: a motion keeps its length and movement, and trembling rotations become calm") {
  const ml::Motion walk = synthetic::walk({.frames = 60, .fps = 30});
  const ml::Motion same = ml::one_euro_filter(walk, {.min_cutoff = 1e9});
  REQUIRE(same.frames() == walk.frames());
  for (std::size_t i = 0; i < walk.local.size(); ++i) CHECK(ml::distance(same.local[i], walk.local[i]) < 1e-6);
  for (std::size_t i = 0; i < walk.root.size(); ++i) CHECK(ml::norm(same.root[i] - walk.root[i]) < 1e-6);

  ml::Motion trembling = walk;
  for (ml::Index f = 0; f < walk.frames(); ++f) {
    const double angle = f % 2 == 0 ? 0.03 : -0.03;
    trembling.rotations(f)[3] = ml::to_quaternion(ml::AxisAngle<double>{{angle, 0, 0}});
    trembling.root[static_cast<std::size_t>(f)] = {0, f % 2 == 0 ? 0.01 : -0.01, 0};
  }
  const ml::Motion calm = ml::one_euro_filter(trembling);
  const auto turn = [](const ml::Motion& m, ml::Index f) {
    return ml::distance(m.rotations(f)[3], m.rotations(f - 1)[3]);
  };
  CHECK(turn(trembling, 40) > 0.05);
  CHECK(turn(calm, 40) < 0.5 * turn(trembling, 40));
  CHECK(std::abs(calm.root[40].y - calm.root[39].y) < 0.5 * 0.02);
  CHECK(calm.root[0] == trembling.root[0]);
  CHECK_ERROR(ml::one_euro_filter(walk, {.min_cutoff = 0}), "[motionlang.config.101] OneEuroFilter: 30 frames");
  CHECK_ERROR(ml::OneEuroFilter(30, {.beta = -1}), "beta -1");
}
