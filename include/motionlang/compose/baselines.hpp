// SPDX-License-Identifier: MIT
/// The timelines of the baselines that STMC is compared with: everything on one track, or in one sentence.
///
/// Source  thesis 6.3.3; STMC (Petrovich et al. 2024) mtt/create_baselines.py. They are made from seconds and
///         written to files, which are then read at 20 fps; converting with to_frames gives the same.
#pragma once

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline BodyParts united(BodyParts a, BodyParts b) { return {a.bits | b.bits}; }

}  // namespace detail

/// One track (DiffCollage): on each piece between cuts the active texts joined by " while ", with all their parts.
/// Pieces without a text are left out.
TimelineInSeconds single_track(const TimelineInSeconds& timeline);

/// One sentence, "T0 and then T1 while T2", with the parts of all texts, from 0 to at most 9.8 s, the longest motion
/// that the models were trained on. The published rule is for timelines of three texts: of longer ones the first three
/// are in the sentence, shorter ones leave its end away.
TimelineInSeconds one_text(const TimelineInSeconds& timeline);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/baselines.ipp>
#endif
