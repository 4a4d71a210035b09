// SPDX-License-Identifier: MIT
/// Long texts in parts.
///
/// Denoisers learn from clips of ten seconds at most. A text of a minute as one crop makes somebody who stands, or
/// turns in the air; in parts that follow each other it is done all the time.
///
///     const auto motion = stmc.generate(divide_long_texts(timeline, 160), rng);
#pragma once

#include <vector>  // parts

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Of one text: a day in parts of 8 s makes 10,800.
inline constexpr Index most_parts = 100000;

namespace detail {

/// An interval in `count` parts that follow each other, equally long to a frame.
inline std::vector<Interval> equal_parts(const Interval& whole, Index count) {
  std::vector<Interval> parts;
  const Index frames = whole.end - whole.start;
  for (Index i = 0; i < count; ++i) {
    Interval part = whole;
    part.start = whole.start + frames * i / count;
    part.end = whole.start + frames * (i + 1) / count;
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace detail

/// Divides every text of more than `longest` frames into as few parts as will do, which are equally long to a frame.
/// Throws config_error 101 unless longest is 1 or more, and for more than most_parts of a text.
inline Timeline divide_long_texts(const Timeline& timeline, Index longest) {
  if (longest < 1) raise<config_error>(101, "divide_long_texts: parts of ", counted(longest, "frame"));
  Timeline out;
  for (const Interval& whole : timeline.intervals) {
    const Index parts = std::max<Index>(1, (whole.end - whole.start + longest - 1) / longest);
    if (parts > most_parts) {
      raise<config_error>(101, "divide_long_texts: '", whole.text, "' of ", counted(whole.end - whole.start, "frame"),
                          " makes ", counted(parts, "part"), ", expected ", most_parts, " at most");
    }
    for (Interval& part : detail::equal_parts(whole, parts)) out.intervals.push_back(std::move(part));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
