// Rotation and translation together.
#include <doctest/doctest.h>

#include <motionlang/geometry/rigid.hpp>
#include <motionlang/geometry/so3.hpp>

namespace ml = motionlang;
using Rigid = ml::Rigid<double>;

TEST_CASE("motions act, compose and invert") {
  const Rigid a{ml::exp_so3(ml::Vec3{0.3, -0.9, 0.4}), {1, 2, 3}}, b{ml::exp_so3(ml::Vec3{-1.0, 0.2, 0.5}), {-4, 0, 1}};
  const ml::Vec3 x{0.5, -1.5, 2.5};
  CHECK(ml::norm((a * b) * x - a * (b * x)) < 1e-14);
  CHECK(ml::norm(ml::inverse(a) * (a * x) - x) < 1e-14);
  CHECK(ml::norm((a * ml::inverse(a)) * x - x) < 1e-14);
  CHECK(Rigid{} * x == x);
  CHECK(Rigid{.translation = {1, 0, 0}} * x == ml::Vec3{1.5, -1.5, 2.5});
}
