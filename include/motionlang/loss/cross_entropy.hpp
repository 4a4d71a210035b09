// SPDX-License-Identifier: MIT
/// The loss of classifiers.
#pragma once

#include <motionlang/tensor/id_sequences.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     l_i = -sum_j t_ij log softmax(s_i)_j,   t_ij = 1 - e where j = y_i, e / (classes - 1) elsewhere
/// Values are computed relative to the largest s_ij of each row, so that nothing overflows. e: label smoothing as in
/// TM2T (Szegedy et al., 2016, section 7, give e / classes to every class).
/// logits s (rows, classes), one label y per row -> (rows). Throws shape_error 203 for a label that is not a class, 204
/// if the counts differ, and config_error 101 unless 0 <= e < 1.
template <Backend B>
Tensor<B, 1> cross_entropies(const Tensor<B, 2>& logits, std::span<const Index> labels, double smoothing = 0) {
  const Index rows = logits.size(0), classes = logits.size(1);
  if (std::ssize(labels) != rows)
    raise<shape_error>(204, "cross_entropy: ", labels.size(), " labels for ", logits.shape());
  if (!(smoothing >= 0 && smoothing < 1)) raise<config_error>(101, "cross_entropy: label smoothing ", smoothing);
  PoolVector<Index> at;
  for (Index i = 0; i < rows; ++i) {
    const Index y = labels[static_cast<std::size_t>(i)];
    if (y < 0 || y >= classes) raise<shape_error>(203, "cross_entropy: label ", y, " of ", classes, " classes");
    at.push_back(i * classes + y);
  }
  const auto s = logits - reshape<2>(max(logits, 1), {rows, 1});
  const auto partition = log(sum(exp(s), 1));
  const auto own = partition - gather(reshape<1>(s, {rows * classes}), at);
  if (smoothing == 0 || classes == 1) return own;
  const double each = smoothing / static_cast<double>(classes - 1);
  const auto all = partition * static_cast<double>(classes) - sum(s, 1);
  return own * (1 - smoothing - each) + all * each;
}
/// Their mean.
template <Backend B>
Tensor<B, 0> cross_entropy(const Tensor<B, 2>& logits, std::span<const Index> labels, double smoothing = 0) {
  return mean(cross_entropies(logits, labels, smoothing));
}

/// The sum over all symbols of -log p (TM2T eq. 4, and the first sum of TM2T eq. 7), not their mean. `logits`:
/// predictions of the next symbol after each symbol except the last.
template <Backend B>
Tensor<B, 0> next_symbol_loss(const Tensor<B, 2>& logits, const IdSequences& written, double smoothing = 0) {
  return sum(cross_entropies(logits, written.without_ends(1, 0).ids, smoothing));
}

MOTIONLANG_NAMESPACE_END
