// The scale of similarities: shares of unlike pairs, and the cosine below which nothing is shown.
#include <doctest/doctest.h>

#include <limits>

#include <motionlang/metrics/similarity_scale.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;

namespace {

/// 10,000 cosines, evenly from 0 to 0.5.
std::vector<float> even_cosines() {
  std::vector<float> out;
  for (int i = 0; i < 10000; ++i) out.push_back(static_cast<float>(i) / 20000);
  return out;
}

}  // namespace

TEST_CASE("a cosine is the share of unlike pairs below it") {
  const auto scale = ml::similarity_scale(even_cosines(), {}, {});
  CHECK_FALSE(scale.empty());
  CHECK(scale.pairs == 10000);
  CHECK(ml::share_below(scale, -0.1) == 0);
  for (const double share : {0.0, 0.1, 0.123, 0.5, 0.99, 0.997, 0.9999})
    CHECK(ml::share_below(scale, share / 2) == Approx(share).epsilon(1e-3));
  CHECK(ml::share_below(scale, 0.9) == 0.9999);
  CHECK_ERROR(ml::share_below(scale, std::numeric_limits<double>::quiet_NaN()), "share_below: the cosine is nan");
  // of ten pairs one may be above, whatever the cosine
  CHECK(ml::share_below(ml::similarity_scale(std::vector<float>(10, 0.5f), {}, {}), 0.9) == 0.9);
  double last = 0;
  for (double cosine = -1; cosine < 1; cosine += 0.01) {
    CHECK(ml::share_below(scale, cosine) >= last);
    last = ml::share_below(scale, cosine);
  }
}

TEST_CASE("the limit is where texts with a motion and texts without one are mixed up least") {
  const std::vector<float> own{0.9f, 0.8f, 0.7f, 0.3f}, strangers{0.1f, 0.2f, 0.4f, 0.75f};
  const auto scale = ml::similarity_scale(even_cosines(), own, strangers);
  CHECK(scale.missed == 0.25);
  CHECK(scale.fooled == 0.25);
  CHECK(scale.least > 0.4);
  CHECK(scale.least <= 0.71);
  CHECK(ml::is_shown(scale, 0.8));
  CHECK_FALSE(ml::is_shown(scale, 0.3));
  CHECK(scale.texts == 4);
  CHECK(scale.strangers == 4);
  const auto apart = ml::similarity_scale(even_cosines(), std::vector<float>{0.6f, 0.9f}, std::vector<float>{0.1f});
  CHECK(apart.missed == 0);
  CHECK(apart.fooled == 0);
  CHECK(apart.least == Approx(0.6));
}

TEST_CASE("a limit that is wrong for half of the texts is none") {
  const std::vector<float> own{0.1f, 0.2f, 0.8f}, strangers{0.3f, 0.7f, 0.9f};
  const auto scale = ml::similarity_scale(even_cosines(), own, strangers);
  CHECK(scale.least == -1);
  CHECK(scale.fooled == 1);
  CHECK(ml::is_shown(scale, -0.9));
}

TEST_CASE("without texts that no motion shows, every text is shown") {
  const auto scale = ml::similarity_scale(even_cosines(), std::vector<float>{0.6f}, {});
  CHECK(scale.least == -1);
  CHECK(ml::is_shown(scale, -0.9));
  CHECK(ml::is_shown({}, -0.9));
}

TEST_CASE("equal cosines, and what is refused") {
  const auto scale = ml::similarity_scale(std::vector<float>(5, 0.25f), {}, {});
  CHECK(ml::share_below(scale, 0.2) == 0);
  CHECK(ml::share_below(scale, 0.3) == 0.8);  // at most all but one of five pairs
  CHECK_ERROR(ml::similarity_scale({}, {}, {}), "[motionlang.config.101] similarity_scale: no unlike pairs");
  CHECK_ERROR(ml::share_below({}, 0), "[motionlang.config.101]");
  const std::vector<float> wrong{0.5f, std::numeric_limits<float>::quiet_NaN()};
  CHECK_ERROR(ml::similarity_scale(wrong, {}, {}), "[motionlang.numeric.301]");
}
