// SPDX-License-Identifier: MIT
// Bodies of track.hpp.
#pragma once

#include <cmath>  // isfinite

#include <motionlang/core/error.hpp>
#include <motionlang/view/track.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void require_finite_times(const char* who, std::span<const Track> tracks) {
  for (const Track& t : tracks) {
    if (!std::isfinite(t.start + t.end))
      raise<config_error>(101, who, ": track '", t.text, "' from ", t.start, " s to ", t.end, " s");
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
