// SPDX-License-Identifier: MIT
// Bodies of body_motion.hpp.
#pragma once

#include <motionlang/kinematics/body_motion.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> body_joint_names(BodyKind kind, Index joints) {
  const std::vector<std::string>& smpl = smpl24_skeleton().names;
  const Index known = kind == BodyKind::other ? 0 : kind == BodyKind::smpl ? 24 : 22;
  std::vector<std::string> out(smpl.begin(), smpl.begin() + known);
  if (kind == BodyKind::smplx) out.insert(out.end(), {"jaw", "left_eye", "right_eye"});
  if (kind == BodyKind::smplh || kind == BodyKind::smplx) {
    for (const char* side : {"left_", "right_"}) {
      for (const char* finger : {"index", "middle", "pinky", "ring", "thumb"}) {
        for (const char* number : {"1", "2", "3"}) out.push_back(concat_text(side, finger, number));
      }
    }
  }
  while (std::ssize(out) < joints) out.push_back(concat_text("joint_", out.size()));
  return out;
}

MOTIONLANG_NAMESPACE_END
