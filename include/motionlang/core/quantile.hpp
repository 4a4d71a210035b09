// SPDX-License-Identifier: MIT
/// Values by their rank: medians, quartiles, "all but the lowest 5 %".
#pragma once

#include <algorithm>  // nth_element
#include <cstddef>    // sizes
#include <utility>    // move
#include <vector>     // values

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The value that n others are not above; n below the number of values.
inline double nth_smallest(std::vector<double> values, std::size_t n) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(n);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}
/// The value below which a share of the values is; 0 of none.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto n = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  return nth_smallest(std::move(values), n);
}

MOTIONLANG_NAMESPACE_END
