// SPDX-License-Identifier: MIT
/// Segments of a motion with a text, as in BABEL. teach_pairs.hpp and simultaneous_segments.hpp make the items of TEACH
/// and SINC from them. datasets/babel.hpp reads them.
#pragma once

#include <array>        // excluded labels
#include <string>       // texts
#include <string_view>  // labels
#include <vector>       // segments

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Frames [start, end) with their text.
struct BabelSegment {
  Index start = 0, end = 0;
  std::string text;
  bool operator==(const BabelSegment&) const = default;

  bool is_transition() const { return text == "transition"; }
};

/// Labels from which TEACH and SINC learn nothing.
inline constexpr std::array<std::string_view, 7> babel_excluded_labels{"t-pose", "a-pose", "a pose",    "t pose",
                                                                       "tpose",  "apose",  "transition"};
bool is_babel_excluded(std::string_view label);

/// The segments that SINC takes, in their order, without empty ones and excluded labels. A segment without text stays
/// here, because it counts as simultaneous with others, but is not trained on. Source  SINC
/// sinc/data/tools/extract_pairs.py
std::vector<BabelSegment> sinc_segments(std::vector<BabelSegment> segments);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/babel_segment.ipp>
#endif
