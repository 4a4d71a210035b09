// SPDX-License-Identifier: MIT
/// Interpolation between rotations along the shortest arc.
#pragma once

#include <motionlang/geometry/so3.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Spherical linear interpolation: a at t = 0, b at t = 1, constant angular velocity in between.
///     slerp = (sin((1-t) h) a + sin(t h) b) / sin h,   h = angle between the quaternions (shorter arc)
/// Source  Shoemake, "Animating rotation with quaternion curves" (SIGGRAPH 1985). For h < 1e-3 it is a normalised lerp.
template <class S>
Quaternion<S> slerp(const Quaternion<S>& a, const Quaternion<S>& other, const S& t) {
  const S d = dot(a, other), sign = where_less(d, S(0), S(-1), S(1));
  const Quaternion<S> b = sign * other;
  const Quaternion<S> chord = b + (S(-1)) * a, sum = b + a;
  const S half = atan2(norm_or_zero(chord), norm_or_zero(sum));  // exact for small and large angles
  const S h = S(2) * half, limit = S(1e-3), safe = where_less(h, limit, S(1), h);
  const S wa = where_less(h, limit, S(1) - t, sin((S(1) - t) * safe) / sin(safe));
  const S wb = where_less(h, limit, t, sin(t * safe) / sin(safe));
  return normalized(wa * a + wb * b);
}

MOTIONLANG_NAMESPACE_END
