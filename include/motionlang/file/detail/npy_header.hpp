// SPDX-License-Identifier: MIT
/// The header of a .npy file: a small parser for the Python dictionary with which NumPy describes an array.
#pragma once

#include <string>       // element type
#include <string_view>  // text
#include <vector>       // shape

#include <motionlang/core/error.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Reads the header of a .npy file: a Python dictionary with the keys descr, fortran_order and shape.
/// Source  numpy.lib.format; also the Python 2 form of integers (3L).
class NpyHeader {
 public:
  std::string descr;
  bool fortran_order = false;
  std::vector<Index> shape;

  NpyHeader(std::string_view text, std::size_t offset, std::string_view file);

  template <class... T>
  [[noreturn]] void fail(const T&... what) const {
    raise<io_error>(403, file_, ": npy header: ", what..., " at byte ", offset_ + at_);
  }
  template <class... T>
  [[noreturn]] void unsupported(const T&... what) const {
    raise<io_error>(404, file_, ": npy header: ", what..., " at byte ", offset_ + at_);
  }

 private:
  static constexpr std::size_t max_rank = 64;  // NumPy 2; NumPy 1 allows 32

  char peek();
  bool accept(char c) { return peek() == c && (++at_, true); }
  void expect(char c);
  bool accept_word(std::string_view word);
  std::string quoted();
  bool boolean();
  std::vector<Index> tuple();

  std::string_view text_;
  std::size_t offset_;
  std::string_view file_;
  std::size_t at_ = 0;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/detail/npy_header.ipp>
#endif
