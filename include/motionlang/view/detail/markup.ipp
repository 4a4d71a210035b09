// SPDX-License-Identifier: MIT
// Bodies of markup.hpp.
#pragma once

#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/view/detail/markup.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Source  XML 1.0, production 2 (decode_utf8 gives no surrogates).
constexpr bool is_xml_character(char32_t c) {
  return c == '\t' || c == '\n' || (c >= 32 && c < 0xFFFE) || (c > 0xFFFF && c <= 0x10FFFF);
}

MOTIONLANG_BODY std::string escape_markup(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = decode_utf8(text, at);
    switch (c) {
      case U'&':
        out += "&amp;";
        break;
      case U'<':
        out += "&lt;";
        break;
      case U'>':
        out += "&gt;";
        break;
      case U'"':
        out += "&quot;";
        break;
      case U'\'':
        out += "&#39;";
        break;
      default:
        append_utf8(out, is_xml_character(c) ? c : U'\uFFFD');
    }
  }
  return out;
}

MOTIONLANG_BODY std::string fixed(double value, int decimals) {
  char digits[64];
  const auto end = detail::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals);
  if (end.ec != std::errc()) return "0";
  std::string out(digits, end.ptr);
  if (out.find('.') != std::string::npos) {
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
