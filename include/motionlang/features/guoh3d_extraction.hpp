// SPDX-License-Identifier: MIT
/// The 263 numbers per frame of HumanML3D ("guoh3dfeats"), or KIT's 251, from joint positions: onto the reference
/// skeleton, onto the floor, facing +Z, then rotations, velocities and contacts. Back: guoh3d.hpp.
///
///     auto features = guoh3d_features(humanml3d_chains(), joints);     // (frames, 22) -> (frames - 1, 263)
///
/// Another body is another ChainSkeleton. Which number is what: Guoh3dSlots in layout.hpp.
///
/// Source  Guo et al. (CVPR 2022), motion_representation.ipynb process_file, extract_features;
///         spec humanml3d-features.md 3 to 6
/// World   Y up; velocities and turns per frame (20 frames per second, KIT 12.5)
#pragma once

#include <motionlang/features/layout.hpp>
#include <motionlang/geometry/rotation6d.hpp>
#include <motionlang/kinematics/uniform_skeleton.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// As published, unless something is said.
struct Guoh3dOptions {
  ChainRotationOptions rotations{.facing = {.sigma = 20}};
  /// false: where the heading passes 180 degrees, the turn of that frame gets the wrong sign.
  bool fix_yaw_sign = false;
};

/// Without what the published code gets wrong: the heading follows hips and shoulders alike, does not jump behind the
/// first frame, passes 180 degrees, and a bone may be opposite to its zero direction.
inline Guoh3dOptions guoh3d_corrected() {
  return {.rotations = {.facing = {.sigma = 20, .legacy_forward = false},
                        .fix_first_frame = true,
                        .fix_opposite_bones = true},
          .fix_yaw_sign = true};
}

/// Joints on the floor; frame 0 stands at x = z = 0 and faces +Z.
template <Scalar S>
struct GroundedJoints {
  std::vector<Vec3<S>> joints;  // (frames, joints)
  S floor{};                    // height of the lowest joint of the clip, before
  Quaternion<S> turn{};         // that all joints have been turned by, last
};

/// first   how the facing direction of frame 0 is found; as published, from this frame alone
/// Throws  shape_error 205 if the joints are not whole frames, config_error 101 (sigma)
template <Scalar S>
GroundedJoints<S> ground_joints(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                const FacingOptions& first = {.legacy_forward = false}) {
  detail::chain_frames("ground_joints", skeleton, joints);
  GroundedJoints<S> out{{}, S(0), Quaternion<S>::identity()};
  if (joints.empty()) return out;
  out.floor = joints[0].y;
  for (const Vec3<S>& p : joints) out.floor = std::min(out.floor, p.y);
  const auto facing = facing_directions(skeleton, first.sigma == 0 ? joints.first(skeleton.size()) : joints, first);
  out.turn = guo::between(facing[0], Vec3<S>{S(0), S(0), S(1)});
  const Vec3<S> origin{joints[0].x, out.floor, joints[0].z};
  out.joints.reserve(joints.size());
  for (const Vec3<S>& p : joints) out.joints.push_back(rotate(out.turn, p - origin));
  return out;
}

/// joints (frames, joints) -> (frames - 1, 2): for two joints, 1 while the squared displacement to the next frame is
/// below the threshold, else 0. Throws shape_error 205.
template <Scalar S>
std::vector<S> foot_contacts(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                             const std::array<int, 2>& foot) {
  const std::size_t frames = detail::chain_frames("foot_contacts", skeleton, joints);
  std::vector<S> out;
  for (std::size_t t = 0; t + 1 < frames; ++t) {
    const Vec3<S>*now = &joints[t * skeleton.size()], *next = now + skeleton.size();
    for (const int j : foot) {
      const Vec3<S> moved = detail::joint_of(next, j) - detail::joint_of(now, j);
      out.push_back(dot(moved, moved) < static_cast<S>(skeleton.foot_threshold) ? S(1) : S(0));
    }
  }
  return out;
}

/// The rotation from one root rotation to the next; its y is the sine of half the turn.
/// fix_sign: the shorter way round.
template <Scalar S>
Quaternion<S> guoh3d_turn(const Quaternion<S>& root, const Quaternion<S>& next, bool fix_sign = false) {
  const Quaternion<S> q = next * inverse(root);
  return fix_sign && q.w < 0 ? -q : q;
}
/// The way of the root to the next frame, seen from the body there.
template <Scalar S>
Vec3<S> guoh3d_root_velocity(const Quaternion<S>& next, const Vec3<S>& now_position, const Vec3<S>& next_position) {
  return rotate(next, next_position - now_position);
}
/// A joint seen from the body: x and z relative to the body's root, the height above the floor.
template <Scalar S>
Vec3<S> guoh3d_position(const Quaternion<S>& root, const Vec3<S>& root_position, const Vec3<S>& joint) {
  return rotate(root, joint - Vec3<S>{root_position.x, S(0), root_position.z});
}

/// joints  (frames, joints), grounded
/// result  (frames - 1, 12 J - 1)
/// Throws  shape_error 205 for fewer than two frames or joints that are not whole frames, config_error 101 (sigma) and
///         106, numeric_error 301, 302
template <Scalar S>
std::vector<S> guoh3d_from_grounded(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                    const Guoh3dOptions& options = {}) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("guoh3d_from_grounded", skeleton, joints);
  if (frames < 2) raise<shape_error>(205, "guoh3d_from_grounded: ", frames, " frames; a row is made of two");
  const auto rotations = chain_inverse_kinematics(skeleton, joints, options.rotations);
  const auto left = foot_contacts(skeleton, joints, skeleton.left_foot);
  const auto right = foot_contacts(skeleton, joints, skeleton.right_foot);
  std::vector<S> out(static_cast<std::size_t>(Guoh3dSlots{static_cast<Index>(n)}.size()) * (frames - 1));
  S* to = out.data();
  auto put = [&](const Vec3<S>& v) { *to++ = v.x, *to++ = v.y, *to++ = v.z; };
  for (std::size_t t = 0; t + 1 < frames; ++t) {
    const Vec3<S>*now = &joints[t * n], *next = now + n;
    const Quaternion<S>*q = &rotations[t * n], &root = q[0], &next_root = q[n];
    const Vec3<S> speed = guoh3d_root_velocity(next_root, now[0], next[0]);
    *to++ = std::asin(std::clamp(guoh3d_turn(root, next_root, options.fix_yaw_sign).y, S(-1), S(1)));
    *to++ = speed.x;
    *to++ = speed.z;
    *to++ = now[0].y;
    for (std::size_t j = 1; j < n; ++j) put(guoh3d_position(root, now[0], now[j]));
    for (std::size_t j = 1; j < n; ++j) {
      const auto columns = to_rotation6d_columns(q[j]);
      put(columns.a);
      put(columns.b);
    }
    for (std::size_t j = 0; j < n; ++j) put(rotate(root, next[j] - now[j]));
    for (const auto* foot : {&left, &right}) *to++ = (*foot)[2 * t], *to++ = (*foot)[2 * t + 1];
  }
  return out;
}

/// The whole way.
/// joints   (frames, joints), of anybody, anywhere
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
/// With the lengths of the skeleton itself. Throws config_error 101 if it has none, as KIT's.
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

}  // namespace motionlang::inline MOTIONLANG_ABI
