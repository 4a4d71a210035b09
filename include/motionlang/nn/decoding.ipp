// SPDX-License-Identifier: MIT
// Bodies of decoding.hpp.
#pragma once

#include <limits>   // infinity
#include <numeric>  // accumulate, iota

#include <motionlang/nn/decoding.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY Index draw(std::span<const double> p, double u) {
  const double all = std::accumulate(p.begin(), p.end(), 0.0);
  if (!(all > 0))
    raise<numeric_error>(302, "decoding: no symbol that may follow has a probability; take a larger top_k");
  double sum = 0;
  Index last = 0;
  for (Index i = 0; i < std::ssize(p); ++i) {
    const double share = p[static_cast<std::size_t>(i)] / all;
    if (share == 0) continue;
    sum += share, last = i;
    if (sum > u) break;
  }
  return last;
}

}  // namespace detail

MOTIONLANG_BODY IdSequences Decoded::written() const {
  std::vector<std::vector<Index>> out;
  for (std::size_t i = 0; i < ids.size(); ++i) out.emplace_back(ids[i].begin() + 1, ids[i].begin() + 1 + lengths[i]);
  return IdSequences::from(out);
}

MOTIONLANG_NAMESPACE_END
