// SPDX-License-Identifier: MIT
// Bodies of edit_motion.hpp.
#pragma once

#include <algorithm>  // clamp, max, min
#include <cmath>      // lround

#include <motionlang/core/option_error.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/edit_motion.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::pair<Index, Index> frames_between(const Motion& motion, double from, double to) {
  const auto frame = [&](double seconds) {
    return static_cast<Index>(std::clamp(seconds * motion.fps + 0.5, 0.0, static_cast<double>(motion.frames())));
  };
  return {frame(from), frame(to > 0 ? to : motion.seconds())};
}

MOTIONLANG_BODY Motion edit_time(Motion m, const TimeEdits& edits) {
  if (edits.from > 0 || edits.to > 0) {
    const auto [first, last] = frames_between(m, edits.from, edits.to);
    if (first >= last)
      raise<option_error>(101, "'", m.name, "': nothing of its ", m.seconds(), " s is between ", edits.from, " and ",
                          edits.to > 0 ? edits.to : m.seconds(), " s");
    m = crop(m, first, last);
  }
  if (edits.speed != 1) m = change_speed(m, edits.speed);
  if (edits.fps > 0) m = resample(m, edits.fps);
  return m;
}

MOTIONLANG_BODY Motion edit_motion(Motion m, const MotionEdits& edits, RetargetReport* report) {
  if (edits.smpl) m = on_smpl(m, report);
  if (edits.mirror) m = mirror(m);
  if (edits.smooth) m = smooth_motion(m);
  if (edits.one_euro) m = one_euro_filter(m, *edits.one_euro);
  if (edits.fix_feet) {
    place_on_floor(m);
    m = motionlang::fix_feet(m);
  }
  if (edits.in_place) m = motionlang::in_place(m);
  if (edits.loop > 0) {
    const double frames = std::min(edits.loop * m.fps, 1e9);
    m = make_loop(m, std::max<Index>(1, std::lround(frames))).motion;
  }
  return m;
}

MOTIONLANG_NAMESPACE_END
