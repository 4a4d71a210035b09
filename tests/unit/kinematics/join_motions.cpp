// Motions one after the other.
#include <doctest/doctest.h>

#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/join_motions.hpp>
#include <motionlang/kinematics/match_motion.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

TEST_CASE("the second motion goes on at the rate of the first, blended for some seconds") {
  const auto first = synthetic::walk({.frames = 60, .fps = 20}), second = synthetic::walk({.frames = 90, .fps = 30});
  const auto both = ml::join_motions(first, second, 0.5);
  CHECK(both.fps == 20);
  const auto same = ml::blend_into(first, ml::match_motion(second, first), 10);
  CHECK(both.frames() == same.frames());
  CHECK(synthetic::largest_distance(both, same) == 0);
  CHECK(ml::join_motions(first, second, 0).frames() == first.frames() + ml::match_motion(second, first).frames() - 1);
  CHECK_ERROR(ml::join_motions(first, second, 1e30),
              "[motionlang.config.101] join: 'walk' has 60 frames at 20 per second, `blend` 1e+30 takes 2e+31");
}
