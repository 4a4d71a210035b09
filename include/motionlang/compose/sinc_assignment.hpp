// SPDX-License-Identifier: MIT
/// Assigns each body part to one text while several texts are active.
///
/// Source   thesis 6.2.3, figure 6.4: the heuristic of SINC (thesis B.2.1) as STMC src/stmc.py applies it. Where papers
///          and code differ (the base is a text with legs first, ties are random), this follows the code.
/// Rule     1. The base is the text with the most body parts. It must have the part that carries the path (the legs of
///             a human), unless no text has it. It gets all parts.
///          2. The others take their parts from the present owners. They come by number of parts, the largest first, in
///             file order among equals. So the text with fewer parts wins, and among equals the later one.
/// Ties     between base texts: the first in the file, or random as published when a generator is given
#pragma once

#include <span>    // texts of a piece
#include <vector>  // one owner for each part

#include <motionlang/compose/intervals.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Number of the interval that owns each body part.
using PartOwners = std::vector<Index>;

/// A generator that can shuffle a list: PythonRandom (as published), NumpyRandom.
template <class G>
concept Shuffler = requires(G& g, std::span<Index> list) {
  g.shuffle(list);
};

/// The library's rule for ties: keep the order of the file.
struct FirstWins {
  void shuffle(std::span<Index>) const {}
};

namespace detail {

/// Among texts with the path (or all, if none has it), the one with the most parts. On a tie, the first after a
/// shuffle. Shuffling a single text takes no random numbers.
template <class T, Shuffler G>
Index base_text(const BasicTimeline<T>& timeline, std::span<const Index> texts, G& ties) {
  const auto parts = [&](Index i) { return timeline.intervals[static_cast<std::size_t>(i)].parts; };
  std::vector<Index> candidates;
  for (Index i : texts) {
    if (parts(i).has(timeline.body.path())) candidates.push_back(i);
  }
  if (candidates.empty()) candidates.assign(texts.begin(), texts.end());
  ties.shuffle(std::span<Index>(candidates));
  Index base = candidates.front();
  for (Index i : candidates) {
    if (parts(i).count() > parts(base).count()) base = i;
  }
  return base;
}

}  // namespace detail

/// Owners of all parts on a piece with at least one text. `texts` are numbers of intervals in file order.
template <class T, Shuffler G>
PartOwners assign_parts(const BasicTimeline<T>& timeline, std::span<const Index> texts, G& ties) {
  const Index base = detail::base_text(timeline, texts, ties);
  const int size = timeline.body.size();
  PartOwners owners(static_cast<std::size_t>(size), base);
  for (int count = size; count > 0; --count) {  // texts with many parts first, in file order among equals
    for (Index i : texts) {
      const BodyParts parts = timeline.intervals[static_cast<std::size_t>(i)].parts;
      if (i == base || parts.count() != count) continue;
      for (int p = 0; p < size; ++p) {
        if (parts.has(static_cast<BodyPart>(p))) owners[static_cast<std::size_t>(p)] = i;
      }
    }
  }
  return owners;
}

MOTIONLANG_NAMESPACE_END
