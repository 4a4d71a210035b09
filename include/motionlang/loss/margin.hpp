// SPDX-License-Identifier: MIT
/// Contrastive losses with a Euclidean margin. margin_loss compares all pairs of a batch, as an alternative to InfoNCE.
/// shifted_margin_loss compares each with one other partner.
#pragma once

#include <motionlang/loss/false_negatives.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/tensor/index.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// max(0, margin - d) for squared distances. For two equal points no direction is defined, so their root gets the slope
/// 0.
template <Backend B, int R>
Tensor<B, R> short_of_margin(const Tensor<B, R>& squared, double margin) {
  return maximum(Tensor<B, R>(margin) - sqrt(maximum(squared, Tensor<B, R>(1e-24))), Tensor<B, R>(0.0));
}

}  // namespace detail

///     d_ij = |x_i - y_j + 1e-6|,   loss = mean_i d_ii^2 + mean_{i != j, not filtered} max(0, margin - d_ij)^2
/// Source   Hadsell, Chopra, LeCun (CVPR 2006), eq. 4; distance and margin of Guo et al. (CVPR 2022). The ablation of
///          TMR, thesis table 5.3: all pairs of the batch, with the same filter as InfoNCE
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
  const auto short_of = detail::short_of_margin(squared, margin);
  return mean_over(squared, positive, n) + mean_over(square(short_of), negative, negatives);
}

///     d(a, b) = |a - b + 1e-6|,   positive = mean_i d(x_i, y_i)^2,   negative = mean_i max(0, margin - d(x_i, y_(i +
///     shift) mod n))^2
/// Source   TM2T (Guo et al., ECCV 2022), appendix C, TM2T eq. 8; text-to-motion networks/trainers.py
///          TextMotionMatchTrainer, networks/modules.py ContrastiveLoss. There the shift is random in 0 ... n - 2, so
///          the right partner is sometimes pushed away, at shift 0
/// Differs  from TM2T eq. 8, as published: the equation squares |s - p|^2 once more, and compares |s - p|^2 with the
///          margin
/// Shapes   x, y (batch, latent) -> the two terms, of weight 1
/// Throws   shape_error 204 if the shapes differ, config_error 101 unless margin > 0 and 0 <= shift
template <Backend B>
LossTerms<B> shifted_margin_loss(const Tensor<B, 2>& x, const Tensor<B, 2>& y, Index shift, double margin = 10) {
  const Index n = x.size(0);
  if (y.shape() != x.shape()) raise<shape_error>(204, "shifted_margin_loss: batches of ", x.shape(), ", ", y.shape());
  if (!(margin > 0) || shift < 0) raise<config_error>(101, "shifted_margin_loss: margin ", margin, ", shift ", shift);
  PoolVector<Index> other;
  for (Index i = 0; i < n; ++i) other.push_back((i + shift) % n);
  auto squared = [&](const Tensor<B, 2>& partner) { return sum(square(x - partner + 1e-6), 1); };
  LossTerms<B> out;
  // The two terms of TM2T eq. 8, see above.
  out.add("positive", 1, mean(squared(y)));
  out.add("negative", 1, mean(square(detail::short_of_margin(squared(gather(y, other)), margin))));
  return out;
}

MOTIONLANG_NAMESPACE_END
