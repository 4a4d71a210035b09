// SPDX-License-Identifier: MIT
/// Contrastive loss with a Euclidean margin: what InfoNCE is compared with.
#pragma once

#include <motionlang/loss/false_negatives.hpp>
#include <motionlang/tensor/index.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

///     d_ij = |x_i - y_j + 1e-6|,   loss = mean_i d_ii^2 + mean_{i != j, not filtered} max(0, margin - d_ij)^2
/// Source   Hadsell, Chopra, LeCun (CVPR 2006), eq. 4; distance and margin of Guo et al. (CVPR 2022). The ablation of TMR, thesis table
///          5.3: all pairs of the batch, with the same filter as InfoNCE
/// Differs  from Guo et al., who have one negative for each pair
/// Shapes   x, y (batch, latent); filtered (batch, batch), see false_negatives, empty: none -> ()
/// Throws   shape_error 204 if the shapes differ, 205 for a filter of another size, config_error 101 unless margin > 0
template <Backend B>
Tensor<B, 0> margin_loss(const Tensor<B, 2>& x, const Tensor<B, 2>& y, double margin = 10,
                         std::span<const unsigned char> filtered = {}) {
  const Index n = x.size(0), width = x.size(1);
  if (y.shape() != x.shape()) raise<shape_error>(204, "margin_loss: batches of ", x.shape(), ", ", y.shape());
  if (!filtered.empty() && static_cast<Index>(filtered.size()) != n * n)
    raise<shape_error>(205, "margin_loss: a filter of ", filtered.size(), " pairs for a batch of ", n);
  if (!(margin > 0)) raise<config_error>(101, "margin_loss: margin ", margin);
  using S = typename B::scalar;
  std::vector<S> positive(static_cast<std::size_t>(n * n)), negative(positive.size());
  Index negatives = 0;
  for (std::size_t k = 0; k < positive.size(); ++k) {
    const bool pair = k % static_cast<std::size_t>(n + 1) == 0, kept = !pair && (filtered.empty() || filtered[k] == 0);
    positive[k] = pair ? S(1) : S(0);
    negative[k] = kept ? S(1) : S(0);
    negatives += kept ? 1 : 0;
  }
  auto mean_over = [&](const Tensor<B, 2>& values, const std::vector<S>& which, Index count) {
    return sum(values * Tensor<B, 2>::from(which, {n, n})) * (1.0 / static_cast<double>(std::max<Index>(1, count)));
  };
  const auto difference = reshape<3>(x, {n, 1, width}) - reshape<3>(y, {1, n, width}) + 1e-6;
  const auto squared = sum(square(difference), 2);
  // A pair at distance 0 has no direction to be pushed in: its root gets slope 0.
  const auto short_of = maximum(Tensor<B, 2>(margin) - sqrt(maximum(squared, Tensor<B, 2>(1e-24))), Tensor<B, 2>(0.0));
  return mean_over(squared, positive, n) + mean_over(square(short_of), negative, negatives);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
