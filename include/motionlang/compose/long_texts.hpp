// SPDX-License-Identifier: MIT
/// Long texts in parts.
///
/// Denoisers learn from clips of ten seconds at most. A text of a minute as one crop makes somebody who stands, or turns in the air;
/// in parts that follow each other it is done all the time.
///
///     const auto motion = stmc.generate(divide_long_texts(timeline, 160), rng);
#pragma once

#include <motionlang/compose/timeline.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Divides every text of more than `longest` frames into as few parts as will do, which are equally long to a frame.
/// Throws config_error 101 unless longest is 1 or more.
inline Timeline divide_long_texts(const Timeline& timeline, Index longest) {
  if (longest < 1) raise<config_error>(101, "divide_long_texts: parts of ", longest, " frames");
  Timeline out;
  for (const Interval& whole : timeline.intervals) {
    const Index frames = whole.end - whole.start, parts = std::max<Index>(1, (frames + longest - 1) / longest);
    for (Index i = 0; i < parts; ++i) {
      Interval part = whole;
      part.start = whole.start + frames * i / parts;
      part.end = whole.start + frames * (i + 1) / parts;
      out.intervals.push_back(std::move(part));
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
