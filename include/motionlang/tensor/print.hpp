// SPDX-License-Identifier: MIT
/// Tensors as readable text: shape and values.
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

/// The text of values in row-major order; number(numbers, i) returns the text of value i.
std::string array_text(const Shape& shape, const void* numbers, std::string (*number)(const void*, Index));

}  // namespace detail

/// Shape and values in brackets, with the innermost axis in a line: "(2, 2) [[1, 2.5],\n        [-3, 4]]". Values have
/// as many digits as needed to read them back. If there are more than 1000 values, axes of more than six show their
/// first and last three. An unset or moved-from tensor is "no tensor".
template <Backend B, int R>
std::string to_string(const Tensor<B, R>& t) {
  if (!t.defined()) return "no tensor";
  using S = typename B::scalar;
  return detail::array_text(t.shape(), t.span().data(), [](const void* numbers, Index i) {
    return concat_text(static_cast<const S*>(numbers)[i]);
  });
}

/// For code that includes <ostream>.
template <Backend B, int R>
std::ostream& operator<<(std::ostream& out, const Tensor<B, R>& t) {
  return out << to_string(t);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/tensor/print.ipp>
#endif
