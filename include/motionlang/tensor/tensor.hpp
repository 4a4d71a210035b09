// SPDX-License-Identifier: MIT
/// Tensor<B, Rank> for user code. The backend and the rank are types, the sizes are values.
///
/// A handle with value semantics: copying shares memory, but a write is never visible through another handle. A wrong
/// rank is a compile error. Wrong sizes are a `shape_error` from the operation, thrown before any backend runs.
#pragma once

#include <array>        // places
#include <concepts>     // tensors that can be written
#include <type_traits>  // is_arithmetic
#include <vector>       // values

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/concepts.hpp>
#include <motionlang/core/lifetime.hpp>
#include <motionlang/core/rng.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A backend's tensor with row-major values that fill(scalar*) writes. It writes directly into the tensor if possible,
/// so that a large table does not exist twice.
template <Backend B, class F>
typename B::tensor written_tensor(const Shape& shape, const F& fill) {
  using S = typename B::scalar;
  if constexpr (requires(typename B::tensor t, const Shape& s) {
                  { t.data() } -> std::same_as<S*>;
                  t = typename B::tensor(s);
                }) {
    typename B::tensor t(shape);
    fill(t.data());
    return t;
  } else {
    PoolVector<S> values(static_cast<std::size_t>(shape.count()));
    fill(values.data());
    return B::from_span(values, shape);
  }
}

template <Backend B, int Rank>
class Tensor {
  static_assert(Rank >= 0 && Rank <= Shape::max_rank, "motionlang::Tensor: rank must be 0 ... 6");

 public:
  using backend = B;
  using scalar = typename B::scalar;
  static constexpr int rank = Rank;

  /// No tensor yet: its shape is (0) for any rank, it has no values, and operations refuse it. A moved-from tensor is
  /// the same.
  Tensor() = default;
  /// Wraps a backend's tensor. Throws shape_error 206 if its rank differs.
  explicit Tensor(typename B::tensor data) : data_(std::move(data)) {
    if (shape().rank() != Rank) raise<shape_error>(206, "Tensor: rank ", Rank, " expected, shape is ", shape());
  }
  /// One value with all sizes 1, which broadcasts against anything.
  template <class N>
  requires std::is_arithmetic_v<N>
  explicit Tensor(N value) : data_(B::full(ones(), static_cast<scalar>(value))) {}

  static Tensor full(const Shape& shape, double value) {
    return Tensor(B::full(checked(shape), static_cast<scalar>(value)));
  }
  static Tensor zeros(const Shape& shape) { return full(shape, 0); }
  /// Row-major values. Throws shape_error 205 if their number does not fit the shape.
  static Tensor from(std::span<const scalar> values, const Shape& shape) {
    if (static_cast<Index>(values.size()) != shape.count()) {
      raise<shape_error>(205, "Tensor: ", Index(values.size()), " values for shape ", shape);
    }
    return Tensor(B::from_span(values, checked(shape)));
  }
  static Tensor from(const std::vector<scalar>& values, const Shape& shape) {
    return from(std::span<const scalar>(values), shape);
  }
  /// Row-major values that fill(scalar*) writes (written_tensor).
  template <class F>
  static Tensor written(const Shape& shape, const F& fill) {
    return Tensor(written_tensor<B>(checked(shape), fill));
  }
  /// Standard normal values.
  static Tensor randn(const Shape& shape, Rng auto& rng) {
    return written(shape,
                   [&](scalar* to) { rng.normal(std::span<scalar>(to, static_cast<std::size_t>(shape.count()))); });
  }

  const typename B::tensor& data() const& MOTIONLANG_LIFETIMEBOUND { return data_; }
  typename B::tensor data() && { return std::move(data_); }
  /// For code that replaces the values in place (optimisers, loaders).
  typename B::tensor& mutable_data() MOTIONLANG_LIFETIMEBOUND { return data_; }

  Shape shape() const { return B::shape(data_); }
  Index size(int axis) const { return shape()[normalize_axis(axis, Rank, "Tensor::size")]; }
  Index count() const { return shape().count(); }
  /// True if there is a tensor, perhaps an empty one. False before it is made, and after a move.
  bool defined() const {
    if constexpr (Rank == 1 && requires(const typename B::tensor& t) { t.defined(); }) return data_.defined();
    return shape().rank() == Rank;
  }

  /// The values, row-major; valid while this tensor lives and is not assigned to.
  std::span<const scalar> span() const& MOTIONLANG_LIFETIMEBOUND { return B::to_span(data_); }
  std::span<const scalar> span() const&& = delete;  // values of a temporary end with it: name it, or use to_vector()
  std::vector<scalar> to_vector() const {
    const auto s = span();
    return {s.begin(), s.end()};
  }
  /// The only value of a tensor with one element. Throws shape_error 205.
  scalar item() const {
    if (count() != 1) raise<shape_error>(205, "Tensor::item: shape ", shape(), " has ", count(), " elements");
    return span()[0];
  }
  /// The value at an index for each axis: t.at(0, 2). For many values use span(). Throws shape_error 203 for an index
  /// outside its axis, and 206 if there is no tensor.
  template <std::integral... I>
  requires(sizeof...(I) == Rank) scalar at(I... index)
  const {
    const Shape sizes = shape();
    if (!defined()) raise<shape_error>(206, "Tensor::at: no tensor yet, or moved from; rank ", Rank, " expected");
    const std::array<Index, static_cast<std::size_t>(Rank)> place{static_cast<Index>(index)...};
    Index number = 0;
    for (int axis = 0; axis < Rank; ++axis) {
      const Index i = place[static_cast<std::size_t>(axis)];
      if (i < 0 || i >= sizes[axis])
        raise<shape_error>(203, "Tensor::at: index ", i, " of axis ", axis, " of shape ", sizes);
      number = number * sizes[axis] + i;
    }
    return span()[static_cast<std::size_t>(number)];
  }

 private:
  static Shape ones() {
    Shape s;
    for (int i = 0; i < Rank; ++i) s.push_back(1);
    return s;
  }
  static const Shape& checked(const Shape& s) {
    if (s.rank() != Rank) raise<shape_error>(206, "Tensor: rank ", Rank, " expected, shape is ", s);
    return s;
  }
  typename B::tensor data_{};
};

namespace detail {

/// Throws shape_error 206 for an unset or moved-from tensor.
template <Backend B, int R>
void require_tensor(std::string_view op, const Tensor<B, R>& t) {
  if (!t.defined()) raise<shape_error>(206, op, ": no tensor yet, or moved from; rank ", R, " expected");
}

}  // namespace detail

template <class T>
inline constexpr bool is_tensor = false;
template <class B, int R>
inline constexpr bool is_tensor<Tensor<B, R>> = true;

MOTIONLANG_NAMESPACE_END
