// SPDX-License-Identifier: MIT
/// Values by their rank: medians, quartiles, "all but the lowest 5 %".
#pragma once

#include <cstddef>  // sizes
#include <vector>   // values

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The value that n others are not above; n below the number of values.
double nth_smallest(std::vector<double> values, std::size_t n);
/// The value below which a share of the values is; 0 of none.
double quantile(std::vector<double> values, double share);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/quantile.ipp>
#endif
