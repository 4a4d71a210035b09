// SPDX-License-Identifier: MIT
/// Which text owns which body part while several texts are active.
///
/// Source   SINC (Athanasiou et al., ICCV 2023) heuristic as STMC's code applies it; spec stmc.md 3.2. Where papers and
///          code differ (the base is a text with legs first, ties are random), the code is followed.
/// Rule     1. Base: of the texts with legs (of all, if none has legs) the one with the most body parts. It gets all
///             five parts.
///          2. The others, by number of parts, largest first, in file order among equals, take their parts away from
///             whoever holds them: the text with fewer parts wins, among equals the later one.
/// Ties     between base texts: the first in the file, or random as published when a generator is given
#pragma once

#include <algorithm>  // stable_sort
#include <array>      // one owner for each part
#include <span>       // texts of a piece

#include <motionlang/compose/intervals.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Number of the interval that owns each body part.
using PartOwners = std::array<Index, body_part_count>;

/// A generator that can put a list into random order: PythonRandom (as published), NumpyRandom.
template <class G>
concept Shuffler = requires(G& g, std::span<Index> list) {
  g.shuffle(list);
};

/// The library's rule for ties: keep the order of the file.
struct FirstWins {
  void shuffle(std::span<Index>) const {}
};

namespace detail {

/// Most body parts first; equals keep their order.
template <class T>
void sort_by_part_count(std::vector<Index>& texts, const BasicTimeline<T>& timeline) {
  const auto parts = [&](Index i) { return timeline.intervals[static_cast<std::size_t>(i)].parts.count(); };
  std::stable_sort(texts.begin(), texts.end(), [&](Index a, Index b) { return parts(a) > parts(b); });
}

/// One shuffle if there is a choice to make: of the texts with legs if there are several, of all if there is none.
template <class T, Shuffler G>
Index base_text(const BasicTimeline<T>& timeline, std::span<const Index> texts, G& ties) {
  std::vector<Index> candidates;
  for (Index i : texts) {
    if (timeline.intervals[static_cast<std::size_t>(i)].parts.has(BodyPart::legs)) candidates.push_back(i);
  }
  if (candidates.empty()) candidates.assign(texts.begin(), texts.end());
  ties.shuffle(std::span<Index>(candidates));
  sort_by_part_count(candidates, timeline);
  return candidates.front();
}

}  // namespace detail

/// Owners of the five parts on a piece with at least one text. `texts` are numbers of intervals in file order.
template <class T, Shuffler G>
PartOwners assign_parts(const BasicTimeline<T>& timeline, std::span<const Index> texts, G& ties) {
  PartOwners owners;
  const Index base = detail::base_text(timeline, texts, ties);
  owners.fill(base);
  std::vector<Index> others(texts.begin(), texts.end());
  std::erase(others, base);
  detail::sort_by_part_count(others, timeline);
  for (Index i : others) {
    for (int p = 0; p < body_part_count; ++p) {
      if (timeline.intervals[static_cast<std::size_t>(i)].parts.has(static_cast<BodyPart>(p))) {
        owners[static_cast<std::size_t>(p)] = i;
      }
    }
  }
  return owners;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
