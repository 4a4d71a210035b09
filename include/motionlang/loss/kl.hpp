// SPDX-License-Identifier: MIT
/// Divergences between diagonal Gaussians, averaged over all coordinates of all rows, or for each row.
#pragma once

#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Twice the divergence of each coordinate.
template <Backend B>
Tensor<B, 2> twice_kl(const Tensor<B, 2>& mu, const Tensor<B, 2>& logvar) {
  return square(mu) + exp(logvar) - 1.0 - logvar;
}
template <Backend B>
Tensor<B, 2> twice_kl(const Tensor<B, 2>& mu_q, const Tensor<B, 2>& logvar_q, const Tensor<B, 2>& mu_p,
                      const Tensor<B, 2>& logvar_p) {
  const auto log_ratio = logvar_q - logvar_p;
  return exp(log_ratio) + square(mu_q - mu_p) * exp(-logvar_p) - 1.0 - log_ratio;
}

}  // namespace detail

/// KL(N(mu, exp(logvar)) || N(0, 1)), averaged over all elements.
///     (mu^2 + exp(logvar) - 1 - logvar) / 2
/// Source  Kingma and Welling (2014), appendix B.
template <Backend B>
Tensor<B, 0> kl_to_standard_normal(const Tensor<B, 2>& mu, const Tensor<B, 2>& logvar) {
  return mean(detail::twice_kl(mu, logvar)) * 0.5;
}
/// The same averaged over the coordinates only, (rows).
template <Backend B>
Tensor<B, 1> kl_to_standard_normal_of_rows(const Tensor<B, 2>& mu, const Tensor<B, 2>& logvar) {
  return mean(detail::twice_kl(mu, logvar), 1) * 0.5;
}

/// KL(N(mu_q, exp(logvar_q)) || N(mu_p, exp(logvar_p))), averaged over all elements.
///     (exp(logvar_q - logvar_p) + (mu_q - mu_p)^2 exp(-logvar_p) - 1 - (logvar_q - logvar_p)) / 2
/// Source   a term of thesis eq. 4.2; TEMOS temos/model/losses/kl.py, TMR src/model/losses.py KLLoss
/// Differs  from the textbook, as published: a mean over the coordinates, not their sum
template <Backend B>
Tensor<B, 0> kl_divergence(const Tensor<B, 2>& mu_q, const Tensor<B, 2>& logvar_q, const Tensor<B, 2>& mu_p,
                           const Tensor<B, 2>& logvar_p) {
  return mean(detail::twice_kl(mu_q, logvar_q, mu_p, logvar_p)) * 0.5;
}
/// The same averaged over the coordinates only, (rows).
template <Backend B>
Tensor<B, 1> kl_divergence_of_rows(const Tensor<B, 2>& mu_q, const Tensor<B, 2>& logvar_q, const Tensor<B, 2>& mu_p,
                                   const Tensor<B, 2>& logvar_p) {
  return mean(detail::twice_kl(mu_q, logvar_q, mu_p, logvar_p), 1) * 0.5;
}

MOTIONLANG_NAMESPACE_END
