// SPDX-License-Identifier: MIT
// Bodies of babel_latents.hpp.
#pragma once

#include <algorithm>  // stable_sort

#include <motionlang/generate/babel_latents.hpp>
#include <motionlang/text/joined_labels.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<Interval> texts_in_order(const Timeline& timeline) {
  std::vector<Interval> out = timeline.intervals;
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.start < b.start; });
  for (std::size_t i = 1; i < out.size(); ++i) {
    if (out[i].start < out[i - 1].end)
      raise<timeline_error>(509, "'", out[i - 1].text, "' and '", out[i].text,
                            "' overlap; this model (TEACH) takes texts one after the other");
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> texts_of(const Timeline& timeline) {
  std::vector<std::string> out;
  for (const Interval& i : timeline.intervals) out.push_back(i.text);
  return out;
}

MOTIONLANG_BODY Interval texts_together(const Timeline& timeline) {
  return {join_labels(texts_of(timeline), Conjunction::same_time), 0, timeline.end(), BodyParts::all()};
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
