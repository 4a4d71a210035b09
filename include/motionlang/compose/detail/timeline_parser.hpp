// SPDX-License-Identifier: MIT
/// Reads lines of timelines in frames, in seconds, or in both. Only bodies (*.ipp) include it. `Options` is always
/// TimelineTextOptions, whose header is above this one.
#pragma once

#include <cmath>        // abs
#include <string_view>  // texts
#include <type_traits>  // frames or seconds
#include <utility>      // both
#include <vector>       // timelines

#include <motionlang/compose/detail/timeline_line.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// T = Index: frames at options.fps; T = double: seconds.
template <class T, class Options>
BasicInterval<T> parse_interval(const TimelineLine& line, const Options& options) {
  if (line.fields() < 3) line.fail(501, line.fields(), "expected 'text # start # end # body parts'");
  const auto time = [&](std::size_t i) {
    if constexpr (std::is_same_v<T, Index>) {
      const double seconds = line.seconds(i);
      if (std::abs(seconds * options.fps) > double(latest_time)) line.fail(502, i, "'", line.field(i), "' is too late");
      return frame_at(seconds, options.fps);
    } else {
      return line.seconds(i);
    }
  };
  BasicInterval<T> out{line.text(), time(1), time(2), line.parts(3, options.body), line.place(0)};
  if (out.parts == BodyParts{} && !options.as_published) out.parts = options.body.all();
  if (!(out.start < out.end) && !options.as_published) {
    line.fail(504, 2, "the interval ", line.field(1), " to ", line.field(2), " s ",
              line.seconds(1) < line.seconds(2) ? "has no frame" : "is empty or ends before it starts");
  }
  return out;
}

/// Shifts each timeline to begin at 0. Throws timeline_error 507 without a timeline, 502 for one that is too long.
template <class T, class Options>
void finish_timelines(std::vector<BasicTimeline<T>>& timelines, const Options& options) {
  if (timelines.empty()) raise<timeline_error>(507, options.name, ": no line");
  for (auto& timeline : timelines) {
    shift_to_zero(timeline);
    for (const auto& i : timeline.intervals) {
      if (i.end <= static_cast<T>(latest_time)) continue;
      fail_at(502, options.name, i.place, "a timeline that lasts ", i.end, " is too long");
    }
  }
}

/// Puts the timelines of a text into lists of them: in frames, in seconds.
template <class Options, class... T>
void parse_timelines_into(std::string_view text, const Options& options, std::vector<BasicTimeline<T>>&... out) {
  if (!(options.fps > 0)) raise<config_error>(101, "parse_timelines: fps ", options.fps);
  bool inside = false;
  for_each_line(text, [&](std::string_view content, Index number) {
    const bool blank = trim(content).empty();
    if (!blank) {
      if (!inside) (out.push_back({{}, options.body}), ...);
      const TimelineLine line(content, number, options.name);
      (out.back().intervals.push_back(parse_interval<T>(line, options)), ...);
    }
    inside = !blank;
  });
  (finish_timelines(out, options), ...);
}

template <class T, class Options>
void require_one_timeline(const std::vector<BasicTimeline<T>>& all, const Options& options) {
  if (all.size() > 1)
    fail_at(509, options.name, all[1].intervals.front().place, all.size(), " timelines where one is expected");
}

/// The timeline of a text that has only one. Throws as parse_timeline.
template <class Options>
std::pair<Timeline, TimelineInSeconds> parse_timeline_in_both(std::string_view text, const Options& options) {
  std::vector<Timeline> frames;
  std::vector<TimelineInSeconds> seconds;
  parse_timelines_into(text, options, frames, seconds);
  require_one_timeline(frames, options);
  return {std::move(frames.front()), std::move(seconds.front())};
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
