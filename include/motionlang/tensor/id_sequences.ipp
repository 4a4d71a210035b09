// SPDX-License-Identifier: MIT
// Bodies of id_sequences.hpp.
#pragma once

#include <algorithm>  // copy

#include <motionlang/tensor/id_sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY IdSequences::IdSequences(std::vector<Index> list, const Offsets& o) : ids(std::move(list)), offsets(o) {
  if (std::ssize(ids) != offsets.rows())
    raise<shape_error>(207, "IdSequences: offsets for ", offsets.rows(), " ids, ", ids.size(), " are there");
}

MOTIONLANG_BODY IdSequences IdSequences::from(const std::vector<std::vector<Index>>& lists) {
  std::vector<Index> ids, lengths;
  for (const auto& list : lists) {
    ids.insert(ids.end(), list.begin(), list.end());
    lengths.push_back(std::ssize(list));
  }
  return {std::move(ids), Offsets(lengths)};
}

MOTIONLANG_BODY IdSequences IdSequences::from_padded(std::span<const Index> padded, Index width, Index pad) {
  if (width < 1 || std::ssize(padded) % width != 0)
    raise<shape_error>(205, "IdSequences: ", padded.size(), " ids are not rows of ", width);
  std::vector<std::vector<Index>> lists;
  for (std::size_t i = 0; i < padded.size(); ++i) {
    if (i % static_cast<std::size_t>(width) == 0) lists.emplace_back();
    if (padded[i] != pad) lists.back().push_back(padded[i]);
  }
  return from(lists);
}

MOTIONLANG_BODY IdSequences IdSequences::without_ends(Index first, Index last) const {
  std::vector<std::vector<Index>> lists;
  for (Index i = 0; i < count(); ++i) {
    const auto list = (*this)[i];
    if (std::ssize(list) < first + last)
      raise<shape_error>(207, "IdSequences: ", first + last, " ids less than ", list.size(), " in sequence ", i);
    lists.emplace_back(list.begin() + first, list.end() - last);
  }
  return from(lists);
}

MOTIONLANG_NAMESPACE_END
