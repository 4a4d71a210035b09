// AMASS poses at another rate and mirrored, as the published training data were made.
#include <doctest/doctest.h>

#include <motionlang/datasets/amass_resample.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;
using lists::view;

TEST_CASE("amass_resample: number of frames and where they lie") {
  // Frame i of the result stands at 3 i + 1 of the source: every third one, from the second.
  std::vector<double> trans, poses;
  for (int f = 0; f < 10; ++f) {
    trans.insert(trans.end(), {1.0 * f, 2.0 * f, 0});
    poses.insert(poses.end(), {0.1 * f, 0, 0});
  }
  const auto third = ml::amass_resample(view(poses), view(trans), 60, 20);
  REQUIRE(third.trans.size() == 9);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(third.trans[3 * i] == Approx(3.0 * static_cast<double>(i) + 1));
    CHECK(third.poses[3 * i] == Approx(0.1 * (3.0 * static_cast<double>(i) + 1)));
  }
  // 60 to 120: at -1/4 (not before the first frame), 1/4, 3/4, ...
  const auto twice = ml::amass_resample(view(poses), view(trans), 60, 120);
  REQUIRE(twice.trans.size() == 60);
  CHECK(twice.trans[0] == 0);
  CHECK(twice.trans[3] == Approx(0.25));
  CHECK(twice.trans[57] == Approx(9));
  CHECK(ml::amass_resample<double>({}, {}, 60, 20).poses.empty());
}

TEST_CASE("amass_resample: vectors turn, their lengths are weights") {
  // Between (1, 0, 0) and (0, 2, 0), at right angles, half of the way: sin 45 of each.
  const std::vector<double> poses{1, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 3}, trans(6);
  const auto out = ml::amass_resample(view(poses), view(trans), 40, 20);
  REQUIRE(out.poses.size() == 6);
  CHECK(out.poses[0] == Approx(std::sqrt(0.5)));
  CHECK(out.poses[1] == Approx(2 * std::sqrt(0.5)));
  CHECK(out.poses[5] == Approx(1.5));  // a zero vector: linear
  const std::vector<double> opposite{1, 0, 0, -1, 0, 0}, still(6);
  for (const double v : ml::amass_resample(view(opposite), view(still), 40, 20).poses) CHECK(v == 0);
}

TEST_CASE("amass_mirror: left and right change places, twice is nothing") {
  std::vector<float> poses, trans{1, 2, 3};
  for (int i = 0; i < 66; ++i) poses.push_back(static_cast<float>(i) - 20);
  const auto image = ml::amass_mirror(view(poses), view(trans));
  CHECK(image.trans == std::vector<float>{-1, 2, 3});
  CHECK(image.poses[3] == poses[6]);  // left hip from right hip
  CHECK(image.poses[4] == -poses[7]);
  CHECK(image.poses[5] == -poses[8]);
  CHECK(image.poses[0] == poses[0]);
  const auto back = ml::amass_mirror(view(image.poses), view(image.trans));
  CHECK(back.poses == poses);
  CHECK(back.trans == trans);
}

TEST_CASE("invalid AMASS rates are refused") {
  const std::vector<double> poses(6), trans(6);
  for (const double fps : {0.0, -20.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e-310})
    CHECK_ERROR(ml::amass_resample<double>(poses, trans, fps, 20), "[motionlang.config.101] amass_resample");
}

TEST_CASE("AMASS arrays that do not fit are refused") {
  const std::vector<double> poses(65), trans(3), frames(6), wide(156);
  CHECK_THROWS_WITH_AS(ml::amass_mirror(view(poses), view(trans)), Contains("[motionlang.shape.205]"), ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::amass_mirror(view(wide), view(trans)), Contains("expected 66 or 72"), ml::shape_error);
  CHECK_THROWS_AS(ml::amass_resample(view(poses), view(frames), 60, 20), ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::amass_resample(view(wide), view(trans), 0, 20), Contains("[motionlang.config.101]"),
                       ml::config_error);
}
