// The joints by which motions are compared.
#include <doctest/doctest.h>

#include <motionlang/backend/reference.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/train/compared_joints.hpp>
#include <motionlang/train/temos_evaluation.hpp>

#include "../../support/body_arrays.hpp"
#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

TEST_CASE("joints of our own skeleton are in metres, whatever the type of the numbers is") {
  const auto walk = synthetic::walk({.frames = 5, .fps = 30});
  const auto rows = ml::motion_features("smplvelp").from_motion(walk);
  const std::vector<float> values(rows.begin(), rows.end());
  const auto clip = ml::smplvelp_inverse(std::span<const float>(values));
  const ml::ComparedJoints<B> joints_of("smplnh"), mmm("mmmns");
  CHECK(!joints_of.has_body());
  const auto joints = joints_of(clip), fewer = mmm(clip);
  CHECK(joints.size() == 22 * clip.trans.size());
  CHECK(fewer.size() == 21 * clip.trans.size());
  CHECK(ml::norm(joints[0] - ml::vec_cast<double>(clip.trans[0])) < 1e-6);
  const double leg = ml::norm(joints[1] - joints[4]);  // from hip to knee
  CHECK(leg > 0.3);
  CHECK(leg < 0.5);
  const auto in_double = ml::smplvelp_inverse(std::span<const double>(rows));
  const auto same = joints_of(in_double);
  REQUIRE(same.size() == joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) CHECK(ml::norm(joints[i] - same[i]) < 1e-5);
  CHECK_ERROR(ml::ComparedJoints<B>("smpl")(clip), "[motionlang.config.103]");
}

TEST_CASE("only SMPL-H is compared as published") {
  const TemporaryFolder folder;
  ml::write_npz(folder / "small.npz", body_arrays::chain(24, 4, 10));
  CHECK_ERROR(ml::ComparedJoints<B>("smplnh", folder / "small.npz"),
              "small.npz: a body of 24 joints and 4 vertices; BABEL is measured on SMPL-H's 52 and 6890");
  CHECK_ERROR(ml::ComparedJoints<B>("smplnh", folder / "nowhere.npz"), "[motionlang.io.401]");
}

TEST_CASE("joints at another rate are interpolated linearly") {
  const ml::JointFrames two{{0, 1, 0}, {5, 5, 5}, {8, 1, 4}, {5, 5, 5}};  // two frames of two joints
  const auto dense = ml::joints_at_rate(two, 2, 12.5, 100);
  REQUIRE(dense.size() == 2 * 9);
  for (std::size_t t = 0; t < 9; ++t) {
    CHECK(ml::norm(dense[2 * t] - ml::Vec3<double>{static_cast<double>(t), 1, 0.5 * static_cast<double>(t)}) < 1e-12);
    CHECK(dense[2 * t + 1] == ml::Vec3<double>{5, 5, 5});
  }
  CHECK(ml::joints_at_rate(two, 2, 30, 30) == two);
  CHECK(ml::rate_of_errors(12.5) == 100);
  CHECK(ml::rate_of_errors(30) == 30);
  CHECK(ml::rate_of_errors(120) == 120);
  CHECK_ERROR(ml::joints_at_rate(two, 2, 30, 100),
              "[motionlang.config.101] joints of 30 frames per second cannot be interpolated to 100");
  CHECK_ERROR(ml::joints_at_rate(two, 2, 100, 12.5), "[motionlang.config.101]");
}

TEST_CASE("MMM's joints of a model on SMPL: in KIT's units, or in metres") {
  const auto& features = ml::motion_features("smplvelp");
  const auto values = features.from_motion(synthetic::walk({.frames = 6, .fps = 12.5}));
  const std::vector<float> rows(values.begin(), values.end());
  const auto scaled = ml::mmm_joints<B>(features, "mmm"), metres = ml::mmm_joints<B>(features, "mmmns");
  CHECK(scaled.unit == 0.001);
  CHECK(metres.unit == 1);
  CHECK(scaled.variant.joints == 21);
  const auto small = scaled(rows), large = metres(rows);
  REQUIRE(small.size() == 21 * 6);
  REQUIRE(large.size() == small.size());
  for (std::size_t i = 0; i < small.size(); ++i)
    CHECK(ml::norm((small[i] - small[0]) - 640.0 * (large[i] - large[0])) < 1e-2);
  CHECK(large[3].y - large[0].y > 0.3);  // Y up: the neck is above the root
  CHECK_ERROR(ml::mmm_joints<B>(ml::motion_features("rifke64"), "mmm"),
              "[motionlang.config.102] MMM's joints of SMPL need a model of smplvelp, this one has 'rifke64'");
  CHECK_ERROR(ml::mmm_joints<B>(features, "smplnh"), "[motionlang.config.103] joints 'smplnh' are not mmm or mmmns");
}

TEST_CASE("a text is found among those of a motion") {
  const ml::DescribedMotion motion{"a", "a", {0, 1, 2, 3, 4, 5}, {{"walk", {0, 3}}, {"sit", {1, 2}}}};
  const auto rows = ml::rows_of_text(motion, "sit", 2);
  REQUIRE(rows.size() == 4);
  CHECK(rows.front() == 2.0f);
  CHECK_ERROR(ml::rows_of_text(motion, "jump", 2), "[motionlang.config.102] a has no text 'jump'");
}

TEST_CASE("TEMOS measures MMM's joints in its own units, SMPL's in metres") {
  const ml::TemosJoints smpl(ml::motion_features("guoh3d")), mmm(ml::motion_features("rifke64"));
  CHECK(!smpl.mmm);
  CHECK(smpl.unit == 1);
  CHECK(smpl.variant.joints == 22);
  CHECK(mmm.mmm);
  CHECK(mmm.unit == 0.001);
  const auto walk = synthetic::walk({.frames = 8, .fps = 20});
  const auto values = smpl.features.from_motion(walk);
  const std::vector<float> rows(values.begin(), values.end());
  const auto joints = smpl(rows);
  CHECK(std::ssize(joints) == smpl.features.joints * (std::ssize(rows) / smpl.features.width));
  double highest = 0;
  for (const auto& p : joints) highest = std::max(highest, p.z);  // Z up
  CHECK(highest > 1.3);
  CHECK(highest < 2);

  const ml::DescribedMotion motion{"a", "a", rows, {{"walk", {2, 3}}, {"all", {0, 7}}}};
  const auto part = ml::first_text_rows(motion, smpl.features.width);
  CHECK(std::ssize(part) == 3 * smpl.features.width);
  CHECK(part.data() == motion.rows.data() + 2 * smpl.features.width);
}
