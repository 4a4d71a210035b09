// SPDX-License-Identifier: MIT
/// Pairs of actions that follow one another, out of overlapping segments of one motion: what TEACH is trained on.
///
///     for (const ActionPair& pair : teach_pairs(babel_intervals(labels, 30, frames))) {
///       const PairFrames cut = pair.frames();
///       if (is_teach_length(cut)) use(pair.first.text, pair.second.text, cut);
///     }
///
/// Source    thesis A.2.3, "Data handling"; TEACH (Athanasiou et al., 3DV 2022) teach/data/babel.py separate_actions
/// Notation  segment S -> (start, end); X before S: X begins and ends earlier and touches S; X after S likewise
/// Differs   from the paper: two overlapping actions are not parted in the middle of their overlap but half of it after
///           the end of the first one, as the code does
#pragma once

#include <optional>  // pairs without transition
#include <span>      // segments
#include <vector>    // pairs

#include <motionlang/compose/overlap.hpp>
#include <motionlang/datasets/babel_segment.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Frames of a pair: the parts lie end to end. Published: the last frame of each, and of the second action the frame
/// behind its last.
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

  /// A transition counts only where the actions do not touch each other.
  PairFrames frames() const;
};

/// Every action with the ones that it touches, and every transition with the actions on both sides, in the order of the
/// segments; each pair once. `segments` may stand in any order.
std::vector<ActionPair> teach_pairs(std::span<const BabelSegment> segments);

/// Frames that TEACH trains on; its evaluation takes up to 100,000.
struct TeachLengths {
  Index shortest = 15, longest = 750;
};
/// True if the first action, and the second one with its transition, are neither too short nor too long.
bool is_teach_length(const PairFrames& frames, const TeachLengths& limits = {});

/// Pairs as one segment with both texts ("walk, sit down"): what the baseline "Joint" is trained on. Of several with
/// the same times the first.
std::vector<BabelSegment> joined_pairs(std::span<const ActionPair> pairs);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/teach_pairs.ipp>
#endif
