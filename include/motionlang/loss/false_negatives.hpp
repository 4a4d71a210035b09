// SPDX-License-Identifier: MIT
/// Pairs of a batch that contrastive losses must not push apart, because their texts mean nearly the same.
#pragma once

#include <cmath>  // sqrt

#include <motionlang/tensor/tensor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     filtered_ij = i != j and <t_i, t_j> > 2 threshold - 1
/// Source   TMR (Petrovich, Black, Varol, ICCV 2023), section 3.3; the threshold is given in [0, 1] and mapped to [-1,
///          1], as in the published code
/// sentences  (batch, width), rows of length 1; one of zeros (no words) has similarity 0 to all
/// threshold  0: nothing is filtered
/// result   (batch, batch), row by row, 1 = filtered; empty for threshold 0. The diagonal is never filtered. The
///          published code filters it below 0.5, and its loss is then NaN
/// Throws   config_error 101 unless 0 <= threshold <= 1, numeric_error 302 for a row whose length is not 1 within 0.01
///          (use normalize_rows)
template <Backend B>
std::vector<unsigned char> false_negatives(const Tensor<B, 2>& sentences, double threshold) {
  if (!(threshold >= 0 && threshold <= 1)) raise<config_error>(101, "false_negatives: threshold ", threshold);
  if (threshold == 0) return {};
  const auto n = static_cast<std::size_t>(sentences.size(0)), width = static_cast<std::size_t>(sentences.size(1));
  const auto t = sentences.span();
  for (std::size_t i = 0; i < n; ++i) {
    double squared = 0;
    for (std::size_t k = 0; k < width; ++k)
      squared += static_cast<double>(t[i * width + k]) * static_cast<double>(t[i * width + k]);
    if (squared != 0 && !(std::abs(std::sqrt(squared) - 1) <= 0.01))
      raise<numeric_error>(302, "false_negatives: sentence ", i, " has length ", std::sqrt(squared), ", not 1");
  }
  std::vector<unsigned char> filtered(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      double similarity = 0;
      for (std::size_t k = 0; k < width; ++k)
        similarity += static_cast<double>(t[i * width + k]) * static_cast<double>(t[j * width + k]);
      filtered[i * n + j] = filtered[j * n + i] = similarity > 2 * threshold - 1 ? 1 : 0;
    }
  }
  return filtered;
}

MOTIONLANG_NAMESPACE_END
