// SPDX-License-Identifier: MIT
/// Laws of Rotation, at the identity, 1e-8 from it, at random and at half a turn. R(r) = to_matrix(r):
///
///     orthonormal   R R^T = I,   det R = 1                  round trip    to_matrix(of(R)) = R
///     group         (a b) c = a (b c),   a^-1 a = I         (a b)^-1 = b^-1 a^-1
///     action        (a b) v = a (b v),   |a v| = |v|,   a (u x v) = (a u) x (a v)
///     distance      d(a, a) = 0,   d(a, b) = d(b, a) = d(c a, c b) <= pi,   d(a, c) <= d(a, b) + d(b, c)
///     logarithm     exp(log a) = a,   |log a| = d(I, a)
///     slerp         d(a, s(t)) = t d(a, b),   s(0) = a,   s(1) = b,   s from a to b at t = s from b to a at 1 - t
#pragma once

#include <doctest/doctest.h>

#include <motionlang/geometry/euler.hpp>
#include <motionlang/geometry/rotation6d.hpp>
#include <motionlang/geometry/slerp.hpp>

#include "../support/rotation_samples.hpp"

namespace laws {

namespace ml = motionlang;
using rotations::difference, rotations::length;

/// How a matrix becomes the representation.
template <class R>
struct Represent;
template <class S>
struct Represent<ml::Matrix3<S>> {
  using scalar = S;
  static auto of(const ml::Matrix3<S>& m) { return m; }
};
template <class S>
struct Represent<ml::Quaternion<S>> {
  using scalar = S;
  static auto of(const ml::Matrix3<S>& m) { return ml::to_quaternion(m); }
};
template <class S>
struct Represent<ml::AxisAngle<S>> {
  using scalar = S;
  static auto of(const ml::Matrix3<S>& m) { return ml::to_axis_angle(m); }
};
template <class S>
struct Represent<ml::EulerAngles<S>> {
  using scalar = S;
  static auto of(const ml::Matrix3<S>& m) { return ml::to_euler(m, ml::EulerOrder::parse("ZXY")); }
};
template <class S>
struct Represent<ml::Rotation6dRows<S>> {
  using scalar = S;
  static auto of(const ml::Matrix3<S>& m) { return ml::to_rotation6d_rows(m); }
};
template <class S>
struct Represent<ml::Rotation6dColumns<S>> {
  using scalar = S;
  static auto of(const ml::Matrix3<S>& m) { return ml::to_rotation6d_columns(m); }
};

template <ml::Rotation R>
void laws_of_one_rotation(const R& a) {
  using S = typename Represent<R>::scalar;
  const double tolerance = 4 * rotations::tolerance<S>;
  const auto identity = ml::Matrix3<S>::identity(), r = ml::to_matrix(a);
  CHECK(difference(r * ml::transpose(r), identity) < tolerance);
  CHECK(double(ml::dot(ml::cross(r.row(0), r.row(1)), r.row(2))) == doctest::Approx(1).epsilon(tolerance));
  CHECK(difference(ml::to_matrix(Represent<R>::of(r)), r) < tolerance);
  CHECK(difference(ml::compose(ml::to_matrix(ml::inverse(a)), a), identity) < tolerance);
  CHECK(double(ml::distance(a, a)) < tolerance);
  CHECK(difference(ml::exp_so3(ml::log_so3(a)), r) < tolerance);
  CHECK(std::abs(length(ml::log_so3(a)) - double(ml::distance(identity, a))) < tolerance);
}

template <ml::Rotation R>
void laws_of_three_rotations(const R& a, const R& b, const R& c) {
  using S = typename Represent<R>::scalar;
  const double tolerance = 4 * rotations::tolerance<S>;
  const auto ab = ml::compose(a, b), ca = ml::compose(c, a), cb = ml::compose(c, b);
  CHECK(difference(ml::compose(ab, c), ml::compose(a, ml::compose(b, c))) < tolerance);
  const auto inverse_a = ml::to_matrix(ml::inverse(a)), inverse_b = ml::to_matrix(ml::inverse(b));
  CHECK(difference(ml::inverse(ab), ml::compose(inverse_b, inverse_a)) < tolerance);

  const ml::Vec3<S> u{S(0.3), S(-1.2), S(0.7)}, v{S(-0.8), S(0.1), S(1.5)};
  CHECK(length(ml::rotate(ab, v) - ml::rotate(a, ml::rotate(b, v))) < tolerance);
  CHECK(std::abs(length(ml::rotate(a, v)) - length(v)) < tolerance);
  CHECK(length(ml::rotate(a, ml::cross(u, v)) - ml::cross(ml::rotate(a, u), ml::rotate(a, v))) < 2 * tolerance);

  const auto d = double(ml::distance(a, b));
  CHECK(std::abs(double(ml::distance(b, a)) - d) < tolerance);
  CHECK(std::abs(double(ml::distance(ca, cb)) - d) < tolerance);
  CHECK(d < std::numbers::pi + tolerance);
  CHECK(double(ml::distance(a, c)) < d + double(ml::distance(b, c)) + tolerance);

  const auto p = ml::to_quaternion(a), q = ml::to_quaternion(b);
  for (double t : {0.0, 0.25, 0.5, 0.9, 1.0}) {
    const auto between = ml::slerp(p, q, S(t));
    CHECK(std::abs(double(ml::distance(p, between)) - t * d) < 2 * tolerance);
    CHECK(double(ml::distance(between, ml::slerp(q, p, S(1 - t)))) < 2 * tolerance);
  }
}

template <ml::Rotation R>
void rotation_laws() {
  using S = typename Represent<R>::scalar;
  std::vector<R> samples;
  for (const auto& v : rotations::vectors<S>()) samples.push_back(Represent<R>::of(ml::exp_so3(v)));
  const std::size_t n = samples.size();
  for (std::size_t i = 0; i < n; ++i) {
    INFO("sample ", i);
    laws_of_one_rotation(samples[i]);
    laws_of_three_rotations(samples[i], samples[(i + 7) % n], samples[(3 * i + 1) % n]);
  }
}

}  // namespace laws
