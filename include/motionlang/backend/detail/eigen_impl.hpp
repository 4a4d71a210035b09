// SPDX-License-Identifier: MIT
/// Functions and reductions of eigen.hpp. The only header that includes Eigen.
#pragma once

#include <Eigen/Core>  // arrays
#include <limits>      // infinity

#include <motionlang/backend/detail/eigen_class.hpp>
#include <motionlang/backend/detail/kernels.hpp>
#include <motionlang/core/parallel.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

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

/// a is (outer, n, inner) -> (outer, inner). `whole` reduces an array to a number, `fold` takes one array into another.
template <class S, class Whole, class Fold>
Dense<S> eigen_reduce(const Dense<S>& a, int axis, S start, Whole whole, Fold fold) {
  const Index outer = a.shape().count(0, axis), n = a.shape()[axis],
              inner = a.shape().count(axis + 1, a.shape().rank());
  Dense<S> out = Dense<S>::full(a.shape().without(axis), start);
  if (n == 0) return out;
  const auto fold_columns = [&](Index i, Index first, Index last) {
    auto row = eigen_map(out.data() + i * inner + first, last - first);
    for (Index l = 0; l < n; ++l) fold(row, eigen_map(a.data() + (i * n + l) * inner + first, last - first));
  };
  if (outer == 1) {
    parallel_columns(n, inner, [&](Index first, Index last) {
      if (inner != 1)
        fold_columns(0, first, last);
      else
        out.data()[0] = whole(eigen_map(a.data(), n));
    });
  } else {
    parallel_ranges(outer, n * inner, [&](Index first, Index last) {
      for (Index i = first; i < last; ++i) {
        if (inner != 1)
          fold_columns(i, 0, inner);
        else
          out.data()[i] = whole(eigen_map(a.data() + i * n, n));
      }
    });
  }
  return out;
}

}  // namespace detail

template <Scalar S>
Dense<S> EigenBackend<S>::atan2(tensor a, tensor b) {
  const Shape s = broadcast_shapes(a.shape(), b.shape(), "atan2");
  a = DenseOps<S>::broadcast(a, s), b = DenseOps<S>::broadcast(b, s);
  tensor out(s);
  for (Index i = 0, n = s.count(); i < n; ++i)
    out.data()[i] = std::atan2(std::as_const(a).data()[i], std::as_const(b).data()[i]);
  return out;
}
template <Scalar S>
Dense<S> EigenBackend<S>::exp(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.exp(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::log(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.log(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::sqrt(tensor a) {
  // Eigen's own root of a packet is rounded otherwise than its root of a single number
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.unaryExpr([](S v) { return std::sqrt(v); }); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::tanh(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.tanh(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::erf(tensor a) {  // Eigen's is in an unsupported module
  tensor out(a.shape());
  detail::kernels<S>().error_function(std::as_const(a).data(), a.count(), out.data());
  return out;
}
template <Scalar S>
Dense<S> EigenBackend<S>::sin(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.sin(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::cos(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.cos(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y) {
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
Dense<S> EigenBackend<S>::max(const tensor& a, int axis) {
  return detail::eigen_reduce(
      a, axis, -std::numeric_limits<S>::infinity(), [](const auto& x) { return x.maxCoeff(); },
      [](auto& largest, const auto& x) { largest = largest.max(x); });
}

}  // namespace motionlang::inline MOTIONLANG_ABI
