// SPDX-License-Identifier: MIT
/// Values by their rank: medians, quartiles, "all but the lowest 5 %".
#pragma once

#include <cstddef>  // sizes
#include <vector>   // values

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The value at position n of the sorted values, counted from 0. n is less than their number.
double nth_smallest(std::vector<double> values, std::size_t n);
/// The value at this share of the sorted values: 0 gives the smallest, 0.5 the median, 1 the largest. 0 for an empty
/// list.
double quantile(std::vector<double> values, double share);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/quantile.ipp>
#endif
