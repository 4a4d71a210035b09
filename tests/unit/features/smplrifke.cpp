// The 205-vector: meaning of its numbers, forward and inverse, motions there and back.
#include <doctest/doctest.h>

#include <motionlang/features/layout.hpp>
#include <motionlang/features/smplrifke.hpp>

#include "../../support/lists.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;
using lists::view;

namespace {

const std::vector<double>& walk_features() {
  static const auto features = ml::smplrifke_from_motion(synthetic::walk({.frames = 40, .turn = 1.5}));
  return features;
}

}  // namespace

TEST_CASE("smplrifke: a row has the numbers that the layout says") {
  CHECK(ml::smplrifke_layout().size == ml::smplrifke_size);
  CHECK(walk_features().size() == 40 * 205);
}

TEST_CASE("smplrifke: a figure that glides straight ahead") {
  // It faces +Z of its Y up world, that is -Y of the features' world, and moves 0.1 m a frame to its left and 0.2
  // ahead.
  ml::Motion motion = synthetic::walk({.frames = 5});
  std::fill(motion.local.begin(), motion.local.end(), ml::Quaternion<double>::identity());
  for (int f = 0; f < 5; ++f) motion.root[static_cast<std::size_t>(f)] = {0.1 * f, 1.5, 0.2 * f};
  const auto rows = ml::smplrifke_from_motion(motion);
  for (std::size_t f = 0; f < 5; ++f) {
    const auto row = view(rows).subspan(205 * f, 205);
    CHECK(row[0] == Approx(0.94));  // pelvis above the toes
    CHECK(row[1] == Approx(0.1));
    CHECK(row[2] == Approx(-0.2));
    CHECK(row[3] == Approx(0));
    // Joint 0: a quarter turn about x, rows (1 0 0) and (0 0 -1). Joint 1: the identity.
    for (const auto& [at, value] : {std::pair{4, 1}, {5, 0}, {6, 0}, {7, 0}, {8, 0}, {9, -1}, {10, 1}, {14, 1}}) {
      CHECK(row[static_cast<std::size_t>(at)] == Approx(value));
    }
    CHECK(row[136] == Approx(0.09));  // left hip: to the left, below
    CHECK(row[138] == Approx(-0.06));
  }
}

TEST_CASE("smplrifke: a turn on the spot") {
  ml::Motion motion = synthetic::walk({.frames = 6});
  std::fill(motion.local.begin(), motion.local.end(), ml::Quaternion<double>::identity());
  for (int f = 0; f < 6; ++f) {
    motion.root[static_cast<std::size_t>(f)] = {0, 1, 0};
    motion.rotations(f)[0] = synthetic::about_y(3.0 + 0.1 * f);  // passes pi
  }
  const auto rows = ml::smplrifke_from_motion(motion);
  for (std::size_t f = 0; f < 6; ++f) {
    CHECK(rows[205 * f + 3] == Approx(0.1));
    for (std::size_t k = 4; k < 205; ++k) CHECK(rows[205 * f + k] == Approx(rows[k]));  // seen from the body: nothing
  }
}

TEST_CASE("smplrifke: joints of the inverse are those of forward kinematics") {
  const auto features = walk_features();
  const auto back = ml::smplrifke_inverse(view(features));
  const auto motion = ml::smplrifke_to_motion(view(features));
  const auto positions = motion.positions();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto& p = positions[i];
    CHECK(ml::norm(ml::Vec3{p.x, -p.z, p.y} - back.joints[i]) < 1e-9);
  }
  CHECK(back.poses().size() == 40 * 66);
}

TEST_CASE("smplrifke: motion to features to motion") {
  const auto walk = synthetic::walk({.frames = 40, .turn = 1.5});
  const auto back = ml::smplrifke_to_motion(view(walk_features()));
  CHECK(back.fps == 20);
  // The walk starts at x = z = 0; its first heading and the floor (3 cm below its toes) are what the features forget.
  const auto p = walk.positions(), q = back.positions();
  const auto first =
      ml::detail::zyx_angles(ml::axis_rotation(0, std::numbers::pi / 2) * to_matrix(walk.local[0]), true).z;
  const auto turn = synthetic::about_y(first);
  double floor = 1;
  for (const auto& x : p) floor = std::min(floor, x.y);
  for (std::size_t i = 0; i < p.size(); ++i) {
    CHECK(ml::norm(rotate(turn, q[i]) + ml::Vec3{0.0, floor, 0.0} - p[i]) < 1e-9);
  }
  // And from there on nothing changes.
  const auto again = ml::smplrifke_from_motion(back);
  for (std::size_t k = 0; k < again.size(); ++k) CHECK(std::abs(again[k] - walk_features()[k]) < 1e-9);
}

TEST_CASE("smplrifke: the first angle turns the clip") {
  const auto straight = ml::smplrifke_inverse(view(walk_features()));
  const auto turned = ml::smplrifke_inverse(view(walk_features()), {.first_angle = std::numbers::pi});
  for (std::size_t i = 0; i < straight.joints.size(); ++i) {
    const auto &a = straight.joints[i], &b = turned.joints[i];
    CHECK(ml::norm(ml::Vec3{-a.x, -a.y, a.z} - b) < 1e-9);
  }
}

TEST_CASE("smplrifke: in float, from poses, and for very short clips") {
  const auto features = walk_features();
  const auto back = ml::smplrifke_inverse(view(features));
  std::vector<double> joints;
  for (const auto& p : back.joints) joints.insert(joints.end(), {p.x, p.y, p.z});
  const auto poses = back.poses();
  const auto again = ml::smplrifke_from_poses(view(poses), view(joints));
  for (std::size_t k = 0; k < again.size(); ++k) CHECK(std::abs(again[k] - features[k]) < 1e-6);

  const std::vector<float> in_float(features.begin(), features.end());
  const auto rough = ml::smplrifke_inverse(view(in_float));
  for (std::size_t i = 0; i < rough.joints.size(); ++i) {
    CHECK(ml::norm(ml::vec_cast<double>(rough.joints[i]) - back.joints[i]) < 1e-5);
  }
  for (const int frames : {1, 2}) {
    const auto few = ml::smplrifke_from_motion(synthetic::walk({.frames = frames}));
    CHECK(ml::smplrifke_to_motion(view(few)).frames() == frames);
  }
  CHECK(ml::smplrifke_to_motion(std::span<const double>{}).frames() == 0);
}

TEST_CASE("smplrifke: asin beyond 1, clamped and as published") {
  // Rows that are not orthonormal are straightened first; only rounding can exceed 1, here made by hand.
  ml::Matrix3<double> m = ml::axis_rotation(1, std::numbers::pi / 2);
  m(2, 0) = -1.0000000000000002;
  CHECK(ml::detail::zyx_angles(m, true).y == Approx(std::numbers::pi / 2));
  CHECK(std::isnan(ml::detail::zyx_angles(m, false).y));
}

TEST_CASE("smplrifke: sizes and skeletons that do not fit are refused") {
  const std::vector<double> odd(204), poses(66), joints(71);
  CHECK_THROWS_WITH_AS(ml::smplrifke_inverse(view(odd)), Contains("[motionlang.shape.205]"), ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::smplrifke_from_poses(view(poses), view(joints)), Contains("[motionlang.shape.205]"),
                       ml::shape_error);
  const std::vector<double> two(144);
  CHECK_THROWS_WITH_AS(ml::smplrifke_from_poses(view(poses), view(two)), Contains("24 and 22"), ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::smplrifke_from_motion(synthetic::walk({.frames = 3}, ml::humanml3d22_skeleton())),
                       Contains("[motionlang.config.103]"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::smplrifke_to_motion(view(walk_features()), {}, 20, ml::kit21_skeleton()),
                       Contains("[motionlang.config.103]"), ml::config_error);
}
