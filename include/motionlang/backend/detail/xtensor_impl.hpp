// SPDX-License-Identifier: MIT
/// Bodies of xtensor.hpp. The only header that includes xtensor, whose files moved in version 0.26.
#pragma once

#include <array>   // sizes
#include <limits>  // infinity

#if __has_include(<xtensor/containers/xadapt.hpp>)
#include <xtensor/containers/xadapt.hpp>  // views of memory
#include <xtensor/core/xmath.hpp>         // functions, reductions
#include <xtensor/core/xnoalias.hpp>      // results without a temporary
#include <xtensor/core/xoperation.hpp>    // arithmetic, where
#else
#include <xtensor/xadapt.hpp>
#include <xtensor/xmath.hpp>
#include <xtensor/xnoalias.hpp>
#include <xtensor/xoperation.hpp>
#endif

#include <motionlang/backend/xtensor.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// Views have a static number of axes, so that their shapes need no memory: all that a shape may have (missing ones in
/// front are 1), or one where every element is treated alike.
template <std::size_t Rank>
using XtensorShape = std::array<std::size_t, Rank>;
inline XtensorShape<Shape::max_rank> all_axes(const Shape& s) {
  XtensorShape<Shape::max_rank> sizes;
  sizes.fill(1);
  for (int i = 0; i < s.rank(); ++i)
    sizes[static_cast<std::size_t>(Shape::max_rank - s.rank() + i)] = static_cast<std::size_t>(s[i]);
  return sizes;
}
inline XtensorShape<1> one_axis(const Shape& s) { return {static_cast<std::size_t>(s.count())}; }

template <class Values, std::size_t Rank>
auto xtensor_view(Values* values, const XtensorShape<Rank>& sizes) {
  std::size_t count = 1;
  for (std::size_t n : sizes) count *= n;
  return xt::adapt(values, count, xt::no_ownership(), sizes);
}
/// Evaluates an expression of shape s, seen as `sizes`, into new memory.
template <class S, std::size_t Rank, class E>
Dense<S> xtensor_evaluate(const Shape& s, const XtensorShape<Rank>& sizes, const E& expression) {
  Dense<S> out(s);
  auto view = xtensor_view(out.data(), sizes);
  xt::noalias(view) = expression;
  return out;
}
template <class S, class F>
Dense<S> xtensor_binary(const Dense<S>& a, const Dense<S>& b, F f) {
  auto evaluate = [&](const Shape& s, auto axes) {
    const auto x = xtensor_view(a.data(), axes(a.shape())), y = xtensor_view(b.data(), axes(b.shape()));
    return xtensor_evaluate<S>(s, axes(s), f(x, y));
  };
  if (a.shape() == b.shape()) return evaluate(a.shape(), one_axis);
  return evaluate(broadcast_shapes(a.shape(), b.shape(), "binary operation"), all_axes);
}
template <class S, class F>
Dense<S> xtensor_unary(const Dense<S>& a, F f) {
  const auto x = xtensor_view(a.data(), one_axis(a.shape()));
  return xtensor_evaluate<S>(a.shape(), one_axis(a.shape()), f(x));
}
/// f reduces axis 1 of (outer, n, inner).
template <class S, class F>
Dense<S> xtensor_reduce(const Dense<S>& a, int axis, F f) {
  const Shape& s = a.shape();
  const auto outer = static_cast<std::size_t>(s.count(0, axis)), n = static_cast<std::size_t>(s[axis]),
             inner = static_cast<std::size_t>(s.count(axis + 1, s.rank()));
  const auto x = xtensor_view(a.data(), XtensorShape<3>{outer, n, inner});
  return xtensor_evaluate<S>(s.without(axis), XtensorShape<2>{outer, inner}, f(x, XtensorShape<1>{1}));
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
  const auto view = [](const tensor& t) { return detail::xtensor_view(t.data(), detail::all_axes(t.shape())); };
  const auto va = view(a), vb = view(b), vx = view(x), vy = view(y);
  return detail::xtensor_evaluate<S>(s, detail::all_axes(s), xt::where(va < vb, vx, vy));
}
template <Scalar S>
Dense<S> XtensorBackend<S>::sum(const tensor& a, int axis) {
  return detail::xtensor_reduce(a, axis, [](const auto& x, const auto& axes) { return xt::sum(x, axes); });
}
template <Scalar S>
Dense<S> XtensorBackend<S>::max(const tensor& a, int axis) {
  if (a.shape()[axis] == 0) return tensor::full(a.shape().without(axis), -std::numeric_limits<S>::infinity());
  return detail::xtensor_reduce(a, axis, [](const auto& x, const auto& axes) { return xt::amax(x, axes); });
}

}  // namespace motionlang::inline MOTIONLANG_ABI
