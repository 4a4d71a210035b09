// SPDX-License-Identifier: MIT
/// Divergence between diagonal Gaussians.
#pragma once

#include <motionlang/tensor/ops.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// KL(N(mu, exp(logvar)) || N(0, 1)), averaged over all elements.
///     (mu^2 + exp(logvar) - 1 - logvar) / 2
/// Source  Kingma and Welling (2014), appendix B.
template <Backend B>
Tensor<B, 0> kl_to_standard_normal(const Tensor<B, 2>& mu, const Tensor<B, 2>& logvar) {
  return mean(square(mu) + exp(logvar) - 1.0 - logvar) * 0.5;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
