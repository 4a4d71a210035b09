// SPDX-License-Identifier: MIT
// Bodies of teach_pairs.hpp.
#pragma once

#include <algorithm>  // any_of, find
#include <map>        // segments by their times
#include <utility>    // pair

#include <motionlang/datasets/teach_pairs.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY PairFrames ActionPair::frames() const {
  if (transition && first.end < second.start) {
    const Index cut = transition->start + 1;
    return {{first.start, cut}, FrameRange{cut, second.start}, {second.start, second.end}};
  }
  const Index overlap = transition ? second.start - first.end : first.end - second.start;
  const Index cut = (2 * first.end + overlap) / 2 + 1;
  return {{first.start, cut}, std::nullopt, {cut, second.end}};
}

namespace detail {

inline bool is_before(const BabelSegment& x, const BabelSegment& s) {
  return x.start < s.start && x.end < s.end && x.end >= s.start;
}
inline bool is_after(const BabelSegment& x, const BabelSegment& s) {
  return s.start < x.start && x.start <= s.end && x.end > s.end;
}

/// Sorted by start and end, without poses at rest. If several have the same times, the last text counts.
inline std::vector<BabelSegment> actions_and_transitions(std::span<const BabelSegment> segments) {
  std::map<std::pair<Index, Index>, std::string_view> texts;
  for (const BabelSegment& s : segments) {
    if (s.is_transition() || !is_babel_excluded(s.text)) texts[{s.start, s.end}] = s.text;
  }
  std::vector<BabelSegment> out;
  out.reserve(texts.size());
  for (const auto& [times, text] : texts) out.push_back({times.first, times.second, std::string(text)});
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<ActionPair> teach_pairs(std::span<const BabelSegment> segments) {
  const std::vector<BabelSegment> sorted = detail::actions_and_transitions(segments);
  std::vector<ActionPair> out;
  const auto add = [&](ActionPair pair) {
    if (std::find(out.begin(), out.end(), pair) == out.end()) out.push_back(std::move(pair));
  };
  for (const BabelSegment& s : sorted) {
    std::vector<BabelSegment> before, after;
    for (const BabelSegment& x : sorted) {
      if (x.is_transition() && !s.is_transition()) continue;
      if (detail::is_before(x, s)) before.push_back(x);
      if (detail::is_after(x, s)) after.push_back(x);
    }
    if (!s.is_transition()) {
      for (const BabelSegment& b : before) add({b, std::nullopt, s});
      for (const BabelSegment& a : after) add({s, std::nullopt, a});
    } else if (s.start > 0) {
      for (const BabelSegment& b : before) {
        for (const BabelSegment& a : after) add({b, s, a});
      }
    }
  }
  return out;
}

MOTIONLANG_BODY bool is_teach_length(const PairFrames& frames, const TeachLengths& limits) {
  const auto fits = [&](Index n) { return limits.shortest <= n && n <= limits.longest; };
  return fits(frames.first.size()) && fits(frames.transition_size() + frames.second.size());
}

MOTIONLANG_BODY std::vector<BabelSegment> joined_pairs(std::span<const ActionPair> pairs) {
  std::vector<BabelSegment> out;
  for (const ActionPair& p : pairs) {
    BabelSegment whole{std::min(p.first.start, p.second.start), std::max(p.first.end, p.second.end),
                       p.first.text + ", " + p.second.text};
    if (p.transition) {
      whole.start = std::min(whole.start, p.transition->start);
      whole.end = std::max(whole.end, p.transition->end);
    }
    const bool known = std::any_of(out.begin(), out.end(),
                                   [&](const BabelSegment& s) { return s.start == whole.start && s.end == whole.end; });
    if (!known) out.push_back(std::move(whole));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
