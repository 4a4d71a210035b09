// SPDX-License-Identifier: MIT
// Bodies of delayed.hpp.
#pragma once

#include <cmath>  // llround

#include <motionlang/kinematics/delayed.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Motion delayed(const Motion& motion, double seconds) {
  if (motion.frames() == 0) raise<shape_error>(203, "delayed: '", motion.name, "' has no frame");
  if (!(seconds >= 0) || !(seconds * motion.fps * motion.skeleton.size() <= max_rotations))
    raise<config_error>(101, "delayed: ", seconds, " s before '", motion.name, "' at ", motion.fps,
                        " frames per second");
  const auto frames = static_cast<std::size_t>(std::llround(seconds * motion.fps));
  Motion out = motion;
  out.root.insert(out.root.begin(), frames, motion.root.front());
  const auto first = motion.rotations(0);
  std::vector<Quaternion<double>> still;
  still.reserve(frames * first.size());
  for (std::size_t f = 0; f < frames; ++f) still.insert(still.end(), first.begin(), first.end());
  out.local.insert(out.local.begin(), still.begin(), still.end());
  return out;
}

MOTIONLANG_NAMESPACE_END
