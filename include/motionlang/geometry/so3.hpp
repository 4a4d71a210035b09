// SPDX-License-Identifier: MIT
/// Operations of every rotation in any representation: the API that follows from `to_matrix`.
#pragma once

#include <motionlang/geometry/axis_angle.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// a after b: the matrix A B.
template <Rotation A, Rotation B>
auto compose(const A& a, const B& b) {
  return to_matrix(a) * to_matrix(b);
}
template <Rotation R>
auto inverse(const R& r) {
  return transpose(to_matrix(r));
}
template <Rotation R, class S>
Vec3<S> rotate(const R& r, const Vec3<S>& v) {
  return to_matrix(r) * v;
}

/// Exponential: rotation vector to matrix (Rodrigues).
///     R = I + (sin t / t) K + ((1 - cos t) / t^2) K^2,   K = hat(v), t = |v|; series below t = 1e-2
template <class S>
Matrix3<S> exp_so3(const Vec3<S>& v) {
  const S t2 = dot(v, v), small = S(1e-4);
  const S safe = where_less(t2, small, small, t2), t = sqrt(safe);
  const S a = where_less(t2, small, S(1) - t2 * (S(1.0 / 6) - t2 * S(1.0 / 120)), sin(t) / t);
  const S b = where_less(t2, small, S(0.5) - t2 * (S(1.0 / 24) - t2 * S(1.0 / 720)), (S(1) - cos(t)) / safe);
  const S xy = b * v.x * v.y, xz = b * v.x * v.z, yz = b * v.y * v.z;
  const S xx = b * v.x * v.x, yy = b * v.y * v.y, zz = b * v.z * v.z;
  return {{S(1) - yy - zz, xy - a * v.z, xz + a * v.y,  //
           xy + a * v.z, S(1) - xx - zz, yz - a * v.x,  //
           xz - a * v.y, yz + a * v.x, S(1) - xx - yy}};
}
/// Logarithm: the shortest rotation vector. The inverse of exp_so3 for |v| <= pi (at pi up to the sign of the axis).
template <Rotation R>
auto log_so3(const R& r) {
  return to_axis_angle(r).v;
}

/// The angle between two rotations, radians in [0, pi]. Its slope counts as 0 where they are equal.
template <Rotation A, Rotation B>
auto distance(const A& a, const B& b) {
  const auto q = to_quaternion(transpose(to_matrix(a)) * to_matrix(b));
  using S = std::remove_cvref_t<decltype(q.w)>;
  return S(2) * atan2(norm_or_zero(q.vec()), where_less(q.w, S(0), -q.w, q.w));
}

/// The shortest rotation that turns direction `from` into direction `to`. For opposite directions, and up to 1.5e-6 rad
/// from them, it is half a turn about some orthogonal axis.
template <class S>
Quaternion<S> rotation_between(const Vec3<S>& from, const Vec3<S>& to) {
  const Vec3<S> a = normalized(from), sum = a + normalized(to), c = cross(a, sum);
  const S w = S(0.5) * dot(sum, sum), ax = where_less(a.x, S(0), -a.x, a.x), limit = S(0.6);
  // An axis orthogonal to a: cross with x or with y, whichever is farther from a.
  const Vec3<S> with_x = cross(a, Vec3<S>{S(1), S(0), S(0)}), with_y = cross(a, Vec3<S>{S(0), S(1), S(0)});
  auto pick = [&](const S& near, const S& far) { return where_less(ax, limit, near, far); };
  const Vec3<S> any{pick(with_x.x, with_y.x), pick(with_x.y, with_y.y), pick(with_x.z, with_y.z)};
  const S tiny = S(1e-12);
  return normalized(Quaternion<S>{where_less(w, tiny, S(0), w), where_less(w, tiny, any.x, c.x),
                                  where_less(w, tiny, any.y, c.y), where_less(w, tiny, any.z, c.z)});
}

MOTIONLANG_NAMESPACE_END
