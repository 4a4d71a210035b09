// SPDX-License-Identifier: MIT
/// Initial values of parameters, from PyTorch's distributions but not its random numbers.
#pragma once

#include <algorithm>  // fill
#include <cmath>      // sqrt
#include <cstdlib>    // calloc
#include <memory>     // owner of zeros
#include <string>     // name of a file

#include <motionlang/tensor/tensor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// While it lives, this thread makes at most as many parameters as a file of weights justifies: twice its values and 16
/// Mi. So a small file with huge sizes is refused before memory is taken for them.
class ParameterRoom {
 public:
  /// file: its name for messages; numbers: of all its tensors
  ParameterRoom(std::string file, Index numbers);
  ~ParameterRoom();
  ParameterRoom(const ParameterRoom&) = delete;
  ParameterRoom& operator=(const ParameterRoom&) = delete;

  /// Throws config_error 102 if there is no room for a parameter of this shape.
  static void take(const Shape& shape);

 private:
  static ParameterRoom*& innermost();
  void take_numbers(const Shape& shape);

  std::string file_;
  Index numbers_;
  double taken_ = 0;
  ParameterRoom* before_;
};

/// A generator that gives zeros at no cost, for models whose parameters will be loaded.
struct NoInit {
  template <class S>
  void normal(std::span<S> out) {
    std::fill(out.begin(), out.end(), S(0));
  }
  template <class S>
  void uniform(std::span<S> out) {
    std::fill(out.begin(), out.end(), S(0));
  }
  NoInit split(std::string_view) const { return {}; }
  NoInit split(std::uint64_t) const { return {}; }
};
static_assert(Rng<NoInit>);

namespace detail {

/// Zeros that take no memory before they are read, if the backend's tensors can use foreign memory.
template <Backend B, int R>
Tensor<B, R> untouched_zeros(const Shape& shape) {
  using S = typename B::scalar;
  if constexpr (AutodiffBackend<B>) {
    return Tensor<B, R>(B::variable(untouched_zeros<typename B::inner, R>(shape).data()));
  } else if constexpr (std::is_constructible_v<typename B::tensor, const S*, Shape, std::shared_ptr<const void>>) {
    const std::shared_ptr<void> zeros(std::calloc(static_cast<std::size_t>(shape.count()) + 1, sizeof(S)), std::free);
    if (zeros == nullptr) raise_bad_alloc();
    return Tensor<B, R>(typename B::tensor(static_cast<const S*>(zeros.get()), shape, zeros));
  } else {
    return Tensor<B, R>::zeros(shape);
  }
}

template <class G>
inline constexpr bool is_no_init = std::is_same_v<std::remove_cvref_t<G>, NoInit>;

}  // namespace detail

/// Uniform in [-bound, bound].
template <Backend B, int R>
Tensor<B, R> uniform_init(const Shape& shape, double bound, Rng auto& rng) {
  ParameterRoom::take(shape);
  if constexpr (detail::is_no_init<decltype(rng)>) return detail::untouched_zeros<B, R>(shape);
  std::vector<typename B::scalar> values(static_cast<std::size_t>(shape.count()));
  rng.uniform(std::span<typename B::scalar>(values));
  for (auto& v : values) v = static_cast<typename B::scalar>((2 * static_cast<double>(v) - 1) * bound);
  Tensor<B, R> t = Tensor<B, R>::from(values, shape);
  if constexpr (AutodiffBackend<B>) t = Tensor<B, R>(B::variable(B::value(t.data())));
  return t;
}
/// Glorot and Bengio (2010): bound sqrt(6 / (fan in + fan out)). shape is (out, in).
template <Backend B>
Tensor<B, 2> xavier_uniform(const Shape& shape, Rng auto& rng) {
  return uniform_init<B, 2>(shape, std::sqrt(6.0 / static_cast<double>(shape[0] + shape[1])), rng);
}
/// Normal with the given standard deviation.
template <Backend B, int R>
Tensor<B, R> normal_init(const Shape& shape, double std, Rng auto& rng) {
  ParameterRoom::take(shape);
  if constexpr (detail::is_no_init<decltype(rng)>) return detail::untouched_zeros<B, R>(shape);
  std::vector<typename B::scalar> values(static_cast<std::size_t>(shape.count()));
  rng.normal(std::span<typename B::scalar>(values));
  for (auto& v : values) v = static_cast<typename B::scalar>(static_cast<double>(v) * std);
  Tensor<B, R> t = Tensor<B, R>::from(values, shape);
  if constexpr (AutodiffBackend<B>) t = Tensor<B, R>(B::variable(B::value(t.data())));
  return t;
}
/// Glorot and Bengio (2010), normal: std sqrt(2 / (fan in + fan out)). shape is (out, in), followed by the kernel if
/// there is one.
template <Backend B, int R>
Tensor<B, R> xavier_normal(const Shape& shape, Rng auto& rng) {
  const Index kernel = shape.count(2, shape.rank());
  return normal_init<B, R>(shape, std::sqrt(2.0 / static_cast<double>((shape[0] + shape[1]) * kernel)), rng);
}
template <Backend B, int R>
Tensor<B, R> constant_init(const Shape& shape, double value) {
  ParameterRoom::take(shape);
  Tensor<B, R> t = Tensor<B, R>::full(shape, value);
  if constexpr (AutodiffBackend<B>) t = Tensor<B, R>(B::variable(B::value(t.data())));
  return t;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/nn/init.ipp>
#endif
