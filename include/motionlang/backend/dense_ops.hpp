// SPDX-License-Identifier: MIT
/// What all backends over Dense storage share: making tensors, and moving numbers without calculating.
#pragma once

#include <array>    // strides
#include <cstring>  // memcpy, memset

#include <motionlang/backend/dense.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

template <Scalar S>
struct DenseOps {
  using scalar = S;
  using tensor = Dense<S>;

  static tensor full(const Shape& shape, S value) { return tensor::full(shape, value); }
  static tensor from_span(std::span<const S> values, const Shape& shape) { return tensor::from_span(values, shape); }
  static std::span<const S> to_span(const tensor& a) { return a.span(); }
  static const Shape& shape(const tensor& a) { return a.shape(); }

  static tensor reshape(const tensor& a, const Shape& s) { return a.reshaped(s); }

  // out[i_axes[0], i_axes[1], ...] = a[i_0, i_1, ...]
  static tensor permute(const tensor& a, std::span<const int> axes) {
    Shape s;
    std::array<Index, Shape::max_rank> stride{};
    const auto strides = strides_of(a.shape());
    for (std::size_t i = 0; i < axes.size(); ++i) {
      s.push_back(a.shape()[axes[i]]);
      stride[i] = strides[static_cast<std::size_t>(axes[i])];
    }
    return strided_copy(a, s, stride);
  }
  // sizes of 1 (and missing leading axes) are repeated
  static tensor broadcast(const tensor& a, const Shape& s) {
    return a.shape() == s ? a : strided_copy(a, s, broadcast_strides(a.shape(), s));
  }
  // a[..., first:last, ...]
  static tensor slice(const tensor& a, int axis, Index first, Index last) {
    if (axis == 0) return a.rows(first, last);
    Shape s = a.shape();
    s[axis] = last - first;
    tensor out(s);
    const Index outer = s.count(0, axis), inner = s.count(axis + 1, s.rank()), size = a.shape()[axis];
    for (Index i = 0; i < outer; ++i) {
      copy(a.data() + (i * size + first) * inner, (last - first) * inner, out.data() + i * (last - first) * inner);
    }
    return out;
  }
  static tensor concat(std::span<const tensor> list, int axis) {
    Shape s = list.front().shape();
    s[axis] = 0;
    for (const tensor& t : list) s[axis] += t.shape()[axis];
    tensor out(s);
    const Index outer = s.count(0, axis), inner = s.count(axis + 1, s.rank());
    Index at = 0;
    for (const tensor& t : list) {
      const Index n = t.shape()[axis] * inner;
      for (Index i = 0; i < outer; ++i) copy(t.data() + i * n, n, out.data() + i * s[axis] * inner + at);
      at += n;
    }
    return out;
  }
  // out[i] = a[rows[i]]
  static tensor gather(const tensor& a, std::span<const Index> rows) {
    Shape s = a.shape();
    const Index inner = s.count(1, s.rank());
    s[0] = static_cast<Index>(rows.size());
    tensor out(s);
    for (std::size_t i = 0; i < rows.size(); ++i)
      copy(a.data() + rows[i] * inner, inner, out.data() + static_cast<Index>(i) * inner);
    return out;
  }
  // out[rows[i]] += a[i], starting from n rows of zeros; in the order of i
  static tensor scatter_add(const tensor& a, std::span<const Index> rows, Index n) {
    Shape s = a.shape();
    const Index inner = s.count(1, s.rank());
    s[0] = n;
    tensor out = full(s, S(0));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const S* from = a.data() + static_cast<Index>(i) * inner;
      S* to = out.data() + rows[i] * inner;
      for (Index j = 0; j < inner; ++j) to[j] += from[j];
    }
    return out;
  }

 protected:
  using Strides = std::array<Index, Shape::max_rank>;

  static void copy(const S* from, Index n, S* to) {
    if (n > 0) std::memcpy(to, from, static_cast<std::size_t>(n) * sizeof(S));
  }
  static Strides strides_of(const Shape& s) {
    Strides stride{};
    Index n = 1;
    for (int i = s.rank() - 1; i >= 0; --i) {
      stride[static_cast<std::size_t>(i)] = n;
      n *= s[i];
    }
    return stride;
  }
  /// Strides that read a tensor of shape `from` as if it had shape `to`: 0 along repeated axes.
  static Strides broadcast_strides(const Shape& from, const Shape& to) {
    const Strides own = strides_of(from);
    Strides stride{};
    for (int i = 0; i < to.rank(); ++i) {
      const int j = i - (to.rank() - from.rank());
      if (j >= 0 && from[j] != 1) stride[static_cast<std::size_t>(i)] = own[static_cast<std::size_t>(j)];
    }
    return stride;
  }
  /// Calls f(position in the output, offset in the input) for every element of `s`, the last axis fastest.
  template <class F>
  static void for_each(const Shape& s, const Strides& stride, F f) {
    std::array<Index, Shape::max_rank> at{};
    Index offset = 0;
    for (Index i = 0, n = s.count(); i < n; ++i) {
      f(i, offset);
      for (int axis = s.rank() - 1; axis >= 0; --axis) {
        const auto x = static_cast<std::size_t>(axis);
        offset += stride[x];
        if (++at[x] < s[axis]) break;
        offset -= at[x] * stride[x];
        at[x] = 0;
      }
    }
  }
  static tensor strided_copy(const tensor& a, const Shape& s, const Strides& stride) {
    tensor out(s);
    for_each(s, stride, [&, from = a.data(), to = out.data()](Index i, Index offset) { to[i] = from[offset]; });
    return out;
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
