// Motions as an eye follows them.
#include <motionlang/metrics/motion_trace.hpp>

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

TEST_CASE("a walk: where it goes, how fast, on the floor") {
  const auto t = ml::trace_motion(synthetic::walk({.frames = 80}));
  CHECK(t.frames() == 80);
  CHECK(t.seconds() == 4);
  CHECK(t.forward.back() > 2);
  CHECK(std::abs(t.left.back()) < 0.3);
  CHECK((t.speed() > 0.5 && t.speed() < 2));
  CHECK(ml::longest_hover(t) < 0.2);
  CHECK(ml::sunken_seconds(t) == 0);
  CHECK(ml::still_share(t) < 0.1);
  CHECK(ml::look_wrong(t) == "");
  const auto turning = ml::trace_motion(synthetic::walk({.frames = 80, .turn = 0.5}));
  CHECK(turning.turned() == doctest::Approx(0.5 * 3.95 * 180 / 3.14159).epsilon(0.1));
  const auto part = ml::part_of(t, 20, 60);
  CHECK(part.frames() == 40);
  CHECK(part.forward.front() == t.forward[20]);
  CHECK(part.arms[1].hand.size() == 40);
  CHECK(ml::part_of(t, 70, 200).frames() == 10);
  ml::Motion other = synthetic::walk({.frames = 4});
  other.skeleton.names[4] = "knee";
  CHECK_ERROR(ml::trace_motion(other), "[motionlang.config.103] trace_motion: 'walk' is not on SMPL's joints");
}

TEST_CASE("a jump of a thrown body is a flight on its arc; one that hangs in the air is not") {
  const auto t = ml::trace_motion(ml::resample(synthetic::jump(), 20));
  const auto all = ml::flights(t);
  REQUIRE(all.size() == 1);
  CHECK((all[0].seconds > 0.35 && all[0].seconds < 0.6));
  CHECK(all[0].off_arc < 0.02);
  CHECK(all[0].lands);
  CHECK(ml::look_wrong(t) == "");
  ml::Motion hangs = synthetic::walk({.frames = 60});
  for (int f = 20; f < 45; ++f) hangs.root[static_cast<std::size_t>(f)].y += 0.3;
  CHECK(ml::look_wrong(ml::trace_motion(hangs)).starts_with("hovers 1.2"));
  for (auto& p : hangs.root) p.y -= 0.4;
  CHECK(ml::look_wrong(ml::trace_motion(hangs)).starts_with("sinks in"));
}

TEST_CASE("a figure on a turntable") {
  ml::Motion stand = synthetic::walk({.frames = 1});
  std::fill(stand.local.begin(), stand.local.end(), ml::Quaternion<double>::identity());  // a T-pose
  stand.root[0] = {0, 0, 0};
  stand.root[0].y = 0.02 - stand.positions()[10].y;
  ml::Motion m = stand;
  for (int f = 1; f < 40; ++f) {
    m.root.push_back(stand.root[0]);
    m.local.insert(m.local.end(), stand.local.begin(), stand.local.end());
    const auto root = m.rotations(f);
    root[0] = synthetic::about_y(0.05 * f) * root[0];
  }
  const auto t = ml::trace_motion(m);
  CHECK(ml::turned_on_flat_soles(t) > 90);
  CHECK(ml::look_wrong(t).find("on flat soles") != std::string::npos);
}

TEST_CASE("how often curves rise and turn back") {
  const std::vector<double> curve{0, 1, 0, 1, 0.6, 1, -1};
  CHECK(ml::rises(curve, 0.2, 0.8) == 2);
  CHECK(ml::rises({1, 1, 0, 1}, 0.2, 0.8) == 1);
  CHECK(ml::rises({}, 0, 1) == 0);
  CHECK(ml::reversals(curve, 0.5) == 3);
  CHECK(ml::reversals(curve, 0.3) == 5);
  CHECK(ml::reversals({}, 1) == 0);
}
