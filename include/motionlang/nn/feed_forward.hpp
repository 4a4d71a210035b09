// SPDX-License-Identifier: MIT
/// The second half of a transformer layer.
#pragma once

#include <motionlang/nn/dropout.hpp>
#include <motionlang/nn/linear.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// dropout(W2 dropout(act(W1 x))) + residual, row by row: Vaswani et al. (2017), equation 2, with PyTorch's dropout.
template <Backend B>
Tensor<B, 2> feed_forward(const Linear<B>& linear1, const Linear<B>& linear2, Activation activation,
                          const Tensor<B, 2>& x, const Tensor<B, 2>& residual, double dropout_p,
                          const Context& context) {
  const auto inside = linear1(x, activation, nullptr, next_dropout(dropout_p, context));
  return linear2(inside, Activation::none, &residual, next_dropout(dropout_p, context));
}

MOTIONLANG_NAMESPACE_END
