// SPDX-License-Identifier: MIT
/// The timelines of the baselines that STMC is compared with: everything on one track, or in one sentence.
///
/// Source  STMC (Petrovich et al. 2024), mtt/create_baselines.py; spec stmc.md 5. They are made from seconds and
///         written to files, which are then read at 20 fps; converting with to_frames gives the same.
#pragma once

#include <motionlang/compose/intervals.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline BodyParts united(BodyParts a, BodyParts b) { return {a.bits | b.bits}; }

}  // namespace detail

/// One track (DiffCollage): on each piece between cuts the active texts joined by " while ", with all their parts.
/// Pieces without a text are left out.
inline TimelineInSeconds single_track(const TimelineInSeconds& timeline) {
  TimelineInSeconds out;
  for (const auto& piece : elementary_pieces(timeline)) {
    if (piece.intervals.empty()) continue;
    IntervalInSeconds joined{"", piece.start, piece.end, {}};
    for (Index i : piece.intervals) {
      const IntervalInSeconds& active = timeline.intervals[static_cast<std::size_t>(i)];
      joined.text += (i == piece.intervals.front() ? "" : " while ") + active.text;
      joined.parts = detail::united(joined.parts, active.parts);
    }
    out.intervals.push_back(std::move(joined));
  }
  return out;
}

/// One sentence, "T0 and then T1 while T2", with the parts of all texts, from 0 to at most 9.8 s, the longest motion
/// that the models were trained on. The published rule is for timelines of three texts: of longer ones the first three
/// are in the sentence, shorter ones leave its end away.
inline TimelineInSeconds one_text(const TimelineInSeconds& timeline) {
  constexpr double longest = 9.8;
  constexpr const char* words[] = {"", " and then ", " while "};
  if (timeline.intervals.empty()) return {};
  IntervalInSeconds joined{"", 0.0, 0.0, {}};
  double first = timeline.intervals.front().start;
  for (std::size_t i = 0; i < timeline.intervals.size(); ++i) {
    const IntervalInSeconds& interval = timeline.intervals[i];
    if (i < std::size(words)) joined.text += words[i] + interval.text;
    joined.parts = detail::united(joined.parts, interval.parts);
    first = std::min(first, interval.start);
  }
  joined.end = std::min(timeline.end() - first, longest);
  return {{std::move(joined)}};
}

MOTIONLANG_NAMESPACE_END
