// SPDX-License-Identifier: MIT
/// The motion of a line of captions, on the floor, with what the table lets follow.
///
///     const SegmentMotion s = segment_motion(line, [&](const ClipLine& l) { return clip_at_20_fps(l); }, 16);
///     const Motion long_enough = lasting(s, 40);
#pragma once

#include <functional>  // clips
#include <optional>    // cycles

#include <motionlang/datasets/clip_lines.hpp>
#include <motionlang/kinematics/loops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct SegmentMotion {
  Motion motion;
  std::optional<Loop> cycle{};  // the whole motion, which is one cycle
  std::optional<Loop> rest{};   // at the end of the motion: what follows an action for as long as wanted
  Index action = 0;             // frames before that; all where nothing follows
};

/// A segment on the floor (ground_recording).
///     repeat      one cycle; one on the spot whose feet slide goes ahead instead (off_treadmill)
///     hold        half a second of the last pose after it
///     then CLIP   two rounds of that clip after it, blended in
/// clip_of  gives the clip of a line, at any frame rate that is the same for all
/// least    frames that a segment must have, except a cycle
/// Throws   io_error 403 if a segment is too short, or if a cycle does not end as it begins; and what clip_of throws
SegmentMotion segment_motion(const ClipLine& line, const std::function<Motion(const ClipLine&)>& clip_of, Index least);

/// The action, and after it as much of what may follow as fills this number of frames. What follows an action that is
/// long enough is cut off. Motions with nothing after them stay as they are.
Motion lasting(const SegmentMotion& segment, Index frames);

namespace detail {

/// Mean distance of the joints of two frames, with places and headings removed.
double pose_distance(const Vec3<double>* a, const Vec3<double>* b, Index joints);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/segment_motion.ipp>
#endif
