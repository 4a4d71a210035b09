// SPDX-License-Identifier: MIT
/// A learned row for every symbol.
#pragma once

#include <motionlang/nn/init.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/module.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

template <Backend B>
struct Embedding {
  Tensor<B, 2> weight;  // (symbols, width)

  static constexpr auto fields() { return motionlang::fields("weight", &Embedding::weight); }

  Embedding() = default;
  Embedding(Index symbols, Index width, Rng auto& rng, double std = 1)
      : weight(normal_init<B, 2>({symbols, width}, std, rng)) {}

  /// ids -> (ids, width). Throws shape_error 203 for an unknown symbol.
  Tensor<B, 2> operator()(std::span<const Index> ids) const { return gather(weight, ids); }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
