// SPDX-License-Identifier: MIT
// Bodies of overlap.hpp.
#pragma once

#include <motionlang/compose/overlap.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Overlap Overlap::of_frames(Index total) {
  if (total < 0 || total > latest_time) raise<config_error>(101, "Overlap: ", total, " frames");
  return {total / 2, total - total / 2};
}

MOTIONLANG_NAMESPACE_END
