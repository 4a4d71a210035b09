// SPDX-License-Identifier: MIT
// Bodies of simultaneous_segments.hpp.
#pragma once

#include <algorithm>  // sort, unique

#include <motionlang/core/error.hpp>
#include <motionlang/datasets/simultaneous_segments.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<SimultaneousSegment> simultaneous_segments(std::span<const BabelSegment> segments,
                                                                       Index most) {
  std::vector<Index> cuts;
  for (const BabelSegment& s : segments) {
    if (s.end <= s.start) {
      raise<config_error>(101, "simultaneous_segments: '", s.text, "' goes from ", s.start, " to ", s.end);
    }
    cuts.insert(cuts.end(), {s.start, s.end});
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  std::vector<SimultaneousSegment> out;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    SimultaneousSegment piece{cuts[i], cuts[i + 1], {}};
    bool transition = false;
    for (const BabelSegment& s : segments) {
      if (s.start > piece.start || s.end < piece.end) continue;
      piece.texts.push_back(s.text);
      transition |= s.is_transition();
    }
    const Index count = std::ssize(piece.texts);
    if (count < 2 || count > most || (count == 2 && transition)) continue;
    std::sort(piece.texts.begin(), piece.texts.end());
    out.push_back(std::move(piece));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
