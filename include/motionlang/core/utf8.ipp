// SPDX-License-Identifier: MIT
// Bodies of utf8.hpp.
#pragma once

#include <motionlang/core/utf8.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void append_utf8(std::string& out, char32_t c) {
  const auto put = [&](char32_t b) { out += static_cast<char>(static_cast<unsigned char>(b)); };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0 | c >> 6), put(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    put(0xE0 | c >> 12), put(0x80 | (c >> 6 & 0x3F)), put(0x80 | (c & 0x3F));
  } else {
    put(0xF0 | c >> 18), put(0x80 | (c >> 12 & 0x3F)), put(0x80 | (c >> 6 & 0x3F)), put(0x80 | (c & 0x3F));
  }
}

MOTIONLANG_BODY std::string printable(std::string_view text, std::string_view keep) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t start = at;
    const char32_t c = decode_utf8(text, at);
    const bool control = c < ' ' || (c >= 0x7F && c <= 0x9F);
    const bool good = (c != invalid_code_point && !control) || keep.find(text[start]) != keep.npos;
    out += good ? text.substr(start, at - start) : "?";
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
