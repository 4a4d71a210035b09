// Bodies that the floor carries: hovering, sinking in, flights, and motions that are right.
#include <motionlang/kinematics/floor_fix.hpp>

#include <algorithm>

#include <doctest/doctest.h>

#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/metrics/motion_quality.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

/// The clip with so much added to the height of its root in the frames from `first` on, before `last`.
ml::Motion moved_up(ml::Motion m, double by, ml::Index first = 0, ml::Index last = 1 << 20) {
  for (ml::Index f = first; f < std::min(last, m.frames()); ++f) m.root[static_cast<std::size_t>(f)].y += by;
  return m;
}
double highest(const ml::Motion& m) {
  const auto h = ml::heights_over_floor(m);
  return *std::max_element(h.begin(), h.end());
}
double lowest(const ml::Motion& m) {
  const auto h = ml::heights_over_floor(m);
  return *std::min_element(h.begin(), h.end());
}
double jitter(const ml::Motion& m) { return ml::motion_quality(m).jitter; }
double seconds_above(const ml::Motion& m, double height) {
  const auto h = ml::heights_over_floor(m);
  return static_cast<double>(std::count_if(h.begin(), h.end(), [&](double y) { return y > height; })) / m.fps;
}

}  // namespace

TEST_CASE("motions that are right stay as they are: a walk, and a jump of a thrown body") {
  for (const double turn : {0.0, 0.8}) {
    const auto walk = synthetic::walk({.frames = 80, .turn = turn});
    CHECK(synthetic::largest_distance(ml::fix_floor(walk), walk) < 1e-9);
  }
  const auto jump = ml::resample(synthetic::jump(), 20);
  CHECK(highest(jump) > 0.25);
  CHECK(synthetic::largest_distance(ml::fix_floor(jump), jump) < 0.02);
}

TEST_CASE("who hovers comes down, smoothly") {
  const auto walk = synthetic::walk({.frames = 80});
  const auto fixed = ml::fix_floor(moved_up(walk, 0.15));
  CHECK(highest(fixed) < 0.04);
  CHECK(jitter(fixed) < jitter(walk) + 1);
  // only a part of the time
  const auto part = ml::fix_floor(moved_up(walk, 0.1, 20, 60));
  CHECK(seconds_above(part, 0.06) < 0.15);
  // what is nearly on the floor stays
  CHECK(synthetic::largest_distance(ml::fix_floor(moved_up(walk, 0.012)), moved_up(walk, 0.012)) < 1e-9);
}

TEST_CASE("a flight becomes the arc of a thrown body with its height") {
  const auto stand = synthetic::walk({.frames = 1});
  ml::Motion m = stand;
  for (int f = 1; f < 60; ++f) {
    m.root.push_back(stand.root[0]);
    m.local.insert(m.local.end(), stand.local.begin(), stand.local.end());
    if (f >= 20 && f < 38) m.root.back().y += 0.2 * std::min({1.0, (f - 19) / 4.0, (38 - f) / 4.0});  // 0.9 s
  }
  const auto fixed = ml::stand_on_floor(m);
  CHECK(seconds_above(m, 0.05) > 0.75);
  CHECK(seconds_above(fixed, 0.05) > 0.25);
  CHECK(seconds_above(fixed, 0.05) < 0.5);  // 2 sqrt(2 H / g) = 0.40 s
  CHECK(highest(fixed) > 0.12);
  for (ml::Index f = 0; f < 12; ++f) CHECK(fixed.root_at(f).y == doctest::Approx(m.root_at(f).y));
}

TEST_CASE("who is sunk in is raised, and single feet are lifted") {
  const auto walk = synthetic::walk({.frames = 80});
  CHECK(lowest(moved_up(walk, -0.12)) < -0.1);
  const auto fixed = ml::fix_floor(moved_up(walk, -0.12));
  CHECK(lowest(fixed) > -0.03);
  CHECK(jitter(fixed) < jitter(walk) + 5);
  CHECK(lowest(ml::lift_sunken_feet(moved_up(walk, -0.05))) > lowest(moved_up(walk, -0.05)) + 0.02);
}

TEST_CASE("recordings come to the floor as a whole, and stay in shape") {
  const auto walk = synthetic::walk({.frames = 80});
  for (const double off : {0.035, -0.03, 0.4}) {
    const auto grounded = ml::ground_recording(moved_up(walk, off));
    CHECK(synthetic::largest_distance(grounded, ml::ground_recording(walk)) < 1e-9);
    auto heights = ml::heights_over_floor(grounded);
    std::sort(heights.begin(), heights.end());
    CHECK(std::abs(heights[8]) < 1e-9);
  }
}

TEST_CASE("who sits on the floor sits on it, though longer legs keep the hips up") {
  auto sit = synthetic::walk({.frames = 60});  // on the edge of a box of 30 cm
  for (ml::Index f = 0; f < sit.frames(); ++f) {
    const auto pose = sit.rotations(f);
    for (auto& q : pose) q = ml::Quaternion<double>::identity();
    pose[1] = pose[2] = synthetic::about_x(-1.57);
    pose[4] = pose[5] = synthetic::about_x(1.57);
    sit.root[static_cast<std::size_t>(f)] = {0, 0.45, 0};
  }
  CHECK(std::abs(highest(ml::ground_recording(sit))) < 0.05);
  CHECK(ml::ground_recording(sit).root_at(30).y > 0.35);  // the feet carry it
  const auto seated = ml::ground_recording(sit, true);
  CHECK(seated.root_at(30).y < 0.15);
  CHECK(lowest(seated) > -0.05);
  const auto joints = seated.positions();
  CHECK(joints[30 * 24 + 4].y > 0.3);  // knees are up
  // who stands is not pulled down
  const auto walk = synthetic::walk({.frames = 80});
  CHECK(synthetic::largest_distance(ml::ground_recording(walk, true), ml::ground_recording(walk)) < 0.02);
}

TEST_CASE("a body without frames, skeletons without legs, options that are not times") {
  const auto walk = synthetic::walk({.frames = 10});
  CHECK(ml::fix_floor(ml::crop(walk, 0, 0)).frames() == 0);
  CHECK(ml::ground_recording(ml::crop(walk, 0, 0)).frames() == 0);
  const std::array<ml::Leg, 1> none{{{{1, 4, 7}, 99}}};
  CHECK_ERROR(ml::stand_on_floor(walk, none), "[motionlang.config.103] heights_over_floor: toe 99");
  CHECK_ERROR(ml::lift_sunken_feet(walk, none), "[motionlang.config.103] lift_sunken_feet: toe 99");
  CHECK_ERROR(ml::stand_on_floor(walk, ml::smpl_legs, {.longest_flight = 0}),
              "[motionlang.config.101] stand_on_floor: flights of 0 s");
}
