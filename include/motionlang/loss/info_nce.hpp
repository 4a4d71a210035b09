// SPDX-License-Identifier: MIT
/// Contrastive loss with filtered negatives (InfoNCE).
#pragma once

#include <motionlang/tensor/normalize.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

///     S_ij = cos(x_i, y_j) / tau,   S_ij = -inf where i != j and <t_i, t_j> > 2 threshold - 1
///     loss = (CE(S) + CE(S^T)) / 2,   CE(S) = mean_i (log sum_j exp(S_ij) - S_ii)
/// Source    TMR (Petrovich, Black, Varol, ICCV 2023), section 3.2
/// Notation  motion -> x, text -> y, sentence -> t (unit rows; constant), temperature -> tau
/// Shapes    x, y (batch, latent); t (batch, d), may be null: nothing is filtered -> ()
/// Differs   from the paper: threshold is given in [0, 1] and mapped to [-1, 1], as the reference code does
/// Throws    shape_error 204 if the batch sizes or the lengths of sentences differ, config_error 101 unless
///           temperature > 0
template <Backend B>
Tensor<B, 0> info_nce(const Tensor<B, 2>& x, const Tensor<B, 2>& y, double temperature,
                      const std::vector<std::vector<double>>* sentences = nullptr, double threshold = 0.8) {
  const Index n = x.size(0);
  if (y.size(0) != n || (sentences != nullptr && static_cast<Index>(sentences->size()) != n)) {
    raise<shape_error>(204, "info_nce: batches of ", x.shape(), ", ", y.shape());
  }
  if (!(temperature > 0)) raise<config_error>(101, "info_nce: temperature ", temperature);
  using S = typename B::scalar;
  std::vector<S> filter(static_cast<std::size_t>(n * n)), diagonal(filter.size());
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const auto at = static_cast<std::size_t>(i * n + j);
      diagonal[at] = i == j ? S(1) : S(0);
      if (i == j || sentences == nullptr) continue;
      const auto &a = (*sentences)[static_cast<std::size_t>(i)], &b = (*sentences)[static_cast<std::size_t>(j)];
      if (a.size() != b.size())
        raise<shape_error>(204, "info_nce: sentences of ", a.size(), " and ", b.size(), " numbers");
      double similarity = 0;
      for (std::size_t k = 0; k < a.size(); ++k) similarity += a[k] * b[k];
      if (similarity > 2 * threshold - 1) filter[at] = S(-1e30);
    }
  }
  const auto s = matmul(normalize_rows(x), normalize_rows(y), {.transpose_b = true}) * (1 / temperature) +
                 Tensor<B, 2>::from(filter, {n, n});
  const auto pick = Tensor<B, 2>::from(diagonal, {n, n});
  auto cross_entropy = [&](const Tensor<B, 2>& t) {  // relative to the largest of each row: nothing overflows
    const auto u = t - reshape<2>(max(t, 1), {n, 1});
    return mean(log(sum(exp(u), 1)) - sum(u * pick, 1));
  };
  return (cross_entropy(s) + cross_entropy(transpose(s))) * 0.5;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
