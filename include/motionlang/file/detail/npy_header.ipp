// SPDX-License-Identifier: MIT
// Bodies of npy_header.hpp.
#pragma once

#include <charconv>  // from_chars

#include <motionlang/file/detail/npy_header.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY NpyHeader::NpyHeader(std::string_view text, std::size_t offset, std::string_view file)
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

MOTIONLANG_BODY char NpyHeader::peek() {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t')) ++at_;
  return at_ < text_.size() ? text_[at_] : '\0';
}

MOTIONLANG_BODY void NpyHeader::expect(char c) {
  if (!accept(c)) fail("'", c, "' expected");
}

MOTIONLANG_BODY bool NpyHeader::accept_word(std::string_view word) {
  peek();
  if (!text_.substr(at_).starts_with(word)) return false;
  at_ += word.size();
  return true;
}

MOTIONLANG_BODY std::string NpyHeader::quoted() {
  const char quote = peek();
  if (quote != '\'' && quote != '"') fail("a text in quotes expected");
  const std::size_t start = ++at_;
  const std::size_t end = text_.find(quote, start);
  if (end == std::string_view::npos) fail("a text without end");
  at_ = end + 1;
  return std::string(text_.substr(start, end - start));
}

MOTIONLANG_BODY bool NpyHeader::boolean() {
  if (accept_word("True")) return true;
  if (!accept_word("False")) fail("True or False expected");
  return false;
}

MOTIONLANG_BODY std::vector<Index> NpyHeader::tuple() {
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

}  // namespace detail

MOTIONLANG_NAMESPACE_END
