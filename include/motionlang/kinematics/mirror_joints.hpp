// SPDX-License-Identifier: MIT
/// Mirrors joint positions at the plane x = 0, as HumanML3D does to double its clips. motion_tools.hpp mirrors whole
/// motions with rotations.
///
/// Source  Guo et al. (CVPR 2022), raw_pose_processing.ipynb swap_left_right
#pragma once

#include <span>    // joints
#include <vector>  // result

#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Partners of the 22 joints of HumanML3D or the 52 of SMPL-H. The published list pairs wrong fingers (the left index
/// finger with the right little one, ...); `fix_fingers` pairs the right ones. Throws config_error 101 for another
/// number of joints.
std::vector<int> humanml3d_mirror_partners(int joints, bool fix_fingers = false);

/// joints (frames, joints) -> the same, p'_partner(j) = (-x, y, z)_j. Throws shape_error 205, config_error 102 if the
/// partners do not pair up.
template <Scalar S>
std::vector<Vec3<S>> mirror_joints(std::span<const Vec3<S>> joints, std::span<const int> partners) {
  const std::size_t n = partners.size();
  if (n == 0 || joints.size() % n != 0) {
    raise<shape_error>(205, "mirror_joints: ", joints.size(), " positions for frames of ", n, " joints");
  }
  for (std::size_t j = 0; j < n; ++j) {
    const auto p = static_cast<std::size_t>(partners[j]);
    if (p >= n || partners[p] != static_cast<int>(j)) {
      raise<config_error>(102, "mirror_joints: the partner of joint ", j, " is ", partners[j],
                          ", which has another partner");
    }
  }
  std::vector<Vec3<S>> out(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Vec3<S>& p = joints[i];
    out[i - i % n + static_cast<std::size_t>(partners[i % n])] = {-p.x, p.y, p.z};
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/mirror_joints.ipp>
#endif
