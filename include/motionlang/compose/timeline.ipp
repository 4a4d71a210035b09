// SPDX-License-Identifier: MIT
// Bodies of timeline.hpp.
#pragma once

#include <cmath>  // trunc

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Index frame_at(double seconds, double fps) {
  const double frame = std::trunc(fps * seconds);
  if (!(std::abs(frame) <= static_cast<double>(latest_time))) {
    raise<config_error>(101, "frame_at: ", seconds, " s at ", fps, " frames per second is out of range");
  }
  return static_cast<Index>(frame);
}

MOTIONLANG_BODY Timeline to_frames(const TimelineInSeconds& timeline, double fps) {
  Timeline out{{}, timeline.body};
  for (const auto& i : timeline.intervals) {
    out.intervals.push_back({i.text, frame_at(i.start, fps), frame_at(i.end, fps), i.parts, i.place});
  }
  shift_to_zero(out);
  return out;
}

MOTIONLANG_BODY TimelineInSeconds to_seconds(const Timeline& timeline, double fps) {
  const auto seconds = [&](Index frame) {
    double t = static_cast<double>(frame) / fps;
    while (frame_at(t, fps) < frame) t = std::nextafter(t, HUGE_VAL);  // the quotient was rounded down
    return t;
  };
  TimelineInSeconds out{{}, timeline.body};
  for (const auto& i : timeline.intervals)
    out.intervals.push_back({i.text, seconds(i.start), seconds(i.end), i.parts, i.place});
  return out;
}

MOTIONLANG_NAMESPACE_END
