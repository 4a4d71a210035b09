// SPDX-License-Identifier: MIT
// Bodies of match_motion.hpp.
#pragma once

#include <motionlang/kinematics/match_motion.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Motion match_motion(Motion motion, const Motion& other) {
  if (motion.skeleton != other.skeleton) {
    motion = retarget(motion, other.skeleton);  // on y = 0
    Motion standing = other;
    const double up = place_on_floor(standing);
    for (auto& root : motion.root) root.y -= up;
  }
  return motion.fps == other.fps ? motion : resample(motion, other.fps);
}

MOTIONLANG_NAMESPACE_END
