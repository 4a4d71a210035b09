// SPDX-License-Identifier: MIT
/// The text form of timelines.
///
///     line      := text "#" start "#" end { "#" body part }          times in seconds
///     timeline  := line { line }
///     file      := timelines separated by blank lines
///
/// Source   STMC (Petrovich et al. 2024), src/stmc.py read_timelines and src/text.py; there is no comment syntax and a
///          text cannot contain '#'
/// Differs  lines of spaces count as blank, any line end is taken (LF, CRLF, CR), a byte order mark is skipped, and an
///          interval that is empty or ends before it starts is refused unless `as_published` is set. Gaps between
///          intervals do not concern the text: see PlanOptions.
/// Throws   timeline_error 501-504, 507, 509; messages begin "name:line:column: ", columns count characters. What is
///          wrong with the whole of a timeline is found when it is planned, and named by line and column of an interval
#pragma once

#include <span>         // several timelines
#include <string>       // texts
#include <string_view>  // input
#include <vector>       // timelines

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TimelineTextOptions {
  double fps = 20;  // frame = trunc(fps * seconds)
  /// Take intervals without a frame and texts without parts as they are. Else texts without parts move the whole body.
  bool as_published = false;
  std::string_view name = "timeline";  // of the file, for messages
  BodyPartition body{};                // whose parts the texts move
};

/// A text with a length, for motions of one text each: it moves the whole body.
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
/// The only timeline of a text. Throws timeline_error 509 if there are several.
///
///     auto timeline = parse_timeline("walking in a circle # 0.0 # 6.0 # legs\n"
///                                    "raising both hands  # 2.0 # 5.0 # left arm # right arm\n", {.fps = 20});
Timeline parse_timeline(std::string_view text, const TimelineTextOptions& options = {});

/// True if a file is a list of single texts ("text # duration") rather than of timelines: every line has fewer than
/// three fields, or a body part where timelines have their second time. The published programs ask for one line of
/// fewer than three fields only (`as_published`), and then blame the others.
bool is_text_list(std::string_view text, const TimelineTextOptions& options = {});

/// Lines "text # duration"; blank lines are skipped. Body parts may follow, as in timelines, and have no effect: a
/// single text moves the whole body. `as_published` takes any further field. Throws timeline_error 501 ... 504, 507.
std::vector<TimedText> parse_text_list(std::string_view text, const TimelineTextOptions& options = {});

/// The text form: fields joined by " # ", body parts in alphabetical order, an empty line after each timeline. Reading
/// it gives the same timelines back (texts trimmed, begin at 0). Throws timeline_error 510 if a text contains '#' or a
/// line end.
std::string write_timelines(std::span<const TimelineInSeconds> timelines);
std::string write_timeline(const TimelineInSeconds& timeline);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/timeline_text.ipp>
#endif
