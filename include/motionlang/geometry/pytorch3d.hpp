// SPDX-License-Identifier: MIT
/// The rotation formulas that the published systems share (an old version of pytorch3d), for parity with their
/// features.
///
/// They differ from quaternion.hpp and axis_angle.hpp, which are more accurate. matrix_to_quaternion loses half of the
/// digits near 0 and near pi, and is wrong at pi for axes of mixed signs. quaternion_to_axis_angle does not take the
/// shorter arc. Use them only to reproduce published numbers.
#pragma once

#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/geometry/rotation6d.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace pytorch3d {

/// w = sqrt(max(0, 1 + m00 + m11 + m22)) / 2, ...; x, y and z have the signs of the antisymmetric part (0 counts as +).
template <class S>
Quaternion<S> matrix_to_quaternion(const Matrix3<S>& m) {
  const S zero = S(0), one = S(1);
  auto half_root = [&](const S& s) { return S(0.5) * sqrt(where_less(s, zero, zero, s)); };
  auto with_sign = [&](const S& size, const S& sign) { return where_less(sign, zero, -size, size); };
  return {half_root(one + m(0, 0) + m(1, 1) + m(2, 2)),
          with_sign(half_root(one + m(0, 0) - m(1, 1) - m(2, 2)), m(2, 1) - m(1, 2)),
          with_sign(half_root(one - m(0, 0) + m(1, 1) - m(2, 2)), m(0, 2) - m(2, 0)),
          with_sign(half_root(one - m(0, 0) - m(1, 1) + m(2, 2)), m(1, 0) - m(0, 1))};
}

/// v = (x, y, z) / (sin(h) / 2h), h = atan2(|(x, y, z)|, w); the divisor is 1/2 - (2h)^2/48 for |2h| < 1e-6.
template <class S>
Vec3<S> quaternion_to_axis_angle(const Quaternion<S>& q) {
  const S h = atan2(norm(q.vec()), q.w), angle = S(2) * h, size = where_less(angle, S(0), -angle, angle),
          small = S(1e-6);
  const S safe = where_less(size, small, S(1), angle);
  const S divisor = where_less(size, small, S(0.5) - angle * angle / S(48), sin(h) / safe);
  return {q.x / divisor, q.y / divisor, q.z / divisor};
}
template <class S>
Vec3<S> matrix_to_axis_angle(const Matrix3<S>& m) {
  return quaternion_to_axis_angle(matrix_to_quaternion(m));
}
/// The body models' formula: angle = |v + 1e-8|, axis = v / angle, R = I + sin K + (1 - cos) K^2.
template <class S>
Matrix3<S> rodrigues(const Vec3<S>& v) {
  const S e = S(1e-8), angle = norm(v + Vec3<S>{e, e, e}), s = sin(angle), c = S(1) - cos(angle);
  const Vec3<S> a{v.x / angle, v.y / angle, v.z / angle};
  const Matrix3<S> k{{S(0), -a.z, a.y, a.z, S(0), -a.x, -a.y, a.x, S(0)}}, kk = k * k;
  Matrix3<S> r = Matrix3<S>::identity();
  for (std::size_t i = 0; i < 9; ++i) r.m[i] = r.m[i] + s * k.m[i] + c * kk.m[i];
  return r;
}

}  // namespace pytorch3d
MOTIONLANG_NAMESPACE_END
