// A motion that begins later.
#include <motionlang/kinematics/delayed.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

TEST_CASE("the first frame stands before the motion") {
  const ml::Motion walk = synthetic::walk({.frames = 10});
  const ml::Motion later = ml::delayed(walk, 3 / walk.fps);
  REQUIRE(later.frames() == 13);
  later.validate();
  CHECK(later.fps == walk.fps);
  CHECK(later.name == walk.name);
  for (ml::Index f = 0; f < later.frames(); ++f) {
    const ml::Index of = f < 3 ? 0 : f - 3;
    CHECK(later.root_at(f) == walk.root_at(of));
    CHECK(std::ranges::equal(later.rotations(f), walk.rotations(of)));
  }
  CHECK(ml::delayed(walk, 0).frames() == 10);
  CHECK(ml::delayed(walk, 0.4 / walk.fps).frames() == 10);
}

TEST_CASE("times that cannot be, and a motion without a frame") {
  ml::Motion walk = synthetic::walk({.frames = 2});
  CHECK_THROWS_WITH_AS(ml::delayed(walk, -1), doctest::Contains("delayed: -1 s"), ml::config_error);
  CHECK_THROWS_AS(ml::delayed(walk, std::numeric_limits<double>::quiet_NaN()), ml::config_error);
  CHECK_THROWS_AS(ml::delayed(walk, 1e300), ml::config_error);
  walk.root.clear(), walk.local.clear();
  CHECK_THROWS_AS(ml::delayed(walk, 1), ml::shape_error);
}
