// SPDX-License-Identifier: MIT
// Bodies of actor_latents.hpp.
#pragma once

#include <motionlang/generate/actor_latents.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void raise_other_length(Index frames, Index wanted, double fps) {
  const auto seconds = [&](Index n) { return static_cast<double>(n) / fps; };
  raise<option_error>(101, "a motion of ", counted(frames, "frame"), " (", seconds(frames),
                      " s); this ACTOR is fully connected, its motions have ", counted(wanted, "frame"), " (",
                      seconds(wanted), " s)");
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
