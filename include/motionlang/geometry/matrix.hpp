// SPDX-License-Identifier: MIT
/// Rotation matrices, and the concept of a rotation.
///
/// Conventions of the whole library: right-handed, active rotations, column vectors (v' = R v).
#pragma once

#include <array>  // storage

#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Three by three values, row by row: m[3 * row + column].
template <class S>
struct Matrix3 {
  std::array<S, 9> m{};

  static Matrix3 identity() { return {{S(1), S(0), S(0), S(0), S(1), S(0), S(0), S(0), S(1)}}; }
  static Matrix3 from_rows(const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& c) {
    return {{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}};
  }
  static Matrix3 from_columns(const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& c) {
    return {{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
  }

  const S& operator()(int row, int column) const { return m[static_cast<std::size_t>(3 * row + column)]; }
  S& operator()(int row, int column) { return m[static_cast<std::size_t>(3 * row + column)]; }
  Vec3<S> row(int i) const { return {(*this)(i, 0), (*this)(i, 1), (*this)(i, 2)}; }
  Vec3<S> column(int j) const { return {(*this)(0, j), (*this)(1, j), (*this)(2, j)}; }

  friend Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
    Matrix3 c;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) c(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
    }
    return c;
  }
  friend Vec3<S> operator*(const Matrix3& a, const Vec3<S>& v) {
    return {dot(a.row(0), v), dot(a.row(1), v), dot(a.row(2), v)};
  }
};

template <class S>
Matrix3<S> transpose(const Matrix3<S>& a) {
  return Matrix3<S>::from_columns(a.row(0), a.row(1), a.row(2));
}
template <class S>
Matrix3<S> inverse(const Matrix3<S>& rotation) {
  return transpose(rotation);
}
template <class S>
const Matrix3<S>& to_matrix(const Matrix3<S>& a) {
  return a;
}
template <class S, class T>
Matrix3<S> matrix_cast(const Matrix3<T>& a) {
  Matrix3<S> b;
  for (std::size_t i = 0; i < 9; ++i) b.m[i] = S(a.m[i]);
  return b;
}

/// One parameterisation of rotations in three dimensions.
/// Minimum   to_matrix(r)
/// Deduced   to_quaternion, to_axis_angle, compose, inverse, distance, slerp (so3.hpp, slerp.hpp)
/// Laws      to_matrix(r) is orthonormal with determinant 1; converting there and back gives the same matrix
/// Models    Matrix3, Quaternion, AxisAngle, EulerAngles, Rotation6dRows, Rotation6dColumns
template <class R>
concept Rotation = requires(const R& r) {
  to_matrix(r).m;
};

MOTIONLANG_NAMESPACE_END
