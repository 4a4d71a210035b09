// Editing clips: crop, resample, speed, joining, mirror, the T-pose in front of CMU files; smoothing of curves.
#include <doctest/doctest.h>

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;

namespace {

/// A clip with `frames` inserted frames in front: the zero pose, then equal parts of the way to the first pose.
ml::Motion with_lead_in(const ml::Motion& motion, int frames) {
  ml::Motion out = motion;
  const auto first = motion.rotations(0);
  for (int i = frames - 1; i >= 0; --i) {
    std::vector<ml::Quaternion<double>> pose;
    for (const auto& q : first) pose.push_back(ml::slerp(ml::Quaternion<double>::identity(), q, i / double(frames)));
    out.local.insert(out.local.begin(), pose.begin(), pose.end());
    out.root.insert(out.root.begin(), motion.root[0]);
  }
  return out;
}

}  // namespace

TEST_CASE("crop takes frames first to last - 1") {
  const auto walk = synthetic::walk({.frames = 10});
  const auto part = ml::crop(walk, 3, 7);
  REQUIRE(part.frames() == 4);
  CHECK(part.root_at(0) == walk.root_at(3));
  CHECK(part.rotations(3)[5] == walk.rotations(6)[5]);
  CHECK(ml::crop(walk, 10, 10).frames() == 0);
  CHECK_THROWS_WITH_AS(ml::crop(walk, 3, 11), Contains("[motionlang.shape.203]"), ml::shape_error);
  CHECK_THROWS_AS(ml::crop(walk, 4, 3), ml::shape_error);
  CHECK_THROWS_AS(ml::crop(walk, -1, 3), ml::shape_error);
}

TEST_CASE("resample: frame i is the moment i / fps") {
  const auto walk = synthetic::walk({.frames = 61, .fps = 60});
  CHECK(ml::resample(walk, 20).frames() == 21);
  CHECK(ml::resample(walk, 120).frames() == 121);
  CHECK(ml::resample(walk, 25).frames() == 26);
  CHECK(ml::resample(walk, 60).local == walk.local);
  const auto third = ml::resample(walk, 20);
  for (ml::Index f = 0; f < third.frames(); ++f) {
    CHECK(third.root_at(f) == walk.root_at(3 * f));
    CHECK(third.rotations(f)[4] == walk.rotations(3 * f)[4]);
  }
  CHECK(ml::resample(ml::resample(walk, 180), 60).local == walk.local);
}

TEST_CASE("resample interpolates the root in a line and rotations on the arc") {
  ml::Motion motion{ml::Skeleton::from_joints({{"r", "", {0, 1, 0}}}), 10, {{0, 0, 0}, {2, 4, -6}}, {}, ""};
  motion.local = {ml::from_axis_angle(ml::Vec3{0.0, 0.0, 1.0}, 0.2),
                  -ml::from_axis_angle(ml::Vec3{0.0, 0.0, 1.0}, 1.0)};
  const auto fine = ml::resample(motion, 40);
  REQUIRE(fine.frames() == 5);
  CHECK(fine.fps == 40);
  CHECK(ml::norm(fine.root_at(1) - ml::Vec3{0.5, 1.0, -1.5}) < 1e-12);
  CHECK(ml::distance(fine.local[1], ml::from_axis_angle(ml::Vec3{0.0, 0.0, 1.0}, 0.4)) < 1e-12);
  CHECK(ml::resample(ml::crop(motion, 0, 1), 7).frames() == 1);
  CHECK(ml::resample(ml::crop(motion, 0, 0), 7).frames() == 0);
  CHECK_THROWS_WITH_AS(ml::resample(motion, 0), Contains("[motionlang.config.101]"), ml::config_error);
}

TEST_CASE("change_speed keeps the rate and changes the length") {
  const auto walk = synthetic::walk({.frames = 41});
  const auto fast = ml::change_speed(walk, 2), slow = ml::change_speed(walk, 0.5);
  CHECK(fast.frames() == 21);
  CHECK(slow.frames() == 81);
  CHECK(fast.fps == walk.fps);
  CHECK(fast.root_at(10) == walk.root_at(20));
  CHECK_THROWS_WITH_AS(ml::change_speed(walk, -1), Contains("[motionlang.config.101]"), ml::config_error);
}

TEST_CASE("a rate that was typed wrong is refused before memory is taken") {
  const auto walk = synthetic::walk({.frames = 41});
  for (const double rate : {2e6, 1e9, 1e300}) {  // 2 s of 24 joints: from 1.04e6 on
    CHECK_THROWS_WITH_AS(ml::resample(walk, rate), Contains("[motionlang.config.101] resample: 'walk' of 2.05 s at "),
                         ml::config_error);
  }
  CHECK_THROWS_WITH_AS(ml::change_speed(walk, 1e-9), Contains("frames of 24 joints, more than"), ml::config_error);
}

TEST_CASE("concatenate joins clips of one skeleton and one rate") {
  const auto walk = synthetic::walk({.frames = 12});
  const auto whole = ml::concatenate(ml::crop(walk, 0, 5), ml::crop(walk, 5, 12));
  CHECK(whole.local == walk.local);
  CHECK(whole.root == walk.root);
  auto other = walk;
  other.fps = 30;
  CHECK_THROWS_WITH_AS(ml::concatenate(walk, other), Contains("[motionlang.config.102]"), ml::config_error);
}

TEST_CASE("mirror: every position is the image of its partner's, twice is nothing") {
  const auto walk = synthetic::walk({.frames = 20, .turn = 1});
  const auto image = ml::mirror(walk);
  CHECK(ml::mirror_partners(walk.skeleton) ==
        std::vector<int>(ml::smpl_mirror_joint.begin(), ml::smpl_mirror_joint.end()));
  CHECK(image.skeleton == walk.skeleton);
  const auto p = walk.positions(), q = image.positions();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t other = i / 24 * 24 + static_cast<std::size_t>(ml::smpl_mirror_joint[i % 24]);
    CHECK(ml::norm(ml::Vec3{-p[i].x, p[i].y, p[i].z} - q[other]) < 1e-12);
  }
  CHECK(synthetic::largest_distance(ml::mirror(image), walk) < 1e-12);
}

TEST_CASE("mirror: also for skeletons that are not symmetric") {
  auto walk = synthetic::walk({.frames = 5});
  walk.skeleton.offsets[4] = {0.02, -0.5, 0.01};
  const auto p = walk.positions(), q = ml::mirror(walk).positions();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t other = i / 24 * 24 + static_cast<std::size_t>(ml::smpl_mirror_joint[i % 24]);
    CHECK(ml::norm(ml::Vec3{-p[i].x, p[i].y, p[i].z} - q[other]) < 1e-12);
  }
}

TEST_CASE("partners are found by the usual marks") {
  const auto partners = [](std::vector<std::string> names) {
    std::vector<int> parents(names.size(), 0);
    parents[0] = -1;
    const std::vector<ml::Vec3<double>> offsets(names.size());
    return ml::mirror_partners(ml::Skeleton::from_arrays(names, parents, offsets));
  };
  CHECK(partners({"root", "lThigh", "rThigh", "lowerback"}) == std::vector<int>{0, 2, 1, 3});
  CHECK(partners({"Hips", "LHipJoint", "RHipJoint", "LeftArm", "RightArm"}) == std::vector<int>{0, 2, 1, 4, 3});
  CHECK(partners({"Hips", "Foot_L", "Foot_R"}) == std::vector<int>{0, 2, 1});
  CHECK(partners({"pelvis", "thigh.L", "thigh.R"}) == std::vector<int>{0, 2, 1});
  CHECK(partners({"root", "lfemur", "rfemur", "lowerneck"}) == std::vector<int>{0, 2, 1, 3});
  CHECK(partners({"J_Bip_C_Hips", "J_Bip_L_UpperLeg", "J_Bip_R_UpperLeg"}) == std::vector<int>{0, 2, 1});
  CHECK(partners({"Bip01", "Bip01 L Thigh", "Bip01 R Thigh"}) == std::vector<int>{0, 2, 1});
  CHECK_THROWS_WITH_AS(partners({"root", "left_arm"}), Contains("[motionlang.config.103]"), ml::config_error);
}

TEST_CASE("mirror refuses invalid partners") {
  const auto walk = synthetic::walk({.frames = 2});
  std::vector<int> partners = ml::mirror_partners(walk.skeleton);
  CHECK_THROWS_WITH_AS(ml::mirror(walk, std::span(partners).first(3)), Contains("[motionlang.config.102]"),
                       ml::config_error);
  partners[1] = 5;
  CHECK_THROWS_WITH_AS(ml::mirror(walk, partners), Contains("'left_hip'"), ml::config_error);
  partners[1] = -7;
  CHECK_THROWS_AS(ml::mirror(walk, partners), ml::config_error);
  partners = ml::mirror_partners(walk.skeleton);
  std::swap(partners[4], partners[7]), std::swap(partners[5], partners[8]);  // knees and ankles
  CHECK_THROWS_AS(ml::mirror(walk, partners), ml::config_error);
}

TEST_CASE("an inserted T-pose is found: one frame, or a blend and its overshoot") {
  const auto walk = synthetic::walk({.frames = 90, .fps = 60});
  CHECK(ml::detect_t_pose_lead_in(walk) == 0);
  CHECK(ml::detect_t_pose_lead_in(with_lead_in(walk, 1)) == 1);
  CHECK(ml::detect_t_pose_lead_in(with_lead_in(walk, 2)) == 4);
  CHECK(synthetic::largest_distance(ml::drop_lead_in(with_lead_in(walk, 1)), walk) == 0);
  auto held = with_lead_in(walk, 1);
  const auto pose = ml::crop(held, 0, 1);
  for (int frames = 2; frames < 80; ++frames) {
    held = ml::concatenate(pose, held);
    CHECK(ml::detect_t_pose_lead_in(held) == frames);
  }
}

TEST_CASE("a performer who starts in a T-pose is left alone") {
  auto slow = with_lead_in(synthetic::walk({.frames = 60, .fps = 60}), 60);  // lowers the arms for a second
  CHECK(ml::detect_t_pose_lead_in(slow) == 0);
  ml::Motion still = ml::crop(slow, 0, 1);
  for (int i = 0; i < 5; ++i) still = ml::concatenate(still, still);
  CHECK(ml::detect_t_pose_lead_in(still) == 0);
  CHECK(ml::detect_t_pose_lead_in(ml::crop(still, 0, 1)) == 0);
  CHECK(ml::detect_t_pose_lead_in(ml::crop(still, 0, 0)) == 0);
}

TEST_CASE("gaussian_smooth: a constant stays, a spike becomes the kernel, ends are continued") {
  const std::vector<double> constant(20, 3.0);
  for (const double v : ml::gaussian_smooth<double>(constant, 2, 1.5)) CHECK(v == Approx(3.0));
  std::vector<float> spike(22, 0.0f);
  spike[2 * 5 + 1] = 1;
  const auto smooth = ml::gaussian_smooth<float>(spike, 2, 1.0);
  double sum = 0;
  for (int k = -4; k <= 4; ++k) sum += std::exp(-0.5 * k * k);
  for (int t = 0; t < 11; ++t) {
    CHECK(smooth[static_cast<std::size_t>(2 * t)] == 0);
    const double wanted = std::abs(t - 5) <= 4 ? std::exp(-0.5 * (t - 5) * (t - 5)) / sum : 0;
    CHECK(smooth[static_cast<std::size_t>(2 * t + 1)] == Approx(wanted).epsilon(1e-6));
  }
  const std::vector<double> step{0, 1};
  CHECK(ml::gaussian_smooth<double>(step, 1, 1.0)[0] + ml::gaussian_smooth<double>(step, 1, 1.0)[1] == Approx(1));
  CHECK(ml::gaussian_smooth<double>(std::vector<double>{}, 3, 1.0).empty());
  CHECK_THROWS_WITH_AS(ml::gaussian_smooth<double>(constant, 2, 0), Contains("[motionlang.config.101]"),
                       ml::config_error);
  CHECK_THROWS_WITH_AS(ml::gaussian_smooth<double>(constant, 3, 1), Contains("[motionlang.shape.205]"),
                       ml::shape_error);
}
