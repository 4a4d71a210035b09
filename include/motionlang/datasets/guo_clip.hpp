// SPDX-License-Identifier: MIT
/// Which clips, and which frames of them, the loader of Guo et al. hands to its evaluator and its models. The caption
/// beside them is `GloVe::framed`.
///
/// Source  text-to-motion data/dataset.py, Text2MotionDatasetV2
#pragma once

#include <span>    // lengths
#include <vector>  // clips

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
std::vector<Index> guo_kept_clips(std::span<const Index> lengths, const GuoClipLimits& limits = {});

/// Frames of an item: the whole units of the clip, one less where `shorter`, which one coin in three says.
/// Throws config_error 101 if that leaves none.
Index guo_item_frames(Index frames, bool shorter, Index unit = 4);
/// The same, from a random start on: NumPy draws the coin, then Python the start.
FrameSlice guo_item(Index frames, NumpyRandom& coin, PythonRandom& start, Index unit = 4);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/guo_clip.ipp>
#endif
