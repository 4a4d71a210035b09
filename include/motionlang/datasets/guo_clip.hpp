// SPDX-License-Identifier: MIT
/// Which clips, and which frames of them, the loader of Guo et al. hands to its evaluator and its models. The caption
/// beside them is `GloVe::framed`.
///
/// Source  text-to-motion data/dataset.py, Text2MotionDatasetV2; spec evaluation-guo.md 1.3, 2.4
#pragma once

#include <algorithm>  // stable_sort
#include <vector>     // clips

#include <motionlang/core/numpy_random.hpp>
#include <motionlang/features/frame_sampling.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct GuoClipLimits {
  Index least = 40;   // frames; KIT: 24
  Index below = 200;  // frames
  Index unit = 4;     // lengths are multiples
};
inline GuoClipLimits guo_clip_limits(bool kit) { return {.least = kit ? 24 : 40}; }

/// The clips that are kept, the shortest first; of equals in their order.
inline std::vector<Index> guo_kept_clips(std::span<const Index> lengths, const GuoClipLimits& limits = {}) {
  std::vector<Index> out;
  auto frames = [&](Index clip) { return lengths[static_cast<std::size_t>(clip)]; };
  for (Index i = 0; i < std::ssize(lengths); ++i) {
    if (frames(i) >= limits.least && frames(i) < limits.below) out.push_back(i);
  }
  std::stable_sort(out.begin(), out.end(), [&](Index a, Index b) { return frames(a) < frames(b); });
  return out;
}

/// Frames of an item: the whole units of the clip, one less where `shorter`, which one coin in three says.
/// Throws config_error 101 if that leaves none.
inline Index guo_item_frames(Index frames, bool shorter, Index unit = 4) {
  const Index units = unit > 0 ? frames / unit - (shorter ? 1 : 0) : 0;
  if (units < 1) raise<config_error>(101, "guo_item_frames: of ", frames, " frames in units of ", unit);
  return units * unit;
}
/// The same, from a random start on: NumPy draws the coin, then Python the start.
inline FrameSlice guo_item(Index frames, NumpyRandom& coin, PythonRandom& start, Index unit = 4) {
  const Index length = guo_item_frames(frames, coin.randint(0, 3) == 2, unit);
  return {static_cast<Index>(start.randint(0, frames - length)), length};
}

MOTIONLANG_NAMESPACE_END
