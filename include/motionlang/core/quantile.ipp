// SPDX-License-Identifier: MIT
// Bodies of quantile.hpp.
#pragma once

#include <algorithm>  // nth_element
#include <utility>    // move

#include <motionlang/core/quantile.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double nth_smallest(std::vector<double> values, std::size_t n) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(n);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

MOTIONLANG_BODY double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto n = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  return nth_smallest(std::move(values), n);
}

MOTIONLANG_NAMESPACE_END
