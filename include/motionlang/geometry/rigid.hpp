// SPDX-License-Identifier: MIT
/// Rotation and translation together.
#pragma once

#include <motionlang/geometry/matrix.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// x -> R x + t.
template <class S>
struct Rigid {
  Matrix3<S> rotation = Matrix3<S>::identity();
  Vec3<S> translation{};

  friend Rigid operator*(const Rigid& a, const Rigid& b) {
    return {a.rotation * b.rotation, a.rotation * b.translation + a.translation};
  }
  friend Vec3<S> operator*(const Rigid& a, const Vec3<S>& x) { return a.rotation * x + a.translation; }
};

template <class S>
Rigid<S> inverse(const Rigid<S>& a) {
  const Matrix3<S> r = transpose(a.rotation);
  return {r, -(r * a.translation)};
}

MOTIONLANG_NAMESPACE_END
