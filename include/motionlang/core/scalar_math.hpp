// SPDX-License-Identifier: MIT
/// The elementary functions of `ScalarLike` types, for the built-in ones.
///
/// Geometry is written once for float, double, dual numbers, SIMD lanes and tensors. Name lookup by argument finds
/// `sqrt(Tensor)`, but not `std::sqrt` for a built-in number: hence these overloads, which must be visible first.
#pragma once

#include <cmath>  // the functions themselves

#include <motionlang/version.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

inline double sqrt(double x) { return std::sqrt(x); }
inline double exp(double x) { return std::exp(x); }
inline double log(double x) { return std::log(x); }
inline double sin(double x) { return std::sin(x); }
inline double cos(double x) { return std::cos(x); }
inline double atan2(double y, double x) { return std::atan2(y, x); }
inline float sqrt(float x) { return std::sqrt(x); }
inline float exp(float x) { return std::exp(x); }
inline float log(float x) { return std::log(x); }
inline float sin(float x) { return std::sin(x); }
inline float cos(float x) { return std::cos(x); }
inline float atan2(float y, float x) { return std::atan2(y, x); }

/// `a < b ? x : y`. The one branch that also works element by element: both x and y are always computed, so neither may
/// be NaN where it is not taken if the result is to be differentiated.
constexpr double where_less(double a, double b, double x, double y) { return a < b ? x : y; }
constexpr float where_less(float a, float b, float x, float y) { return a < b ? x : y; }

}  // namespace motionlang::inline MOTIONLANG_ABI
