// Skeletons and forward kinematics of one pose.
#include <doctest/doctest.h>

#include <numbers>

#include <motionlang/core/dual.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/describe_skeleton.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/motion.hpp>

namespace ml = motionlang;
using doctest::Contains;

namespace {
ml::Skeleton leg() {
  return ml::Skeleton::from_joints(
      {{"hips", "", {0, 0.9, 0}}, {"knee", "hips", {0, -0.4, 0}}, {"ankle", "knee", {0, -0.4, 0}}});
}
}  // namespace

TEST_CASE("a bent knee is where geometry says") {
  const auto skeleton = leg();
  auto pose = ml::Pose<double>::rest(skeleton);
  pose.local[1] = ml::from_axis_angle(ml::Vec3{1.0, 0.0, 0.0}, std::numbers::pi / 2);
  const auto joints = ml::forward_kinematics(skeleton, pose);
  CHECK(joints.position[1].y == doctest::Approx(0.5));
  CHECK(joints.position[2].y == doctest::Approx(0.5));
  CHECK(joints.position[2].z == doctest::Approx(-0.4));
}

TEST_CASE("malformed skeletons are refused with the joint's name") {
  CHECK_THROWS_WITH_AS(ml::Skeleton::from_joints({{"a", "", {}}, {"b", "c", {}}}), Contains("[motionlang.config.106]"),
                       ml::config_error);
  CHECK_THROWS_WITH_AS(ml::Skeleton::from_joints({{"a", "", {}}, {"a", "a", {}}}), Contains("'a'"), ml::config_error);
  CHECK_THROWS_AS(ml::Skeleton::from_joints({{"a", "", {}}, {"b", "", {}}}), ml::config_error);
  CHECK_THROWS_AS(ml::Skeleton::from_arrays({"a", "b"}, {-1, 1}, {{}, {}}), ml::config_error);
  CHECK_THROWS_AS(ml::Skeleton::from_arrays({"a", "b"}, {-1}, {{}, {}}), ml::config_error);
  CHECK_THROWS_AS(ml::Skeleton::from_joints({}), ml::config_error);
  CHECK_THROWS_WITH_AS(leg()["toe"], Contains("[motionlang.config.103]"), ml::config_error);
}

TEST_CASE("standard skeletons: sizes, order, symmetry, height") {
  CHECK(ml::smpl24_skeleton().size() == 24);
  CHECK(ml::humanml3d22_skeleton().size() == 22);
  CHECK(ml::kit21_skeleton().size() == 21);
  CHECK(ml::smpl24_skeleton()["right_wrist"] == 21);
  const auto rest = ml::smpl24_skeleton().rest_positions();
  for (std::size_t j = 0; j < 24; ++j) {
    const auto m = static_cast<std::size_t>(ml::smpl_mirror_joint[j]);
    CHECK(rest[j].x == doctest::Approx(-rest[m].x));
    CHECK(rest[j].y == doctest::Approx(rest[m].y));
  }
  CHECK(rest[15].y - rest[10].y > 1.4);
}

TEST_CASE("body parts: names, synonyms, sets") {
  CHECK(ml::parse_body_part("torso") == ml::BodyPart::spine);
  CHECK(ml::parse_body_part("right leg") == ml::BodyPart::legs);
  CHECK_FALSE(ml::parse_body_part("Legs").has_value());
  const auto set = ml::BodyParts{}.with(ml::BodyPart::legs).with(ml::BodyPart::head).with(ml::BodyPart::head);
  CHECK(set.count() == 2);
  CHECK(set.has(ml::BodyPart::head));
  CHECK_FALSE(set.has(ml::BodyPart::spine));
  CHECK(ml::BodyParts::all().count() == 5);
}

TEST_CASE("forward kinematics is differentiable: dual numbers against differences") {
  const auto& skeleton = ml::smpl24_skeleton();
  ml::Philox rng{.seed = 5};
  std::vector<double> v(24 * 3);
  rng.normal(std::span<double>(v));
  auto hand = [&]<class S>(const S& x) {
    std::vector<ml::AxisAngle<S>> local;
    for (std::size_t j = 0; j < 24; ++j) local.push_back({{S(v[3 * j]), S(v[3 * j + 1]), S(v[3 * j + 2])}});
    local[18].v.y = x;
    const auto t =
        ml::forward_kinematics(skeleton, std::span<const ml::AxisAngle<S>>(local), ml::Vec3<S>{S(0), S(1), S(0)});
    return t.position[22].x + t.position[22].z;
  };
  const double h = 1e-6, numeric = (hand(0.4 + h) - hand(0.4 - h)) / (2 * h);
  CHECK(hand(ml::Dual<double>(0.4, 1.0)).derivative == doctest::Approx(numeric).epsilon(1e-7));
}

TEST_CASE("a joint that is not there, also of a skeleton without joints") {
  CHECK_THROWS_WITH_AS(leg()["elbow"], Contains("[motionlang.config.103] Skeleton: no joint 'elbow' among 3 joints"),
                       ml::config_error);
  CHECK_THROWS_WITH_AS(ml::Skeleton{}["hips"], Contains("[motionlang.config.103]"), ml::config_error);
}

TEST_CASE("motions are checked") {
  ml::Motion m{
      .skeleton = leg(), .fps = 20, .root = {{0, 1, 0}}, .local = std::vector(3, ml::Quaternion<double>::identity())};
  m.validate();
  CHECK(m.positions().size() == 3);
  for (double fps : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    auto timed = m;
    timed.fps = fps;
    CHECK_THROWS_WITH_AS(timed.validate(), Contains("[motionlang.config.101]"), ml::config_error);
  }
  m.local[1] = {0, 0, 0, 0};
  CHECK_THROWS_WITH_AS(m.validate(), Contains("'knee' in frame 0 has length 0"), ml::numeric_error);
  m.local[1].x = std::nan("");
  CHECK_THROWS_WITH_AS(m.validate(), Contains("'knee' in frame 0"), ml::numeric_error);
  m.local.pop_back();
  CHECK_THROWS_AS(m.validate(), ml::shape_error);
}

TEST_CASE("a skeleton as lines: number, name, parent") {
  CHECK(ml::describe_skeleton(leg()) ==
        "    0 hips                     \n    1 knee                     hips\n    2 ankle                    knee\n");
}
