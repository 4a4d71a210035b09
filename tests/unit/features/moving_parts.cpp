// Body parts told from how joints move.
#include <ostream>  // of bitsets in messages

#include <motionlang/features/moving_parts.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"

namespace ml = motionlang;
using doctest::Approx;
using enum ml::SincPart;

TEST_CASE("sinc_part_speeds: of the middle of the joints, over time") {
  std::vector<ml::Vec3<double>> joints(3 * 22);
  // The right arm (13 is the left collar) goes 0.3 and 0.1; two joints of a leg go against each other.
  for (const std::size_t j : {14u, 17u, 19u, 21u}) joints[22 + j] = {0.3, 0, 0}, joints[44 + j] = {0.3, 0.1, 0};
  joints[22 + 1].z = 5, joints[22 + 4].z = -5;
  const auto v = ml::sinc_part_speeds(lists::view(joints));
  CHECK(v[3] == Approx(0.2));
  for (const std::size_t p : {0u, 1u, 2u, 4u, 5u}) CHECK(v[p] == Approx(0));
  CHECK(ml::moving_sinc_parts(v) == ml::sinc_parts(right_arm));
  CHECK_ERROR(ml::sinc_part_speeds(lists::view(joints).first(23)), "[motionlang.shape.205]");
  CHECK_ERROR(ml::sinc_part_speeds(lists::view(joints).first(22)), "[motionlang.numeric.302]");
}

TEST_CASE("moving_sinc_parts: above the threshold between slowest and fastest") {
  const std::array<double, 6> v{1, 2, 1.6, 1.66, 1, 1};
  CHECK(ml::moving_sinc_parts(v) == ml::sinc_parts(torso, right_arm));
  CHECK(ml::moving_sinc_parts(v, 0.5) == ml::sinc_parts(torso, left_arm, right_arm));
  CHECK(ml::moving_sinc_parts(std::array<double, 6>{3, 3, 3, 3, 3, 3}).none());
}
