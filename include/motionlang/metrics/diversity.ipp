// SPDX-License-Identifier: MIT
// Bodies of diversity.hpp.
#pragma once

#include <motionlang/metrics/diversity.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY IndexPairs random_pairs(Index n, Index count, NumpyRandom& rng) {
  IndexPairs out;
  for (std::vector<Index>* list : {&out.first, &out.second}) {
    for (Index i = 0; i < count; ++i) list->push_back(static_cast<Index>(rng.randint(0, n)));
  }
  return out;
}

MOTIONLANG_BODY IndexPairs disjoint_draws(Index n, Index count, NumpyRandom& rng) {
  if (count >= n) raise<config_error>(101, "disjoint_draws: ", count, " of ", n, "; fewer than there are");
  IndexPairs out;
  out.first = rng.choice(n, count);
  out.second = rng.choice(n, count);
  return out;
}

MOTIONLANG_BODY IndexPairs pairs_within_classes(std::span<const Index> labels, Index classes, Index quota,
                                                NumpyRandom& rng) {
  if (classes < 1 || quota < 1) raise<config_error>(101, "pairs_within_classes: ", quota, " of ", classes, " classes");
  std::vector<Index> wanted(static_cast<std::size_t>(classes), 0);
  for (const Index y : labels) {
    if (y < 0 || y >= classes) raise<shape_error>(203, "pairs_within_classes: label ", y, " of ", classes);
    wanted[static_cast<std::size_t>(y)] = quota;
  }
  for (Index c = 0; c < classes; ++c) {
    if (wanted[static_cast<std::size_t>(c)] == 0)
      raise<numeric_error>(302, "pairs_within_classes: no sample of class ", c);
  }
  auto draw = [&] { return static_cast<Index>(rng.randint(0, std::ssize(labels))); };
  auto label = [&](Index i) { return static_cast<std::size_t>(labels[static_cast<std::size_t>(i)]); };
  IndexPairs out;
  for (Index left = quota * classes; left > 0;) {
    const Index first = draw();
    if (wanted[label(first)] == 0) continue;
    Index second = draw();
    while (label(second) != label(first)) second = draw();
    out.first.push_back(first), out.second.push_back(second);
    --wanted[label(first)], --left;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
