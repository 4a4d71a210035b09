// SPDX-License-Identifier: MIT
/// The hinge losses of a generator and a discriminator.
#pragma once

#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     (mean max(0, 1 - D(x)) + mean max(0, 1 + D(x^))) / 2,   x: real, x^: generated, as a constant
/// Source  Lim and Ye, "Geometric GAN" (2017)
template <Backend B>
Tensor<B, 0> hinge_discriminator_loss(const Tensor<B, 2>& real, const Tensor<B, 2>& generated) {
  const Tensor<B, 2> zero(0.0);
  return (mean(maximum(1.0 - real, zero)) + mean(maximum(1.0 + generated, zero))) * 0.5;
}
///     -mean D(x^)
template <Backend B>
Tensor<B, 0> hinge_generator_loss(const Tensor<B, 2>& generated) {
  return -mean(generated);
}

MOTIONLANG_NAMESPACE_END
