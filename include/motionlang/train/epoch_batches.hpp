// SPDX-License-Identifier: MIT
/// Shuffled batches, epoch after epoch.
///
///     const EpochBatches batches(100, 32);
///     batches.per_epoch();   // 4
///     batches(0, seed);      // the numbers of the 32 items of the first step
#pragma once

#include <algorithm>  // min
#include <utility>    // swap
#include <vector>     // numbers

#include <motionlang/core/rng.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Every item occurs once in an epoch, in a new order. The last batch of an epoch may be smaller. Throws config_error
/// 101 without items, and for a batch below 1.
class EpochBatches {
 public:
  EpochBatches(Index items, Index batch) : items_(items), batch_(batch) {
    if (items < 1 || batch < 1) raise<config_error>(101, "batches of ", batch, " out of ", items, " items");
  }
  Index per_epoch() const { return (items_ + batch_ - 1) / batch_; }
  /// The number of items of a step.
  Index size(Index step) const { return std::min(batch_, items_ - step % per_epoch() * batch_); }

  /// Numbers of the items of a step.
  std::vector<Index> operator()(Index step, std::uint64_t seed) const {
    const Index epoch = step / per_epoch(), first = step % per_epoch() * batch_;
    std::vector<Index> order(static_cast<std::size_t>(items_));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
    auto rng = Philox{.seed = seed}.split("epoch").split(static_cast<std::uint64_t>(epoch));
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[rng.below(static_cast<std::uint32_t>(i))]);
    return {order.begin() + first, order.begin() + std::min(first + batch_, items_)};
  }

 private:
  Index items_, batch_;
};

MOTIONLANG_NAMESPACE_END
