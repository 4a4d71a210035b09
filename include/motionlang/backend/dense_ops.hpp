// SPDX-License-Identifier: MIT
/// Operations that all backends over Dense storage share: making tensors, moving values, and sharing a reduction among
/// threads.
#pragma once

#include <algorithm>  // fill, min
#include <array>      // strides
#include <cstring>    // memcpy

#include <motionlang/backend/dense.hpp>
#include <motionlang/core/parallel.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
/// A reduction along an axis of (outer, axis, inner), on all threads. Along the last axis it calls rows(first, last)
/// for rows of the memory. Along another axis it calls columns(i, first, last) for columns of matrix i of `outer`.
template <class Rows, class Columns>
void for_reduction(const Shape& s, int axis, const Rows& rows, const Columns& columns) {
  const Index outer = s.count(0, axis), n = s[axis], inner = s.count(axis + 1, s.rank());
  if (inner == 1) return parallel_ranges(outer, n, rows);
  if (outer == 1) return parallel_columns(n, inner, [&](Index first, Index last) { columns(0, first, last); });
  parallel_ranges(outer, n * inner, [&](Index first, Index last) {
    for (Index i = first; i < last; ++i) columns(i, 0, inner);
  });
}
}  // namespace detail

template <Scalar S>
struct DenseOps {
  using scalar = S;
  using tensor = Dense<S>;

  static tensor full(const Shape& shape, S value) { return tensor::full(shape, value); }
  static tensor from_span(std::span<const S> values, const Shape& shape) { return tensor::from_span(values, shape); }
  static std::span<const S> to_span(const tensor& a MOTIONLANG_LIFETIMEBOUND) { return a.span(); }
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
    copy_pieces(
        outer, (last - first) * inner, [&](Index i) { return a.data() + (i * size + first) * inner; },
        [&](Index i) { return out.data() + i * (last - first) * inner; });
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
      copy_pieces(
          outer, n, [&](Index i) { return t.data() + i * n; },
          [&](Index i) { return out.data() + i * s[axis] * inner + at; });
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
    copy_pieces(
        s[0], inner, [&](Index i) { return a.data() + rows[static_cast<std::size_t>(i)] * inner; },
        [&](Index i) { return out.data() + i * inner; });
    return out;
  }
  // out[rows[i]] += a[i], starting from n rows of zeros; in the order of i
  static tensor scatter_add(const tensor& a, std::span<const Index> rows, Index n) {
    Shape s = a.shape();
    const Index inner = s.count(1, s.rank());
    s[0] = n;
    tensor out = full(s, S(0));
    parallel_columns(static_cast<Index>(rows.size()), inner, [&](Index first, Index last) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const S* from = a.data() + static_cast<Index>(i) * inner;
        S* to = out.data() + rows[i] * inner;
        for (Index j = first; j < last; ++j) to[j] += from[j];
      }
    });
    return out;
  }

 protected:
  using Strides = std::array<Index, Shape::max_rank>;

  /// For i = 0 ... count-1: copies n values from from(i) to to(i).
  template <class From, class To>
  static void copy_pieces(Index count, Index n, const From& from, const To& to) {
    if (n == 0) return;
    const auto bytes = static_cast<std::size_t>(n) * sizeof(S);
    parallel_ranges(count, n, [&](Index first, Index last) {
      for (Index i = first; i < last; ++i) std::memcpy(to(i), from(i), bytes);
    });
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
  /// An axis of a copy: its size, and how far one step along it goes in the input and in the output.
  struct Axis {
    Index size = 1, in = 1, out = 1;
  };
  /// out[i_0, i_1, ...] = a's memory at sum i_k stride_k, line by line along the last axis. If these lines jump through
  /// the memory of a, and lines along another axis do not, several lines are made together. They then share the cache
  /// lines that they read.
  static tensor strided_copy(const tensor& a, const Shape& s, const Strides& stride) {
    tensor out(s);
    if (s.count() == 0) return out;
    std::array<Axis, Shape::max_rank> axes;  // from the last to the first; axes that are one in memory are joined
    int count = 0;
    const auto own = strides_of(s);
    for (int i = s.rank() - 1; i >= 0; --i) {
      const auto x = static_cast<std::size_t>(i);
      if (s[i] == 1) continue;
      Axis* const before = count == 0 ? nullptr : &axes[static_cast<std::size_t>(count - 1)];
      if (before != nullptr && stride[x] == before->in * before->size)
        before->size *= s[i];
      else
        axes[static_cast<std::size_t>(count++)] = {s[i], stride[x], own[x]};
    }
    const Axis line = axes[0];
    std::size_t beside = 0;
    for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) {
      if (line.in > 1 && axes[i].in == 1) beside = i;
    }
    constexpr Index at_once = 8;
    const Index group = beside == 0 ? 1 : at_once;
    const auto groups = [&](std::size_t i) { return i == beside ? (axes[i].size + group - 1) / group : axes[i].size; };
    Index total = 1;
    for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) total *= groups(i);

    parallel_ranges(total, group * line.size, [&](Index first, Index last) {
      std::array<Index, Shape::max_rank> at{};
      Index rest = first;
      for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) at[i] = rest % groups(i), rest /= groups(i);
      for (Index g = first; g < last; ++g) {
        const S* from = a.data();
        S* to = out.data();
        for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) {
          const Index place = i == beside ? at[i] * group : at[i];
          from += place * axes[i].in, to += place * axes[i].out;
        }
        const Index lines = beside == 0 ? 1 : std::min(group, axes[beside].size - at[beside] * group);
        copy_lines(from, line.in, line.size, to, lines, axes[beside].out);
        for (std::size_t i = 1; i < static_cast<std::size_t>(count) && ++at[i] == groups(i); ++i) at[i] = 0;
      }
    });
    return out;
  }
  /// Line l of n values:  to[l * pitch + i] = from[l + i * step]. Several lines only where step > 1.
  static void copy_lines(const S* from, Index step, Index n, S* to, Index lines, Index pitch) {
    if (step == 1) {
      std::memcpy(to, from, static_cast<std::size_t>(n) * sizeof(S));
    } else if (step == 0) {
      std::fill_n(to, n, *from);
    } else {
      for (Index i = 0; i < n; ++i, from += step) {
        for (Index l = 0; l < lines; ++l) to[l * pitch + i] = from[l];
      }
    }
  }
};

MOTIONLANG_NAMESPACE_END
