// SPDX-License-Identifier: MIT
/// The clips, and their frames, that the loader of Guo et al. passes to its evaluator and its models. `GloVe::framed`
/// makes the captions for them.
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

/// The clips that are kept, the shortest first; equal lengths stay in their order.
std::vector<Index> guo_kept_clips(std::span<const Index> lengths, const GuoClipLimits& limits = {});

/// The frames of an item: the whole units of the clip, one less if `shorter`, which is true for one item in three.
/// Throws config_error 101 if no unit is left.
Index guo_item_frames(Index frames, bool shorter, Index unit = 4);
/// The same from a random start. NumPy draws `shorter`, then Python the start.
FrameSlice guo_item(Index frames, NumpyRandom& coin, PythonRandom& start, Index unit = 4);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/guo_clip.ipp>
#endif
