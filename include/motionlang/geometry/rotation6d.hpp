// SPDX-License-Identifier: MIT
/// Six values for a rotation: two of the three rows, or two of the three columns, of its matrix.
///
/// Source   Zhou et al., "On the continuity of rotation representations in neural networks" (CVPR 2019), section B.
/// Two conventions are in use and must not be mixed, so there are two types. ACTOR, TEMOS, TEACH, SINC and the
/// 205-vector take the first two ROWS, row by row. The 263-vector of HumanML3D takes the first two COLUMNS, column by
/// column.
#pragma once

#include <motionlang/geometry/matrix.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <class S>
struct Rotation6dRows {
  Vec3<S> a{}, b{};
};
template <class S>
struct Rotation6dColumns {
  Vec3<S> a{}, b{};
};

/// Gram-Schmidt: b1 = a / |a|, b2 = (b - (b1 . b) b1) normalised, b3 = b1 x b2; norms are at least 1e-12.
template <class S>
Matrix3<S> to_matrix(const Rotation6dRows<S>& r) {
  const Vec3<S> b1 = normalized(r.a);
  const Vec3<S> b2 = normalized(r.b - dot(b1, r.b) * b1);
  return Matrix3<S>::from_rows(b1, b2, cross(b1, b2));
}
/// By cross products: x = a / |a|, z = x x b normalised, y = z x x. The same as Gram-Schmidt, up to rounding.
template <class S>
Matrix3<S> to_matrix(const Rotation6dColumns<S>& r) {
  const Vec3<S> x = normalized(r.a);
  const Vec3<S> z = normalized(cross(x, r.b));
  return Matrix3<S>::from_columns(x, cross(z, x), z);
}
template <Rotation R>
auto to_rotation6d_rows(const R& r) {
  const auto m = to_matrix(r);
  return Rotation6dRows<std::remove_cvref_t<decltype(m.m[0])>>{m.row(0), m.row(1)};
}
template <Rotation R>
auto to_rotation6d_columns(const R& r) {
  const auto m = to_matrix(r);
  return Rotation6dColumns<std::remove_cvref_t<decltype(m.m[0])>>{m.column(0), m.column(1)};
}
static_assert(Rotation<Rotation6dRows<double>> && Rotation<Rotation6dColumns<double>>);

MOTIONLANG_NAMESPACE_END
