// SPDX-License-Identifier: MIT
// Bodies of long_texts.hpp.
#pragma once

#include <motionlang/compose/long_texts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<Interval> equal_parts(const Interval& whole, Index count) {
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

MOTIONLANG_BODY Timeline divide_long_texts(const Timeline& timeline, Index longest) {
  if (longest < 1) raise<config_error>(101, "divide_long_texts: parts of ", counted(longest, "frame"));
  Timeline out{{}, timeline.body};
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
