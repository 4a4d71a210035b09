// SPDX-License-Identifier: MIT
/// The texts of a timeline as the tracks that pages and film strips show below a motion.
///
///     write_viewer("walk.html", motion, timeline_tracks(timeline, motion.fps));
#pragma once

#include <motionlang/compose/timeline.hpp>
#include <motionlang/view/track.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One track for each text, in seconds.
std::vector<Track> timeline_tracks(const Timeline& timeline, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/timeline_tracks.ipp>
#endif
