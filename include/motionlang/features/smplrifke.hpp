// SPDX-License-Identifier: MIT
/// The 205-vector "smplrifke" of MDM-SMPL and STMC: forward, inverse, and conversions from and to `Motion`. The ranges
/// of the body parts are in layout.hpp.
///
///     0        height of the pelvis above the lowest joint of the clip
///     1:3      its velocity x, y, seen from the body
///     3        turn of the heading to the next frame
///     4:136    22 rotations as 6D rows (rotation6d.hpp)
///     136:205  joints 1 ... 23 relative to the pelvis, seen from the body
/// World: Z up, metres, radians; velocities and turns per frame (the models use 20 frames per second).
/// Source   STMC (Petrovich et al. 2024), src/tools/smplrifke_feats.py
#pragma once

#include <algorithm>  // clamp
#include <cmath>      // asin
#include <numbers>    // pi
#include <vector>     // frames

#include <motionlang/geometry/euler.hpp>
#include <motionlang/geometry/pytorch3d.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

inline constexpr Index smplrifke_size = 205, smplrifke_rotations = 22, smplrifke_joints = 24;

struct SmplRifkeOptions {
  double first_angle = 0;  // heading of the first frame; every published generation uses pi
  bool clamp_asin = true;  // false: as published, where rounding beyond [-1, 1] gives NaN
};

/// A clip in the features' own world (Z up).
template <Scalar S>
struct SmplRifkeMotion {
  std::vector<Vec3<S>> joints;        // (frames, 24)
  std::vector<Vec3<S>> trans;         // (frames): the pelvis
  std::vector<Matrix3<S>> rotations;  // (frames, 22), local; joint 0 in the world

  /// Rotation vectors (frames, 66) by the published formulas (geometry/pytorch3d.hpp), noisy near 0 in float.
  std::vector<S> poses() const {
    std::vector<S> out;
    for (const Matrix3<S>& r : rotations) {
      const Vec3<S> v = pytorch3d::matrix_to_axis_angle(r);
      out.insert(out.end(), {v.x, v.y, v.z});
    }
    return out;
  }
};

namespace detail {

/// R = Rz Ry Rx:  z = atan2(m10, m00), y = asin(-m20), x = atan2(m21, m22).
template <Scalar S>
struct EulerZyx {
  S z, y, x;
};
template <Scalar S>
EulerZyx<S> zyx_angles(const Matrix3<S>& m, bool clamp) {
  const S sine = -m(2, 0), limited = clamp ? std::clamp(sine, S(-1), S(1)) : sine;
  return {std::atan2(m(1, 0), m(0, 0)), std::asin(limited), std::atan2(m(2, 1), m(2, 2))};
}
/// The rotation without its heading.
template <Scalar S>
Matrix3<S> level(const EulerZyx<S>& angles) {
  return axis_rotation(1, angles.y) * axis_rotation(0, angles.x);
}
/// x and y turned by `angle` about Z.
template <Scalar S>
Vec3<S> turn_about_z(const Vec3<S>& v, S angle) {
  const S c = std::cos(angle), s = std::sin(angle);
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}
/// The same angle in [-pi, pi].
template <Scalar S>
S wrapped(S angle) {
  return std::atan2(std::sin(angle), std::cos(angle));
}
/// Differences to the next frame. The last one extrapolates its two predecessors linearly. With two frames it is the
/// same again; with one it is zero (the published code fails there).
template <class T, class Difference>
std::vector<T> to_next(std::size_t frames, Difference difference) {
  std::vector<T> d(frames);
  for (std::size_t i = 0; i + 1 < frames; ++i) d[i] = difference(i);
  if (frames >= 3) d[frames - 1] = d[frames - 2] + (d[frames - 2] - d[frames - 3]);
  if (frames == 2) d[1] = d[0];
  return d;
}

}  // namespace detail

/// rotations  (frames, 22), local; joint 0 in the world
/// joints     (frames, 24), world
/// result     (frames, 205)
/// Throws     shape_error 205 if the sizes do not fit
template <Scalar S>
std::vector<S> smplrifke_features(std::span<const Matrix3<S>> rotations, std::span<const Vec3<S>> joints) {
  const std::size_t frames = joints.size() / smplrifke_joints;
  if (joints.size() != frames * smplrifke_joints || rotations.size() != frames * smplrifke_rotations) {
    raise<shape_error>(205, "smplrifke_features: ", joints.size(), " joints and ", rotations.size(),
                       " rotations; expected 24 and 22 for every frame");
  }
  auto pelvis = [&](std::size_t f) -> const Vec3<S>& { return joints[f * smplrifke_joints]; };
  S floor = frames == 0 ? S(0) : joints[0].z;
  for (const Vec3<S>& p : joints) floor = std::min(floor, p.z);
  std::vector<detail::EulerZyx<S>> angles(frames);
  for (std::size_t f = 0; f < frames; ++f) angles[f] = detail::zyx_angles(rotations[f * smplrifke_rotations], true);
  const auto velocity = detail::to_next<Vec3<S>>(frames, [&](std::size_t f) { return pelvis(f + 1) - pelvis(f); });
  const auto turn =
      detail::to_next<S>(frames, [&](std::size_t f) { return detail::wrapped(angles[f + 1].z - angles[f].z); });

  std::vector<S> out;
  out.reserve(frames * smplrifke_size);
  auto put = [&](const Vec3<S>& v) { out.insert(out.end(), {v.x, v.y, v.z}); };
  for (std::size_t f = 0; f < frames; ++f) {
    const S heading = angles[f].z;
    const Vec3<S> speed = detail::turn_about_z(velocity[f], -heading);
    out.insert(out.end(), {pelvis(f).z - floor, speed.x, speed.y, detail::wrapped(turn[f])});
    for (std::size_t j = 0; j < smplrifke_rotations; ++j) {
      const auto r = j == 0 ? detail::level(angles[f]) : rotations[f * smplrifke_rotations + j];
      put(r.row(0));
      put(r.row(1));
    }
    for (std::size_t j = 1; j < smplrifke_joints; ++j) {
      put(detail::turn_about_z(joints[f * smplrifke_joints + j] - pelvis(f), -heading));
    }
  }
  return out;
}

/// The same from rotation vectors (frames, 66) and joints (frames, 72).
template <Scalar S>
std::vector<S> smplrifke_from_poses(std::span<const S> poses, std::span<const S> joints) {
  if (poses.size() % 3 != 0 || joints.size() % 3 != 0) {
    raise<shape_error>(205, "smplrifke_from_poses: ", poses.size(), " and ", joints.size(), " values");
  }
  std::vector<Matrix3<S>> rotations;
  std::vector<Vec3<S>> points;
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    rotations.push_back(to_matrix(AxisAngle<S>{{poses[i], poses[i + 1], poses[i + 2]}}));
  }
  for (std::size_t i = 0; i < joints.size(); i += 3) points.push_back({joints[i], joints[i + 1], joints[i + 2]});
  return smplrifke_features(std::span<const Matrix3<S>>(rotations), std::span<const Vec3<S>>(points));
}

/// features  (frames, 205)
/// The path starts at x = y = 0 with the heading `first_angle`. The velocity and turn of the last frame, and the
/// heading in the first rotation, are not used.
/// Throws    shape_error 205 if the size is not a multiple of 205
template <Scalar S>
SmplRifkeMotion<S> smplrifke_inverse(std::span<const S> features, const SmplRifkeOptions& options = {}) {
  if (features.size() % smplrifke_size != 0) {
    raise<shape_error>(205, "smplrifke_inverse: ", features.size(), " values are not rows of ", smplrifke_size);
  }
  const std::size_t frames = features.size() / smplrifke_size;
  SmplRifkeMotion<S> out;
  S heading = S(options.first_angle);
  Vec3<S> position{};
  for (std::size_t f = 0; f < frames; ++f) {
    const auto row = features.subspan(f * smplrifke_size, smplrifke_size);
    auto vector = [&](std::size_t at) { return Vec3<S>{row[at], row[at + 1], row[at + 2]}; };
    position.z = row[0];
    out.trans.push_back(position);
    for (std::size_t j = 0; j < smplrifke_rotations; ++j) {
      const auto r = to_matrix(Rotation6dRows<S>{vector(4 + 6 * j), vector(7 + 6 * j)});
      const auto own =
          j == 0 ? axis_rotation(2, heading) * detail::level(detail::zyx_angles(r, options.clamp_asin)) : r;
      out.rotations.push_back(own);
    }
    out.joints.push_back(position);
    for (std::size_t j = 1; j < smplrifke_joints; ++j) {
      out.joints.push_back(detail::turn_about_z(vector(133 + 3 * j), heading) + position);
    }
    position = position + detail::turn_about_z(Vec3<S>{row[1], row[2], S(0)}, heading);
    heading = heading + row[3];
  }
  return out;
}

/// The features of a clip on SMPL's 24 joints, with the bones of its skeleton. The rotations of the hands are lost.
/// Resample to the rate of the model first. Throws config_error 103 if the joints are not SMPL's.
std::vector<double> smplrifke_from_motion(const Motion& motion);

/// The clip that the features describe, Y up, on a skeleton with SMPL's 24 joints. It uses rotations and path but not
/// the positions of joints, so bones keep their lengths. With first_angle 0 the first frame faces +Z, up to the turn of
/// the pelvis itself. Throws shape_error 205, and config_error 103 if the joints are not SMPL's.
template <Scalar S>
Motion smplrifke_to_motion(std::span<const S> features, const SmplRifkeOptions& options = {}, double fps = 20,
                           const Skeleton& skeleton = smpl24_skeleton()) {
  if (skeleton.names != smpl24_skeleton().names) {
    raise<config_error>(103, "smplrifke_to_motion: the ", skeleton.size(), " joints are not the 24 of SMPL");
  }
  const auto from = smplrifke_inverse(features, options);
  const auto y_up = axis_rotation(0, -std::numbers::pi / 2);
  Motion out;
  out.skeleton = skeleton;
  out.fps = fps;
  for (std::size_t f = 0; f < from.trans.size(); ++f) {
    const auto p = vec_cast<double>(from.trans[f]);
    out.root.push_back({p.x, p.z, -p.y});
    for (std::size_t j = 0; j < smplrifke_rotations; ++j) {
      const auto r = matrix_cast<double>(from.rotations[f * smplrifke_rotations + j]);
      out.local.push_back(to_quaternion(j == 0 ? y_up * r : r));
    }
    out.local.insert(out.local.end(), 2, Quaternion<double>::identity());  // hands
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/smplrifke.ipp>
#endif
