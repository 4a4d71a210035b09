// SPDX-License-Identifier: MIT
/// Vectors of length 1 and their cosine, for searches.
#pragma once

#include <cmath>   // sqrt, isfinite
#include <span>    // rows
#include <vector>  // normalized rows

#include <motionlang/core/concepts.hpp>
#include <motionlang/core/error.hpp>
#include <motionlang/core/parallel.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// <a, b> in double, rounded once. Products of floats are exact there, so what is left of rounding is the order of four
/// sums: every compiler and every processor gives the same bits.
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
inline Index whole_rows(std::string_view function, std::size_t values, Index width) {
  if (width < 1) raise<config_error>(101, function, ": rows of ", width, " numbers");
  if (values % static_cast<std::size_t>(width) != 0)
    raise<shape_error>(205, function, ": ", values, " values are no rows of ", width);
  return static_cast<Index>(values) / width;
}

}  // namespace detail

/// Rows divided by their length. Throws shape_error 205, numeric_error 301 for a row that is not finite, 302 for one of
/// length 0.
inline std::vector<float> unit_rows(std::span<const float> rows, Index width) {
  const Index count = detail::whole_rows("unit_rows", rows.size(), width);
  std::vector<float> out(rows.begin(), rows.end());
  for (Index r = 0; r < count; ++r) {
    double square = 0;
    float* row = out.data() + r * width;
    for (Index i = 0; i < width; ++i) square += static_cast<double>(row[i]) * static_cast<double>(row[i]);
    if (!std::isfinite(square)) raise<numeric_error>(301, "unit_rows: row ", r, " of ", count, " is not finite");
    if (square == 0) raise<numeric_error>(302, "unit_rows: row ", r, " of ", count, " has length 0");
    const double scale = 1 / std::sqrt(square);
    for (Index i = 0; i < width; ++i) row[i] = static_cast<float>(row[i] * scale);
  }
  return out;
}

/// Throws shape_error 205, numeric_error 302 with the first row whose length is not 1 (to 1/1000), or that is not
/// finite.
inline void require_unit_rows(std::string_view where, std::span<const float> rows, Index width) {
  const Index count = detail::whole_rows(where, rows.size(), width);
  constexpr Index at_once = 1024;
  std::vector<Index> wrong(static_cast<std::size_t>((count + at_once - 1) / at_once), -1);
  parallel_for(std::ssize(wrong), [&](Index part) {
    for (Index r = part * at_once; r < std::min(count, (part + 1) * at_once); ++r) {
      float square[16] = {};
      const float* row = rows.data() + r * width;
      Index i = 0;
      for (; i + 16 <= width; i += 16) {
        for (int j = 0; j < 16; ++j) square[j] += row[i + j] * row[i + j];
      }
      for (; i < width; ++i) square[0] += row[i] * row[i];
      float sum = 0;
      for (const float s : square) sum += s;
      if (std::abs(sum - 1) <= 0.002f) continue;
      wrong[static_cast<std::size_t>(part)] = r;
      return;
    }
  });
  for (const Index r : wrong) {
    if (r >= 0) raise<numeric_error>(302, where, ": vector ", r, " of ", count, " is not of length 1");
  }
}

MOTIONLANG_NAMESPACE_END
