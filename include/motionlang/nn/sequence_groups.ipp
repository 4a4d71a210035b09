// SPDX-License-Identifier: MIT
// Bodies of sequence_groups.hpp.
#pragma once

#include <motionlang/nn/sequence_groups.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY SequenceShares share_sequences(const Offsets& offsets, std::span<const Index> order, Index threads) {
  SequenceShares out;
  if (threads == 1) return out;
  PoolVector<Index> rows(static_cast<std::size_t>(threads)), thread_of;
  Index total = 0;
  std::size_t shared = 0;
  for (Index s : order) {
    Index* const fewest = std::min_element(rows.begin(), rows.end());
    thread_of.push_back(fewest - rows.begin());
    *fewest += offsets.length(s);
    total += offsets.length(s);
    const Index most = *std::max_element(rows.begin(), rows.end());
    if (total >= 128 * threads && most * threads * 20 <= total * 21) shared = thread_of.size();
  }
  for (std::size_t i = 0; i < shared; ++i) out.push_back(thread_of[i]);
  return out;
}

MOTIONLANG_BODY PoolVector<Index> longest_first(const Offsets& offsets) {
  PoolVector<Index> order;
  for (Index s = 0; s < offsets.count(); ++s) order.push_back(s);
  sort(order, [&](Index a, Index b) {
    return offsets.length(a) != offsets.length(b) ? offsets.length(a) > offsets.length(b) : a < b;
  });
  return order;
}

MOTIONLANG_BODY std::span<const Index> first_group(const Offsets& offsets, std::span<const Index> order, Index rows) {
  std::size_t size = 0;
  Index sum = 0;
  do sum += offsets.length(order[size++]);
  while (size < order.size() && sum + offsets.length(order[size]) <= rows);
  return order.first(size);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
