// The box around positions.
#include <doctest/doctest.h>

#include <motionlang/geometry/box.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("a box has the smallest and the largest of each coordinate") {
  const std::vector<ml::Vec3<double>> positions{{1, -2, 3}, {-4, 5, 0}, {0, 0, 7}};
  const ml::Box box = ml::box_of(positions);
  CHECK(box.low == ml::Vec3<double>{-4, -2, 0});
  CHECK(box.high == ml::Vec3<double>{1, 5, 7});
  const ml::Box one = ml::box_of(std::span(positions).first(1));
  CHECK(one.low == positions[0]);
  CHECK(one.high == positions[0]);
  CHECK_ERROR(ml::box_of({}), "[motionlang.config.101]");
}
