// SPDX-License-Identifier: MIT
/// Stretches of a motion with a text, as BABEL has them. What TEACH and SINC make of them: teach_pairs.hpp,
/// simultaneous_segments.hpp. Read by datasets/babel.hpp.
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

/// Labels that TEACH and SINC train nothing on.
inline constexpr std::array<std::string_view, 7> babel_excluded_labels{"t-pose", "a-pose", "a pose",    "t pose",
                                                                       "tpose",  "apose",  "transition"};
bool is_babel_excluded(std::string_view label);

/// The segments that SINC takes, in their order: without empty ones and excluded labels. One without text stays here
/// (it
/// counts as simultaneous with others) and is nothing to train on. Source  SINC sinc/data/tools/extract_pairs.py
std::vector<BabelSegment> sinc_segments(std::vector<BabelSegment> segments);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/babel_segment.ipp>
#endif
