// SPDX-License-Identifier: MIT
// Bodies of rounding.hpp.
#pragma once

#include <cmath>  // nearbyint, pow, isfinite

#include <motionlang/core/error.hpp>
#include <motionlang/core/rounding.hpp>
#include <motionlang/core/standard_library.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws config_error 101 for more places than a double can have.
inline void require_places(const char* function, int places) {
  if (places < 0 || places > 15) raise<config_error>(101, function, ": ", places, " decimal places");
}

}  // namespace detail

MOTIONLANG_BODY double python_round(double x, int places) {
  detail::require_places("python_round", places);
  if (!std::isfinite(x)) return x;
  char digits[400];  // the largest double has 309 digits before the point
  const char* end = detail::to_chars(digits, digits + sizeof digits, x, std::chars_format::fixed, places).ptr;
  detail::from_chars(digits, end, x);
  return x;
}

MOTIONLANG_BODY double numpy_round(double x, int places) {
  detail::require_places("numpy_round", places);
  const double scale = std::pow(10.0, places);
  return std::nearbyint(x * scale) / scale;
}

MOTIONLANG_NAMESPACE_END
