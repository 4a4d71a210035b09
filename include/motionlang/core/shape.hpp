// SPDX-License-Identifier: MIT
/// Sizes of a tensor, stored inline, and the broadcasting rule.
#pragma once

#include <array>             // storage
#include <cstddef>           // ptrdiff_t
#include <initializer_list>  // Shape{2, 3}
#include <span>              // construction from a range
#include <string>            // to_string

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes, positions and counts. The type is signed, so that differences may be negative.
using Index = std::ptrdiff_t;

/// Up to six sizes, slowest axis first. A shape without axes is a scalar and has one element.
class Shape {
 public:
  static constexpr int max_rank = 6;

  constexpr Shape() = default;
  constexpr Shape(std::initializer_list<Index> sizes) : Shape(std::span<const Index>(sizes.begin(), sizes.size())) {}
  constexpr explicit Shape(std::span<const Index> sizes) {
    if (sizes.size() > max_rank) raise<shape_error>(206, "Shape: more than ", max_rank, " axes: ", Index(sizes.size()));
    for (Index n : sizes) push_back(n);
  }

  constexpr int rank() const { return rank_; }
  constexpr Index operator[](int axis) const { return size_[static_cast<std::size_t>(axis)]; }
  constexpr Index& operator[](int axis) { return size_[static_cast<std::size_t>(axis)]; }
  constexpr std::span<const Index> sizes() const { return {size_.data(), static_cast<std::size_t>(rank_)}; }
  constexpr Index back() const { return size_[static_cast<std::size_t>(rank_ - 1)]; }

  /// Number of elements.
  constexpr Index count() const { return count(0, rank_); }
  /// Product of the sizes of the axes first ... last-1.
  constexpr Index count(int first, int last) const {
    Index n = 1;
    for (int i = first; i < last; ++i) n *= (*this)[i];
    return n;
  }
  constexpr void push_back(Index n) {
    if (n < 0) raise<shape_error>(205, "Shape: negative size ", n);
    if (rank_ == max_rank) raise<shape_error>(206, "Shape: more than ", max_rank, " axes");
    size_[static_cast<std::size_t>(rank_++)] = n;
  }
  /// The same sizes without one axis.
  constexpr Shape without(int axis) const {
    Shape s;
    for (int i = 0; i < rank_; ++i) {
      if (i != axis) s.push_back((*this)[i]);
    }
    return s;
  }
  constexpr bool operator==(const Shape& o) const {
    if (rank_ != o.rank_) return false;
    for (int i = 0; i < rank_; ++i) {
      if ((*this)[i] != o[i]) return false;
    }
    return true;
  }

 private:
  std::array<Index, max_rank> size_{};
  int rank_ = 0;
};

namespace detail {

/// "(2, 60, 512)"; a negative size means any size.
std::string shape_text(std::span<const Index> sizes);

}  // namespace detail

/// "(2, 60, 512)"
inline std::string to_string(const Shape& s) { return detail::shape_text(s.sizes()); }

/// An axis, counted from the end if negative. Throws shape_error 203 if it is out of range.
constexpr int normalize_axis(int axis, int rank, const char* op) {
  const int a = axis < 0 ? axis + rank : axis;
  if (a < 0 || a >= rank) raise<shape_error>(203, op, ": axis ", axis, " of a tensor of rank ", rank);
  return a;
}

/// NumPy's rule: align at the last axis; sizes must be equal or one of them 1.
constexpr Shape broadcast_shapes(const Shape& a, const Shape& b, const char* op) {
  const int rank = a.rank() > b.rank() ? a.rank() : b.rank();
  Shape out;
  for (int i = 0; i < rank; ++i) {
    const int ia = i - (rank - a.rank()), ib = i - (rank - b.rank());
    const Index na = ia < 0 ? 1 : a[ia], nb = ib < 0 ? 1 : b[ib];
    if (na != nb && na != 1 && nb != 1) {
      raise<shape_error>(202, op, ": shapes do not broadcast: lhs ", a, ", rhs ", b);
    }
    out.push_back(na == 1 ? nb : na);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/shape.ipp>
#endif
