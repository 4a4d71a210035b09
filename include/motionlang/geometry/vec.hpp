// SPDX-License-Identifier: MIT
/// Vectors of three coordinates.
#pragma once

#include <motionlang/core/concepts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <class S>
struct Vec3 {
  S x{}, y{}, z{};

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(const S& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend Vec3 operator*(const Vec3& a, const S& s) { return s * a; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};
template <class S>
Vec3(S, S, S) -> Vec3<S>;

template <class S>
S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class S>
S norm(const Vec3<S>& a) {
  return sqrt(dot(a, a));
}
/// a| of a vector or quaternion. The slope is 0 where a is 0 (shorter than 1e-15) and |a| has no slope.
template <class V>
auto norm_or_zero(const V& a) {
  const auto squared = dot(a, a);
  using S = std::remove_const_t<decltype(squared)>;
  const S least = S(1e-30);
  return where_less(squared, least, S(0), sqrt(where_less(squared, least, least, squared)));
}

/// a / max(|a|, floor). The published code uses floor = 1e-12: a zero vector stays zero and its derivative stays
/// finite.
template <class S>
Vec3<S> normalized(const Vec3<S>& a, double floor = 1e-12) {
  const S squared = dot(a, a), least = S(floor * floor);
  const S floored = where_less(squared, least, least, squared);
  if constexpr (requires { inverse_sqrt(floored); }) {
    return inverse_sqrt(floored) * a;  // cheaper in a register than three divisions
  } else {
    const S length = sqrt(floored);
    return {a.x / length, a.y / length, a.z / length};
  }
}

/// The same vector over another scalar.
template <class S, class T>
Vec3<S> vec_cast(const Vec3<T>& a) {
  return {S(a.x), S(a.y), S(a.z)};
}

MOTIONLANG_NAMESPACE_END
