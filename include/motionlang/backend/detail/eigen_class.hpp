// SPDX-License-Identifier: MIT
/// The part of the Eigen backend that a model needs: its operations, and the bodies of kernels such as arithmetic. The
/// bodies that include Eigen (functions and maxima) come with <motionlang/backend/eigen.hpp>.
#pragma once

#include <motionlang/backend/dense_ops.hpp>
#include <motionlang/backend/kernel_ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Functions and maxima of the Eigen backend.
template <Scalar S>
struct EigenFunctions {
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

#ifndef MOTIONLANG_INSTANTIATED
/// This type is complete where the bodies of these functions are.
template <Scalar S>
struct EigenBodies;

/// The functions for units that may lack their bodies. The compiler then reports it, not the linker.
template <Scalar S>
struct CheckedEigenFunctions {
  using tensor = Dense<S>;

  static tensor atan2(tensor a, tensor b) { return checked().atan2(std::move(a), std::move(b)); }
  static tensor exp(tensor a) { return checked().exp(std::move(a)); }
  static tensor log(tensor a) { return checked().log(std::move(a)); }
  static tensor sqrt(tensor a) { return checked().sqrt(std::move(a)); }
  static tensor tanh(tensor a) { return checked().tanh(std::move(a)); }
  static tensor erf(tensor a) { return checked().erf(std::move(a)); }
  static tensor sin(tensor a) { return checked().sin(std::move(a)); }
  static tensor cos(tensor a) { return checked().cos(std::move(a)); }
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y) {
    return checked().where_less(a, b, x, y);
  }
  static tensor max(const tensor& a, int axis) { return checked().max(a, axis); }

 private:
  template <class T = S>
  static EigenFunctions<T> checked() {
    static_assert(
        requires { sizeof(EigenBodies<T>); },
        "motionlang: this calculates with tensors of EigenBackend, so include <motionlang/backend/eigen.hpp>");
    return {};
  }
};
#endif

}  // namespace detail

#ifdef MOTIONLANG_INSTANTIATED
template <Scalar S>
struct EigenBackend : DenseOps<S>, KernelOps<S>, detail::EigenFunctions<S> {
  using tensor = Dense<S>;
};
#else
template <Scalar S>
struct EigenBackend : DenseOps<S>, KernelOps<S>, detail::CheckedEigenFunctions<S> {
  using tensor = Dense<S>;
};
#endif

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::detail::EigenFunctions<float>;
extern template struct motionlang::detail::EigenFunctions<double>;
#endif

MOTIONLANG_NAMESPACE_BEGIN
static_assert(Backend<EigenBackend<float>> && Backend<EigenBackend<double>>);
MOTIONLANG_NAMESPACE_END
