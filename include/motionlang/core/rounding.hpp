// SPDX-License-Identifier: MIT
/// Decimal places as Python and NumPy round them: published tables are printed by one or the other.
#pragma once

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Python's `round(x, places)`: the decimal number nearest to the binary value of x. 2.675 is stored as slightly less
/// than it looks, so it becomes 2.67. Throws config_error 101 unless 0 <= places <= 15.
double python_round(double x, int places);

/// NumPy's `round(x, places)`: x 10^places to the nearest integer, halves to the even one, then back. 2.675 becomes
/// 2.68, because the product is rounded first. Throws config_error 101 unless 0 <= places <= 15.
double numpy_round(double x, int places);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/rounding.ipp>
#endif
