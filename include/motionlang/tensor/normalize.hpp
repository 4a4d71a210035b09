// SPDX-License-Identifier: MIT
/// Rows of length 1, for cosine similarity in losses and encoders.
#pragma once

#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Rows divided by max(norm, 1e-12). The sums are a product with ones, whose order does not depend on the number of
/// rows. So a row has the same bits alone and among others.
template <Backend B>
Tensor<B, 2> normalize_rows(const Tensor<B, 2>& x) {
  const auto squared = matmul(square(x), Tensor<B, 2>::full({x.size(1), 1}, 1));
  return x / sqrt(maximum(squared, Tensor<B, 2>(1e-24)));
}

/// S_ij = cos(x_i, y_j), (rows of x, rows of y); 0 if a row is zero. Every element is summed in the same order, so
/// equal rows have equal similarities bit by bit. Ranks depend on such ties.
template <Backend B>
Tensor<B, 2> cosine_similarity(const Tensor<B, 2>& x, const Tensor<B, 2>& y) {
  return matmul(normalize_rows(x), normalize_rows(y), {.transpose_b = true});
}

MOTIONLANG_NAMESPACE_END
