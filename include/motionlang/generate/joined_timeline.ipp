// SPDX-License-Identifier: MIT
// Bodies of joined_timeline.hpp.
#pragma once

#include <motionlang/generate/joined_timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Timeline joined_timeline(const Timeline& timeline, const LabelSentences& sentence_of) {
  std::vector<std::string> labels;
  for (const Interval& i : timeline.intervals) labels.push_back(i.text);
  if (labels.empty()) return timeline;
  Timeline out = timeline;
  out.intervals = {{sentence_of(labels), 0, timeline.end(), BodyParts::all()}};
  return out;
}

MOTIONLANG_NAMESPACE_END
