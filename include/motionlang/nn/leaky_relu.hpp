// SPDX-License-Identifier: MIT
/// The nonlinearity of convolutional networks.
#pragma once

#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     x where x > 0, else slope x,   0 < slope < 1
/// Source  Maas, Hannun, Ng, "Rectifier nonlinearities improve neural network acoustic models" (2013), eq. 2; the
///         networks of Guo et al. have slope 0.2
template <Backend B, int R>
Tensor<B, R> leaky_relu(const Tensor<B, R>& x, double slope = 0.2) {
  return maximum(x * slope, x);
}

MOTIONLANG_NAMESPACE_END
