// SPDX-License-Identifier: MIT
/// STMC and the baselines that it is compared with, by name; and the timelines of those that put everything on one
/// track, or into one sentence.
///
/// Source  thesis 6.3.3; STMC (Petrovich et al. 2024) mtt/create_baselines.py. The published script works in seconds
///         and writes files, which are then read at 20 fps. Converting with to_frames gives the same.
#pragma once

#include <array>        // modes
#include <string_view>  // names

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline BodyParts united(BodyParts a, BodyParts b) { return {a.bits | b.bits}; }

}  // namespace detail

/// One track (DiffCollage): each piece between cuts has its active texts joined by " while ", with all their parts.
/// Pieces without a text are left out.
TimelineInSeconds single_track(const TimelineInSeconds& timeline);

/// One sentence, "T0 and then T1 while T2", with the parts of all texts. It lasts from 0 to at most 9.8 s, the longest
/// motion that the models were trained on. The published rule is for timelines of three texts. From longer timelines
/// the sentence takes the first three texts; for shorter ones it ends earlier.
TimelineInSeconds one_text(const TimelineInSeconds& timeline);

/// The ways of making a motion from a timeline (thesis, table 6.1).
///   stmc          every step of denoising is a collage of the texts
///   sinc          each text is sampled alone, and parts are stitched once at the end, with hard cuts
///   sinc_lerp     the same; around cuts parts are interpolated (systems/sinc_baseline.hpp)
///   single_track  STMC of `single_track`: DiffCollage
///   one_text      STMC of `one_text`, which is plain text to motion
enum class StmcMode { stmc, sinc, sinc_lerp, single_track, one_text };

inline constexpr std::array stmc_modes{StmcMode::stmc, StmcMode::sinc, StmcMode::sinc_lerp, StmcMode::single_track,
                                       StmcMode::one_text};
/// "stmc", "sinc", "sinc-lerp", "single-track", "one-text".
std::string_view to_string(StmcMode mode);
/// Throws config_error 103 for another name.
StmcMode parse_stmc_mode(std::string_view name, std::string_view where = "mode");

/// The timeline that a mode samples: that of a baseline with one track or one sentence, or the timeline as it is. In
/// frames cuts stay where they are.
/// fps  of the frames
Timeline timeline_of_mode(StmcMode mode, const Timeline& timeline, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/baselines.ipp>
#endif
