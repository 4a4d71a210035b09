// SPDX-License-Identifier: MIT
/// The elementary functions of `ScalarLike` types, for built-in types.
///
/// Geometry is written once for float, double, dual numbers, SIMD lanes and tensors. Argument-dependent lookup finds
/// `sqrt(Tensor)`, but not `std::sqrt` for a built-in type. These overloads fill that gap, and must be visible first.
#pragma once

#include <cmath>   // the functions themselves
#include <limits>  // infinity

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

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

/// exp(x) as PyTorch (1.13 of Debian) computes it for float tensors: SLEEF's expf_u10. Its last digit often differs
/// from that of the C library. Published tables of frequencies need it, because after thousands of frames it decides
/// the fourth digit.
inline float torch_exp(float x) {
  if (!(x >= -104.0f)) return x < 0 ? 0.0f : x;  // NaN stays
  if (x > 100.0f) return std::numeric_limits<float>::infinity();
  const float n = std::rint(x * 1.442695040888963407f);
  const float f = std::fma(n, -1.428606765330187045e-06f, std::fma(n, -0.693145751953125f, x));
  constexpr float series[] = {0.00139304355252534151077271f, 0.00833336077630519866943359f,
                              0.0416664853692054748535156f, 0.166666671633720397949219f, 0.5f};
  float p = 0.000198527617612853646278381f;
  for (const float c : series) p = std::fma(p, f, c);
  return std::ldexp(1.0f + std::fma(f * f, p, f), static_cast<int>(n));
}

/// `a < b ? x : y`, which also works element by element. Both x and y are always computed. If the result is
/// differentiated, neither may be NaN, even where it is not chosen.
constexpr double where_less(double a, double b, double x, double y) { return a < b ? x : y; }
constexpr float where_less(float a, float b, float x, float y) { return a < b ? x : y; }

MOTIONLANG_NAMESPACE_END
