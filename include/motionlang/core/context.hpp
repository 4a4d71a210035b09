// SPDX-License-Identifier: MIT
/// Settings of a model call besides its inputs. By default they are empty, and no dropout runs.
#pragma once

#include <optional>  // no generator, no dropout

#include <motionlang/core/batch_sums.hpp>
#include <motionlang/core/rng.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Dropout runs only if the context carries a generator: there is no train or eval flag to forget.
///
///     model(x, t, text, {.dropout = rng.split("dropout").split(step)});
struct Context {
  std::optional<Philox> dropout{};
  mutable std::uint64_t drawn = 0;  // masks handed out so far; every mask has its own stream
  bool recompute = false;  // training keeps only the inputs of layers and recomputes the rest: less memory, more time
  const BatchSums* sums = nullptr;  // of a part of a batch: batch norm takes the statistics of all parts

  /// The generator of the next dropout mask. Only when `dropout` is set.
  Philox next_mask() const { return dropout->split(drawn++); }
};

MOTIONLANG_NAMESPACE_END
