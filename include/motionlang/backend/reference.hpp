// SPDX-License-Identifier: MIT
/// The definition of every primitive, in plain loops. It is slow and readable, and the other backends are tested
/// against it.
///
/// Read this file to know what an operation means; read eigen.hpp or detail/kernels.hpp to see how it is made fast.
#pragma once

#include <cmath>   // exp, log, ...
#include <limits>  // infinity

#include <motionlang/backend/dense_ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct ReferenceBackend : DenseOps<S> {
  using tensor = Dense<S>;

  // Binary operations broadcast: out[i] = f(a[i], b[i]), sizes of 1 are repeated.
  static tensor add(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x + y; });
  }
  static tensor sub(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x - y; });
  }
  static tensor mul(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x * y; });
  }
  static tensor div(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x / y; });
  }
  static tensor maximum(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x < y ? y : x; });
  }
  static tensor atan2(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return std::atan2(x, y); });
  }

  static tensor exp(const tensor& a) {
    return unary(a, [](S x) { return std::exp(x); });
  }
  static tensor log(const tensor& a) {
    return unary(a, [](S x) { return std::log(x); });
  }
  static tensor sqrt(const tensor& a) {
    return unary(a, [](S x) { return std::sqrt(x); });
  }
  static tensor tanh(const tensor& a) {
    return unary(a, [](S x) { return std::tanh(x); });
  }
  static tensor erf(const tensor& a) {
    return unary(a, [](S x) { return std::erf(x); });
  }
  static tensor sin(const tensor& a) {
    return unary(a, [](S x) { return std::sin(x); });
  }
  static tensor cos(const tensor& a) {
    return unary(a, [](S x) { return std::cos(x); });
  }

  // out[i] = a[i] < b[i] ? x[i] : y[i]
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y) {
    Shape s = a.shape();
    for (const tensor* t : {&b, &x, &y}) s = broadcast_shapes(s, t->shape(), "where_less");
    const tensor ba = DenseOps<S>::broadcast(a, s), bb = DenseOps<S>::broadcast(b, s);
    const tensor bx = DenseOps<S>::broadcast(x, s), by = DenseOps<S>::broadcast(y, s);
    tensor out(s);
    S* to = out.data();
    for (Index i = 0; i < s.count(); ++i) to[i] = ba.data()[i] < bb.data()[i] ? bx.data()[i] : by.data()[i];
    return out;
  }

  // a is (outer, n, inner) -> out (outer, inner); summed in order, an empty axis gives 0
  static tensor sum(const tensor& a, int axis) {
    return reduce(a, axis, S(0), [](S total, S x) { return total + x; });
  }
  // the largest along the axis; an empty axis gives -infinity
  static tensor max(const tensor& a, int axis) {
    return reduce(a, axis, -std::numeric_limits<S>::infinity(),
                  [](S largest, S x) { return largest < x ? x : largest; });
  }

  // a is (..., m, k), or (..., k, m) when transpose_a; b is (..., k, n), or (..., n, k) when transpose_b -> (..., m, n)
  static tensor matmul(const tensor& a, const tensor& b, bool transpose_a, bool transpose_b) {
    const int r = a.shape().rank();
    const Index m = a.shape()[r - (transpose_a ? 1 : 2)], k = a.shape()[r - (transpose_a ? 2 : 1)];
    const Index n = b.shape()[r - (transpose_b ? 2 : 1)];
    Shape s = a.shape();
    s[r - 2] = m;
    s[r - 1] = n;
    tensor out(s);
    const S *pa = a.data(), *pb = b.data();
    S* to = out.data();
    for (Index batch = 0; batch < s.count(0, r - 2); ++batch, pa += m * k, pb += k * n, to += m * n) {
      for (Index i = 0; i < m; ++i) {
        for (Index j = 0; j < n; ++j) {
          S total = 0;
          for (Index l = 0; l < k; ++l)
            total += (transpose_a ? pa[l * m + i] : pa[i * k + l]) * (transpose_b ? pb[j * k + l] : pb[l * n + j]);
          to[i * n + j] = total;
        }
      }
    }
    return out;
  }

 private:
  template <class F>
  static tensor unary(const tensor& a, F f) {
    tensor out(a.shape());
    S* to = out.data();
    for (Index i = 0; i < a.count(); ++i) to[i] = f(a.data()[i]);
    return out;
  }
  template <class F>
  static tensor binary(const tensor& a, const tensor& b, F f) {
    const Shape s = broadcast_shapes(a.shape(), b.shape(), "binary operation");
    const tensor left = DenseOps<S>::broadcast(a, s), right = DenseOps<S>::broadcast(b, s);
    tensor out(s);
    S* to = out.data();
    for (Index i = 0; i < s.count(); ++i) to[i] = f(left.data()[i], right.data()[i]);
    return out;
  }
  template <class F>
  static tensor reduce(const tensor& a, int axis, S start, F f) {
    const Index outer = a.shape().count(0, axis), n = a.shape()[axis],
                inner = a.shape().count(axis + 1, a.shape().rank());
    tensor out = tensor::full(a.shape().without(axis), start);
    S* to = out.data();
    for (Index i = 0; i < outer; ++i) {
      for (Index l = 0; l < n; ++l) {
        for (Index j = 0; j < inner; ++j) to[i * inner + j] = f(to[i * inner + j], a.data()[(i * n + l) * inner + j]);
      }
    }
    return out;
  }
};
static_assert(Backend<ReferenceBackend<float>> && Backend<ReferenceBackend<double>>);

MOTIONLANG_NAMESPACE_END
