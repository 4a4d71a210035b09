// SPDX-License-Identifier: MIT
/// Arithmetic of eigen.hpp, by the kernels: no Eigen here.
#pragma once

#include <motionlang/backend/detail/broadcast.hpp>
#include <motionlang/backend/detail/eigen_class.hpp>
#include <motionlang/backend/detail/kernels.hpp>

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
  const auto apply = kernels<S>().binary;
  for (Index i = 0; i < outer && inner > 0; ++i) {
    apply({.op = op,
           .a = std::as_const(a).data() + (walk_a.outer ? i * (walk_a.inner ? inner : 1) : 0),
           .b = std::as_const(b).data() + (walk_b.outer ? i * (walk_b.inner ? inner : 1) : 0),
           .a_repeated = !walk_a.inner,
           .b_repeated = !walk_b.inner,
           .count = inner,
           .y = out.data() + i * inner});
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
