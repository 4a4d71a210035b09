// motionlang compose and join: whose joints are whose, how clips go on, and what is refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <motionlang/file/file.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;

namespace {

/// A walk of 40 frames at 20 per second, and a pose of 30 frames at 10 in which every joint is bent.
struct Clips : TemporaryFolder {
  Clips() {
    const ml::Motion walk = synthetic::walk({.frames = 40});
    ml::write_bvh(*this / "walk.bvh", walk);
    ml::Motion bent{walk.skeleton, 10, {}, {}, "bent"};
    bent.root.assign(30, {0, 1, 5});
    const auto turn = ml::from_axis_angle(ml::Vec3<double>{0, 0, 1}, 0.3);
    bent.local.assign(30 * walk.skeleton.names.size(), turn);
    ml::write_bvh(*this / "bent.bvh", bent);
  }
  Outcome run(const std::vector<std::string>& arguments) const { return ::run(arguments, path); }
  ml::Motion read(const std::string& file) const { return ml::read_bvh_motion(*this / file); }
};

double angle_between(const ml::Motion& a, ml::Index in_a, const ml::Motion& b, ml::Index in_b,
                     const std::string& joint) {
  const auto of = [&](const ml::Motion& m, ml::Index frame) {
    const auto at = std::find(m.skeleton.names.begin(), m.skeleton.names.end(), joint) - m.skeleton.names.begin();
    REQUIRE(at < m.skeleton.size());
    return m.rotations(frame)[static_cast<std::size_t>(at)];
  };
  return ml::distance(of(a, in_a), of(b, in_b));
}

}  // namespace

TEST_CASE("compose: the second motion gives the parts that are named, or that its text moves") {
  const Clips w;
  const ml::Motion walk = w.read("walk.bvh"), bent = w.read("bent.bvh");
  for (const char* second : {"right arm", "wave with the right hand"}) {
    const Outcome made = w.run({"compose", "walk.bvh", "bent.bvh", "--second", second, "-o", "both.bvh"});
    REQUIRE_MESSAGE(made.code == 0, made.text);
    CHECK_MESSAGE(contains(made.text, "bent.bvh: right arm\n"), made.text);
    CHECK_MESSAGE(contains(made.text, "both.bvh: 40 frames at 20 per second"), made.text);
    const ml::Motion both = w.read("both.bvh");
    for (const char* joint : {"right_shoulder", "right_wrist", "right_hand"}) {
      CHECK(angle_between(both, 10, bent, 5, joint) < 1e-4);
      CHECK(angle_between(both, 10, walk, 10, joint) > 0.1);
    }
    for (const char* joint : {"pelvis", "left_hip", "spine2", "left_elbow", "left_hand"})
      CHECK(angle_between(both, 10, walk, 10, joint) < 1e-4);
    CHECK(ml::norm(both.root_at(30) - walk.root_at(30)) < 1e-4);
  }
}

TEST_CASE("compose: legs, pelvis and path stay together; the motion with fewer parts overrides") {
  const Clips w;
  const ml::Motion walk = w.read("walk.bvh"), bent = w.read("bent.bvh");
  const Outcome made = w.run(
      {"compose", "walk.bvh", "bent.bvh", "--first", "left arm, right arm", "--second", "right leg", "-o", "both.bvh"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  const ml::Motion both = w.read("both.bvh");
  for (const char* joint : {"pelvis", "left_hip", "right_ankle"}) CHECK(angle_between(both, 10, bent, 5, joint) < 1e-4);
  for (const char* joint : {"spine1", "left_elbow", "head"}) CHECK(angle_between(both, 10, walk, 10, joint) < 1e-4);
  CHECK(ml::norm(both.root_at(30) - bent.root_at(15)) < 1e-4);
  CHECK(contains(w.run({"compose", "walk.bvh", "bent.bvh", "--first", "left arm,right arm", "--second", "right arm",
                        "-o", "both.bvh"})
                     .text,
                 "both motions claim right arm; the one with fewer parts gets them"));
}

TEST_CASE("compose: two motions of the whole body are none at the same time") {
  const Clips w;
  const Outcome made = w.run({"compose", "walk.bvh", "bent.bvh", "--second", "tail", "-o", "no.bvh"});
  const char* said = "[motionlang.config.102] compose: both motions have all parts, nothing of 'walk' would remain";
  CHECK_MESSAGE((made.code == 2 && contains(made.text, said)), made.text);
}

TEST_CASE("compose, join: a T-pose that was put in front of a recording is left out, and the program says so") {
  const Clips w;
  const ml::Motion walk = w.read("walk.bvh");
  ml::Motion pose = ml::crop(walk, 0, 1);
  std::fill(pose.local.begin(), pose.local.end(), ml::Quaternion<double>::identity());
  ml::write_bvh(w / "exported.bvh", ml::concatenate(pose, walk));
  const char* said = "exported.bvh: left out: 1 frame of an inserted T-pose at the start\n";
  const Outcome joined = w.run({"join", "exported.bvh", "exported.bvh", "-o", "all.bvh"});
  REQUIRE_MESSAGE((joined.code == 0 && contains(joined.text, said)), joined.text);
  CHECK(synthetic::largest_distance(w.read("all.bvh"), ml::blend_into(walk, walk, 6)) < 1e-3);
  const Outcome made = w.run({"compose", "exported.bvh", "bent.bvh", "--second", "right arm", "-o", "both.bvh"});
  REQUIRE_MESSAGE((made.code == 0 && contains(made.text, said)), made.text);
  CHECK(angle_between(w.read("both.bvh"), 0, walk, 0, "left_shoulder") < 1e-4);
}

TEST_CASE("compose: body parts by a table of answers, as SINC has them") {
  const Clips w;
  ml::write_file(w / "table.json", std::string_view(R"({"salute": ["", "", "Answer: left arm\ntorso"]})"));
  const Outcome made =
      w.run({"compose", "walk.bvh", "bent.bvh", "--second", "salute", "--table", "table.json", "-o", "both.glb"});
  CHECK_MESSAGE(contains(made.text, "bent.bvh: torso, left arm\n"), made.text);
  CHECK(ml::GlbFile::open(w / "both.glb").animation_names().size() == 1);
  const Outcome unknown =
      w.run({"compose", "walk.bvh", "bent.bvh", "--second", "bow", "--table", "table.json", "-o", "no.bvh"});
  CHECK_MESSAGE((unknown.code == 1 && contains(unknown.text, "no parts of 'bow'")), unknown.text);
  const Outcome nothing = w.run({"compose", "walk.bvh", "bent.bvh", "-o", "no.bvh"});
  CHECK_MESSAGE((nothing.code == 2 && contains(nothing.text, "--second")), nothing.text);
  const Outcome nowhere = w.run({"compose", "walk.bvh", "bent.bvh", "--second", "torso", "-o", "there/no.bvh"});
  CHECK_MESSAGE((nowhere.code == 1 && contains(nowhere.text, "there is no folder there")), nowhere.text);
}

TEST_CASE("join: each motion goes on where the one before it ends") {
  const Clips w;
  const ml::Motion walk = w.read("walk.bvh");
  const Outcome made = w.run({"join", "walk.bvh", "walk.bvh", "bent.bvh", "--blend", "0.5", "-o", "all.bvh"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  const ml::Motion all = w.read("all.bvh");
  // bent.bvh at the rate of the walk: 3 s less one of its frames
  CHECK(all.frames() == 40 + 40 - 10 + 59 - 10);
  CHECK(all.fps == doctest::Approx(20));
  CHECK(synthetic::largest_distance(ml::crop(all, 0, 60), ml::crop(ml::blend_into(walk, walk, 10), 0, 60)) < 1e-3);
  for (ml::Index f = 1; f < all.frames(); ++f) CHECK(ml::norm(all.root_at(f) - all.root_at(f - 1)) < 0.15);  // no jump
  const Outcome one = w.run({"join", "walk.bvh", "-o", "one.bvh"});
  CHECK_MESSAGE(one.code == 0, one.text);
  CHECK(synthetic::largest_distance(w.read("one.bvh"), walk) < 1e-3);
  const Outcome too_long = w.run({"join", "walk.bvh", "bent.bvh", "--blend", "2.5", "-o", "no.bvh"});
  const char* said = "join: 'walk' has 40 frames at 20 per second, --blend 2.5 takes 50";
  CHECK_MESSAGE((too_long.code == 2 && contains(too_long.text, said)), too_long.text);
  const Outcome endless = w.run({"join", "walk.bvh", "bent.bvh", "--blend", "1e30", "-o", "no.bvh"});
  CHECK_MESSAGE((endless.code == 2 && contains(endless.text, "--blend 1e+30 takes")), endless.text);
  CHECK(w.run({"join", "walk.bvh", "bent.bvh", "-o", "named by the file.glb"}).code == 0);
  const auto names = ml::GlbFile::open(w / "named by the file.glb").animation_names();
  CHECK((names.size() == 1 && names[0] == "named by the file"));
}

TEST_CASE("join: a motion of another skeleton stands on the floor of the first") {
  const Clips w;
  ml::Motion high = w.read("walk.bvh");
  for (auto& root : high.root) root.y += 0.5;
  ml::write_bvh(w / "high.bvh", high);
  ml::write_bvh(w / "other.bvh", synthetic::walk({.frames = 40}, ml::humanml3d22_skeleton()));
  const Outcome made = w.run({"join", "high.bvh", "other.bvh", "-o", "all.bvh"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  const ml::Motion all = w.read("all.bvh");
  for (const ml::Index f : {10, 60, 70}) CHECK(std::abs(all.root_at(f).y - high.root_at(f % 40).y) < 0.1);
}
