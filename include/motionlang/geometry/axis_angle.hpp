// SPDX-License-Identifier: MIT
/// Rotation vectors: the axis times the angle in radians. Exponential and logarithm of SO(3) in quaternion form.
#pragma once

#include <motionlang/geometry/quaternion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <class S>
struct AxisAngle {
  Vec3<S> v{};
};
template <class S>
AxisAngle(Vec3<S>) -> AxisAngle<S>;

/// q = (cos(t/2), sin(t/2)/t v), t = |v|. Below t = 1e-3 the factor is 1/2 - t^2/48 + t^4/3840: smooth at 0.
template <class S>
Quaternion<S> to_quaternion(const AxisAngle<S>& r) {
  const S t2 = dot(r.v, r.v), small = S(1e-6);
  const S t = sqrt(where_less(t2, small, small, t2));  // never 0, so that the branch not taken stays finite
  const S series = S(0.5) - t2 * (S(1.0 / 48) - t2 * S(1.0 / 3840));
  const S factor = where_less(t2, small, series, sin(S(0.5) * t) / t);
  const S w = where_less(t2, small, S(1) - t2 * (S(0.125) - t2 * S(1.0 / 384)), cos(S(0.5) * t));
  return {w, factor * r.v.x, factor * r.v.y, factor * r.v.z};
}
template <class S>
Matrix3<S> to_matrix(const AxisAngle<S>& r) {
  return to_matrix(to_quaternion(r));
}
/// Rotation by `angle` radians about a unit axis.
template <class S>
Quaternion<S> from_axis_angle(const Vec3<S>& axis, const S& angle) {
  return to_quaternion(AxisAngle<S>{angle * axis});
}

/// The shortest rotation vector (length at most pi). Correct up to and at pi; smooth at 0.
///     v = 2 atan2(n, |w|) / n (x, y, z) sign(w),   n = |(x, y, z)|
///     for small n the factor is 2/w (1 - n^2 / (3 w^2))
template <class S>
AxisAngle<S> to_axis_angle(const Quaternion<S>& q) {
  const S n2 = dot(q.vec(), q.vec()), small = S(1e-8), zero = S(0);
  const S n = sqrt(where_less(n2, small, small, n2));
  const S w = where_less(q.w, zero, -q.w, q.w), sign = where_less(q.w, zero, S(-1), S(1));
  const S safe_w = where_less(n2, small, w, S(1));
  const S series = S(2) / safe_w * (S(1) - n2 / (S(3) * safe_w * safe_w));
  const S factor = sign * where_less(n2, small, series, S(2) * atan2(n, w) / n);
  return {factor * q.vec()};
}
template <class S>
const AxisAngle<S>& to_axis_angle(const AxisAngle<S>& r) {
  return r;
}
template <Rotation R>
auto to_axis_angle(const R& r) {
  return to_axis_angle(to_quaternion(r));
}
static_assert(Rotation<AxisAngle<double>>);

MOTIONLANG_NAMESPACE_END
