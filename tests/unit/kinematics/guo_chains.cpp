// Chains of bones: inverse and forward kinematics, bodies of other lengths, mirrored joints, malformed chains.
#include <doctest/doctest.h>

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/chain_kinematics.hpp>
#include <motionlang/kinematics/guo_chains.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/mirror_joints.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/uniform_skeleton.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx;
using lists::largest_distance, lists::view;
using Joints = std::vector<ml::Vec3<double>>;

namespace {

Joints walk(int frames, double turn) {
  return synthetic::walk({.frames = frames, .turn = turn}, ml::humanml3d22_skeleton()).positions();
}
}  // namespace

TEST_CASE("chains: parents are those of the published skeletons") {
  CHECK(ml::humanml3d_chains().parents() == ml::humanml3d22_skeleton().parents);
  CHECK(ml::kit_chains().parents() == ml::kit21_skeleton().parents);
}

TEST_CASE("chains: forward kinematics undoes inverse kinematics, also where bones change their lengths") {
  const auto& skeleton = ml::humanml3d_chains();
  auto joints = walk(30, 2.0);
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i].z += 0.01 * std::sin(static_cast<double>(i));
  Joints root, offsets;
  for (std::size_t at = 0; at < joints.size(); at += 22) {
    root.push_back(joints[at]);
    const auto lengths = ml::bone_lengths(skeleton, view(joints).subspan(at, 22));
    for (const auto& o : ml::chain_offsets<double>(skeleton, view(lengths))) offsets.push_back(o);
  }
  for (const double sigma : {0.0, 20.0}) {
    const auto q = ml::chain_inverse_kinematics(skeleton, view(joints), {.facing = {.sigma = sigma}});
    CHECK(largest_distance(ml::chain_forward_kinematics(skeleton, view(q), view(root), view(offsets)), joints) < 1e-12);
    CHECK(q[0] == ml::Quaternion<double>::identity());
    // Without the root's rotation everything is turned back by it, about the root.
    const auto back = ml::chain_forward_kinematics(skeleton, view(q), view(root), view(offsets), false);
    for (std::size_t i = 22 * 20; i < 22 * 21; ++i) {
      const auto expected = rotate(inverse(q[22 * 20]), joints[i] - joints[22 * 20]);
      CHECK(norm(back[i] - back[22 * 20] - expected) < 1e-12);
    }
  }
}

TEST_CASE("chains: where a body faces") {
  const auto& skeleton = ml::humanml3d_chains();
  auto motion = synthetic::walk({.frames = 10}, ml::humanml3d22_skeleton());
  std::fill(motion.local.begin(), motion.local.end(), ml::Quaternion<double>::identity());
  for (int f = 0; f < 10; ++f) motion.rotations(f)[0] = synthetic::about_y(0.2 * f);
  const auto joints = motion.positions();
  for (const bool legacy : {false, true}) {  // hips and shoulders are parallel
    const auto forward = ml::facing_directions(skeleton, view(joints), {.legacy_forward = legacy});
    for (std::size_t f = 0; f < 10; ++f) {
      const double angle = 0.2 * static_cast<double>(f);
      CHECK(forward[f].x == Approx(std::sin(angle)));
      CHECK(forward[f].z == Approx(std::cos(angle)));
    }
  }
  const auto smooth = ml::facing_directions(skeleton, view(joints), {.sigma = 3});
  CHECK(smooth[0].x > 0.1);  // drawn towards the frames behind
  CHECK(smooth[9].z > std::cos(1.8) + 0.1);
  CHECK(norm(smooth[4]) == Approx(1));
}

TEST_CASE("chains: a uniform skeleton has the lengths and keeps the directions") {
  const auto& skeleton = ml::humanml3d_chains();
  const auto joints = walk(20, 1.0);
  const auto uniform = ml::uniform_skeleton(skeleton, view(joints), view(skeleton.lengths));
  const auto own = ml::bone_lengths(skeleton, view(joints).first(22));
  CHECK(uniform.scale == Approx((skeleton.lengths[5] + skeleton.lengths[8]) / (own[5] + own[8])));
  for (std::size_t at = 0; at < joints.size(); at += 22) {
    CHECK(norm(uniform.joints[at] - uniform.scale * joints[at]) < 1e-12);
    const auto lengths = ml::bone_lengths(skeleton, view(uniform.joints).subspan(at, 22));
    for (std::size_t j = 0; j < 22; ++j) CHECK(lengths[j] == Approx(skeleton.lengths[j]));
  }
  double worst = 0;
  for (const ml::ChainBone& b : skeleton.bones()) {
    for (std::size_t at = 0; at < joints.size(); at += 22) {
      const auto u = normalized(joints[at + b.joint] - joints[at + b.parent]);
      const auto v = normalized(uniform.joints[at + b.joint] - uniform.joints[at + b.parent]);
      worst = std::max(worst, norm(u - v));
    }
  }
  CHECK(worst < 1e-12);
  CHECK(ml::uniform_skeleton(skeleton, std::span<const ml::Vec3<double>>{}, view(skeleton.lengths)).joints.empty());
  CHECK(largest_distance(ml::uniform_skeleton(skeleton, view(joints), view(own)).joints, joints) < 1e-12);
}

TEST_CASE("mirrored joints are those of the mirrored motion") {
  const auto motion = synthetic::walk({.frames = 12, .turn = 1.0}, ml::humanml3d22_skeleton());
  const auto partners = ml::humanml3d_mirror_partners(22);
  CHECK(partners == ml::mirror_partners(ml::humanml3d22_skeleton()));
  const auto joints = motion.positions(), mirrored = ml::mirror_joints(view(joints), view(partners));
  CHECK(largest_distance(mirrored, ml::mirror(motion).positions()) < 1e-12);
  CHECK(ml::mirror_joints(view(mirrored), view(partners)) == joints);
}

TEST_CASE("mirrored hands: fingers as published, and the right ones") {
  const auto published = ml::humanml3d_mirror_partners(52), fixed = ml::humanml3d_mirror_partners(52, true);
  CHECK(published[22] == 43);  // left index, right little finger
  CHECK(fixed[22] == 37);
  for (const auto& partners : {published, fixed}) {
    for (std::size_t j = 0; j < 52; ++j) {
      CHECK(partners[static_cast<std::size_t>(partners[j])] == static_cast<int>(j));
      if (j >= 22) CHECK(partners[j] != static_cast<int>(j));
    }
  }
  CHECK_ERROR(ml::humanml3d_mirror_partners(24), "[motionlang.config.101] humanml3d_mirror_partners: 24 joints");
  const Joints joints(6);
  const std::vector<int> four(4), unpaired{0, 2, 0};
  CHECK_ERROR(ml::mirror_joints(view(joints), view(four)),
              "[motionlang.shape.205] mirror_joints: 6 positions for frames of 4");
  CHECK_ERROR(ml::mirror_joints(view(joints), view(unpaired)), "[motionlang.config.102]");
  CHECK_ERROR(ml::mirror_joints(view(joints), {}), "[motionlang.shape.205]");
}

TEST_CASE("invalid chains are refused") {
  auto broken = [](auto change) {
    auto skeleton = ml::humanml3d_chains();
    change(skeleton);
    return skeleton;
  };
  using Skeleton = ml::ChainSkeleton;
  CHECK_ERROR(broken([](Skeleton& s) { s.chains[0].back() = 22; }).bones(), "[motionlang.config.106]");
  CHECK_ERROR(broken([](Skeleton& s) { s.chains[1] = s.chains[0]; }).bones(), "joint 2 of chain 1 has a bone already");
  CHECK_ERROR(broken([](Skeleton& s) { std::swap(s.chains[2], s.chains[3]); }).bones(),
              "joint 9 of chain 2 begins it, but no chain before contains it");
  CHECK_ERROR(broken([](Skeleton& s) { s.chains.pop_back(); }).bones(), "bones end at 17 of 21 joints");
  CHECK_ERROR(broken([](Skeleton& s) { s.directions[4].y = -2; }).bones(), "the direction of joint 4 has length 2");
  CHECK_ERROR(broken([](Skeleton& s) { s.face[0] = -1; }).bones(), "no joint -1 among 22");
  CHECK_ERROR(Skeleton{}.bones(), "no joints");

  const auto& skeleton = ml::humanml3d_chains();
  const Joints joints(23);
  const std::vector<double> lengths(21);
  CHECK_ERROR(ml::bone_lengths(skeleton, view(joints)),
              "[motionlang.shape.205] bone_lengths: 23 joints for a skeleton of 22");
  CHECK_ERROR(ml::chain_offsets<double>(skeleton, view(lengths)),
              "[motionlang.shape.204] chain_offsets: 21 lengths for 22");
  CHECK_ERROR(ml::facing_directions(skeleton, view(joints)), "[motionlang.shape.205]");
  const auto faceless = broken([](Skeleton& s) { s.face[3] = 22; });
  CHECK_ERROR(ml::facing_directions(faceless, view(joints).first(22)), "[motionlang.config.106]");
  const std::vector<ml::Quaternion<double>> q(22);
  CHECK_ERROR(ml::guo::continuous(view(q), 4),
              "[motionlang.shape.205] continuous: 22 rotations for frames of 4 joints");
}

TEST_CASE("the published slerp takes the long way, the general one the short way") {
  const auto a = synthetic::about_y(0.2), b = -synthetic::about_y(0.6);
  CHECK(ml::distance(ml::slerp(a, b, 0.5), synthetic::about_y(0.4)) < 1e-12);
  CHECK(ml::distance(ml::guo::slerp(a, b, 0.5), synthetic::about_y(0.4)) == Approx(std::numbers::pi));
  CHECK(ml::distance(ml::guo::slerp(a, -b, 0.5), synthetic::about_y(0.4)) < 1e-12);
  const auto opposite = ml::guo::between(ml::Vec3{0.0, 1.0, 0.0}, ml::Vec3{0.0, -1.0, 0.0});
  CHECK(std::isnan(opposite.w));
}
