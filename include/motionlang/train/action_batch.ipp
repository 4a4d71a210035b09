// SPDX-License-Identifier: MIT
// Bodies of action_batch.hpp.
#pragma once

#include <motionlang/train/action_batch.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> others_of_class(std::span<const Index> which, std::span<const Index> classes,
                                                   Philox& rng) {
  std::vector<Index> out;
  for (const Index i : which) {
    std::vector<Index> others;
    for (Index k = 0; k < std::ssize(classes); ++k) {
      if (k != i && classes[static_cast<std::size_t>(k)] == classes[static_cast<std::size_t>(i)]) others.push_back(k);
    }
    out.push_back(others.empty() ? i : others[rng.below(static_cast<std::uint32_t>(others.size()))]);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
