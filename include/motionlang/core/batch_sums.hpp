// SPDX-License-Identifier: MIT
/// Sums over the parts of a batch, for networks that normalise by the statistics of the whole batch.
#pragma once

#include <span>  // numbers

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The view that a part of a batch has of the others. Each part has its own object, in its Context.
/// Models  the parts of train/meeting_parts.hpp
class BatchSums {
 public:
  virtual ~BatchSums() = default;
  /// Replaces each number by its sum over all parts, whose bits do not depend on the number of processes. It waits for
  /// the other parts, so all parts must call it equally often, with equally many numbers.
  virtual void add(std::span<double> numbers) const = 0;
  /// True for the one part of a process that changes what its parts share, such as running statistics.
  virtual bool keeps_statistics() const = 0;
};

MOTIONLANG_NAMESPACE_END
