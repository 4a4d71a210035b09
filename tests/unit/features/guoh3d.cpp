// The vector of HumanML3D and KIT: meaning of its numbers, there and back, published errors and their corrections.
#include <doctest/doctest.h>

#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/kinematics/mirror_joints.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx;
using lists::largest_difference, lists::largest_distance, lists::view;

namespace {

template <class S>
using Joints = std::vector<ml::Vec3<S>>;

Joints<double> walk(int frames, double turn = 0) {
  return synthetic::walk({.frames = frames, .turn = turn}, ml::humanml3d22_skeleton()).positions();
}
/// The motion that the features describe. With corrections the smooth heading of frame 0 is turned onto +Z.
Joints<double> grounded(const Joints<double>& joints, bool corrected = false) {
  const auto& skeleton = ml::humanml3d_chains();
  const auto uniform = ml::uniform_skeleton(skeleton, view(joints), view(skeleton.lengths));
  if (!corrected) return ml::ground_joints(skeleton, view(uniform.joints)).joints;
  return ml::ground_joints(skeleton, view(uniform.joints), ml::guoh3d_corrected().rotations.facing).joints;
}
std::vector<double> features(const Joints<double>& joints, const ml::Guoh3dOptions& options = {}) {
  return ml::guoh3d_features(ml::humanml3d_chains(), view(joints), options);
}
}  // namespace

TEST_CASE("guoh3d: where things are") {
  const ml::Guoh3dSlots slots, kit{21};
  CHECK(slots.size() == 263);
  CHECK(slots.positions() == ml::IndexRange{4, 67});
  CHECK(slots.rotations() == ml::IndexRange{67, 193});
  CHECK(slots.velocities() == ml::IndexRange{193, 259});
  CHECK(slots.contacts() == ml::IndexRange{259, 263});
  CHECK(kit.size() == 251);
  CHECK(kit.contacts() == ml::IndexRange{247, 251});
}

TEST_CASE("guoh3d: a figure that glides, then stands") {
  // In its zero pose, which is not a T-pose: arms hang, feet point ahead. It goes 0.1 m to its left, 0.2 ahead.
  const auto& skeleton = ml::humanml3d_chains();
  const auto offsets = ml::chain_offsets<double>(skeleton, view(skeleton.lengths));
  const std::vector<ml::Quaternion<double>> zero(4 * 22, ml::Quaternion<double>::identity());
  const Joints<double> path{{0, 1, 0}, {0.1, 1, 0.2}, {0.2, 1, 0.4}, {0.2, 1, 0.4}};
  const auto joints = ml::chain_forward_kinematics(skeleton, view(zero), view(path), view(offsets));
  const auto rows = features(joints);
  REQUIRE(rows.size() == 3 * 263);
  for (std::size_t t = 0; t < 3; ++t) {
    const bool stands = t == 2;
    const auto row = view(rows).subspan(263 * t, 263);
    CHECK(row[0] == Approx(0));
    CHECK(row[1] == Approx(stands ? 0 : 0.1));
    CHECK(row[2] == Approx(stands ? 0 : 0.2));
    CHECK(row[3] == Approx(0.39018822 + 0.42564335).epsilon(0.01));  // the longer leg reaches the floor
    CHECK(row[4] == Approx(0.10307397));                             // left hip
    CHECK(row[5] == Approx(row[3]));
    CHECK(row[4 + 3 * 19] == Approx(0.13748677));  // the left wrist hangs below the shoulder
    for (std::size_t j = 0; j < 21; ++j) {         // rotations: the identity's columns
      for (std::size_t k = 0; k < 6; ++k) CHECK(row[67 + 6 * j + k] == Approx(k == 0 || k == 4 ? 1 : 0));
    }
    for (std::size_t j = 0; j < 22; ++j) {
      CHECK(row[193 + 3 * j] == Approx(stands ? 0 : 0.1));
      CHECK(row[195 + 3 * j] == Approx(stands ? 0 : 0.2));
    }
    for (std::size_t k = 259; k < 263; ++k) CHECK(row[k] == (stands ? 1 : 0));
  }
}

TEST_CASE("guoh3d: whoever it is, wherever it starts") {
  const auto joints = walk(30, 0.8);
  auto moved = joints;
  const auto turn = synthetic::about_y(2.1);
  for (auto& p : moved) p = rotate(turn, 1.3 * p) + ml::Vec3{4.0, -0.5, 7.0};
  CHECK(largest_difference(features(joints), features(moved)) < 1e-9);
}

TEST_CASE("guoh3d: a body that faces -Z") {
  const auto joints = walk(10, 0.5);
  for (const auto& options : {ml::Guoh3dOptions{}, ml::guoh3d_corrected()}) {
    auto away = grounded(joints, options.rotations.fix_first_frame);
    for (auto& p : away) p = {-p.x, p.y, -p.z};
    CHECK(largest_difference(features(away, options), features(joints, options)) < 1e-9);
  }
}

TEST_CASE("guoh3d: joints to features to joints") {
  for (const bool corrected : {false, true}) {
    const auto options = corrected ? ml::guoh3d_corrected() : ml::Guoh3dOptions{};
    for (const int frames : {2, 3, 50}) {
      const auto joints = walk(frames, 0.7), reference = grounded(joints, corrected);
      const auto rows = features(joints, options);
      CHECK(std::ssize(rows) == 263 * (frames - 1));
      CHECK(largest_distance(reference, ml::guoh3d_joints(view(rows), 22, {.last_frame = true})) < 1e-9);

      const std::vector<float> in_float(rows.begin(), rows.end());
      CHECK(largest_distance(reference, ml::guoh3d_joints(view(in_float), 22, {.last_frame = true})) < 1e-5);

      // The rotations tell the same, and all but the last frame.
      const auto& skeleton = ml::humanml3d_chains();
      const auto offsets = ml::chain_offsets<double>(skeleton, view(skeleton.lengths));
      const auto from_positions = ml::guoh3d_joints(view(rows));
      CHECK(std::ssize(from_positions) == 22 * (frames - 1));
      const auto from_rotations = ml::guoh3d_joints_from_rotations(skeleton, view(rows), view(offsets));
      CHECK(largest_distance(from_positions, from_rotations) < 1e-9);
    }
  }
  CHECK(ml::guoh3d_joints(std::span<const double>{}, 22, {.last_frame = true}).empty());
}

TEST_CASE("guoh3d: features in float are those in double") {
  const auto joints = walk(40, 0.7);
  Joints<float> rough;
  for (const auto& p : joints) rough.push_back(ml::vec_cast<float>(p));
  const auto rows = ml::guoh3d_features(ml::humanml3d_chains(), view(rough));
  CHECK(largest_difference(features(joints), {rows.begin(), rows.end()}) < 1e-4);
}

TEST_CASE("guoh3d: a heading that passes 180 degrees") {
  const auto joints = walk(80, 1.5), reference = grounded(joints);  // 6 radians in all
  const auto published = features(joints), fixed = features(joints, {.fix_yaw_sign = true});
  CHECK(largest_distance(reference, ml::guoh3d_joints(view(fixed), 22, {.last_frame = true})) < 1e-9);
  CHECK(largest_distance(reference, ml::guoh3d_joints(view(published), 22, {.last_frame = true})) > 0.1);
  int different = 0;
  for (std::size_t i = 0; i < published.size(); ++i) {
    if (std::abs(published[i] - fixed[i]) < 1e-12) continue;
    ++different;
    CHECK(i % 263 == 0);
    CHECK(published[i] == Approx(-fixed[i]));
  }
  CHECK(different == 1);
}

TEST_CASE("guoh3d: the heading of the first frame, and hips the wrong way round") {
  // It stands with the shoulders 0.3 radians ahead of the hips: the published heading overshoots the shoulders.
  auto motion = synthetic::walk({.frames = 40}, ml::humanml3d22_skeleton());
  std::fill(motion.local.begin(), motion.local.end(), ml::Quaternion<double>::identity());
  for (ml::Index f = 0; f < motion.frames(); ++f) motion.rotations(f)[3] = synthetic::about_y(0.3);  // spine1
  const auto joints = motion.positions();
  const auto published = features(joints);
  const auto legacy = ml::guoh3d_root(view(published)).turn[1],
             right = ml::guoh3d_root(
                         view(features(joints, {.rotations = {.facing = {.sigma = 20, .legacy_forward = false}}})))
                         .turn[1];
  CHECK(ml::distance(legacy, ml::Quaternion<double>::identity()) > 0.2);  // although nothing moves
  CHECK(ml::distance(right, ml::Quaternion<double>::identity()) < 1e-6);
  CHECK(std::abs(published[0]) > 0.1);
  const auto first = features(joints, {.rotations = {.facing = {.sigma = 20}, .fix_first_frame = true}});
  CHECK(first[0] == Approx(0));
}

TEST_CASE("guoh3d: a bone opposite to its zero direction") {
  const auto& skeleton = ml::humanml3d_chains();
  auto joints = walk(6);
  for (std::size_t t = 0; t < 6; ++t)
    joints[22 * t + 20] = joints[22 * t + 18] + ml::Vec3{0.0, 0.25, 0.0};  // left arm up
  const auto published = features(joints), corrected = features(joints, ml::guoh3d_corrected());
  CHECK(std::isnan(published[67 + 6 * 19]));
  for (const double x : corrected) CHECK(std::isfinite(x));
  const auto offsets = ml::chain_offsets<double>(skeleton, view(skeleton.lengths));
  CHECK(largest_distance(ml::guoh3d_joints(view(corrected)),
                         ml::guoh3d_joints_from_rotations(skeleton, view(corrected), view(offsets))) < 1e-9);
}

TEST_CASE("guoh3d: another body") {  // HumanML3D's without wrists
  auto skeleton = ml::humanml3d_chains();
  skeleton.name = "no wrists";
  skeleton.chains[3] = {9, 14, 17, 19};
  skeleton.chains[4] = {9, 13, 16, 18};
  skeleton.directions.resize(20);
  skeleton.lengths.resize(20);
  const auto joints = walk(20, 0.5);
  Joints<double> fewer;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (i % 22 < 20) fewer.push_back(joints[i]);
  }
  const auto rows = ml::guoh3d_features(skeleton, view(fewer)), all = features(joints);
  const ml::Guoh3dSlots slots{20}, whole;
  REQUIRE(std::ssize(rows) == 19 * slots.size());
  const auto groups = slots.groups(), of_whole = whole.groups();
  for (ml::Index t = 0; t < 19; ++t) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (ml::Index i = 0; i < groups[g].size(); ++i) {
        CHECK(rows[static_cast<std::size_t>(t * slots.size() + groups[g].begin + i)] ==
              Approx(all[static_cast<std::size_t>(t * whole.size() + of_whole[g].begin + i)]).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("guoh3d: in the mirror left feet are right feet") {
  const auto joints = walk(30);
  const auto partners = ml::humanml3d_mirror_partners(22);
  const auto mirrored = ml::mirror_joints(view(joints), view(partners));
  auto skeleton = ml::humanml3d_chains();  // whose left and right lengths differ
  skeleton.lengths = ml::bone_lengths(skeleton, view(joints).first(22));
  CHECK(ml::guoh3d_contacts(skeleton, view(mirrored), skeleton.left_foot) ==
        ml::guoh3d_contacts(skeleton, view(joints), skeleton.right_foot));
  const auto rows = ml::guoh3d_features(skeleton, view(joints)),
             mirror_rows = ml::guoh3d_features(skeleton, view(mirrored));
  double turned = 0;
  for (std::size_t t = 0; t < 29; ++t) {
    CHECK(mirror_rows[263 * t] == Approx(-rows[263 * t]).epsilon(1e-6));
    turned += std::abs(rows[263 * t]);
  }
  CHECK(turned > 0.01);
}

TEST_CASE("guoh3d: deviations of the population, by group, without clips that are not finite") {
  ml::FeatureStatistics statistics;
  const std::vector<double> clip{1, 10, 3, 30}, broken{1, std::nan("")};
  CHECK(statistics.add_finite(view(clip), 2));
  CHECK(!statistics.add_finite(view(broken), 2));
  CHECK(statistics.count() == 2);
  CHECK(statistics.mean() == std::vector<double>{2, 20});
  CHECK(statistics.population_deviation() == std::vector<double>{1, 10});
  CHECK(statistics.standard_deviation()[0] == Approx(std::sqrt(2)));
  const std::vector<ml::IndexRange> groups{{0, 1}, {1, 4}}, outside{{3, 5}}, empty{{1, 1}};
  CHECK(ml::group_means({5, 1, 2, 6}, groups) == std::vector<double>{5, 3, 3, 3});
  CHECK_ERROR(ml::group_means({5, 1, 2, 6}, outside), "[motionlang.shape.203] group_means: the group 3:5 of 4 values");
  CHECK_ERROR(ml::group_means({5, 1}, empty), "[motionlang.shape.203]");
  CHECK_ERROR(ml::FeatureStatistics().population_deviation(), "[motionlang.numeric.302]");
}

TEST_CASE("guoh3d: what is refused") {
  const auto& skeleton = ml::humanml3d_chains();
  auto joints = walk(4);
  CHECK_ERROR(features({joints.begin(), joints.begin() + 22}), "[motionlang.shape.205] guoh3d_from_grounded: 1 frames");
  CHECK_ERROR(features({}), "[motionlang.shape.205] guoh3d_from_grounded: 0 frames");
  CHECK_ERROR(features({joints.begin(), joints.begin() + 45}),
              "[motionlang.shape.205] uniform_skeleton: 45 values are not frames of 22 joints");
  CHECK_ERROR(ml::guoh3d_features(skeleton, view(joints), view(std::vector<double>(21, 1.0))),
              "[motionlang.shape.204] uniform_skeleton: 21 lengths for 22 joints");
  CHECK_ERROR(ml::guoh3d_features(ml::kit_chains(), view(Joints<double>(42))),
              "[motionlang.config.101] guoh3d_features: 'KIT' has 0 bone lengths for 21 joints");
  CHECK_ERROR(features(joints, {.rotations = {.facing = {.sigma = -1}}}), "[motionlang.config.101]");
  joints[2 * 22 + 5].y = std::nan("");
  CHECK_ERROR(features(joints), "[motionlang.numeric.301] 'HumanML3D' frame 2: the bone from joint 2 to 5 has length");
  joints[2 * 22 + 5] = joints[2 * 22 + 2];
  CHECK_ERROR(features(joints),
              "[motionlang.numeric.302] 'HumanML3D' frame 2: the bone from joint 2 to 5 has length 0");

  const std::vector<double> rows(264);
  CHECK_ERROR(ml::guoh3d_joints(view(rows)), "[motionlang.shape.205] guoh3d_root: 264 values are not rows of 263");
  CHECK_ERROR(ml::guoh3d_joints(view(rows), 0), "[motionlang.config.101] guoh3d_root: 0 joints");
  CHECK_ERROR(ml::guoh3d_joints_from_rotations(skeleton, view(rows).first(263), view(Joints<double>(21))),
              "[motionlang.shape.204] chain_forward_kinematics: 1 frames of 22 joints, 1 root positions, 21 offsets");
  CHECK_ERROR(ml::guoh3d_contacts(skeleton, view(joints), {7, 22}),
              "[motionlang.shape.203] guoh3d_contacts: joint 22 of 22");
}
