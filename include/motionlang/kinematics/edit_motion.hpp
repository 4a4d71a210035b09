// SPDX-License-Identifier: MIT
/// Several edits of a clip, applied in a useful order. Each is also a function of its own.
///
///     const Motion loop = edit_motion(motion, {.mirror = true, .in_place = true, .loop = 0.5});
#pragma once

#include <optional>  // a filter
#include <utility>   // pair

#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/kinematics/one_euro_filter.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Edits of a clip's time, which come first.
struct TimeEdits {
  double from = 0, to = 0;  // seconds; to = 0: to the end
  double speed = 1;         // factor by which it becomes faster
  double fps = 0;           // 0: unchanged
};
/// The frames [first, last) of a clip from a time to a time, seconds, each rounded; to = 0: to the end.
std::pair<Index, Index> frames_between(const Motion& motion, double from, double to);
/// Throws option_error 101 if nothing of the clip is between `from` and `to`, and what change_speed and resample throw.
Motion edit_time(Motion motion, const TimeEdits& edits);

/// In this order.
struct MotionEdits {
  bool smpl = false;                         // retarget to SMPL's 24 joints
  bool mirror = false;                       // exchange left and right
  bool smooth = false;                       // removes jitter
  std::optional<OneEuroOptions> one_euro{};  // removes jitter without looking ahead
  bool fix_feet = false;  // put it on the floor and keep standing feet from sliding; on SMPL's 24 joints
  bool in_place = false;  // keep the root over the origin
  double loop = 0;        // blend this many seconds at the end into the start; 0: no loop
};
/// report  is set if the joints were not SMPL's and were retargeted. Throws what the single edits throw.
Motion edit_motion(Motion motion, const MotionEdits& edits, RetargetReport* report = nullptr);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/edit_motion.ipp>
#endif
