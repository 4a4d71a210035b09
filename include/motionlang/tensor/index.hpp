// SPDX-License-Identifier: MIT
/// Moves values: reshape, permute, slice, concat, gather, scatter.
#pragma once

#include <array>  // axes

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/tensor/tensor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The same values in another shape. One size may be -1 and is then computed. Throws shape_error 205.
template <int New, Backend B, int R>
Tensor<B, New> reshape(const Tensor<B, R>& a, const std::array<Index, New>& sizes) {
  detail::require_tensor("reshape", a);
  Index known = 1;
  int unknown = -1;
  for (int i = 0; i < New; ++i) {
    const Index n = sizes[static_cast<std::size_t>(i)];
    if (n == -1 && unknown < 0)
      unknown = i;
    else
      known *= n;
  }
  Shape s;
  for (int i = 0; i < New; ++i)
    s.push_back(i == unknown ? (known == 0 ? 0 : a.count() / known) : sizes[static_cast<std::size_t>(i)]);
  if (s.count() != a.count()) raise<shape_error>(205, "reshape: shape ", a.shape(), " cannot become ", s);
  return Tensor<B, New>(B::reshape(a.data(), s));
}

/// out[i_axes[0], i_axes[1], ...] = a[i_0, i_1, ...]
template <Backend B, int R>
Tensor<B, R> permute(const Tensor<B, R>& a, const std::array<int, static_cast<std::size_t>(R)>& axes) {
  detail::require_tensor("permute", a);
  std::array<int, static_cast<std::size_t>(R)> from{};
  unsigned seen = 0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    from[i] = normalize_axis(axes[i], R, "permute");
    seen |= 1u << static_cast<unsigned>(from[i]);
  }
  if (seen != (1u << R) - 1) raise<shape_error>(203, "permute: every axis must occur once");
  return Tensor<B, R>(B::permute(a.data(), std::span<const int>(from)));
}
template <Backend B>
Tensor<B, 2> transpose(const Tensor<B, 2>& a) {
  return permute(a, {1, 0});
}

/// Sizes of 1 and missing leading axes are repeated.
template <int New, Backend B, int R>
requires(New >= R) Tensor<B, New> broadcast_to(const Tensor<B, R>& a, const Shape& s) {
  if (broadcast_shapes(a.shape(), s, "broadcast_to") != s)
    raise<shape_error>(202, "broadcast_to: ", a.shape(), " does not become ", s);
  detail::require_tensor("broadcast_to", a);
  return Tensor<B, New>(B::broadcast(a.data(), s));
}

/// Indices first ... last-1 along an axis. If these are all, it is the tensor itself, without a copy. Throws
/// shape_error 203.
template <Backend B, int R>
Tensor<B, R> slice(const Tensor<B, R>& a, int axis, Index first, Index last) {
  detail::require_tensor("slice", a);
  axis = normalize_axis(axis, R, "slice");
  if (first < 0 || last < first || last > a.size(axis)) {
    raise<shape_error>(203, "slice: ", first, " ... ", last, " of axis ", axis, " of ", a.shape());
  }
  if (first == 0 && last == a.size(axis)) return a;
  return Tensor<B, R>(B::slice(a.data(), axis, first, last));
}

/// Joins along an axis; the other sizes must be equal. Throws shape_error 204.
template <Backend B, int R>
Tensor<B, R> concat(std::span<const Tensor<B, R>> list, int axis) {
  if (list.empty()) raise<shape_error>(205, "concat: nothing to join");
  axis = normalize_axis(axis, R, "concat");
  PoolVector<typename B::tensor> data;
  data.reserve(list.size());
  for (const auto& t : list) {
    if (t.shape().without(axis) != list.front().shape().without(axis)) {
      raise<shape_error>(204, "concat along axis ", axis, ": shapes ", list.front().shape(), " and ", t.shape());
    }
    detail::require_tensor("concat", t);
    data.push_back(t.data());
  }
  return Tensor<B, R>(B::concat(std::span<const typename B::tensor>(data), axis));
}
template <Backend B, int R, class... T>
Tensor<B, R> concat(int axis, const Tensor<B, R>& first, const T&... more) {
  axis = normalize_axis(axis, R, "concat");
  detail::require_tensor("concat", first);
  const Shape rest = first.shape().without(axis);
  auto check = [&](const Tensor<B, R>& t) {
    if (t.shape().without(axis) != rest) {
      raise<shape_error>(204, "concat along axis ", axis, ": shapes ", first.shape(), " and ", t.shape());
    }
    detail::require_tensor("concat", t);
  };
  (check(more), ...);
  const std::array<typename B::tensor, 1 + sizeof...(T)> data{first.data(), more.data()...};
  return Tensor<B, R>(B::concat(std::span<const typename B::tensor>(data), axis));
}

namespace detail {
void check_rows(const char* op, std::span<const Index> rows, Index n);
}  // namespace detail

/// out[i] = a[rows[i]]: selects along the first axis; rows may repeat. Throws shape_error 203.
template <Backend B, int R>
requires(R > 0) Tensor<B, R> gather(const Tensor<B, R>& a, std::span<const Index> rows) {
  detail::require_tensor("gather", a);
  detail::check_rows("gather", rows, a.size(0));
  return Tensor<B, R>(B::gather(a.data(), rows));
}
/// out[rows[i]] += a[i] into n rows of zeros. The adjoint of gather. Throws shape_error 203, 204.
template <Backend B, int R>
requires(R > 0) Tensor<B, R> scatter_add(const Tensor<B, R>& a, std::span<const Index> rows, Index n) {
  detail::require_tensor("scatter_add", a);
  if (static_cast<Index>(rows.size()) != a.size(0)) {
    raise<shape_error>(204, "scatter_add: ", Index(rows.size()), " rows for shape ", a.shape());
  }
  detail::check_rows("scatter_add", rows, n);
  return Tensor<B, R>(B::scatter_add(a.data(), rows, n));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/tensor/index.ipp>
#endif
