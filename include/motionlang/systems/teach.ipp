// SPDX-License-Identifier: MIT
// Bodies of teach.hpp.
#pragma once

#include <motionlang/systems/teach.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY Offsets generated_frames(const Offsets& lengths, Index gap) {
  if (gap < 0) raise<config_error>(101, "TEACH: a gap of ", gap, " frames");
  PoolVector<Index> out;
  for (Index i = 0; i < lengths.count(); ++i) {
    out.push_back(lengths.length(i) - (i == 0 ? 0 : gap));
    if (i > 0 && gap > 0 && out[static_cast<std::size_t>(i)] < 2)
      raise<config_error>(101, "TEACH: action ", i, " has ", counted(lengths.length(i), "frame"),
                          "; two or more must follow the gap of ", gap);
  }
  return Offsets(std::span<const Index>(out));
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
