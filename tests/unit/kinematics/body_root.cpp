// Where a body begins in a skeleton that has more: random trees with joints above and beside the hips.
#include <doctest/doctest.h>

#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/body_root.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

namespace ml = motionlang;

namespace {

/// SMPL's joints below `above` joints in a row, with `beside` others that hang on random joints above the hips.
ml::Skeleton with_more(ml::Philox& random, int above, int beside) {
  std::vector<ml::Joint> joints;
  for (int i = 0; i < above; ++i)
    joints.push_back({"above" + std::to_string(i), i == 0 ? "" : "above" + std::to_string(i - 1), {0.1, 0.2, 0.3}});
  for (int i = 0; i < beside; ++i)
    joints.push_back({"beside" + std::to_string(i),
                      "above" + std::to_string(random.bits() % static_cast<unsigned>(above)),
                      {1, 0, 0}});
  const ml::Skeleton& smpl = ml::smpl24_skeleton();
  for (int j = 0; j < smpl.size(); ++j)
    joints.push_back({smpl.name(j),
                      j == 0 ? joints[static_cast<std::size_t>(above - 1)].name : smpl.name(smpl.parent(j)),
                      smpl.offset(j)});
  return ml::Skeleton::from_joints(joints);
}

std::vector<ml::JointMovement> at_rest(const ml::Skeleton& s) {
  return std::vector<ml::JointMovement>(static_cast<std::size_t>(s.size()));
}

}  // namespace

TEST_CASE("the pelvis is the root of a body, whatever stands above and beside it") {
  ml::Philox random{.seed = 47};
  for (int round = 0; round < 50; ++round) {
    const ml::Skeleton all = with_more(random, 1 + round % 4, round % 7);
    const int root = ml::body_root(all);
    CHECK(all.name(root) == "pelvis");
    const ml::Skeleton body = ml::skeleton_from(all, root);
    CHECK(body.names == ml::smpl24_skeleton().names);
    CHECK(body.parents == ml::smpl24_skeleton().parents);
    const auto whole = all.rest_positions(), part = body.rest_positions();
    const auto joints = ml::joints_from(all, root);
    REQUIRE(joints.size() == part.size());
    for (std::size_t j = 0; j < part.size(); ++j) CHECK(part[j] == whole[static_cast<std::size_t>(joints[j])]);
  }
}

TEST_CASE("where trunk and legs hang on a joint above the pelvis, that is the root") {
  std::vector<ml::Joint> joints{{"centre", "", {0, 1, 0}}};
  const ml::Skeleton& smpl = ml::smpl24_skeleton();
  for (int j = 0; j < smpl.size(); ++j) {
    const bool on_centre = j == 0 || smpl.name(j) == "spine1";
    joints.push_back({smpl.name(j), on_centre ? "centre" : smpl.name(smpl.parent(j)), smpl.offset(j)});
  }
  CHECK(ml::body_root(ml::Skeleton::from_joints(joints)) == 0);
}

TEST_CASE("a skeleton that no table knows begins at its root, and ends go along") {
  ml::Skeleton s = ml::Skeleton::from_joints({{"a", "", {1, 0, 0}}, {"b", "a", {0, 1, 0}}, {"c", "a", {0, 0, 1}}});
  s.ends = {{0, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  CHECK(ml::body_root(s) == 0);
  CHECK(ml::body_root(s, ml::skeleton_table("SMPL")) == -1);
  const ml::Skeleton c = ml::skeleton_from(s, 2);
  CHECK(c.names == std::vector<std::string>{"c"});
  CHECK(c.offsets == std::vector<ml::Vec3<double>>{{1, 0, 1}});
  CHECK(c.ends == std::vector<ml::Vec3<double>>{{0, 0, 3}});
}

TEST_CASE(
    "without known names the movement tells: the child that moves with most of the joints, not a bone that stretches") {
  // floor > {trunk > {arm, head > hat}, prop}
  const auto s = ml::Skeleton::from_joints({{"floor", "", {}},
                                            {"trunk", "floor", {0, 1, 0}},
                                            {"arm", "trunk", {0.5, 0, 0}},
                                            {"head", "trunk", {0, 1, 0}},
                                            {"hat", "head", {0, 0.2, 0}},
                                            {"prop", "floor", {1, 0, 0}}});
  auto moves = at_rest(s);
  CHECK(ml::moving_root(s, moves) == 0);
  moves[1].way = 0.3;  // beside a prop at rest
  CHECK(ml::moving_root(s, moves) == 1);
  moves[5].turns = true;  // beside something that may be a leg
  CHECK(ml::moving_root(s, moves) == 0);
  moves[1].way = 1.1;  // less than trunk, head and hat are long
  CHECK(ml::moving_root(s, moves) == 0);
  moves[1].way = 1.3;
  CHECK(ml::moving_root(s, moves) == 1);
  moves[3].way = 0.01;  // the neck stretches a little
  CHECK(ml::moving_root(s, moves) == 1);
  moves[0].way = 1;  // the floor moves as well: it may be the hips, and the trunk a spine
  moves[1].way = 1.1;
  CHECK(ml::moving_root(s, moves) == 0);
  moves = at_rest(s);
  moves[5].way = 3;  // a prop alone
  CHECK(ml::moving_root(s, moves) == 0);
  const auto chain = ml::Skeleton::from_joints({{"a", "", {}}, {"b", "a", {0, 1, 0}}, {"c", "b", {0, 1, 0}}});
  moves = at_rest(chain);
  moves[1].way = 1e-3;  // carried by a alone
  CHECK(ml::moving_root(chain, moves) == 1);
}
