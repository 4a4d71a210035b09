// SPDX-License-Identifier: MIT
/// The text form of timelines.
///
///     line      := text "#" start "#" end { "#" body part }          times in seconds
///     timeline  := line { line }
///     file      := timelines separated by blank lines
///
/// Source   STMC (Petrovich et al. 2024), src/stmc.py read_timelines and src/text.py. There are no comments, and a text
///          cannot contain '#'
/// Differs  Lines of spaces count as blank, any line end is accepted (LF, CRLF, CR), and a byte order mark is skipped.
///          An interval that is empty or ends before it starts is refused unless `as_published` is set. Gaps between
///          intervals do not matter here: see PlanOptions.
/// Throws   timeline_error 501-504, 507, 509. Messages begin "name:line:column: "; columns count characters. Faults of
///          a whole timeline are found when it is planned. Their messages name line and column of an interval
#pragma once

#include <span>         // several timelines
#include <string>       // texts
#include <string_view>  // input
#include <vector>       // timelines

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TimelineTextOptions {
  double fps = 20;  // frame = trunc(fps * seconds)
  /// Accept intervals without a frame and texts without parts as they are. Otherwise texts without parts move the whole
  /// body.
  bool as_published = false;
  std::string_view name = "timeline";  // of the file, for messages
  BodyPartition body{};                // whose parts the texts move
};

/// A text with a duration, for a motion of its own. It moves the whole body.
struct TimedText {
  std::string text;
  Index frames = 0;
  bool operator==(const TimedText&) const = default;
};

/// All timelines of a file, in frames, each shifted to begin at 0.
std::vector<Timeline> parse_timelines(std::string_view text, const TimelineTextOptions& options = {});
/// All timelines of a file, in seconds; options.fps has no effect.
std::vector<TimelineInSeconds> parse_timelines_in_seconds(std::string_view text,
                                                          const TimelineTextOptions& options = {});
/// The timeline of a text that has only one. Throws timeline_error 509 if there are several.
///
///     auto timeline = parse_timeline("walking in a circle # 0.0 # 6.0 # legs\n"
///                                    "raising both hands  # 2.0 # 5.0 # left arm # right arm\n", {.fps = 20});
Timeline parse_timeline(std::string_view text, const TimelineTextOptions& options = {});

/// True if a file is a list of single texts ("text # duration") rather than of timelines. Then every line has fewer
/// than three fields, or a body part instead of the second time. The published programs (`as_published`) only need one
/// line of fewer than three fields, and then refuse the others.
bool is_text_list(std::string_view text, const TimelineTextOptions& options = {});

/// Lines "text # duration"; blank lines are skipped. Body parts may follow, as in timelines, but have no effect: a
/// single text moves the whole body. `as_published` accepts any further field. Throws timeline_error 501 ... 504, 507.
std::vector<TimedText> parse_text_list(std::string_view text, const TimelineTextOptions& options = {});

/// The text form: fields joined by " # ", body parts in alphabetical order, an empty line after each timeline. Reading
/// it gives the same timelines (texts trimmed, start at 0). Throws timeline_error 510 if a text contains '#' or a line
/// end.
std::string write_timelines(std::span<const TimelineInSeconds> timelines);
std::string write_timeline(const TimelineInSeconds& timeline);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/timeline_text.ipp>
#endif
