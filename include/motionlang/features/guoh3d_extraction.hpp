// SPDX-License-Identifier: MIT
/// The 263 values per frame of HumanML3D ("guoh3dfeats"), or KIT's 251, from joint positions. The joints are put onto
/// the reference skeleton and the floor and turned to face +Z. Rotations, velocities and contacts follow. The other
/// direction is in guoh3d.hpp.
///
///     auto features = guoh3d_features(humanml3d_chains(), joints);     // (frames, 22) -> (frames - 1, 263)
///
/// Another body is another ChainSkeleton. Guoh3dSlots in layout.hpp explains the values.
///
/// Source  Guo et al. (CVPR 2022), motion_representation.ipynb process_file, extract_features
/// World   Y up; velocities and turns per frame (20 frames per second, KIT 12.5)
#pragma once

#include <algorithm>  // min, clamp
#include <array>      // feet
#include <cmath>      // asin
#include <span>       // joints
#include <vector>     // result

#include <motionlang/core/lane_rows.hpp>
#include <motionlang/features/layout.hpp>
#include <motionlang/geometry/rotation6d.hpp>
#include <motionlang/kinematics/uniform_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The defaults are as published.
struct Guoh3dOptions {
  ChainRotationOptions rotations{.facing = {.sigma = 20}};
  /// false: if the heading passes 180 degrees, the turn of that frame gets the wrong sign.
  bool fix_yaw_sign = false;
};

/// Options without the errors of the published code. The heading follows hips and shoulders alike, does not jump after
/// the first frame, and passes 180 degrees. A bone may be opposite to its zero direction.
inline Guoh3dOptions guoh3d_corrected() {
  return {.rotations = {.facing = {.sigma = 20, .legacy_forward = false},
                        .fix_first_frame = true,
                        .fix_opposite_bones = true},
          .fix_yaw_sign = true};
}

namespace detail {

/// A turn about Y, like the rotation of a root. It takes two products for each coordinate instead of a quaternion's.
template <ScalarLike T>
struct LevelTurn {
  T c, s;  // cosine and sine

  explicit LevelTurn(const Quaternion<T>& q) : c(q.w * q.w - q.y * q.y), s(T(2) * q.w * q.y) {}
  Vec3<T> operator()(const Vec3<T>& v) const { return {c * v.x + s * v.z, v.y, c * v.z - s * v.x}; }
};

}  // namespace detail

/// Joints on the floor. Frame 0 is at x = z = 0 and faces +Z.
template <Scalar S>
struct GroundedJoints {
  std::vector<Vec3<S>> joints;  // (frames, joints)
  S floor{};                    // height of the lowest joint of the clip, before
  Quaternion<S> turn{};         // last turn of all joints
};

/// first   how to find the facing direction of frame 0; as published, from this frame alone. A body that faces -Z is
///         turned by 180 degrees; published: NaN
/// Throws  shape_error 205 if the joints are not whole frames, config_error 101 (sigma) and 106
template <Scalar S>
GroundedJoints<S> ground_joints(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                const FacingOptions& first = {.legacy_forward = false}) {
  detail::chain_frames("ground_joints", skeleton, joints);
  GroundedJoints<S> out{{}, S(0), Quaternion<S>::identity()};
  if (joints.empty()) return out;
  out.floor = joints[0].y;
  for (const Vec3<S>& p : joints) out.floor = std::min(out.floor, p.y);
  const auto facing = facing_directions(skeleton, first.sigma == 0 ? joints.first(skeleton.size()) : joints, first);
  out.turn = detail::turn_ahead(facing[0]);
  const Vec3<S> origin{joints[0].x, out.floor, joints[0].z};
  out.joints.resize(joints.size());
  const detail::LevelTurn<S> level(out.turn);
  for (std::size_t i = 0; i < joints.size(); ++i) out.joints[i] = level(joints[i] - origin);
  return out;
}

/// 1 while the squared displacement to the next frame is below the threshold, else 0.
template <ScalarLike T>
T guoh3d_contact(const Vec3<T>& now, const Vec3<T>& next, double threshold) {
  const Vec3<T> moved = next - now;
  return where_less(dot(moved, moved), T(threshold), T(1), T(0));
}
/// The same of two joints over time: (frames, joints) -> (frames - 1, 2). Throws shape_error 205, 203 for a joint that
/// does not exist.
template <Scalar S>
std::vector<S> guoh3d_contacts(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                               const std::array<int, 2>& foot) {
  const std::size_t frames = detail::chain_frames("guoh3d_contacts", skeleton, joints);
  for (const int j : foot) {
    if (j < 0 || static_cast<std::size_t>(j) >= skeleton.size())
      raise<shape_error>(203, "guoh3d_contacts: joint ", j, " of ", skeleton.size());
  }
  std::vector<S> out;
  for (std::size_t t = 0; t + 1 < frames; ++t) {
    const Vec3<S>*now = &joints[t * skeleton.size()], *next = now + skeleton.size();
    for (const int j : foot) {
      out.push_back(guoh3d_contact(detail::joint_of(now, j), detail::joint_of(next, j), skeleton.foot_threshold));
    }
  }
  return out;
}

/// The rotation from one root rotation to the next. Its y is the sine of half the turn. fix_sign: along the shorter
/// arc.
template <ScalarLike T>
Quaternion<T> guoh3d_turn(const Quaternion<T>& root, const Quaternion<T>& next, bool fix_sign = false) {
  const Quaternion<T> q = next * inverse(root);
  return fix_sign ? where_less(q.w, T(0), T(-1), T(1)) * q : q;
}
/// The displacement of the root to the next frame, seen from the body there.
template <ScalarLike T>
Vec3<T> guoh3d_root_velocity(const Quaternion<T>& next, const Vec3<T>& now_position, const Vec3<T>& next_position) {
  return rotate(next, next_position - now_position);
}
/// A joint seen from the body: x and z relative to the body's root, and the height above the floor.
template <ScalarLike T>
Vec3<T> guoh3d_position(const Quaternion<T>& root, const Vec3<T>& root_position, const Vec3<T>& joint) {
  return rotate(root, joint - Vec3<T>{root_position.x, T(0), root_position.z});
}

namespace detail {

/// One row, or one in each lane: rotations of the frame, root rotation of the next frame, joints of both. Value 0 is
/// left as the sine of half the turn.
template <ScalarLike T>
void guoh3d_row(const ChainSkeleton& skeleton, bool fix_yaw_sign, std::span<const Quaternion<T>> local,
                const Quaternion<T>& next_root, std::span<const Vec3<T>> now, std::span<const Vec3<T>> next, T* to) {
  auto put = [&](const Vec3<T>& v) { *to++ = v.x, *to++ = v.y, *to++ = v.z; };
  const Quaternion<T>& root = local[0];
  const LevelTurn<T> level(root);
  const Vec3<T> on_floor{now[0].x, T(0), now[0].z}, speed = LevelTurn<T>(next_root)(next[0] - now[0]);
  *to++ = guoh3d_turn(root, next_root, fix_yaw_sign).y;
  *to++ = speed.x;
  *to++ = speed.z;
  *to++ = now[0].y;
  for (std::size_t j = 1; j < now.size(); ++j) put(level(now[j] - on_floor));
  for (std::size_t j = 1; j < now.size(); ++j) {
    const auto columns = to_rotation6d_columns(local[j]);
    put(columns.a);
    put(columns.b);
  }
  for (std::size_t j = 0; j < now.size(); ++j) put(level(next[j] - now[j]));
  for (const auto& foot : {skeleton.left_foot, skeleton.right_foot}) {
    for (const int j : foot) {
      *to++ = guoh3d_contact(joint_of(now.data(), j), joint_of(next.data(), j), skeleton.foot_threshold);
    }
  }
}

}  // namespace detail

/// joints  (frames, joints), grounded
/// result  (frames - 1, 12 J - 1)
/// Throws  shape_error 205 for fewer than two frames or joints that are not whole frames, config_error 101 (sigma) and
///         106, numeric_error 301, 302
template <Scalar S>
std::vector<S> guoh3d_from_grounded(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                    const Guoh3dOptions& options = {}) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("guoh3d_from_grounded", skeleton, joints);
  if (frames < 2) raise<shape_error>(205, "guoh3d_from_grounded: ", frames, " frames; a row is made of two");
  const auto bones = skeleton.bones();
  const auto roots = detail::chain_roots(skeleton, joints, options.rotations);
  const std::size_t rows = frames - 1, width = static_cast<std::size_t>(Guoh3dSlots{static_cast<Index>(n)}.size());
  std::vector<S> out(width * rows);

  using L = Lane<S>;  // eight frames at once
  const auto zero = [&] {
    std::vector<Vec3<L>> directions;
    for (const auto& d : skeleton.directions) directions.push_back({L(d.x), L(d.y), L(d.z)});
    return directions;
  }();
  std::vector<Vec3<L>> now(n), next(n);
  std::vector<Quaternion<L>> world(n), local(n);
  std::vector<L> row(width);
  for (std::size_t first = 0; first < rows; first += L::size) {
    Quaternion<L> root, next_root;
    for (int i = 0; i < L::size; ++i) {
      const std::size_t t = std::min(first + static_cast<std::size_t>(i), rows - 1);
      auto lane = [i](Vec3<L>& to, const Vec3<S>& v) { to.x[i] = v.x, to.y[i] = v.y, to.z[i] = v.z; };
      auto turn = [i](Quaternion<L>& to, const Quaternion<S>& q) {
        to.w[i] = q.w, to.x[i] = q.x, to.y[i] = q.y, to.z[i] = q.z;
      };
      for (std::size_t j = 0; j < n; ++j) lane(now[j], joints[t * n + j]), lane(next[j], joints[(t + 1) * n + j]);
      turn(root, roots[t]), turn(next_root, roots[t + 1]);
    }
    const L bad = detail::chain_rotations<L>(bones, zero, now.data(), root, options.rotations.fix_opposite_bones,
                                             world.data(), local.data());
    detail::guoh3d_row<L>(skeleton, options.fix_yaw_sign, local, next_root, now, next, row.data());
    const int count = static_cast<int>(std::min<std::size_t>(L::size, rows - first));
    store_rows(std::span<const L>(row), width, count, &out[first * width]);
    for (int i = 0; i < count; ++i) {
      const std::size_t t = first + static_cast<std::size_t>(i);
      if (bad[i] > 0) detail::require_bones(skeleton, bones, &joints[t * n], t);
      S& turn = out[t * width];
      turn = std::asin(std::clamp(turn, S(-1), S(1)));
    }
  }
  detail::require_bones(skeleton, bones, &joints[rows * n], rows);
  return out;
}

/// All steps together.
/// joints   (frames, joints), of any person at any place
/// lengths  (joints), bones of the reference skeleton
/// result   (frames - 1, 12 J - 1)
/// With fix_first_frame the smooth heading of frame 0 is turned onto +Z, so that the identity is right there.
/// Throws   as above; shape_error 204 unless there is one length for each joint
template <Scalar S>
std::vector<S> guoh3d_features(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                               std::span<const S> lengths, const Guoh3dOptions& options = {}) {
  const auto uniform = uniform_skeleton(skeleton, joints, lengths);
  const FacingOptions published{.legacy_forward = false}, &smooth = options.rotations.facing;
  const auto grounded = ground_joints(skeleton, std::span<const Vec3<S>>(uniform.joints),
                                      options.rotations.fix_first_frame ? smooth : published);
  return guoh3d_from_grounded(skeleton, std::span<const Vec3<S>>(grounded.joints), options);
}
/// The same with the lengths of the skeleton itself. Throws config_error 101 if it has none, like KIT's.
template <Scalar S>
std::vector<S> guoh3d_features(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                               const Guoh3dOptions& options = {}) {
  if (skeleton.lengths.empty()) {
    raise<config_error>(101, "guoh3d_features: '", skeleton.name, "' has 0 bone lengths for ", skeleton.size(),
                        " joints; take those of its reference clip");
  }
  const std::vector<S> lengths(skeleton.lengths.begin(), skeleton.lengths.end());
  return guoh3d_features(skeleton, joints, std::span<const S>(lengths), options);
}

MOTIONLANG_NAMESPACE_END
