// SPDX-License-Identifier: MIT
// Bodies of stroke_font.hpp.
#pragma once

#include <algorithm>  // max
#include <array>      // letters

#include <motionlang/core/utf8.hpp>
#include <motionlang/view/detail/stroke_font.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Strokes of ASCII 33 ... 126, two hexadecimal digits (x and y) for a point. A stroke of one point is a dot.
// clang-format off
inline constexpr std::array<std::string_view, 94> stroke_letters{
    "0d07 04", "0d0b 2d2b", "2d14 4d34 0a5a 0757", "5c4d1d0c0a19485755441405 3e33", "6d04 0d2d2b0b0d 4666644446",
    "540b1d3d3b0705143457", "0d0b", "2e0b0622", "0e2b2602", "2d29 0c4a 4c0a", "0848 2a26", "1402", "0848", "04", "4e02",
    "2434565b3d2d0b0624", "0b2d24", "0c1d4d5c5a0454", "0c1d4d5c5a4929 495855441405", "444d0757", "5d0d09495855441405",
    "4d2d0b0614445558491908", "0d5d24", "19495a5c4d1d0c0a1908051444555849", "594818090c1d4d5b563414",
    "04 09", "09 1402", "4a0846", "0949 0747", "0a4806", "0c1d3d4c4a2827 24",
    "56362729 3a5a56767b5d2d0b062454",
    "043d64 1757", "040d4d5c5a4909 4958554404", "6b4d2d0b06244466", "040d3d6a673404", "5d0d0454 0949", "5d0d04 0949",
    "6b4d2d0b062444666848", "0d04 6d64 0969", "0d04", "4d46341406", "0d04 5d08 2a64", "0d0454", "040d376d64", "040d646d",
    "2444666b4d2d0b0624", "040d4d5c594808", "2444666b4d2d0b0624 4673", "040d4d5c594808 3854",
    "5c4d1d0c0a19485755441405", "0d6d 3d34", "0d062444666d", "0d346d", "0d244b648d", "0d64 6d04", "0d396d 3934", "0d6d0464",
    "2e0e0222", "0e42", "0e2e2202", "0b2d4b", "0353", "0d1b",
    "243456583a2a080624 5a54", "0d04 243456583a2a080624", "594a2a0806244455", "243456583a2a080624 5d54",
    "0757583a2a080624344455", "4d3d2c24 0a4a", "243456583a2a080624 5a52301001", "0d04 082a3a5854", "0a04 0d", "2a211000 2d",
    "0d04 4a06 2854", "0d04", "0a04 082a3a4844 486a7a8884", "0a04 082a3a5854", "243456583a2a080624", "0a00 243456583a2a080624",
    "243456583a2a080624 5a50", "0a04 082a4a", "493a1a090817374645341405", "1d152434 0a3a", "0a06243456 5a54", "0a244a",
    "0a244a648a", "0a44 4a04", "0a24 4a1000", "0a4a0444",
    "3e2d2918272332", "0e01", "0e1d1928171302", "07183748"};
// clang-format on

MOTIONLANG_BODY StrokedText stroke_text(std::string_view text) {
  StrokedText out;
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = decode_utf8(text, at);
    std::string_view letter = c == U'\u00B7' ? "08" : c > 32 && c < 127 ? stroke_letters[c - 33] : "";
    if (c <= 32) out.width += 4;
    if (c > 126 && letter.empty()) letter = "040d5d5404";
    if (letter.empty()) continue;
    int right = 0;
    std::vector<GridPoint>* stroke = nullptr;
    for (std::size_t i = 0; i < letter.size();) {
      if (letter[i] == ' ') {
        stroke = nullptr, ++i;
        continue;
      }
      if (stroke == nullptr) stroke = &out.strokes.emplace_back();
      const int x = digit(letter[i]), y = digit(letter[i + 1]);
      stroke->push_back({out.width + x, y});
      right = std::max(right, x);
      i += 2;
    }
    out.width += right + font_gap;
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
