// SPDX-License-Identifier: MIT
/// motionlang 0.2.0, generated from include/ by tests/tools/amalgamate.cpp. Changes belong there.
#pragma once

#include <motionlang/motionlang.hpp>

#ifndef MOTIONLANG_HAS_BACKEND_EIGEN_HPP  // <motionlang/backend/eigen.hpp>
#define MOTIONLANG_HAS_BACKEND_EIGEN_HPP
/// Backend over Eigen: functions and maxima are Eigen expressions over mapped memory. Arithmetic, sums, products and
/// fused operations are the kernels of kernel_ops.hpp. These use the instruction set of the machine, whatever the
/// program was built for. Eigen's own product reaches 20 to 50 % of the processor's peak at these shapes, and its
/// broadcasting expressions would compile half a second longer.

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_EIGEN_CLASS_HPP  // <motionlang/backend/detail/eigen_class.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_EIGEN_CLASS_HPP
/// The part of the Eigen backend that a model needs: its operations, and the bodies of kernels such as arithmetic. The
/// bodies that include Eigen (functions and maxima) come with <motionlang/backend/eigen.hpp>.

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

}  // namespace detail

template <Scalar S>
struct EigenBackend : DenseOps<S>, KernelOps<S>, detail::CheckedEigenFunctions<S> {
  using tensor = Dense<S>;
};

MOTIONLANG_NAMESPACE_END

MOTIONLANG_NAMESPACE_BEGIN
static_assert(Backend<EigenBackend<float>> && Backend<EigenBackend<double>>);
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_BACKEND_EIGEN_IPP  // <motionlang/backend/eigen.ipp>
#define MOTIONLANG_HAS_BACKEND_EIGEN_IPP
/// Functions and maxima of eigen.hpp. The only header that includes Eigen.

#include <Eigen/Core>  // arrays

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <class S>
using EigenArray = Eigen::Array<S, Eigen::Dynamic, 1>;

template <class S>
auto eigen_map(const S* data, Index n) {
  return Eigen::Map<const EigenArray<S>>(data, n);
}
template <class S>
auto eigen_map(S* data, Index n) {
  return Eigen::Map<EigenArray<S>>(data, n);
}

/// out = f(a) as arrays; a's memory is reused when nobody else holds it.
template <class S, class F>
Dense<S> eigen_unary(Dense<S> a, F f) {
  Dense<S> out = a.unique() ? a : Dense<S>(a.shape());
  parallel_ranges(a.count(), 1, [&](Index first, Index last) {
    eigen_map(out.data() + first, last - first) = f(eigen_map(std::as_const(a).data() + first, last - first));
  });
  return out;
}

template <Scalar S>
struct EigenBodies {};

}  // namespace detail

template <Scalar S>
Dense<S> detail::EigenFunctions<S>::atan2(tensor a, tensor b) {
  const Shape s = broadcast_shapes(a.shape(), b.shape(), "atan2");
  a = DenseOps<S>::broadcast(a, s), b = DenseOps<S>::broadcast(b, s);
  tensor out(s);
  for (Index i = 0, n = s.count(); i < n; ++i)
    out.data()[i] = std::atan2(std::as_const(a).data()[i], std::as_const(b).data()[i]);
  return out;
}
template <Scalar S>
Dense<S> detail::EigenFunctions<S>::exp(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.exp(); });
}
template <Scalar S>
Dense<S> detail::EigenFunctions<S>::log(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.log(); });
}
template <Scalar S>
Dense<S> detail::EigenFunctions<S>::sqrt(tensor a) {
  // Eigen rounds the root of a packet differently from the root of a single value.
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.unaryExpr([](S v) { return std::sqrt(v); }); });
}
template <Scalar S>
Dense<S> detail::EigenFunctions<S>::tanh(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.tanh(); });
}
template <Scalar S>
Dense<S> detail::EigenFunctions<S>::erf(tensor a) {  // Eigen's is in an unsupported module
  tensor out(a.shape());
  detail::kernels<S>().error_function(std::as_const(a).data(), a.count(), out.data());
  return out;
}
template <Scalar S>
Dense<S> detail::EigenFunctions<S>::sin(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.sin(); });
}
template <Scalar S>
Dense<S> detail::EigenFunctions<S>::cos(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.cos(); });
}
template <Scalar S>
Dense<S> detail::EigenFunctions<S>::where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y) {
  const Shape s = broadcast_shapes(broadcast_shapes(a.shape(), b.shape(), "where_less"),
                                   broadcast_shapes(x.shape(), y.shape(), "where_less"), "where_less");
  const Index n = s.count();
  const tensor la = DenseOps<S>::broadcast(a, s), lb = DenseOps<S>::broadcast(b, s);
  const tensor lx = DenseOps<S>::broadcast(x, s), ly = DenseOps<S>::broadcast(y, s);
  tensor out(s);
  parallel_ranges(n, 1, [&](Index first, Index last) {
    auto piece = [&](const tensor& t) { return detail::eigen_map(t.data() + first, last - first); };
    detail::eigen_map(out.data() + first, last - first) = (piece(la) < piece(lb)).select(piece(lx), piece(ly));
  });
  return out;
}
template <Scalar S>
Dense<S> detail::EigenFunctions<S>::max(const tensor& a, int axis) {
  const Shape& s = a.shape();
  const Index n = s[axis], inner = s.count(axis + 1, s.rank());
  tensor out = tensor::full(s.without(axis), -std::numeric_limits<S>::infinity());
  if (n == 0) return out;
  const auto rows = [&](Index first, Index last) {
    for (Index i = first; i < last; ++i) out.data()[i] = detail::eigen_map(a.data() + i * n, n).maxCoeff();
  };
  const auto columns = [&](Index i, Index first, Index last) {
    auto largest = detail::eigen_map(out.data() + i * inner + first, last - first);
    for (Index l = 0; l < n; ++l)
      largest = largest.max(detail::eigen_map(a.data() + (i * n + l) * inner + first, last - first));
  };
  detail::for_reduction(s, axis, rows, columns);
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif
