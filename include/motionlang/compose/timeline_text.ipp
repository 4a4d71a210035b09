// SPDX-License-Identifier: MIT
// Bodies of timeline_text.hpp.
#pragma once

#include <cmath>  // abs

#include <motionlang/compose/detail/timeline_parser.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/sort.hpp>
#include <motionlang/core/text_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Timeline> parse_timelines(std::string_view text, const TimelineTextOptions& options) {
  std::vector<Timeline> out;
  detail::parse_timelines_into(text, options, out);
  return out;
}

MOTIONLANG_BODY std::vector<TimelineInSeconds> parse_timelines_in_seconds(std::string_view text,
                                                                          const TimelineTextOptions& options) {
  std::vector<TimelineInSeconds> out;
  detail::parse_timelines_into(text, options, out);
  return out;
}

MOTIONLANG_BODY Timeline parse_timeline(std::string_view text, const TimelineTextOptions& options) {
  auto all = parse_timelines(text, options);
  detail::require_one_timeline(all, options);
  return std::move(all.front());
}

MOTIONLANG_BODY bool is_text_list(std::string_view text, const TimelineTextOptions& options) {
  Index lines = 0, short_lines = 0, lines_with_parts = 0;
  detail::for_each_line(text, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    ++lines;
    const detail::TimelineLine line(content, number, options.name);
    if (line.fields() < 3)
      ++short_lines;
    else if (options.body.find(line.field(2)))
      ++lines_with_parts;
  });
  return options.as_published ? short_lines > 0 : lines > 0 && short_lines + lines_with_parts == lines;
}

MOTIONLANG_BODY std::vector<TimedText> parse_text_list(std::string_view text, const TimelineTextOptions& options) {
  std::vector<TimedText> out;
  detail::for_each_line(text, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    const detail::TimelineLine line(content, number, options.name);
    if (line.fields() < 2) line.fail(501, line.fields(), "expected 'text # duration'");
    if (!options.as_published) line.parts(2, options.body);
    const double seconds = line.seconds(1);
    if (std::abs(seconds * options.fps) > double(latest_time)) line.fail(502, 1, "'", line.field(1), "' is too long");
    const Index frames = frame_at(seconds, options.fps);
    if (frames <= 0 && !options.as_published) line.fail(504, 1, "a duration of ", line.field(1), " s has no frame");
    out.push_back({line.text(), frames});
  });
  if (out.empty()) raise<timeline_error>(507, options.name, ": no line");
  return out;
}

MOTIONLANG_BODY std::string write_timelines(std::span<const TimelineInSeconds> timelines) {
  std::string out;
  for (const TimelineInSeconds& timeline : timelines) {
    const BodyPartition& body = timeline.body;
    std::vector<BodyPart> alphabetical;
    alphabetical.reserve(static_cast<std::size_t>(body.size()));
    for (int p = 0; p < body.size(); ++p) alphabetical.push_back(static_cast<BodyPart>(p));
    detail::sort(alphabetical, [&](BodyPart a, BodyPart b) { return body.name(a) < body.name(b); });
    for (const IntervalInSeconds& i : timeline.intervals) {
      if (i.text.find_first_of("#\r\n") != i.text.npos) {
        raise<timeline_error>(510, "write_timelines: the text '", i.text, "' contains '#' or a line end");
      }
      out += i.text + " # ";
      detail::append_python_float(out, i.start);
      out += " # ";
      detail::append_python_float(out, i.end);
      for (BodyPart part : alphabetical) {
        if (i.parts.has(part)) out += " # " + body.name(part);
      }
      out += '\n';
    }
    out += '\n';
  }
  return out;
}

MOTIONLANG_BODY std::string write_timeline(const TimelineInSeconds& timeline) {
  return write_timelines(std::span(&timeline, 1));
}

MOTIONLANG_NAMESPACE_END
