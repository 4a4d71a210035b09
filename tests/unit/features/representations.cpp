// The representations of ACTOR, TEMOS, TEACH, SINC and TMR: meaning, there and back, what is refused. Their numbers are
// golden cases.
#include <doctest/doctest.h>

#include <motionlang/features/rifke.hpp>
#include <motionlang/features/smplvelp.hpp>
#include <motionlang/geometry/so3.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx;
using lists::largest_difference, lists::largest_distance, lists::view;
using Joints = std::vector<ml::Vec3<double>>;

namespace {

/// A walk with Z up: matrices of its rotations and its root.
ml::SmplVelpMotion<double> walk_z_up(int frames, double turn) {
  const auto motion = synthetic::walk({.frames = frames, .turn = turn}, ml::humanml3d22_skeleton());
  const auto up = ml::axis_rotation(0, std::numbers::pi / 2);
  ml::SmplVelpMotion<double> out;
  for (ml::Index f = 0; f < motion.frames(); ++f) {
    out.trans.push_back(up * motion.root_at(f));
    for (const auto& q : motion.rotations(f)) out.rotations.push_back(to_matrix(q));
    out.rotations[static_cast<std::size_t>(22 * f)] = up * out.rotations[static_cast<std::size_t>(22 * f)];
  }
  return out;
}
ml::SmplVelpMotion<double> turned(ml::SmplVelpMotion<double> motion, double angle) {
  const auto r = ml::axis_rotation(2, angle);
  for (auto& p : motion.trans) p = r * p;
  for (std::size_t i = 0; i < motion.rotations.size(); i += 22) motion.rotations[i] = r * motion.rotations[i];
  return motion;
}
std::vector<double> velp(const ml::SmplVelpMotion<double>& motion, const ml::SmplVelpOptions& options = {}) {
  return ml::smplvelp_features(view(motion.rotations), view(motion.trans), options);
}
}  // namespace

TEST_CASE("pose representations: there and back") {
  const ml::Vec3 v{0.4, -1.1, 0.3};
  const auto m = to_matrix(ml::AxisAngle<double>{v});
  for (const auto name : ml::pose_representation_names) {
    const auto r = ml::parse_pose_representation(name);
    std::vector<double> from_vector, from_matrix;
    append_rotation(from_vector, r, ml::AxisAngle<double>{v});
    append_rotation(from_matrix, r, m);
    CHECK(std::ssize(from_vector) == ml::size(r));
    CHECK(largest_difference(from_vector, from_matrix) < 1e-12);
    CHECK(ml::distance(ml::rotation_from(r, view(from_vector)), m) < 1e-7);
    from_vector.push_back(0);
    CHECK_ERROR(ml::rotation_from(r, view(from_vector)), "[motionlang.shape.205] rotation_from");
  }
  CHECK_ERROR(ml::parse_pose_representation("xyz"), "[motionlang.config.103] parse_pose_representation: 'xyz'");
}

TEST_CASE("actor: rows of joints over time") {
  const std::vector<ml::AxisAngle<double>> poses{{{1, 2, 3}}, {{4, 5, 6}}, {{-1, -2, -3}}, {{7, 8, 9}}};  // two of two
  const Joints root{{10, 0, 5}, {11, 2, 5}};
  const auto rotvec = ml::PoseRepresentation::rotvec;
  CHECK(ml::actor_features(view(poses), view(root), 2, {.rotations = rotvec}) ==
        std::vector<double>{1, -1, 2, -2, 3, -3, 4, 7, 5, 8, 6, 9, 0, 1, 0, 2, 0, 0});
  CHECK(ml::actor_features(view(poses), view(root), 2, {.rotations = rotvec, .translation = false, .global = false}) ==
        std::vector<double>{4, 7, 5, 8, 6, 9});
  const auto six = ml::actor_features(view(poses), view(root), 2);
  REQUIRE(six.size() == 3 * 6 * 2);
  for (std::size_t i = 2 * 6 * 2 + 3 * 2; i < six.size(); ++i) CHECK(six[i] == 0);
  CHECK(ml::actor_joint_features(view(root), 1) == std::vector<double>{0, 1, 0, 2, 0, 0});
  CHECK_ERROR(ml::actor_features(view(poses), view(root), 3),
              "actor_frame_features: 4 rotations of 3 joints, 2 root positions");
  CHECK_ERROR(ml::actor_features(view(poses), view(root).first(1), 2), "[motionlang.shape.205]");
  CHECK_ERROR(ml::actor_joint_features(view(root), 3), "[motionlang.shape.205] actor_joint_features: 2 positions");
}

TEST_CASE("actor: there and back") {
  const auto motion = synthetic::walk({.frames = 6, .turn = 0.8});
  std::vector<ml::AxisAngle<double>> vectors;
  std::vector<ml::Matrix3<double>> matrices;
  for (const auto& q : motion.local) matrices.push_back(to_matrix(q)), vectors.push_back(to_axis_angle(q));
  const auto upside_down = to_matrix(ml::AxisAngle<double>{ml::actor_global_rotation});
  for (const auto name : ml::pose_representation_names) {
    for (const bool translation : {true, false}) {
      for (const bool global : {true, false}) {
        CAPTURE(name);
        CAPTURE(translation);
        CAPTURE(global);
        const ml::ActorFeatureOptions options{ml::parse_pose_representation(name), translation, global};
        const auto rows = ml::actor_frame_features(view(vectors), view(motion.root), 24, options);
        CHECK(std::ssize(rows) == 6 * ml::size(options.rotations) * (23 + (global ? 1 : 0) + (translation ? 1 : 0)));
        CHECK(largest_difference(rows, ml::actor_frame_features(view(matrices), view(motion.root), 24, options)) <
              1e-7);
        const auto back = ml::actor_inverse(view(rows), 24, options);
        REQUIRE(back.rotations.size() == matrices.size());
        REQUIRE(back.root.size() == 6);
        for (std::size_t i = 0; i < matrices.size(); ++i) {
          const auto& wanted = i % 24 == 0 && !global ? upside_down : matrices[i];
          CHECK(ml::distance(back.rotations[i], wanted) < 1e-6);
        }
        for (std::size_t t = 0; t < 6; ++t) {
          const auto way = translation ? motion.root[t] - motion.root[0] : ml::Vec3<double>{};
          CHECK(norm(back.root[t] - way) < 1e-12);
        }
      }
    }
  }
  const std::vector<double> odd(151);
  CHECK_ERROR(ml::actor_inverse(view(odd)), "[motionlang.shape.205] actor_inverse: 151 values are not frames of 150");
  CHECK_ERROR(ml::actor_inverse(view(odd), 0), "[motionlang.config.101] actor_inverse: 0 joints");
  CHECK_ERROR(ml::actor_inverse(view(odd), 1, {.translation = false, .global = false}), "are not frames of 0");
}

TEST_CASE("smplvelp: there and back") {
  const auto motion = walk_z_up(20, 1.0);
  for (const auto name : ml::pose_representation_names) {
    const auto r = ml::parse_pose_representation(name);
    const auto rows = velp(motion, {.rotations = r, .canonicalize = false});
    CHECK(std::ssize(rows) == 20 * (3 + 22 * ml::size(r)));
    const auto back = ml::smplvelp_inverse(view(rows), 22, r);
    const auto start = motion.trans[0];
    for (std::size_t t = 0; t < 20; ++t) {
      CHECK(norm(back.trans[t] - (motion.trans[t] - ml::Vec3{start.x, start.y, 0.0})) < 1e-12);
    }
    for (std::size_t i = 0; i < back.rotations.size(); ++i) {
      CHECK(ml::distance(back.rotations[i], motion.rotations[i]) < 1e-6);
    }
  }
  CHECK(velp({}).empty());
  CHECK(ml::smplvelp_inverse(std::span<const double>{}).trans.empty());
}

TEST_CASE("smplvelp: canonical once, as published, and by the heading") {
  const auto motion = walk_z_up(20, 1.0), other = turned(motion, 1.2);
  CHECK(largest_difference(velp(motion), velp(other)) > 0.1);
  const auto again = velp(ml::smplvelp_inverse(view(velp(motion))));
  CHECK(largest_difference(velp(motion), again) > 0.1);

  const ml::SmplVelpOptions exact{.exact_yaw = true};
  CHECK(largest_difference(velp(motion, exact), velp(other, exact)) < 1e-9);
  const ml::SmplVelpOptions in_place{.offset = false, .exact_yaw = true};
  const auto rows = velp(motion, in_place);
  CHECK(largest_difference(rows, velp(ml::smplvelp_inverse(view(rows)), in_place)) < 1e-9);
  CHECK(rows[135 + 1] * rows[135 + 1] + rows[135 + 2] * rows[135 + 2] > 1e-5);  // it walks
}

TEST_CASE("smplvelp: what is refused") {
  const auto motion = walk_z_up(3, 0);
  CHECK_ERROR(ml::smplvelp_features(view(motion.rotations).first(50), view(motion.trans)),
              "[motionlang.shape.205] smplvelp_features: 50 rotations for 3 frames");
  CHECK_ERROR(ml::smplvelp_features(std::span<const ml::Matrix3<double>>{}, view(motion.trans)), "0 rotations for 3");
  const std::vector<double> rows(136);
  CHECK_ERROR(ml::smplvelp_inverse(view(rows)),
              "[motionlang.shape.205] smplvelp_inverse: 136 values are not rows of 135");
  CHECK_ERROR(ml::smplvelp_inverse(view(rows), 0), "[motionlang.shape.205]");
}

TEST_CASE("rifke: joints to features to joints, up to where and whither the first frame stands") {
  // The walk has 22 joints. TEMOS' own 21 joints take the same path through the code.
  auto y_up = ml::temos_rifke();
  y_up.joints = 22;
  y_up.across = {{{2, 1}, {17, 16}}};
  y_up.floor = {7, 10, 8, 11};
  const auto motion = synthetic::walk({.frames = 30, .turn = 0.8}, ml::humanml3d22_skeleton());
  for (const auto& variant : {y_up, ml::sinc_rifke(), ml::tmr_rifke()}) {
    auto joints = motion.positions();
    if (variant.z_up) {
      for (auto& p : joints) p = {p.x, -p.z, p.y};
    }
    const auto rows = ml::rifke_features(variant, view(joints));
    CHECK(std::ssize(rows.features) == 30 * variant.size());
    const auto back = ml::rifke_joints(variant, view(rows.features));
    // The features forget the first frame's place, its heading and the floor. Turning it back makes them equal.
    const double sine = rows.forward[0][0], cosine = rows.forward[0][1];
    const auto root = motion.root_at(0);
    for (auto& p : joints) {
      const double a = p.x - root.x, b = variant.z_up ? p.y + root.z : p.z - root.z;
      const double along = a * cosine - b * sine, ahead = a * sine + b * cosine;
      p = variant.z_up ? ml::Vec3{along, ahead, p.z - rows.floor} : ml::Vec3{along, p.y - rows.floor, ahead};
    }
    CHECK(largest_distance(joints, back) < 1e-9);
    if (variant.floor.empty()) {
      CHECK(largest_difference(ml::rifke_features(variant, view(back)).features, rows.features) < 1e-9);
    }
  }
}

TEST_CASE("rifke: the filter smooths the heading and keeps it a direction") {
  const auto motion = synthetic::walk({.frames = 40}, ml::humanml3d22_skeleton());
  auto joints = motion.positions();
  for (auto& p : joints) p = {p.x, -p.z, p.y};
  auto roughness = [](const auto& result) {
    double sum = 0;
    for (std::size_t t = 10; t < 30; ++t) {  // away from the ends, where zeros are taken in
      sum += std::abs(result.forward[t + 1][0] - 2 * result.forward[t][0] + result.forward[t - 1][0]);
    }
    return sum;
  };
  const auto plain = ml::rifke_features(ml::tmr_rifke(), view(joints));
  const auto smooth = ml::rifke_features(ml::tmr_rifke(), view(joints), true);
  // The heading swings with w = 1.8 pi radians per second; a Gaussian leaves exp(-(sigma w)^2 / 2) of it.
  const double w = 1.8 * std::numbers::pi / 20;
  CHECK(roughness(smooth) / roughness(plain) == Approx(std::exp(-0.5 * 4 * w * w)).epsilon(0.01));
  for (const auto& [sine, cosine] : smooth.forward) CHECK(sine * sine + cosine * cosine == Approx(1));
}

TEST_CASE("rifke: what is refused") {
  const Joints joints(43);
  CHECK_ERROR(ml::rifke_features(ml::tmr_rifke(), view(joints)),
              "[motionlang.shape.205] rifke_features: 43 values are not frames of 22");
  const std::vector<double> rows(66);
  CHECK_ERROR(ml::rifke_joints(ml::sinc_rifke(), view(rows)),
              "[motionlang.shape.205] rifke_joints: 66 values are not frames of 67");
  CHECK_ERROR(ml::rifke_features(ml::RifkeVariant{}, view(joints)), "[motionlang.shape.205]");
  CHECK_ERROR(ml::rifke_features(ml::tmr_rifke(17), view(joints).first(34)),
              "[motionlang.shape.203] rifke: joint 17 of 17");
}
