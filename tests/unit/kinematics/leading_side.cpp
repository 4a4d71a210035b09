// The side to which a figure turns, and the arm or leg that does more.
#include <doctest/doctest.h>

#include <motionlang/kinematics/leading_side.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using enum ml::BodyPart;
using ml::Side;

namespace {

const auto arms = ml::BodyParts{}.with(left_arm).with(right_arm), only_legs = ml::BodyParts{}.with(legs);

/// A second of standing still, with the turns of one joint about x.
ml::Motion stand(std::size_t joint = 0, double angle = 0, double swing = 0) {
  ml::Motion m{ml::smpl24_skeleton(), 20, {}, {}, "stand"};
  for (int f = 0; f < 20; ++f) {
    m.root.push_back({0, 1, 0});
    m.local.insert(m.local.end(), 24, ml::Quaternion<double>::identity());
    if (joint > 0) m.rotations(f)[joint] = synthetic::about_x(angle + swing * std::sin(f));
  }
  return m;
}

/// The same side in the clip and the other one in its mirror image.
void check(const ml::Motion& motion, ml::BodyParts parts, Side side) {
  CHECK(ml::leading_side(motion, parts) == side);
  CHECK(ml::leading_side(ml::mirror(motion), parts) == (side == Side::left ? Side::right : Side::left));
}

}  // namespace

TEST_CASE("the side to which a figure turns comes first") {
  check(synthetic::walk({.turn = 0.5}), ml::BodyParts::all(), Side::left);  // 86 degrees in three seconds
  check(synthetic::walk({.turn = 3}), {}, Side::left);                      // further than once round
  CHECK(ml::leading_side(synthetic::walk({.turn = 0.3}), {}) == Side::middle);
}

TEST_CASE("then the arm that moves more, the raised arm, and the raised leg, if these parts act") {
  constexpr std::size_t left_hip = 1, left_elbow = 18, right_shoulder = 17;
  auto swung = stand(left_elbow);
  for (int f = 0; f < 20; ++f) swung.rotations(f)[left_elbow] = synthetic::about_y(0.8 * std::sin(f));
  check(swung, arms, Side::left);
  CHECK(ml::leading_side(swung, only_legs) == Side::middle);

  auto raised = stand();
  for (int f = 0; f < 20; ++f) raised.rotations(f)[right_shoulder] = synthetic::about_z(-1);
  check(raised, arms, Side::right);

  const auto kick = stand(left_hip, -0.8, 0.8);
  check(kick, only_legs, Side::left);
  CHECK(ml::leading_side(kick, arms) == Side::middle);
}

TEST_CASE("no side leads a walk straight ahead, nor a figure that stands") {
  CHECK(ml::leading_side(synthetic::walk(), ml::BodyParts::all()) == Side::middle);
  CHECK(ml::leading_side(stand(), ml::BodyParts::all()) == Side::middle);
}

TEST_CASE("other skeletons are refused") {
  auto other = stand();
  std::swap(other.skeleton.names[20], other.skeleton.names[21]);
  CHECK_ERROR(ml::leading_side(other, arms), "[motionlang.config.103] leading_side: 'stand'");
}
