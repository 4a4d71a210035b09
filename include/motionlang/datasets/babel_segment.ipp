// SPDX-License-Identifier: MIT
// Bodies of babel_segment.hpp.
#pragma once

#include <algorithm>  // find

#include <motionlang/datasets/babel_segment.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool is_babel_excluded(std::string_view label) {
  return std::find(babel_excluded_labels.begin(), babel_excluded_labels.end(), label) != babel_excluded_labels.end();
}

MOTIONLANG_BODY std::vector<BabelSegment> sinc_segments(std::vector<BabelSegment> segments) {
  std::erase_if(segments, [](const BabelSegment& s) { return s.end <= s.start || is_babel_excluded(s.text); });
  return segments;
}

MOTIONLANG_NAMESPACE_END
