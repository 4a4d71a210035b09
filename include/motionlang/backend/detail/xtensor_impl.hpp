// SPDX-License-Identifier: MIT
/// Bodies of xtensor.hpp. The only header that includes xtensor, whose files moved in version 0.26.
#pragma once

#include <array>   // axes
#include <limits>  // infinity
#include <vector>  // sizes

#if __has_include(<xtensor/containers/xadapt.hpp>)
#include <xtensor/containers/xadapt.hpp>  // views of memory
#include <xtensor/core/xmath.hpp>         // functions, reductions
#include <xtensor/core/xoperation.hpp>    // arithmetic, where
#else
#include <xtensor/xadapt.hpp>
#include <xtensor/xmath.hpp>
#include <xtensor/xoperation.hpp>
#endif

#include <motionlang/backend/xtensor.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

inline std::vector<std::size_t> xtensor_shape(const Shape& s) {
  std::vector<std::size_t> sizes;
  for (int i = 0; i < s.rank(); ++i) sizes.push_back(static_cast<std::size_t>(s[i]));
  return sizes;
}
template <class S>
auto xtensor_view(const Dense<S>& a) {
  return xt::adapt(a.data(), static_cast<std::size_t>(a.count()), xt::no_ownership(), xtensor_shape(a.shape()));
}
/// Evaluates an expression of shape s into new memory.
template <class S, class E>
Dense<S> xtensor_evaluate(const Shape& s, const E& expression) {
  Dense<S> out(s);
  auto view = xt::adapt(out.data(), static_cast<std::size_t>(out.count()), xt::no_ownership(), xtensor_shape(s));
  view = expression;
  return out;
}
template <class S, class F>
Dense<S> xtensor_binary(const Dense<S>& a, const Dense<S>& b, F f) {
  const auto x = xtensor_view(a), y = xtensor_view(b);
  return xtensor_evaluate<S>(broadcast_shapes(a.shape(), b.shape(), "binary operation"), f(x, y));
}
template <class S, class F>
Dense<S> xtensor_unary(const Dense<S>& a, F f) {
  const auto x = xtensor_view(a);
  return xtensor_evaluate<S>(a.shape(), f(x));
}

}  // namespace detail

template <Scalar S>
Dense<S> XtensorBackend<S>::add(const tensor& a, const tensor& b) {
  return detail::xtensor_binary(a, b, [](const auto& x, const auto& y) { return x + y; });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::sub(const tensor& a, const tensor& b) {
  return detail::xtensor_binary(a, b, [](const auto& x, const auto& y) { return x - y; });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::mul(const tensor& a, const tensor& b) {
  return detail::xtensor_binary(a, b, [](const auto& x, const auto& y) { return x * y; });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::div(const tensor& a, const tensor& b) {
  return detail::xtensor_binary(a, b, [](const auto& x, const auto& y) { return x / y; });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::maximum(const tensor& a, const tensor& b) {
  return detail::xtensor_binary(a, b, [](const auto& x, const auto& y) { return xt::maximum(x, y); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::atan2(const tensor& a, const tensor& b) {
  return detail::xtensor_binary(a, b, [](const auto& x, const auto& y) { return xt::atan2(x, y); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::exp(const tensor& a) {
  return detail::xtensor_unary(a, [](const auto& x) { return xt::exp(x); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::log(const tensor& a) {
  return detail::xtensor_unary(a, [](const auto& x) { return xt::log(x); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::sqrt(const tensor& a) {
  return detail::xtensor_unary(a, [](const auto& x) { return xt::sqrt(x); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::tanh(const tensor& a) {
  return detail::xtensor_unary(a, [](const auto& x) { return xt::tanh(x); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::erf(const tensor& a) {
  return detail::xtensor_unary(a, [](const auto& x) { return xt::erf(x); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::sin(const tensor& a) {
  return detail::xtensor_unary(a, [](const auto& x) { return xt::sin(x); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::cos(const tensor& a) {
  return detail::xtensor_unary(a, [](const auto& x) { return xt::cos(x); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y) {
  const Shape s = broadcast_shapes(broadcast_shapes(a.shape(), b.shape(), "where_less"),
                                   broadcast_shapes(x.shape(), y.shape(), "where_less"), "where_less");
  const auto va = detail::xtensor_view(a), vb = detail::xtensor_view(b), vx = detail::xtensor_view(x),
             vy = detail::xtensor_view(y);
  return detail::xtensor_evaluate<S>(s, xt::where(va < vb, vx, vy));
}
template <Scalar S>
Dense<S> XtensorBackend<S>::sum(const tensor& a, int axis) {
  const std::array<std::size_t, 1> axes{static_cast<std::size_t>(axis)};
  const auto view = detail::xtensor_view(a);
  return detail::xtensor_evaluate<S>(a.shape().without(axis), xt::sum(view, axes));
}
template <Scalar S>
Dense<S> XtensorBackend<S>::max(const tensor& a, int axis) {
  if (a.shape()[axis] == 0) return tensor::full(a.shape().without(axis), -std::numeric_limits<S>::infinity());
  const std::array<std::size_t, 1> axes{static_cast<std::size_t>(axis)};
  const auto view = detail::xtensor_view(a);
  return detail::xtensor_evaluate<S>(a.shape().without(axis), xt::amax(view, axes));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
