// SPDX-License-Identifier: MIT
// Bodies of tm2t_data.hpp.
#pragma once

#include <algorithm>  // find_if

#include <motionlang/datasets/tm2t_data.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<ClipWindow> tm2t_windows(std::span<const Index> lengths, Index window) {
  if (window < 1) raise<config_error>(101, "tm2t_windows: windows of ", window);
  std::vector<ClipWindow> out;
  const auto first = std::find_if(lengths.begin(), lengths.end(), [&](Index length) { return length >= window; });
  out.push_back({first - lengths.begin(), 0});
  for (Index clip = 0; clip < std::ssize(lengths); ++clip) {
    for (Index start = 0; start < lengths[static_cast<std::size_t>(clip)] - window; ++start)
      out.push_back({clip, start});
  }
  out.pop_back();
  return out;
}

MOTIONLANG_BODY FrameSlice tm2t_token_frames(Index frames, PythonRandom& random, Index unit) {
  const Index length = unit > 0 ? frames / unit * unit : 0;
  if (length < 1) raise<config_error>(101, "tm2t_token_frames: of ", frames, " frames in units of ", unit);
  return {static_cast<Index>(random.randint(0, frames - length)), length};
}

MOTIONLANG_NAMESPACE_END
