// SPDX-License-Identifier: MIT
/// Cutting a timeline at every start and end: between two neighbouring cuts the set of active texts is constant.
///
/// Source  STMC (Petrovich et al. 2024), section 3.2; spec stmc.md 3.1
#pragma once

#include <algorithm>  // sort, unique, lower_bound
#include <numeric>    // iota

#include <motionlang/compose/timeline.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// A stretch without cuts inside, and the intervals that cover it, in file order.
template <class T>
struct BasicPiece {
  T start{}, end{};
  std::vector<Index> intervals;
  bool operator==(const BasicPiece&) const = default;
};
using Piece = BasicPiece<Index>;

/// All starts and ends, each once, ascending.
template <class T>
std::vector<T> cut_points(const BasicTimeline<T>& timeline) {
  std::vector<T> points;
  for (const auto& i : timeline.intervals) points.push_back(i.start), points.push_back(i.end);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// The pieces between neighbouring cuts; those of gaps have no intervals. Throws config_error 101 if so many intervals
/// lie over each other that the lists would not be reasonable (10 million entries).
template <class T>
std::vector<BasicPiece<T>> elementary_pieces(const BasicTimeline<T>& timeline) {
  const auto& intervals = timeline.intervals;
  const auto interval = [&](Index i) -> const BasicInterval<T>& { return intervals[static_cast<std::size_t>(i)]; };
  std::vector<Index> by_start(intervals.size());
  std::iota(by_start.begin(), by_start.end(), Index{0});
  std::sort(by_start.begin(), by_start.end(), [&](Index a, Index b) { return interval(a).start < interval(b).start; });

  std::vector<BasicPiece<T>> pieces;
  const std::vector<T> points = cut_points(timeline);
  std::vector<Index> active;  // ascending
  std::size_t next = 0, entries = 0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const T left = points[k], right = points[k + 1];
    std::erase_if(active, [&](Index i) { return interval(i).end < right; });
    for (; next < by_start.size() && interval(by_start[next]).start <= left; ++next) {
      const Index i = by_start[next];
      if (interval(i).end >= right) active.insert(std::lower_bound(active.begin(), active.end(), i), i);
    }
    entries += active.size();
    if (entries > 10'000'000) {
      raise<config_error>(101, "elementary_pieces: too many of ", intervals.size(), " intervals overlap");
    }
    pieces.push_back({left, right, active});
  }
  return pieces;
}

/// Adds an interval with the unconditional text "" and all body parts for every stretch from 0 to the end that no text
/// covers.
template <class T>
void fill_gaps(BasicTimeline<T>& timeline) {
  std::vector<std::pair<T, T>> covered;
  for (const auto& i : timeline.intervals) covered.emplace_back(i.start, i.end);
  std::sort(covered.begin(), covered.end());
  T reached{};
  for (const auto& [start, end] : covered) {
    if (start > reached) timeline.intervals.push_back({"", reached, start, BodyParts::all()});
    reached = std::max(reached, end);
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI
