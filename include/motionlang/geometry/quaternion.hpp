// SPDX-License-Identifier: MIT
/// Unit quaternions (w, x, y, z), Hamilton product.
#pragma once

#include <motionlang/geometry/matrix.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <class S>
struct Quaternion {
  S w{}, x{}, y{}, z{};

  static Quaternion identity() { return {S(1), S(0), S(0), S(0)}; }
  Vec3<S> vec() const { return {x, y, z}; }

  friend Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
  friend Quaternion operator*(const S& s, const Quaternion& q) { return {s * q.w, s * q.x, s * q.y, s * q.z}; }
  friend Quaternion operator+(const Quaternion& a, const Quaternion& b) {
    return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend Quaternion operator-(const Quaternion& q) { return {-q.w, -q.x, -q.y, -q.z}; }
  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};
template <class S>
Quaternion(S, S, S, S) -> Quaternion<S>;

template <class S>
S dot(const Quaternion<S>& a, const Quaternion<S>& b) {
  return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}
/// The inverse of a unit quaternion.
template <class S>
Quaternion<S> inverse(const Quaternion<S>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
template <class S>
Quaternion<S> normalized(const Quaternion<S>& q) {
  return (S(1) / sqrt(dot(q, q))) * q;
}
/// q v q^-1 = v + 2 (w (u x v) + u x (u x v)), u = (x, y, z). For unit q.
template <class S>
Vec3<S> rotate(const Quaternion<S>& q, const Vec3<S>& v) {
  const Vec3<S> uv = cross(q.vec(), v);
  return v + S(2) * (q.w * uv + cross(q.vec(), uv));
}

/// The matrix of a quaternion. One that is not of unit length is tolerated: factor 2 / (q . q).
template <class S>
Matrix3<S> to_matrix(const Quaternion<S>& q) {
  const S k = S(2) / dot(q, q);
  const S xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const S xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{S(1) - k * (yy + zz), k * (xy - wz), k * (xz + wy),  //
           k * (xy + wz), S(1) - k * (xx + zz), k * (yz - wx),  //
           k * (xz - wy), k * (yz + wx), S(1) - k * (xx + yy)}};
}

/// The quaternion with w >= 0 of a rotation matrix. It is accurate everywhere, also near half turns.
/// Source  Shepperd (1978): divide by the largest of |w|, |x|, |y|, |z|. All four candidates are computed, and
///         where_less chooses one, so that SIMD lanes and tensors can do it, too.
template <class S>
Quaternion<S> to_quaternion(const Matrix3<S>& r) {
  const S m00 = r(0, 0), m11 = r(1, 1), m22 = r(2, 2), zero = S(0), tiny = S(1e-12);
  const S sw = S(1) + m00 + m11 + m22, sx = S(1) + m00 - m11 - m22, sy = S(1) - m00 + m11 - m22,
          sz = S(1) - m00 - m11 + m22;
  auto half_root = [&](const S& s) { return S(0.5) * sqrt(where_less(s, tiny, tiny, s)); };
  const S w = half_root(sw), x = half_root(sx), y = half_root(sy), z = half_root(sz);
  const S a = r(2, 1) - r(1, 2), b = r(0, 2) - r(2, 0), c = r(1, 0) - r(0, 1);
  const S d = r(1, 0) + r(0, 1), e = r(0, 2) + r(2, 0), f = r(2, 1) + r(1, 2);
  auto select = [](const S& p, const S& q, const Quaternion<S>& less, const Quaternion<S>& other) {
    return Quaternion<S>{where_less(p, q, less.w, other.w), where_less(p, q, less.x, other.x),
                         where_less(p, q, less.y, other.y), where_less(p, q, less.z, other.z)};
  };
  const S iw = S(0.25) / w, ix = S(0.25) / x, iy = S(0.25) / y, iz = S(0.25) / z;
  const Quaternion<S> by_w{w, a * iw, b * iw, c * iw}, by_x{a * ix, x, d * ix, e * ix};
  const Quaternion<S> by_y{b * iy, d * iy, y, f * iy}, by_z{c * iz, e * iz, f * iz, z};
  const Quaternion<S> wx = select(sw, sx, by_x, by_w), yz = select(sy, sz, by_z, by_y);
  const Quaternion<S> q = select(where_less(sw, sx, sx, sw), where_less(sy, sz, sz, sy), yz, wx);
  return select(q.w, zero, -q, q);
}
template <class S>
const Quaternion<S>& to_quaternion(const Quaternion<S>& q) {
  return q;
}
template <Rotation R>
auto to_quaternion(const R& r) {
  return to_quaternion(to_matrix(r));
}
static_assert(Rotation<Quaternion<double>> && Rotation<Matrix3<float>>);

MOTIONLANG_NAMESPACE_END
