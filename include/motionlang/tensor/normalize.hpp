// SPDX-License-Identifier: MIT
/// Rows of length 1: what cosine similarity needs, in losses and in encoders.
#pragma once

#include <motionlang/tensor/ops.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Rows divided by max(norm, 1e-12). The sums are a product with ones, whose order does not depend on the number of rows: a row has the
/// same bits alone and among others.
template <Backend B>
Tensor<B, 2> normalize_rows(const Tensor<B, 2>& x) {
  const auto squared = matmul(square(x), Tensor<B, 2>::full({x.size(1), 1}, 1));
  return x / sqrt(maximum(squared, Tensor<B, 2>(1e-24)));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
