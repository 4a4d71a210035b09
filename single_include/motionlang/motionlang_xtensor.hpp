// SPDX-License-Identifier: MIT
/// motionlang 0.1.0, generated from include/ by tests/tools/amalgamate.cpp. Changes belong there.
#pragma once

#include <motionlang/motionlang.hpp>

#ifndef MOTIONLANG_HAS_BACKEND_XTENSOR_HPP  // <motionlang/backend/xtensor.hpp>
#define MOTIONLANG_HAS_BACKEND_XTENSOR_HPP
/// Backend over xtensor: functions and maxima are xtensor expressions over adapted memory; arithmetic, sums, products
/// and fused operations are the same kernels that the Eigen backend uses.

#ifndef MOTIONLANG_HAS_BACKEND_KERNEL_OPS_HPP  // <motionlang/backend/kernel_ops.hpp>
#define MOTIONLANG_HAS_BACKEND_KERNEL_OPS_HPP
/// Arithmetic and the operations of tensor/fused.hpp as kernels over Dense storage, with their derivatives. Shared by
/// the Eigen and xtensor backends: one layer of kernels serves both.
///
/// Declarations only; the bodies are in detail/kernel_ops_impl.hpp, which a program that links motionlang::instantiated
/// need not read.

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct KernelOps {
  using kernel_tensor = Dense<S>;

  // Operands come by value: memory that nobody else holds is reused for the result.
  static Dense<S> add(Dense<S> a, Dense<S> b);
  static Dense<S> sub(Dense<S> a, Dense<S> b);
  static Dense<S> mul(Dense<S> a, Dense<S> b);
  static Dense<S> div(Dense<S> a, Dense<S> b);
  static Dense<S> maximum(Dense<S> a, Dense<S> b);
  static Dense<S> sum(const Dense<S>& a, int axis);

  /// As many rows of a network's inside as stay in the caches of all threads from one layer to the next.
  static Index rows_in_cache();

  /// Product of the last two axes, batched. b is packed on the fly.
  static Dense<S> matmul(const Dense<S>& a, const Dense<S>& b, bool transpose_a, bool transpose_b);

  /// Packs a weight (out, in) once, or that of a convolution (out, in, taps); `linear` and `conv1d` then use the packed
  /// form. For inference: the weight must not change afterwards. Returns whether all its numbers are finite: they are
  /// read anyway.
  static bool prepare(const Dense<S>& weight);
  static Dense<S> linear(const Dense<S>& x, const Dense<S>& weight, const Dense<S>* bias, Activation act,
                         const Dense<S>* residual, const Dropout& drop = {});

  /// nn/conv1d.hpp, without dilation. The sequences of x lie in it by `before`, those of the result by `after`.
  static Dense<S> conv1d(const Dense<S>& x, const Offsets& before, const Offsets& after, const Dense<S>& weight,
                         const Dense<S>* bias, Index stride, Index padding, Activation act);
  static Dense<S> conv1d_weight_vjp(const Dense<S>& x, const Offsets& before, const Offsets& after, Index taps,
                                    Index stride, Index padding, const Dense<S>& dy);
  static Dense<S> conv1d_input_vjp(const Dense<S>& weight, const Offsets& before, const Offsets& after, Index stride,
                                   Index padding, const Dense<S>& dy);

  static Dense<S> activate(const Dense<S>& x, Activation act, const Dropout& drop = {});
  static Dense<S> activate_vjp(const Dense<S>& x, const Dense<S>& dy, Activation act, const Dropout& drop = {});

  static Dense<S> layer_norm(const Dense<S>& x, const Dense<S>& weight, const Dense<S>& bias, double eps);
  static Dense<S> add_layer_norm(const Dense<S>& x, const Dense<S>& residual, const Dense<S>& weight,
                                 const Dense<S>& bias, double eps);
  /// {dx, dweight, dbias}
  static std::array<Dense<S>, 3> layer_norm_vjp(const Dense<S>& x, const Dense<S>& weight, double eps,
                                                const Dense<S>& dy);

  static Dense<S> softmax(const Dense<S>& x);
  static Dense<S> dropout(const Dense<S>& x, const Dropout& d);

  static Dense<S> attention(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v, const Offsets& q_offsets,
                            const Offsets& k_offsets, const AttentionOptions& options,
                            const Dense<S>* relative_scores = nullptr);
  /// {dq, dk, dv}
  static std::array<Dense<S>, 3> attention_vjp(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v,
                                               const Offsets& q_offsets, const Offsets& k_offsets,
                                               const AttentionOptions& options, const Dense<S>& dy);
  static Dense<S> self_attention(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options);
  static Dense<S> self_attention_vjp(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options,
                                     const Dense<S>& dy);

  /// Updates parameter and moments in place when nobody else holds them, else makes new ones.
  static void adamw(Dense<S>& parameter, Dense<S>& m, Dense<S>& v, const Dense<S>& gradient, const AdamwUpdate& update);
};

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::KernelOps<float>;
extern template struct motionlang::KernelOps<double>;
#else
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct XtensorBackend : DenseOps<S>, KernelOps<S> {
  using tensor = Dense<S>;

  static tensor atan2(const tensor& a, const tensor& b);
  static tensor exp(const tensor& a);
  static tensor log(const tensor& a);
  static tensor sqrt(const tensor& a);
  static tensor tanh(const tensor& a);
  static tensor erf(const tensor& a);
  static tensor sin(const tensor& a);
  static tensor cos(const tensor& a);
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y);
  static tensor max(const tensor& a, int axis);
};

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::XtensorBackend<float>;
extern template struct motionlang::XtensorBackend<double>;
#else

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_XTENSOR_IMPL_HPP  // <motionlang/backend/detail/xtensor_impl.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_XTENSOR_IMPL_HPP
/// Bodies of xtensor.hpp. The only header that includes xtensor, whose files moved in version 0.26.

#if __has_include(<xtensor/containers/xadapt.hpp>)
#include <xtensor/containers/xadapt.hpp>  // views of memory
#include <xtensor/core/xmath.hpp>         // functions, reductions
#include <xtensor/core/xnoalias.hpp>      // results without a temporary
#include <xtensor/core/xoperation.hpp>    // comparison, where
#else
#include <xtensor/xadapt.hpp>
#include <xtensor/xmath.hpp>
#include <xtensor/xnoalias.hpp>
#include <xtensor/xoperation.hpp>
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Views have a static number of axes, so that their shapes need no memory.
template <std::size_t Rank>
using XtensorShape = std::array<std::size_t, Rank>;
/// All axes that a shape may have; missing ones in front are 1.
inline XtensorShape<Shape::max_rank> all_axes(const Shape& s) {
  XtensorShape<Shape::max_rank> sizes;
  sizes.fill(1);
  for (int i = 0; i < s.rank(); ++i)
    sizes[static_cast<std::size_t>(Shape::max_rank - s.rank() + i)] = static_cast<std::size_t>(s[i]);
  return sizes;
}

template <class Values, std::size_t Rank>
auto xtensor_view(Values* values, const XtensorShape<Rank>& sizes) {
  std::size_t count = 1;
  for (std::size_t n : sizes) count *= n;
  return xt::adapt(values, count, xt::no_ownership(), sizes);
}
/// A view with all axes.
template <class S>
auto xtensor_view(const Dense<S>& t) {
  return xtensor_view(t.data(), all_axes(t.shape()));
}
/// Evaluates an expression of shape s into new memory.
template <class S, class E>
Dense<S> xtensor_evaluate(const Shape& s, const E& expression) {
  Dense<S> out(s);
  auto view = xtensor_view(out.data(), all_axes(s));
  xt::noalias(view) = expression;
  return out;
}
template <class S, class F>
Dense<S> xtensor_unary(const Dense<S>& a, F f) {
  Dense<S> out(a.shape());
  parallel_ranges(a.count(), 1, [&](Index first, Index last) {
    const XtensorShape<1> size{static_cast<std::size_t>(last - first)};
    auto view = xtensor_view(out.data() + first, size);
    const auto x = xtensor_view(a.data() + first, size);
    xt::noalias(view) = f(x);
  });
  return out;
}
}  // namespace detail

template <Scalar S>
Dense<S> XtensorBackend<S>::atan2(const tensor& a, const tensor& b) {
  const Shape s = broadcast_shapes(a.shape(), b.shape(), "atan2");
  const auto x = detail::xtensor_view(a), y = detail::xtensor_view(b);
  return detail::xtensor_evaluate<S>(s, xt::atan2(x, y));
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
  const auto va = detail::xtensor_view(a), vb = detail::xtensor_view(b);
  const auto vx = detail::xtensor_view(x), vy = detail::xtensor_view(y);
  return detail::xtensor_evaluate<S>(s, xt::where(va < vb, vx, vy));
}
template <Scalar S>
Dense<S> XtensorBackend<S>::max(const tensor& a, int axis) {
  const Shape& s = a.shape();
  const Index outer = s.count(0, axis), n = s[axis], inner = s.count(axis + 1, s.rank());
  if (n == 0) return tensor::full(s.without(axis), -std::numeric_limits<S>::infinity());
  tensor out(s.without(axis));
  parallel_ranges(outer, n * inner, [&](Index first, Index last) {
    const auto sizes = [](auto... each) {
      return detail::XtensorShape<sizeof...(each)>{static_cast<std::size_t>(each)...};
    };
    auto view = detail::xtensor_view(out.data() + first * inner, sizes(last - first, inner));
    const auto x = detail::xtensor_view(a.data() + first * n * inner, sizes(last - first, n, inner));
    xt::noalias(view) = xt::amax(x, detail::XtensorShape<1>{1});
  });
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN
static_assert(Backend<XtensorBackend<float>> && Backend<XtensorBackend<double>>);
MOTIONLANG_NAMESPACE_END
#endif
