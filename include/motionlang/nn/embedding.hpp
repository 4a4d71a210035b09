// SPDX-License-Identifier: MIT
/// A learned row for every symbol.
#pragma once

#include <motionlang/nn/init.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/module.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct Embedding {
  Tensor<B, 2> weight;  // (symbols, width)

  static constexpr auto fields() { return motionlang::fields("weight", &Embedding::weight); }

  Embedding() = default;
  Embedding(Index symbols, Index width, Rng auto& rng, double std = 1)
      : weight(normal_init<B, 2>({symbols, width}, std, rng)) {}

  /// ids -> (ids, width). Throws shape_error 203 for an unknown symbol.
  Tensor<B, 2> operator()(std::span<const Index> ids) const {
    const ModuleScope scope(*this);
    return gather(weight, ids);
  }
};

/// A row for each label with 1 in its column, (labels, classes).
/// Throws shape_error 203 for a label that is not a class.
template <Backend B>
Tensor<B, 2> one_hot(std::span<const Index> labels, Index classes) {
  std::vector<typename B::scalar> rows(labels.size() * static_cast<std::size_t>(classes));
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] < 0 || labels[i] >= classes)
      raise<shape_error>(203, "one_hot: label ", labels[i], " of ", classes, " classes");
    rows[i * static_cast<std::size_t>(classes) + static_cast<std::size_t>(labels[i])] = 1;
  }
  return Tensor<B, 2>::from(rows, {std::ssize(labels), classes});
}

MOTIONLANG_NAMESPACE_END
