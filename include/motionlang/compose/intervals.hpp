// SPDX-License-Identifier: MIT
/// Cutting a timeline at every start and end: between two neighbouring cuts the set of active texts is constant.
///
/// Source  thesis 6.2.3, "Resolving unassigned timeframes"; STMC (Petrovich et al. 2024) src/stmc.py process_timeline
#pragma once

#include <algorithm>  // lower_bound
#include <utility>    // pair

#include <motionlang/compose/timeline.hpp>
#include <motionlang/core/sort.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A range without cuts inside, and the intervals that cover it, in file order.
template <class T>
struct BasicPiece {
  T start{}, end{};
  std::vector<Index> intervals;
  bool operator==(const BasicPiece&) const = default;
};
using Piece = BasicPiece<Index>;

/// The pieces between neighbouring cuts; those of gaps have no intervals. Throws config_error 101 if so many intervals
/// overlap that the lists would have more than 10 million entries.
template <class T>
std::vector<BasicPiece<T>> elementary_pieces(const BasicTimeline<T>& timeline) {
  std::vector<std::pair<T, Index>> events;  // every start and end, with the number of its interval
  for (Index i = 0; const auto& interval : timeline.intervals) {
    events.emplace_back(interval.start, i);
    events.emplace_back(interval.end, i++);
  }
  detail::sort(events, [](const auto& a, const auto& b) { return a < b; });

  std::vector<BasicPiece<T>> pieces;
  std::vector<Index> active;  // ascending
  std::size_t entries = 0;
  for (std::size_t at = 0; at < events.size();) {
    const T cut = events[at].first;
    for (; at < events.size() && events[at].first == cut; ++at) {
      const Index i = events[at].second;
      const auto& interval = timeline.intervals[static_cast<std::size_t>(i)];
      const auto place = std::lower_bound(active.begin(), active.end(), i);
      const bool is_active = place != active.end() && *place == i;
      if (is_active && interval.end == cut) active.erase(place);
      if (!is_active && interval.start == cut && interval.end > cut) active.insert(place, i);
    }
    if (at == events.size()) break;
    entries += active.size();
    if (entries > 10'000'000) {
      raise<config_error>(101, "elementary_pieces: too many of ", timeline.intervals.size(), " intervals overlap");
    }
    pieces.push_back({cut, events[at].first, active});
  }
  return pieces;
}

/// Adds an interval with the unconditional text "" and all body parts for every gap between 0 and the end.
template <class T>
void fill_gaps(BasicTimeline<T>& timeline) {
  std::vector<std::pair<T, T>> covered;
  for (const auto& i : timeline.intervals) covered.emplace_back(i.start, i.end);
  detail::sort(covered, [](const auto& a, const auto& b) { return a < b; });
  T reached{};
  for (const auto& [start, end] : covered) {
    if (start > reached) timeline.intervals.push_back({"", reached, start, timeline.body.all()});
    reached = std::max(reached, end);
  }
}

MOTIONLANG_NAMESPACE_END
