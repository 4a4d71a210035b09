// SPDX-License-Identifier: MIT
/// motionlang 0.2.0, generated from include/ by tests/tools/amalgamate.cpp. Changes belong there.
#pragma once

#ifndef MOTIONLANG_HAS_FWD_HPP  // <motionlang/fwd.hpp>
#define MOTIONLANG_HAS_FWD_HPP
/// Declarations of the types in interfaces. It includes the concepts but no third-party header.
///
///     #include <motionlang/fwd.hpp>
///     void play(const motionlang::Motion& motion, const motionlang::Timeline& timeline);
///     template <motionlang::Backend B> void train(motionlang::Linear<B>& layer);
///
/// A backend must be complete before it is used: Tensor<EigenBackend<float>, 2> needs the backend's header. Stmc is not
/// here because the denoiser constrains its parameters.

#ifndef MOTIONLANG_HAS_CORE_CONCEPTS_HPP  // <motionlang/core/concepts.hpp>
#define MOTIONLANG_HAS_CORE_CONCEPTS_HPP
/// The basic concepts. Each one states its idea, what a model must provide, the laws (run on every model in
/// tests/laws), and the models.

#include <concepts>     // same_as, semiregular
#include <cstdint>      // uint64_t
#include <span>         // views of values and rows
#include <string_view>  // names of random streams

#ifndef MOTIONLANG_HAS_CORE_PRECISION_HPP  // <motionlang/core/precision.hpp>
#define MOTIONLANG_HAS_CORE_PRECISION_HPP
/// The precision of matrix products.

#include <atomic>       // one setting for all threads
#include <optional>     // no such name

#ifndef MOTIONLANG_HAS_VERSION_HPP  // <motionlang/version.hpp>
#define MOTIONLANG_HAS_VERSION_HPP
/// The version of the library, and the inline namespace that carries it.

#if __cplusplus < 202002L
#error "motionlang needs C++20: compile with -std=c++20 (GCC 12 or Clang 14 and later)"
#endif

#define MOTIONLANG_VERSION_MAJOR 0
#define MOTIONLANG_VERSION_MINOR 2
#define MOTIONLANG_VERSION_PATCH 0
#define MOTIONLANG_VERSION "0.2.0"

/// Every public name lives in `motionlang`, inside this inline namespace. The tag changes with options that change
/// layouts, and without exceptions. So object files built with different options fail to link instead of mixing
/// silently.
#if defined(MOTIONLANG_DIAGNOSTICS) && defined(__cpp_exceptions)
#define MOTIONLANG_ABI v0_diag
#elif defined(MOTIONLANG_DIAGNOSTICS)
#define MOTIONLANG_ABI v0_diag_no_exceptions
#elif defined(__cpp_exceptions)
#define MOTIONLANG_ABI v0
#else
#define MOTIONLANG_ABI v0_no_exceptions
#endif

/// Stands before every definition in a file *.ipp, which has the bodies of the header of the same name. Without
/// motionlang::instantiated, the header includes that file and all functions are inline. With it, units see
/// declarations only, and the library's own units (instantiated/*.cpp) include the files *.ipp.
#define MOTIONLANG_BODY inline

/// Opens and closes the namespace of the library. It is a macro, so that editors, clang-format and ctags need not know
/// the inline namespace: `ctags -R include` finds every name.
#define MOTIONLANG_NAMESPACE_BEGIN \
  namespace motionlang {           \
  inline namespace MOTIONLANG_ABI {
#define MOTIONLANG_NAMESPACE_END \
  }                              \
  }
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// fp32    the values as they are.
/// bf16    Both factors are rounded to bfloat16 (8 bits of significand); products and sums are float. Prepared weights
///         take half the memory. The speed is up to ten times as high where the processor has instructions for it. An
///         element of a product over k differs from the exact one by at most (2^-7 + 2^-16) sum_k |a_k b_k|. The sum,
///         which may start with a bias, is also rounded. Values below 2^-126 may count as 0.
/// bf16x3  fp32 by AMX: a float is the sum of three bfloat16, whose products are added. It is for weights of 128 x 128
///         and more; smaller ones, and other processors, use fp32. It has half the error of fp32 while products are
///         above 2^-108 (below 2^-126 they count as 0). The last digits differ. Use it for many rows and few threads.
///         With two threads, large products take 0.6 to 0.9 of the time, and those of a few rows up to four times as
///         long. With 8 and 16 threads of one machine, large ones took 1.1 to 2.3 times as long, because AMX is slower
///         there when every core uses it.
/// All other arithmetic stays in float. Only the kernels of the Eigen and xtensor backends in float follow this.
enum class Precision { fp32, bf16, bf16x3 };

/// "fp32", ...
inline const char* precision_name(Precision p) {
  return p == Precision::bf16 ? "bf16" : p == Precision::bf16x3 ? "bf16x3" : "fp32";
}
/// The opposite. Nothing if the name is unknown.
inline std::optional<Precision> precision_named(std::string_view name) {
  for (const Precision p : {Precision::fp32, Precision::bf16, Precision::bf16x3}) {
    if (name == precision_name(p)) return p;
  }
  return {};
}

namespace detail {
inline std::atomic<Precision>& current_product_precision() {
  static std::atomic<Precision> current{Precision::fp32};
  return current;
}
}  // namespace detail

/// Precision for the whole process, of weights that are prepared from now on and of products without a prepared weight.
/// backend/precision.hpp changes it, and prepares a model in another.
inline Precision product_precision() { return detail::current_product_precision().load(std::memory_order_acquire); }

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_SCALAR_MATH_HPP  // <motionlang/core/scalar_math.hpp>
#define MOTIONLANG_HAS_CORE_SCALAR_MATH_HPP
/// The elementary functions of `ScalarLike` types, for built-in types.
///
/// Geometry is written once for float, double, dual numbers, SIMD lanes and tensors. Argument-dependent lookup finds
/// `sqrt(Tensor)`, but not `std::sqrt` for a built-in type. These overloads fill that gap, and must be visible first.

#include <cmath>   // the functions themselves
#include <limits>  // infinity

MOTIONLANG_NAMESPACE_BEGIN

inline double sqrt(double x) { return std::sqrt(x); }
inline double exp(double x) { return std::exp(x); }
inline double log(double x) { return std::log(x); }
inline double sin(double x) { return std::sin(x); }
inline double cos(double x) { return std::cos(x); }
inline double atan2(double y, double x) { return std::atan2(y, x); }
inline float sqrt(float x) { return std::sqrt(x); }
inline float exp(float x) { return std::exp(x); }
inline float log(float x) { return std::log(x); }
inline float sin(float x) { return std::sin(x); }
inline float cos(float x) { return std::cos(x); }
inline float atan2(float y, float x) { return std::atan2(y, x); }

/// exp(x) as PyTorch (1.13 of Debian) computes it for float tensors: SLEEF's expf_u10. Its last digit often differs
/// from that of the C library. Published tables of frequencies need it, because after thousands of frames it decides
/// the fourth digit.
inline float torch_exp(float x) {
  if (!(x >= -104.0f)) return x < 0 ? 0.0f : x;  // NaN stays
  if (x > 100.0f) return std::numeric_limits<float>::infinity();
  const float n = std::rint(x * 1.442695040888963407f);
  const float f = std::fma(n, -1.428606765330187045e-06f, std::fma(n, -0.693145751953125f, x));
  constexpr float series[] = {0.00139304355252534151077271f, 0.00833336077630519866943359f,
                              0.0416664853692054748535156f, 0.166666671633720397949219f, 0.5f};
  float p = 0.000198527617612853646278381f;
  for (const float c : series) p = std::fma(p, f, c);
  return std::ldexp(1.0f + std::fma(f * f, p, f), static_cast<int>(n));
}

/// `a < b ? x : y`, which also works element by element. Both x and y are always computed. If the result is
/// differentiated, neither may be NaN, even where it is not chosen.
constexpr double where_less(double a, double b, double x, double y) { return a < b ? x : y; }
constexpr float where_less(float a, float b, float x, float y) { return a < b ? x : y; }

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_SHAPE_HPP  // <motionlang/core/shape.hpp>
#define MOTIONLANG_HAS_CORE_SHAPE_HPP
/// Sizes of a tensor, stored inline, and the broadcasting rule.

#include <array>             // storage
#include <cstddef>           // ptrdiff_t
#include <initializer_list>  // Shape{2, 3}
#include <string>            // to_string

#ifndef MOTIONLANG_HAS_CORE_ERROR_HPP  // <motionlang/core/error.hpp>
#define MOTIONLANG_HAS_CORE_ERROR_HPP
/// Errors: one hierarchy, one id for each kind of failure, one place that throws, one that catches.
///
/// Without exceptions (-fno-exceptions) an error prints its message and ends the program. Define
/// MOTIONLANG_THROW(exception), the same in all units, to change that. It gets the exception as an object (an error,
/// std::bad_alloc, cancelled) on the thread where it happens, and must not return; std::_Exit ends a program from any
/// thread. Errors that the library would catch, for example to skip an unreadable value in a file of weights, also end
/// it.
///
/// A message reads `[motionlang.shape.201] matmul: inner sizes differ: lhs (2, 60, 512), rhs (256, 1024); at
/// layers.3.linear1`. It has the family and the id, the operation, the fault with both values, and (with
/// MOTIONLANG_DIAGNOSTICS) the module path. Text from files appears in it as UTF-8 without control characters.
/// `error_ids` below lists the ids; every one has a test.

#include <cstdio>            // fputs
#include <cstdlib>           // abort
#include <new>               // bad_alloc
#include <stdexcept>         // runtime_error
#include <utility>           // exchange, move
#include <vector>            // diagnostics path

#ifndef MOTIONLANG_HAS_CORE_STANDARD_LIBRARY_HPP  // <motionlang/core/standard_library.hpp>
#define MOTIONLANG_HAS_CORE_STANDARD_LIBRARY_HPP
/// The parts of C++20 that libc++ lacks on macOS, in WebAssembly and on Linux: `bit_cast` (before libc++ 14), and
/// `from_chars` and `to_chars` of floating-point values. The bits and characters are the same as with every other
/// standard library.

#include <bit>       // bit_cast
#include <charconv>  // from_chars, to_chars

#ifndef __cpp_lib_to_chars

#ifndef MOTIONLANG_HAS_CORE_DETAIL_DECIMAL_HPP  // <motionlang/core/detail/decimal.hpp>
#define MOTIONLANG_HAS_CORE_DETAIL_DECIMAL_HPP
/// Floating-point values as decimal text, made by the C library alone. This is for standard libraries that lack
/// `from_chars` and `to_chars` for them (standard_library.hpp). The results are the same to the last character.
///
/// strtod and printf of all C libraries round correctly, but their decimal point is the locale's. So strtod gets whole
/// numbers with an exponent here, and anything that printf writes between digits counts as a point. This is slower than
/// `to_chars`: a microsecond or two for a value.

#include <cassert>       // formats
#include <system_error>  // errc

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

inline bool is_decimal_digit(char c) { return c >= '0' && c <= '9'; }

/// digits x 10^exponent.
struct Decimal {
  std::string digits;
  long long exponent = 0;

  /// The nearest F; infinity if it is too large.
  template <class F>
  F value() const {
    // Beyond these limits a value is zero or infinite, however many digits it has.
    const long long e = exponent < -9999 ? -9999 : exponent > 9999 ? 9999 : exponent;
    const std::string text = digits + "e" + std::to_string(e);
    if constexpr (std::same_as<F, float>) return std::strtof(text.c_str(), nullptr);
    static_assert(std::same_as<F, float> || std::same_as<F, double>);
    return static_cast<F>(std::strtod(text.c_str(), nullptr));
  }
};

/// True if the text begins with `word` in letters of any case.
inline bool starts_with_word(std::string_view text, std::string_view word) {
  if (text.size() < word.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i)
    if ((text[i] | 0x20) != word[i]) return false;
  return true;
}

/// Length of "inf", "infinity", "nan" or "nan(letters)" at the start of a text, and the value; 0 if there is none.
template <class F>
std::size_t read_word(std::string_view text, F& value) {
  if (starts_with_word(text, "inf")) {
    value = std::numeric_limits<F>::infinity();
    return starts_with_word(text, "infinity") ? 8 : 3;
  }
  if (!starts_with_word(text, "nan")) return 0;
  value = std::numeric_limits<F>::quiet_NaN();
  if (text.size() < 4 || text[3] != '(') return 3;
  constexpr std::string_view letters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ_abcdefghijklmnopqrstuvwxyz";
  const std::size_t end = text.find_first_not_of(letters, 4);
  return end != text.npos && text[end] == ')' ? end + 1 : 3;
}

/// The exponent at `p`, and moves `p` past it; 0 if there is none.
inline long long read_exponent(const char*& p, const char* last) {
  const char* at = p;
  if (at == last || (*at | 0x20) != 'e') return 0;
  const bool negative = ++at != last && *at == '-';
  if (at != last && (*at == '-' || *at == '+')) ++at;
  if (at == last || !is_decimal_digit(*at)) return 0;
  long long out = 0;
  for (; at != last && is_decimal_digit(*at); ++at)
    if (out < 1'000'000'000'000'000) out = 10 * out + (*at - '0');  // no text has as many digits
  p = at;
  return negative ? -out : out;
}

/// The number at `p`, and moves `p` past it; no digits if there is none.
inline Decimal read_digits(const char*& p, const char* last) {
  // More digits never decide, because no value halfway between two doubles has more than 767. It only matters if they
  // are all zero, and one digit tells that.
  constexpr std::size_t most = 768;
  Decimal out;
  bool any = false, behind_point = false, more = false;
  const char* at = p;
  for (; at != last && (is_decimal_digit(*at) || (*at == '.' && !behind_point)); ++at) {
    if (*at == '.') {
      behind_point = true;
      continue;
    }
    any = true;
    const bool kept = out.digits.size() < most;
    out.exponent += !kept - behind_point;
    if (!kept)
      more = more || *at != '0';
    else if (!out.digits.empty() || *at != '0')
      out.digits += *at;
  }
  if (!any) return out;
  if (more) {
    out.digits += '1';
    --out.exponent;
  }
  if (out.digits.empty()) out.digits = "0";
  p = at;
  out.exponent += read_exponent(p, last);
  return out;
}

/// As `std::from_chars`.
template <class F>
std::from_chars_result read_decimal(const char* first, const char* last, F& value) {
  const bool negative = first != last && *first == '-';
  const char* p = first + negative;
  F size = 0;
  const Decimal number = read_digits(p, last);
  if (number.digits.empty()) {
    const std::size_t length = read_word(std::string_view(p, static_cast<std::size_t>(last - p)), size);
    if (length == 0) return {first, std::errc::invalid_argument};
    p += length;
  } else {
    size = number.value<F>();
    if (!std::isfinite(size) || (size == 0 && number.digits != "0")) return {p, std::errc::result_out_of_range};
  }
  value = negative ? -size : size;
  return {p, std::errc{}};
}

/// The text that printf wrote, with a point instead of the locale's decimal point, which may have several bytes.
inline std::string with_point(std::string_view printed) {
  std::string out;
  bool inside = false;
  for (const char c : printed) {
    const bool known = is_decimal_digit(c) || c == '-' || c == '+' || c == 'e';
    if (known)
      out += c;
    else if (!inside)
      out += '.';
    inside = !known;
  }
  return out;
}
inline std::string printed(const char* format, int places, double x) {
  char some[64];
  const auto size = static_cast<std::size_t>(std::snprintf(some, sizeof some, format, places, x));
  if (size < sizeof some) return with_point({some, size});
  std::string all(size, ' ');
  std::snprintf(all.data(), size + 1, format, places, x);
  return with_point(all);
}

/// x > 0 rounded to `count` digits.
inline Decimal rounded_decimal(double x, int count) {
  const std::string text = printed("%.*e", count - 1, x);
  const std::size_t e = text.find('e');
  Decimal out{text.substr(0, 1), static_cast<int>(std::strtol(text.c_str() + e + 1, nullptr, 10)) - (count - 1)};
  if (count > 1) out.digits += text.substr(2, e - 2);
  return out;
}

/// The next number with as many digits.
inline Decimal next_decimal(Decimal d) {
  std::size_t i = d.digits.size();
  while (i > 0 && d.digits[i - 1] == '9') d.digits[--i] = '0';
  if (i > 0)
    ++d.digits[i - 1];
  else
    d.digits.insert(0, 1, '1');
  return d;
}

/// The fewest digits that are read back as x > 0. Of several such numbers, the nearest to x.
template <class F>
Decimal shortest_decimal(F x) {
  // A number of digits10 digits survives conversion to a normal F and back. So if the shortest has no more digits than
  // that, it is this number without the zeros at its end.
  for (int count = x < std::numeric_limits<F>::min() ? 1 : std::numeric_limits<F>::digits10;; ++count) {
    Decimal out = rounded_decimal(x, count);
    // The gap above a power of two is twice the gap below. So the nearest number may be too far below, while the next
    // one is near enough above.
    if (out.value<F>() != x) out = next_decimal(std::move(out));
    if (out.value<F>() != x) continue;
    while (out.digits.size() > 1 && out.digits.ends_with('0')) {
      out.digits.pop_back();
      ++out.exponent;
    }
    return out;
  }
}

/// d.ddde+xx
inline std::string scientific_text(const Decimal& d) {
  const long long exponent = d.exponent + static_cast<long long>(d.digits.size()) - 1;
  std::string out = d.digits;
  if (out.size() > 1) out.insert(1, ".");
  out += exponent < 0 ? "e-" : "e+";
  const std::string size = std::to_string(exponent < 0 ? -exponent : exponent);
  return out + (size.size() < 2 ? "0" : "") + size;
}
/// ddd.ddd
inline std::string fixed_text(const Decimal& d, double x) {
  // All digits of a whole number are written.
  if (d.exponent >= 0) return printed("%.*f", 0, x);
  std::string out = d.digits;
  const auto places = static_cast<std::size_t>(-d.exponent);
  if (out.size() <= places) out.insert(0, places + 1 - out.size(), '0');
  return out.insert(out.size() - places, ".");
}

/// The text of `std::to_chars` without a precision: fixed, scientific or, by default, the shorter of the two.
template <class F>
std::string shortest_text(F x, std::chars_format format = {}) {
  using enum std::chars_format;
  assert(format == std::chars_format{} || format == fixed || format == scientific);
  const std::string sign = std::signbit(x) ? "-" : "";
  if (std::isnan(x)) return sign + "nan";
  if (std::isinf(x)) return sign + "inf";
  const F size = std::abs(x);
  const Decimal d = size == 0 ? Decimal{"0"} : shortest_decimal(size);
  const std::string with_exponent = scientific_text(d), without = fixed_text(d, size);
  const bool shorter = format != fixed && with_exponent.size() < without.size();
  return sign + (format == scientific || shorter ? with_exponent : without);
}
/// The text of `std::to_chars` with a number of decimal places: fixed or scientific.
template <class F>
std::string text_with_places(F x, std::chars_format format, int places) {
  using enum std::chars_format;
  assert(format == fixed || format == scientific);
  if (!std::isfinite(x)) return shortest_text(x);
  return printed(format == fixed ? "%.*f" : "%.*e", places, x);
}

inline std::to_chars_result copy_text(const std::string& text, char* first, char* last) {
  if (last - first < static_cast<std::ptrdiff_t>(text.size())) return {last, std::errc::value_too_large};
  text.copy(first, text.size());
  return {first + text.size(), std::errc{}};
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif
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
#endif

#ifndef MOTIONLANG_HAS_CORE_THREAD_OBJECT_HPP  // <motionlang/core/thread_object.hpp>
#define MOTIONLANG_HAS_CORE_THREAD_OBJECT_HPP
/// Objects of which every thread has its own.

// MinGW's GCC frees the memory of thread_local variables before it destroys them, so there the system keeps them.
#if defined(_WIN32) && !defined(__clang__)
#define MOTIONLANG_SYSTEM_KEEPS_THREAD_OBJECTS
extern "C" {
__declspec(dllimport) unsigned long __stdcall FlsAlloc(void(__stdcall* at_end)(void*));
__declspec(dllimport) void* __stdcall FlsGetValue(unsigned long key);
__declspec(dllimport) int __stdcall FlsSetValue(unsigned long key, void* value);
}
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The calling thread's T. It is made at first use and destroyed when the thread ends. `Tag` distinguishes objects of
/// one type.
template <class T, class Tag = T>
T& thread_object() {
#ifdef MOTIONLANG_SYSTEM_KEEPS_THREAD_OBJECTS
  struct AtEnd {
    static void __stdcall call(void* object) { delete static_cast<T*>(object); }
  };
  static const unsigned long key = ::FlsAlloc(&AtEnd::call);
  void* object = ::FlsGetValue(key);
  if (object == nullptr && ::FlsSetValue(key, object = new T) == 0) std::abort();
  return *static_cast<T*>(object);
#else
  thread_local T object;
  return object;
#endif
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_UTF8_HPP  // <motionlang/core/utf8.hpp>
#define MOTIONLANG_HAS_CORE_UTF8_HPP
/// UTF-8, one code point at a time, strictly. text/unicode.hpp has the classes of characters.

MOTIONLANG_NAMESPACE_BEGIN

/// The result of `decode_utf8` for bytes that are not UTF-8.
inline constexpr char32_t invalid_code_point = 0xFFFFFFFF;

/// The code point that starts at text[at]; moves `at` past it. Bytes that are not UTF-8 (stray or missing
/// continuation bytes, overlong forms, surrogates, above U+10FFFF) give `invalid_code_point` and `at` moves by one.
/// Needs at < text.size().
constexpr char32_t decode_utf8(std::string_view text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t start = at++;
  const unsigned char first = byte(start);
  if (first < 0x80) return first;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || length > text.size() - start) return invalid_code_point;
  char32_t c = first & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(start + i) & 0xC0u) != 0x80u) return invalid_code_point;
    c = c << 6 | (byte(start + i) & 0x3Fu);
  }
  constexpr char32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  if (c < smallest[length] || (c >= 0xD800 && c <= 0xDFFF) || c > 0x10FFFF) return invalid_code_point;
  at = start + length;
  return c;
}

/// True if the whole text is UTF-8.
constexpr bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    if (decode_utf8(text, at) == invalid_code_point) return false;
  }
  return true;
}

/// The longest beginning of a text that has at most this many bytes and ends between two characters.
constexpr std::string_view utf8_head(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  for (std::size_t start = bytes - (bytes < 3 ? bytes : 3); start < bytes; ++start) {
    std::size_t end = start;
    if (decode_utf8(text, end) != invalid_code_point && end > bytes) return text.substr(0, start);
  }
  return text.substr(0, bytes);
}

/// Appends the bytes of a code point (up to U+10FFFF).
void append_utf8(std::string& out, char32_t c);

/// For messages and lists: '?' replaces control characters, which terminals obey, and bytes that are not UTF-8.
/// Characters in `keep` stay.
std::string printable(std::string_view text, std::string_view keep = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_UTF8_IPP  // <motionlang/core/utf8.ipp>
#define MOTIONLANG_HAS_CORE_UTF8_IPP
// Bodies of utf8.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void append_utf8(std::string& out, char32_t c) {
  const auto put = [&](char32_t b) { out += static_cast<char>(static_cast<unsigned char>(b)); };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0 | c >> 6), put(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    put(0xE0 | c >> 12), put(0x80 | (c >> 6 & 0x3F)), put(0x80 | (c & 0x3F));
  } else {
    put(0xF0 | c >> 18), put(0x80 | (c >> 12 & 0x3F)), put(0x80 | (c >> 6 & 0x3F)), put(0x80 | (c & 0x3F));
  }
}

MOTIONLANG_BODY std::string printable(std::string_view text, std::string_view keep) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t start = at;
    const char32_t c = decode_utf8(text, at);
    const bool control = c < ' ' || (c >= 0x7F && c <= 0x9F);
    const bool good = (c != invalid_code_point && !control) || keep.find(text[start]) != keep.npos;
    out += good ? text.substr(start, at - start) : "?";
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Base of every exception of the library. `id()` is stable between versions; the text is not.
class error : public std::runtime_error {
 public:
  error(int id, const std::string& message) : std::runtime_error(message), id_(id) {}
  int id() const noexcept { return id_; }

 private:
  int id_;
};

struct config_error : error {
  using error::error;
  static constexpr std::string_view family = "config";
};  // 1xx
struct shape_error : error {
  using error::error;
  static constexpr std::string_view family = "shape";
};  // 2xx
struct numeric_error : error {
  using error::error;
  static constexpr std::string_view family = "numeric";
};  // 3xx
struct io_error : error {
  using error::error;
  static constexpr std::string_view family = "io";
};  // 4xx
struct timeline_error : error {
  using error::error;
  static constexpr std::string_view family = "timeline";
};  // 5xx

/// Thrown when a progress callback asks to stop. Not a failure, hence not an `error`.
struct cancelled : std::runtime_error {
  cancelled() : std::runtime_error("cancelled by the caller") {}
};

struct ErrorId {
  int id;
  std::string_view meaning;
};

// clang-format off
/// Every id with its meaning.
inline constexpr ErrorId error_ids[] = {
    // config: a value that cannot work, whatever the data
    {101, "a size or an option is out of its range"},
    {102, "two options contradict each other"},
    {103, "a name is unknown (joint, body part, option, backend)"},
    {104, "a diffusion schedule has a beta outside (0, 1]"},
    {105, "a respacing specification cannot be satisfied"},
    {106, "a skeleton is malformed (order of parents, number of roots, repeated names)"},
    {107, "a configuration file has a value of the wrong kind"},
    // shape: sizes of tensors
    {201, "inner sizes of a product differ"},
    {202, "shapes cannot be broadcast together"},
    {203, "an axis or an index is out of range"},
    {204, "two operands must have the same size along an axis"},
    {205, "the number of values does not fit the shape"},
    {206, "the rank is not the one that the type states"},
    {207, "sequence offsets do not fit the rows"},
    // numeric: values
    {301, "a value is NaN or infinite"},
    {302, "a value lies outside the domain of the function"},
    // io: files
    {401, "a file cannot be opened, read or written"},
    {402, "a file ends too early"},
    {403, "a file is malformed"},
    {404, "a file asks for a feature that is not supported"},
    {405, "a file declares a size that it cannot have"},
    {406, "tensor names are missing or unexpected"},
    {407, "a tensor has another shape or type than expected"},
    // timeline: texts over time
    {501, "a line has too few or too many fields"},
    {502, "a time is not a number"},
    {503, "a body part is unknown"},
    {504, "an interval is empty or ends before it starts"},
    {505, "no text covers a stretch of the timeline"},
    {506, "a text owns no body part at its own start or end"},
    {507, "the timeline has no line"},
    {508, "a crop is longer than the denoiser accepts"},
    {509, "several timelines where one is expected"},
    {510, "a text cannot be written on a line"},
};
// clang-format on

namespace detail {

inline void append(std::string& out, std::string_view s) { out += s; }
inline void append(std::string& out, char c) { out += c; }
template <std::same_as<bool> T>  // a template, or string literals would convert to bool
void append(std::string& out, T b) {
  out += b ? "true" : "false";
}
template <class N>
requires((std::integral<N> || std::floating_point<N>)&&!std::same_as<N, bool> &&
         !std::same_as<N, char>) void append(std::string& out, N n) {
  if constexpr (std::floating_point<N>) {  // 10000000, not 1e+07, while whole numbers are exact
    constexpr N exact = N(1ull << std::numeric_limits<N>::digits);
    if (n > -exact && n < exact && n != 0 && n == N(static_cast<long long>(n)))
      return append(out, static_cast<long long>(n));
  }
  char digits[64];
  out.append(digits, detail::to_chars(digits, digits + sizeof digits, n).ptr);
}
/// Anything with a `to_string` found by name lookup (shapes, enumerations).
template <class T>
requires requires(const T& t) {
  { to_string(t) } -> std::convertible_to<std::string>;
}
void append(std::string& out, const T& t) { out += to_string(t); }

/// A part of a message: where its value is and how it is written. There is one type for all values and one for literals
/// of all lengths. Otherwise each of the many messages would compile code for its own list of types.
struct TextPart {
  const void* value;
  void (*append)(std::string& out, const void* value);
};
inline TextPart text_part(const char* literal) {
  return {literal, [](std::string& out, const void* value) { out += static_cast<const char*>(value); }};
}
template <class T>
TextPart text_part(const T& value) {
  return {&value, [](std::string& out, const void* v) { detail::append(out, *static_cast<const T*>(v)); }};
}
std::string concat_parts(std::initializer_list<TextPart> parts);

/// A module that is being evaluated. Its name is given, or comes from the fields of the module around it.
struct ModuleStep {
  std::string name;
  const void* module = nullptr;  // null: the name is given
  const void* type = nullptr;    // tells a module from its first member, which has the same address
  /// The path from `module` to a module inside it. "" if that is not inside it.
  std::string (*path_to)(const void* module, const void* inner, const void* inner_type) = nullptr;
};

/// The step into a module (core/fields.hpp).
template <class M>
struct StepInto;

/// The modules that are being evaluated, outermost first. Only kept when MOTIONLANG_DIAGNOSTICS is defined.
struct ModulePath {
  using Steps = std::vector<ModuleStep>;
  static Steps& steps() { return thread_object<Steps, ModulePath>(); }
  /// "layers.3.linear1"
  static std::string text();
  /// While it lives, this thread is inside the modules of another thread, whose work it shares.
  class Continued {
   public:
#ifdef MOTIONLANG_DIAGNOSTICS
    explicit Continued(Steps other) : own_(std::exchange(steps(), std::move(other))) {}
    ~Continued() { steps() = std::move(own_); }
    Continued(const Continued&) = delete;
    Continued& operator=(const Continued&) = delete;

   private:
    Steps own_;
#else
    explicit Continued(const Steps&) {}
    ~Continued() {}
#endif
  };
};

}  // namespace detail

/// The text of all arguments, one after the other. Numbers look as in `std::to_chars`, whole ones without an exponent.
template <class... T>
std::string concat_text(const T&... parts) {
  return detail::concat_parts({detail::text_part(parts)...});
}

/// The items of a list, each written by text(item), with `between` between them: "left, right".
template <class R, class F>
std::string join_text(const R& items, std::string_view between, F text) {
  std::string out;
  bool first = true;
  for (const auto& item : items) {
    if (!first) out += between;
    first = false;
    detail::append(out, text(item));
  }
  return out;
}
template <class R>
std::string join_text(const R& items, std::string_view between = ", ") {
  return join_text(
      items, between, [](const auto& item) -> const auto& { return item; });
}

/// A number of things: "1 frame", "2 frames". For a word with another plural: counted(n, "pass", "passes").
template <std::integral N>
std::string counted(N n, std::string_view one, std::string_view several = {}) {
  std::string out = concat_text(n, ' ', n == 1 || several.empty() ? one : several);
  if (n != 1 && several.empty()) out += 's';
  return out;
}

/// Names the evaluated module while the object lives. Write ModuleScope scope(*this) in its functions, or give the text
/// as arguments. It costs nothing unless MOTIONLANG_DIAGNOSTICS is set.
struct ModuleScope {
#ifdef MOTIONLANG_DIAGNOSTICS
  template <class... T>
  explicit ModuleScope(const T&... name) {
    detail::ModulePath::steps().push_back({.name = concat_text(name...)});
  }
  template <class M>
  requires requires { M::fields(); }
  explicit ModuleScope(const M& module) { detail::ModulePath::steps().push_back(detail::StepInto<M>::step(module)); }
  ~ModuleScope() { detail::ModulePath::steps().pop_back(); }
#else
  template <class... T>
  explicit ModuleScope(const T&...) {}
  ~ModuleScope() {}
#endif
  ModuleScope(const ModuleScope&) = delete;
  ModuleScope& operator=(const ModuleScope&) = delete;
};

namespace detail {

#ifdef __cpp_exceptions
inline constexpr bool has_exceptions = true;
#else
inline constexpr bool has_exceptions = false;
#endif

/// The one place that throws.
template <class E>
[[noreturn]] void throw_exception(const E& exception) {
#if defined(MOTIONLANG_THROW)
  MOTIONLANG_THROW(exception);
  std::abort();
#elif defined(__cpp_exceptions)
  throw exception;
#else
  std::fputs(exception.what(), stderr);
  std::fputs("\n", stderr);
  std::abort();
#endif
}
[[noreturn]] inline void raise_bad_alloc() { throw_exception(std::bad_alloc()); }

/// The one place that catches. Calls f. If f throws an E, calls handle(e), which returns true to stop the exception
/// here and false to pass it on. Returns true if f came to its end.
template <class E, class F, class H>
bool guard(const F& f, [[maybe_unused]] const H& handle) {
#ifdef __cpp_exceptions
  try {
    f();
  } catch (const E& e) {
    if (!handle(e)) throw;
    return false;
  }
#else
  f();
#endif
  return true;
}
/// The same for any exception: handle() sees std::current_exception().
template <class F, class H>
bool guard_all(const F& f, [[maybe_unused]] const H& handle) {
#ifdef __cpp_exceptions
  try {
    f();
  } catch (...) {
    if (!handle()) throw;
    return false;
  }
#else
  f();
#endif
  return true;
}

/// The message of an error of a family.
std::string error_text(std::string_view family, int id, std::initializer_list<TextPart> parts);

template <class E>
[[noreturn]] void raise_parts(int id, std::initializer_list<TextPart> parts) {
  throw_exception(E(id, error_text(E::family, id, parts)));
}

}  // namespace detail

/// Throws E with this id and the text of all parts.
template <class E, class... T>
[[noreturn]] void raise(int id, const T&... parts) {
  detail::raise_parts<E>(id, {detail::text_part(parts)...});
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_ERROR_IPP  // <motionlang/core/error.ipp>
#define MOTIONLANG_HAS_CORE_ERROR_IPP
// Bodies of error.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string concat_parts(std::initializer_list<TextPart> parts) {
  std::string out;
  for (const TextPart& p : parts) p.append(out, p.value);
  return out;
}

MOTIONLANG_BODY std::string ModulePath::text() {
  std::string path;
  const ModuleStep* around = nullptr;
  for (const ModuleStep& step : steps()) {
    std::string name = step.name;
    if (step.module != nullptr) {
      if (around != nullptr) name = around->path_to(around->module, step.module, step.type);
      around = &step;
    }
    if (!path.empty() && !name.empty()) path += '.';
    path += name;
  }
  return path;
}

MOTIONLANG_BODY std::string error_text(std::string_view family, int id, std::initializer_list<TextPart> parts) {
  std::string text = concat_text("[motionlang.", family, ".", id, "] ") + printable(concat_parts(parts), "\n");
#ifdef MOTIONLANG_DIAGNOSTICS
  const std::string path = ModulePath::text();
  if (!path.empty()) text += "; at " + path;
#endif
  return text;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

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

#ifndef MOTIONLANG_HAS_CORE_SHAPE_IPP  // <motionlang/core/shape.ipp>
#define MOTIONLANG_HAS_CORE_SHAPE_IPP
// Bodies of shape.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string shape_text(std::span<const Index> sizes) {
  return concat_text("(", join_text(sizes, ", ", [](Index n) { return n < 0 ? "any" : concat_text(n); }), ")");
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// A number that memory holds: float or double.
template <class S>
concept Scalar = std::same_as<S, float> || std::same_as<S, double>;

/// A type that calculates like a number. Geometry needs nothing more.
/// Laws     those of a field, up to rounding; where_less(a, b, x, y) is x where a < b, else y
/// Models   float, double, Dual<S>, Lane<S> (a SIMD register), Tensor<B, Rank> (element by element)
template <class S>
concept ScalarLike = std::copyable<S> && requires(const S& a, const S& b) {
  S(0.5);
  { a + b } -> std::convertible_to<S>;
  { a - b } -> std::convertible_to<S>;
  { a* b } -> std::convertible_to<S>;
  { a / b } -> std::convertible_to<S>;
  { -a } -> std::convertible_to<S>;
  { sqrt(a) } -> std::convertible_to<S>;
  { sin(a) } -> std::convertible_to<S>;
  { cos(a) } -> std::convertible_to<S>;
  { atan2(a, b) } -> std::convertible_to<S>;
  { where_less(a, b, a, b) } -> std::convertible_to<S>;
};

/// The place and the arithmetic of tensors: a scalar, a dense tensor type and 28 static operations.
///
/// `tensor` is a cheap handle with value semantics and dynamic rank. Operands are taken by value, so that an operation
/// may reuse memory that nobody else holds. The caller has checked shapes (tensor/ops.hpp): a backend only computes.
/// Everything else (softmax, attention, ...) has a default in these primitives. A backend may add its own version under
/// the same name (see tensor/fused.hpp).
///
/// tensor    can be default-constructed, copied and moved. A default-constructed tensor has the shape (0), and to_span
///           gives nothing; a moved-from one is the same. Tensor<B, Rank> refuses such a tensor before an operation of
///           the backend sees it. A list of no values has the shape (0), too. If the tensor has `bool defined() const`,
///           that tells one from the other
/// Minimum   data      full, from_span, to_span, shape
///           elements  add sub mul div maximum atan2 (broadcasting), exp log sqrt tanh erf sin cos, where_less
///           reduce    sum max (one axis, which disappears)
///           product   matmul(a, b, transpose_a, transpose_b), equal leading axes
///           movement  reshape permute broadcast slice concat gather scatter_add
/// Left out  devices, threads, in-place operations, scalars other than float and double, views of foreign memory
/// Laws      Every operation equals that of ReferenceBackend (tests/ops). Operands never change visibly. The algebra of
///           tests/laws holds. examples/11_own_backend has a backend of your own, and runs the laws on it
/// Models    ReferenceBackend<S>, EigenBackend<S>, XtensorBackend<S>, Autodiff<B>
template <class B>
concept Backend = Scalar<typename B::scalar> && std::semiregular<typename B::tensor> &&
    requires(const typename B::tensor a, const Shape s, int axis, Index n, std::span<const typename B::scalar> values,
             std::span<const Index> rows, std::span<const int> axes, std::span<const typename B::tensor> list) {
  { B::full(s, typename B::scalar{}) } -> std::same_as<typename B::tensor>;
  { B::from_span(values, s) } -> std::same_as<typename B::tensor>;
  { B::to_span(a) } -> std::convertible_to<std::span<const typename B::scalar>>;
  { B::shape(a) } -> std::convertible_to<Shape>;
  { B::add(a, a) } -> std::same_as<typename B::tensor>;
  { B::sub(a, a) } -> std::same_as<typename B::tensor>;
  { B::mul(a, a) } -> std::same_as<typename B::tensor>;
  { B::div(a, a) } -> std::same_as<typename B::tensor>;
  { B::maximum(a, a) } -> std::same_as<typename B::tensor>;
  { B::atan2(a, a) } -> std::same_as<typename B::tensor>;
  { B::exp(a) } -> std::same_as<typename B::tensor>;
  { B::log(a) } -> std::same_as<typename B::tensor>;
  { B::sqrt(a) } -> std::same_as<typename B::tensor>;
  { B::tanh(a) } -> std::same_as<typename B::tensor>;
  { B::erf(a) } -> std::same_as<typename B::tensor>;
  { B::sin(a) } -> std::same_as<typename B::tensor>;
  { B::cos(a) } -> std::same_as<typename B::tensor>;
  { B::where_less(a, a, a, a) } -> std::same_as<typename B::tensor>;
  { B::sum(a, axis) } -> std::same_as<typename B::tensor>;
  { B::max(a, axis) } -> std::same_as<typename B::tensor>;
  { B::matmul(a, a, true, false) } -> std::same_as<typename B::tensor>;
  { B::reshape(a, s) } -> std::same_as<typename B::tensor>;
  { B::permute(a, axes) } -> std::same_as<typename B::tensor>;
  { B::broadcast(a, s) } -> std::same_as<typename B::tensor>;
  { B::slice(a, axis, n, n) } -> std::same_as<typename B::tensor>;
  { B::concat(list, axis) } -> std::same_as<typename B::tensor>;
  { B::gather(a, rows) } -> std::same_as<typename B::tensor>;
  { B::scatter_add(a, rows, n) } -> std::same_as<typename B::tensor>;
};

/// A backend whose tensors remember how they were made, so that `backward` can differentiate.
/// Laws     values equal those of `B::inner`; gradients equal central differences (tests/ops)
/// Models   Autodiff<B>
template <class B>
concept AutodiffBackend = Backend<B> && Backend<typename B::inner> && requires(const typename B::tensor a) {
  { B::value(a) } -> std::convertible_to<typename B::inner::tensor>;
  { B::variable(B::value(a)) } -> std::same_as<typename B::tensor>;
};

/// A backend with a layout of its own for the weights of linear layers, (out, in), and of convolutions, (out, in,
/// taps). prepare(weight, precision) keeps this layout beside the tensor, which must not change afterwards. It returns
/// true if all values are finite, which it checks while it reads them. precision_of(weight) is that of its products.
/// Laws     `linear` and `conv1d` of a prepared weight give the same bits (tests/unit/tensor/module.cpp)
/// Models   EigenBackend<S>, XtensorBackend<S>
template <class B>
concept PackingBackend = Backend<B> && requires(const typename B::tensor weight, Precision precision) {
  { B::prepare(weight, precision) } -> std::same_as<bool>;
  { B::precision_of(weight) } -> std::same_as<Precision>;
};

/// A type with parameters: `fields()` lists pairs (name, pointer to member); names are the official state-dict keys.
/// Saving, loading, optimising, counting and conversion between backends all follow from it (core/fields.hpp).
/// Laws     names are unique; visiting twice gives the same paths in the same order
template <class M>
concept Module = requires {
  M::fields();
};

/// A source of random numbers. It is passed to functions and never global.
/// Laws     equal seeds give equal numbers; split(name) depends on the seed and the name only, not on what was drawn
/// Models   Philox
template <class G>
concept Rng = std::copyable<G> &&
    requires(G g, const G& c, std::span<float> out, std::string_view name, std::uint64_t number) {
  g.normal(out);
  g.uniform(out);
  { c.split(name) } -> std::same_as<G>;
  { c.split(number) } -> std::same_as<G>;
};

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

// core
class error;
class Offsets;
class Progress;
struct Context;
struct Philox;
template <Scalar S>
struct Dual;
template <Scalar S, int bytes>
struct Lane;

// tensor
template <Backend B, int Rank>
class Tensor;
template <Backend B>
struct Sequences;
template <AutodiffBackend A>
class Gradients;

// backend
template <Scalar S>
struct ReferenceBackend;
template <Scalar S>
struct EigenBackend;
template <Scalar S>
struct XtensorBackend;
template <Backend B>
struct Autodiff;

// geometry
template <class S>
struct Vec3;
template <class S>
struct Quaternion;
template <class S>
struct Matrix3;
template <class S>
struct AxisAngle;
template <class S>
struct EulerAngles;
template <class S>
struct Rigid;

// kinematics
class BodyPartition;
struct BodyParts;
struct Motion;
struct Skeleton;
template <ScalarLike S>
struct Pose;

// features
struct FeatureLayout;
struct IndexRange;
template <Backend B>
struct Normalizer;

// nn, text
template <Backend B>
struct Embedding;
template <Backend B>
struct LayerNorm;
template <Backend B>
struct Linear;
template <Backend B>
struct MultiheadAttention;
template <Backend B>
struct TransformerDecoder;
template <Backend B>
struct TransformerEncoder;
template <Backend B>
struct TextFeatures;
template <Backend B>
struct CaptionEncoder;
class WordPiece;

// diffusion, optim
class GaussianDiffusion;
template <Backend B>
struct MdmDenoiser;
template <Backend B>
struct MdmSmplDenoiser;
template <Backend B>
struct MotionDiffuseDenoiser;
template <AutodiffBackend A>
class AdamW;

// autoencoders and their systems
template <Backend B>
struct LatentGaussian;
template <Backend B>
struct LossTerms;
template <Backend B>
struct Actor;
struct ActorConfig;
template <Backend B>
struct StGcn;
template <Backend B>
struct GruClassifier;
template <Backend B>
struct Temos;
struct TemosConfig;
template <Backend B>
struct Tmr;
struct TmrConfig;
template <Backend B>
struct Teach;
struct TeachConfig;
template <Backend B>
struct Sinc;
struct SincConfig;

// compose
template <class T>
struct BasicInterval;
template <class T>
struct BasicTimeline;
using Interval = BasicInterval<Index>;
using Timeline = BasicTimeline<Index>;
using IntervalInSeconds = BasicInterval<double>;
using TimelineInSeconds = BasicTimeline<double>;
struct StmcOptions;

MOTIONLANG_NAMESPACE_END
#endif
