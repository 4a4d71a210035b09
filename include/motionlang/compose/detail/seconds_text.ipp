// SPDX-License-Identifier: MIT
// Bodies of seconds_text.hpp.
#pragma once

#include <cmath>  // abs

#include <motionlang/compose/detail/seconds_text.hpp>
#include <motionlang/compose/timeline.hpp>
#include <motionlang/core/standard_library.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::optional<double> parse_seconds(std::string_view text) {
  double t = 0;
  const char* last = text.data() + text.size();
  const auto [end, status] = detail::from_chars(text.data(), last, t);
  const bool good = status == std::errc{} && end == last && std::abs(t) <= static_cast<double>(latest_time);
  return good ? std::optional(t) : std::nullopt;
}

MOTIONLANG_BODY void append_python_float(std::string& out, double x) {
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

MOTIONLANG_NAMESPACE_END
