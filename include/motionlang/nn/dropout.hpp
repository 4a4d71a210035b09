// SPDX-License-Identifier: MIT
/// Dropout that runs only if the call has a generator.
#pragma once

#include <motionlang/core/context.hpp>
#include <motionlang/tensor/fused.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The next mask of a context; its probability is 0 without a generator. Throws config_error 101 unless 0 <= p < 1.
inline Dropout next_dropout(double p, const Context& context) {
  detail::check_dropout({.p = p});
  if (!context.dropout || p == 0) return {};
  const Philox g = context.next_mask();
  return {.p = p, .key = g.stream ^ (g.seed * 0x9E3779B97F4A7C15u)};
}
template <Backend B, int R>
Tensor<B, R> dropout(const Tensor<B, R>& x, double p, const Context& context) {
  return dropout(x, next_dropout(p, context));
}

MOTIONLANG_NAMESPACE_END
