// The weight of a sample in the training of the bundled model.
#include <doctest/doctest.h>

#include <motionlang/diffusion/gaussian.hpp>
#include <motionlang/diffusion/schedule.hpp>
#include <motionlang/train/stmc_training.hpp>

namespace {

namespace ml = motionlang;

TEST_CASE("a sample weighs as much as its ratio of signal to noise, between 1 and the cap") {
  CHECK(ml::detail::snr_weight(0.5, 10) == 1);  // as much signal as noise
  CHECK(ml::detail::snr_weight(0.75, 10) == doctest::Approx(3));
  CHECK(ml::detail::snr_weight(0.001, 10) == 1);
  CHECK(ml::detail::snr_weight(0.99, 10) == 10);  // 99
  CHECK(ml::detail::snr_weight(1, 10) == 10);     // without noise
  CHECK(ml::detail::snr_weight(0.99, 1) == 1);    // a cap of 1: all weigh the same
}

TEST_CASE("about half of a hundred cosine steps weigh more than 1") {
  const ml::GaussianDiffusion diffusion(ml::CosineSchedule{.steps = 100});
  ml::Index heavier = 0;
  double before = 10;
  for (ml::Index t = 0; t < diffusion.steps(); ++t) {
    const double weight = ml::detail::snr_weight(diffusion.abar(t), 10);
    CHECK(weight <= before);
    before = weight;
    heavier += weight > 1 ? 1 : 0;
  }
  CHECK(heavier == 49);
}

}  // namespace
