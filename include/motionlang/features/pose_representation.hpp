// SPDX-License-Identifier: MIT
/// Rotations as values of a feature vector, as in ACTOR, TEMOS, TEACH and SINC, and ACTOR's motions from them.
///
///     rotvec   3   rotation vector, radians
///     rotquat  4   quaternion, w first
///     rotmat   9   matrix, row by row
///     rot6d    6   first two rows of the matrix; what all published models use
///
/// Source  ACTOR (Petrovich et al., ICCV 2021), src/datasets/dataset.py; conversions: geometry/pytorch3d.hpp;
///         thesis 3.3.2, table 3.1
#pragma once

#include <array>        // names
#include <numbers>      // pi
#include <span>         // numbers
#include <string_view>  // names
#include <vector>       // numbers

#include <motionlang/features/layout.hpp>
#include <motionlang/geometry/pytorch3d.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class PoseRepresentation : int { rotvec, rotquat, rotmat, rot6d };
inline constexpr std::array<std::string_view, 4> pose_representation_names{"rotvec", "rotquat", "rotmat", "rot6d"};

/// The number of values of one rotation.
constexpr Index size(PoseRepresentation r) {
  constexpr Index sizes[] = {3, 4, 9, 6};
  return sizes[static_cast<int>(r)];
}
/// Throws config_error 103.
PoseRepresentation parse_pose_representation(std::string_view name);

namespace detail {

template <Scalar S>
void append_vector(std::vector<S>& out, const Vec3<S>& v) {
  out.insert(out.end(), {v.x, v.y, v.z});
}
template <Scalar S>
void append_quaternion(std::vector<S>& out, const Quaternion<S>& q) {
  out.insert(out.end(), {q.w, q.x, q.y, q.z});
}

}  // namespace detail

/// Appends the values of a matrix.
template <Scalar S>
void append_rotation(std::vector<S>& out, PoseRepresentation r, const Matrix3<S>& m) {
  switch (r) {
    case PoseRepresentation::rotvec:
      return detail::append_vector(out, pytorch3d::matrix_to_axis_angle(m));
    case PoseRepresentation::rotquat:
      return detail::append_quaternion(out, pytorch3d::matrix_to_quaternion(m));
    default:
      out.insert(out.end(), m.m.begin(), m.m.begin() + size(r));  // rows
  }
}
/// Appends the values of a rotation vector, which rotvec keeps unchanged.
template <Scalar S>
void append_rotation(std::vector<S>& out, PoseRepresentation r, const AxisAngle<S>& v) {
  if (r == PoseRepresentation::rotvec) return detail::append_vector(out, v.v);
  if (r == PoseRepresentation::rotquat) return detail::append_quaternion(out, to_quaternion(v));
  append_rotation(out, r, to_matrix(v));
}
/// The matrix for the values, which may be whole tensors. Throws shape_error 205.
template <ScalarLike S>
Matrix3<S> rotation_from(PoseRepresentation r, std::span<const S> n) {
  if (std::ssize(n) != size(r)) {
    raise<shape_error>(205, "rotation_from: ", n.size(), " numbers for '",
                       pose_representation_names[static_cast<std::size_t>(r)], "' of ", size(r));
  }
  switch (r) {
    case PoseRepresentation::rotvec:
      return to_matrix(AxisAngle<S>{{n[0], n[1], n[2]}});
    case PoseRepresentation::rotquat:
      return to_matrix(Quaternion<S>{n[0], n[1], n[2], n[3]});
    case PoseRepresentation::rotmat:
      return {{n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8]}};
    default:
      return to_matrix(Rotation6dRows<S>{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}});
  }
}

struct ActorFeatureOptions {
  PoseRepresentation rotations = PoseRepresentation::rot6d;
  bool translation = true;  // one more row: the root's path since frame 0, padded with zeros
  bool global = true;       // false: without joint 0

  /// Rows of a frame of this many joints.
  Index rows(Index joints) const { return joints - (global ? 0 : 1) + (translation ? 1 : 0); }
};
/// ACTOR's rotation of joint 0 if features have none: a figure that is upside down in the world of the camera.
inline constexpr Vec3<double> actor_global_rotation{std::numbers::pi, 0, 0};

/// A frame of ACTOR: a rotation of each joint, then the root's path (see `actor_frame_features`), which belongs to the
/// part with the path: 150.
FeatureLayout actor_layout(std::span<const BodyPart> part_of_joint = smpl_part_of_joint,
                           const ActorFeatureOptions& options = {}, const BodyPartition& body = {});

/// The meaning of the values of `actor_layout`. World: that of a camera, in which figures are upside down.
inline constexpr std::array<FeatureRange, 4> actor_ranges{{
    {{0, 6}, "rotation in the world: the first two rows of the matrix", "1", {0, 1}},
    {{6, 144}, "rotation relative to the parent: the first two rows of the matrix", "1", {1, 24}},
    {{144, 147}, "way of the root since frame 0: x, y, z", "m"},
    {{147, 150}, "0: the root's row is as long as the others", "1"},
}};

/// The input of ACTOR's networks, frame by frame.
/// poses    (frames, joints): rotation vectors or matrices
/// root     (frames), the pelvis; read if `translation` is on
/// result   (frames, rows numbers): a row for each joint, then the root's
/// Throws   shape_error 205 if the sizes do not fit
template <class R, Scalar S>
std::vector<S> actor_frame_features(std::span<const R> poses, std::span<const Vec3<S>> root, Index joints,
                                    const ActorFeatureOptions& options = {}) {
  const Index frames = joints > 0 ? std::ssize(poses) / joints : 0;
  if (joints < 1 || std::ssize(poses) != frames * joints || (options.translation && std::ssize(root) != frames)) {
    raise<shape_error>(205, "actor_frame_features: ", poses.size(), " rotations of ", joints, " joints, ", root.size(),
                       " root positions");
  }
  std::vector<S> out;
  for (Index t = 0; t < frames; ++t) {
    for (Index j = options.global ? 0 : 1; j < joints; ++j) {
      append_rotation(out, options.rotations, poses[static_cast<std::size_t>(t * joints + j)]);
    }
    if (!options.translation) continue;
    detail::append_vector(out, root[static_cast<std::size_t>(t)] - root[0]);
    out.resize(out.size() + static_cast<std::size_t>(size(options.rotations) - 3));
  }
  return out;
}
/// The same with time last, as in its repository: (rows, numbers, frames).
template <class R, Scalar S>
std::vector<S> actor_features(std::span<const R> poses, std::span<const Vec3<S>> root, Index joints,
                              const ActorFeatureOptions& options = {}) {
  const std::vector<S> by_frame = actor_frame_features(poses, root, joints, options);
  const auto width = static_cast<std::size_t>(options.rows(joints) * size(options.rotations));
  std::vector<S> out(by_frame.size());
  if (width == 0) return out;
  const std::size_t frames = out.size() / width;
  for (std::size_t i = 0; i < out.size(); ++i) out[i % width * frames + i / width] = by_frame[i];
  return out;
}

template <Scalar S>
struct ActorMotion {
  std::vector<Matrix3<S>> rotations;  // (frames, joints)
  std::vector<Vec3<S>> root;          // (frames), since frame 0
};

/// features  (frames, rows numbers), as `actor_frame_features` returns them and networks use them
/// Joint 0 is `actor_global_rotation` if the features have none. Without a translation the root stays in place.
/// Throws    shape_error 205 if the features are not whole frames, config_error 101 for no joints
template <Scalar S>
ActorMotion<S> actor_inverse(std::span<const S> features, Index joints = 24, const ActorFeatureOptions& options = {}) {
  if (joints < 1) raise<config_error>(101, "actor_inverse: ", joints, " joints");
  const auto numbers = static_cast<std::size_t>(size(options.rotations));
  const auto width = static_cast<std::size_t>(options.rows(joints)) * numbers;
  if (width == 0 || features.size() % width != 0)
    raise<shape_error>(205, "actor_inverse: ", features.size(), " values are not frames of ", width);
  ActorMotion<S> out;
  for (std::size_t at = 0; at < features.size(); at += width) {
    std::size_t from = at;
    if (!options.global) out.rotations.push_back(to_matrix(AxisAngle<S>{vec_cast<S>(actor_global_rotation)}));
    for (Index j = options.global ? 0 : 1; j < joints; ++j, from += numbers)
      out.rotations.push_back(rotation_from(options.rotations, features.subspan(from, numbers)));
    out.root.push_back(options.translation ? Vec3<S>{features[from], features[from + 1], features[from + 2]}
                                           : Vec3<S>{});
  }
  return out;
}

/// The same for positions (representation "xyz"), with the root of frame 0 at the origin. joints (frames, joints) ->
/// (joints, 3, frames). Throws shape_error 205.
template <Scalar S>
std::vector<S> actor_joint_features(std::span<const Vec3<S>> positions, Index joints) {
  if (joints < 1 || std::ssize(positions) % joints != 0) {
    raise<shape_error>(205, "actor_joint_features: ", positions.size(), " positions for frames of ", joints);
  }
  const std::size_t n = static_cast<std::size_t>(joints), frames = positions.size() / n;
  std::vector<S> out(3 * positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3<S> p = positions[i] - positions[0];
    S* to = &out[3 * (i % n) * frames + i / n];
    to[0] = p.x, to[frames] = p.y, to[2 * frames] = p.z;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/pose_representation.ipp>
#endif
