// SPDX-License-Identifier: MIT
// Bodies of batch_parts.hpp.
#pragma once

#include <numeric>  // accumulate

#include <motionlang/train/batch_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double BatchPart::share(std::span<const Index> numbers) const {
  const auto own = numbers.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count()));
  const Index part = std::accumulate(own.begin(), own.end(), Index{0});
  return static_cast<double>(part) / static_cast<double>(std::accumulate(numbers.begin(), numbers.end(), Index{0}));
}

MOTIONLANG_NAMESPACE_END
