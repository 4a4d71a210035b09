// SPDX-License-Identifier: MIT
// Bodies of unit_rows.hpp.
#pragma once

#include <algorithm>  // min
#include <cmath>      // sqrt, isfinite

#include <motionlang/core/parallel.hpp>
#include <motionlang/search/unit_rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY Index whole_rows(std::string_view function, std::size_t values, Index width) {
  if (width < 1) raise<config_error>(101, function, ": rows of ", width, " numbers");
  if (values % static_cast<std::size_t>(width) != 0)
    raise<shape_error>(205, function, ": ", values, " values are not rows of ", width);
  return static_cast<Index>(values) / width;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<float> unit_rows(std::span<const float> rows, Index width) {
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

MOTIONLANG_BODY std::vector<float> mean_direction(std::span<const float> rows, Index width) {
  const auto directions = unit_rows(rows, width);
  const Index count = std::ssize(directions) / width;
  std::vector<float> mean(static_cast<std::size_t>(width));
  for (std::size_t i = 0; i < directions.size(); ++i)
    mean[i % mean.size()] += directions[i] / static_cast<float>(count);
  return mean;
}

MOTIONLANG_BODY void require_unit_rows(std::string_view where, std::span<const float> rows, Index width) {
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
