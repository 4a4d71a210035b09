// SPDX-License-Identifier: MIT
/// Backend over xtensor: functions and maxima are xtensor expressions over adapted memory. Arithmetic, sums, products
/// and fused operations are the kernels that the Eigen backend uses, too.
#pragma once

#include <motionlang/backend/dense_ops.hpp>
#include <motionlang/backend/kernel_ops.hpp>

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
#include <motionlang/backend/xtensor.ipp>
#endif

MOTIONLANG_NAMESPACE_BEGIN
static_assert(Backend<XtensorBackend<float>> && Backend<XtensorBackend<double>>);
MOTIONLANG_NAMESPACE_END
