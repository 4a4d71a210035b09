// SPDX-License-Identifier: MIT
/// Overlap around the cuts of a timeline: how far texts reach beyond their ends, and the windows of transitions.
///
/// Source   thesis 6.2.3, "Temporal stitching"; STMC (Petrovich et al. 2024) src/stmc.py
/// Differs  from the thesis, which gives 0.25 s on each side: the code splits a total overlap. The longer half is on
///          the right
#pragma once

#include <algorithm>  // min, max

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A half-open range of frames.
struct FrameRange {
  Index start = 0, end = 0;
  Index size() const { return end - start; }
  bool operator==(const FrameRange&) const = default;
};

/// A total of O frames: l = O div 2 to the left of a cut, r = O - l to the right.
struct Overlap {
  Index left = 0, right = 0;

  /// Throws config_error 101 if it is negative or beyond `latest_time`.
  static Overlap of_frames(Index total);
  static Overlap of_seconds(double total, double fps) { return of_frames(frame_at(total, fps)); }

  /// [max(s - l, 0), min(e + r, frames))
  FrameRange extend(FrameRange range, Index frames) const {
    return {std::max<Index>(range.start - left, 0), std::min(range.end + right, frames)};
  }
  /// Around a cut x: [max(x - l, 0), min(x + r, frames)).
  FrameRange window(Index cut, Index frames) const { return extend({cut, cut}, frames); }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/overlap.ipp>
#endif
