// SPDX-License-Identifier: MIT
// Bodies of guo_clip.hpp.
#pragma once

#include <algorithm>  // stable_sort

#include <motionlang/datasets/guo_clip.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> guo_kept_clips(std::span<const Index> lengths, const GuoClipLimits& limits) {
  std::vector<Index> out;
  auto frames = [&](Index clip) { return lengths[static_cast<std::size_t>(clip)]; };
  for (Index i = 0; i < std::ssize(lengths); ++i) {
    if (frames(i) >= limits.least && frames(i) < limits.below) out.push_back(i);
  }
  std::stable_sort(out.begin(), out.end(), [&](Index a, Index b) { return frames(a) < frames(b); });
  return out;
}

MOTIONLANG_BODY Index guo_item_frames(Index frames, bool shorter, Index unit) {
  const Index units = unit > 0 ? frames / unit - (shorter ? 1 : 0) : 0;
  if (units < 1) raise<config_error>(101, "guo_item_frames: of ", frames, " frames in units of ", unit);
  return units * unit;
}

MOTIONLANG_BODY FrameSlice guo_item(Index frames, NumpyRandom& coin, PythonRandom& start, Index unit) {
  const Index length = guo_item_frames(frames, coin.randint(0, 3) == 2, unit);
  return {static_cast<Index>(start.randint(0, frames - length)), length};
}

MOTIONLANG_NAMESPACE_END
