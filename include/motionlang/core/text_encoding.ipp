// SPDX-License-Identifier: MIT
// Bodies of text_encoding.hpp.
#pragma once

#include <motionlang/core/text_encoding.hpp>
#include <motionlang/core/utf8.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The storage of a text's units.
struct WideText {
  std::size_t width = 0;  // bytes of a unit; 0: the text has single bytes
  bool big_endian = false;
  std::size_t mark = 0;  // bytes of the byte order mark
};

inline WideText wide_text_of(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\xFF\xFE\0\0"sv)) return {4, false, 4};
  if (bytes.starts_with("\0\0\xFE\xFF"sv)) return {4, true, 4};
  if (bytes.starts_with("\xFF\xFE"sv)) return {2, false, 2};
  if (bytes.starts_with("\xFE\xFF"sv)) return {2, true, 2};
  if (bytes.size() < 4) return {};
  const auto zero = [&](std::size_t i) { return bytes[i] == '\0'; };
  if (!zero(0) && zero(1) && !zero(2) && zero(3)) return {2, false, 0};
  if (zero(0) && !zero(1) && zero(2) && !zero(3)) return {2, true, 0};
  return {};
}

}  // namespace detail

MOTIONLANG_BODY std::optional<std::string> from_wide_text(std::string_view bytes) {
  const detail::WideText form = detail::wide_text_of(bytes);
  if (form.width == 0) return std::nullopt;
  bytes.remove_prefix(form.mark);
  const auto unit = [&](std::size_t at) {
    char32_t value = 0;
    for (std::size_t i = 0; i < form.width; ++i) {
      const std::size_t from = form.big_endian ? i : form.width - 1 - i;
      value = value << 8 | static_cast<unsigned char>(bytes[at + from]);
    }
    return value;
  };
  constexpr char32_t unknown = 0xFFFD;
  std::string out;
  for (std::size_t at = 0; at < bytes.size(); at += form.width) {
    if (bytes.size() - at < form.width) {
      append_utf8(out, unknown);
      break;
    }
    char32_t c = unit(at);
    const bool high = form.width == 2 && c >= 0xD800 && c < 0xDC00 && bytes.size() - at >= 4;
    if (const char32_t low = high ? unit(at + 2) : 0; low >= 0xDC00 && low < 0xE000) {
      c = 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00);
      at += 2;
    }
    append_utf8(out, c > 0x10FFFF || (c >= 0xD800 && c < 0xE000) ? unknown : c);
  }
  return out;
}

MOTIONLANG_BODY std::string from_latin1(std::string_view bytes) {
  std::string out;
  for (const char c : bytes) append_utf8(out, static_cast<unsigned char>(c));
  return out;
}

MOTIONLANG_NAMESPACE_END
