// SPDX-License-Identifier: MIT
/// Linear layer: y = x W^T + b.
#pragma once

#include <motionlang/nn/init.hpp>
#include <motionlang/tensor/fused.hpp>
#include <motionlang/tensor/module.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct Linear {
  Tensor<B, 2> weight;  // (out, in)
  Tensor<B, 1> bias;    // (out)

  static constexpr auto fields() { return motionlang::fields("weight", &Linear::weight, "bias", &Linear::bias); }

  Linear() = default;
  /// PyTorch's initialisation: weight and bias uniform within 1 / sqrt(in).
  Linear(Index in, Index out, Rng auto& rng)
      : weight(uniform_init<B, 2>({out, in}, 1 / std::sqrt(static_cast<double>(in)), rng)),
        bias(uniform_init<B, 1>({out}, 1 / std::sqrt(static_cast<double>(in)), rng)) {}

  Index in() const { return weight.size(1); }
  Index out() const { return weight.size(0); }

  /// x (rows, in) -> dropout(act(x W^T + b)) + residual, (rows, out)
  Tensor<B, 2> operator()(const Tensor<B, 2>& x, Activation act = Activation::none,
                          const Tensor<B, 2>* residual = nullptr, const Dropout& drop = {}) const {
    const ModuleScope scope(*this);
    return linear(x, weight, &bias, act, residual, drop);
  }
  Sequences<B> operator()(const Sequences<B>& x, Activation act = Activation::none) const {
    const ModuleScope scope(*this);
    return x.with((*this)(x.rows, act));
  }
  /// Any leading axes: (..., in) -> (..., out)
  template <int R>
  requires(R == 1 || R > 2) Tensor<B, R>
  operator()(const Tensor<B, R>& x, Activation act = Activation::none) const {
    const ModuleScope scope(*this);
    const Shape s = x.shape();
    Shape to = s;
    to[R - 1] = out();
    const Tensor<B, 2> rows(B::reshape(x.data(), Shape{s.count(0, R - 1), s[R - 1]}));
    return Tensor<B, R>(B::reshape((*this)(rows, act).data(), to));
  }
};

/// Linear layer without bias: y = x W^T.
template <Backend B>
struct LinearMap {
  Tensor<B, 2> weight;  // (out, in)

  static constexpr auto fields() { return motionlang::fields("weight", &LinearMap::weight); }

  LinearMap() = default;
  /// Initialised like the weight of Linear.
  LinearMap(Index in, Index out, Rng auto& rng)
      : weight(uniform_init<B, 2>({out, in}, 1 / std::sqrt(static_cast<double>(in)), rng)) {}

  Tensor<B, 2> operator()(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    return linear<B>(x, weight, nullptr);
  }
};

MOTIONLANG_NAMESPACE_END
