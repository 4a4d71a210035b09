// Hyperparameters of trainings: rates of steps, and what cannot be.
#include <doctest/doctest.h>

#include <motionlang/optim/optimiser_config.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("the rate warms up, stays, follows a cosine or falls by tenths") {
  ml::OptimiserConfig c{.lr = 1, .warmup = 4};
  CHECK(c.rate(0, 100) == 0.25);
  CHECK(c.rate(3, 100) == 1);
  CHECK(c.rate(99, 100) == 1);
  c.schedule = "cosine";
  CHECK(c.rate(4, 100) == doctest::Approx(1));
  CHECK(c.rate(100, 100) == doctest::Approx(0.02));
  CHECK(c.rate(30, 100) > c.rate(60, 100));
  c.schedule = "step";
  c.epochs = 500;  // a tenth after 200 and after 400 of them
  CHECK(c.rate(39, 100) == 1);
  CHECK(c.rate(40, 100) == doctest::Approx(0.1));
  CHECK(c.rate(80, 100) == doctest::Approx(0.01));
  c.schedule = "linear";
  CHECK_ERROR(c.rate(0, 100), "[motionlang.config.103] optimiser.schedule 'linear'");
  CHECK(c.adamw().lr == 1);
  CHECK(c.adamw().weight_decay == c.weight_decay);
}

TEST_CASE("values that cannot be are refused by name") {
  ml::OptimiserConfig{}.require_sound();
  CHECK_ERROR((ml::OptimiserConfig{.lr = -1}.require_sound()), "[motionlang.config.101] lr is -1, expected 0 or more");
  CHECK_ERROR((ml::OptimiserConfig{.beta1 = 1}.require_sound()), "beta1 is 1");
  CHECK_ERROR((ml::OptimiserConfig{.eps = 0}.require_sound()), "eps is 0, expected a number above 0");
  CHECK_ERROR((ml::OptimiserConfig{.warmup = -1}.require_sound()), "warmup is -1");
  CHECK_ERROR((ml::OptimiserConfig{.batch = 0}.require_sound()), "batch is 0, expected 1 or more");
}
