// SPDX-License-Identifier: MIT
/// The quaternion formulas of HumanML3D, T2M and TM2T, for parity with their features. Formulas that are missing here
/// are the same as in quaternion.hpp, rotation6d.hpp, euler.hpp (`to_euler`) and axis_angle.hpp.
///
/// They differ where the general functions are safer. `between` has no answer for opposite vectors, and `slerp` takes
/// the longer arc if the quaternions are in different hemispheres. Use them only to reproduce published numbers.
/// Source  Guo et al. (CVPR 2022), HumanML3D common/quaternion.py
#pragma once

#include <span>    // rotations
#include <vector>  // continuous

#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/geometry/degree.hpp>
#include <motionlang/geometry/euler.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace guo {

/// The shortest rotation from a to b, of any length:  q ~ (|a||b| + a . b, a x b).  NaN for opposite vectors.
/// lengths = |a||b|, if it is known.
template <class S>
Quaternion<S> between(const Vec3<S>& a, const Vec3<S>& b, const S& lengths) {
  const Vec3<S> c = cross(a, b);
  return normalized(Quaternion<S>{lengths + dot(a, b), c.x, c.y, c.z});
}
template <class S>
Quaternion<S> between(const Vec3<S>& a, const Vec3<S>& b) {
  return between(a, b, sqrt(dot(a, a) * dot(b, b)));
}

/// Chooses signs so that each quaternion is at most a half turn from the same joint's in the frame before. rotations
/// (frames, joints). Throws shape_error 205.
template <Scalar S>
std::vector<Quaternion<S>> continuous(std::span<const Quaternion<S>> rotations, Index joints) {
  if (joints <= 0 || std::ssize(rotations) % joints != 0) {
    raise<shape_error>(205, "continuous: ", rotations.size(), " rotations for frames of ", joints, " joints");
  }
  std::vector<Quaternion<S>> out(rotations.begin(), rotations.end());
  const auto n = static_cast<std::size_t>(joints);
  for (std::size_t i = n; i < out.size(); ++i) {
    if (dot(out[i - n], out[i]) < 0) out[i] = -out[i];
  }
  return out;
}

/// a at t = 0, b at t = 1; both are normalised first, and no sign is changed.
///     d = b a^-1 = (cos h, sin h u);   slerp = (cos(t h), sin(t h) u) a
template <class S>
Quaternion<S> slerp(const Quaternion<S>& a, const Quaternion<S>& b, const S& t) {
  const Quaternion<S> from = normalized(a), d = normalized(normalized(b) * inverse(from));
  const S h = atan2(norm(d.vec()), d.w);
  const Vec3<S> u = sin(t * h) * normalized(d.vec(), 1e-9);
  return Quaternion<S>{cos(t * h), u.x, u.y, u.z} * from;
}

/// Among q and -q, the quaternion whose component by which the published code divides is positive. So w may be
/// negative.
template <Scalar S>
Quaternion<S> matrix_to_quaternion(const Matrix3<S>& m) {
  const Quaternion<S> q = to_quaternion(m);
  const S x = m(0, 0), y = m(1, 1), divisor = m(2, 2) < 0 ? (x > y ? q.x : q.y) : (x < -y ? q.z : q.w);
  return divisor < 0 ? -q : q;
}

/// From angles about x, y and z in degrees, in any order. For the cyclic orders xyz, yzx and zxy the quaternion has the
/// opposite sign.
template <Scalar S>
Quaternion<S> from_euler_degrees(const Vec3<S>& angles, EulerOrder order) {
  Quaternion<S> q = Quaternion<S>::identity();
  for (const int axis : order.axis) {
    const Vec3<S> about{S(axis == 0), S(axis == 1), S(axis == 2)};
    q = q * from_axis_angle(about, dot(about, angles) * S(degree));
  }
  return (order.axis[1] - order.axis[0] + 3) % 3 == 1 ? -q : q;
}

}  // namespace guo
MOTIONLANG_NAMESPACE_END
