// SPDX-License-Identifier: MIT
/// Rotations as numbers of a feature vector, the way ACTOR, TEMOS, TEACH and SINC write them, and ACTOR's motions made
/// of them.
///
///     rotvec   3   rotation vector, radians
///     rotquat  4   quaternion, w first
///     rotmat   9   matrix, row by row
///     rot6d    6   first two rows of the matrix; what all published models use
///
/// Source  ACTOR (Petrovich et al., ICCV 2021), src/datasets/dataset.py; conversions: geometry/pytorch3d.hpp;
///         spec actor.md 4.1, 4.2
#pragma once

#include <array>        // names
#include <span>         // numbers
#include <string_view>  // names
#include <vector>       // numbers

#include <motionlang/geometry/pytorch3d.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

enum class PoseRepresentation : int { rotvec, rotquat, rotmat, rot6d };
inline constexpr std::array<std::string_view, 4> pose_representation_names{"rotvec", "rotquat", "rotmat", "rot6d"};

/// Numbers of one rotation.
constexpr Index size(PoseRepresentation r) {
  constexpr Index sizes[] = {3, 4, 9, 6};
  return sizes[static_cast<int>(r)];
}
/// Throws config_error 103.
inline PoseRepresentation parse_pose_representation(std::string_view name) {
  for (std::size_t i = 0; i < pose_representation_names.size(); ++i) {
    if (name == pose_representation_names[i]) return static_cast<PoseRepresentation>(i);
  }
  raise<config_error>(103, "parse_pose_representation: '", name, "' is not rotvec, rotquat, rotmat or rot6d");
}

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

/// Appends the numbers of a matrix.
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
/// Appends the numbers of a rotation vector, which rotvec keeps as it is.
template <Scalar S>
void append_rotation(std::vector<S>& out, PoseRepresentation r, const AxisAngle<S>& v) {
  if (r == PoseRepresentation::rotvec) return detail::append_vector(out, v.v);
  if (r == PoseRepresentation::rotquat) return detail::append_quaternion(out, to_quaternion(v));
  append_rotation(out, r, to_matrix(v));
}
/// The matrix of the numbers, which may be whole tensors. Throws shape_error 205.
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
  bool translation = true;  // one more row: the root's way since frame 0, filled up with zeros
  bool global = true;       // false: without joint 0
};

/// What ACTOR's networks read.
/// poses    (frames, joints)
/// root     (frames), the pelvis; read if `translation` is on
/// result   (rows, numbers, frames): a row for each joint, then the root's
/// Throws   shape_error 205 if the sizes do not fit
template <Scalar S>
std::vector<S> actor_features(std::span<const AxisAngle<S>> poses, std::span<const Vec3<S>> root, Index joints,
                              const ActorFeatureOptions& options = {}) {
  const Index frames = joints > 0 ? std::ssize(poses) / joints : 0, numbers = size(options.rotations);
  if (joints < 1 || std::ssize(poses) != frames * joints || (options.translation && std::ssize(root) != frames)) {
    raise<shape_error>(205, "actor_features: ", poses.size(), " rotations of ", joints, " joints, ", root.size(),
                       " root positions");
  }
  const Index first = options.global ? 0 : 1, rows = joints - first + (options.translation ? 1 : 0);
  std::vector<S> out(static_cast<std::size_t>(rows * numbers * frames)), row;
  for (Index t = 0; t < frames; ++t) {
    row.clear();
    for (Index j = first; j < joints; ++j) {
      append_rotation(row, options.rotations, poses[static_cast<std::size_t>(t * joints + j)]);
    }
    if (options.translation) detail::append_vector(row, root[static_cast<std::size_t>(t)] - root[0]);
    for (std::size_t i = 0; i < row.size(); ++i)
      out[i * static_cast<std::size_t>(frames) + static_cast<std::size_t>(t)] = row[i];
  }
  return out;
}

/// The same of positions (its representation "xyz"), with the root of frame 0 at the origin.
/// joints (frames, joints) -> (joints, 3, frames). Throws shape_error 205.
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

}  // namespace motionlang::inline MOTIONLANG_ABI
