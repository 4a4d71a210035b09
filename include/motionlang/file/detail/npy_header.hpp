// SPDX-License-Identifier: MIT
/// The header of a .npy file: a small parser for the Python dictionary in which NumPy describes an array.
#pragma once

#include <charconv>     // from_chars
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

  NpyHeader(std::string_view text, std::size_t offset, std::string_view file)
      : text_(text), offset_(offset), file_(file) {
    expect('{');
    std::string seen;
    while (!accept('}')) {
      const std::string key = quoted();
      expect(':');
      if (seen.find(key + ",") != std::string::npos) fail("key '", key, "' twice");
      seen += key + ",";
      if (key == "descr") {
        if (peek() == '[') unsupported("a record type");
        descr = quoted();
      } else if (key == "fortran_order") {
        fortran_order = boolean();
      } else if (key == "shape") {
        shape = tuple();
      } else {
        fail("unknown key '", key, "'");
      }
      if (!accept(',') && peek() != '}') fail("no comma after '", key, "'");
    }
    if (peek() != '\0') fail("characters after the dictionary");
    if (seen.size() != std::string_view("descr,fortran_order,shape,").size()) fail("has only the keys ", seen);
  }

  template <class... T>
  [[noreturn]] void fail(const T&... what) const {
    raise<io_error>(403, file_, ": npy header: ", what..., " at byte ", offset_ + at_);
  }
  template <class... T>
  [[noreturn]] void unsupported(const T&... what) const {
    raise<io_error>(404, file_, ": npy header: ", what..., " at byte ", offset_ + at_);
  }

 private:
  static constexpr std::size_t max_rank = 64;  // NumPy 2; NumPy 1 has 32

  char peek() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t')) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool accept(char c) { return peek() == c && (++at_, true); }
  void expect(char c) {
    if (!accept(c)) fail("'", c, "' expected");
  }
  bool accept_word(std::string_view word) {
    peek();
    if (!text_.substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  std::string quoted() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') fail("a text in quotes expected");
    const std::size_t start = ++at_;
    const std::size_t end = text_.find(quote, start);
    if (end == std::string_view::npos) fail("a text without end");
    at_ = end + 1;
    return std::string(text_.substr(start, end - start));
  }
  bool boolean() {
    if (accept_word("True")) return true;
    if (!accept_word("False")) fail("True or False expected");
    return false;
  }
  std::vector<Index> tuple() {
    std::vector<Index> sizes;
    expect('(');
    while (!accept(')')) {
      peek();
      Index size = 0;
      const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), size);
      if (error != std::errc() || size < 0) fail("a size that is not negative expected");
      at_ = static_cast<std::size_t>(end - text_.data());
      if (at_ < text_.size() && text_[at_] == 'L') ++at_;
      if (sizes.size() == max_rank) fail("more than ", max_rank, " sizes");
      sizes.push_back(size);
      if (!accept(',') && peek() != ')') fail("no comma in the shape");
    }
    return sizes;
  }

  std::string_view text_;
  std::size_t offset_;
  std::string_view file_;
  std::size_t at_ = 0;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
