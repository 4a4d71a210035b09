// SPDX-License-Identifier: MIT
/// Joint positions in a mirror that stands in the plane x = 0: how HumanML3D doubles its clips. Of whole motions, with
/// rotations: motion_tools.hpp.
///
/// Source  Guo et al. (CVPR 2022), raw_pose_processing.ipynb swap_left_right; spec humanml3d-features.md 8
#pragma once

#include <array>   // fingers
#include <span>    // joints
#include <vector>  // result

#include <motionlang/geometry/vec.hpp>
#include <motionlang/kinematics/body_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Partners of the 22 joints of HumanML3D or the 52 of SMPL-H. The published list of the fingers pairs wrong ones (the
/// left index finger with the right little one, ...); `fix_fingers` pairs the right ones.
/// Throws config_error 101 for another number of joints.
inline std::vector<int> humanml3d_mirror_partners(int joints, bool fix_fingers = false) {
  if (joints != 22 && joints != 52) raise<config_error>(101, "humanml3d_mirror_partners: ", joints, " joints");
  std::vector<int> out(smpl_mirror_joint.begin(), smpl_mirror_joint.begin() + 22);
  if (joints == 22) return out;
  // First joints of the fingers of three joints: left index, thumb, middle, ring, little finger, and their partners.
  constexpr std::array<int, 5> left{22, 34, 25, 31, 28}, published{43, 46, 40, 37, 49}, right{37, 49, 40, 46, 43};
  out.resize(52);
  for (std::size_t finger = 0; finger < 5; ++finger) {
    for (int k = 0; k < 3; ++k) {
      const int l = left[finger] + k, r = (fix_fingers ? right : published)[finger] + k;
      out[static_cast<std::size_t>(l)] = r;
      out[static_cast<std::size_t>(r)] = l;
    }
  }
  return out;
}

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
