// SPDX-License-Identifier: MIT
/// Stretches in which several actions happen at once, out of overlapping segments of one motion: what SINC is trained
/// on.
///
///     simultaneous_segments(std::vector<BabelSegment>{{0, 60, "walk"}, {30, 90, "wave"}})   // [30, 60) {walk, wave}
///
/// Source   SINC (Athanasiou et al., ICCV 2023), spatial_compositions; spec sinc.md 5.2
/// Differs  from the code, whose order of labels is that of a hash table: here they are sorted
#pragma once

#include <span>  // segments

#include <motionlang/core/error.hpp>
#include <motionlang/datasets/babel_segment.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct SimultaneousSegment {
  Index start = 0, end = 0;
  std::vector<std::string> texts;  // sorted; a text that stands twice stands twice
  bool operator==(const SimultaneousSegment&) const = default;
};

/// Between any two neighbouring starts or ends: the texts that are active, if they are two to `most`. An action and a
/// transition are no two actions. Throws config_error 101 for a segment that is empty.
inline std::vector<SimultaneousSegment> simultaneous_segments(std::span<const BabelSegment> segments, Index most = 4) {
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
