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
///          intervals are no matter of the text: see PlanOptions.
/// Throws   timeline_error 501-504, 507, 509; messages begin "name:line:column: ", columns count characters. What is
///          wrong with the whole of a timeline is found when it is planned, and named by line and column of an interval
#pragma once

#include <cmath>        // abs
#include <optional>     // times
#include <span>         // several timelines
#include <string_view>  // input
#include <type_traits>  // frames or seconds

#include <motionlang/compose/timeline.hpp>
#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/core/utf8.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TimelineTextOptions {
  double fps = 20;  // frame = trunc(fps * seconds)
  bool as_published =
      false;  // take intervals without a frame, and texts without parts as they are; else those move all
  std::string_view name = "timeline";  // of the file, for messages
};

/// A text with a length, for motions of one text each: it moves the whole body.
struct TimedText {
  std::string text;
  Index frames = 0;
  bool operator==(const TimedText&) const = default;
};

namespace detail {

/// Throws timeline_error with a message that begins "name:line:column: ".
template <class... T>
[[noreturn]] void fail_at(int id, std::string_view name, const TextPlace& place, const T&... what) {
  raise<timeline_error>(id, name, ":", place.line, ":", place.column, ": ", what...);
}

/// A time in seconds, finite and not beyond `latest_time`; nothing if the whole text is none.
inline std::optional<double> parse_seconds(std::string_view text) {
  double t = 0;
  const char* last = text.data() + text.size();
  const auto [end, status] = detail::from_chars(text.data(), last, t);
  const bool good = status == std::errc{} && end == last && std::abs(t) <= static_cast<double>(latest_time);
  return good ? std::optional(t) : std::nullopt;
}

/// One line of a file, split at '#'. Knows where it stands.
class TimelineLine {
 public:
  TimelineLine(std::string_view line, Index number, std::string_view name) : line_(line), number_(number), name_(name) {
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t end = std::min(line.find('#', at), line.size());
      fields_.push_back(trim(line.substr(at, end - at)));
      at = end + 1;
    }
  }

  std::size_t fields() const { return fields_.size(); }
  std::string_view field(std::size_t i) const { return fields_[i]; }

  /// Throws timeline_error at the beginning of a field (past the last one: at the end of the line).
  template <class... T>
  [[noreturn]] void fail(int id, std::size_t field, const T&... what) const {
    fail_at(id, name_, place(field), what...);
  }
  /// Of the beginning of a field.
  TextPlace place(std::size_t field) const {
    const char* begin = field < fields_.size() ? fields_[field].data() : line_.data() + line_.size();
    Index column = 1;
    for (const char* c = line_.data(); c < begin; ++c) column += (static_cast<unsigned char>(*c) & 0xC0u) != 0x80u;
    return {number_, column};
  }

  std::string text() const {
    if (!is_utf8(fields_[0])) fail(501, 0, "the text is not UTF-8");
    return std::string(fields_[0]);
  }

  /// A time in seconds. Python's spelling: a plus sign is allowed, infinity is not.
  double seconds(std::size_t i) const {
    std::string_view s = fields_[i];
    if (s.size() > 1 && s[0] == '+' && s[1] != '-') s.remove_prefix(1);
    const auto t = parse_seconds(s);
    if (!t) fail(502, i, "'", fields_[i], "' is not a time in seconds");
    return *t;
  }

  BodyParts parts(std::size_t first) const {
    BodyParts parts;
    for (std::size_t i = first; i < fields_.size(); ++i) {
      const auto part = parse_body_part(fields_[i]);
      if (!part) fail(503, i, "'", fields_[i], "' is not a body part (left arm, right arm, legs, head, spine)");
      parts = parts.with(*part);
    }
    return parts;
  }

 private:
  std::string_view line_;
  Index number_;
  std::string_view name_;
  std::vector<std::string_view> fields_;
};

/// T = Index: frames at options.fps; T = double: seconds.
template <class T>
BasicInterval<T> parse_interval(const TimelineLine& line, const TimelineTextOptions& options) {
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
  BasicInterval<T> out{line.text(), time(1), time(2), line.parts(3), line.place(0)};
  if (out.parts == BodyParts{} && !options.as_published) out.parts = BodyParts::all();
  if (!(out.start < out.end) && !options.as_published) {
    line.fail(504, 2, "the interval ", line.field(1), " to ", line.field(2), " s ",
              line.seconds(1) < line.seconds(2) ? "has no frame" : "is empty or ends before it starts");
  }
  return out;
}

template <class T>
std::vector<BasicTimeline<T>> parse_timelines_as(std::string_view text, const TimelineTextOptions& options) {
  if (!(options.fps > 0)) raise<config_error>(101, "parse_timelines: fps ", options.fps);
  std::vector<BasicTimeline<T>> out;
  bool inside = false;
  for_each_line(text, [&](std::string_view line, Index number) {
    const bool blank = trim(line).empty();
    if (!blank) {
      if (!inside) out.emplace_back();
      out.back().intervals.push_back(parse_interval<T>(TimelineLine(line, number, options.name), options));
    }
    inside = !blank;
  });
  if (out.empty()) raise<timeline_error>(507, options.name, ": no line");
  for (auto& timeline : out) {
    shift_to_zero(timeline);
    for (const auto& i : timeline.intervals) {
      if (i.end <= static_cast<T>(latest_time)) continue;
      fail_at(502, options.name, i.place, "a timeline that lasts ", i.end, " is too long");
    }
  }
  return out;
}

/// Shortest decimal form, as Python prints a float: 5.5, 8.0, 1e-05, 1e+16.
inline void append_python_float(std::string& out, double x) {
  char digits[64];
  const double size = std::abs(x);
  const bool fixed = size == 0 || (size >= 1e-4 && size < 1e16);
  const auto end = detail::to_chars(digits, digits + sizeof digits, x,
                                    fixed ? std::chars_format::fixed : std::chars_format::scientific)
                       .ptr;
  const std::string_view text(digits, static_cast<std::size_t>(end - digits));
  out += text;
  if (fixed && text.find('.') == text.npos) out += ".0";
}

}  // namespace detail

/// All timelines of a file, in frames, each shifted to begin at 0.
inline std::vector<Timeline> parse_timelines(std::string_view text, const TimelineTextOptions& options = {}) {
  return detail::parse_timelines_as<Index>(text, options);
}
/// All timelines of a file, in seconds; options.fps has no effect.
inline std::vector<TimelineInSeconds> parse_timelines_in_seconds(std::string_view text,
                                                                 const TimelineTextOptions& options = {}) {
  return detail::parse_timelines_as<double>(text, options);
}
/// The only timeline of a text. Throws timeline_error 509 if there are several.
///
///     auto timeline = parse_timeline("walking in a circle # 0.0 # 6.0 # legs\n"
///                                    "raising both hands  # 2.0 # 5.0 # left arm # right arm\n", {.fps = 20});
inline Timeline parse_timeline(std::string_view text, const TimelineTextOptions& options = {}) {
  auto all = parse_timelines(text, options);
  if (all.size() > 1)
    detail::fail_at(509, options.name, all[1].intervals.front().place, all.size(), " timelines where one is expected");
  return std::move(all.front());
}

/// Whether a file is a list of single texts ("text # duration") rather than of timelines: every line has fewer than
/// three fields, or a body part where timelines have their second time. The published programs ask for one line of
/// fewer than three fields only (`as_published`), and then blame the others.
inline bool is_text_list(std::string_view text, const TimelineTextOptions& options = {}) {
  Index lines = 0, short_lines = 0, lines_with_parts = 0;
  detail::for_each_line(text, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    ++lines;
    const detail::TimelineLine line(content, number, options.name);
    if (line.fields() < 3)
      ++short_lines;
    else if (parse_body_part(line.field(2)))
      ++lines_with_parts;
  });
  return options.as_published ? short_lines > 0 : lines > 0 && short_lines + lines_with_parts == lines;
}

/// Lines "text # duration"; blank lines are skipped. Body parts may follow, as in timelines, and have no effect: a
/// single text moves the whole body. `as_published` takes any further field. Throws timeline_error 501 ... 504, 507.
inline std::vector<TimedText> parse_text_list(std::string_view text, const TimelineTextOptions& options = {}) {
  std::vector<TimedText> out;
  detail::for_each_line(text, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    const detail::TimelineLine line(content, number, options.name);
    if (line.fields() < 2) line.fail(501, line.fields(), "expected 'text # duration'");
    if (!options.as_published) line.parts(2);
    const double seconds = line.seconds(1);
    if (std::abs(seconds * options.fps) > double(latest_time)) line.fail(502, 1, "'", line.field(1), "' is too long");
    const Index frames = frame_at(seconds, options.fps);
    if (frames <= 0 && !options.as_published) line.fail(504, 1, "a duration of ", line.field(1), " s has no frame");
    out.push_back({line.text(), frames});
  });
  if (out.empty()) raise<timeline_error>(507, options.name, ": no line");
  return out;
}

/// The text form: fields joined by " # ", body parts in alphabetical order, an empty line after each timeline. Reading
/// it gives the same timelines back (texts trimmed, begin at 0). Throws timeline_error 510 if a text contains '#' or a
/// line end.
inline std::string write_timelines(std::span<const TimelineInSeconds> timelines) {
  using enum BodyPart;
  std::string out;
  for (const TimelineInSeconds& timeline : timelines) {
    for (const IntervalInSeconds& i : timeline.intervals) {
      if (i.text.find_first_of("#\r\n") != i.text.npos) {
        raise<timeline_error>(510, "write_timelines: the text '", i.text, "' contains '#' or a line end");
      }
      out += i.text + " # ";
      detail::append_python_float(out, i.start);
      out += " # ";
      detail::append_python_float(out, i.end);
      for (BodyPart part : {head, left_arm, legs, right_arm, spine}) {
        if (i.parts.has(part)) out += " # " + to_string(part);
      }
      out += '\n';
    }
    out += '\n';
  }
  return out;
}
inline std::string write_timeline(const TimelineInSeconds& timeline) {
  return write_timelines(std::span(&timeline, 1));
}

MOTIONLANG_NAMESPACE_END
