// SPDX-License-Identifier: MIT
/// Vectors of length 1 and their cosine, for searches.
#pragma once

#include <span>    // rows
#include <vector>  // normalized rows

#include <motionlang/core/concepts.hpp>
#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// <a, b> in double, rounded once. Products of floats are exact there, and four sums have a fixed order. So every
/// compiler and every processor gives the same bits.
inline float exact_cosine(const float* a, const float* b, Index width) {
  double s[4] = {};
  Index i = 0;
  for (; i + 4 <= width; i += 4) {
    for (int j = 0; j < 4; ++j) s[j] += static_cast<double>(a[i + j]) * static_cast<double>(b[i + j]);
  }
  for (; i < width; ++i) s[0] += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return static_cast<float>((s[0] + s[1]) + (s[2] + s[3]));
}

namespace detail {

/// Throws shape_error 205 unless `values` are whole rows.
Index whole_rows(std::string_view function, std::size_t values, Index width);

}  // namespace detail

/// Rows divided by their length. Throws shape_error 205, numeric_error 301 for a row that is not finite, 302 for one of
/// length 0.
std::vector<float> unit_rows(std::span<const float> rows, Index width);

/// (width): the mean of the rows' directions, which is not of length 1. Throws what unit_rows throws.
std::vector<float> mean_direction(std::span<const float> rows, Index width);

/// Throws shape_error 205, and numeric_error 302 with the first row whose length is not 1 (to 1/1000), or that is not
/// finite.
void require_unit_rows(std::string_view where, std::span<const float> rows, Index width);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/unit_rows.ipp>
#endif
