// SPDX-License-Identifier: MIT
/// The loss of classifiers.
#pragma once

#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/ops.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

///     mean_i (log sum_j exp(s_ij) - s_i,y_i),   computed relative to the largest s_ij of each row: nothing overflows
/// logits s (rows, classes), one label y per row. Throws shape_error 203 for a label that is no class, 204 if the counts differ.
template <Backend B>
Tensor<B, 0> cross_entropy(const Tensor<B, 2>& logits, std::span<const Index> labels) {
  const Index rows = logits.size(0), classes = logits.size(1);
  if (std::ssize(labels) != rows)
    raise<shape_error>(204, "cross_entropy: ", labels.size(), " labels for ", logits.shape());
  PoolVector<Index> at;
  for (Index i = 0; i < rows; ++i) {
    const Index y = labels[static_cast<std::size_t>(i)];
    if (y < 0 || y >= classes) raise<shape_error>(203, "cross_entropy: label ", y, " of ", classes, " classes");
    at.push_back(i * classes + y);
  }
  const auto s = logits - reshape<2>(max(logits, 1), {rows, 1});
  return mean(log(sum(exp(s), 1)) - gather(reshape<1>(s, {rows * classes}), at));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
