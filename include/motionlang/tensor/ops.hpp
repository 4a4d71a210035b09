// SPDX-License-Identifier: MIT
/// Arithmetic, functions, reductions and products of tensors. Every function checks shapes once and calls the backend.
///
/// Binary operations broadcast like NumPy; the result has the larger rank. Temporaries are passed on, so that a backend
/// may compute in place.
#pragma once

#include <motionlang/tensor/tensor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr int larger(int a, int b) { return a > b ? a : b; }

template <class B, int P, int Q, class F>
auto binary(const char* name, Tensor<B, P>&& a, Tensor<B, Q>&& b, F f) {
  if (a.shape() != b.shape()) broadcast_shapes(a.shape(), b.shape(), name);
  require_tensor(name, a);
  require_tensor(name, b);
  return Tensor<B, larger(P, Q)>(f(std::move(a).data(), std::move(b).data()));
}

}  // namespace detail

template <Backend B, int P, int Q>
auto operator+(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator+", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::add(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto operator-(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator-", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::sub(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto operator*(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator*", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::mul(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto operator/(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator/", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::div(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto maximum(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("maximum", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::maximum(std::move(x), std::move(y)); });
}
template <Backend B, int R>
Tensor<B, R> atan2(Tensor<B, R> y, Tensor<B, R> x) {
  return detail::binary("atan2", std::move(y), std::move(x),
                        [](auto&& p, auto&& q) { return B::atan2(std::move(p), std::move(q)); });
}

template <Backend B, int R>
Tensor<B, R> operator+(Tensor<B, R> a, double b) {
  return std::move(a) + Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator+(double a, Tensor<B, R> b) {
  return std::move(b) + Tensor<B, R>(a);
}
template <Backend B, int R>
Tensor<B, R> operator-(Tensor<B, R> a, double b) {
  return std::move(a) - Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator-(double a, Tensor<B, R> b) {
  return Tensor<B, R>(a) - std::move(b);
}
template <Backend B, int R>
Tensor<B, R> operator*(Tensor<B, R> a, double b) {
  return std::move(a) * Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator*(double a, Tensor<B, R> b) {
  return std::move(b) * Tensor<B, R>(a);
}
template <Backend B, int R>
Tensor<B, R> operator/(Tensor<B, R> a, double b) {
  return std::move(a) / Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator/(double a, Tensor<B, R> b) {
  return Tensor<B, R>(a) / std::move(b);
}
template <Backend B, int R>
Tensor<B, R> operator-(Tensor<B, R> a) {
  return std::move(a) * Tensor<B, R>(-1.0);
}

template <Backend B, int R>
Tensor<B, R> exp(Tensor<B, R> a) {
  detail::require_tensor("exp", a);
  return Tensor<B, R>(B::exp(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> log(Tensor<B, R> a) {
  detail::require_tensor("log", a);
  return Tensor<B, R>(B::log(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> sqrt(Tensor<B, R> a) {
  detail::require_tensor("sqrt", a);
  return Tensor<B, R>(B::sqrt(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> tanh(Tensor<B, R> a) {
  detail::require_tensor("tanh", a);
  return Tensor<B, R>(B::tanh(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> erf(Tensor<B, R> a) {
  detail::require_tensor("erf", a);
  return Tensor<B, R>(B::erf(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> sin(Tensor<B, R> a) {
  detail::require_tensor("sin", a);
  return Tensor<B, R>(B::sin(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> cos(Tensor<B, R> a) {
  detail::require_tensor("cos", a);
  return Tensor<B, R>(B::cos(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> square(const Tensor<B, R>& a) {
  return a * a;
}
/// Its slope at 0 is 0.
template <Backend B, int R>
Tensor<B, R> abs(const Tensor<B, R>& a) {
  const Tensor<B, R> zero(0.0);
  return maximum(a, zero) + maximum(-a, zero);
}

/// Element by element: a < b ? x : y.
template <Backend B, int R>
Tensor<B, R> where_less(const Tensor<B, R>& a, const Tensor<B, R>& b, const Tensor<B, R>& x, const Tensor<B, R>& y) {
  broadcast_shapes(broadcast_shapes(a.shape(), b.shape(), "where_less"),
                   broadcast_shapes(x.shape(), y.shape(), "where_less"), "where_less");
  for (const auto* t : {&a, &b, &x, &y}) detail::require_tensor("where_less", *t);
  return Tensor<B, R>(B::where_less(a.data(), b.data(), x.data(), y.data()));
}

/// Sum along one axis, which disappears. Negative axes count from the end.
template <Backend B, int R>
requires(R > 0) Tensor<B, R - 1> sum(const Tensor<B, R>& a, int axis) {
  detail::require_tensor("sum", a);
  return Tensor<B, R - 1>(B::sum(a.data(), normalize_axis(axis, R, "sum")));
}
template <Backend B, int R>
requires(R > 0) Tensor<B, R - 1> max(const Tensor<B, R>& a, int axis) {
  detail::require_tensor("max", a);
  return Tensor<B, R - 1>(B::max(a.data(), normalize_axis(axis, R, "max")));
}
template <Backend B, int R>
requires(R > 0) Tensor<B, R - 1> mean(const Tensor<B, R>& a, int axis) {
  return sum(a, axis) / static_cast<double>(a.size(axis));
}
/// Sum and mean of all elements.
template <Backend B, int R>
Tensor<B, 0> sum(const Tensor<B, R>& a) {
  detail::require_tensor("sum", a);
  return Tensor<B, 0>(B::sum(B::reshape(a.data(), Shape{a.count()}), 0));
}
template <Backend B, int R>
Tensor<B, 0> mean(const Tensor<B, R>& a) {
  return sum(a) / static_cast<double>(a.count());
}

struct MatmulOptions {
  bool transpose_a = false, transpose_b = false;
};
/// Product of the last two axes; leading axes are equal. Throws shape_error 201 or 204.
template <Backend B, int R>
requires(R >= 2) Tensor<B, R> matmul(const Tensor<B, R>& a, const Tensor<B, R>& b, MatmulOptions options = {}) {
  detail::require_tensor("matmul", a);
  detail::require_tensor("matmul", b);
  const Shape sa = a.shape(), sb = b.shape();
  for (int i = 0; i < R - 2; ++i) {
    if (sa[i] != sb[i]) raise<shape_error>(204, "matmul: leading sizes differ: lhs ", sa, ", rhs ", sb);
  }
  if (sa[options.transpose_a ? R - 2 : R - 1] != sb[options.transpose_b ? R - 1 : R - 2]) {
    raise<shape_error>(201, "matmul: inner sizes differ: lhs ", sa, options.transpose_a ? " transposed" : "", ", rhs ",
                       sb, options.transpose_b ? " transposed" : "");
  }
  return Tensor<B, R>(B::matmul(a.data(), b.data(), options.transpose_a, options.transpose_b));
}

MOTIONLANG_NAMESPACE_END
