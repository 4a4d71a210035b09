// SPDX-License-Identifier: MIT
/// Joint positions of any person on a skeleton of given bone lengths. Every bone keeps its direction, and the path of
/// the root is scaled with the length of the leg.
///
///     scale = (thigh + shank of the target) / (thigh + shank of frame 0)
///     X_0 = scale p_0,   X_j = X_parent(j) + length_j (p_j - p_parent(j)) / |p_j - p_parent(j)|
///
/// Source  Guo et al. (CVPR 2022), HumanML3D motion_representation.ipynb uniform_skeleton. The published code converts
///         to rotations and back, which cancels. Its NaN for a bone opposite to its zero direction is not reproduced.
#pragma once

#include <span>    // joints
#include <vector>  // result

#include <motionlang/kinematics/chain_kinematics.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct UniformJoints {
  std::vector<Vec3<S>> joints;  // (frames, joints)
  S scale{};                    // of the root's path
};

/// joints   (frames, joints)
/// lengths  (joints), of the target's bones
/// The result keeps its own height; it does not search for the floor. Without frames it is empty, with scale 0.
/// Throws   shape_error 204, 205, config_error 106, numeric_error 301 for a bone that is not finite, 302 for one of
///          length 0
template <Scalar S>
UniformJoints<S> uniform_skeleton(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                  std::span<const S> lengths) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("uniform_skeleton", skeleton, joints);
  if (lengths.size() != n) {
    raise<shape_error>(204, "uniform_skeleton: ", lengths.size(), " lengths for ", n, " joints");
  }
  UniformJoints<S> out{std::vector<Vec3<S>>(joints.size()), S(0)};
  if (frames == 0) return out;
  const auto source = bone_lengths(skeleton, joints.first(n));
  auto leg = [&](const auto& of) {
    return detail::joint_of(of.data(), skeleton.leg[0]) + detail::joint_of(of.data(), skeleton.leg[1]);
  };
  out.scale = leg(lengths) / leg(source);
  const auto bones = skeleton.bones();
  for (std::size_t t = 0; t < frames; ++t) {
    Vec3<S>* to = &out.joints[t * n];
    to[0] = out.scale * joints[t * n];
    for (const ChainBone& b : bones) {
      const auto [v, length] = detail::measure_bone(skeleton, b, &joints[t * n], t);
      to[b.joint] = to[b.parent] + (lengths[b.joint] / length) * v;
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
