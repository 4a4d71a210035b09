// The user's own table of joints.
#include <doctest/doctest.h>

#include <motionlang/formats/glb_rig.hpp>
#include <motionlang/formats/skeleton_table_file.hpp>
#include <motionlang/geometry/so3.hpp>

#include "../../support/rigs.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Contains;

namespace {

/// SMPL's figure with names of which no table knows, and the lines that say which joint is which.
ml::Skeleton biped() {
  ml::Skeleton s = ml::smpl24_skeleton();
  for (std::string& name : s.names) name = "Bip " + name;
  return s;
}
std::string lines_for(const ml::Skeleton& smpl) {
  std::string text = "\xEF\xBB\xBF# SMPL, ours\r\n\r\n";
  for (const std::string& name : smpl.names) text += name + "\tBip " + name + (name == "head" ? "\t+x+y\r\n" : "\r\n");
  return text;
}

}  // namespace

TEST_CASE("a table in a file says which joint is which") {
  const auto table = ml::parse_skeleton_table(lines_for(ml::smpl24_skeleton()), biped(), "biped.tsv");
  CHECK(table.name == "biped.tsv");
  REQUIRE(table.joints.size() == 24);
  CHECK(table.find("left_knee")->source == "Bip left_knee");
  auto walk = synthetic::walk({.frames = 10, .turn = 0.5});
  const auto wanted = walk;
  walk.skeleton = biped();
  const auto on_smpl =
      ml::retarget(walk, ml::SkeletonMap(walk.skeleton, ml::smpl24_skeleton(), table), {.floor = false});
  CHECK(synthetic::largest_distance(on_smpl, wanted) < 1e-9);
}

TEST_CASE("axes of a table: a skeleton that lies in its zero pose") {
  // SMPL's with bones turned by a quarter, so that the head is at +z: its y points up in the T-pose where it was -z.
  ml::Skeleton lying = biped();
  for (auto& o : lying.offsets) o = {o.x, -o.z, o.y};
  std::string text;
  for (const std::string& name : ml::smpl24_skeleton().names) text += name + "\tBip " + name + "\t+x+z\n";
  const ml::SkeletonMap map(lying, ml::smpl24_skeleton(), ml::parse_skeleton_table(text, lying));
  ml::Motion standing{lying, 20, {{0, 0.95, 0}}, std::vector(24, ml::Quaternion<double>::identity()), "standing"};
  standing.local[0] = synthetic::about_x(-std::acos(0.0));
  for (const auto& q : ml::retarget(standing, map).local)
    CHECK(ml::distance(q, ml::Quaternion<double>::identity()) < 1e-9);
}

TEST_CASE("a table in a file puts motions on a character of other names") {
  ml::Skeleton names = rigs::skeleton_of(ml::skeleton_table("Mixamo"));
  std::string text;
  for (const auto& row : ml::skeleton_table("Mixamo").joints) {
    names.names[static_cast<std::size_t>(names[row.source])] = "my" + row.source;
    text += row.target + "\tmy" + row.source + "\n";
  }
  const auto glb = rigs::glb_of(names);
  CHECK_THROWS_WITH_AS(ml::GlbRig(glb, "my.glb"), Contains("`joints`"), ml::config_error);
  const ml::GlbRig mine(glb, "my.glb", [&](const ml::Skeleton& s) { return ml::parse_skeleton_table(text, s, "t"); });
  CHECK(mine.table().name == "t");
  const auto walk = synthetic::walk({.frames = 5});
  const ml::GlbRig known(rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"))), "known.glb");
  const auto on_known = ml::retarget(walk, known.map_from(walk.skeleton)),
             on_mine = ml::retarget(walk, mine.map_from(walk.skeleton));
  for (std::size_t i = 0; i < on_known.local.size(); ++i)
    CHECK(ml::distance(on_known.local[i], on_mine.local[i]) < 1e-9);
  CHECK(mine.with(std::span(&walk, 1)).size() > glb.size());
}

TEST_CASE("an error in a table is reported with its line") {
  const auto refused = [](const std::string& text, const char* message) {
    CHECK_THROWS_WITH_AS(ml::parse_skeleton_table(text, biped(), "t.tsv"), Contains(message), ml::error);
  };
  refused("pelvis\tBip pelvis\nhips\tBip pelvis\n",
          "[motionlang.config.103] t.tsv:2: 'hips' is not a joint of SMPL: pelvis, left_hip, right_hip, spine1");
  refused("\nleft_foot\tBip toe\n",
          "[motionlang.config.103] t.tsv:2: the skeleton has no joint 'Bip toe': Bip pelvis, Bip left_hip");
  refused("pelvis\tBip pelvis\n\npelvis\tBip spine1\n",
          "[motionlang.config.102] t.tsv:3: 'pelvis' is in line 1 already");
  refused("pelvis\tBip pelvis\t+x\n", "[motionlang.config.103] t.tsv:1: '+x' does not name two axes");
  for (const char* line : {"pelvis Bip pelvis", "pelvis\t", "pelvis\tBip pelvis\t+x+y\tleft"})
    refused(line, "[motionlang.io.403] t.tsv:1: ");
  refused("pelvis\tBip pelvis\n", "[motionlang.config.103] t.tsv: no line says which joint is 'left_hip'");
  CHECK_THROWS_WITH_AS(ml::read_skeleton_table("no/such.tsv", biped()), Contains("[motionlang.io.401]"), ml::io_error);
}
