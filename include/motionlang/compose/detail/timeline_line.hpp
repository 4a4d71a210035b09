// SPDX-License-Identifier: MIT
/// A line of a file of timelines. Only bodies (*.ipp) include it.
#pragma once

#include <algorithm>    // min
#include <string>       // texts
#include <string_view>  // lines
#include <vector>       // fields

#include <motionlang/compose/detail/seconds_text.hpp>
#include <motionlang/compose/timeline.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/core/utf8.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws timeline_error with a message that begins "name:line:column: ".
template <class... T>
[[noreturn]] void fail_at(int id, std::string_view name, const TextPlace& place, const T&... what) {
  raise<timeline_error>(id, name, ":", place.line, ":", place.column, ": ", what...);
}

/// One line of a file, split at '#'. It knows its place in the file.
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
  /// The place of the beginning of a field.
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

  /// The parts that are named by the fields from `first` on.
  BodyParts parts(std::size_t first, const BodyPartition& body) const {
    BodyParts parts;
    for (std::size_t i = first; i < fields_.size(); ++i) {
      const auto part = body.find(fields_[i]);
      if (!part) fail(503, i, "'", fields_[i], "' is not a body part (", join_text(body.names()), ")");
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

}  // namespace detail

MOTIONLANG_NAMESPACE_END
