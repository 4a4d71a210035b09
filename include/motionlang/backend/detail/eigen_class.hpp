// SPDX-License-Identifier: MIT
/// What a model needs of the Eigen backend: its operations, and of the bodies those of the kernels, arithmetic among
/// them. Those that include Eigen, functions and maxima, come with <motionlang/backend/eigen.hpp>.
#pragma once

#include <motionlang/backend/dense_ops.hpp>
#include <motionlang/backend/kernel_ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct EigenBackend : DenseOps<S>, KernelOps<S> {
  using tensor = Dense<S>;

  static tensor atan2(tensor a, tensor b);
  static tensor exp(tensor a);
  static tensor log(tensor a);
  static tensor sqrt(tensor a);
  static tensor tanh(tensor a);
  static tensor erf(tensor a);
  static tensor sin(tensor a);
  static tensor cos(tensor a);
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y);
  static tensor max(const tensor& a, int axis);
};

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::EigenBackend<float>;
extern template struct motionlang::EigenBackend<double>;
#endif

MOTIONLANG_NAMESPACE_BEGIN
static_assert(Backend<EigenBackend<float>> && Backend<EigenBackend<double>>);
MOTIONLANG_NAMESPACE_END
