// Several edits in one call are the single edits one after the other.
#include <doctest/doctest.h>

#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/edit_motion.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/match_motion.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

bool same(const ml::Motion& a, const ml::Motion& b) {
  return a.fps == b.fps && a.root == b.root && a.local == b.local && a.skeleton == b.skeleton;
}

}  // namespace

TEST_CASE("time is cut, then made faster, then resampled") {
  const ml::Motion walk = synthetic::walk({.frames = 60, .fps = 20});
  CHECK(ml::frames_between(walk, 0.5, 1) == std::pair<ml::Index, ml::Index>{10, 20});
  CHECK(ml::frames_between(walk, 1, 0) == std::pair<ml::Index, ml::Index>{20, 60});
  CHECK(ml::frames_between(walk, 7, 9) == std::pair<ml::Index, ml::Index>{60, 60});
  CHECK(same(ml::edit_time(walk, {}), walk));
  CHECK(same(ml::edit_time(walk, {.from = 0.5, .to = 2, .speed = 2, .fps = 10}),
             ml::resample(ml::change_speed(ml::crop(walk, 10, 40), 2), 10)));
  CHECK_ERROR(ml::edit_time(walk, {.from = 5}), "[motionlang.config.101]");
}

TEST_CASE("edits follow each other in the order of the structure") {
  const ml::Motion walk = synthetic::walk({.frames = 60, .fps = 20});
  CHECK(same(ml::edit_motion(walk, {}), walk));
  CHECK(same(ml::edit_motion(walk, {.mirror = true, .smooth = true}), ml::smooth_motion(ml::mirror(walk))));
  CHECK(same(ml::edit_motion(walk, {.mirror = true, .one_euro = ml::OneEuroOptions{.beta = 1}}),
             ml::one_euro_filter(ml::mirror(walk), {.beta = 1})));
  CHECK(same(ml::edit_motion(walk, {.in_place = true, .loop = 0.3}), ml::make_loop(ml::in_place(walk), 6).motion));
  ml::Motion standing = walk;
  ml::place_on_floor(standing);
  CHECK(same(ml::edit_motion(walk, {.fix_feet = true}), ml::fix_feet(standing)));
  CHECK_ERROR(ml::edit_motion(ml::crop(walk, 0, 1), {.loop = 0.3}), "[motionlang.config.101]");
}

TEST_CASE("SMPL's joints in another order are put in order, others are retargeted") {
  const ml::Motion walk = synthetic::walk({.frames = 6});
  ml::RetargetReport report;
  CHECK(same(ml::edit_motion(walk, {.smpl = true}, &report), walk));
  CHECK(report.table.empty());
  ml::Motion small = walk;  // the same names, with bones that are half as long
  for (auto& o : small.skeleton.offsets) o = 0.5 * o;
  CHECK(same(ml::on_smpl(small), small));
  ml::Motion unknown = walk;
  unknown.skeleton.names[4] = "patella";
  CHECK_ERROR(ml::on_smpl(unknown), "[motionlang.config.103]");
}

TEST_CASE("a clip is made like another one") {
  const ml::Motion walk = synthetic::walk({.frames = 30, .fps = 20});
  CHECK(same(ml::match_motion(walk, walk), walk));
  const ml::Motion fast = synthetic::walk({.frames = 60, .fps = 40});
  CHECK(same(ml::match_motion(fast, walk), ml::resample(fast, 20)));
  ml::Motion high = walk;
  for (auto& p : high.root) p.y += 1;
  for (auto& o : high.skeleton.offsets) o = 1.1 * o;
  const ml::Motion matched = ml::match_motion(walk, high);
  CHECK(matched.skeleton == high.skeleton);
  ml::Motion there = matched, other = high;
  CHECK(ml::place_on_floor(there) == doctest::Approx(ml::place_on_floor(other)));
}
