// SPDX-License-Identifier: MIT
/// Pairs of consecutive actions, from overlapping segments of one motion. TEACH is trained on them.
///
///     for (const ActionPair& pair : teach_pairs(babel_intervals(labels, 30, frames))) {
///       const PairFrames cut = pair.frames();
///       if (is_teach_length(cut)) use(pair.first.text, pair.second.text, cut);
///     }
///
/// Source    thesis A.2.3, "Data handling"; TEACH (Athanasiou et al., 3DV 2022) teach/data/babel.py separate_actions
/// Notation  segment S -> (start, end); X before S: X begins and ends earlier and touches S; X after S likewise
/// Differs   from the paper, as the code does: two overlapping actions are not divided in the middle of their overlap,
///           but half of it after the end of the first one
#pragma once

#include <optional>  // pairs without transition
#include <span>      // segments
#include <vector>    // pairs

#include <motionlang/compose/overlap.hpp>
#include <motionlang/datasets/babel_segment.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Frames of a pair; the parts follow each other without a gap. The published code instead gives the last frame of each
/// part, and for the second action the frame after its last.
struct PairFrames {
  FrameRange first;
  std::optional<FrameRange> transition;
  FrameRange second;

  FrameRange all() const { return {first.start, second.end}; }
  Index transition_size() const { return transition ? transition->size() : 0; }
  bool operator==(const PairFrames&) const = default;
};

struct ActionPair {
  BabelSegment first;
  std::optional<BabelSegment> transition;
  BabelSegment second;
  bool operator==(const ActionPair&) const = default;

  /// A transition counts only if the actions do not touch each other.
  PairFrames frames() const;
};

/// Every action with the actions that it touches, and every transition with the actions on both sides, in the order of
/// the segments. Each pair occurs once. `segments` may have any order.
std::vector<ActionPair> teach_pairs(std::span<const BabelSegment> segments);

/// Frames that TEACH trains on; its evaluation takes up to 100,000.
struct TeachLengths {
  Index shortest = 15, longest = 750;
};
/// True if the first action, and the second one with its transition, are neither too short nor too long.
bool is_teach_length(const PairFrames& frames, const TeachLengths& limits = {});

/// Pairs as one segment with both texts ("walk, sit down"), for training the baseline "Joint". If several pairs have
/// the same times, only the first counts.
std::vector<BabelSegment> joined_pairs(std::span<const ActionPair> pairs);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/teach_pairs.ipp>
#endif
