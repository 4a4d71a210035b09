// SPDX-License-Identifier: MIT
/// Euler angles in all twelve orders.
///
/// Intrinsic angles: order "ZXY" means R = Rz(a) Rx(b) Ry(c) on column vectors, the first letter outermost. This is the
/// order of BVH channels and of pytorch3d's conventions.
#pragma once

#include <array>        // axes
#include <numbers>      // pi
#include <string_view>  // "ZXY"

#include <motionlang/geometry/matrix.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Three axes, 0 = x, 1 = y, 2 = z; neighbours differ.
struct EulerOrder {
  std::array<int, 3> axis{2, 0, 1};

  /// From "XYZ", "ZXZ", ... Throws config_error 103.
  static EulerOrder parse(std::string_view letters) {
    EulerOrder o;
    bool ok = letters.size() == 3;
    for (std::size_t i = 0; ok && i < 3; ++i) {
      const char c = static_cast<char>(letters[i] | 0x20);
      o.axis[i] = c - 'x';
      ok = c >= 'x' && c <= 'z' && (i == 0 || o.axis[i] != o.axis[i - 1]);
    }
    if (!ok) raise<config_error>(103, "EulerOrder: '", letters, "' is not an order of rotation axes");
    return o;
  }
  bool operator==(const EulerOrder&) const = default;
};

/// Radians, in the order of the axes.
template <class S>
struct EulerAngles {
  S a{}, b{}, c{};
  EulerOrder order{};
};

/// Rotation about one coordinate axis (0, 1, 2).
template <class S>
Matrix3<S> axis_rotation(int axis, const S& angle) {
  const S c = cos(angle), s = sin(angle);
  Matrix3<S> m = Matrix3<S>::identity();
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  m(i, i) = c;
  m(j, j) = c;
  m(i, j) = -s;
  m(j, i) = s;
  return m;
}

template <class S>
Matrix3<S> to_matrix(const EulerAngles<S>& e) {
  return axis_rotation(e.order.axis[0], e.a) * axis_rotation(e.order.axis[1], e.b) *
         axis_rotation(e.order.axis[2], e.c);
}

/// The angles of a rotation. The middle one is in [-pi/2, pi/2] for three different axes, and in [0, pi] for a proper
/// order (ZXZ). Only arc tangents are used, so nothing needs clamping. If the first and last axis coincide (gimbal
/// lock, within 1e-6), the last angle is `last` and the first takes the rest.
template <class R>
requires Rotation<R>
auto to_euler(const R& rotation, EulerOrder order, double last = 0.0) {
  const auto& m = to_matrix(rotation);
  using S = std::remove_cvref_t<decltype(m.m[0])>;
  const int i = order.axis[0], j = order.axis[1], k = order.axis[2];
  const bool proper = i == k;
  const int l = proper ? 3 - i - j : k;
  const double sign = (j - i + 3) % 3 == 1 ? 1.0 : -1.0;  // of the permutation (i, j, l)
  const S plus = S(sign), lock = S(1e-6);
  EulerAngles<S> e{.order = order};
  // Product for three axes: m(i, k) = sign sin b, first angle from column k, last from row i. For a proper order: m(i,
  // i) = cos b.
  const S middle = proper ? m(i, i) : plus * m(i, k);
  const S other = proper ? sqrt(m(i, j) * m(i, j) + m(i, l) * m(i, l)) : sqrt(m(i, i) * m(i, i) + m(i, j) * m(i, j));
  e.b = proper ? atan2(other, middle) : atan2(middle, other);
  const S first = proper ? atan2(m(j, i), -(plus * m(l, i))) : atan2(-(plus * m(j, k)), m(k, k));
  const S third = proper ? atan2(m(i, j), plus * m(i, l)) : atan2(-(plus * m(i, j)), m(i, i));
  // Locked: given c, column j of R Rk(-c) = Ri(a) Rj(b) is that of Ri(a) alone.
  const S c = S(last);
  const Vec3<S> column = m * axis_rotation(k, -c).column(j);
  const std::array<S, 3> turned{column.x, column.y, column.z};
  const S locked_first = atan2(plus * turned[static_cast<std::size_t>(l)], turned[static_cast<std::size_t>(j)]);
  e.a = where_less(other, lock, locked_first, first);
  e.c = where_less(other, lock, c, third);
  return e;
}
static_assert(Rotation<EulerAngles<double>>);

MOTIONLANG_NAMESPACE_END
