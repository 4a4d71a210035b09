// SPDX-License-Identifier: MIT
/// The place of the largest value in each row.
#pragma once

#include <algorithm>  // max_element

#include <motionlang/tensor/tensor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// For each row the column of the largest value, the first among equals. Throws shape_error 205 for empty rows.
template <Backend B>
std::vector<Index> arg_max(const Tensor<B, 2>& x) {
  const Index rows = x.size(0), width = x.size(1);
  if (width < 1) raise<shape_error>(205, "arg_max: ", x.shape());
  const auto numbers = x.span();
  std::vector<Index> out;
  for (Index r = 0; r < rows; ++r) {
    const auto row = numbers.subspan(static_cast<std::size_t>(r * width), static_cast<std::size_t>(width));
    out.push_back(std::max_element(row.begin(), row.end()) - row.begin());
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
