// SPDX-License-Identifier: MIT
/// Forward kinematics: from local rotations to joint positions. One function serves a single pose (S = float, double),
/// derivatives (Dual), poses side by side in a register (Lane) and a differentiable batch (Tensor; see
/// forward_batch.hpp).
///
///     R_j = R_parent(j) L_j,   p_j = p_parent(j) + R_parent(j) offset_j,   R_0 = L_0, p_0 = root
#pragma once

#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Local rotations of all joints and the position of the root.
template <ScalarLike S>
struct Pose {
  Vec3<S> root{};
  std::vector<Quaternion<S>> local;

  /// All rotations are the identity, and the root is at its place in the skeleton.
  static Pose rest(const Skeleton& skeleton) {
    return {vec_cast<S>(skeleton.offset(0)),
            std::vector<Quaternion<S>>(static_cast<std::size_t>(skeleton.size()), Quaternion<S>::identity())};
  }
};

/// Positions and rotations of all joints in the world.
template <ScalarLike S>
struct JointTransforms {
  std::vector<Vec3<S>> position;
  std::vector<Matrix3<S>> rotation;
};

namespace detail {

/// Computes the position of joint j after its parent, and its rotation if it has children.
template <Rotation R, ScalarLike S>
void place_joint(const Skeleton& skeleton, std::size_t j, const R& local, const Vec3<S>& root, bool rotate,
                 JointTransforms<S>& world) {
  if (j == 0) {
    world.position[0] = root;
    world.rotation[0] = to_matrix(local);
    return;
  }
  const auto p = static_cast<std::size_t>(skeleton.parents[j]);
  world.position[j] = world.position[p] + world.rotation[p] * vec_cast<S>(skeleton.offsets[j]);
  if (rotate) world.rotation[j] = world.rotation[p] * to_matrix(local);
}

}  // namespace detail

/// local     one rotation per joint, in any representation
/// result    resized to the number of joints; pass the same object again to avoid allocations
/// Throws    shape_error 204 if the number of rotations is not the number of joints
template <Rotation R, ScalarLike S>
void forward_kinematics(const Skeleton& skeleton, std::span<const R> local, const Vec3<S>& root,
                        JointTransforms<S>& result) {
  const auto joints = static_cast<std::size_t>(skeleton.size());
  if (local.size() != joints) {
    raise<shape_error>(204, "forward_kinematics: ", local.size(), " rotations for ", joints, " joints");
  }
  result.position.resize(joints);
  result.rotation.resize(joints);
  for (std::size_t j = 0; j < joints; ++j) detail::place_joint(skeleton, j, local[j], root, true, result);
}

template <Rotation R, ScalarLike S>
JointTransforms<S> forward_kinematics(const Skeleton& skeleton, std::span<const R> local, const Vec3<S>& root) {
  JointTransforms<S> result;
  forward_kinematics(skeleton, local, root, result);
  return result;
}

template <ScalarLike S>
JointTransforms<S> forward_kinematics(const Skeleton& skeleton, const Pose<S>& pose) {
  return forward_kinematics(skeleton, std::span<const Quaternion<S>>(pose.local), pose.root);
}

MOTIONLANG_NAMESPACE_END
