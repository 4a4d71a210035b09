// SPDX-License-Identifier: MIT
/// Random tensors for tests, and how far two tensors are from each other.
#pragma once

#include <algorithm>  // max, equal
#include <cmath>      // abs
#include <limits>     // infinity, epsilon

#include <motionlang/tensor/gradient.hpp>

namespace tensors {

namespace ml = motionlang;

/// The rounding error that is allowed where nothing is summed up: a trait of the scalar.
template <ml::Scalar S>
inline constexpr double tolerance = 32 * static_cast<double>(std::numeric_limits<S>::epsilon());

/// Standard normal numbers. On a backend with a tape they are a variable.
template <ml::Backend B, int R>
ml::Tensor<B, R> normal(const ml::Shape& shape, std::uint64_t seed) {
  ml::Philox rng{.seed = seed};
  if constexpr (ml::AutodiffBackend<B>)
    return ml::variable<B>(ml::Tensor<typename B::inner, R>::randn(shape, rng));
  else
    return ml::Tensor<B, R>::randn(shape, rng);
}

/// Largest |a - b| / (1 + |b|); infinity if the shapes differ or a number is NaN.
template <ml::Backend A, ml::Backend B, int R>
double distance(const ml::Tensor<A, R>& a, const ml::Tensor<B, R>& b) {
  if (a.shape() != b.shape()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t i = 0; i < a.span().size(); ++i) {
    const auto x = static_cast<double>(a.span()[i]), y = static_cast<double>(b.span()[i]);
    const double d = std::abs(x - y) / (1 + std::abs(y));
    worst = std::isnan(d) ? std::numeric_limits<double>::infinity() : std::max(worst, d);
  }
  return worst;
}

template <ml::Backend A, ml::Backend B, int R>
bool same_bits(const ml::Tensor<A, R>& a, const ml::Tensor<B, R>& b) {
  return a.shape() == b.shape() && std::equal(a.span().begin(), a.span().end(), b.span().begin());
}

}  // namespace tensors
