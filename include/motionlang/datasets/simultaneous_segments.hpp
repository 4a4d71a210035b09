// SPDX-License-Identifier: MIT
/// Ranges in which several actions happen at the same time, from overlapping segments of one motion. SINC is trained on
/// them.
///
///     simultaneous_segments(std::vector<BabelSegment>{{0, 60, "walk"}, {30, 90, "wave"}})   // [30, 60) {walk, wave}
///
/// Source   thesis B.3.1; SINC (Athanasiou et al., ICCV 2023) sinc/data/tools/spatiotempo.py spatial_compositions
/// Differs  from the code, which orders labels by a hash table: here they are sorted
#pragma once

#include <span>    // segments
#include <string>  // texts
#include <vector>  // segments

#include <motionlang/datasets/babel_segment.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct SimultaneousSegment {
  Index start = 0, end = 0;
  std::vector<std::string> texts;  // sorted; a text of two segments occurs twice
  bool operator==(const SimultaneousSegment&) const = default;
};

/// Between any two neighbouring starts or ends: the active texts, if there are two to `most`. An action and a
/// transition are not two actions. Throws config_error 101 for an empty segment.
std::vector<SimultaneousSegment> simultaneous_segments(std::span<const BabelSegment> segments, Index most = 4);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/simultaneous_segments.ipp>
#endif
