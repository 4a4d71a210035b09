// Motions of lines that say how they go on: repeated, held, followed; and long enough for trainings that need length.
#include <motionlang/datasets/segment_motion.hpp>

#include <doctest/doctest.h>

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/kinematics/floor_fix.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

ml::Motion cycle() {  // on the spot
  auto m = synthetic::walk({.frames = 21, .steps_per_second = 2});
  for (auto& root : m.root) root.x = root.z = 0, root.y += 0.3;
  return m;
}
ml::ClipLine line(double start, double end) {
  ml::ClipLine l;
  l.place = "table:1", l.clip = "walk", l.start = start, l.end = end;
  return l;
}
ml::SegmentMotion motion_of(const ml::ClipLine& l) {
  return ml::segment_motion(
      l, [](const ml::ClipLine&) { return cycle(); }, 8);
}

}  // namespace

TEST_CASE("a cycle goes ahead on the floor, as long as wanted") {
  auto l = line(0, 9);
  l.repeat = true;
  const auto s = motion_of(l);
  REQUIRE(s.cycle);
  CHECK((s.action == 21 && s.cycle->first == 0 && s.cycle->last == 20));
  CHECK((s.motion.root.back() - s.motion.root.front()).z > 0.4);
  CHECK(std::abs(ml::heights_over_floor(s.motion)[5]) < 0.03);
  const auto longer = ml::lasting(s, 100);
  CHECK(longer.frames() == 100);
  CHECK((longer.root.back() - longer.root.front()).z > 2);
  CHECK(ml::lasting(s, 10).frames() == 21);
  l.end = 0.5;
  CHECK_ERROR(motion_of(l), "[motionlang.io.403] table:1: 'walk' is to repeat, but its 10 frames end ");
}

TEST_CASE("the last pose is held, or a cycle follows; the action is never cut") {
  auto l = line(0, 0.5);
  CHECK(ml::lasting(motion_of(l), 100).frames() == 10);  // nothing follows
  CHECK_ERROR(motion_of(line(0, 0.3)), "at least 8 are wanted");
  l.hold = true;
  const auto held = ml::lasting(motion_of(l), 60);
  CHECK(held.frames() == 60);
  CHECK(synthetic::largest_distance(ml::crop(held, 20, 21), ml::crop(held, 59, 60)) < 1e-6);
  CHECK(synthetic::largest_distance(ml::crop(held, 2, 3), ml::crop(held, 59, 60)) > 0.05);
  CHECK(ml::lasting(motion_of(l), 12).frames() == 12);
  CHECK(ml::lasting(motion_of(l), 3).frames() == 10);
  l.hold = false;
  l.then.push_back(line(0, 9));
  const auto followed = motion_of(l);
  REQUIRE(followed.rest);
  CHECK(followed.action == 10);
  CHECK(followed.rest->last - followed.rest->first == 20);
  CHECK(ml::lasting(followed, 90).frames() == 90);
}

TEST_CASE("short actions become long enough for trainings that want two seconds") {
  const TemporaryFolder folder;
  auto walk = cycle();
  walk.name = "Walk";
  ml::write_glb(folder / "hero.glb", walk);
  ml::write_file(folder / "captions.tsv", std::string_view("hero.glb#Walk\t0\t9\tlegs\twalk along\trepeat\n"
                                                           "hero.glb#Walk\t0\t0.6\tlegs\ttake a step\n"));
  const auto data =
      ml::read_described_motions({.data = folder.path, .captions = folder / "captions.tsv"},
                                 {.min_seconds = 2, .test_share = 0, .validation_share = 0}, ml::row_maker("guoh3d"));
  REQUIRE(data.training.size() == 1);
  CHECK(std::ssize(data.training[0].rows) / data.width > 45);
  CHECK(data.training[0].texts[0].text == "walk along");
}
