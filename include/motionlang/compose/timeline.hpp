// SPDX-License-Identifier: MIT
/// A timeline: texts, each with its time and its body parts. Reading and writing is in timeline_text.hpp.
///
/// Motion is made in frames (Index), and files are written and edited in seconds (double). The two are different types,
/// so they cannot be mixed.
#pragma once

#include <algorithm>  // min, max
#include <string>     // texts
#include <vector>     // intervals

#include <motionlang/kinematics/body_partition.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The place where an interval was read, for messages. It is not part of the interval's value: all places are equal.
struct TextPlace {
  Index line = 0, column = 0;  // from 1; 0: not from a text
  constexpr bool operator==(const TextPlace&) const { return true; }
};

/// A text that acts on some body parts from `start` up to, not including, `end`.
template <class T>
struct BasicInterval {
  std::string text;
  T start{}, end{};
  BodyParts parts;
  TextPlace place{};
  bool operator==(const BasicInterval&) const = default;
};

/// Intervals in the order of the file, which decides ties.
template <class T>
struct BasicTimeline {
  std::vector<BasicInterval<T>> intervals;
  BodyPartition body{};  // whose parts the intervals move; the human body unless given

  /// End of the last interval.
  T end() const {
    T last{};
    for (const auto& i : intervals) last = std::max(last, i.end);
    return last;
  }
  bool operator==(const BasicTimeline&) const = default;
};

using Interval = BasicInterval<Index>;
using Timeline = BasicTimeline<Index>;
using IntervalInSeconds = BasicInterval<double>;
using TimelineInSeconds = BasicTimeline<double>;

/// Times beyond this number of frames or seconds are refused.
inline constexpr Index latest_time = 1'000'000'000;

/// trunc(fps * seconds), computed in double like the published readers. Throws config_error 101 if it is not a time.
Index frame_at(double seconds, double fps);

/// Moves a timeline so that it begins at 0.
template <class T>
void shift_to_zero(BasicTimeline<T>& timeline) {
  if (timeline.intervals.empty()) return;
  T first = timeline.intervals.front().start;
  for (const auto& i : timeline.intervals) first = std::min(first, i.start);
  for (auto& i : timeline.intervals) i.start -= first, i.end -= first;
}

/// Frames of a timeline, shifted to 0 after the conversion. Throws config_error 101.
Timeline to_frames(const TimelineInSeconds& timeline, double fps);

/// Seconds of a timeline, such that to_frames gives the same frames back. Throws config_error 101.
TimelineInSeconds to_seconds(const Timeline& timeline, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/timeline.ipp>
#endif
