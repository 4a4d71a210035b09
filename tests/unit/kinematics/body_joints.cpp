#include <motionlang/kinematics/body_joints.hpp>

#include <doctest/doctest.h>

#include <motionlang/kinematics/known_skeletons.hpp>

namespace ml = motionlang;

TEST_CASE("the joints of SMPL's skeleton by their names") {
  const ml::Skeleton& s = ml::smpl24_skeleton();
  const auto joints = ml::find_body_joints(s);
  REQUIRE(joints);
  const auto name = [&](int j) { return j < 0 ? std::string() : std::string(s.name(j)); };
  CHECK(name(joints->pelvis) == "pelvis");
  CHECK(name(joints->head) == "head");
  CHECK(name(joints->knee.left) == "left_knee");
  CHECK(name(joints->wrist.right) == "right_wrist");
  for (const auto* pair :
       {&joints->hip, &joints->knee, &joints->ankle, &joints->toe, &joints->shoulder, &joints->elbow, &joints->wrist})
    CHECK(pair->known());
}

TEST_CASE("a skeleton that no table fits has none") {
  const auto rope =
      ml::Skeleton::from_joints({{"a", "", {0, 1, 0}}, {"b", "a", {0, -0.5, 0}}, {"c", "b", {0, -0.5, 0}}});
  CHECK_FALSE(ml::find_body_joints(rope));
  CHECK_FALSE(ml::BodyJoints::Pair{.left = 3}.known());
}
