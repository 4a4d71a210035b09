// SPDX-License-Identifier: MIT
// Bodies of baselines.hpp.
#pragma once

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/intervals.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TimelineInSeconds single_track(const TimelineInSeconds& timeline) {
  TimelineInSeconds out{{}, timeline.body};
  for (const auto& piece : elementary_pieces(timeline)) {
    if (piece.intervals.empty()) continue;
    IntervalInSeconds joined{"", piece.start, piece.end, {}};
    for (Index i : piece.intervals) {
      const IntervalInSeconds& active = timeline.intervals[static_cast<std::size_t>(i)];
      joined.text += (i == piece.intervals.front() ? "" : " while ") + active.text;
      joined.parts = detail::united(joined.parts, active.parts);
    }
    out.intervals.push_back(std::move(joined));
  }
  return out;
}

MOTIONLANG_BODY TimelineInSeconds one_text(const TimelineInSeconds& timeline) {
  constexpr double longest = 9.8;
  constexpr const char* words[] = {"", " and then ", " while "};
  if (timeline.intervals.empty()) return {{}, timeline.body};
  IntervalInSeconds joined{"", 0.0, 0.0, {}};
  double first = timeline.intervals.front().start;
  for (std::size_t i = 0; i < timeline.intervals.size(); ++i) {
    const IntervalInSeconds& interval = timeline.intervals[i];
    if (i < std::size(words)) joined.text += words[i] + interval.text;
    joined.parts = detail::united(joined.parts, interval.parts);
    first = std::min(first, interval.start);
  }
  joined.end = std::min(timeline.end() - first, longest);
  return {{std::move(joined)}, timeline.body};
}

MOTIONLANG_NAMESPACE_END
