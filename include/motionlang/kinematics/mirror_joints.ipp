// SPDX-License-Identifier: MIT
// Bodies of mirror_joints.hpp.
#pragma once

#include <array>  // fingers

#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/mirror_joints.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<int> humanml3d_mirror_partners(int joints, bool fix_fingers) {
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

MOTIONLANG_NAMESPACE_END
