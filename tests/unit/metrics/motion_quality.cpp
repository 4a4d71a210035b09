// Skating, jitter, penetration, bones: each on tracks whose answer is known.
#include <doctest/doctest.h>

#include <motionlang/metrics/motion_quality.hpp>

#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;

namespace {

/// One joint whose position in frame f is `at(f)`.
template <class F>
std::vector<ml::Vec3<double>> track(int frames, F at) {
  std::vector<ml::Vec3<double>> out;
  for (int f = 0; f < frames; ++f) out.push_back(at(static_cast<double>(f)));
  return out;
}
const std::vector<ml::ContactJoint> foot{{0, 0.05}};

}  // namespace

TEST_CASE("foot_skate: speed on the floor, not above it, and only horizontally") {
  const auto slides = track(11, [](double f) { return ml::Vec3{0.03 * f, 0.01, 0.04 * f}; });
  const auto s = ml::foot_skate({slides, 1, 20}, foot);
  CHECK(s.speed == Approx(1.0));  // 5 cm a frame at 20 fps
  CHECK(s.ratio == 1);
  CHECK(s.contact == 1);
  CHECK(ml::foot_skate({slides, 1, 20}, foot, 0, 1.5).ratio == 0);
  CHECK(ml::foot_skate({slides, 1, 20}, foot, -0.05).contact == 0);  // the floor is lower
  CHECK(ml::foot_skate({slides, 1, 20}, foot, -0.05).speed == 0);

  const auto taps = track(11, [](double f) { return ml::Vec3{0.0, 0.02 * (static_cast<int>(f) % 2), 0.0}; });
  CHECK(ml::foot_skate({taps, 1, 20}, foot).speed == 0);
  CHECK(ml::foot_skate({taps, 1, 20}, foot).contact == 1);

  // Slides for five steps, then lifts off: the step that leaves the floor is not a contact.
  const auto lifts = track(11, [](double f) { return ml::Vec3{0.1 * f, f <= 5 ? 0.0 : 0.3, 0.0}; });
  CHECK(ml::foot_skate({lifts, 1, 10}, foot).contact == Approx(0.5));
  CHECK(ml::foot_skate({lifts, 1, 10}, foot).speed == Approx(1.0));
}

TEST_CASE("jitter: the third derivative, in metres per second cubed") {
  // x = t^3 has the third derivative 6; a parabola none.
  const auto cubic = track(20, [](double f) { return ml::Vec3{std::pow(f / 50, 3), 0.0, 0.0}; });
  CHECK(ml::jitter({cubic, 1, 50}) == Approx(6));
  const auto parabola = track(20, [](double f) { return ml::Vec3{0.0, 3 * f * f, f}; });
  CHECK(ml::jitter({parabola, 1, 50}) == Approx(0));
  CHECK(ml::jitter({std::span(cubic).first(3), 1, 50}) == 0);
}

TEST_CASE("mean_acceleration: the second derivative, in metres per second squared") {
  const auto parabola = track(20, [](double f) { return ml::Vec3{3 * f * f / 100, 0.0, 4 * f * f / 100}; });
  CHECK(ml::mean_acceleration({parabola, 1, 10}) == Approx(10));  // x = 3 t^2, z = 4 t^2
  CHECK(ml::mean_acceleration({parabola, 1, 1}) == Approx(0.1));
  const auto line = track(20, [](double f) { return ml::Vec3{f, 0.0, -f}; });
  CHECK(ml::mean_acceleration({line, 1, 10}) == Approx(0));
  CHECK(ml::mean_acceleration({std::span(parabola).first(2), 1, 10}) == 0);
}

TEST_CASE("penetration: depth of the lowest joint") {
  const std::vector<ml::Vec3<double>> two{{0, 0.1, 0},  {0, -0.02, 0}, {0, 0.1, 0},
                                          {0, 0.05, 0}, {0, -0.04, 0}, {0, 0.1, 0}};
  const auto p = ml::penetration({two, 2, 20});
  CHECK(p.mean == Approx(0.02));
  CHECK(p.deepest == Approx(0.04));
  CHECK(p.ratio == Approx(2.0 / 3));
  CHECK(ml::penetration({two, 2, 20}, -1).deepest == 0);
  CHECK(ml::penetration({{}, 2, 20}).ratio == 0);
}

TEST_CASE("bone_length_deviation: 0 for rotations, else the largest relative change") {
  const auto walk = synthetic::walk({.frames = 20});
  const auto positions = walk.positions();
  CHECK(ml::bone_length_deviation({positions, 24, 20}, walk.skeleton.parents) < 1e-9);
  const std::vector<ml::Vec3<double>> bone{{0, 0, 0}, {0, 0.9, 0}, {1, 0, 0}, {1, 1.1, 0}};
  CHECK(ml::bone_length_deviation({bone, 2, 20}, std::vector<int>{-1, 0}) == Approx(0.1));
}

TEST_CASE("motion_quality: a walk that does not slide, and one that does") {
  auto walk = synthetic::walk({.frames = 60});
  const auto good = ml::motion_quality(walk);
  CHECK(good.feet.contact > 0.2);
  CHECK(good.below_floor.deepest < 0.01);
  for (std::size_t f = 0; f < walk.root.size(); ++f) walk.root[f].x += 0.1 * static_cast<double>(f);
  const auto bad = ml::motion_quality(walk);
  CHECK(bad.feet.speed > good.feet.speed + 1);
  CHECK(bad.feet.ratio > 0.9);
  CHECK(bad.jitter == Approx(good.jitter));
}

TEST_CASE("tracks that do not fit are refused") {
  const std::vector<ml::Vec3<double>> three(3);
  CHECK_THROWS_WITH_AS(ml::jitter({three, 2, 20}), Contains("[motionlang.shape.205]"), ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::penetration({three, 0, 20}), Contains("[motionlang.shape.205]"), ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::jitter({three, 3, 0}), Contains("[motionlang.config.101]"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::foot_skate({three, 3, 20}), Contains("[motionlang.shape.203]"), ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::bone_length_deviation({three, 3, 20}, std::vector<int>{-1}),
                       Contains("[motionlang.shape.204]"), ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::bone_length_deviation({three, 3, 20}, std::vector<int>{-1, 0, 5}),
                       Contains("[motionlang.shape.203]"), ml::shape_error);
}
