#include <motionlang/generate/finish_motion.hpp>

#include <doctest/doctest.h>

#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/floor_fix.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

TEST_CASE("a motion is smoothed and put on its feet, in that order, as the options say") {
  ml::Motion walk = synthetic::walk({.frames = 30, .turn = 0.5});
  const auto same = [](const ml::Motion& a, const ml::Motion& b) { return a.local == b.local && a.root == b.root; };
  CHECK(same(ml::finish_motion(walk, {.smooth = false, .fix_feet = false, .fix_floor = false}), walk));
  CHECK(same(ml::finish_motion(walk, {.fix_feet = false, .fix_floor = false}), ml::smooth_motion(walk)));
  CHECK(same(ml::finish_motion(walk, {.smooth = false, .fix_floor = false}), ml::fix_feet(walk)));
  CHECK(same(ml::finish_motion(walk, {.fix_floor = false}), ml::fix_feet(ml::smooth_motion(walk))));
  for (auto& p : walk.root) p.y += 0.1;
  CHECK(same(ml::finish_motion(walk, {.smooth = false, .fix_feet = false}), ml::fix_floor(walk)));
  CHECK(same(ml::finish_motion(walk, {}),
             ml::lift_sunken_feet(ml::fix_feet(ml::stand_on_floor(ml::smooth_motion(walk))))));
  ml::Motion other = walk;  // a skeleton without known legs
  other.skeleton.names[1] = "thigh";
  CHECK(same(ml::finish_motion(other, {.smooth = false}), other));
}

TEST_CASE("the features of a layout, and motions of them") {
  CHECK(ml::features_of_layout("guoh3dfeats", 263).name == "guoh3d");
  CHECK(ml::features_of_layout("guoh3dfeats", 251).name == "kit");
  CHECK(ml::features_of_layout("rifke", 67).name == "rifke");
  CHECK_ERROR(ml::features_of_layout("shapes", 3), "[motionlang.config.103]");
  const ml::Motion walk = synthetic::walk({.frames = 12});
  const auto& smplrifke = ml::motion_features("smplrifke");
  const auto rows = smplrifke.from_motion(walk);
  const ml::Motion published = ml::motion_of_features("smplrifke", rows, smplrifke.width, 20);
  const ml::Motion plain = ml::motion_of_rows(smplrifke, rows, 20);
  CHECK(published.frames() == plain.frames());
  // the same motion, which starts turned by pi
  CHECK(std::abs(ml::distance(published.rotations(0)[0], plain.rotations(0)[0]) - std::numbers::pi) < 1e-6);
  const std::vector<float> floats(rows.begin(), rows.end());
  CHECK(synthetic::largest_distance(ml::motion_of_features(smplrifke, floats), plain) < 1e-4);
}
