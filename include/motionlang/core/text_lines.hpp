// SPDX-License-Identifier: MIT
/// Splits texts into lines, trims blanks, and lower-cases letters.
#pragma once

#include <algorithm>    // min
#include <string_view>  // input

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The lower case of an ASCII letter, in any locale.
constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// The text without the blanks at both ends.
constexpr std::string_view trim(std::string_view s) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  const std::size_t first = s.find_first_not_of(blanks);
  return first == s.npos ? s.substr(0, 0) : s.substr(first, s.find_last_not_of(blanks) - first + 1);
}

/// Calls on_line(line, number) for every line, without its end (LF, CRLF, CR); numbers count from 1. A byte order mark
/// is skipped.
template <class F>
void for_each_line(std::string_view text, F on_line) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (Index number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    on_line(text.substr(0, end), number);
    text.remove_prefix(std::min(text.size(), end + (text.substr(end).starts_with("\r\n") ? 2 : 1)));
  }
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
