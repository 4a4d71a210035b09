// SPDX-License-Identifier: MIT
/// Letters as lines on a grid, for pictures of pixels: printable ASCII and the middle dot.
#pragma once

#include <string_view>  // texts
#include <vector>       // strokes

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A point of the grid: descenders reach down to y = 0, letters stand on 4, small ones reach up to 10, capitals to 13.
struct GridPoint {
  int x, y;
};
inline constexpr int font_baseline = 4, font_em = 13, font_gap = 2;  // em: size of the font in units of the grid

/// The lines of a text from left to right, in units of the grid, and its width. Letters that the font lacks are boxes.
struct StrokedText {
  std::vector<std::vector<GridPoint>> strokes;
  int width = 0;
};
StrokedText stroke_text(std::string_view text);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/detail/stroke_font.ipp>
#endif
