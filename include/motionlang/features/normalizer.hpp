// SPDX-License-Identifier: MIT
/// Converts features to zero mean and unit deviation, and back.
#pragma once

#include <motionlang/tensor/module.hpp>
#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     x' = (x - mean) / (std + eps),   x = x' (std + eps) + mean
/// Statistics are saved with a model but not trained. eps matters only if std is 0.
template <Backend B>
struct Normalizer {
  static constexpr bool trainable = false;
  Tensor<B, 1> mean, std;  // (features)
  double eps = 1e-12;

  static constexpr auto fields() {
    return motionlang::fields("mean", &Normalizer::mean, "std", &Normalizer::std, "eps", &Normalizer::eps);
  }
  /// Statistics that change nothing.
  static Normalizer identity(Index features) {
    return {Tensor<B, 1>::zeros({features}), Tensor<B, 1>::full({features}, 1)};
  }

  template <int R>
  Tensor<B, R> normalize(const Tensor<B, R>& x) const {
    return (x - mean) / (std + eps);
  }
  template <int R>
  Tensor<B, R> denormalize(const Tensor<B, R>& x) const {
    return x * (std + eps) + mean;
  }
};

MOTIONLANG_NAMESPACE_END
