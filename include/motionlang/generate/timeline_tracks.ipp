// SPDX-License-Identifier: MIT
// Bodies of timeline_tracks.hpp.
#pragma once

#include <motionlang/generate/text_warnings.hpp>
#include <motionlang/generate/timeline_tracks.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Track> timeline_tracks(const Timeline& timeline, double fps) {
  std::vector<Track> tracks;
  for (const Interval& i : timeline.intervals) {
    Track track{i.text, static_cast<double>(i.start) / fps, static_cast<double>(i.end) / fps, {}};
    if (i.parts == timeline.body.all())
      track.parts = {whole_body};
    else
      for (const BodyPart p : listed_parts(i.parts)) track.parts.push_back(to_string(p));
    tracks.push_back(std::move(track));
  }
  return tracks;
}

MOTIONLANG_NAMESPACE_END
