// SPDX-License-Identifier: MIT
/// The parts of C++20 that libc++ lacks on macOS, in WebAssembly and on Linux: `bit_cast` (before libc++ 14), and
/// `from_chars` and `to_chars` of floating-point values. The bits and characters are the same as with every other
/// standard library.
#pragma once

#include <bit>       // bit_cast
#include <charconv>  // from_chars, to_chars
#include <concepts>  // integral, floating_point

#include <motionlang/version.hpp>

#ifndef __cpp_lib_to_chars
#include <motionlang/core/detail/decimal.hpp>
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

#ifdef __cpp_lib_bit_cast
using std::bit_cast;
#else
template <class To, class From>
constexpr To bit_cast(const From& from) {
  return __builtin_bit_cast(To, from);
}
#endif

#ifdef __cpp_lib_to_chars
using std::from_chars;
using std::to_chars;
#else
// These are templates, because libc++ has some of the functions for floating-point values and deletes the others.
template <std::integral N>
std::from_chars_result from_chars(const char* first, const char* last, N& value, int base = 10) {
  return std::from_chars(first, last, value, base);
}
template <std::floating_point F>
std::from_chars_result from_chars(const char* first, const char* last, F& value) {
  return read_decimal(first, last, value);
}
template <std::integral N>
std::to_chars_result to_chars(char* first, char* last, N value) {
  return std::to_chars(first, last, value);
}
template <std::floating_point F>
std::to_chars_result to_chars(char* first, char* last, F value) {
  return copy_text(shortest_text(value), first, last);
}
template <std::floating_point F>
std::to_chars_result to_chars(char* first, char* last, F value, std::chars_format format) {
  return copy_text(shortest_text(value, format), first, last);
}
template <std::floating_point F>
std::to_chars_result to_chars(char* first, char* last, F value, std::chars_format format, int places) {
  return copy_text(text_with_places(value, format, places), first, last);
}
#endif

}  // namespace detail
MOTIONLANG_NAMESPACE_END
