// SPDX-License-Identifier: MIT
/// Layer normalisation with gain and bias.
#pragma once

#include <motionlang/nn/init.hpp>
#include <motionlang/tensor/fused.hpp>
#include <motionlang/tensor/module.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Ba, Kiros, Hinton (2016). eps = 1e-5, as in all published systems.
template <Backend B>
struct LayerNorm {
  Tensor<B, 1> weight, bias;  // (width)
  double eps = 1e-5;

  static constexpr auto fields() {
    return motionlang::fields("weight", &LayerNorm::weight, "bias", &LayerNorm::bias, "eps", &LayerNorm::eps);
  }
  LayerNorm() = default;
  explicit LayerNorm(Index width) : weight(constant_init<B, 1>({width}, 1)), bias(constant_init<B, 1>({width}, 0)) {}

  Tensor<B, 2> operator()(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    return layer_norm(x, weight, bias, eps);
  }
  /// The norm of x + residual.
  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Tensor<B, 2>& residual) const {
    const ModuleScope scope(*this);
    return add_layer_norm(x, residual, weight, bias, eps);
  }
};

MOTIONLANG_NAMESPACE_END
