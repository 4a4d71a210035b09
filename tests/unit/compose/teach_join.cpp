// TEACH: parts of a motion one behind the other, frames between them.
#include <doctest/doctest.h>

#include <motionlang/compose/teach_join.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using Rotations = std::vector<ml::Matrix3<double>>;
using Places = std::vector<ml::Vec3<double>>;

namespace {

ml::Matrix3<double> heading(double angle) { return ml::axis_rotation(2, angle); }

}  // namespace

TEST_CASE("alignment: the next part goes on where the last frame stands and looks") {
  const Rotations last{heading(1.2), heading(0)};
  const ml::PoseInWorld<double> e{last, {5, 6, 0.9}};
  Rotations part{heading(0.2), heading(0.3), heading(0.4), heading(0.5)};
  Places trans{{1, 0, 0.8}, {1, 1, 0.7}};
  ml::align_to<double>(e, part, trans);
  CHECK(part[0](1, 0) == doctest::Approx(std::sin(1.2)));
  CHECK(part[2](1, 0) == doctest::Approx(std::sin(1.4)));
  CHECK(part[1](1, 0) == doctest::Approx(std::sin(0.3)));  // only the body as a whole turns
  CHECK(trans[0] == ml::Vec3<double>{5, 6, 0.8});          // height stays
  CHECK(trans[1].x == doctest::Approx(5 - std::sin(1.0)));
  CHECK(trans[1].y == doctest::Approx(6 + std::cos(1.0)));
  CHECK(trans[1].z == 0.7);
}

TEST_CASE("alignment by translation only; refused sizes") {
  const Rotations last{heading(1.2)};
  const ml::PoseInWorld<double> e{last, {5, 6, 0.9}};
  Rotations part{heading(0.2), heading(0.4)}, none;
  const Rotations before = part;
  Places trans{{1, 0, 0.8}, {1, 1, 0.7}}, nowhere;
  ml::align_to<double>(e, part, trans, ml::Alignment::translation);
  CHECK(part[1].m == before[1].m);
  CHECK(trans[1] == ml::Vec3<double>{5, 7, 0.7});
  ml::align_to<double>(e, none, nowhere);  // nothing to move
  CHECK_ERROR(ml::align_to<double>(e, part, nowhere), "[motionlang.shape.205] align_to: 2 rotations for 0 frames");
}

TEST_CASE("slerp window: even steps the shorter way round") {
  const Rotations a{heading(0.1), heading(-3.0)}, b{heading(1.1), heading(3.0)};
  const auto window = ml::slerp_window<double>({a, {0, 0, 0}}, {b, {4, 8, 0}}, 3);
  REQUIRE(window.rotations.size() == 6);
  CHECK(window.rotations[0](1, 0) == doctest::Approx(std::sin(0.35)));
  CHECK(window.rotations[4](1, 0) == doctest::Approx(std::sin(0.85)));
  const double pi = std::numbers::pi;
  CHECK(window.rotations[3](0, 0) == doctest::Approx(std::cos(pi)));  // through the back, not through the front
  CHECK(window.trans[2] == ml::Vec3<double>{3, 6, 0});
  CHECK_ERROR(ml::slerp_window<double>({a, {}}, {{}, {}}, 3), "[motionlang.shape.205] slerp_window: 2 and 0 joints");
}

TEST_CASE("parts of a motion: each goes on where the one before it ends, and the frames between are filled") {
  const Rotations given{heading(0), heading(0), heading(2), heading(2), heading(2.5), heading(1)};
  const Places trans{{0, 0, 1}, {2, 0, 1}, {9, 9, 9}, {5, 5, 3}, {6, 5, 3}, {7, 7, 1}};
  const std::vector<ml::Index> lengths{2, 3, 1};
  ml::SmplVelpMotion<double> motion{given, trans};
  ml::join_parts<double>(motion, lengths);
  CHECK(motion.trans[2] == ml::Vec3<double>{2, 0, 9});
  CHECK(motion.rotations[2](1, 0) == doctest::Approx(0));
  CHECK(motion.rotations[5](1, 0) == doctest::Approx(std::sin(0.5)));  // as the part before it ends, which has turned
  const auto first = std::vector<ml::Index>{2, 3};
  motion = {Rotations(given.begin(), given.end() - 1), Places(trans.begin(), trans.end() - 1)};
  ml::join_parts<double>(motion, first, 1, ml::Alignment::translation);
  CHECK(motion.trans[2] == ml::Vec3<double>{2, 0, 2});  // between (2, 0, 1) and (2, 0, 3)
  CHECK(motion.trans[4] == ml::Vec3<double>{3, 0, 3});
  CHECK(motion.rotations[2](1, 0) == doctest::Approx(std::sin(1.0)));
  CHECK(motion.rotations[4](1, 0) == doctest::Approx(std::sin(2.5)));
  CHECK_ERROR(ml::join_parts<double>(motion, lengths), "[motionlang.shape.205] join_parts: part 2 of 1 frames");
  CHECK_ERROR(ml::join_parts<double>(motion, first, -1), "[motionlang.config.101] join_parts: a window of -1 frames");
  CHECK_ERROR(ml::join_parts<double>(motion, first, 3),
              "[motionlang.shape.205] join_parts: part 1 of 3 frames, window 3");
  const std::vector<ml::Index> one{2};
  CHECK_ERROR(ml::join_parts<double>(motion, one), "[motionlang.shape.205] join_parts: parts of 2 frames, motion of 5");
}
