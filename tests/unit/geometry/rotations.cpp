// Rotations: orders of angles, conventions, derivatives, registers. What every representation can do is in tests/laws.
#include <doctest/doctest.h>

#include <numbers>
#include <string>
#include <vector>

#include <motionlang/core/dual.hpp>
#include <motionlang/core/lane.hpp>
#include <motionlang/geometry/euler.hpp>
#include <motionlang/geometry/guo.hpp>
#include <motionlang/geometry/pytorch3d.hpp>
#include <motionlang/geometry/slerp.hpp>
#include <motionlang/geometry/so3.hpp>

#include "../../support/rotation_samples.hpp"

namespace ml = motionlang;
using rotations::difference, rotations::length, rotations::tolerance;

namespace {

constexpr const char* all_orders[] = {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX",
                                      "XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ"};

}  // namespace

TEST_CASE_TEMPLATE("every order of Euler angles gives the same matrix back", S, float, double) {
  for (const auto& v : rotations::vectors<S>()) {
    const auto r = ml::exp_so3(v);
    for (const char* letters : all_orders) {
      const auto e = ml::to_euler(r, ml::EulerOrder::parse(letters));
      const double bound = length(v) < 1e-6 ? 1e-6 : 4 * tolerance<S>;  // proper orders are locked at the identity
      CHECK_MESSAGE(difference(r, ml::to_matrix(e)) < bound, std::string(letters), " ", v.x, " ", v.y, " ", v.z);
    }
  }
}

TEST_CASE_TEMPLATE("the logarithm inverts the exponential, also at pi", S, float, double) {
  for (const auto& v : rotations::vectors<S>()) {
    const auto back = ml::log_so3(ml::exp_so3(v));
    const double err = std::min(length(back - v), length(back + v));  // at pi both signs are right
    CHECK(err < (length(v) > 3.14 ? 200 : 4) * tolerance<S>);
    if (length(v) < 3.1) CHECK(length(back - v) < 10 * tolerance<S>);
  }
}

TEST_CASE_TEMPLATE("gimbal lock keeps the rotation and the requested last angle", S, float, double) {
  const double pi = std::numbers::pi;
  for (const char* letters : all_orders) {
    const auto order = ml::EulerOrder::parse(letters);
    const bool proper = order.axis[0] == order.axis[2];
    for (double middle : proper ? std::vector{0.0, pi} : std::vector{pi / 2, -pi / 2}) {
      for (double first : {-2.0, 0.3}) {
        const auto r = ml::to_matrix(ml::EulerAngles<S>{S(first), S(middle), S(1.1), order});
        const auto e = ml::to_euler(r, order, 0.7);
        CHECK(double(e.c) == doctest::Approx(0.7));
        CHECK_MESSAGE(difference(r, ml::to_matrix(e)) < 1e3 * tolerance<S>, std::string(letters), " ", middle, " ",
                      first);
      }
    }
  }
}

TEST_CASE("the angle conventions are those of the exchange formats") {  // of BVH and glTF
  const auto r = ml::to_matrix(ml::EulerAngles<double>{0.5, 0.3, -0.7, ml::EulerOrder::parse("ZXY")});
  CHECK(std::asin(r(2, 1)) == doctest::Approx(0.3));
  CHECK(std::atan2(-r(0, 1), r(1, 1)) == doctest::Approx(0.5));
  CHECK(std::atan2(-r(2, 0), r(2, 2)) == doctest::Approx(-0.7));
  CHECK_THROWS_WITH_AS(ml::EulerOrder::parse("ZZX"), doctest::Contains("[motionlang.config.103]"), ml::config_error);
  CHECK_THROWS_AS(ml::EulerOrder::parse("ABC"), ml::config_error);
}

TEST_CASE("quarter turns go the right way: active, right-handed, column vectors") {
  const auto q = ml::from_axis_angle(ml::Vec3{0.0, 0.0, 1.0}, std::numbers::pi / 2);
  const auto v = ml::rotate(q, ml::Vec3{1.0, 0.0, 0.0});
  CHECK(length(v - ml::Vec3{0.0, 1.0, 0.0}) < 1e-15);
  CHECK(length(ml::to_matrix(q) * ml::Vec3{1.0, 0.0, 0.0} - v) < 1e-15);
}

TEST_CASE("the shortest rotation between directions, also opposite ones") {
  const std::vector<ml::Vec3<double>> directions{{1, 0, 0},  {0, 1, 0},      {0, 0, -1},
                                                 {-1, 0, 0}, {0.6, -0.8, 0}, {-0.6, 0.8, 0}};
  for (const auto& a : directions) {
    for (const auto& b : directions) {
      const auto q = ml::rotation_between(a, b);
      CHECK(length(ml::rotate(q, a) - b) < 1e-6);
      CHECK(2 * std::acos(std::min(1.0, std::abs(q.w))) == doctest::Approx(std::acos(ml::dot(a, b))).epsilon(1e-6));
    }
  }
}

TEST_CASE("almost opposite directions: the rotation is exact to what is near the turning point") {
  const ml::Vec3<double> a{0.36, 0.48, 0.8}, sideways{-0.8, 0.6, 0};
  for (double angle : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 0.0}) {
    const auto b = ml::normalized(-1.0 * a + std::tan(angle) * sideways);
    CHECK_MESSAGE(length(ml::rotate(ml::rotation_between(a, b), a) - b) < 1.5e-6, angle);
    if (angle > 2e-6) CHECK_MESSAGE(length(ml::rotate(ml::rotation_between(a, b), a) - b) < 1e-9, angle);
  }
}

TEST_CASE("distance and slerp have finite derivatives at equal rotations") {
  using D = ml::Dual<double>;
  const auto q = ml::from_axis_angle(ml::Vec3{0.6, 0.0, 0.8}, 0.7);
  const ml::Quaternion<D> moving{D(q.w, 0.1), D(q.x, -0.2), D(q.y, 0.3), D(q.z, 0.4)},
      still{D(q.w), D(q.x), D(q.y), D(q.z)};
  CHECK(ml::distance(moving, still).value == 0);
  CHECK(ml::distance(moving, still).derivative == 0);
  const auto between = ml::slerp(still, still, D(0.3, 1.0));
  CHECK(between.w.value == doctest::Approx(q.w));
  for (const D& x : {between.w, between.x, between.y, between.z}) CHECK(x.derivative == doctest::Approx(0.0));
  const auto half = ml::slerp(moving, still, D(0.5));  // half of what moves, without what would change its length
  const double along = 0.1 * q.w - 0.2 * q.x + 0.3 * q.y + 0.4 * q.z;
  CHECK(half.w.derivative == doctest::Approx(0.5 * (0.1 - along * q.w)));
  CHECK(half.z.derivative == doctest::Approx(0.5 * (0.4 - along * q.z)));
}

TEST_CASE("derivatives stay right through the small-angle branches") {
  using D = ml::Dual<double>;
  for (const auto& v : rotations::vectors<double>()) {
    if (length(v) > 3.1) continue;  // the logarithm has no derivative at pi
    const ml::Vec3<double> d{0.3, -0.5, 0.8};
    const ml::Vec3<D> x{D(v.x, d.x), D(v.y, d.y), D(v.z, d.z)};
    // log(exp(x)) = x, so its derivative along d is d
    const auto back = ml::log_so3(ml::exp_so3(x));
    CHECK(length(ml::Vec3{back.x.derivative, back.y.derivative, back.z.derivative} - d) < 1e-6);
    const auto via_quaternion = ml::to_axis_angle(ml::to_quaternion(ml::AxisAngle<D>{x})).v;
    CHECK(length(ml::Vec3{via_quaternion.x.derivative, via_quaternion.y.derivative, via_quaternion.z.derivative} - d) <
          1e-6);
  }
}

TEST_CASE_TEMPLATE("eight poses in a register are eight poses", S, float, double) {
  using L = ml::Lane<S>;
  const auto vectors = rotations::vectors<S>();
  for (std::size_t at = 0; at + L::size <= vectors.size(); at += L::size) {
    const auto pose = [&](int i) { return vectors[at + static_cast<std::size_t>(i)]; };
    ml::Vec3<L> v;
    for (int i = 0; i < L::size; ++i) v.x[i] = pose(i).x, v.y[i] = pose(i).y, v.z[i] = pose(i).z;
    const auto m = ml::to_matrix(ml::to_rotation6d_rows(ml::exp_so3(v)));
    const auto w = ml::log_so3(m);
    for (int i = 0; i < L::size; ++i) {
      const auto want = ml::exp_so3(pose(i));
      ml::Matrix3<S> got;
      for (std::size_t k = 0; k < 9; ++k) got.m[k] = m.m[k][i];
      CHECK(difference(got, want) < 4 * tolerance<S>);
      CHECK(difference(ml::exp_so3(ml::Vec3<S>{w.x[i], w.y[i], w.z[i]}), want) < 10 * tolerance<S>);
    }
  }
}

TEST_CASE("the published formulas agree with ours away from their weak spots") {
  for (const auto& v : rotations::vectors<double>()) {
    if (length(v) < 1e-3 || length(v) > 3.1) continue;
    const auto r = ml::exp_so3(v);
    CHECK(length(ml::pytorch3d::matrix_to_axis_angle(r) - v) < 1e-9);
    CHECK(difference(ml::pytorch3d::rodrigues(v), r) < 1e-7);
  }
}
