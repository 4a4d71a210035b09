// SPDX-License-Identifier: MIT
/// UTF-8, one code point at a time, strictly. text/unicode.hpp has the classes of characters.
#pragma once

#include <cstddef>      // size_t
#include <string>       // output
#include <string_view>  // input

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The result of `decode_utf8` for bytes that are not UTF-8.
inline constexpr char32_t invalid_code_point = 0xFFFFFFFF;

/// The code point that starts at text[at]; moves `at` past it. Bytes that are not UTF-8 (stray or missing
/// continuation bytes, overlong forms, surrogates, above U+10FFFF) give `invalid_code_point` and `at` moves by one.
/// Needs at < text.size().
constexpr char32_t decode_utf8(std::string_view text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t start = at++;
  const unsigned char first = byte(start);
  if (first < 0x80) return first;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || length > text.size() - start) return invalid_code_point;
  char32_t c = first & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(start + i) & 0xC0u) != 0x80u) return invalid_code_point;
    c = c << 6 | (byte(start + i) & 0x3Fu);
  }
  constexpr char32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  if (c < smallest[length] || (c >= 0xD800 && c <= 0xDFFF) || c > 0x10FFFF) return invalid_code_point;
  at = start + length;
  return c;
}

/// True if the whole text is UTF-8.
constexpr bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    if (decode_utf8(text, at) == invalid_code_point) return false;
  }
  return true;
}

/// The longest beginning of a text that has at most this many bytes and ends between two characters.
constexpr std::string_view utf8_head(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  for (std::size_t start = bytes - (bytes < 3 ? bytes : 3); start < bytes; ++start) {
    std::size_t end = start;
    if (decode_utf8(text, end) != invalid_code_point && end > bytes) return text.substr(0, start);
  }
  return text.substr(0, bytes);
}

/// Appends the bytes of a code point (up to U+10FFFF).
void append_utf8(std::string& out, char32_t c);

/// For messages and lists: '?' replaces control characters, which terminals obey, and bytes that are not UTF-8.
/// Characters in `keep` stay.
std::string printable(std::string_view text, std::string_view keep = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/utf8.ipp>
#endif
