// SPDX-License-Identifier: MIT
// Bodies of join_motions.hpp.
#pragma once

#include <algorithm>  // max
#include <cmath>      // round
#include <utility>    // move

#include <motionlang/core/option_error.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/join_motions.hpp>
#include <motionlang/kinematics/match_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Motion join_motions(const Motion& first, Motion second, double blend) {
  second = match_motion(std::move(second), first);
  const double frames = std::max(1.0, std::round(blend * first.fps));
  const Motion& shorter = first.frames() < second.frames() ? first : second;
  if (frames > static_cast<double>(shorter.frames()))
    raise<option_error>(101, "join: '", shorter.name, "' has ", counted(shorter.frames(), "frame"), " at ", shorter.fps,
                        " per second, `blend` ", blend, " takes ", frames);
  return blend_into(first, second, static_cast<Index>(frames));
}

MOTIONLANG_NAMESPACE_END
