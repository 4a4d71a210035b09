// SINC: two motions put together by body parts; which parts move by themselves.
#include <doctest/doctest.h>

#include <cmath>    // asin
#include <sstream>  // prints sets of parts

#include <motionlang/compose/sinc_composition.hpp>
#include <motionlang/kinematics/sinc_part_motion.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using enum ml::SincPart;

namespace {

/// Rotations and places that tell which motion, frame and joint they are of.
ml::SmplVelpMotion<double> marked(double mark, std::size_t frames) {
  ml::SmplVelpMotion<double> out;
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t j = 0; j < 22; ++j) {
      auto& r = out.rotations.emplace_back();
      r.m.fill(mark), r.m[0] = static_cast<double>(f), r.m[1] = static_cast<double>(j);
    }
    out.trans.push_back({mark, static_cast<double>(f), 0});
  }
  return out;
}
double owner(const ml::SmplVelpMotion<double>& m, std::size_t joint) { return m.rotations[joint].m[8]; }

}  // namespace

TEST_CASE("SINC composition: the worked cases of the specification") {
  const auto a = marked(1, 5), b = marked(2, 8);
  const auto walk = ml::sinc_parts(global, left_leg, right_leg), wave = ml::sinc_parts(right_arm),
             clap = ml::sinc_parts(left_arm, right_arm), kick = ml::sinc_parts(right_leg), turn = ml::sinc_parts(torso);
  const std::size_t pelvis = 0, left_foot = 10, spine = 3, left_wrist = 20, right_wrist = 21;
  const auto waves = ml::compose_motions(a, walk, b, wave);
  CHECK(waves.trans.size() == 5);
  CHECK(owner(waves, right_wrist) == 2);
  for (std::size_t j : {pelvis, left_foot, spine, left_wrist}) CHECK(owner(waves, j) == 1);
  CHECK(waves.trans[0].x == 1);
  const auto kicks = ml::compose_motions(a, clap, b, kick);
  for (std::size_t j : {pelvis, left_foot}) CHECK(owner(kicks, j) == 2);
  for (std::size_t j : {spine, left_wrist, right_wrist}) CHECK(owner(kicks, j) == 1);
  CHECK(kicks.trans[0].x == 2);
  const auto turns = ml::compose_motions(a, turn, b, wave);
  CHECK(owner(turns, right_wrist) == 2);
  CHECK(owner(turns, spine) == 1);
  CHECK(turns.trans[0].x == 1);
  const auto swapped = ml::compose_motions(b, wave, a, walk);
  CHECK(owner(swapped, right_wrist) == 2);
  CHECK(owner(swapped, spine) == 1);
}

TEST_CASE("SINC composition: the longer motion is cut") {
  const auto a = marked(1, 5), b = marked(2, 8);
  const auto parts = ml::sinc_parts(right_arm);
  const auto first_frame = [&](ml::SincTrim trim) {
    return ml::compose_motions(a, parts, b, parts, trim).rotations[21].m[0];
  };
  CHECK(first_frame(ml::SincTrim::end) == 0);
  CHECK(first_frame(ml::SincTrim::both_ends) == 1);
  CHECK(ml::compose_motions(a, parts, {}, parts).trans.empty());
  auto broken = a;
  broken.trans.pop_back();
  CHECK_ERROR(ml::compose_motions(b, parts, broken, parts), "[motionlang.shape.205] compose_motions: 110");
}

TEST_CASE("SINC: moving parts by speed") {
  std::vector<ml::Vec3<double>> joints(3 * 22);
  for (std::size_t f = 0; f < 3; ++f) {
    joints[f * 22 + 21].x = static_cast<double>(f) * 4;  // right wrist: a quarter of the right arm
    joints[f * 22 + 3].y = static_cast<double>(f) * 0.5;
  }
  const auto speeds = ml::sinc_part_speeds(std::span<const ml::Vec3<double>>(joints));
  CHECK(speeds == std::array<double, 6>{0, 0.1, 0, 1, 0, 0});
  CHECK(ml::moving_sinc_parts(speeds) == ml::sinc_parts(right_arm));
  CHECK(ml::moving_sinc_parts(speeds, 0.05) == ml::sinc_parts(right_arm, torso));
  CHECK(ml::moving_sinc_parts(std::array<double, 6>{}).none());
  CHECK_ERROR(ml::sinc_part_speeds(std::span<const ml::Vec3<double>>(joints).first(22)), "[motionlang.shape.205]");
}

TEST_CASE("SINC composition: clips on SMPL's joints, hands with their arms") {
  const auto still = [](const ml::Skeleton& skeleton, double angle, double fps = 20) {
    ml::Motion m{skeleton, fps, {{angle, 0, 0}}, {}, "still"};
    m.local.assign(skeleton.names.size(), ml::from_axis_angle(ml::Vec3<double>{0, 0, 1}, angle));
    return m;
  };
  const auto& smpl = ml::smpl24_skeleton();
  const ml::Motion a = still(smpl, 0.1), b = still(smpl, 0.2);
  const auto owner = [](const ml::Motion& m, std::size_t joint) { return 2 * std::asin(m.local[joint].z); };
  const ml::Motion waves = ml::compose_motions(a, ~ml::SincParts{}, b, ml::sinc_parts(left_arm));
  for (const std::size_t j : {13u, 16u, 18u, 20u, 22u}) CHECK(owner(waves, j) == doctest::Approx(0.2));
  for (const std::size_t j : {0u, 1u, 9u, 15u, 21u, 23u}) CHECK(owner(waves, j) == doctest::Approx(0.1));
  CHECK(waves.root[0].x == 0.1);
  const ml::Motion kicks = ml::compose_motions(a, ml::sinc_parts(left_arm, right_arm), b, ml::sinc_parts(left_leg));
  CHECK(owner(kicks, 0) == doctest::Approx(0.2));
  CHECK(owner(kicks, 23) == doctest::Approx(0.1));
  CHECK(kicks.root[0].x == 0.2);
  CHECK_ERROR(ml::compose_motions(a, {}, still(smpl, 0, 30), {}),
              "[motionlang.config.102] compose_motions: 'still' has 24");
  const ml::Motion kit = still(ml::kit21_skeleton(), 0);
  CHECK_ERROR(ml::compose_motions(kit, {}, kit, {}), "is not on SMPL's 24 joints");
}
