// SPDX-License-Identifier: MIT
// Bodies of baselines.hpp.
#pragma once

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/intervals.hpp>
#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::array<std::string_view, stmc_modes.size()> stmc_mode_names{"stmc", "sinc", "sinc-lerp",
                                                                                 "single-track", "one-text"};

}  // namespace detail

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

MOTIONLANG_BODY std::string_view to_string(StmcMode mode) {
  return detail::stmc_mode_names[static_cast<std::size_t>(mode)];
}

MOTIONLANG_BODY StmcMode parse_stmc_mode(std::string_view name, std::string_view where) {
  for (const StmcMode mode : stmc_modes) {
    if (name == to_string(mode)) return mode;
  }
  raise<config_error>(103, where, " '", name, "' is not one of ", join_text(detail::stmc_mode_names));
}

MOTIONLANG_BODY Timeline timeline_of_mode(StmcMode mode, const Timeline& timeline, double fps) {
  if (mode == StmcMode::single_track) return to_frames(single_track(to_seconds(timeline, fps)), fps);
  if (mode == StmcMode::one_text) return to_frames(one_text(to_seconds(timeline, fps)), fps);
  return timeline;
}

MOTIONLANG_NAMESPACE_END
