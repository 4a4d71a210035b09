// SPDX-License-Identifier: MIT
/// Arithmetic of eigen.hpp, by the kernels: no Eigen here.
#pragma once

#include <motionlang/backend/detail/broadcast.hpp>
#include <motionlang/backend/detail/eigen_class.hpp>
#include <motionlang/backend/detail/kernels.hpp>
#include <motionlang/core/parallel.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// out = op(a, b) with broadcasting, row by row; the memory of an operand is reused when nobody else holds it.
template <class S>
Dense<S> kernel_binary(BinaryOp op, Dense<S> a, Dense<S> b) {
  const Shape s = a.shape() == b.shape() ? a.shape() : broadcast_shapes(a.shape(), b.shape(), "binary operation");
  const auto pattern = broadcast_pattern(a.shape(), b.shape(), s);
  if (!pattern) return kernel_binary(op, DenseOps<S>::broadcast(a, s), DenseOps<S>::broadcast(b, s));
  const auto& [outer, inner, walk_a, walk_b] = *pattern;
  Dense<S> out = a.unique() && a.shape() == s ? a : b.unique() && b.shape() == s ? b : Dense<S>(s);
  if (inner == 0) return out;
  auto apply = [&, pattern = *pattern](Index i, Index first, Index last) {  // columns first ... last-1 of row i
    auto at = [&](const Dense<S>& x, const BroadcastPattern::Operand& walk) {
      return x.data() + (walk.outer ? i * (walk.inner ? pattern.inner : 1) : 0) + (walk.inner ? first : 0);
    };
    kernels<S>().binary({.op = op,
                         .a = at(a, pattern.a),
                         .b = at(b, pattern.b),
                         .a_repeated = !pattern.a.inner,
                         .b_repeated = !pattern.b.inner,
                         .count = last - first,
                         .y = out.data() + i * pattern.inner + first});
  };
  if (outer == 1) {
    parallel_ranges(inner, 1, [&](Index first, Index last) { apply(0, first, last); });
  } else {
    parallel_ranges(outer, inner, [&, n = inner](Index first, Index last) {
      for (Index i = first; i < last; ++i) apply(i, 0, n);
    });
  }
  return out;
}

}  // namespace detail

template <Scalar S>
Dense<S> EigenBackend<S>::add(tensor a, tensor b) {
  return detail::kernel_binary(detail::BinaryOp::add, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> EigenBackend<S>::sub(tensor a, tensor b) {
  return detail::kernel_binary(detail::BinaryOp::sub, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> EigenBackend<S>::mul(tensor a, tensor b) {
  return detail::kernel_binary(detail::BinaryOp::mul, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> EigenBackend<S>::div(tensor a, tensor b) {
  return detail::kernel_binary(detail::BinaryOp::div, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> EigenBackend<S>::maximum(tensor a, tensor b) {
  return detail::kernel_binary(detail::BinaryOp::maximum, std::move(a), std::move(b));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
