// SPDX-License-Identifier: MIT
/// Tensors as text, for people: shape and numbers.
///
///     const auto x = Tensor<B, 2>::from({1, 2.5, -3, 4}, {2, 2});
///     std::cout << x << "\n";
///     const std::string text = to_string(x);
#pragma once

#include <iosfwd>  // operator<<
#include <string>  // the text

#include <motionlang/tensor/tensor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The text of numbers in row-major order; number(numbers, i) is that of number i.
std::string array_text(const Shape& shape, const void* numbers, std::string (*number)(const void*, Index));

}  // namespace detail

/// Shape and numbers in brackets, the innermost axis in a line: "(2, 2) [[1, 2.5],\n        [-3, 4]]". Numbers have as
/// many digits as read back the same. Of more than 1000 numbers, axes of more than six have their first and last three.
/// A tensor that is not made yet, or was moved from, is "no tensor".
template <Backend B, int R>
std::string to_string(const Tensor<B, R>& t) {
  if (!t.defined()) return "no tensor";
  using S = typename B::scalar;
  return detail::array_text(t.shape(), t.span().data(), [](const void* numbers, Index i) {
    return concat_text(static_cast<const S*>(numbers)[i]);
  });
}

/// For who includes <ostream>.
template <Backend B, int R>
std::ostream& operator<<(std::ostream& out, const Tensor<B, R>& t) {
  return out << to_string(t);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/tensor/print.ipp>
#endif
