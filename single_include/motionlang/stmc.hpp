// SPDX-License-Identifier: MIT
/// motionlang 0.2.0, generated from include/ by tests/tools/amalgamate.cpp. Changes belong there.
#if !defined(MOTIONLANG_TEXT_BACKEND_DETAIL_KERNELS_INC)
#ifndef MOTIONLANG_SINGLE_STMC_HPP
#define MOTIONLANG_SINGLE_STMC_HPP

#ifndef MOTIONLANG_HAS_STMC_HPP  // <motionlang/stmc.hpp>
#define MOTIONLANG_HAS_STMC_HPP
/// Everything to turn a timeline of texts into a motion: include this one.
///
///     namespace ml = motionlang;
///     using B = ml::EigenBackend<float>;
///     const auto stmc = ml::load_stmc<B>("stmc_free.safetensors");
///     const auto timeline = ml::parse_timeline("walk forward # 0.0 # 6.0 # legs\n"
///                                              "raise both arms # 2.0 # 5.0 # left arm # right arm\n");
///     const ml::Motion motion = ml::generate_motion(stmc, timeline, {.seed = 7});
///
/// stmc.generate and stmc_motion give the model's own output, without smoothing and foot fixing. Writers of
/// BVH, GLB, NPZ and pages are in <motionlang/formats/...> and <motionlang/view/...>. Who calculates with the features
/// (exp, max, ...) includes <motionlang/backend/eigen.hpp> as well; the compiler says so.
///
/// Linking motionlang::instantiated compiles several times faster: Stmc over EigenBackend<float> is in the library
/// then, and this header only says what can be called. For other backends, and for `generate_from`, include
/// <motionlang/generate/generate_motion.ipp> and <motionlang/weights/stmc_file.hpp> as well; the compiler says so.

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_EIGEN_CLASS_HPP  // <motionlang/backend/detail/eigen_class.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_EIGEN_CLASS_HPP
/// The part of the Eigen backend that a model needs: its operations, and bodies of the kernels, arithmetic among
/// them. Those that include Eigen, functions and maxima, come with <motionlang/backend/eigen.hpp>.

#ifndef MOTIONLANG_HAS_BACKEND_DENSE_OPS_HPP  // <motionlang/backend/dense_ops.hpp>
#define MOTIONLANG_HAS_BACKEND_DENSE_OPS_HPP
/// Operations that all backends over Dense storage share: making tensors, moving values, and how a reduction
/// is shared by threads.

#include <algorithm>  // fill, min
#include <array>      // strides
#include <cstring>    // memcpy

#ifndef MOTIONLANG_HAS_BACKEND_DENSE_HPP  // <motionlang/backend/dense.hpp>
#define MOTIONLANG_HAS_BACKEND_DENSE_HPP
/// Dense row-major storage: the tensor type of the reference, Eigen and xtensor backends.
///
/// A handle to a shared buffer plus a shape. Copying shares memory; whoever wants to write asks `unique()` first.
/// Always contiguous: reshaping and taking leading rows are views, everything else copies.

#include <span>       // values
#include <utility>    // exchange

#ifndef MOTIONLANG_HAS_CORE_BUFFER_POOL_HPP  // <motionlang/core/buffer_pool.hpp>
#define MOTIONLANG_HAS_CORE_BUFFER_POOL_HPP
/// Memory of tensors: counted buffers that are kept for reuse when nobody needs them any more.
///
/// Fresh pages cost more than the arithmetic that fills them (64 MiB: 26 ms). A loop that repeats the same computation
/// finds all its buffers in the pool from the second round on and takes nothing from the system.

#include <atomic>       // reference counts
#include <bit>          // bit_width
#include <cstddef>      // byte
#include <cstdint>      // sizes
#include <memory>       // owner of foreign memory
#include <new>          // objects in memory that is there
#include <type_traits>  // is_trivially_copyable

#ifndef MOTIONLANG_HAS_CORE_ERROR_HPP  // <motionlang/core/error.hpp>
#define MOTIONLANG_HAS_CORE_ERROR_HPP
/// Errors: one hierarchy, one id for each kind of failure, one place that throws, one that catches.
///
/// Without exceptions (-fno-exceptions) an error prints its message and ends the program, unless
/// MOTIONLANG_THROW(exception) is defined, the same in all units: it gets the exception as an object (an error,
/// std::bad_alloc, cancelled), on whichever thread it happens, and must not return; std::_Exit ends a program from any
/// thread. What is caught otherwise (a value in a file of weights that cannot be read is skipped) ends it too.
///
/// A message reads `[motionlang.shape.201] matmul: inner sizes differ: lhs (2, 60, 512), rhs (256, 1024); at
/// layers.3.linear1`: family and id, the operation, what is wrong with both values, and (with MOTIONLANG_DIAGNOSTICS)
/// the module path. Text of files stands in it without control characters, and is UTF-8. The list of ids is `error_ids`
/// below; every one has a test.

#include <concepts>          // integral, floating_point
#include <cstdio>            // fputs
#include <cstdlib>           // abort
#include <initializer_list>  // parts of a message
#include <limits>            // whole numbers
#include <stdexcept>         // runtime_error
#include <string>            // string
#include <string_view>       // string_view
#include <vector>            // diagnostics path

#ifndef MOTIONLANG_HAS_CORE_STANDARD_LIBRARY_HPP  // <motionlang/core/standard_library.hpp>
#define MOTIONLANG_HAS_CORE_STANDARD_LIBRARY_HPP
/// The parts of C++20 that libc++ lacks, on macOS, in WebAssembly and on Linux: `bit_cast` (before libc++ 14),
/// `from_chars` and `to_chars` of floating-point values. The same bits and the same characters as with every other
/// standard library.

#include <charconv>  // from_chars, to_chars

#ifndef MOTIONLANG_HAS_VERSION_HPP  // <motionlang/version.hpp>
#define MOTIONLANG_HAS_VERSION_HPP
/// Version of the library and the inline namespace that carries it.

#if __cplusplus < 202002L
#error "motionlang needs C++20: compile with -std=c++20 (GCC 12 or Clang 14 and later)"
#endif

#define MOTIONLANG_VERSION_MAJOR 0
#define MOTIONLANG_VERSION_MINOR 2
#define MOTIONLANG_VERSION_PATCH 0
#define MOTIONLANG_VERSION "0.2.0"

/// Every public name lives in `motionlang`, inside this inline namespace. The tag changes with options that change
/// layouts, and without exceptions, so that object files built with different options do not link silently against each
/// other.
#if defined(MOTIONLANG_DIAGNOSTICS) && defined(__cpp_exceptions)
#define MOTIONLANG_ABI v0_diag
#elif defined(MOTIONLANG_DIAGNOSTICS)
#define MOTIONLANG_ABI v0_diag_no_exceptions
#elif defined(__cpp_exceptions)
#define MOTIONLANG_ABI v0
#else
#define MOTIONLANG_ABI v0_no_exceptions
#endif

/// In front of every definition in a file *.ipp, which has the bodies of the header of the same name. Without
/// motionlang::instantiated, the header includes it and all are inline. With it, units see declarations only, and the
/// library's own units (instantiated/*.cpp) include the files *.ipp.
#define MOTIONLANG_BODY inline

/// Opens and closes the namespace of the library. A macro, so that editors, clang-format and ctags need not know of the
/// inline namespace: `ctags -R include` finds every name.
#define MOTIONLANG_NAMESPACE_BEGIN \
  namespace motionlang {           \
  inline namespace MOTIONLANG_ABI {
#define MOTIONLANG_NAMESPACE_END \
  }                              \
  }
#endif

#ifndef __cpp_lib_to_chars

#ifndef MOTIONLANG_HAS_CORE_DETAIL_DECIMAL_HPP  // <motionlang/core/detail/decimal.hpp>
#define MOTIONLANG_HAS_CORE_DETAIL_DECIMAL_HPP
/// Floating-point values as decimal text, by the C library alone: for standard libraries without `from_chars` and
/// `to_chars` for them (standard_library.hpp), whose results these functions give to the last character.
///
/// strtod and printf of all C libraries round correctly, but their decimal point is the locale's. So strtod reads whole
/// numbers with an exponent here, and whatever printf writes between digits is taken for a point. Slower than
/// `to_chars`: a microsecond or two for a value.

#include <cassert>       // formats
#include <cmath>         // signbit, isfinite
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

/// Begins with `word` in letters of any case?
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

/// The exponent at `p`, which is moved behind it; 0 if there is none.
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

/// The number at `p`, which is moved behind it; no digits if there is none.
inline Decimal read_digits(const char*& p, const char* last) {
  // More digits never decide: no value halfway between two doubles has more than 767. It only matters whether they are
  // all zero, and one digit says so.
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

/// The text that printf wrote, with a point in place of the locale's, which may have several bytes.
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

/// x > 0 to `count` digits, the nearest such number.
inline Decimal rounded_decimal(double x, int count) {
  const std::string text = printed("%.*e", count - 1, x);
  const std::size_t e = text.find('e');
  Decimal out{text.substr(0, 1), static_cast<int>(std::strtol(text.c_str() + e + 1, nullptr, 10)) - (count - 1)};
  if (count > 1) out.digits += text.substr(2, e - 2);
  return out;
}

/// The next number of as many digits.
inline Decimal next_decimal(Decimal d) {
  std::size_t i = d.digits.size();
  while (i > 0 && d.digits[i - 1] == '9') d.digits[--i] = '0';
  if (i > 0)
    ++d.digits[i - 1];
  else
    d.digits.insert(0, 1, '1');
  return d;
}

/// The fewest digits that are read back as x > 0; the nearest to x of those.
template <class F>
Decimal shortest_decimal(F x) {
  // A number of digits10 digits survives the way through a normal F. So the shortest, if it has no more digits than
  // that, is what remains without the zeros at the end.
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
  // The digits of a whole number are all written as they are.
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
// Templates, because libc++ has some of the functions for floating-point values and deletes the others.
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

// MinGW's GCC gives the memory of thread_local variables back before it destroys them, so there the system keeps them.
#if defined(_WIN32) && !defined(__clang__)
#define MOTIONLANG_SYSTEM_KEEPS_THREAD_OBJECTS
extern "C" {
__declspec(dllimport) unsigned long __stdcall FlsAlloc(void(__stdcall* at_end)(void*));
__declspec(dllimport) void* __stdcall FlsGetValue(unsigned long key);
__declspec(dllimport) int __stdcall FlsSetValue(unsigned long key, void* value);
}
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The calling thread's T: made when it is first asked for, destroyed when the thread ends. `Tag` tells objects of one
/// type apart.
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
/// UTF-8: one code point at a time, strictly. Nothing here knows about classes of characters.

MOTIONLANG_NAMESPACE_BEGIN

/// The result of `decode_utf8` for bytes that are not UTF-8.
inline constexpr char32_t invalid_code_point = 0xFFFFFFFF;

/// The code point that starts at text[at]; moves `at` behind it. Bytes that are not UTF-8 (stray or missing
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

/// For messages and lists: '?' for control characters, which terminals obey, and for bytes that are not UTF-8. What is
/// in `keep` stays.
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
  if constexpr (std::floating_point<N>) {  // 10000000, not 1e+07: as far as whole numbers are exact
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

/// A value on its way into a message: where it stands and how it is written. One type for all values and one for
/// literals of all lengths, because messages are many and each would be compiled for its own list of types.
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

/// A module that is being evaluated. Its name is given, or known by the fields of the module around it.
struct ModuleStep {
  std::string name;
  const void* module = nullptr;  // null: the name is given
  const void* type = nullptr;    // tells a module from its first member, which lies in the same place
  /// Path from `module` to one inside of it, "" if it has none such.
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
  /// As long as it lives, the thread is inside the modules of another one, a part of whose work it does.
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

/// Text of all arguments, one after the other; numbers as `std::to_chars` writes them, whole ones without an exponent.
template <class... T>
std::string concat_text(const T&... parts) {
  return detail::concat_parts({detail::text_part(parts)...});
}

/// Items of a list with `between` between them, each as text(item) is written: "left, right".
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

/// A number of things: "1 frame", "2 frames"; of a word with another plural: counted(n, "pass", "passes").
template <std::integral N>
std::string counted(N n, std::string_view one, std::string_view several = {}) {
  std::string out = concat_text(n, ' ', n == 1 || several.empty() ? one : several);
  if (n != 1 && several.empty()) out += 's';
  return out;
}

/// Names the module that is evaluated as long as the object lives: ModuleScope scope(*this) in its functions, or the
/// text of all arguments. Costs nothing unless MOTIONLANG_DIAGNOSTICS is set.
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

/// The one place that catches: calls f; handle(e), called with what it throws of type E, says whether that ends here
/// (true) or goes on to the caller. Returns whether f came to its end.
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
/// The same for whatever it throws: handle() sees std::current_exception().
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

#ifndef MOTIONLANG_HAS_CORE_LIFETIME_HPP  // <motionlang/core/lifetime.hpp>
#define MOTIONLANG_HAS_CORE_LIFETIME_HPP
/// Help against memory that is used after it was freed: a mark for compilers, and marks of free memory for the address
/// sanitizer.

/// Marks a member function or a parameter to which the result refers. Clang warns if it is a temporary, or a local
/// variable of a function that returns the result. GCC has no such mark.
#if defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::lifetimebound)
#define MOTIONLANG_LIFETIMEBOUND [[clang::lifetimebound]]
#endif
#endif
#ifndef MOTIONLANG_LIFETIMEBOUND
#define MOTIONLANG_LIFETIMEBOUND
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// True if this unit is compiled for the address sanitizer (-fsanitize=address).
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool address_sanitizer = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool address_sanitizer = true;
#else
inline constexpr bool address_sanitizer = false;
#endif
#else
inline constexpr bool address_sanitizer = false;
#endif

/// Forbids the use of memory until allow_access: the sanitizer reports every use. Without the sanitizer these calls do
/// nothing.
void forbid_access(const void* memory, std::size_t bytes);
void allow_access(const void* memory, std::size_t bytes);

}  // namespace detail
MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_LIFETIME_IPP  // <motionlang/core/lifetime.ipp>
#define MOTIONLANG_HAS_CORE_LIFETIME_IPP
// Bodies of lifetime.hpp.

// Functions of the sanitizer.
extern "C" {
void __asan_poison_memory_region(const volatile void* memory, std::size_t bytes);    // NOLINT
void __asan_unpoison_memory_region(const volatile void* memory, std::size_t bytes);  // NOLINT
}

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

MOTIONLANG_BODY void forbid_access([[maybe_unused]] const void* memory, [[maybe_unused]] std::size_t bytes) {
  if constexpr (address_sanitizer) __asan_poison_memory_region(memory, bytes);
}

MOTIONLANG_BODY void allow_access([[maybe_unused]] const void* memory, [[maybe_unused]] std::size_t bytes) {
  if constexpr (address_sanitizer) __asan_unpoison_memory_region(memory, bytes);
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Header of a buffer. The data follow it, 64 bytes aligned, or lie elsewhere (memory-mapped weights).
struct alignas(64) Buffer {
  std::atomic<std::int64_t> references{1};
  void* data = nullptr;
  int bucket = -1;                     // -1: not from a pool
  std::uint32_t pool = 0;              // number of the pool that made it
  Buffer* next = nullptr;              // in a free list
  std::shared_ptr<const void> owner;   // keeps foreign memory alive
  std::shared_ptr<const void> packed;  // the same numbers in the layout of a kernel (see Dense::attach)
};

}  // namespace detail

/// Free buffers of this thread, in buckets of four sizes per power of two. A pool keeps only what it made itself:
/// buffers that one thread makes and another frees do not pile up. Once the pool of an ending thread is gone, memory
/// comes from the system and returns to it. Under the address sanitizer, who uses a free buffer is reported.
class BufferPool {
 public:
  static BufferPool& local() { return thread_object<BufferPool>(); }

  /// A buffer of at least this many bytes, and its way back, for the calling thread.
  static detail::Buffer* take(std::size_t bytes) {
    const int bucket = bucket_of(bytes);
    return gone_ ? make(bucket, bytes, 0) : local().reuse(bucket, bytes);
  }
  static void give_back(detail::Buffer* b) {
    if (gone_ || b->pool != local().number_) return release(b);
    b->packed.reset();
    if constexpr (detail::address_sanitizer) detail::forbid_access(b->data, bucket_bytes(b->bucket));
    b->next = std::exchange(local().free_[static_cast<std::size_t>(b->bucket)], b);
  }

  /// Returns all free buffers to the system.
  void trim();

  /// How often this pool had to ask the system. Stands still in a loop that has settled.
  std::int64_t system_allocations() const { return system_allocations_; }

  static void release(detail::Buffer* b);

  BufferPool(const BufferPool&) = delete;
  BufferPool& operator=(const BufferPool&) = delete;

 private:
  template <class T, class Tag>
  friend T& thread_object();
  BufferPool() = default;
  ~BufferPool();

  detail::Buffer* reuse(int bucket, std::size_t bytes) {
    detail::Buffer*& head = free_[static_cast<std::size_t>(bucket)];
    if (head != nullptr) {
      detail::Buffer* b = std::exchange(head, head->next);
      b->references.store(1, std::memory_order_relaxed);
      if constexpr (detail::address_sanitizer) detail::allow_access(b->data, bucket_bytes(bucket));
      return b;
    }
    ++system_allocations_;
    return make(bucket, bytes, number_);
  }
  static detail::Buffer* make(int bucket, std::size_t bytes, std::uint32_t pool);

  // Sizes 64 * {4, 5, 6, 7} * 2^k: at most a quarter of a buffer is unused.
  static int bucket_of(std::size_t bytes) {
    const std::size_t units = (bytes + 63) / 64 < 4 ? 4 : (bytes + 63) / 64;
    const int shift = static_cast<int>(std::bit_width(units)) - 3;
    const std::size_t quarter = (units + (std::size_t{1} << shift) - 1) >> shift;  // 4 ... 8
    return shift * 4 + static_cast<int>(quarter) - 4;
  }
  static std::size_t bucket_bytes(int bucket) {
    return static_cast<std::size_t>(64 * (4 + bucket % 4)) << static_cast<unsigned>(bucket / 4);
  }

  std::array<detail::Buffer*, 4 * 62> free_{};
  std::int64_t system_allocations_ = 0;
  std::uint32_t number_ = ++pools_;

  inline static std::atomic<std::uint32_t> pools_{0};
  inline static thread_local bool gone_ = false;  // a static model may be destroyed after the pool of main's thread
};

namespace detail {

/// Shared handle of a buffer.
class BufferHandle {
 public:
  BufferHandle() = default;
  explicit BufferHandle(std::size_t bytes) : buffer_(BufferPool::take(bytes)) {}
  /// Memory that belongs to somebody else and is only read.
  BufferHandle(const void* data, std::shared_ptr<const void> owner) : buffer_(new (std::align_val_t{64}) Buffer) {
    buffer_->data = const_cast<void*>(data);
    buffer_->owner = std::move(owner);
  }
  BufferHandle(const BufferHandle& o) noexcept : buffer_(o.buffer_) {
    if (buffer_ != nullptr) buffer_->references.fetch_add(1, std::memory_order_relaxed);
  }
  BufferHandle(BufferHandle&& o) noexcept : buffer_(std::exchange(o.buffer_, nullptr)) {}
  BufferHandle& operator=(BufferHandle o) noexcept {
    std::swap(buffer_, o.buffer_);
    return *this;
  }
  ~BufferHandle() {
    if (buffer_ == nullptr || buffer_->references.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    if (buffer_->bucket >= 0)
      BufferPool::give_back(buffer_);
    else
      ::operator delete (destroyed(buffer_), std::align_val_t{64});
  }

  void* data() const MOTIONLANG_LIFETIMEBOUND { return buffer_ == nullptr ? nullptr : buffer_->data; }
  /// Nobody else sees this memory, and it may be written.
  bool unique() const {
    return buffer_ != nullptr && buffer_->bucket >= 0 && buffer_->references.load(std::memory_order_acquire) == 1;
  }
  std::shared_ptr<const void>& packed() const { return buffer_->packed; }
  explicit operator bool() const { return buffer_ != nullptr; }

 private:
  static void* destroyed(Buffer* b) {
    b->~Buffer();
    return b;
  }
  Buffer* buffer_ = nullptr;
};

}  // namespace detail

/// A list of values in memory of the pool: cheap to make again and again in a loop. Does what such lists are for and no
/// more (a std::vector over an allocator would be compiled with sixty functions for every type).
template <class T>
class PoolVector {
  static_assert(std::is_nothrow_move_constructible_v<T> && alignof(T) <= 64,
                "motionlang::PoolVector: values that move without fail, in memory aligned to 64 bytes");

 public:
  using value_type = T;

  PoolVector() = default;
  explicit PoolVector(std::size_t size, const T& value = T{}) {
    reserve(size);
    for (; size_ < size; ++size_) ::new (static_cast<void*>(data_ + size_)) T(value);
  }
  PoolVector(PoolVector&& o) noexcept
      : memory_(std::move(o.memory_)),
        data_(std::exchange(o.data_, nullptr)),
        size_(std::exchange(o.size_, 0)),
        capacity_(std::exchange(o.capacity_, 0)) {}
  PoolVector& operator=(PoolVector&&) = delete;
  ~PoolVector() {
    for (std::size_t i = 0; i < size_; ++i) data_[i].~T();
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T* begin() { return data_; }
  const T* begin() const { return data_; }
  T* end() { return data_ + size_; }
  const T* end() const { return data_ + size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

  void reserve(std::size_t capacity) {
    if (capacity <= capacity_) return;
    if (capacity > SIZE_MAX / 2 / sizeof(T)) detail::raise_bad_alloc();
    detail::BufferHandle larger(capacity * sizeof(T));
    T* to = static_cast<T*>(larger.data());
    for (std::size_t i = 0; i < size_; ++i) {
      ::new (static_cast<void*>(to + i)) T(std::move(data_[i]));
      data_[i].~T();
    }
    memory_ = std::move(larger);
    data_ = to;
    capacity_ = capacity;
  }
  void push_back(T value) {
    if (size_ == capacity_) reserve(size_ < 32 ? 64 : 2 * size_);
    ::new (static_cast<void*>(data_ + size_++)) T(std::move(value));
  }

 private:
  detail::BufferHandle memory_;
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_BUFFER_POOL_IPP  // <motionlang/core/buffer_pool.ipp>
#define MOTIONLANG_HAS_CORE_BUFFER_POOL_IPP
// Bodies of buffer_pool.hpp.

#ifndef MOTIONLANG_HAS_CORE_LARGE_MEMORY_HPP  // <motionlang/core/large_memory.hpp>
#define MOTIONLANG_HAS_CORE_LARGE_MEMORY_HPP
/// Memory for what is read from end to end again and again, weights and tables: in pages of 2 MB where the system has
/// them (Linux). Between small pages the processor stops to read ahead; a scan over large ones is up to 1.8 times as
/// fast. It comes from the system itself and goes back there: a heap that mixes alignments of 2 MB with small things
/// keeps the gaps (a quarter of the weights).

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The largest of the small ones that Linux has: addresses of which none is used cost nothing.
inline constexpr std::size_t small_page = 65536, large_page = std::size_t{2} << 20;

constexpr std::size_t rounded_up(std::size_t bytes, std::size_t unit) { return (bytes + unit - 1) / unit * unit; }

}  // namespace detail

/// `bytes` bytes at a multiple of 64, not initialised; `used` of them from the start will be written, mostly in
/// large pages.
void* take_memory(std::size_t bytes, std::size_t used);

/// Gives back what take_memory(bytes, ...) gave.
void give_memory(void* memory, std::size_t bytes) noexcept;

/// Room for `count` numbers, not initialised.
template <class T>
std::shared_ptr<T[]> large_table(std::size_t count) {
  const std::size_t bytes = count * sizeof(T);
  return {static_cast<T*>(take_memory(bytes, bytes)), [bytes](T* p) { give_memory(p, bytes); }};
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_LARGE_MEMORY_IPP  // <motionlang/core/large_memory.ipp>
#define MOTIONLANG_HAS_CORE_LARGE_MEMORY_IPP
// Bodies of large_memory.hpp.

#if defined(__linux__)
#include <sys/mman.h>  // mmap, madvise
#elif defined(_WIN32)
#include <malloc.h>  // _aligned_malloc
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void* take_memory(std::size_t bytes, [[maybe_unused]] std::size_t used) {
#if defined(__linux__)
  if (bytes >= detail::large_page) {
    const std::size_t whole = detail::rounded_up(bytes, detail::small_page), room = whole + detail::large_page;
    void* start = ::mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start == MAP_FAILED) detail::raise_bad_alloc();
    const auto address = reinterpret_cast<std::uintptr_t>(start);
    const std::size_t before = detail::rounded_up(address, detail::large_page) - address, after = room - whole - before;
    std::byte* memory = static_cast<std::byte*>(start) + before;
    if (before > 0) ::munmap(start, before);
    if (after > 0) ::munmap(memory + whole, after);
    // a page that is partly used would be taken whole
    const std::size_t large = used / detail::large_page * detail::large_page;
    ::madvise(memory, large, MADV_HUGEPAGE);
    ::madvise(memory + large, whole - large, MADV_NOHUGEPAGE);  // where the system takes large pages for everything
    return memory;
  }
#endif
#if defined(_WIN32)
  void* memory = ::_aligned_malloc(bytes + 1, 64);
#else
  void* memory = std::aligned_alloc(64, detail::rounded_up(bytes + 1, 64));
#endif
  if (memory == nullptr) detail::raise_bad_alloc();
  return memory;
}

MOTIONLANG_BODY void give_memory(void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__linux__)
  if (bytes >= detail::large_page) {
    ::munmap(memory, detail::rounded_up(bytes, detail::small_page));
    return;
  }
#endif
#if defined(_WIN32)
  ::_aligned_free(memory);
#else
  std::free(memory);
#endif
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void BufferPool::trim() {
  for (auto& head : free_) {
    while (head != nullptr) release(std::exchange(head, head->next));
  }
}

MOTIONLANG_BODY void BufferPool::release(detail::Buffer* b) {
  const int bucket = b->bucket;
  if constexpr (detail::address_sanitizer) detail::allow_access(b->data, bucket_bytes(bucket));
  b->~Buffer();
  give_memory(b, sizeof(detail::Buffer) + bucket_bytes(bucket));
}

MOTIONLANG_BODY BufferPool::~BufferPool() {
  gone_ = true;
  trim();
}

MOTIONLANG_BODY detail::Buffer* BufferPool::make(int bucket, std::size_t bytes, std::uint32_t pool) {
  void* memory = take_memory(sizeof(detail::Buffer) + bucket_bytes(bucket), sizeof(detail::Buffer) + bytes);
  auto* b = new (memory) detail::Buffer;
  b->data = static_cast<std::byte*>(memory) + sizeof(detail::Buffer);
  b->bucket = bucket;
  b->pool = pool;
  return b;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_CORE_CONCEPTS_HPP  // <motionlang/core/concepts.hpp>
#define MOTIONLANG_HAS_CORE_CONCEPTS_HPP
/// The concepts on which everything rests. Each one states: idea, what a model must provide, the laws (run on every
/// model in tests/laws), and the models.

#ifndef MOTIONLANG_HAS_CORE_SCALAR_MATH_HPP  // <motionlang/core/scalar_math.hpp>
#define MOTIONLANG_HAS_CORE_SCALAR_MATH_HPP
/// The elementary functions of `ScalarLike` types, for the built-in ones.
///
/// Geometry is written once for float, double, dual numbers, SIMD lanes and tensors. Name lookup by argument finds
/// `sqrt(Tensor)`, but not `std::sqrt` for a built-in number: hence these overloads, which must be visible first.

#include <cmath>   // the functions themselves

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
/// from that of the C library. Published tables of frequencies need it: after thousands of frames it decides the fourth
/// digit.
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

/// `a < b ? x : y`, which also works element by element. Both x and y are always computed. If the result is to be
/// differentiated, neither may be NaN, even where it is not taken.
constexpr double where_less(double a, double b, double x, double y) { return a < b ? x : y; }
constexpr float where_less(float a, float b, float x, float y) { return a < b ? x : y; }

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_SHAPE_HPP  // <motionlang/core/shape.hpp>
#define MOTIONLANG_HAS_CORE_SHAPE_HPP
/// Sizes of a tensor, stored inline, and the broadcasting rule.

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes, positions and counts. Signed, so that differences are what they look like.
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

/// "(2, 60, 512)"; a negative size stands for any.
std::string shape_text(std::span<const Index> sizes);

}  // namespace detail

/// "(2, 60, 512)"
inline std::string to_string(const Shape& s) { return detail::shape_text(s.sizes()); }

/// Axis counted from the end when negative; an error when out of range.
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

/// Something that calculates like a number: geometry needs nothing more.
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

/// Where tensors live and how they are calculated with: a scalar, a dense tensor type and 28 static operations.
///
/// `tensor` is a cheap handle with value semantics and dynamic rank; operands are taken by value, so that an operation
/// may reuse the memory of one that nobody else holds. Shapes have been checked by the caller (tensor/ops.hpp): a
/// backend only computes. Everything else (softmax, attention, ...) has a default in these primitives; a backend may
/// add its own version under the same name (see tensor/fused.hpp).
///
/// tensor    can be default-constructed, copied and moved. A default-constructed tensor has the shape (0), and to_span
///           gives nothing. One that was moved from is the same. Tensor<B, Rank> refuses such a tensor before
///           an operation of the backend sees it. A list of no values has the shape (0) too; `bool defined() const`,
///           if the tensor has it, tells one from the other
/// Minimum   data      full, from_span, to_span, shape
///           elements  add sub mul div maximum atan2 (broadcasting), exp log sqrt tanh erf sin cos, where_less
///           reduce    sum max (one axis, which disappears)
///           product   matmul(a, b, transpose_a, transpose_b), equal leading axes
///           movement  reshape permute broadcast slice concat gather scatter_add
/// Left out  which device, threads, in-place operations, other scalars than float and double, views of memory of others
/// Laws      every operation equals the one of ReferenceBackend (tests/ops); operands are never changed visibly; the
///           algebra of tests/laws. examples/11_own_backend has a backend of one's own, and how to run the laws on it
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
/// taps): prepare(weight) keeps the weight in it beside the tensor, which must not change afterwards, and says whether
/// all numbers are finite, which are read anyway.
/// Laws     `linear` and `conv1d` of a prepared weight give the same bits (tests/unit/tensor/module.cpp)
/// Models   EigenBackend<S>, XtensorBackend<S>
template <class B>
concept PackingBackend = Backend<B> && requires(const typename B::tensor weight) {
  { B::prepare(weight) } -> std::same_as<bool>;
};

/// A type with parameters: `fields()` lists pairs (name, pointer to member); names are the official state-dict keys.
/// Saving, loading, optimising, counting and conversion between backends all follow from it (core/fields.hpp).
/// Laws     names are unique; visiting twice gives the same paths in the same order
template <class M>
concept Module = requires {
  M::fields();
};

/// A source of random numbers that is passed, never global.
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

template <Scalar S>
class Dense {
 public:
  /// Nothing yet: an empty list.
  Dense() = default;
  /// Uninitialised.
  explicit Dense(const Shape& shape) : buffer_(static_cast<std::size_t>(shape.count()) * sizeof(S)), shape_(shape) {}
  /// Numbers that somebody else owns and nobody writes (a mapped file).
  Dense(const S* values, const Shape& shape, std::shared_ptr<const void> owner)
      : buffer_(values, std::move(owner)), shape_(shape) {}

  Dense(const Dense&) = default;
  Dense& operator=(const Dense&) = default;
  /// A tensor that was moved from holds nothing.
  Dense(Dense&& o) noexcept
      : buffer_(std::move(o.buffer_)), shape_(std::exchange(o.shape_, nothing)), offset_(std::exchange(o.offset_, 0)) {}
  Dense& operator=(Dense&& o) noexcept {
    buffer_ = std::move(o.buffer_);
    shape_ = std::exchange(o.shape_, nothing);
    offset_ = std::exchange(o.offset_, 0);
    return *this;
  }
  ~Dense() = default;

  static Dense full(const Shape& shape, S value) {
    Dense d(shape);
    std::fill_n(d.data(), d.count(), value);
    return d;
  }
  static Dense from_span(std::span<const S> values, const Shape& shape) {
    Dense d(shape);
    std::copy(values.begin(), values.end(), d.data());
    return d;
  }

  const Shape& shape() const MOTIONLANG_LIFETIMEBOUND { return shape_; }
  Index count() const { return shape_.count(); }
  const S* data() const MOTIONLANG_LIFETIMEBOUND { return static_cast<const S*>(buffer_.data()) + offset_; }
  /// For writing: only right after construction or when `unique()`.
  S* data() MOTIONLANG_LIFETIMEBOUND { return static_cast<S*>(buffer_.data()) + offset_; }
  std::span<const S> span() const MOTIONLANG_LIFETIMEBOUND { return {data(), static_cast<std::size_t>(count())}; }
  /// True if there is a tensor, perhaps an empty one; else nothing is made yet, or it was moved from.
  bool defined() const { return static_cast<bool>(buffer_); }

  /// Nobody else can see the numbers, so an operation may overwrite them.
  bool unique() const { return buffer_.unique() && !buffer_.packed(); }

  /// The same numbers in another shape of the same count.
  Dense reshaped(const Shape& shape) const {
    Dense d(*this);
    d.shape_ = shape;
    return d;
  }
  /// Leading indices first ... last-1, without copying.
  Dense rows(Index first, Index last) const {
    Dense d(*this);
    d.offset_ += first * shape_.count(1, shape_.rank());
    d.shape_[0] = last - first;
    return d;
  }

  /// Attaches the same numbers in the layout of a kernel. They live and die with the buffer.
  void attach(std::shared_ptr<const void> packed) const { buffer_.packed() = std::move(packed); }
  const void* attached() const { return buffer_ && offset_ == 0 ? buffer_.packed().get() : nullptr; }

 private:
  static constexpr Shape nothing{0};

  detail::BufferHandle buffer_;
  Shape shape_ = nothing;
  Index offset_ = 0;
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_PARALLEL_HPP  // <motionlang/core/parallel.hpp>
#define MOTIONLANG_HAS_CORE_PARALLEL_HPP
/// A small pool of threads and `parallel_for`, their number, and the objects that threads of a program may share.
///
/// How many   processor_count() threads calculate (core/processors.hpp: what the process is given, in a container too),
///            at most 256. set_thread_count(n) changes that for the whole process. The results are the same bits
/// From several threads of a program at once
///   may be shared    everything that is const: models, tensors, skeletons, indices, text encoders. Threads may
///                    copy and use handles of the same tensor. The pool serves one call at a time; other calls wait
///   may not          objects that change: a tensor that is assigned to, a generator that draws, an AdamW that steps, a
///                    KeptMotion that is filled. Give each thread its own, or a lock. A Context counts its masks, so
///                    each call needs its own
///   Autodiff         variables may be shared; operations behind a loss belong to the thread that calls `backward`
///   at rest          set_thread_count and set_product_precision (backend/precision.hpp): while no work is running
///
/// Work is split into tasks that never share a sum, and the result of a task does not depend on who runs it: one thread
/// and many give the same bits. Workers spin after a task (20,000 pauses: 0.2 to 1 millisecond, by the processor) and
/// then sleep, so that the many short regions of a transformer layer cost well below a microsecond each (on few cores)
/// while an idle program costs nothing.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Runs task(context, i) for i = 0 ... count-1 on all threads and returns when all are done.
void run_tasks(Index count, void (*task)(const void*, Index), const void* context);

}  // namespace detail

/// Threads that `parallel_for` uses, the caller included: processor_count(), at most 256, unless set.
int thread_count();

/// Threads that `parallel_for` uses here: one inside a task.
int parallel_width();

/// Number of the thread that runs a task of `parallel_for`: 0 ... thread_count()-1, different for those that run at
/// once.
int thread_number();

/// Changes the number of threads for the whole process. Not while work is running. Throws config_error 101.
void set_thread_count(int threads);

/// Calls f(i) for i = 0 ... count-1, in any order, on all threads. f must not depend on the order. Exceptions reach the
/// caller (the first one). Inside a task it runs serially.
template <class F>
void parallel_for(Index count, const F& f) {
  if (count <= 0) return;
  detail::run_tasks(
      count, [](const void* g, Index i) { (*static_cast<const F*>(g))(i); }, &f);
}

namespace detail {
inline constexpr Index worth_a_thread = 16384;  // numbers
}

/// Calls f(first, last) for pieces of 0 ... count-1. Work that is too small for two threads is one piece (`cost` values
/// per element). For large elements, such as rows, every thread gets the same share in each region, which is then still
/// in its cache. Pieces of single values begin at the same places for any number of threads, so full vectors and
/// remainders are the same.
template <class F>
void parallel_ranges(Index count, Index cost, const F& f) {
  const Index grain = std::max<Index>(1, detail::worth_a_thread / std::max<Index>(1, cost));
  const Index pieces = (count + grain - 1) / grain, threads = parallel_width();
  if (cost < 64 || pieces <= 1 || threads == 1)
    return parallel_for(pieces, [&](Index i) { f(i * grain, std::min(count, (i + 1) * grain)); });
  const Index equal = std::min(count, (pieces + threads - 1) / threads * threads);
  parallel_for(equal, [&](Index i) { f(count * i / equal, count * (i + 1) / equal); });
}

/// Calls f(first, last) for pieces of the columns 0 ... width-1 of a matrix with this many rows, for functions that go
/// through the rows in their order. Pieces begin at multiples of 16, so that whole vectors are the same for any number
/// of threads.
template <class F>
void parallel_columns(Index rows, Index width, const F& f) {
  const Index pieces = rows * width < detail::worth_a_thread ? 1 : std::clamp<Index>(width / 64, 1, parallel_width());
  const auto begin = [&](Index i) { return i == pieces ? width : width * i / pieces / 16 * 16; };
  parallel_for(pieces, [&](Index i) { f(begin(i), begin(i + 1)); });
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_PARALLEL_IPP  // <motionlang/core/parallel.ipp>
#define MOTIONLANG_HAS_CORE_PARALLEL_IPP
// Bodies of parallel.hpp.

#include <condition_variable>  // sleeping workers
#include <exception>           // exception_ptr: errors in tasks reach the caller
#include <mutex>               // sleeping workers
#include <system_error>        // no more threads
#include <thread>              // workers

#ifndef MOTIONLANG_HAS_CORE_PROCESSORS_HPP  // <motionlang/core/processors.hpp>
#define MOTIONLANG_HAS_CORE_PROCESSORS_HPP
/// The number of useful threads: the processors on which this process may run, limited by the processor time of its
/// control group (containers, batch systems). More threads would use up the group's time by waiting for each other, and
/// the system would then stop all of them.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Linux' control groups, version 2 and, where they are counted there, 1: `processes` names the group of
/// this process, and the folders of `root` hold its limits. A file that cannot be read sets no limit.
struct ControlGroups {
  std::string root = "/sys/fs/cgroup", processes = "/proc/self/cgroup";

  /// The smallest limit of the groups that this process is in, in processors, rounded up; at most `all`.
  int processors(int all) const;

 private:
  template <class F>
  static void for_lines(const std::string& path, const F& f);
  /// "quota period", both in microseconds, in one file or in two. A quota of "max" or -1 is unlimited.
  static int limit(const std::string& quota_file, const std::string& period_file, int all);
};

}  // namespace detail

/// The number of useful threads, at least 1.
int processor_count();

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_PROCESSORS_IPP  // <motionlang/core/processors.ipp>
#define MOTIONLANG_HAS_CORE_PROCESSORS_IPP
// Bodies of processors.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <class F>
void ControlGroups::for_lines(const std::string& path, const F& f) {
  std::FILE* const file = std::fopen(path.c_str(), "r");  // NOLINT(android-cloexec-fopen): C has no mode "e"
  if (file == nullptr) return;
  char text[4096];
  while (std::fgets(text, sizeof text, file) != nullptr) {
    std::string line(text);
    if (line.ends_with('\n')) line.pop_back();
    f(line);
  }
  std::fclose(file);
}

MOTIONLANG_BODY int ControlGroups::processors(int all) const {
  int least = all;
  for_lines(processes, [&](const std::string& line) {  // number:controllers:path
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) return;
    std::string controllers = line.substr(first, second - first + 1);
    controllers.front() = controllers.back() = ',';
    const bool second_version = controllers == ",,";
    if (!second_version && controllers.find(",cpu,") == std::string::npos) return;
    // The group, and those around it.
    for (std::string path = line.substr(second + 1);; path.resize(path.rfind('/'))) {
      if (path.ends_with('/')) path.pop_back();
      const std::string folder = root + (second_version ? "" : "/cpu") + path;
      least = std::min(least, second_version ? limit(folder + "/cpu.max", "", all)
                                             : limit(folder + "/cpu.cfs_quota_us", folder + "/cpu.cfs_period_us", all));
      if (path.find('/') == std::string::npos) break;
    }
  });
  return least;
}

MOTIONLANG_BODY int ControlGroups::limit(const std::string& quota_file, const std::string& period_file, int all) {
  double quota = 0, period = 0;
  // NOLINTBEGIN(cert-err34-c): what is not a number stays 0, which is not a limit
  for_lines(quota_file, [&](const std::string& line) { std::sscanf(line.c_str(), "%lf %lf", &quota, &period); });
  if (!period_file.empty())
    for_lines(period_file, [&](const std::string& line) { std::sscanf(line.c_str(), "%lf", &period); });
  // NOLINTEND(cert-err34-c)
  return quota > 0 && period > 0 ? static_cast<int>(std::clamp(std::ceil(quota / period), 1.0, 1.0 * all)) : all;
}

}  // namespace detail

MOTIONLANG_BODY int processor_count() {
  const int all = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
#if defined(__linux__)
  return detail::ControlGroups().processors(all);
#else
  return all;
#endif
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

class ThreadPool {
 public:
  static ThreadPool& instance() {
    static ThreadPool pool;
    return pool;
  }

  int size() const { return workers_ + 1; }
  /// Threads that `run` uses when it is called here: a task runs its own tasks alone.
  int width() const { return inside_ ? 1 : size(); }
  /// 0 for a thread that called `run`, 1 ... size-1 for the workers.
  static int number() { return number_; }

  void resize(int threads) {
    stop();
    shares_ = std::make_unique<Share[]>(static_cast<std::size_t>(threads));
    threads_ = std::make_unique<std::thread[]>(static_cast<std::size_t>(threads - 1));
    stopping_ = false;
    for (int i = 1; i < threads; ++i) {
      threads_[static_cast<std::size_t>(workers_)] = std::thread(start, this, i, round_.load());
      ++workers_;
    }
  }

  /// Runs task(context, i) for i = 0 ... count-1 on all threads and returns when all are done.
  void run(Index count, void (*task)(const void*, Index), const void* context) {
    if (count == 1 || workers_ == 0 || inside_) {
      for (Index i = 0; i < count; ++i) task(context, i);
      return;
    }
    std::scoped_lock only_one_caller(caller_);
    task_ = task;
    context_ = context;
    for (int t = 0; t < size(); ++t) {
      share(t).next.store(count * t / size(), std::memory_order_relaxed);
      share(t).end = count * (t + 1) / size();
    }
    pending_.store(workers_, std::memory_order_relaxed);
    {
      std::scoped_lock lock(sleep_);
      round_.fetch_add(1, std::memory_order_release);
    }
    if (asleep_.load() > 0) wake_.notify_all();
    take_tasks();
    for (int spins = 0; pending_.load(std::memory_order_acquire) != 0; ++spins) pause(spins);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

 private:
  static constexpr int spins_before_sleep = 20000;

  /// Tasks that a thread takes first; whoever has none left helps the others. Regions that split the same rows alike,
  /// one after the other, find them in the caches of the same thread.
  struct alignas(64) Share {
    std::atomic<Index> next{0};
    Index end = 0;
  };

  Share& share(int thread) { return shares_[static_cast<std::size_t>(thread)]; }

  ThreadPool() {
    const auto start = [&] { resize(std::min(processor_count(), 256)); };
    const auto no_more = [](const std::system_error&) { return true; };  // those threads that began will do
    guard<std::system_error>(start, no_more);
  }
  ~ThreadPool() { stop(); }

  static void pause(int spins) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
    if (spins % 1024 == 1023) std::this_thread::yield();  // more threads than cores: let the others finish
  }

  void stop() {
    {
      std::scoped_lock lock(sleep_);
      stopping_ = true;
      round_.fetch_add(1);
    }
    wake_.notify_all();
    for (; workers_ > 0; --workers_) threads_[static_cast<std::size_t>(workers_ - 1)].join();
  }

  /// The work of a thread. It is a function whose address std::thread takes: the code of a lambda would be a part of
  /// std::thread's, which a program and a shared library, each with its own copy of this pool and of `inside_`, have in
  /// common.
  static void start(ThreadPool* pool, int number, unsigned seen) {
    number_ = number;
    pool->work(seen);
  }
  void work(unsigned seen) {
    inside_ = true;
    for (;;) {
      int spins = 0;
      while (round_.load(std::memory_order_acquire) == seen && ++spins < spins_before_sleep) pause(spins);
      if (round_.load(std::memory_order_acquire) == seen) {
        std::unique_lock lock(sleep_);
        ++asleep_;
        wake_.wait(lock, [&] { return round_.load() != seen; });
        --asleep_;
      }
      ++seen;
      if (stopping_) return;
      take_tasks();
      pending_.fetch_sub(1, std::memory_order_release);
    }
  }

  void take_tasks() {
    const bool outer = std::exchange(inside_, true);
    for (int t = 0; t < size(); ++t) take_tasks(share((number_ + t) % size()));
    inside_ = outer;
  }
  void take_tasks(Share& from) {
    const auto stop_with_it = [&] {
      std::scoped_lock lock(sleep_);
      if (!failure_) failure_ = std::current_exception();
      for (int t = 0; t < size(); ++t) share(t).next.store(share(t).end, std::memory_order_relaxed);
      return true;
    };
    while (from.next.load(std::memory_order_relaxed) < from.end) {
      const Index i = from.next.fetch_add(1, std::memory_order_relaxed);
      if (i >= from.end) return;
      guard_all([&] { task_(context_, i); }, stop_with_it);
    }
  }

  inline static thread_local int number_ = 0;
  inline static thread_local bool inside_ = false;  // a task that calls parallel_for runs it alone
  std::unique_ptr<Share[]> shares_;                 // one for every thread
  std::unique_ptr<std::thread[]> threads_;
  int workers_ = 0;  // threads that run
  std::mutex caller_, sleep_;
  std::condition_variable wake_;
  std::atomic<unsigned> round_{0};
  std::atomic<int> pending_{0}, asleep_{0};
  std::atomic<bool> stopping_{false};
  void (*task_)(const void*, Index) = nullptr;
  const void* context_ = nullptr;
  std::exception_ptr failure_;
};

MOTIONLANG_BODY void run_tasks(Index count, void (*task)(const void*, Index), const void* context) {
  ThreadPool::instance().run(count, task, context);
}

}  // namespace detail

MOTIONLANG_BODY int thread_count() { return detail::ThreadPool::instance().size(); }

MOTIONLANG_BODY int parallel_width() { return detail::ThreadPool::instance().width(); }

MOTIONLANG_BODY int thread_number() { return detail::ThreadPool::number(); }

MOTIONLANG_BODY void set_thread_count(int threads) {
  if (threads < 1 || threads > 1024) raise<config_error>(101, "set_thread_count: ", threads, " is not in 1 ... 1024");
  detail::ThreadPool::instance().resize(threads);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
/// A reduction along an axis of (outer, axis, inner), by all threads: of the last axis rows(first, last), rows of the
/// memory; of another columns(i, first, last), columns of matrix i of `outer`.
template <class Rows, class Columns>
void for_reduction(const Shape& s, int axis, const Rows& rows, const Columns& columns) {
  const Index outer = s.count(0, axis), n = s[axis], inner = s.count(axis + 1, s.rank());
  if (inner == 1) return parallel_ranges(outer, n, rows);
  if (outer == 1) return parallel_columns(n, inner, [&](Index first, Index last) { columns(0, first, last); });
  parallel_ranges(outer, n * inner, [&](Index first, Index last) {
    for (Index i = first; i < last; ++i) columns(i, 0, inner);
  });
}
}  // namespace detail

template <Scalar S>
struct DenseOps {
  using scalar = S;
  using tensor = Dense<S>;

  static tensor full(const Shape& shape, S value) { return tensor::full(shape, value); }
  static tensor from_span(std::span<const S> values, const Shape& shape) { return tensor::from_span(values, shape); }
  static std::span<const S> to_span(const tensor& a MOTIONLANG_LIFETIMEBOUND) { return a.span(); }
  static const Shape& shape(const tensor& a) { return a.shape(); }

  static tensor reshape(const tensor& a, const Shape& s) { return a.reshaped(s); }

  // out[i_axes[0], i_axes[1], ...] = a[i_0, i_1, ...]
  static tensor permute(const tensor& a, std::span<const int> axes) {
    Shape s;
    std::array<Index, Shape::max_rank> stride{};
    const auto strides = strides_of(a.shape());
    for (std::size_t i = 0; i < axes.size(); ++i) {
      s.push_back(a.shape()[axes[i]]);
      stride[i] = strides[static_cast<std::size_t>(axes[i])];
    }
    return strided_copy(a, s, stride);
  }
  // sizes of 1 (and missing leading axes) are repeated
  static tensor broadcast(const tensor& a, const Shape& s) {
    return a.shape() == s ? a : strided_copy(a, s, broadcast_strides(a.shape(), s));
  }
  // a[..., first:last, ...]
  static tensor slice(const tensor& a, int axis, Index first, Index last) {
    if (axis == 0) return a.rows(first, last);
    Shape s = a.shape();
    s[axis] = last - first;
    tensor out(s);
    const Index outer = s.count(0, axis), inner = s.count(axis + 1, s.rank()), size = a.shape()[axis];
    copy_pieces(
        outer, (last - first) * inner, [&](Index i) { return a.data() + (i * size + first) * inner; },
        [&](Index i) { return out.data() + i * (last - first) * inner; });
    return out;
  }
  static tensor concat(std::span<const tensor> list, int axis) {
    Shape s = list.front().shape();
    s[axis] = 0;
    for (const tensor& t : list) s[axis] += t.shape()[axis];
    tensor out(s);
    const Index outer = s.count(0, axis), inner = s.count(axis + 1, s.rank());
    Index at = 0;
    for (const tensor& t : list) {
      const Index n = t.shape()[axis] * inner;
      copy_pieces(
          outer, n, [&](Index i) { return t.data() + i * n; },
          [&](Index i) { return out.data() + i * s[axis] * inner + at; });
      at += n;
    }
    return out;
  }
  // out[i] = a[rows[i]]
  static tensor gather(const tensor& a, std::span<const Index> rows) {
    Shape s = a.shape();
    const Index inner = s.count(1, s.rank());
    s[0] = static_cast<Index>(rows.size());
    tensor out(s);
    copy_pieces(
        s[0], inner, [&](Index i) { return a.data() + rows[static_cast<std::size_t>(i)] * inner; },
        [&](Index i) { return out.data() + i * inner; });
    return out;
  }
  // out[rows[i]] += a[i], starting from n rows of zeros; in the order of i
  static tensor scatter_add(const tensor& a, std::span<const Index> rows, Index n) {
    Shape s = a.shape();
    const Index inner = s.count(1, s.rank());
    s[0] = n;
    tensor out = full(s, S(0));
    parallel_columns(static_cast<Index>(rows.size()), inner, [&](Index first, Index last) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const S* from = a.data() + static_cast<Index>(i) * inner;
        S* to = out.data() + rows[i] * inner;
        for (Index j = first; j < last; ++j) to[j] += from[j];
      }
    });
    return out;
  }

 protected:
  using Strides = std::array<Index, Shape::max_rank>;

  /// For i = 0 ... count-1: n numbers of from(i) to to(i).
  template <class From, class To>
  static void copy_pieces(Index count, Index n, const From& from, const To& to) {
    if (n == 0) return;
    const auto bytes = static_cast<std::size_t>(n) * sizeof(S);
    parallel_ranges(count, n, [&](Index first, Index last) {
      for (Index i = first; i < last; ++i) std::memcpy(to(i), from(i), bytes);
    });
  }
  static Strides strides_of(const Shape& s) {
    Strides stride{};
    Index n = 1;
    for (int i = s.rank() - 1; i >= 0; --i) {
      stride[static_cast<std::size_t>(i)] = n;
      n *= s[i];
    }
    return stride;
  }
  /// Strides that read a tensor of shape `from` as if it had shape `to`: 0 along repeated axes.
  static Strides broadcast_strides(const Shape& from, const Shape& to) {
    const Strides own = strides_of(from);
    Strides stride{};
    for (int i = 0; i < to.rank(); ++i) {
      const int j = i - (to.rank() - from.rank());
      if (j >= 0 && from[j] != 1) stride[static_cast<std::size_t>(i)] = own[static_cast<std::size_t>(j)];
    }
    return stride;
  }
  /// An axis of a copy: its size, and how far one step along it goes in the input and in the output.
  struct Axis {
    Index size = 1, in = 1, out = 1;
  };
  /// out[i_0, i_1, ...] = a's memory at sum i_k stride_k, line by line along the last axis. Where these lines jump
  /// through the memory of a, and those along another axis do not, some lines are made at once: a line of the cache
  /// serves all of them.
  static tensor strided_copy(const tensor& a, const Shape& s, const Strides& stride) {
    tensor out(s);
    if (s.count() == 0) return out;
    std::array<Axis, Shape::max_rank> axes;  // from the last to the first, those that are one to the memory joined
    int count = 0;
    const auto own = strides_of(s);
    for (int i = s.rank() - 1; i >= 0; --i) {
      const auto x = static_cast<std::size_t>(i);
      if (s[i] == 1) continue;
      Axis* const before = count == 0 ? nullptr : &axes[static_cast<std::size_t>(count - 1)];
      if (before != nullptr && stride[x] == before->in * before->size)
        before->size *= s[i];
      else
        axes[static_cast<std::size_t>(count++)] = {s[i], stride[x], own[x]};
    }
    const Axis line = axes[0];
    std::size_t beside = 0;
    for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) {
      if (line.in > 1 && axes[i].in == 1) beside = i;
    }
    constexpr Index at_once = 8;
    const Index group = beside == 0 ? 1 : at_once;
    const auto groups = [&](std::size_t i) { return i == beside ? (axes[i].size + group - 1) / group : axes[i].size; };
    Index total = 1;
    for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) total *= groups(i);

    parallel_ranges(total, group * line.size, [&](Index first, Index last) {
      std::array<Index, Shape::max_rank> at{};
      Index rest = first;
      for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) at[i] = rest % groups(i), rest /= groups(i);
      for (Index g = first; g < last; ++g) {
        const S* from = a.data();
        S* to = out.data();
        for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) {
          const Index place = i == beside ? at[i] * group : at[i];
          from += place * axes[i].in, to += place * axes[i].out;
        }
        const Index lines = beside == 0 ? 1 : std::min(group, axes[beside].size - at[beside] * group);
        copy_lines(from, line.in, line.size, to, lines, axes[beside].out);
        for (std::size_t i = 1; i < static_cast<std::size_t>(count) && ++at[i] == groups(i); ++i) at[i] = 0;
      }
    });
    return out;
  }
  /// Line l of n numbers:  to[l * pitch + i] = from[l + i * step]. Several lines only where step > 1.
  static void copy_lines(const S* from, Index step, Index n, S* to, Index lines, Index pitch) {
    if (step == 1) {
      std::memcpy(to, from, static_cast<std::size_t>(n) * sizeof(S));
    } else if (step == 0) {
      std::fill_n(to, n, *from);
    } else {
      for (Index i = 0; i < n; ++i, from += step) {
        for (Index l = 0; l < lines; ++l) to[l * pitch + i] = from[l];
      }
    }
  }
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_BACKEND_KERNEL_OPS_HPP  // <motionlang/backend/kernel_ops.hpp>
#define MOTIONLANG_HAS_BACKEND_KERNEL_OPS_HPP
/// Arithmetic and the operations of tensor/fused.hpp as kernels over Dense storage, with their derivatives. Shared by
/// the Eigen and xtensor backends: one layer of kernels serves both.
///
/// Declarations only; the bodies are in kernel_ops.ipp, which a program that links motionlang::instantiated
/// need not read.

#ifndef MOTIONLANG_HAS_TENSOR_FUSED_HPP  // <motionlang/tensor/fused.hpp>
#define MOTIONLANG_HAS_TENSOR_FUSED_HPP
/// Operations that a backend may have as one kernel: each is defined here in primitives, which is what it means.
///
/// `if constexpr (requires { B::linear(...); })` takes the kernel of a backend that has one. `Autodiff<B>` has the
/// operation, with a hand-written derivative, exactly when B has its kernels; otherwise the definition below is
/// differentiated.

#ifndef MOTIONLANG_HAS_CORE_ACTIVATION_HPP  // <motionlang/core/activation.hpp>
#define MOTIONLANG_HAS_CORE_ACTIVATION_HPP
/// The nonlinearities of networks, by name.

MOTIONLANG_NAMESPACE_BEGIN

///     relu(x) = max(x, 0),   gelu(x) = x (1 + erf(x / sqrt 2)) / 2 (the exact form),   silu(x) = x / (1 + exp(-x)),
///     tanh(x),   quick_gelu(x) = x / (1 + exp(-1.702 x)),   gelu_new(x) = x (1 + tanh(sqrt(2 / pi) (x + 0.044715
///                x^3))) / 2,
///     sigmoid(x) = 1 / (1 + exp(-x))
enum class Activation { none, relu, gelu, silu, tanh, quick_gelu, gelu_new, sigmoid };

/// Throws config_error 103.
inline Activation parse_activation(std::string_view name) {
  if (name == "none" || name == "identity") return Activation::none;
  if (name == "relu") return Activation::relu;
  if (name == "gelu") return Activation::gelu;
  if (name == "silu") return Activation::silu;
  if (name == "tanh") return Activation::tanh;
  if (name == "quick_gelu") return Activation::quick_gelu;
  if (name == "gelu_new") return Activation::gelu_new;
  if (name == "sigmoid") return Activation::sigmoid;
  raise<config_error>(103, "activation '", name,
                      "' is not one of none, relu, gelu, silu, tanh, quick_gelu, gelu_new, sigmoid");
}

constexpr std::string_view to_string(Activation a) {
  constexpr std::string_view names[] = {"none", "relu", "gelu", "silu", "tanh", "quick_gelu", "gelu_new", "sigmoid"};
  return names[static_cast<int>(a)];
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_DROPOUT_HPP  // <motionlang/core/dropout.hpp>
#define MOTIONLANG_HAS_CORE_DROPOUT_HPP
/// Dropout masks that are a function of a key and a position: nothing is stored, and any thread computes any part.

MOTIONLANG_NAMESPACE_BEGIN

/// Inverted dropout (Srivastava et al., JMLR 2014): element i becomes x / (1 - p) if kept, else 0.
/// Nothing happens at p = 0.
struct Dropout {
  double p = 0;
  std::uint64_t key = 0;

  /// 32 bits hashed from the key and the position: two rounds of multiply and xor-shift.
  static constexpr std::uint32_t bits(std::uint64_t key, std::uint64_t i) {
    std::uint32_t h = static_cast<std::uint32_t>(i) * 0x9E3779B1u + static_cast<std::uint32_t>(key) +
                      static_cast<std::uint32_t>(i >> 32) * 0x27D4EB2Fu;
    h = (h ^ (h >> 16)) * 0x85EBCA6Bu + static_cast<std::uint32_t>(key >> 32);
    h = (h ^ (h >> 13)) * 0xC2B2AE35u;
    return h ^ (h >> 16);
  }
  constexpr std::uint32_t limit() const { return static_cast<std::uint32_t>(p * 4294967296.0); }
  /// The factor of element i: 1 / (1 - p) or 0.
  constexpr double factor(std::uint64_t i) const { return bits(key, i) >= limit() ? 1.0 / (1.0 - p) : 0.0; }

  /// Position of an attention weight: 65,536 keys at most.
  static constexpr std::uint64_t attention_position(Index query_row, Index heads, Index head, Index key_column) {
    return (static_cast<std::uint64_t>(query_row * heads + head) << 16) + static_cast<std::uint64_t>(key_column);
  }
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_TENSOR_OPS_HPP  // <motionlang/tensor/ops.hpp>
#define MOTIONLANG_HAS_TENSOR_OPS_HPP
/// Arithmetic, functions, reductions and products of tensors. Every function checks shapes once and calls the backend.
///
/// Binary operations broadcast like NumPy; the result has the larger rank. Temporaries are passed on, so that a backend
/// may compute in place.

#ifndef MOTIONLANG_HAS_TENSOR_TENSOR_HPP  // <motionlang/tensor/tensor.hpp>
#define MOTIONLANG_HAS_TENSOR_TENSOR_HPP
/// Tensor<B, Rank>: what user code sees. The backend and the rank are types, the sizes are values.
///
/// A handle with value semantics: copying shares memory, writing never shows through another handle. A wrong rank is a
/// compile error; wrong sizes are a `shape_error` from the operation, thrown before any backend runs.

#ifndef MOTIONLANG_HAS_CORE_RNG_HPP  // <motionlang/core/rng.hpp>
#define MOTIONLANG_HAS_CORE_RNG_HPP
/// Random numbers: a counter-based generator that can be split by name or number.
///
/// Source   Salmon et al., "Parallel random numbers: as easy as 1, 2, 3" (SC 2011): Philox4x32 with 10 rounds.
/// Normals  Box and Muller (1958), computed in double and rounded, because the standard leaves
///          `std::normal_distribution` open and float libraries differ in the last bit.
/// The generators of PyTorch, NumPy and CPython, for parity with published runs, are in torch_random.hpp,
/// numpy_random.hpp and python_random.hpp.

#include <numbers>      // pi

MOTIONLANG_NAMESPACE_BEGIN

/// Philox4x32-10. `seed` is the key, `stream` and `position` are the counter: any number of any stream can be computed
/// without the ones before it, so results do not depend on batch order or threads.
///
///     Philox rng{.seed = 7};
///     auto step_rng = rng.split("noise").split(step);   // independent of everything drawn elsewhere
struct Philox {
  std::uint64_t seed = 0;
  std::uint64_t stream = 0;
  std::uint64_t position = 0;  // the next block of four 32-bit numbers

  using Block = std::array<std::uint32_t, 4>;

  /// Block `at` of this stream.
  Block block(std::uint64_t at) const {
    Block c{static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at >> 32), static_cast<std::uint32_t>(stream),
            static_cast<std::uint32_t>(stream >> 32)};
    auto k0 = static_cast<std::uint32_t>(seed), k1 = static_cast<std::uint32_t>(seed >> 32);
    for (int round = 0; round < 10; ++round) {
      const std::uint64_t p0 = std::uint64_t{0xD2511F53u} * c[0], p1 = std::uint64_t{0xCD9E8D57u} * c[2];
      c = {static_cast<std::uint32_t>(p1 >> 32) ^ c[1] ^ k0, static_cast<std::uint32_t>(p1),
           static_cast<std::uint32_t>(p0 >> 32) ^ c[3] ^ k1, static_cast<std::uint32_t>(p0)};
      k0 += 0x9E3779B9u;
      k1 += 0xBB67AE85u;
    }
    return c;
  }

  /// A generator for a part of the work. Depends on seed, stream and name, not on what has been drawn.
  Philox split(std::string_view name) const {
    std::uint64_t h = 0xCBF29CE484222325u;  // FNV-1a over the name
    for (char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
    return split(h);
  }
  Philox split(std::uint64_t number) const {
    const Block b = Philox{.seed = stream ^ 0x6D6F74696F6E6C61u, .stream = seed}.block(number);
    return {.seed = seed, .stream = (std::uint64_t{b[0]} << 32) | b[1], .position = 0};
  }

  std::uint32_t bits() { return block(position++)[0]; }

  /// Uniform in 0 ... n-1, without bias (Lemire 2019, with rejection).
  std::uint32_t below(std::uint32_t n) {
    if (n == 0) raise<config_error>(101, "Philox::below: n is 0");
    const std::uint32_t reject = static_cast<std::uint32_t>(-n) % n;
    for (;;) {
      const std::uint64_t product = std::uint64_t{bits()} * n;
      if (static_cast<std::uint32_t>(product) >= reject) return static_cast<std::uint32_t>(product >> 32);
    }
  }

  /// Uniform in [0, 1).
  double uniform() { return bits() * 0x1p-32; }

  template <Scalar S>
  void uniform(std::span<S> out) {
    fill(out, [](const Block& b, std::array<double, 4>& v) {
      for (std::size_t i = 0; i < 4; ++i) v[i] = (b[i] >> 8) * 0x1p-24;  // 24 bits: exact in float, never 1
    });
  }
  void uniform(std::span<float> out) { uniform<float>(out); }

  /// Standard normal numbers.
  template <Scalar S>
  void normal(std::span<S> out) {
    fill(out, [](const Block& b, std::array<double, 4>& v) {
      for (std::size_t i = 0; i < 4; i += 2) {
        const double radius = std::sqrt(-2.0 * std::log((b[i] + 0.5) * 0x1p-32));
        const double angle = 2.0 * std::numbers::pi * (b[i + 1] * 0x1p-32);
        v[i] = radius * std::cos(angle);
        v[i + 1] = radius * std::sin(angle);
      }
    });
  }
  void normal(std::span<float> out) { normal<float>(out); }

 private:
  template <Scalar S, class F>
  void fill(std::span<S> out, F values_of) {
    std::array<double, 4> v{};
    for (std::size_t i = 0; i < out.size(); i += 4) {
      values_of(block(position++), v);
      for (std::size_t j = 0; j < 4 && i + j < out.size(); ++j) out[i + j] = static_cast<S>(v[j]);
    }
  }
};
static_assert(Rng<Philox>);

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// A backend's tensor, row-major numbers that fill(scalar*) writes: into the tensor itself where it can be written, so
/// that a large table is not there twice.
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

  /// No tensor yet: its shape is (0) whatever the rank, it has no numbers, and operations refuse it. A tensor that was
  /// moved from is the same.
  Tensor() = default;
  /// Wraps a backend's tensor. Throws shape_error 206 if its rank is another.
  explicit Tensor(typename B::tensor data) : data_(std::move(data)) {
    if (shape().rank() != Rank) raise<shape_error>(206, "Tensor: rank ", Rank, " expected, shape is ", shape());
  }
  /// One number with all sizes 1: broadcasts against anything.
  template <class N>
  requires std::is_arithmetic_v<N>
  explicit Tensor(N value) : data_(B::full(ones(), static_cast<scalar>(value))) {}

  static Tensor full(const Shape& shape, double value) {
    return Tensor(B::full(checked(shape), static_cast<scalar>(value)));
  }
  static Tensor zeros(const Shape& shape) { return full(shape, 0); }
  /// Row-major values. Throws shape_error 205 if their number is not the shape's.
  static Tensor from(std::span<const scalar> values, const Shape& shape) {
    if (static_cast<Index>(values.size()) != shape.count()) {
      raise<shape_error>(205, "Tensor: ", Index(values.size()), " values for shape ", shape);
    }
    return Tensor(B::from_span(values, checked(shape)));
  }
  static Tensor from(const std::vector<scalar>& values, const Shape& shape) {
    return from(std::span<const scalar>(values), shape);
  }
  /// Row-major numbers that fill(scalar*) writes (written_tensor).
  template <class F>
  static Tensor written(const Shape& shape, const F& fill) {
    return Tensor(written_tensor<B>(checked(shape), fill));
  }
  /// Standard normal numbers.
  static Tensor randn(const Shape& shape, Rng auto& rng) {
    return written(shape,
                   [&](scalar* to) { rng.normal(std::span<scalar>(to, static_cast<std::size_t>(shape.count()))); });
  }

  const typename B::tensor& data() const& MOTIONLANG_LIFETIMEBOUND { return data_; }
  typename B::tensor data() && { return std::move(data_); }
  /// For code that replaces the value in place (optimisers, loaders).
  typename B::tensor& mutable_data() MOTIONLANG_LIFETIMEBOUND { return data_; }

  Shape shape() const { return B::shape(data_); }
  Index size(int axis) const { return shape()[normalize_axis(axis, Rank, "Tensor::size")]; }
  Index count() const { return shape().count(); }
  /// True if there is a tensor, perhaps an empty one; else nothing is made yet, or it was moved from.
  bool defined() const {
    if constexpr (Rank == 1 && requires(const typename B::tensor& t) { t.defined(); }) return data_.defined();
    return shape().rank() == Rank;
  }

  /// The numbers, row-major; valid as long as this tensor lives and is not assigned to.
  std::span<const scalar> span() const& MOTIONLANG_LIFETIMEBOUND { return B::to_span(data_); }
  std::span<const scalar> span() const&& = delete;  // values of a temporary end with it: name it, or to_vector()
  std::vector<scalar> to_vector() const {
    const auto s = span();
    return {s.begin(), s.end()};
  }
  /// The only number of a tensor with one element. Throws shape_error 205.
  scalar item() const {
    if (count() != 1) raise<shape_error>(205, "Tensor::item: shape ", shape(), " has ", count(), " elements");
    return span()[0];
  }
  /// The value at an index for each axis: t.at(0, 2). For many values take span(). Throws shape_error 203 for an index
  /// outside its axis, 206 if there is no tensor.
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

/// Throws shape_error 206 for a tensor that is not made yet, or was moved from.
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
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr int larger(int a, int b) { return a > b ? a : b; }

template <class B, int P, int Q, class F>
auto binary(const char* name, Tensor<B, P>&& a, Tensor<B, Q>&& b, F f) {
  if (a.shape() != b.shape()) broadcast_shapes(a.shape(), b.shape(), name);
  require_tensor(name, a);
  require_tensor(name, b);
  return Tensor<B, larger(P, Q)>(f(std::move(a).data(), std::move(b).data()));
}

}  // namespace detail

template <Backend B, int P, int Q>
auto operator+(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator+", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::add(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto operator-(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator-", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::sub(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto operator*(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator*", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::mul(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto operator/(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator/", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::div(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto maximum(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("maximum", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::maximum(std::move(x), std::move(y)); });
}
template <Backend B, int R>
Tensor<B, R> atan2(Tensor<B, R> y, Tensor<B, R> x) {
  return detail::binary("atan2", std::move(y), std::move(x),
                        [](auto&& p, auto&& q) { return B::atan2(std::move(p), std::move(q)); });
}

template <Backend B, int R>
Tensor<B, R> operator+(Tensor<B, R> a, double b) {
  return std::move(a) + Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator+(double a, Tensor<B, R> b) {
  return std::move(b) + Tensor<B, R>(a);
}
template <Backend B, int R>
Tensor<B, R> operator-(Tensor<B, R> a, double b) {
  return std::move(a) - Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator-(double a, Tensor<B, R> b) {
  return Tensor<B, R>(a) - std::move(b);
}
template <Backend B, int R>
Tensor<B, R> operator*(Tensor<B, R> a, double b) {
  return std::move(a) * Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator*(double a, Tensor<B, R> b) {
  return std::move(b) * Tensor<B, R>(a);
}
template <Backend B, int R>
Tensor<B, R> operator/(Tensor<B, R> a, double b) {
  return std::move(a) / Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator/(double a, Tensor<B, R> b) {
  return Tensor<B, R>(a) / std::move(b);
}
template <Backend B, int R>
Tensor<B, R> operator-(Tensor<B, R> a) {
  return std::move(a) * Tensor<B, R>(-1.0);
}

template <Backend B, int R>
Tensor<B, R> exp(Tensor<B, R> a) {
  detail::require_tensor("exp", a);
  return Tensor<B, R>(B::exp(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> log(Tensor<B, R> a) {
  detail::require_tensor("log", a);
  return Tensor<B, R>(B::log(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> sqrt(Tensor<B, R> a) {
  detail::require_tensor("sqrt", a);
  return Tensor<B, R>(B::sqrt(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> tanh(Tensor<B, R> a) {
  detail::require_tensor("tanh", a);
  return Tensor<B, R>(B::tanh(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> erf(Tensor<B, R> a) {
  detail::require_tensor("erf", a);
  return Tensor<B, R>(B::erf(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> sin(Tensor<B, R> a) {
  detail::require_tensor("sin", a);
  return Tensor<B, R>(B::sin(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> cos(Tensor<B, R> a) {
  detail::require_tensor("cos", a);
  return Tensor<B, R>(B::cos(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> square(const Tensor<B, R>& a) {
  return a * a;
}
/// Its slope at 0 is 0.
template <Backend B, int R>
Tensor<B, R> abs(const Tensor<B, R>& a) {
  const Tensor<B, R> zero(0.0);
  return maximum(a, zero) + maximum(-a, zero);
}

/// Element by element: a < b ? x : y.
template <Backend B, int R>
Tensor<B, R> where_less(const Tensor<B, R>& a, const Tensor<B, R>& b, const Tensor<B, R>& x, const Tensor<B, R>& y) {
  broadcast_shapes(broadcast_shapes(a.shape(), b.shape(), "where_less"),
                   broadcast_shapes(x.shape(), y.shape(), "where_less"), "where_less");
  for (const auto* t : {&a, &b, &x, &y}) detail::require_tensor("where_less", *t);
  return Tensor<B, R>(B::where_less(a.data(), b.data(), x.data(), y.data()));
}

/// Sum along one axis, which disappears. Negative axes count from the end.
template <Backend B, int R>
requires(R > 0) Tensor<B, R - 1> sum(const Tensor<B, R>& a, int axis) {
  detail::require_tensor("sum", a);
  return Tensor<B, R - 1>(B::sum(a.data(), normalize_axis(axis, R, "sum")));
}
template <Backend B, int R>
requires(R > 0) Tensor<B, R - 1> max(const Tensor<B, R>& a, int axis) {
  detail::require_tensor("max", a);
  return Tensor<B, R - 1>(B::max(a.data(), normalize_axis(axis, R, "max")));
}
template <Backend B, int R>
requires(R > 0) Tensor<B, R - 1> mean(const Tensor<B, R>& a, int axis) {
  return sum(a, axis) / static_cast<double>(a.size(axis));
}
/// Sum and mean of everything.
template <Backend B, int R>
Tensor<B, 0> sum(const Tensor<B, R>& a) {
  detail::require_tensor("sum", a);
  return Tensor<B, 0>(B::sum(B::reshape(a.data(), Shape{a.count()}), 0));
}
template <Backend B, int R>
Tensor<B, 0> mean(const Tensor<B, R>& a) {
  return sum(a) / static_cast<double>(a.count());
}

struct MatmulOptions {
  bool transpose_a = false, transpose_b = false;
};
/// Product of the last two axes; leading axes are equal. Throws shape_error 201 or 204.
template <Backend B, int R>
requires(R >= 2) Tensor<B, R> matmul(const Tensor<B, R>& a, const Tensor<B, R>& b, MatmulOptions options = {}) {
  detail::require_tensor("matmul", a);
  detail::require_tensor("matmul", b);
  const Shape sa = a.shape(), sb = b.shape();
  for (int i = 0; i < R - 2; ++i) {
    if (sa[i] != sb[i]) raise<shape_error>(204, "matmul: leading sizes differ: lhs ", sa, ", rhs ", sb);
  }
  if (sa[options.transpose_a ? R - 2 : R - 1] != sb[options.transpose_b ? R - 1 : R - 2]) {
    raise<shape_error>(201, "matmul: inner sizes differ: lhs ", sa, options.transpose_a ? " transposed" : "", ", rhs ",
                       sb, options.transpose_b ? " transposed" : "");
  }
  return Tensor<B, R>(B::matmul(a.data(), b.data(), options.transpose_a, options.transpose_b));
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_TENSOR_SEQUENCES_HPP  // <motionlang/tensor/sequences.hpp>
#define MOTIONLANG_HAS_TENSOR_SEQUENCES_HPP
/// A batch of sequences without padding: the rows of all sequences one after the other, and where each begins.
///
/// Layers that treat rows alike (linear, norms, nonlinearities, losses) see only rows; attention, positions and pooling
/// take the offsets. Padded tensors and masks exist only at the edge, for loaders and for comparison with other
/// programs.

#ifndef MOTIONLANG_HAS_CORE_OFFSETS_HPP  // <motionlang/core/offsets.hpp>
#define MOTIONLANG_HAS_CORE_OFFSETS_HPP
/// Where each sequence of a packed batch begins: an immutable shared list 0 = o_0 <= o_1 <= ... <= o_n = rows.

MOTIONLANG_NAMESPACE_BEGIN

/// Sequence i has the rows offsets[i] ... offsets[i + 1] - 1. Cheap to copy; whoever keeps a copy keeps the list alive.
/// To move is to copy: what was moved from keeps its list.
class Offsets {
 public:
  Offsets() : Offsets(std::span<const Index>()) {}
  /// From the lengths of the sequences. Throws shape_error 207 on a negative one.
  explicit Offsets(std::span<const Index> lengths)
      : memory_((lengths.size() + 1) * sizeof(Index)), count_(static_cast<Index>(lengths.size())) {
    Index* last = static_cast<Index*>(memory_.data());
    *last = 0;
    for (Index n : lengths) {
      if (n < 0) raise<shape_error>(207, "Offsets: negative length ", n);
      last[1] = *last + n;
      ++last;
    }
  }
  explicit Offsets(const std::vector<Index>& lengths) : Offsets(std::span<const Index>(lengths)) {}
  Offsets(std::initializer_list<Index> lengths) : Offsets(std::span<const Index>(lengths.begin(), lengths.size())) {}
  Offsets(const Offsets&) = default;
  Offsets& operator=(const Offsets&) = default;
  ~Offsets() = default;
  /// `count` sequences of equal length. Throws shape_error 207 if either is negative.
  static Offsets equal(Index count, Index length);

  Index count() const { return count_; }
  Index rows() const { return first()[count_]; }
  Index begin(Index i) const { return first()[i]; }
  Index end(Index i) const { return first()[i + 1]; }
  Index length(Index i) const { return end(i) - begin(i); }
  Index longest() const;
  std::span<const Index> list() const MOTIONLANG_LIFETIMEBOUND {
    return {first(), static_cast<std::size_t>(count_) + 1};
  }
  bool operator==(const Offsets& o) const {
    return count_ == o.count_ &&
           std::memcmp(first(), o.first(), (static_cast<std::size_t>(count_) + 1) * sizeof(Index)) == 0;
  }

 private:
  const Index* first() const { return static_cast<const Index*>(memory_.data()); }
  detail::BufferHandle memory_;
  Index count_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_OFFSETS_IPP  // <motionlang/core/offsets.ipp>
#define MOTIONLANG_HAS_CORE_OFFSETS_IPP
// Bodies of offsets.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Offsets Offsets::equal(Index count, Index length) {
  if (count < 0) raise<shape_error>(207, "Offsets: ", count, " sequences");
  return Offsets(std::span<const Index>(PoolVector<Index>(static_cast<std::size_t>(count), length)));
}

MOTIONLANG_BODY Index Offsets::longest() const {
  Index n = 0;
  for (Index i = 0; i < count(); ++i) n = length(i) > n ? length(i) : n;
  return n;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_TENSOR_INDEX_HPP  // <motionlang/tensor/index.hpp>
#define MOTIONLANG_HAS_TENSOR_INDEX_HPP
/// Moving numbers: reshape, permute, slice, concat, gather, scatter.

MOTIONLANG_NAMESPACE_BEGIN

/// The same numbers in another shape; one size may be -1 and is then computed. Throws shape_error 205.
template <int New, Backend B, int R>
Tensor<B, New> reshape(const Tensor<B, R>& a, const std::array<Index, New>& sizes) {
  detail::require_tensor("reshape", a);
  Index known = 1;
  int unknown = -1;
  for (int i = 0; i < New; ++i) {
    const Index n = sizes[static_cast<std::size_t>(i)];
    if (n == -1 && unknown < 0)
      unknown = i;
    else
      known *= n;
  }
  Shape s;
  for (int i = 0; i < New; ++i)
    s.push_back(i == unknown ? (known == 0 ? 0 : a.count() / known) : sizes[static_cast<std::size_t>(i)]);
  if (s.count() != a.count()) raise<shape_error>(205, "reshape: shape ", a.shape(), " cannot become ", s);
  return Tensor<B, New>(B::reshape(a.data(), s));
}

/// out[i_axes[0], i_axes[1], ...] = a[i_0, i_1, ...]
template <Backend B, int R>
Tensor<B, R> permute(const Tensor<B, R>& a, const std::array<int, static_cast<std::size_t>(R)>& axes) {
  detail::require_tensor("permute", a);
  std::array<int, static_cast<std::size_t>(R)> from{};
  unsigned seen = 0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    from[i] = normalize_axis(axes[i], R, "permute");
    seen |= 1u << static_cast<unsigned>(from[i]);
  }
  if (seen != (1u << R) - 1) raise<shape_error>(203, "permute: every axis must occur once");
  return Tensor<B, R>(B::permute(a.data(), std::span<const int>(from)));
}
template <Backend B>
Tensor<B, 2> transpose(const Tensor<B, 2>& a) {
  return permute(a, {1, 0});
}

/// Sizes of 1 and missing leading axes are repeated.
template <int New, Backend B, int R>
requires(New >= R) Tensor<B, New> broadcast_to(const Tensor<B, R>& a, const Shape& s) {
  if (broadcast_shapes(a.shape(), s, "broadcast_to") != s)
    raise<shape_error>(202, "broadcast_to: ", a.shape(), " does not become ", s);
  detail::require_tensor("broadcast_to", a);
  return Tensor<B, New>(B::broadcast(a.data(), s));
}

/// Indices first ... last-1 along an axis; all of them are the tensor itself, without a copy. Throws shape_error 203.
template <Backend B, int R>
Tensor<B, R> slice(const Tensor<B, R>& a, int axis, Index first, Index last) {
  detail::require_tensor("slice", a);
  axis = normalize_axis(axis, R, "slice");
  if (first < 0 || last < first || last > a.size(axis)) {
    raise<shape_error>(203, "slice: ", first, " ... ", last, " of axis ", axis, " of ", a.shape());
  }
  if (first == 0 && last == a.size(axis)) return a;
  return Tensor<B, R>(B::slice(a.data(), axis, first, last));
}

/// Joins along an axis; the other sizes must be equal. Throws shape_error 204.
template <Backend B, int R>
Tensor<B, R> concat(std::span<const Tensor<B, R>> list, int axis) {
  if (list.empty()) raise<shape_error>(205, "concat: nothing to join");
  axis = normalize_axis(axis, R, "concat");
  PoolVector<typename B::tensor> data;
  data.reserve(list.size());
  for (const auto& t : list) {
    if (t.shape().without(axis) != list.front().shape().without(axis)) {
      raise<shape_error>(204, "concat along axis ", axis, ": shapes ", list.front().shape(), " and ", t.shape());
    }
    detail::require_tensor("concat", t);
    data.push_back(t.data());
  }
  return Tensor<B, R>(B::concat(std::span<const typename B::tensor>(data), axis));
}
template <Backend B, int R, class... T>
Tensor<B, R> concat(int axis, const Tensor<B, R>& first, const T&... more) {
  axis = normalize_axis(axis, R, "concat");
  detail::require_tensor("concat", first);
  const Shape rest = first.shape().without(axis);
  auto check = [&](const Tensor<B, R>& t) {
    if (t.shape().without(axis) != rest) {
      raise<shape_error>(204, "concat along axis ", axis, ": shapes ", first.shape(), " and ", t.shape());
    }
    detail::require_tensor("concat", t);
  };
  (check(more), ...);
  const std::array<typename B::tensor, 1 + sizeof...(T)> data{first.data(), more.data()...};
  return Tensor<B, R>(B::concat(std::span<const typename B::tensor>(data), axis));
}

namespace detail {
void check_rows(const char* op, std::span<const Index> rows, Index n);
}  // namespace detail

/// out[i] = a[rows[i]]: picks along the first axis; rows may repeat. Throws shape_error 203.
template <Backend B, int R>
requires(R > 0) Tensor<B, R> gather(const Tensor<B, R>& a, std::span<const Index> rows) {
  detail::require_tensor("gather", a);
  detail::check_rows("gather", rows, a.size(0));
  return Tensor<B, R>(B::gather(a.data(), rows));
}
/// out[rows[i]] += a[i] into n rows of zeros. The adjoint of gather. Throws shape_error 203, 204.
template <Backend B, int R>
requires(R > 0) Tensor<B, R> scatter_add(const Tensor<B, R>& a, std::span<const Index> rows, Index n) {
  detail::require_tensor("scatter_add", a);
  if (static_cast<Index>(rows.size()) != a.size(0)) {
    raise<shape_error>(204, "scatter_add: ", Index(rows.size()), " rows for shape ", a.shape());
  }
  detail::check_rows("scatter_add", rows, n);
  return Tensor<B, R>(B::scatter_add(a.data(), rows, n));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_TENSOR_INDEX_IPP  // <motionlang/tensor/index.ipp>
#define MOTIONLANG_HAS_TENSOR_INDEX_IPP
// Bodies of index.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void check_rows(const char* op, std::span<const Index> rows, Index n) {
  for (Index r : rows) {
    if (r < 0 || r >= n) raise<shape_error>(203, op, ": row ", r, " of ", n);
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct Sequences {
  Tensor<B, 2> rows;  // (sum of lengths, width)
  Offsets offsets;

  Sequences() = default;
  /// Throws shape_error 207 unless the offsets end at the last row.
  Sequences(Tensor<B, 2> r, Offsets o) : rows(std::move(r)), offsets(std::move(o)) {
    if (rows.size(0) != offsets.rows()) {
      raise<shape_error>(207, "Sequences: offsets for ", offsets.rows(), " rows, tensor is ", rows.shape());
    }
  }
  Index count() const { return offsets.count(); }
  Index width() const { return rows.size(1); }
  /// One sequence, (length, width).
  Tensor<B, 2> operator[](Index i) const { return slice(rows, 0, offsets.begin(i), offsets.end(i)); }
  /// The same structure with other rows.
  Sequences with(Tensor<B, 2> r) const { return {std::move(r), offsets}; }
};

/// For every row the number of its sequence.
PoolVector<Index> sequence_of_row(const Offsets& offsets);
/// One row per sequence to one per row of the sequences: (sequences, width) -> (rows, width). Throws shape_error 204
/// for another count.
template <Backend B>
Tensor<B, 2> repeat_for_rows(const Tensor<B, 2>& per_sequence, const Offsets& offsets) {
  if (per_sequence.size(0) != offsets.count())
    raise<shape_error>(204, "repeat_for_rows: ", per_sequence.size(0), " rows for ", offsets.count(), " sequences");
  return gather(per_sequence, sequence_of_row(offsets));
}
/// The same rows for each of `count` sequences.
template <Backend B>
Sequences<B> repeat_sequence(const Tensor<B, 2>& rows, Index count) {
  PoolVector<Index> pick;
  for (Index s = 0; s < count; ++s) {
    for (Index i = 0; i < rows.size(0); ++i) pick.push_back(i);
  }
  return {gather(rows, pick), Offsets::equal(count, rows.size(0))};
}

namespace detail {

/// The lengths of the sequences `which`: numbers that there are, in any order, with repetition.
Offsets some_sequences(const Offsets& offsets, std::span<const Index> which);
/// The sequences `which`; without copying if these are all of them in order.
template <Backend B>
Sequences<B> some_sequences(const Sequences<B>& x, std::span<const Index> which) {
  const Index first = which.empty() ? 0 : which.front(), count = std::ssize(which);
  bool in_a_row = true;
  for (Index i = 0; i < count; ++i) in_a_row = in_a_row && which[static_cast<std::size_t>(i)] == first + i;
  if (in_a_row && count == x.count()) return x;
  const Offsets offsets = some_sequences(x.offsets, which);
  if (in_a_row) return {slice(x.rows, 0, x.offsets.begin(first), x.offsets.begin(first + count)), offsets};
  PoolVector<Index> rows;
  for (Index s : which) {
    for (Index r = x.offsets.begin(s); r < x.offsets.end(s); ++r) rows.push_back(r);
  }
  return {gather(x.rows, rows), offsets};
}
/// Number i times.length(i) times. Throws shape_error 204 for another number of times.
PoolVector<Index> repeated_numbers(Index sequences, const Offsets& times);

/// Rows to pick, and how long the sequences of them are.
struct PickedRows {
  PoolVector<Index> rows;
  Offsets offsets;
};
/// For concat_tokens, of the parts one behind the other. Throws shape_error 204 if the counts differ.
PickedRows joined_sequences(std::span<const Offsets* const> parts);
/// For last_rows. Throws shape_error 204, 207.
PoolVector<Index> last_rows_of(const Offsets& offsets, const Offsets& tail);
/// For from_padded: shape (batch, time, width), mask (batch, time). Throws shape_error 205.
PickedRows valid_rows(const Shape& shape, std::span<const unsigned char> mask);
/// The same for lengths. Throws shape_error 204, 205.
std::vector<unsigned char> mask_of_lengths(const Shape& shape, std::span<const Index> lengths);

}  // namespace detail

/// Sequence i times.length(i) times, one after the other. Throws shape_error 204 for another number of times.
Offsets repeat_lengths(const Offsets& offsets, const Offsets& times);
template <Backend B>
Sequences<B> repeat_sequences(const Sequences<B>& x, const Offsets& times) {
  return detail::some_sequences(x, detail::repeated_numbers(x.count(), times));
}

/// Joins sequence by sequence: the rows of a's sequence i, then of b's, ... Throws shape_error 204 if the counts
/// differ.
template <Backend B, class... T>
Sequences<B> concat_tokens(const Sequences<B>& first, const T&... more) {
  const std::array<const Offsets*, 1 + sizeof...(T)> parts{&first.offsets, &more.offsets...};
  auto joined = detail::joined_sequences(parts);
  return {gather(concat(0, first.rows, more.rows...), joined.rows), std::move(joined.offsets)};
}
/// The last tail.length(i) rows of each sequence. Throws shape_error 204, 207.
template <Backend B>
Sequences<B> last_rows(const Sequences<B>& x, const Offsets& tail) {
  return {gather(x.rows, detail::last_rows_of(x.offsets, tail)), tail};
}
/// Each sequence without its first n rows.
template <Backend B>
Sequences<B> drop_tokens(const Sequences<B>& x, Index n) {
  PoolVector<Index> lengths;
  for (Index s = 0; s < x.count(); ++s) lengths.push_back(x.offsets.length(s) - n);
  return last_rows(x, Offsets(std::span<const Index>(lengths)));
}

/// true for the first lengths[i] of `longest` frames: (sequences, longest), row-major, 1 = valid.
std::vector<unsigned char> lengths_to_mask(std::span<const Index> lengths);

/// x (batch, time, width) and mask (batch, time; 0 = padding) to the valid rows. Padding need not be at the end.
template <Backend B>
Sequences<B> from_padded(const Tensor<B, 3>& x, std::span<const unsigned char> mask) {
  auto valid = detail::valid_rows(x.shape(), mask);
  return {gather(reshape<2>(x, {x.size(0) * x.size(1), x.size(2)}), valid.rows), std::move(valid.offsets)};
}
/// The first lengths[i] frames of each. Throws shape_error 204, 205.
template <Backend B>
Sequences<B> from_padded(const Tensor<B, 3>& x, std::span<const Index> lengths) {
  return from_padded(x, std::span<const unsigned char>(detail::mask_of_lengths(x.shape(), lengths)));
}
/// All sequences of a (batch, time, width) tensor at full length.
template <Backend B>
Sequences<B> from_equal(const Tensor<B, 3>& x) {
  return {reshape<2>(x, {x.size(0) * x.size(1), x.size(2)}), Offsets::equal(x.size(0), x.size(1))};
}

/// (batch, time, width) with `value` behind the end of each sequence; `time` is the longest length when 0.
template <Backend B>
Tensor<B, 3> to_padded(const Sequences<B>& x, double value = 0, Index time = 0) {
  if (time == 0) time = x.offsets.longest();
  if (time < x.offsets.longest())
    raise<shape_error>(205, "to_padded: ", time, " frames for a sequence of ", x.offsets.longest());
  // a last row of padding, which all padded positions pick
  const auto rows = concat(0, x.rows, Tensor<B, 2>::full({1, x.width()}, value));
  std::vector<Index> pick;
  for (Index i = 0; i < x.count(); ++i) {
    for (Index t = 0; t < time; ++t)
      pick.push_back(t < x.offsets.length(i) ? x.offsets.begin(i) + t : x.offsets.rows());
  }
  return reshape<3>(gather(rows, pick), {x.count(), time, x.width()});
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_TENSOR_SEQUENCES_IPP  // <motionlang/tensor/sequences.ipp>
#define MOTIONLANG_HAS_TENSOR_SEQUENCES_IPP
// Bodies of sequences.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY PoolVector<Index> sequence_of_row(const Offsets& offsets) {
  PoolVector<Index> owner;
  owner.reserve(static_cast<std::size_t>(offsets.rows()));
  for (Index s = 0; s < offsets.count(); ++s) {
    for (Index i = 0; i < offsets.length(s); ++i) owner.push_back(s);
  }
  return owner;
}

namespace detail {

MOTIONLANG_BODY Offsets some_sequences(const Offsets& offsets, std::span<const Index> which) {
  PoolVector<Index> lengths;
  for (Index s : which) lengths.push_back(offsets.length(s));
  return Offsets(std::span<const Index>(lengths));
}

MOTIONLANG_BODY PoolVector<Index> repeated_numbers(Index sequences, const Offsets& times) {
  if (times.count() != sequences)
    raise<shape_error>(204, "repeat_lengths: ", times.count(), " numbers of times for ", sequences, " sequences");
  return sequence_of_row(times);
}

MOTIONLANG_BODY PickedRows joined_sequences(std::span<const Offsets* const> parts) {
  const Index count = parts.front()->count();
  for (const Offsets* part : parts) {
    if (part->count() != count) raise<shape_error>(204, "concat_tokens: ", count, " sequences and ", part->count());
  }
  PoolVector<Index> pick, lengths;
  for (Index s = 0; s < count; ++s) {
    Index start = 0, length = 0;  // of the part among all rows; of the joined sequence
    for (const Offsets* part : parts) {
      for (Index r = part->begin(s); r < part->end(s); ++r) pick.push_back(start + r);
      start += part->rows();
      length += part->length(s);
    }
    lengths.push_back(length);
  }
  return {std::move(pick), Offsets(std::span<const Index>(lengths))};
}

MOTIONLANG_BODY PoolVector<Index> last_rows_of(const Offsets& offsets, const Offsets& tail) {
  if (tail.count() != offsets.count())
    raise<shape_error>(204, "last_rows: ", offsets.count(), " sequences and ", tail.count());
  PoolVector<Index> pick;
  for (Index s = 0; s < offsets.count(); ++s) {
    if (tail.length(s) > offsets.length(s)) {
      raise<shape_error>(207, "last_rows: ", tail.length(s), " of ", offsets.length(s), " rows of sequence ", s);
    }
    for (Index r = offsets.end(s) - tail.length(s); r < offsets.end(s); ++r) pick.push_back(r);
  }
  return pick;
}

MOTIONLANG_BODY PickedRows valid_rows(const Shape& shape, std::span<const unsigned char> mask) {
  const Index batch = shape[0], time = shape[1];
  if (static_cast<Index>(mask.size()) != batch * time) {
    raise<shape_error>(205, "from_padded: ", Index(mask.size()), " mask values for shape ", shape);
  }
  PoolVector<Index> rows, lengths;
  for (Index b = 0; b < batch; ++b) {
    const auto before = static_cast<Index>(rows.size());
    for (Index t = 0; t < time; ++t) {
      if (mask[static_cast<std::size_t>(b * time + t)] != 0) rows.push_back(b * time + t);
    }
    lengths.push_back(static_cast<Index>(rows.size()) - before);
  }
  return {std::move(rows), Offsets(std::span<const Index>(lengths))};
}

MOTIONLANG_BODY std::vector<unsigned char> mask_of_lengths(const Shape& shape, std::span<const Index> lengths) {
  std::vector<unsigned char> mask(static_cast<std::size_t>(shape[0] * shape[1]));
  if (static_cast<Index>(lengths.size()) != shape[0]) {
    raise<shape_error>(204, "from_padded: ", Index(lengths.size()), " lengths for shape ", shape);
  }
  for (Index b = 0; b < shape[0]; ++b) {
    const Index length = lengths[static_cast<std::size_t>(b)];
    if (length < 0 || length > shape[1]) {
      raise<shape_error>(205, "from_padded: length ", length, " of sequence ", b, " for shape ", shape);
    }
    for (Index t = 0; t < length; ++t) mask[static_cast<std::size_t>(b * shape[1] + t)] = 1;
  }
  return mask;
}

}  // namespace detail

MOTIONLANG_BODY Offsets repeat_lengths(const Offsets& offsets, const Offsets& times) {
  return detail::some_sequences(offsets, detail::repeated_numbers(offsets.count(), times));
}

MOTIONLANG_BODY std::vector<unsigned char> lengths_to_mask(std::span<const Index> lengths) {
  Index longest = 0;
  for (Index n : lengths) longest = n > longest ? n : longest;
  std::vector<unsigned char> mask;
  for (Index n : lengths) {
    for (Index i = 0; i < longest; ++i) mask.push_back(i < n ? 1 : 0);
  }
  return mask;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline void check_dropout(const Dropout& d) {
  if (!(d.p >= 0 && d.p < 1)) raise<config_error>(101, "dropout: probability ", d.p, " is not in [0, 1)");
}

}  // namespace detail

/// x times the mask of core/dropout.hpp; positions are row-major. Throws config_error 101 unless 0 <= p < 1.
template <Backend B, int R>
Tensor<B, R> dropout(const Tensor<B, R>& x, const Dropout& d) {
  detail::require_tensor("dropout", x);
  detail::check_dropout(d);
  if (d.p == 0) return x;
  if constexpr (requires { B::dropout(x.data(), d); }) {
    return Tensor<B, R>(B::dropout(x.data(), d));
  } else {
    std::vector<typename B::scalar> mask(static_cast<std::size_t>(x.count()));
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = static_cast<typename B::scalar>(d.factor(i));
    return x * Tensor<B, R>::from(mask, x.shape());
  }
}

/// Applies a nonlinearity element by element (core/activation.hpp has the formulas).
template <Backend B, int R>
Tensor<B, R> activate(const Tensor<B, R>& x, Activation act) {
  detail::require_tensor("activate", x);
  if constexpr (requires { B::activate(x.data(), act); }) {
    return Tensor<B, R>(B::activate(x.data(), act));
  } else {
    switch (act) {
      case Activation::none:
        return x;
      case Activation::relu:
        return maximum(x, Tensor<B, R>(0.0));  // slope 1 at 0; of the kernels, as in PyTorch, 0
      case Activation::gelu:
        return x * 0.5 * (erf(x * std::sqrt(0.5)) + 1.0);
      case Activation::silu:
        return x / (exp(-x) + 1.0);
      case Activation::tanh:
        return tanh(x);
      case Activation::quick_gelu:
        return x / (exp(x * -1.702) + 1.0);
      case Activation::gelu_new:
        return x * 0.5 * (tanh((x + x * x * x * 0.044715) * 0.79788456080286536) + 1.0);
      case Activation::sigmoid:
        return 1.0 / (exp(-x) + 1.0);
    }
    return x;
  }
}

namespace detail {

template <Backend B>
void check_linear(const Tensor<B, 2>& x, const Tensor<B, 2>& weight, const Tensor<B, 1>* bias,
                  const Tensor<B, 2>* residual) {
  if (x.size(1) != weight.size(1)) {
    raise<shape_error>(201, "linear: inner sizes differ: input ", x.shape(), ", weight ", weight.shape());
  }
  if (bias != nullptr && bias->size(0) != weight.size(0)) {
    raise<shape_error>(204, "linear: bias ", bias->shape(), " for weight ", weight.shape());
  }
  if (residual != nullptr && residual->shape() != Shape{x.size(0), weight.size(0)}) {
    raise<shape_error>(204, "linear: residual ", residual->shape(), " for input ", x.shape(), " and weight ",
                       weight.shape());
  }
  require_tensor("linear", x);
  require_tensor("linear", weight);
  if (bias != nullptr) require_tensor("linear", *bias);
}

}  // namespace detail

/// y = dropout(act(x W^T + bias)) + residual.   x (rows, in), weight (out, in), bias (out), residual (rows, out) ->
/// (rows, out) Bias and residual may be null. Throws shape_error 201, 204, and as dropout.
template <Backend B>
Tensor<B, 2> linear(const Tensor<B, 2>& x, const Tensor<B, 2>& weight, const Tensor<B, 1>* bias,
                    Activation act = Activation::none, const Tensor<B, 2>* residual = nullptr,
                    const Dropout& drop = {}) {
  detail::check_linear(x, weight, bias, residual);
  detail::check_dropout(drop);
  using T = const typename B::tensor*;
  if constexpr (requires { B::linear(x.data(), weight.data(), T{}, act, T{}, drop); }) {
    return Tensor<B, 2>(B::linear(x.data(), weight.data(), bias == nullptr ? nullptr : &bias->data(), act,
                                  residual == nullptr ? nullptr : &residual->data(), drop));
  } else {
    auto y = matmul(x, weight, {.transpose_b = true});
    if (bias != nullptr) y = y + *bias;
    if (act != Activation::none) y = activate(y, act);
    y = dropout(y, drop);
    return residual == nullptr ? y : y + *residual;
  }
}

/// Layer normalisation over the last axis (Ba et al. 2016): (x - mean) / sqrt(variance + eps) weight + bias, with the
/// variance divided by n. Throws shape_error 204.
template <Backend B>
Tensor<B, 2> layer_norm(const Tensor<B, 2>& x, const Tensor<B, 1>& weight, const Tensor<B, 1>& bias,
                        double eps = 1e-5) {
  if (weight.size(0) != x.size(1) || bias.size(0) != x.size(1)) {
    raise<shape_error>(204, "layer_norm: weight ", weight.shape(), " and bias ", bias.shape(), " for input ",
                       x.shape());
  }
  detail::require_tensor("layer_norm", x);
  if constexpr (requires { B::layer_norm(x.data(), weight.data(), bias.data(), eps); }) {
    return Tensor<B, 2>(B::layer_norm(x.data(), weight.data(), bias.data(), eps));
  } else {
    const Index rows = x.size(0);
    const auto centred = x - reshape<2>(mean(x, 1), {rows, 1});
    const auto variance = reshape<2>(mean(square(centred), 1), {rows, 1});
    return centred / sqrt(variance + eps) * weight + bias;
  }
}
/// layer_norm(x + residual): the second half of a post-norm block.
template <Backend B>
Tensor<B, 2> add_layer_norm(const Tensor<B, 2>& x, const Tensor<B, 2>& residual, const Tensor<B, 1>& weight,
                            const Tensor<B, 1>& bias, double eps = 1e-5) {
  if constexpr (requires { B::add_layer_norm(x.data(), residual.data(), weight.data(), bias.data(), eps); }) {
    if (x.shape() != residual.shape() || weight.size(0) != x.size(1) || bias.size(0) != x.size(1)) {
      raise<shape_error>(204, "add_layer_norm: input ", x.shape(), ", residual ", residual.shape(), ", weight ",
                         weight.shape());
    }
    detail::require_tensor("add_layer_norm", x);
    return Tensor<B, 2>(B::add_layer_norm(x.data(), residual.data(), weight.data(), bias.data(), eps));
  } else {
    return layer_norm(x + residual, weight, bias, eps);
  }
}

/// softmax over the last axis: exp(x - max) / sum.
template <Backend B>
Tensor<B, 2> softmax(const Tensor<B, 2>& x) {
  detail::require_tensor("softmax", x);
  if constexpr (requires { B::softmax(x.data()); }) {
    return Tensor<B, 2>(B::softmax(x.data()));
  } else {
    const auto e = exp(x - reshape<2>(max(x, 1), {x.size(0), 1}));
    return e / reshape<2>(sum(e, 1), {x.size(0), 1});
  }
}

struct AttentionOptions {
  Index heads = 1;
  bool causal = false;  // a query sees the keys up to its own position only
  Dropout dropout{};    // on the attention weights
};

namespace detail {

template <Backend B>
void check_attention(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, const Offsets& q_offsets,
                     const Offsets& k_offsets, const AttentionOptions& options,
                     const Tensor<B, 2>* relative_scores = nullptr) {
  if (q.size(1) != k.size(1) || k.shape() != v.shape()) {
    raise<shape_error>(204, "attention: q ", q.shape(), ", k ", k.shape(), ", v ", v.shape());
  }
  if (options.heads < 1 || q.size(1) % options.heads != 0) {
    raise<config_error>(101, "attention: ", options.heads, " heads do not divide width ", q.size(1));
  }
  if (q_offsets.rows() != q.size(0) || k_offsets.rows() != k.size(0) || q_offsets.count() != k_offsets.count()) {
    raise<shape_error>(207, "attention: offsets for ", q_offsets.rows(), " and ", k_offsets.rows(), " rows, q ",
                       q.shape(), ", k ", k.shape());
  }
  for (Index s = 0; s < k_offsets.count(); ++s) {
    if (k_offsets.length(s) == 0 && q_offsets.length(s) > 0)
      raise<shape_error>(207, "attention: sequence ", s, " has no keys");
    if (k_offsets.length(s) > 65536) raise<shape_error>(207, "attention: sequence ", s, " has more than 65536 keys");
  }
  require_tensor("attention", q);
  require_tensor("attention", k);
  if (relative_scores == nullptr) return;
  const Index farthest = std::max(q_offsets.longest(), k_offsets.longest()) - 1;
  if (relative_scores->size(0) != options.heads || relative_scores->size(1) % 2 != 1 ||
      relative_scores->size(1) / 2 < farthest) {
    raise<shape_error>(204, "attention: relative scores ", relative_scores->shape(), " for ", options.heads,
                       " heads and distances up to ", farthest);
  }
}

/// (queries, keys) of one head: element (i, j) is that of distance j - i.
template <Backend B>
Tensor<B, 2> scores_of_distances(const Tensor<B, 2>& relative_scores, Index head, Index tq, Index tk) {
  const Index zero = relative_scores.size(1) / 2;  // the column of distance 0
  PoolVector<Index> columns;
  for (Index i = 0; i < tq; ++i) {
    for (Index j = 0; j < tk; ++j) columns.push_back(zero + j - i);
  }
  return reshape<2>(gather(reshape<1>(slice(relative_scores, 0, head, head + 1), {-1}), columns), {tq, tk});
}

/// softmax(q k^T / sqrt(width) + relative scores) v for one head of one sequence; q (tq, width), k and v (tk, width).
template <Backend B>
Tensor<B, 2> attend(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, Index first_row, Index head,
                    const AttentionOptions& o, const Tensor<B, 2>* relative_scores) {
  const Index tq = q.size(0), tk = k.size(0);
  auto scores = matmul(q, k, {.transpose_b = true}) * (1.0 / std::sqrt(static_cast<double>(q.size(1))));
  if (relative_scores != nullptr) scores = scores + scores_of_distances(*relative_scores, head, tq, tk);
  using S = typename B::scalar;
  std::vector<S> values(static_cast<std::size_t>(tq * tk));
  if (o.causal) {
    for (Index i = 0; i < tq; ++i) {
      for (Index j = i + 1; j < tk; ++j) values[static_cast<std::size_t>(i * tk + j)] = S(-1e30);
    }
    scores = scores + Tensor<B, 2>::from(values, {tq, tk});
  }
  auto weights = softmax(scores);
  if (o.dropout.p > 0) {
    for (Index i = 0; i < tq; ++i) {
      for (Index j = 0; j < tk; ++j) {
        values[static_cast<std::size_t>(i * tk + j)] =
            static_cast<S>(o.dropout.factor(Dropout::attention_position(first_row + i, o.heads, head, j)));
      }
    }
    weights = weights * Tensor<B, 2>::from(values, {tq, tk});
  }
  return matmul(weights, v);
}

}  // namespace detail

/// Multi-head attention over packed sequences (Vaswani et al. 2017, eq. 1); heads are contiguous slices of the width.
///     O_h = softmax(Q_h K_h^T / sqrt(width / heads) + R_h) V_h     within each sequence
/// q (query rows, width), k and v (key rows, width) -> (query rows, width). Padding does not exist here: a key that is
/// masked is simply not in the sequence (see from_padded). R may be null; element (i, j) of R_h is a number of the
/// distance j - i: column j - i + n of relative_scores (heads, 2 n + 1). Throws config_error 101, shape_error 204, 207.
template <Backend B>
Tensor<B, 2> attention(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, const Offsets& q_offsets,
                       const Offsets& k_offsets, const AttentionOptions& options,
                       const Tensor<B, 2>* relative_scores = nullptr) {
  detail::check_attention(q, k, v, q_offsets, k_offsets, options, relative_scores);
  using T = const typename B::tensor*;
  if constexpr (requires { B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options, T{}); }) {
    return Tensor<B, 2>(B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options,
                                     relative_scores == nullptr ? nullptr : &relative_scores->data()));
  } else {
    if constexpr (requires { B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options); }) {
      if (relative_scores == nullptr)
        return Tensor<B, 2>(B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options));
    }
    const Index width = q.size(1) / options.heads;
    std::vector<Tensor<B, 2>> sequences, heads;
    for (Index s = 0; s < q_offsets.count(); ++s) {
      const auto qs = slice(q, 0, q_offsets.begin(s), q_offsets.end(s));
      const auto ks = slice(k, 0, k_offsets.begin(s), k_offsets.end(s)),
                 vs = slice(v, 0, k_offsets.begin(s), k_offsets.end(s));
      heads.clear();
      for (Index h = 0; h < options.heads; ++h) {
        auto columns = [&](const Tensor<B, 2>& t) { return slice(t, 1, h * width, (h + 1) * width); };
        heads.push_back(
            detail::attend(columns(qs), columns(ks), columns(vs), q_offsets.begin(s), h, options, relative_scores));
      }
      sequences.push_back(concat(std::span<const Tensor<B, 2>>(heads), 1));
    }
    return sequences.empty() ? q : concat(std::span<const Tensor<B, 2>>(sequences), 0);
  }
}

/// The same with q, k and v side by side, as one projection makes them: qkv (rows, 3 width) -> (rows, width).
template <Backend B>
Tensor<B, 2> self_attention(const Tensor<B, 2>& qkv, const Offsets& offsets, const AttentionOptions& options) {
  if (qkv.size(1) % 3 != 0) raise<shape_error>(204, "self_attention: ", qkv.shape(), " is not three parts wide");
  detail::require_tensor("self_attention", qkv);
  const Index d = qkv.size(1) / 3;
  if constexpr (requires { B::self_attention(qkv.data(), offsets, options); }) {
    if (options.heads < 1 || d % options.heads != 0) {
      raise<config_error>(101, "self_attention: ", options.heads, " heads do not divide width ", d);
    }
    if (offsets.rows() != qkv.size(0))
      raise<shape_error>(207, "self_attention: offsets for ", offsets.rows(), " rows, ", qkv.shape());
    if (offsets.longest() > 65536) raise<shape_error>(207, "self_attention: a sequence has more than 65536 rows");
    return Tensor<B, 2>(B::self_attention(qkv.data(), offsets, options));
  } else {
    return attention(slice(qkv, 1, 0, d), slice(qkv, 1, d, 2 * d), slice(qkv, 1, 2 * d, 3 * d), offsets, offsets,
                     options);
  }
}

/// One step of AdamW on one parameter; optim/adamw.hpp has the formula.
struct AdamwUpdate {
  double lr = 0, beta1 = 0, beta2 = 0, eps = 0, weight_decay = 0, gradient_scale = 1;
  Index step = 1;  // 1 for the first
};

/// Updates the parameter p and the moments m and v with gradient g, all of one shape.
template <Backend B>
void adamw_update(typename B::tensor& p, typename B::tensor& m, typename B::tensor& v, const typename B::tensor& g,
                  const AdamwUpdate& u) {
  if constexpr (requires { B::adamw(p, m, v, g, u); }) {
    B::adamw(p, m, v, g, u);
  } else {
    using T = typename B::tensor;
    auto number = [](double c) { return B::full(Shape{}, static_cast<typename B::scalar>(c)); };
    auto times = [&](const T& a, double c) { return B::mul(a, number(c)); };
    const double k = static_cast<double>(u.step);
    const T scaled = times(g, u.gradient_scale);
    m = B::add(times(m, u.beta1), times(scaled, 1 - u.beta1));
    v = B::add(times(v, u.beta2), times(B::mul(scaled, scaled), 1 - u.beta2));
    const T root = times(B::sqrt(v), 1 / std::sqrt(1 - std::pow(u.beta2, k)));
    const T change = B::div(m, B::add(root, number(u.eps)));
    p = B::sub(times(p, 1 - u.lr * u.weight_decay), times(change, u.lr / (1 - std::pow(u.beta1, k))));
  }
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct KernelOps {
  using kernel_tensor = Dense<S>;

  // Operands come by value: memory that nobody else holds is reused for the result.
  static Dense<S> add(Dense<S> a, Dense<S> b);
  static Dense<S> sub(Dense<S> a, Dense<S> b);
  static Dense<S> mul(Dense<S> a, Dense<S> b);
  static Dense<S> div(Dense<S> a, Dense<S> b);
  static Dense<S> maximum(Dense<S> a, Dense<S> b);
  static Dense<S> sum(const Dense<S>& a, int axis);

  /// As many rows of a network's inside as stay in the caches of all threads from one layer to the next.
  static Index rows_in_cache();

  /// Product of the last two axes, batched. b is packed on the fly.
  static Dense<S> matmul(const Dense<S>& a, const Dense<S>& b, bool transpose_a, bool transpose_b);

  /// Packs a weight (out, in) once, or that of a convolution (out, in, taps); `linear` and `conv1d` then use the packed
  /// form. For inference: the weight must not change afterwards. Returns whether all its numbers are finite: they are
  /// read anyway.
  static bool prepare(const Dense<S>& weight);
  static Dense<S> linear(const Dense<S>& x, const Dense<S>& weight, const Dense<S>* bias, Activation act,
                         const Dense<S>* residual, const Dropout& drop = {});

  /// nn/conv1d.hpp, without dilation. The sequences of x lie in it by `before`, those of the result by `after`.
  static Dense<S> conv1d(const Dense<S>& x, const Offsets& before, const Offsets& after, const Dense<S>& weight,
                         const Dense<S>* bias, Index stride, Index padding, Activation act);
  static Dense<S> conv1d_weight_vjp(const Dense<S>& x, const Offsets& before, const Offsets& after, Index taps,
                                    Index stride, Index padding, const Dense<S>& dy);
  static Dense<S> conv1d_input_vjp(const Dense<S>& weight, const Offsets& before, const Offsets& after, Index stride,
                                   Index padding, const Dense<S>& dy);

  static Dense<S> activate(const Dense<S>& x, Activation act, const Dropout& drop = {});
  static Dense<S> activate_vjp(const Dense<S>& x, const Dense<S>& dy, Activation act, const Dropout& drop = {});

  static Dense<S> layer_norm(const Dense<S>& x, const Dense<S>& weight, const Dense<S>& bias, double eps);
  static Dense<S> add_layer_norm(const Dense<S>& x, const Dense<S>& residual, const Dense<S>& weight,
                                 const Dense<S>& bias, double eps);
  /// {dx, dweight, dbias}
  static std::array<Dense<S>, 3> layer_norm_vjp(const Dense<S>& x, const Dense<S>& weight, double eps,
                                                const Dense<S>& dy);

  static Dense<S> softmax(const Dense<S>& x);
  static Dense<S> dropout(const Dense<S>& x, const Dropout& d);

  static Dense<S> attention(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v, const Offsets& q_offsets,
                            const Offsets& k_offsets, const AttentionOptions& options,
                            const Dense<S>* relative_scores = nullptr);
  /// {dq, dk, dv}
  static std::array<Dense<S>, 3> attention_vjp(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v,
                                               const Offsets& q_offsets, const Offsets& k_offsets,
                                               const AttentionOptions& options, const Dense<S>& dy);
  static Dense<S> self_attention(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options);
  static Dense<S> self_attention_vjp(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options,
                                     const Dense<S>& dy);

  /// Updates parameter and moments in place when nobody else holds them, else makes new ones.
  static void adamw(Dense<S>& parameter, Dense<S>& m, Dense<S>& v, const Dense<S>& gradient, const AdamwUpdate& update);
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_BACKEND_KERNEL_OPS_IPP  // <motionlang/backend/kernel_ops.ipp>
#define MOTIONLANG_HAS_BACKEND_KERNEL_OPS_IPP
/// Bodies of kernel_ops.hpp: shapes to pointers, and the split of the work over threads.
///
/// Work is split over rows or columns of the result only, never over a summed index.

#include <numeric>    // gcd

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_BROADCAST_HPP  // <motionlang/backend/detail/broadcast.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_BROADCAST_HPP
/// How two operands of a broadcasting operation lie in memory, reduced to the cases that a vectorised loop can handle.

#include <optional>  // no simple pattern

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The result as a matrix (outer, inner); in each operand an axis is either walked along or repeated.
struct BroadcastPattern {
  struct Operand {
    bool outer = true, inner = true;  // false: repeated
  };
  Index outer = 1, inner = 1;
  Operand a, b;
};

/// The pattern of a and b in the result shape s, or nothing if it takes more than one change between walked and
/// repeated.
inline std::optional<BroadcastPattern> broadcast_pattern(const Shape& a, const Shape& b, const Shape& s) {
  BroadcastPattern p;
  int group = 0;  // 0: inner, 1: outer; from the last axis backwards
  bool started[2] = {false, false};
  for (int i = s.rank() - 1; i >= 0; --i) {
    if (s[i] == 1) continue;
    const int ia = i - (s.rank() - a.rank()), ib = i - (s.rank() - b.rank());
    const bool wa = ia >= 0 && a[ia] != 1, wb = ib >= 0 && b[ib] != 1;
    if (started[group] && (group == 0 ? p.a.inner != wa || p.b.inner != wb : p.a.outer != wa || p.b.outer != wb)) {
      if (++group == 2) return std::nullopt;
    }
    started[group] = true;
    if (group == 0)
      p.a.inner = wa, p.b.inner = wb, p.inner *= s[i];
    else
      p.a.outer = wa, p.b.outer = wb, p.outer *= s[i];
  }
  return p;
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_KERNELS_HPP  // <motionlang/backend/detail/kernels.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_KERNELS_HPP
/// The kernels behind the Eigen and xtensor backends: one text, compiled for several instruction sets, chosen at run
/// time.
///
/// The files *.inc are included once per instruction set, with the compiler told to generate code for it;
/// `kernels<S>()` is the table of the best one that this processor has. A program built without any -march therefore
/// runs as fast as one built for the machine. Other processors use the first table, in 16-byte vectors of the compiler
/// (SSE2, NEON, ...). Nothing here knows about tensors or threads: pointers, sizes, and ranges of rows.

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_GELU_TABLE_HPP  // <motionlang/backend/detail/gelu_table.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_GELU_TABLE_HPP
/// The difference of relu(x) and gelu(x), as polynomials of degree 4 around 0, 1/4, 2/4, ... 31/4.
///
/// gelu(x) = x Phi(x) = max(x, 0) - g(|x|),   g(c) = c (1 - Phi(c)) (Hendrycks and Gimpel 2016, Phi: normal
/// distribution function). g is bounded by 0.17 and dies out above c = 5.5. Processors that look up 32 numbers in one
/// instruction so take 14 instructions.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// g(i / 4 + d) = sum over n of by_power[n][i] d^n for |d| <= 1/8. Wrong by 5e-8 at most, by 1e-7 of g for i = 0.
struct GeluTable {
  static constexpr int cells = 32, degree = 4;
  static constexpr double width = 0.25;
  alignas(64) float by_power[degree + 1][cells];
};

/// Taylor's series in every cell, whose powers 5 and 6 are replaced by lower ones (Chebyshev's economisation).
constexpr GeluTable make_gelu_table() {
  constexpr int terms = 16;
  GeluTable table{};
  double density = 0.39894228040143268, above = 0.5;  // phi and 1 - Phi at the middle of the cell
  for (int i = 0; i < GeluTable::cells; ++i) {
    const double c = GeluTable::width * i;
    double p[terms] = {density}, q[terms] = {above}, g[terms] = {c * above};
    for (int n = 1; n < terms; ++n) {
      p[n] = -(c * p[n - 1] + (n > 1 ? p[n - 2] : 0)) / n;  // phi' = -x phi
      q[n] = -p[n - 1] / n;
      g[n] = c * q[n] + q[n - 1];
    }
    // Polynomials that are small for |u| <= 1, u = d / (1/8), are taken away: u^2 T_4(u) / 8 for u^6 (it keeps g(0) =
    // 0), T_5(u) / 16 for u^5.
    constexpr double square = GeluTable::width * GeluTable::width / 4;
    g[4] += g[6] * square, g[2] -= g[6] * square * square / 8;
    g[3] += g[5] * square * 20 / 16, g[1] -= g[5] * square * square * 5 / 16;
    for (int n = 0; n <= GeluTable::degree; ++n) table.by_power[n][i] = static_cast<float>(g[n]);
    density = above = 0;
    for (int n = terms; n-- > 0;) density = density * GeluTable::width + p[n], above = above * GeluTable::width + q[n];
  }
  return table;
}
inline constexpr GeluTable gelu_table = make_gelu_table();

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_INSTRUCTION_SET_HPP  // <motionlang/core/instruction_set.hpp>
#define MOTIONLANG_HAS_CORE_INSTRUCTION_SET_HPP
/// Instruction sets beyond the plain ones of the compiler, chosen while the program runs: one binary for all
/// processors.
///
/// MOTIONLANG_KERNELS (portable, avx2, avx512, avx512_bf16, amx) in the environment chooses instead of the processor.

#if defined(__x86_64__)
// Features for the target attribute of GCC and Clang in code for these sets; processor_has asks for them.
#define MOTIONLANG_AVX2 "avx2,fma"
#define MOTIONLANG_AVX512 "avx512f,avx512vl,avx512dq,avx512bw," MOTIONLANG_AVX2
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Each set includes those before it. The last two differ from avx512 only in products of bfloat16.
enum class Isa { portable, avx2, avx512, avx512_bf16, amx, best };

#if defined(__x86_64__)
bool has_amx_bf16();
#endif

bool processor_has(Isa isa);

/// The set that MOTIONLANG_KERNELS names, or the best one. Throws config_error 103 for an unknown name and for one that
/// this processor lacks.
Isa wanted_isa();

// Clang inlines less into such functions than GCC, and code that is not inlined uses narrow registers.
#if defined(__x86_64__) && !defined(__clang__)
#define MOTIONLANG_WIDER_COPIES
/// avx512, avx2 or portable: the sets that differ for code without products of bfloat16.
Isa widest_vectors();
template <class F>
__attribute__((target(MOTIONLANG_AVX2), flatten)) void with_avx2(const F& f) {
  f();
}
template <class F>
__attribute__((target(MOTIONLANG_AVX512), flatten)) void with_avx512(const F& f) {
  f();
}
#endif

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_INSTRUCTION_SET_IPP  // <motionlang/core/instruction_set.ipp>
#define MOTIONLANG_HAS_CORE_INSTRUCTION_SET_IPP
// Bodies of instruction_set.hpp.

#if defined(__x86_64__)
#include <cpuid.h>  // what the processor has
#if defined(__linux__)
#include <sys/syscall.h>  // arch_prctl
#include <unistd.h>       // syscall
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

#if defined(__x86_64__)
/// Bit of a register (EAX 0 ... EDX 3) that the CPUID instruction gives for leaf 7.
inline bool cpuid_bit(unsigned subleaf, int register_number, int bit) {
  unsigned r[4] = {};
  return __get_cpuid_count(7, subleaf, &r[0], &r[1], &r[2], &r[3]) != 0 && (r[register_number] >> bit & 1u) != 0;
}
MOTIONLANG_BODY bool has_amx_bf16() { return cpuid_bit(0, 3, 24) && cpuid_bit(0, 3, 22); }

/// Programs must ask Linux for the registers of AMX once (ARCH_REQ_XCOMP_PERM, XFEATURE_XTILEDATA).
inline bool may_use_amx() {
#if defined(__linux__)
  return syscall(SYS_arch_prctl, 0x1023, 18) == 0;
#else
  return false;
#endif
}
#endif

MOTIONLANG_BODY bool processor_has(Isa isa) {
#if defined(__x86_64__)
  switch (isa) {
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case Isa::avx512:
      return processor_has(Isa::avx2) && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
    case Isa::avx512_bf16:
      return processor_has(Isa::avx512) && cpuid_bit(1, 0, 5);
    case Isa::amx:
      return processor_has(Isa::avx512) && has_amx_bf16() && may_use_amx();
    default:
      return true;
  }
#else
  return isa == Isa::portable || isa == Isa::best;
#endif
}

MOTIONLANG_BODY Isa wanted_isa() {
  static const Isa wanted = [] {
    const char* name = std::getenv("MOTIONLANG_KERNELS");
    if (name == nullptr || *name == 0) return Isa::best;
    constexpr std::array<const char*, 5> names{"portable", "avx2", "avx512", "avx512_bf16", "amx"};
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto isa = static_cast<Isa>(i);
      if (std::strcmp(name, names[i]) == 0 && processor_has(isa)) return isa;
    }
    raise<config_error>(103, "MOTIONLANG_KERNELS=", name,
                        " is not one of portable, avx2, avx512, avx512_bf16, amx, or not in this processor");
  }();
  return wanted;
}

#ifdef MOTIONLANG_WIDER_COPIES
MOTIONLANG_BODY Isa widest_vectors() {
  for (const Isa isa : {Isa::avx512, Isa::avx2}) {
    if (wanted_isa() >= isa && processor_has(isa)) return isa;
  }
  return Isa::portable;
}
#endif

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// c (m x n) = act(a (m x k) B + bias + residual). B is packed in panels.
template <class S>
struct Gemm {
  Index m = 0, n = 0, k = 0;
  const S* a = nullptr;
  Index lda = 0;  // distance of rows of a (of its transpose, (k x m), when a_transposed)
  bool a_transposed = false;
  const S* panels = nullptr;
  S* c = nullptr;
  Index ldc = 0;
  const S* bias = nullptr;
  const S* residual = nullptr;
  Index ldr = 0;
  Activation act = Activation::none;
  const std::byte* after = nullptr;  // what is read after this product: a panel's share of it is fetched meanwhile
  Index after_bytes = 0;

  /// Where in `after` a thread goes on that has multiplied panels first, first + 1, ... of `count`; `otherwise` if
  /// there is no `after`.
  const std::byte* following(Index first, Index count, const void* otherwise) const {
    return after == nullptr ? static_cast<const std::byte*>(otherwise) : after + after_bytes / 64 * first / count * 64;
  }
};

/// Attention over packed sequences: q (query rows, heads * width), k and v (key rows, ...), each a part of a wider
/// tensor.
template <class S>
struct Attention {
  const S *q = nullptr, *k = nullptr, *v = nullptr;
  Index q_stride = 0, k_stride = 0, v_stride = 0;
  S* o = nullptr;
  Index o_stride = 0;
  const Index *q_offsets = nullptr, *k_offsets = nullptr;
  Index heads = 1, width = 0;
  bool causal = false;
  Dropout dropout{};
  // forward only: (heads, 2 reach + 1), the number of distance d in column d + reach
  const S* relative_scores = nullptr;
  Index reach = 0;
};
template <class S>
struct AttentionGradients {
  const S* d_o = nullptr;
  S *d_q = nullptr, *d_k = nullptr, *d_v = nullptr;  // strides as q, k, v
};

template <class S>
struct LayerNorm {
  const S *x = nullptr, *residual = nullptr, *weight = nullptr, *bias = nullptr;
  Index width = 0;
  S eps = S(1e-5);
  S* y = nullptr;
};

/// y (rows, width) = act(z^T + bias + residual), z (width, rows).
template <class S>
struct Transposed {
  const S *z = nullptr, *bias = nullptr, *residual = nullptr;
  Index rows = 0, width = 0;
  Activation act = Activation::none;
  S* y = nullptr;
};

template <class S>
struct AdamwStep {
  S *p = nullptr, *m = nullptr, *v = nullptr;
  const S* g = nullptr;
  S beta1{}, rest1{}, beta2{}, rest2{}, step{}, correction{}, eps{}, decay{}, gradient_scale{};
};

/// y[i] = op(a[i], b[i]); an operand that is repeated has one number for all i.
enum class BinaryOp { add, sub, mul, div, maximum };
template <class S>
struct Binary {
  BinaryOp op{};
  const S *a = nullptr, *b = nullptr;
  bool a_repeated = false, b_repeated = false;
  Index count = 0;
  S* y = nullptr;  // may be a or b
};

/// Products with the same panels by tiles of bfloat16, three for every float (Precision::bf16x3, float_tiles.inc).
struct FloatTiles {
  Index tile_rows;
  Index (*gemm_rows)(Index k);
  Index (*gemm_scratch)(Index k);
  void (*gemm_block)(const Gemm<float>&, Index r0, Index r1, Index j0, Index j1, float* scratch);
};

/// Entry points of one instruction set.
template <class S>
struct Kernels {
  Isa isa;
  const char* name;
  Index panel_width, tile_rows;
  Index (*gemm_rows)(Index k);     // of A in a block
  Index (*gemm_scratch)(Index k);  // numbers
  void (*pack_rows)(const S* b, Index k, Index n, Index stride, Index k0, Index k1, S* panels);
  bool (*pack_transposed)(const S* b, Index k, Index n, Index stride, Index first, Index last, S* panels);
  void (*gemm_block)(const Gemm<S>&, Index r0, Index r1, Index j0, Index j1, S* scratch);
  Index (*attention_scratch)(Index keys, Index width);
  void (*attention_head)(const Attention<S>&, Index sequence, Index head, Index piece, Index pieces, S* scratch);
  void (*dropout)(const S* x, Index n, Index first, const Dropout&, S* y);
  void (*layer_norm_rows)(const LayerNorm<S>&, Index first, Index last);
  void (*softmax_rows)(const S* x, Index n, Index first, Index last, S* y, S* scratch);
  void (*transpose)(const Transposed<S>&, Index first, Index last);
  void (*activate)(const S* x, Index n, Activation, S* y);
  void (*binary)(const Binary<S>&);
  void (*error_function)(const S* x, Index n, S* y);
  void (*row_sums)(const S* x, Index n, Index first, Index last, S* y);
  void (*column_sums)(const S* x, Index rows, Index width, Index first, Index last, S* y);
};
/// The same of training: a table of its own, so that a program that does not train does not compile it.
template <class S>
struct GradientKernels {
  Index (*attention_scratch)(Index queries, Index keys, Index width);
  void (*attention_head)(const Attention<S>&, const AttentionGradients<S>&, Index sequence, Index head, S* scratch);
  void (*layer_norm_rows)(const LayerNorm<S>&, const S* dy, S* dx, S* moments, Index first, Index last);
  void (*layer_norm_columns)(const LayerNorm<S>&, const S* dy, const S* moments, S* dweight, S* dbias, Index rows,
                             Index first, Index last);
  void (*activate)(const S* x, const S* dy, Index n, Activation, S* dx);
  void (*adamw)(const AdamwStep<S>&, Index first, Index last);
};

/// Products of numbers rounded to bfloat16, with sums in float; attention with such products. B is packed in panels
/// that are the same for all instruction sets, except numbers below 2^-126.
struct Bf16Kernels {
  const char* name;
  Index tile_rows;
  Index (*gemm_rows)(Index k);     // of A in a block
  Index (*gemm_scratch)(Index k);  // numbers
  void (*pack_rows)(const float* b, Index k, Index n, Index stride, Index k0, Index k1, std::uint16_t* panels);
  bool (*pack_transposed)(const float* b, Index k, Index n, Index stride, Index first, Index last,
                          std::uint16_t* panels);
  void (*gemm_block)(const Gemm<float>&, const std::uint16_t* panels, Index r0, Index r1, Index j0, Index j1,
                     float* scratch);
  Index (*attention_scratch)(Index keys, Index width);
  void (*attention_head)(const Attention<float>&, Index sequence, Index head, Index piece, Index pieces,
                         float* scratch);
  Index (*attention_vjp_scratch)(Index queries, Index keys, Index width);
  void (*attention_head_vjp)(const Attention<float>&, const AttentionGradients<float>&, Index sequence, Index head,
                             float* scratch);
};
/// Columns of a panel, and its rows: k, filled up to whole tiles.
inline constexpr Index bf16_columns = 32;
constexpr Index bf16_depth(Index k) { return std::max<Index>(32, (k + 31) / 32 * 32); }

}  // namespace detail
MOTIONLANG_NAMESPACE_END

// GCC and clang spell "generate code for these instructions" differently.
#if defined(__clang__)
#define MOTIONLANG_PRAGMA(text) _Pragma(#text)
#define MOTIONLANG_TARGET_PUSH(features) \
  MOTIONLANG_PRAGMA(clang attribute push(__attribute__((target(features))), apply_to = function))
#define MOTIONLANG_TARGET_POP _Pragma("clang attribute pop")
#else
#define MOTIONLANG_PRAGMA(text) _Pragma(#text)
#define MOTIONLANG_TARGET_PUSH(features) _Pragma("GCC push_options") MOTIONLANG_PRAGMA(GCC target(features))
#define MOTIONLANG_TARGET_POP _Pragma("GCC pop_options")
#endif

#define MOTIONLANG_ISA portable
#define MOTIONLANG_VECTOR_BYTES 16
#if defined(__OPTIMIZE__)
#define MOTIONLANG_TILE_ROWS 6
#else  // without the optimiser higher tiles would only take longer to compile
#define MOTIONLANG_TILE_ROWS 2
#endif
#define MOTIONLANG_TEXT_BACKEND_DETAIL_KERNELS_INC
#include "stmc.hpp"
#undef MOTIONLANG_TEXT_BACKEND_DETAIL_KERNELS_INC
#undef MOTIONLANG_ISA
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS

// Without the optimiser the wider kernels would only take longer to compile.
#if defined(__x86_64__) && defined(__OPTIMIZE__)
#define MOTIONLANG_WIDE_KERNELS
MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX2)
#define MOTIONLANG_ISA avx2
#define MOTIONLANG_VECTOR_BYTES 32
#define MOTIONLANG_TILE_ROWS 6
#define MOTIONLANG_TEXT_BACKEND_DETAIL_KERNELS_INC
#include "stmc.hpp"
#undef MOTIONLANG_TEXT_BACKEND_DETAIL_KERNELS_INC
#undef MOTIONLANG_ISA
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS
MOTIONLANG_TARGET_POP

MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX512)
#define MOTIONLANG_ISA avx512
#define MOTIONLANG_VECTOR_BYTES 64
#define MOTIONLANG_TILE_ROWS 14
#define MOTIONLANG_TEXT_BACKEND_DETAIL_KERNELS_INC
#include "stmc.hpp"
#undef MOTIONLANG_TEXT_BACKEND_DETAIL_KERNELS_INC
#undef MOTIONLANG_ISA
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS
MOTIONLANG_TARGET_POP

#define MOTIONLANG_VECTOR_BYTES 64
#define MOTIONLANG_TILE_ROWS 14
#define MOTIONLANG_INLINE inline __attribute__((always_inline))
MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX512 ",avx512bf16,amx-tile,amx-bf16")
MOTIONLANG_NAMESPACE_BEGIN
namespace detail::avx512 {
// Tiles of bf16.inc for the instructions of x86 processors that multiply bfloat16. As assembly: the intrinsics would
// need a large header, and their types differ between compilers.

/// Rounds in one instruction: numbers below 2^-126 to 0.
class ConvertingTile {
 public:
  using Element = std::uint16_t;
  static void round_row(const float* x, Index n, Index padded, Element* y) {
    for (Index i = 0; i < padded; i += lanes<float>) {
      *reinterpret_cast<LooseHalves*>(y + i) = rounded(x + i, n - i);
    }
  }
  static void round_pairs(const float* x, Index nx, const float* y, Index ny, std::uint16_t* out) {
    for (Index c = 0; c < bf16_columns; c += lanes<float>) {
      const Words first = __builtin_convertvector(rounded(x + c, nx - c), Words),
                  second = __builtin_convertvector(rounded(y + c, ny - c), Words);
      store_words(out + 2 * c, first | second << 16);
    }
  }

 private:
  MOTIONLANG_INLINE static Halves rounded(const float* x, Index n) {
    const Vec<float> from = load_first(x, n);
    Halves h;
    asm("vcvtneps2bf16 %1, %0" : "=v"(h) : "v"(from));
    return h;
  }
};

/// AVX512-BF16: one instruction adds 16 sums of two products. AMD since Zen 4, Intel since Cooper Lake.
struct DotTile : RegisterTile<DotTile>, ConvertingTile {
  static constexpr const char* name = "avx512_bf16";
  static constexpr int rows = MOTIONLANG_TILE_ROWS;

  MOTIONLANG_INLINE static Vec<float> add_products(Vec<float> c, const Words& x, const Words& b) {
    asm("vdpbf16ps %2, %1, %0" : "+v"(c) : "v"(x), "v"(b));
    return c;
  }
  template <int R>
  static void rows_of(const Element* a, Index pitch, const std::uint16_t* panel, Index depth, float* c, Index ldc,
                      Index columns, const Epilogue<float>& e, Ahead ahead) {
    Vec<float> c0[R], c1[R];
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<float>{};
    fetch_result<float, R>(c, ldc, e);
    for (Index k = 0; k < depth; k += 2, panel += 2 * bf16_columns) {
      ahead.fetch();
      const Words b0 = *reinterpret_cast<const LooseWords*>(panel),
                  b1 = *reinterpret_cast<const LooseWords*>(panel + bf16_columns);
#pragma GCC unroll 16
      for (int i = 0; i < R; ++i) {
        std::uint32_t pair;
        std::memcpy(&pair, a + i * pitch + k, sizeof pair);
        const Words x = pair - Words{};
        c0[i] = add_products(c0[i], x, b0);
        c1[i] = add_products(c1[i], x, b1);
      }
    }
    put_result<float, R>(c0, c1, c, ldc, columns, e);
  }
};

MOTIONLANG_INLINE bool any_nan(const Vec<float>& x) {
  bool any = false;
  for (int i = 0; i < lanes<float>; ++i) any |= x[i] != x[i];
  return any;
}

/// The three parts of floats in a panel of `k` rows, filled up to whole tiles: [k / 32][part][pair of k][column][2].
/// The parts are cut off, not rounded: that takes a third of the time.
class PanelSplit {
 public:
  static constexpr Index parts = 3;
  Index each = 0;  // pairs of k with every step of a tile

  PanelSplit() = default;
  /// following: what is read after the panel; it is fetched into the second-level cache meanwhile.
  PanelSplit(const float* panel, Index k, const std::byte* following, std::uint16_t* out)
      : from_(panel), following_(following), k_(k), depth_(bf16_depth(k)), begin_(out) {}
  const std::uint16_t* begin() const { return begin_; }
  /// True if all numbers so far were finite.
  bool sound() const { return !any_nan(left_); }

  /// The next pairs of k.
  MOTIONLANG_INLINE void some(Index pairs_of_k) {
    for (const Index end = std::min(depth_, at_ + 2 * pairs_of_k); at_ < end; at_ += 2) {
      const float* from = from_ + at_ * bf16_columns;
      constexpr Index row_bytes = 4 * bf16_columns;
      for (Index byte = 0; byte < 2 * row_bytes; byte += 64)
        __builtin_prefetch(following_ + at_ * row_bytes + byte, 0, 2);
      std::uint16_t* out = begin_ + (at_ / 32 * 32 * parts + at_ % 32) * bf16_columns;
#pragma GCC unroll 2
      for (Index c = 0; c < bf16_columns; c += lanes<float>) {
        Vec<float> even = at_ < k_ ? load(from + c) : Vec<float>{},
                   odd = at_ + 1 < k_ ? load(from + bf16_columns + c) : Vec<float>{};
#pragma GCC unroll 3
        for (Index p = 0; p < parts; ++p) {
          if (p + 1 == parts) left_ += even + odd;
          const Words first = (Words)even & 0xFFFF0000u, second = (Words)odd & 0xFFFF0000u;
          store_words(out + p * 32 * bf16_columns + 2 * c, pairs(first, second));
          even -= (Vec<float>)first, odd -= (Vec<float>)second;
        }
      }
    }
  }
  void finish() { some(depth_); }

 private:
  const float* from_ = nullptr;
  const std::byte* following_ = nullptr;
  Index k_ = 0, depth_ = 0, at_ = 0;
  std::uint16_t* begin_ = nullptr;
  Vec<float> left_{};  // the sum of what the first two parts leave: NaN if a number is not finite
};

/// AMX: registers of 16 rows of 64 bytes; one instruction multiplies 16 x 32 by 32 x 16. Intel since Sapphire Rapids.
/// Registers 0 1 / 2 3 are the sums of 32 rows and 32 columns, 4 5 the rows of A, 6 7 the columns of B.
///
/// These instructions are 16 times as fast as those in float, so that everything else counts. The sums begin with the
/// bias (of bfloat16). A piece of a panel stays in the first-level cache while rows of A pass by it (tileloaddt1). What
/// else is to be done with a tile is done beside the products of the next one, some rows with every step of k: the
/// vector units are idle then.
///
/// Parts: of every number; more than one are those of floats (float_tiles.inc). The parts of 32 numbers lie together,
/// part after part.
template <Index Parts>
class AmxTile : public ConvertingTile {
 public:
  static constexpr const char* name = "amx";
  static constexpr Index parts = Parts;
  static constexpr int rows = 32;
  static constexpr bool even = false;             // 32 rows cost as much as 17
  static constexpr bool bias_first = parts == 1;  // else at last, as with multiply-adds
  static constexpr Index depth(Index k) { return bf16_depth(k); }
  static constexpr Index pieces(Index depth, Index tiles) { return tiles > 3 ? (depth + 511) / 512 : 1; }

  static void begin() {
    static constexpr Shapes shapes;
    asm volatile("ldtilecfg %0" : : "m"(shapes));
  }
  static void end() { asm volatile("tilerelease"); }

  void multiply(const TileProduct<Element>& t) {
    const bool lower = t.height > 16, once = t.first && t.last;
    const bool plain = t.e.residual == nullptr && !t.e.accumulate && (bias_first || t.e.bias == nullptr) &&
                       t.e.act == Activation::none;
    const bool direct = once && plain && t.height == rows && t.columns == bf16_columns && !t.stream;
    if (once) turn_ = 1 - turn_;
    float* own = sums_[once ? turn_ : t.number];
    if (t.first)
      begin_with(bias_first ? t.e.bias : nullptr, t.columns, lower);
    else
      load_sums(own, bf16_columns, lower);
    const Element* a = t.a;
    const std::uint16_t* panel = t.panel;
    const Index a_stride = 2 * t.pitch, steps = t.depth / 32;
    const Index put_each = (waiting_.height - put_ + steps - 1) / steps;
    const std::byte* ahead = t.ahead.at;
    const Index ahead_bytes = 16 * t.ahead.step;  // with every step
    const auto products = [&]<bool panel_stays>() {
      for (Index step = 0; step < steps; ++step, a += 32 * parts, panel += 32 * parts * bf16_columns) {
        add_products<panel_stays>(a, a_stride, a + 16 * t.pitch, panel, lower);
        for (Index byte = 0; byte < ahead_bytes; byte += 64) __builtin_prefetch(ahead + byte, 0, 2);
        ahead += ahead_bytes;
        if constexpr (parts > 1) t.next->some(t.next->each);
        put(put_each);
      }
    };
    t.panel_stays ? products.template operator()<true>() : products.template operator()<false>();
    store_sums(direct ? t.c : own, direct ? t.ldc : bf16_columns, lower);
    if (t.last && !direct) waiting_ = t, waiting_sums_ = own, put_ = 0;
  }
  void finish() { put(waiting_.height - put_); }

 private:
  struct alignas(64) Shapes {
    std::uint8_t palette = 1, start_row = 0, reserved[14] = {};
    std::uint16_t row_bytes[16] = {64, 64, 64, 64, 64, 64, 64, 64};
    std::uint8_t rows[16] = {16, 16, 16, 16, 16, 16, 16, 16};
  };

  static void begin_with(const float* bias, Index columns, bool lower) {
    if (bias == nullptr) {
      asm volatile("tilezero %%tmm0\n\ttilezero %%tmm1\n\ttilezero %%tmm2\n\ttilezero %%tmm3" : : : "memory");
      return;
    }
    float some[bf16_columns] = {};
    if (columns < bf16_columns) {
      std::copy(bias, bias + columns, some);
      bias = some;
    }
    load_sums(bias, 0, lower);  // the same row, 16 times
  }
  /// Part p of 32 rows (16 unless `lower`) of 32 numbers, into registers 4 and 5, and of 32 columns, into 6 and 7. What
  /// does not stay in the first-level cache is loaded past it. Memory is read, which the compiler is not told: it knows
  /// of those instructions that begin and store the sums.
  template <Index p, bool stays>
  MOTIONLANG_INLINE static void load_rows(const Element* upper, const Element* below, Index stride, bool lower) {
    if constexpr (stays) {
      asm volatile("tileloadd %c2(%0,%1,1), %%tmm4" : : "r"(upper), "r"(stride), "i"(64 * p));
      if (lower) asm volatile("tileloadd %c2(%0,%1,1), %%tmm5" : : "r"(below), "r"(stride), "i"(64 * p));
    } else {
      asm volatile("tileloaddt1 %c2(%0,%1,1), %%tmm4" : : "r"(upper), "r"(stride), "i"(64 * p));
      if (lower) asm volatile("tileloaddt1 %c2(%0,%1,1), %%tmm5" : : "r"(below), "r"(stride), "i"(64 * p));
    }
  }
  template <Index p, bool stays>
  MOTIONLANG_INLINE static void load_columns(const std::uint16_t* panel) {
    constexpr Index at = p * 16 * pair_bytes;
    if constexpr (stays) {
      asm volatile("tileloadd %c2(%0,%1,1), %%tmm6\n\ttileloadd %c3(%0,%1,1), %%tmm7"
                   :
                   : "r"(panel), "r"(Index{pair_bytes}), "i"(at), "i"(at + 64));
    } else {
      asm volatile("tileloaddt1 %c2(%0,%1,1), %%tmm6\n\ttileloaddt1 %c3(%0,%1,1), %%tmm7"
                   :
                   : "r"(panel), "r"(Index{pair_bytes}), "i"(at), "i"(at + 64));
    }
  }
  MOTIONLANG_INLINE static void add_loaded(bool lower) {
    asm volatile("tdpbf16ps %tmm6, %tmm4, %tmm0\n\ttdpbf16ps %tmm7, %tmm4, %tmm1");
    if (lower) asm volatile("tdpbf16ps %tmm6, %tmm5, %tmm2\n\ttdpbf16ps %tmm7, %tmm5, %tmm3");
  }
  /// 32 rows times 32 columns, 32 of k. Of parts the largest product comes last; the order saves loads.
  template <bool panel_stays>
  MOTIONLANG_INLINE static void add_products(const Element* upper, Index stride, const Element* below,
                                             const std::uint16_t* panel, bool lower) {
    const auto rows_part = [&]<Index p>(std::integral_constant<Index, p>) {
      load_rows<p, !panel_stays>(upper, below, stride, lower);
    };
    const auto columns_part = [&]<Index p>(std::integral_constant<Index, p>) { load_columns<p, panel_stays>(panel); };
    constexpr std::integral_constant<Index, 0> first;
    if constexpr (parts == 1) {
      columns_part(first), rows_part(first), add_loaded(lower);
    } else {
      constexpr std::integral_constant<Index, 1> second;
      constexpr std::integral_constant<Index, 2> third;
      rows_part(first), columns_part(third), add_loaded(lower);
      columns_part(second), add_loaded(lower);
      rows_part(second), add_loaded(lower);
      columns_part(first), add_loaded(lower);
      rows_part(third), add_loaded(lower);
      rows_part(first), add_loaded(lower);
    }
  }
  static void load_sums(const float* c, Index ldc, bool lower) {
    asm volatile("tileloadd (%0,%1,1), %%tmm0\n\ttileloadd 64(%0,%1,1), %%tmm1" : : "r"(c), "r"(4 * ldc) : "memory");
    if (lower)
      asm volatile("tileloadd (%0,%1,1), %%tmm2\n\ttileloadd 64(%0,%1,1), %%tmm3"
                   :
                   : "r"(c + 16 * ldc), "r"(4 * ldc)
                   : "memory");
  }
  static void store_sums(float* c, Index ldc, bool lower) {
    asm volatile("tilestored %%tmm0, (%0,%1,1)\n\ttilestored %%tmm1, 64(%0,%1,1)" : : "r"(c), "r"(4 * ldc) : "memory");
    if (lower)
      asm volatile("tilestored %%tmm2, (%0,%1,1)\n\ttilestored %%tmm3, 64(%0,%1,1)"
                   :
                   : "r"(c + 16 * ldc), "r"(4 * ldc)
                   : "memory");
  }

  /// Puts the next rows of the tile that waits.
  MOTIONLANG_INLINE void put(Index count) {
    const TileProduct<Element>& w = waiting_;
    const Index first = put_, n = std::min(count, w.height - first);
    if (n <= 0) return;
    put_ += n;
    float *own = waiting_sums_ + first * bf16_columns, *c = w.c + first * w.ldc;
    const bool act = w.e.act != Activation::none;
    const bool adds = w.e.residual != nullptr || w.e.accumulate || (!bias_first && w.e.bias != nullptr);
    for (Index r = 0; r < n && (adds || !act); ++r) {
      constexpr Index l = lanes<float>;
      Vec<float> c0 = load(own + r * bf16_columns), c1 = load(own + r * bf16_columns + l);
      // Not by put_result, which may be given other rows than those of c.
      if (w.e.accumulate)
        c0 += load_first(c + r * w.ldc, w.columns), c1 += load_first(c + r * w.ldc + l, w.columns - l);
      Epilogue<float> e = w.e.from_row(first + r);
      if (bias_first) e.bias = nullptr;
      e.accumulate = false, e.act = Activation::none;
      put_result<float, 1>(&c0, &c1, act || w.stream ? own + r * bf16_columns : c + r * w.ldc, w.ldc, w.columns, e);
    }
    if (act)
      activate_rows<float>(own, bf16_columns, n, w.columns, w.e.act, w.stream ? own : c,
                           w.stream ? bf16_columns : w.ldc);
    if (w.stream) stream_rows(own, n, c, w.ldc);
  }

  alignas(64) float sums_[most_tiles][rows * bf16_columns];  // of the tiles of a panel, or of two tiles in turn
  TileProduct<Element> waiting_{
      .a = nullptr, .pitch = 0, .height = 0, .panel = nullptr, .depth = 0, .c = nullptr, .ldc = 0, .columns = 0};
  float* waiting_sums_ = nullptr;
  Index put_ = 0;   // rows that are put already
  Index turn_ = 0;  // which of two sums
};
using FloatTile = AmxTile<3>;
//
// Products of floats by AMX, which multiplies bfloat16 16 times as fast as other instructions multiply floats.
//
//   Parts    a float is the sum of three bfloat16: 24 bits are three times 8. Of the nine products of the parts of two
//            floats the six largest are added up, the others are at most 3 2^-24 of the whole together, a tenth of that
//            mostly, and of either sign. The instruction adds up 32 products before it adds them to the sum, so that
//            the error is about half of that of one multiply-add after the other.
//   Panels   those of gemm.inc. A panel is split into scratch, beside the products with the panel before it, and so are
//            the rows of A.
//   Block    up to 1024 of k at a time: rows of A stay in the second-level cache (2 MB where there is AMX) beside the
//            split panel.
//   Order    as in gemm.inc: depends on k alone.
//   Limits   parts and their products below 2^-126 count as 0: exact are products of more than 2^-108. A sum that
//            overflows may be NaN. Rows of A and panels of B with a number that is not finite (or whose nearest
//            bfloat16 is not: from 3.39e38 on) have no parts: they are multiplied by gemm.inc.

/// 16 numbers, in parts: each the nearest bfloat16 to what those before it leave. What the last one leaves: 0, or NaN
/// if there are no parts.
MOTIONLANG_INLINE Vec<float> split_lanes(Vec<float> x, std::uint16_t* y) {
#pragma GCC unroll 3
  for (Index p = 0; p < FloatTile::parts; ++p) {
    Halves part;
    Words wide;
    asm("vcvtneps2bf16 %2, %0\n\tvpmovzxwd %0, %1" : "=v"(part), "=v"(wide) : "v"(x));
    *reinterpret_cast<LooseHalves*>(y + 32 * p) = part;
    x -= (Vec<float>)(wide << 16);
  }
  return x;
}
/// `count` rows of A, k numbers each, filled up to `depth`: [row][k / 32][part][k]. Whether all numbers have parts.
inline bool split_rows(const Rows<float>& a, Index count, Index k, Index depth, std::uint16_t* y, Index pitch) {
  constexpr Index l = lanes<float>;
  Vec<float> left{};
  const auto place = [&](Index row, Index at) { return y + row * pitch + at / 32 * 32 * FloatTile::parts + at % 32; };
  if (!a.transposed) {
    for (Index r = 0; r < count; ++r) {
      for (Index i = 0; i < depth; i += l) left += split_lanes(load_first(a.at + r * a.stride + i, k - i), place(r, i));
    }
    return !any_nan(left);
  }
  for (Index r = 0; r < count; r += l) {
    for (Index i = 0; i < depth; i += l) {
      Vec<float> square[lanes<float>];
#pragma GCC unroll 16
      for (int q = 0; q < lanes<float>; ++q) {
        const float* from = a.at + (i + q) * a.stride + r;
        if (i + q + l < k) __builtin_prefetch(from + l * a.stride);  // no prefetcher follows pieces so far apart
        square[q] = load_first(from, i + q < k ? count - r : 0);
      }
      transpose_lanes<float>(square);
      for (Index q = 0; q < std::min(count - r, l); ++q) left += split_lanes(square[q], place(r + q, i));
    }
  }
  return !any_nan(left);
}

/// The rows and panels of a product that have numbers without parts, by multiply-adds.
inline void multiply_odd_parts(const Gemm<float>& g, Index r0, Index r1, Index j0, Index j1, float* scratch) {
  for (Index j = j0; j < j1; ++j) {
    Mask<float> found{};
    const float* panel = g.panels + j * g.k * bf16_columns;
    for (Index i = 0; i < g.k * bf16_columns; i += lanes<float>) find_not_finite<float>(load(panel + i), found);
    if (any_negative<float>(found)) gemm_block(g, r0, r1, j, j + 1, scratch);
  }
  const Rows<float> rows{g.a, g.lda, g.a_transposed};
  for (Index r = r0; r < r1; ++r) {
    std::uint16_t parts[FloatTile::parts * 32];
    bool sound = true;
    for (Index k = 0; k < g.k; ++k) sound &= split_rows(rows.from(r).from_depth(k), 1, 1, 32, parts, 0);
    if (!sound) gemm_block(g, r, r + 1, j0, j1, scratch);
  }
}

/// How a product over k is split: blocks of k, and rows of A at a time.
struct FloatBlocks {
  Index all, count, depth, pitch, rows;  // depth: of a block at most; pitch: of rows in scratch

  explicit FloatBlocks(Index k)
      : all(bf16_depth(k)),
        count((all + depth_block - 1) / depth_block),
        depth(bf16_depth((all + count - 1) / count)),
        pitch(depth * FloatTile::parts + 32),
        rows(rows_at_once(2 * pitch, FloatTile::rows, 1280 * 1024)) {}
};
inline Index float_tile_rows(Index k) { return FloatBlocks(k).rows; }
/// Numbers of scratch that float_tile_block needs.
inline Index float_tile_scratch(Index k) {
  const FloatBlocks split(k);
  return (split.rows * split.pitch + 2 * split.depth * FloatTile::parts * bf16_columns) / 2;
}

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product.
inline void float_tile_block(const Gemm<float>& g, Index r0, Index r1, Index j0, Index j1, float* scratch) {
  bool sound = true;  // all numbers have parts
  const FloatBlocks split(g.k);
  const Index panel_size = split.depth * FloatTile::parts * bf16_columns;
  auto* const panels = reinterpret_cast<std::uint16_t*>(scratch);  // two in turn
  auto* const a = panels + 2 * panel_size;
  const bool stream = split.count == 1 && streams(g);
  FloatTile tile;
  FloatTile::begin();
  constexpr Index unit = FloatTile::rows;
  const Index units = (r1 - r0 + unit - 1) / unit, row_blocks = (r1 - r0 + split.rows - 1) / split.rows;
  const auto first_of = [&](Index block) { return 32 * part(split.all / 32, block, split.count); };
  int turn = 0;
  const auto splitting = [&](Index row_block, Index block, Index j) {
    const Index begin = first_of(block), end = std::min(g.k, first_of(block + 1));
    const float* from = g.panels + (j * g.k + begin) * bf16_columns;
    const float* next = j + 1 < j1 ? from + g.k * bf16_columns
                                   : g.panels + (j0 * g.k + (block + 1 < split.count ? end : 0)) * bf16_columns;
    const bool last = j + 1 == j1 && block + 1 == split.count && row_block + 1 == row_blocks;
    const auto* following = last ? g.following(j0, (g.n + bf16_columns - 1) / bf16_columns, next) : as_bytes(next);
    turn = 1 - turn;
    return PanelSplit(from, end - begin, following, panels + turn * panel_size);
  };
  PanelSplit panel = splitting(0, 0, j0);
  for (Index row_block = 0; row_block < row_blocks; ++row_block) {
    const Index top = r0 + unit * part(units, row_block, row_blocks);
    const Index rows = std::min(r1, r0 + unit * part(units, row_block + 1, row_blocks)) - top,
                tiles = (rows + unit - 1) / unit;
    for (Index block = 0; block < split.count; ++block) {
      const Index begin = first_of(block), k = std::min(g.k, first_of(block + 1)) - begin, depth = bf16_depth(k);
      sound &= split_rows(Rows<float>{g.a, g.lda, g.a_transposed}.from(top).from_depth(begin), rows, k, depth, a,
                          split.pitch);
      for (Index j = j0; j < j1; ++j) {
        panel.finish();
        sound &= panel.sound();
        const Index next_block = block + (j + 1 == j1 ? 1 : 0), next_rows = row_block + next_block / split.count;
        PanelSplit next = next_rows == row_blocks
                              ? PanelSplit()
                              : splitting(next_rows, next_block % split.count, j + 1 == j1 ? j0 : j + 1);
        next.each = (16 + tiles - 1) / tiles;
        for (Index t = 0; t < tiles; ++t) {
          const Index first = t * unit, row = top + first, column = j * bf16_columns;
          TileProduct<std::uint16_t> product{
              .a = a + first * split.pitch,
              .pitch = split.pitch,
              .height = std::min(rows - first, unit),
              .panel = panel.begin(),
              .depth = depth,
              .c = g.c + row * g.ldc + column,
              .ldc = g.ldc,
              .columns = std::min(g.n - column, bf16_columns),
              .e = Epilogue<float>::of(g, row, column, block == 0, block + 1 == split.count),
              .stream = stream,
              .next = &next};
          tile.multiply(product);
        }
        panel = next;
      }
    }
  }
  tile.finish();
  if (stream) end_of_streams();
  FloatTile::end();
  if (!sound) multiply_odd_parts(g, r0, r1, j0, j1, scratch);
}

/// The kernels of AVX-512 under the name of AMX, whose tiles (float_tiles) go with them.
inline const Kernels<float>& amx_table() {
  static const Kernels<float> t = [] {
    Kernels<float> k = table<float>();
    k.isa = Isa::amx, k.name = FloatTile::name;
    return k;
  }();
  return t;
}
inline const FloatTiles& float_tiles() {
  static constexpr FloatTiles t{FloatTile::rows, &float_tile_rows, &float_tile_scratch, &float_tile_block};
  return t;
}
}  // namespace detail::avx512
MOTIONLANG_NAMESPACE_END
MOTIONLANG_TARGET_POP
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS
#undef MOTIONLANG_INLINE
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The kernels of one instruction set, or nothing if this processor or this build does not have it.
template <class S>
const Kernels<S>* kernels_for(Isa isa) {
  if (isa == Isa::portable) return &portable::table<S>();
#if defined(MOTIONLANG_WIDE_KERNELS)
  if (isa == Isa::avx2) return processor_has(isa) ? &avx2::table<S>() : nullptr;
  if constexpr (std::is_same_v<S, float>) {
    if (isa == Isa::amx) return processor_has(isa) ? &avx512::amx_table() : nullptr;
  }
  if (isa != Isa::best) return processor_has(Isa::avx512) ? &avx512::table<S>() : nullptr;
#endif
  if (isa != Isa::best) return nullptr;
  for (Isa better : {Isa::amx, Isa::avx512, Isa::avx2}) {
    if (const auto* k = kernels_for<S>(better)) return k;
  }
  return &portable::table<S>();
}
/// Those of training for the instruction set of `kernels`.
template <class S>
const GradientKernels<S>& gradient_kernels_of(const Kernels<S>& kernels) {
#if defined(MOTIONLANG_WIDE_KERNELS)
  if (kernels.isa == Isa::avx2) return avx2::gradient_table<S>();
  if (kernels.isa != Isa::portable) return avx512::gradient_table<S>();
#else
  static_cast<void>(kernels);
#endif
  return portable::gradient_table<S>();
}
/// Tiles that belong to `kernels`, or nothing: all products are made of multiply-adds.
inline const FloatTiles* float_tiles_of(const Kernels<float>& kernels) {
#if defined(MOTIONLANG_WIDE_KERNELS)
  if (kernels.isa == Isa::amx) return &avx512::float_tiles();
#else
  static_cast<void>(kernels);
#endif
  return nullptr;
}
/// The same for products of bfloat16. The best is AMX; vdpbf16ps where there is none (beside AMX it runs at half the
/// speed of products in float); else float instructions.
inline const Bf16Kernels* bf16_kernels_for(Isa isa) {
  if (isa == Isa::portable) return &portable::bf16_table<portable::WideningTile>();
#if defined(MOTIONLANG_WIDE_KERNELS)
  if (!processor_has(isa)) return nullptr;
  if (isa == Isa::avx2) return &avx2::bf16_table<avx2::WideningTile>();
  if (isa == Isa::avx512) return &avx512::bf16_table<avx512::WideningTile>();
  if (isa == Isa::avx512_bf16) return &avx512::bf16_table<avx512::DotTile>();
  if (isa == Isa::amx) return &avx512::bf16_table<avx512::AmxTile<1>>();
  if (const auto* k = bf16_kernels_for(Isa::amx)) return k;
  if (!has_amx_bf16()) {
    if (const auto* k = bf16_kernels_for(Isa::avx512_bf16)) return k;
  }
#endif
  if (isa != Isa::best) return nullptr;
  for (Isa better : {Isa::avx512, Isa::avx2}) {
    if (const auto* k = bf16_kernels_for(better)) return k;
  }
  return bf16_kernels_for(Isa::portable);
}

/// `kernels`, if this build has them. Throws config_error 103.
template <class K>
const K* present(const K* kernels) {
  if (kernels == nullptr)
    raise<config_error>(103,
                        "MOTIONLANG_KERNELS: compiled without optimisation, a program has only the portable kernels");
  return kernels;
}

/// The table in use. Chosen once; tests and benchmarks may point it elsewhere.
template <class S>
const Kernels<S>*& current_kernels() {
  static const Kernels<S>* chosen = present(kernels_for<S>(wanted_isa()));
  return chosen;
}
template <class S>
const Kernels<S>& kernels() {
  return *current_kernels<S>();
}
inline const Bf16Kernels*& current_bf16_kernels() {
  static const Bf16Kernels* chosen = present(bf16_kernels_for(wanted_isa()));
  return chosen;
}

/// The kernels of precisions other than fp32. Only set_product_precision (backend/precision.hpp) and searches in
/// bfloat16 name them: a program without either does not compile them.
inline std::atomic<const Bf16Kernels*& (*)()> bf16_products{nullptr};
inline std::atomic<const FloatTiles* (*)(const Kernels<float>&)> tile_products{nullptr};
/// Makes bf16_product_kernels() callable. Whoever packs panels in bfloat16 calls it before.
inline void use_bf16_products() { bf16_products.store(&current_bf16_kernels, std::memory_order_relaxed); }
/// The kernels of products in bfloat16. Precondition: use_bf16_products() was called.
inline const Bf16Kernels& bf16_product_kernels() { return *bf16_products.load(std::memory_order_relaxed)(); }

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_PRECISION_HPP  // <motionlang/core/precision.hpp>
#define MOTIONLANG_HAS_CORE_PRECISION_HPP
/// How exactly products of matrices are computed.

MOTIONLANG_NAMESPACE_BEGIN

/// fp32    the numbers as they are.
/// bf16    both factors rounded to bfloat16 (8 bits of significand), products and sums in float: half the memory for
///         prepared weights, and up to ten times the speed where the processor has instructions for it. An element of a
///         product over k differs from the exact one by at most (2^-7 + 2^-16) sum_k |a_k b_k|, besides the rounding of
///         the sum, of which a bias may be the first number. Numbers below 2^-126 may count as 0.
/// bf16x3  fp32 by AMX: a float is the sum of three bfloat16, whose products are added up. From 128 rows on; else, and
///         on other processors, fp32. Half its error while products are above 2^-108 (below 2^-126 they count as 0),
///         other last digits (those of a few rows may differ alone and in a larger batch). For few threads: with two,
///         large products take 0.6 to 0.9 of the time; with 8 and 16 of one machine they took 1.1 to 2.3 times as long,
///         as all instructions of AMX are slower there when every core uses them.
/// All other arithmetic stays in float. For the kernels of the Eigen and xtensor backends in float; others ignore it.
enum class Precision { fp32, bf16, bf16x3 };

/// "fp32", ...
inline const char* precision_name(Precision p) {
  return p == Precision::bf16 ? "bf16" : p == Precision::bf16x3 ? "bf16x3" : "fp32";
}
/// The opposite. Nothing if no precision is called so.
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

/// Precision of products, for the whole process: set_product_precision (backend/precision.hpp) changes it.
inline Precision product_precision() { return detail::current_product_precision().load(std::memory_order_acquire); }

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_ROWS_TOGETHER_HPP  // <motionlang/core/rows_together.hpp>
#define MOTIONLANG_HAS_CORE_ROWS_TOGETHER_HPP
/// How many rows belong together that are multiplied a few at a time.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// While it lives, products of this thread count as parts of one of this many rows (0: each as what it is), unless
/// another lives already. In bf16x3 the instructions depend on the number of rows, and with them the last digit: where
/// that must not depend on how rows are shared by threads, or on what else is in a batch, say so by this. As `many`, a
/// product of a few rows takes up to four times as long. Threads that help need one of
/// their own (for_products, in_groups).
class RowsTogether {
 public:
  static constexpr Index few = 1, many = 1 << 20;

  explicit RowsTogether(Index rows) : before_(counted()) {
    if (before_ == 0) counted() = rows;
  }
  ~RowsTogether() { counted() = before_; }
  RowsTogether(const RowsTogether&) = delete;
  RowsTogether& operator=(const RowsTogether&) = delete;

  /// 0: none lives.
  static Index count() { return counted(); }

 private:
  struct Count {
    Index rows = 0;
  };
  static Index& counted() { return thread_object<Count, RowsTogether>().rows; }

  Index before_;
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Memory that the kernels of a parallel region may scribble on, a piece for every thread. The caller takes it, so that
/// a region that ran before takes nothing from the system, whichever threads do the work.
template <class S>
class Scratch {
 public:
  explicit Scratch(Index count)
      : piece_((count + 63) / 64 * 64),
        pieces_(parallel_width()),
        memory_(static_cast<std::size_t>(piece_ * pieces_) * sizeof(S)) {}
  /// The piece of the calling thread.
  S* mine() const { return static_cast<S*>(memory_.data()) + (pieces_ == 1 ? 0 : piece_ * thread_number()); }

 private:
  Index piece_, pieces_;
  BufferHandle memory_;
};

/// A matrix (k, n) in panels: of S for `kernels`, or of bfloat16.
template <class S>
struct Panels {
  Index k = 0, n = 0;
  const Kernels<S>* kernels = nullptr;  // none: bfloat16
  BufferHandle memory;

  const S* data() const { return static_cast<const S*>(memory.data()); }
  const std::uint16_t* bf16() const { return static_cast<const std::uint16_t*>(memory.data()); }
  Index width() const { return kernels == nullptr ? bf16_columns : kernels->panel_width; }
  Index count() const { return (n + width() - 1) / width(); }
  Index bytes() const {
    const Index column = kernels == nullptr ? bf16_depth(k) * 2 : k * static_cast<Index>(sizeof(S));
    return count() * width() * column;
  }
};

/// The panels of a weight that was prepared, and those of the weight that was prepared after it: probably multiplied
/// with next. Of these only the place is known, for the cache: they may be gone.
template <class S>
struct PreparedPanels {
  PreparedPanels(Panels<S> p, Index t) : panels(std::move(p)), taps(t) {}

  Panels<S> panels;
  Index taps;  // of a convolution's weight
  mutable std::atomic<const std::byte*> next{nullptr};
  mutable std::atomic<Index> next_bytes{0};
};

inline Index parts(Index count, Index size) { return (count + size - 1) / size; }

/// Precision of products of S.
template <class S>
Precision precision_of() {
  return std::is_same_v<S, float> ? product_precision() : Precision::fp32;
}

/// Room for a matrix, packed.
template <class S>
Panels<S> panels_for(Index k, Index n, Precision precision) {
  Panels<S> p{k, n, precision == Precision::bf16 ? nullptr : &kernels<S>(), {}};
  p.memory = BufferHandle(static_cast<std::size_t>(p.bytes()));
  return p;
}
/// Element (k, n) of the packed matrix is b[k * stride_k + n * stride_n]; one stride is 1. `finite`, for a
/// transposed B (stride_k is 1), becomes false if a number is not.
template <class S>
void pack_into(Panels<S>& p, const S* b, Index stride_k, Index stride_n, std::atomic<bool>* finite = nullptr) {
  const Index k = p.k, n = p.n;
  const bool bf16 = p.kernels == nullptr;
  // The rows that a task reads lie together: rows of B as stored (in pairs, for bfloat16), panels of a transposed B. A
  // column is both, but only as transposed is it looked at.
  const bool as_it_lies = stride_n == 1 && finite == nullptr;
  const Index count = !as_it_lies ? p.count() : bf16 ? bf16_depth(k) : k;
  const Index each = p.width() * (as_it_lies ? p.count() : k), step = as_it_lies ? 2 : 1;
  const Index at_once = std::max<Index>(1, 65536 / std::max<Index>(1, each) / step) * step;
  const auto pack = [&](const auto& with, auto* out) {
    parallel_for(parts(count, at_once), [&](Index i) {
      const Index first = i * at_once, last = std::min(count, first + at_once);
      if (as_it_lies)
        with.pack_rows(b, k, n, stride_k, first, last, out);
      else if (!with.pack_transposed(b, k, n, stride_n, first, last, out) && finite != nullptr)
        *finite = false;
    });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (bf16) {
      pack(bf16_product_kernels(), static_cast<std::uint16_t*>(p.memory.data()));
      return;
    }
  }
  pack(*p.kernels, static_cast<S*>(p.memory.data()));
}
template <class S>
Panels<S> pack_panels(const S* b, Index k, Index n, Index stride_k, Index stride_n,
                      Precision precision = Precision::fp32, std::atomic<bool>* finite = nullptr) {
  auto p = panels_for<S>(k, n, precision);
  pack_into(p, b, stride_k, stride_n, finite);
  return p;
}

/// True if a product of m x k and k x n is split.
inline bool worth_threads(Index m, Index n, Index k) { return m * n * k >= 100'000; }

/// The kernels whose panels are wanted of weights; none: bfloat16.
template <class S>
const Kernels<S>* wanted_kernels() {
  return precision_of<S>() == Precision::bf16 ? nullptr : &kernels<S>();
}
/// The prepared form of a weight, if it is the form that is wanted now.
template <class S>
const PreparedPanels<S>* prepared_panels(const Dense<S>& weight, Index n, Index k, Index taps) {
  const auto* p = static_cast<const PreparedPanels<S>*>(weight.attached());
  const bool fits = p != nullptr && p->panels.kernels == wanted_kernels<S>() && p->panels.n == n && p->panels.k == k &&
                    p->taps == taps;
  return fits ? p : nullptr;
}
/// The weight (out, in, taps) of a convolution as the matrix (out, taps in) that windows of rows are multiplied with.
template <class S>
Dense<S> window_matrix(const Dense<S>& weight) {
  const std::array axes{0, 2, 1};
  return DenseOps<S>::permute(weight, axes).reshaped(Shape{weight.shape()[0], weight.shape()[1] * weight.shape()[2]});
}

/// Tiles for a product of m x k and k x n in bf16x3, if there are any that are faster than multiply-adds: of less,
/// splitting panels and rows takes as long as is saved. That depends on the product, not on how its rows are shared:
/// the same numbers for any number of threads.
template <class S>
const FloatTiles* float_tiles(Index m, Index n, Index k) {
  if (precision_of<S>() != Precision::bf16x3) return nullptr;
  const Index rows = RowsTogether::count() > 0 ? RowsTogether::count() : m;
  const bool pays = rows >= 128 && n >= 128 && k >= 128 && rows * n >= (k < 256 ? 131072 : 32768);
  return pays ? tile_products.load(std::memory_order_relaxed)(kernels<float>()) : nullptr;
}
/// Scratch of products of at most this many rows with such panels.
template <class S>
Scratch<S> gemm_scratch(const Panels<S>& p, Index rows) {
  if constexpr (std::is_same_v<S, float>) {
    if (p.kernels == nullptr) return Scratch<S>(bf16_product_kernels().gemm_scratch(p.k));
  }
  const FloatTiles* tiles = float_tiles<S>(rows, p.n, p.k);
  return Scratch<S>(std::max(tiles == nullptr ? 0 : tiles->gemm_scratch(p.k), p.kernels->gemm_scratch(p.k)));
}
/// True if every thread takes rows of A of its own and multiplies them with all panels, else some panels of rows that
/// threads share. Its rows a thread finds where it wrote them, in its cache. Those of others come slowly: with 16
/// threads a byte costs about what five of panels do, which are fetched ahead. Not if the rows are few and there is
/// much more of the panels, or the rows do not fill tiles.
inline bool takes_own_rows(Index each, Index a_bytes, Index panel_bytes, Index rows_at_once, Index tile_rows) {
  const bool fills_tiles = each > 0 && 4 * each >= 3 * tile_rows * parts(each, tile_rows);
  return each >= std::max(tile_rows, rows_at_once / 4) || (fills_tiles && 5 * a_bytes >= panel_bytes);
}
/// How a product is shared by threads.
struct Sharing {
  Index rows_at_once;     // in a block
  bool own_rows = false;  // takes_own_rows
  // Each thread has a part. Other threads take what a slower thread (another kind of core, a busy one) left over.
  Index pieces = 1;
};
/// Calls block(r0, r1, j0, j1) for parts of a product of this many rows and panels.
template <class F>
void for_blocks(Index rows, Index panels, bool split, const Sharing& how, const F& block) {
  const Index threads = split ? parallel_width() : 1, blocks = threads == 1 ? 1 : parts(rows, how.rows_at_once);
  // As many for every thread.
  const Index row_parts = blocks > threads ? parts(blocks, threads) * threads : how.own_rows ? threads : blocks;
  const Index panel_parts = threads == 1 ? 1 : std::min(panels, parts(threads * how.pieces, row_parts));
  parallel_for(row_parts * panel_parts, [&](Index task) {
    const Index r = task / panel_parts, j = task % panel_parts;
    block(rows * r / row_parts, rows * (r + 1) / row_parts, panels * j / panel_parts, panels * (j + 1) / panel_parts);
  });
}

/// Nothing to be done behind a block of a product.
struct NothingBehind {
  void operator()(Index, Index, Index, Index) const {}
};
/// g with the right-hand side `p`; then behind(r0, r1, c0, c1) for every thread's blocks of rows and columns, by that
/// thread.
template <class S, class F = NothingBehind>
void run_gemm(Gemm<S> g, const Panels<S>& p, const Scratch<S>& scratch, const F& behind = {}) {
  if (g.m == 0 || g.n == 0) return;
  const bool split = worth_threads(g.m, g.n, g.k);
  const Index width = p.width(), a_bytes = g.m * g.k * static_cast<Index>(sizeof(S));
  const auto run = [&](const auto& kernel, Index pieces, const auto& multiply) {
    Sharing how{.rows_at_once = kernel.gemm_rows(g.k)};
    how.own_rows = takes_own_rows(g.m / parallel_width(), a_bytes, p.bytes(), how.rows_at_once, kernel.tile_rows);
    how.pieces = pieces;
    for_blocks(g.m, p.count(), split, how, [&](Index r0, Index r1, Index j0, Index j1) {
      multiply(r0, r1, j0, j1);
      behind(r0, r1, j0 * width, std::min(g.n, j1 * width));
    });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (p.kernels == nullptr) {
      const Bf16Kernels& kernel = bf16_product_kernels();
      run(kernel, 1, [&](Index r0, Index r1, Index j0, Index j1) {  // rows would be rounded for every piece
        kernel.gemm_block(g, p.bf16(), r0, r1, j0, j1, scratch.mine());
      });
      return;
    }
  }
  g.panels = p.data();
  const auto run_floats = [&](const auto& kernel, Index pieces) {
    run(kernel, pieces,
        [&](Index r0, Index r1, Index j0, Index j1) { kernel.gemm_block(g, r0, r1, j0, j1, scratch.mine()); });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (const FloatTiles* tiles = float_tiles<S>(g.m, g.n, g.k)) return run_floats(*tiles, 1);
  }
  run_floats(*p.kernels, parallel_width() > 2 ? 3 : 1);
}

/// How many of `count` products of m x k and k x n are made by one thread each: as long as there is one for every
/// thread. The rest is made by all of them, one after the other.
inline Index products_apart(Index count, Index m, Index n, Index k) {
  return worth_threads(count * m, n, k) ? count - count % parallel_width() : 0;
}
/// product(i) for 0 ... count-1.
template <class F>
void for_products(Index count, Index apart, const F& product) {
  const Index together = RowsTogether::count();
  parallel_for(apart, [&](Index i) {
    const RowsTogether as_here(together);
    product(i);
  });
  for (Index i = apart; i < count; ++i) product(i);
}

/// Packed sequences with rows of zeros at both ends of each. The windows of such a sequence lie in memory as the rows
/// of a matrix do, but overlap.
template <class S>
struct WithMargins {
  const Offsets& inside;
  Index margin, width;
  Dense<S> rows;

  WithMargins(const Dense<S>& x, const Offsets& o, Index m) : inside(o), margin(m), width(x.shape()[1]), rows(x) {
    if (margin == 0) return;
    rows = Dense<S>(Shape{inside.rows() + 2 * margin * inside.count(), width});
    parallel_ranges(inside.count(), inside.longest() * width, [&](Index first, Index last) {
      for (Index s = first; s < last; ++s) {
        S* to = std::fill_n(rows.data() + at(s), margin * width, S(0));
        to = std::copy_n(x.data() + inside.begin(s) * width, inside.length(s) * width, to);
        std::fill_n(to, margin * width, S(0));
      }
    });
  }
  /// Place among all numbers where sequence s begins, with its margin.
  Index at(Index s) const { return (inside.begin(s) + 2 * margin * s) * width; }
};

/// f(place of a window's first number, its row among all windows) for every window of `size` numbers; those of a
/// sequence by one thread.
template <class S, class F>
void for_windows(const WithMargins<S>& margins, const Offsets& windows, Index stride, Index size, const F& f) {
  parallel_ranges(windows.count(), windows.longest() * size, [&](Index first, Index last) {
    for (Index s = first; s < last; ++s) {
      for (Index t = 0; t < windows.length(s); ++t) f(margins.at(s) + t * stride * margins.width, windows.begin(s) + t);
    }
  });
}

/// Windows of x times a matrix (taps in, n), sequence by sequence.
template <class S>
Dense<S> convolve(const Dense<S>& x, const Offsets& before, const Offsets& after, const Panels<S>& matrix,
                  const S* bias, Index stride, Index padding, Activation act) {
  const WithMargins<S> margins(x, before, padding);
  Dense<S> y(Shape{after.rows(), matrix.n});
  const Scratch<S> scratch = gemm_scratch(matrix, after.longest());
  for_products(after.count(), products_apart(after.count(), after.longest(), matrix.n, matrix.k), [&](Index s) {
    run_gemm(Gemm<S>{.m = after.length(s),
                     .n = matrix.n,
                     .k = matrix.k,
                     .a = margins.rows.data() + margins.at(s),
                     .lda = stride * margins.width,
                     .c = y.data() + after.begin(s) * matrix.n,
                     .ldc = matrix.n,
                     .bias = bias,
                     .act = act},
             matrix, scratch);
  });
  return y;
}

template <class S>
Attention<S> attention_arguments(const Offsets& q_offsets, const Offsets& k_offsets, Index width,
                                 const AttentionOptions& options) {
  return {.q_offsets = q_offsets.list().data(),
          .k_offsets = k_offsets.list().data(),
          .heads = options.heads,
          .width = width / options.heads,
          .causal = options.causal,
          .dropout = options.dropout};
}
template <class S>
void run_attention(const Attention<S>& t, const Offsets& q, const Offsets& k) {
  const auto run = [&](const auto& kernel) {
    const Scratch<S> scratch(kernel.attention_scratch(k.longest(), t.width));
    // Few heads: the queries of each are split, so that every thread has as many tasks. Each task packs keys and
    // values.
    const Index heads = q.count() * t.heads, threads = parallel_width();
    const Index equal = heads < 4 * threads ? threads / std::gcd(heads, threads) : 1;
    const Index pieces = std::clamp<Index>(equal, 1, std::max<Index>(1, parts(q.longest(), kernel.tile_rows)));
    parallel_for(heads * pieces, [&](Index task) {
      const Index i = task / pieces;
      if (q.length(i / t.heads) > 0)
        kernel.attention_head(t, i / t.heads, i % t.heads, task % pieces, pieces, scratch.mine());
    });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (product_precision() == Precision::bf16) return run(bf16_product_kernels());
  }
  run(kernels<S>());
}
template <class S>
void run_attention_vjp(const Attention<S>& t, const AttentionGradients<S>& g, const Offsets& q, const Offsets& k) {
  const auto run = [&](const auto& scratch_of, const auto& vjp) {
    const Scratch<S> scratch(scratch_of(q.longest(), k.longest(), t.width));
    parallel_for(q.count() * t.heads, [&](Index i) { vjp(t, g, i / t.heads, i % t.heads, scratch.mine()); });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (product_precision() == Precision::bf16) {
      const Bf16Kernels& kernel = bf16_product_kernels();
      return run(kernel.attention_vjp_scratch, kernel.attention_head_vjp);
    }
  }
  const GradientKernels<S>& kernel = gradient_kernels_of(kernels<S>());
  run(kernel.attention_scratch, kernel.attention_head);
}

/// linear with the sides exchanged, y^T = weight x^T: the weight is read where it lies, only x is packed. The same sums
/// in the same order as with panels of the weight, so the same bits (of multiply-adds; tiles do not treat both sides
/// alike).
template <class S>
Dense<S> exchanged_linear(const Dense<S>& x, const Dense<S>& weight, const S* bias, Activation act, const S* residual) {
  const Index n = weight.shape()[0], k = weight.shape()[1], m = x.shape()[0];
  const auto panels = pack_panels(x.data(), k, m, Index{1}, k);
  Dense<S> z(Shape{n, m}), y(Shape{m, n});
  run_gemm(Gemm<S>{.m = n, .n = m, .k = k, .a = weight.data(), .lda = k, .c = z.data(), .ldc = m}, panels,
           gemm_scratch(panels, n));
  const Transposed<S> t{
      .z = z.data(), .bias = bias, .residual = residual, .rows = m, .width = n, .act = act, .y = y.data()};
  constexpr Index columns = 64;
  parallel_for(parts(n, columns),
               [&](Index i) { kernels<S>().transpose(t, i * columns, std::min(n, (i + 1) * columns)); });
  return y;
}

/// f(first, n) for pieces of a ... b-1 that stay in the first-level cache while several things are done with them.
template <class F>
void pieces_of(Index a, Index b, const F& f) {
  constexpr Index piece = 2048;
  for (; a < b; a += piece) f(a, std::min(piece, b - a));
}
/// The same for 0 ... count-1, by all threads.
template <class F>
void in_pieces(Index count, const F& f) {
  parallel_ranges(count, 1, [&](Index a, Index b) { pieces_of(a, b, f); });
}

template <class S>
LayerNorm<S> layer_norm_arguments(const Dense<S>& x, const Dense<S>& weight, const S* bias, double eps, S* y) {
  return {.x = x.data(),
          .weight = weight.data(),
          .bias = bias,
          .width = x.shape().back(),
          .eps = static_cast<S>(eps),
          .y = y};
}

/// out = op(a, b) with broadcasting, row by row; the memory of an operand is reused when nobody else holds it.
template <class S>
Dense<S> kernel_binary(BinaryOp op, Dense<S> a, Dense<S> b) {
  const Shape s = a.shape() == b.shape() ? a.shape() : broadcast_shapes(a.shape(), b.shape(), "binary operation");
  const auto pattern = broadcast_pattern(a.shape(), b.shape(), s);
  if (!pattern) return kernel_binary(op, DenseOps<S>::broadcast(a, s), DenseOps<S>::broadcast(b, s));
  const auto& [outer, inner, walk_a, walk_b] = *pattern;
  Dense<S> out = a.unique() && a.shape() == s ? a : b.unique() && b.shape() == s ? b : Dense<S>(s);
  if (inner == 0) return out;
  auto apply = [&, pattern = *pattern](Index i, Index first, Index last) {  // columns first ... last-1 of row i
    auto at = [&](const Dense<S>& x, const BroadcastPattern::Operand& walk) {
      return x.data() + (walk.outer ? i * (walk.inner ? pattern.inner : 1) : 0) + (walk.inner ? first : 0);
    };
    kernels<S>().binary({.op = op,
                         .a = at(a, pattern.a),
                         .b = at(b, pattern.b),
                         .a_repeated = !pattern.a.inner,
                         .b_repeated = !pattern.b.inner,
                         .count = last - first,
                         .y = out.data() + i * pattern.inner + first});
  };
  if (outer == 1) {
    parallel_ranges(inner, 1, [&](Index first, Index last) { apply(0, first, last); });
  } else {
    parallel_ranges(outer, inner, [&, n = inner](Index first, Index last) {
      for (Index i = first; i < last; ++i) apply(i, 0, n);
    });
  }
  return out;
}

}  // namespace detail

template <Scalar S>
Dense<S> KernelOps<S>::add(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::add, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> KernelOps<S>::sub(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::sub, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> KernelOps<S>::mul(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::mul, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> KernelOps<S>::div(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::div, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> KernelOps<S>::maximum(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::maximum, std::move(a), std::move(b));
}

template <Scalar S>
Dense<S> KernelOps<S>::sum(const Dense<S>& a, int axis) {
  const Shape& s = a.shape();
  const Index n = s[axis], inner = s.count(axis + 1, s.rank());
  Dense<S> y(s.without(axis));
  const detail::Kernels<S>& kernel = detail::kernels<S>();
  const auto rows = [&](Index first, Index last) { kernel.row_sums(a.data(), n, first, last, y.data()); };
  const auto columns = [&](Index i, Index first, Index last) {
    kernel.column_sums(a.data() + i * n * inner, n, inner, first, last, y.data() + i * inner);
  };
  detail::for_reduction(s, axis, rows, columns);
  return y;
}

template <Scalar S>
Dense<S> KernelOps<S>::matmul(const Dense<S>& a, const Dense<S>& b, bool transpose_a, bool transpose_b) {
  const int r = a.shape().rank();
  const Index m = a.shape()[r - (transpose_a ? 1 : 2)], k = a.shape()[r - (transpose_a ? 2 : 1)];
  const Index n = b.shape()[r - (transpose_b ? 2 : 1)];
  Shape s = a.shape();
  s[r - 2] = m;
  s[r - 1] = n;
  Dense<S> out(s);
  const Index count = s.count(0, r - 2), apart = detail::products_apart(count, m, n, k);
  PoolVector<detail::Panels<S>> rooms;  // one for every thread that packs
  for (int i = 0; i < (apart > 0 ? parallel_width() : 1); ++i)
    rooms.push_back(detail::panels_for<S>(k, n, detail::precision_of<S>()));
  const auto scratch = detail::gemm_scratch(rooms[0], m);
  detail::for_products(count, apart, [&](Index i) {
    auto& panels = rooms[rooms.size() == 1 ? 0 : static_cast<std::size_t>(thread_number())];
    detail::pack_into(panels, b.data() + i * k * n, transpose_b ? 1 : n, transpose_b ? k : 1);
    detail::run_gemm(detail::Gemm<S>{.m = m,
                                     .n = n,
                                     .k = k,
                                     .a = a.data() + i * m * k,
                                     .lda = transpose_a ? m : k,
                                     .a_transposed = transpose_a,
                                     .c = out.data() + i * m * n,
                                     .ldc = n},
                     panels, scratch);
  });
  return out;
}

template <Scalar S>
Index KernelOps<S>::rows_in_cache() {
  return 256 * parallel_width();  // of a few thousand numbers each, 2 to 4 MB
}

template <Scalar S>
bool KernelOps<S>::prepare(const Dense<S>& weight) {
  const Index taps = weight.shape().rank() == 3 ? weight.shape()[2] : 1;
  const Dense<S> matrix = taps > 1 ? detail::window_matrix(weight) : weight;
  const Index n = weight.shape()[0], k = taps * weight.shape()[1];
  std::atomic<bool> finite{true};
  auto& before = thread_object<std::weak_ptr<const detail::PreparedPanels<S>>>();
  const auto prepared = std::make_shared<const detail::PreparedPanels<S>>(
      detail::pack_panels(matrix.data(), k, n, Index{1}, k, detail::precision_of<S>(), &finite), taps);
  if (const auto last = before.lock()) {
    last->next_bytes = prepared->panels.bytes();
    last->next = static_cast<const std::byte*>(prepared->panels.memory.data());
  }
  before = prepared;
  weight.attach(prepared);
  return finite;
}

template <Scalar S>
Dense<S> KernelOps<S>::linear(const Dense<S>& x, const Dense<S>& weight, const Dense<S>* bias, Activation act,
                              const Dense<S>* residual, const Dropout& drop) {
  const Index n = weight.shape()[0], k = weight.shape()[1], m = x.shape()[0];
  const auto* prepared = detail::prepared_panels(weight, n, k, 1);
  const auto* ready = prepared == nullptr ? nullptr : &prepared->panels;
  // The kernel applies the nonlinearity after everything, and knows no dropout.
  const bool last = drop.p == 0 && (residual == nullptr || act == Activation::none);
  detail::Panels<S> packed;
  Dense<S> y;
  const auto finish = [&](Index first, Index count) {
    const detail::Kernels<S>& kernel = detail::kernels<S>();
    S* to = y.data() + first;
    if (drop.p > 0) kernel.dropout(to, count, first, drop, to);
    if (residual != nullptr)
      kernel.binary({.op = detail::BinaryOp::add, .a = to, .b = residual->data() + first, .count = count, .y = to});
  };
  const auto behind = [&](Index r0, Index r1, Index c0, Index c1) {
    if (last) return;
    if (c1 - c0 == n) return detail::pieces_of(r0 * n, r1 * n, finish);
    for (Index r = r0; r < r1; ++r) finish(r * n + c0, c1 - c0);
  };
  if (ready == nullptr) {
    if (detail::wanted_kernels<S>() != nullptr && m > 0 &&
        m * (n + k) < n * k &&  // x and y are smaller than the weight
        detail::float_tiles<S>(m, n, k) == nullptr) {
      y = detail::exchanged_linear(x, weight, bias == nullptr ? nullptr : bias->data(), act,
                                   residual == nullptr || !last ? nullptr : residual->data());
      behind(0, m, 0, n);
      return y;
    }
    packed = detail::pack_panels(weight.data(), k, n, Index{1}, k, detail::precision_of<S>());
    ready = &packed;
  }
  y = Dense<S>(Shape{m, n});
  detail::run_gemm(
      detail::Gemm<S>{.m = m,
                      .n = n,
                      .k = k,
                      .a = x.data(),
                      .lda = k,
                      .c = y.data(),
                      .ldc = n,
                      .bias = bias == nullptr ? nullptr : bias->data(),
                      .residual = residual == nullptr || !last ? nullptr : residual->data(),
                      .ldr = n,
                      .act = act,
                      .after = ready == &packed ? nullptr : prepared->next.load(std::memory_order_relaxed),
                      .after_bytes = ready == &packed ? 0 : prepared->next_bytes.load(std::memory_order_relaxed)},
      *ready, detail::gemm_scratch(*ready, m), behind);
  return y;
}

template <Scalar S>
Dense<S> KernelOps<S>::conv1d(const Dense<S>& x, const Offsets& before, const Offsets& after, const Dense<S>& weight,
                              const Dense<S>* bias, Index stride, Index padding, Activation act) {
  const Index n = weight.shape()[0], taps = weight.shape()[2], k = taps * weight.shape()[1];
  const auto* prepared = detail::prepared_panels(weight, n, k, taps);
  detail::Panels<S> packed;
  if (prepared == nullptr)
    packed = detail::pack_panels(detail::window_matrix(weight).data(), k, n, Index{1}, k, detail::precision_of<S>());
  return detail::convolve(x, before, after, prepared == nullptr ? packed : prepared->panels,
                          bias == nullptr ? nullptr : bias->data(), stride, padding, act);
}
template <Scalar S>
Dense<S> KernelOps<S>::conv1d_weight_vjp(const Dense<S>& x, const Offsets& before, const Offsets& after, Index taps,
                                         Index stride, Index padding, const Dense<S>& dy) {
  const Index n = dy.shape()[1], in = x.shape()[1];
  const detail::WithMargins<S> margins(x, before, padding);
  Dense<S> windows(Shape{after.rows(), taps * in});
  detail::for_windows(margins, after, stride, taps * in, [&](Index from, Index row) {
    std::copy_n(margins.rows.data() + from, taps * in, windows.data() + row * taps * in);
  });
  const std::array axes{0, 2, 1};
  return DenseOps<S>::permute(matmul(dy, windows, true, false).reshaped(Shape{n, taps, in}), axes);
}
template <Scalar S>
Dense<S> KernelOps<S>::conv1d_input_vjp(const Dense<S>& weight, const Offsets& before, const Offsets& after,
                                        Index stride, Index padding, const Dense<S>& dy) {
  const Index n = weight.shape()[0], in = weight.shape()[1], taps = weight.shape()[2];
  if (stride == 1 && padding < taps) {  // a convolution, too, with its taps in the opposite order
    const std::array axes{1, 2, 0};
    Dense<S> turned = DenseOps<S>::permute(weight, axes);  // (in, taps, out)
    parallel_ranges(in, taps * n, [&](Index first, Index last) {
      for (Index i = first; i < last; ++i) {
        S* rows = turned.data() + i * taps * n;
        for (Index j = 0; 2 * j + 1 < taps; ++j)
          std::swap_ranges(rows + j * n, rows + (j + 1) * n, rows + (taps - 1 - j) * n);
      }
    });
    const auto panels =
        detail::pack_panels(std::as_const(turned).data(), taps * n, in, Index{1}, taps * n, detail::precision_of<S>());
    return detail::convolve<S>(dy, after, before, panels, nullptr, 1, taps - 1 - padding, Activation::none);
  }
  const Dense<S> windows = matmul(dy, detail::window_matrix(weight), false, false);
  detail::WithMargins<S> margins(Dense<S>::full(Shape{before.rows(), in}, S(0)), before, padding);
  detail::for_windows(margins, after, stride, taps * in, [&](Index to, Index row) {
    const S* from = windows.data() + row * taps * in;
    for (Index i = 0; i < taps * in; ++i) margins.rows.data()[to + i] += from[i];
  });
  Dense<S> dx(Shape{before.rows(), in});
  for (Index s = 0; s < before.count(); ++s) {
    std::copy_n(std::as_const(margins.rows).data() + margins.at(s) + padding * in, before.length(s) * in,
                dx.data() + before.begin(s) * in);
  }
  return dx;
}

template <Scalar S>
Dense<S> KernelOps<S>::activate(const Dense<S>& x, Activation act, const Dropout& drop) {
  Dense<S> y(x.shape());
  detail::in_pieces(x.count(), [&](Index a, Index n) {
    detail::kernels<S>().activate(x.data() + a, n, act, y.data() + a);
    if (drop.p > 0) detail::kernels<S>().dropout(y.data() + a, n, a, drop, y.data() + a);
  });
  return y;
}
template <Scalar S>
Dense<S> KernelOps<S>::activate_vjp(const Dense<S>& x, const Dense<S>& dy, Activation act, const Dropout& drop) {
  Dense<S> dx(x.shape());
  const auto& kernel = detail::gradient_kernels_of(detail::kernels<S>());
  detail::in_pieces(x.count(), [&](Index a, Index n) {
    const S* g = dy.data() + a;
    if (drop.p > 0) detail::kernels<S>().dropout(g, n, a, drop, dx.data() + a), g = dx.data() + a;
    kernel.activate(x.data() + a, g, n, act, dx.data() + a);
  });
  return dx;
}

template <Scalar S>
Dense<S> KernelOps<S>::layer_norm(const Dense<S>& x, const Dense<S>& weight, const Dense<S>& bias, double eps) {
  Dense<S> y(x.shape());
  const auto t = detail::layer_norm_arguments(x, weight, bias.data(), eps, y.data());
  parallel_ranges(x.shape()[0], t.width, [&](Index a, Index b) { detail::kernels<S>().layer_norm_rows(t, a, b); });
  return y;
}
template <Scalar S>
Dense<S> KernelOps<S>::add_layer_norm(const Dense<S>& x, const Dense<S>& residual, const Dense<S>& weight,
                                      const Dense<S>& bias, double eps) {
  Dense<S> y(x.shape());
  auto t = detail::layer_norm_arguments(x, weight, bias.data(), eps, y.data());
  t.residual = residual.data();
  parallel_ranges(x.shape()[0], t.width, [&](Index a, Index b) { detail::kernels<S>().layer_norm_rows(t, a, b); });
  return y;
}
template <Scalar S>
std::array<Dense<S>, 3> KernelOps<S>::layer_norm_vjp(const Dense<S>& x, const Dense<S>& weight, double eps,
                                                     const Dense<S>& dy) {
  const Index rows = x.shape()[0];
  const auto t = detail::layer_norm_arguments<S>(x, weight, nullptr, eps, nullptr);
  Dense<S> dx(x.shape()), dweight(weight.shape()), dbias(weight.shape()), moments(Shape{rows, 2});
  const auto& kernel = detail::gradient_kernels_of(detail::kernels<S>());
  parallel_ranges(rows, t.width,
                  [&](Index a, Index b) { kernel.layer_norm_rows(t, dy.data(), dx.data(), moments.data(), a, b); });
  parallel_columns(rows, t.width, [&](Index a, Index b) {
    kernel.layer_norm_columns(t, dy.data(), moments.data(), dweight.data(), dbias.data(), rows, a, b);
  });
  return {std::move(dx), std::move(dweight), std::move(dbias)};
}

template <Scalar S>
Dense<S> KernelOps<S>::softmax(const Dense<S>& x) {
  Dense<S> y(x.shape());
  const Index n = x.shape().back();
  const detail::Scratch<S> scratch(n + 64);
  parallel_ranges(x.shape()[0], n, [&](Index a, Index b) {
    detail::kernels<S>().softmax_rows(x.data(), n, a, b, y.data(), scratch.mine());
  });
  return y;
}
template <Scalar S>
Dense<S> KernelOps<S>::dropout(const Dense<S>& x, const Dropout& d) {
  Dense<S> y(x.shape());
  parallel_ranges(x.count(), 1,
                  [&](Index a, Index b) { detail::kernels<S>().dropout(x.data() + a, b - a, a, d, y.data() + a); });
  return y;
}
template <Scalar S>
Dense<S> KernelOps<S>::attention(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v, const Offsets& q_offsets,
                                 const Offsets& k_offsets, const AttentionOptions& options,
                                 const Dense<S>* relative_scores) {
  const Index d = q.shape()[1];
  Dense<S> o(q.shape());
  auto t = detail::attention_arguments<S>(q_offsets, k_offsets, d, options);
  if (relative_scores != nullptr)
    t.relative_scores = relative_scores->data(), t.reach = relative_scores->shape()[1] / 2;
  t.q = q.data(), t.k = k.data(), t.v = v.data(), t.o = o.data();
  t.q_stride = t.k_stride = t.v_stride = t.o_stride = d;
  detail::run_attention(t, q_offsets, k_offsets);
  return o;
}
template <Scalar S>
std::array<Dense<S>, 3> KernelOps<S>::attention_vjp(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v,
                                                    const Offsets& q_offsets, const Offsets& k_offsets,
                                                    const AttentionOptions& options, const Dense<S>& dy) {
  const Index d = q.shape()[1];
  Dense<S> dq(q.shape()), dk(k.shape()), dv(v.shape());
  auto t = detail::attention_arguments<S>(q_offsets, k_offsets, d, options);
  t.q = q.data(), t.k = k.data(), t.v = v.data();
  t.q_stride = t.k_stride = t.v_stride = t.o_stride = d;
  detail::run_attention_vjp(t, detail::AttentionGradients<S>{dy.data(), dq.data(), dk.data(), dv.data()}, q_offsets,
                            k_offsets);
  return {std::move(dq), std::move(dk), std::move(dv)};
}
template <Scalar S>
Dense<S> KernelOps<S>::self_attention(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options) {
  const Index d = qkv.shape()[1] / 3;
  Dense<S> o(Shape{qkv.shape()[0], d});
  auto t = detail::attention_arguments<S>(offsets, offsets, d, options);
  t.q = qkv.data(), t.k = qkv.data() + d, t.v = qkv.data() + 2 * d, t.o = o.data();
  t.q_stride = t.k_stride = t.v_stride = 3 * d, t.o_stride = d;
  detail::run_attention(t, offsets, offsets);
  return o;
}
template <Scalar S>
Dense<S> KernelOps<S>::self_attention_vjp(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options,
                                          const Dense<S>& dy) {
  const Index d = qkv.shape()[1] / 3;
  Dense<S> g(qkv.shape());
  auto t = detail::attention_arguments<S>(offsets, offsets, d, options);
  t.q = qkv.data(), t.k = qkv.data() + d, t.v = qkv.data() + 2 * d;
  t.q_stride = t.k_stride = t.v_stride = 3 * d, t.o_stride = d;
  detail::run_attention_vjp(t, detail::AttentionGradients<S>{dy.data(), g.data(), g.data() + d, g.data() + 2 * d},
                            offsets, offsets);
  return g;
}

template <Scalar S>
void KernelOps<S>::adamw(Dense<S>& parameter, Dense<S>& m, Dense<S>& v, const Dense<S>& gradient,
                         const AdamwUpdate& u) {
  for (Dense<S>* d : {&parameter, &m, &v}) {
    if (!d->unique()) *d = Dense<S>::from_span(d->span(), d->shape());
  }
  const double step = static_cast<double>(u.step);
  const detail::AdamwStep<S> t{
      .p = parameter.data(),
      .m = m.data(),
      .v = v.data(),
      .g = gradient.data(),
      .beta1 = static_cast<S>(u.beta1),
      .rest1 = static_cast<S>(1 - u.beta1),  // of doubles: of floats it is wrong in the fifth digit
      .beta2 = static_cast<S>(u.beta2),
      .rest2 = static_cast<S>(1 - u.beta2),
      .step = static_cast<S>(u.lr / (1 - std::pow(u.beta1, step))),
      .correction = static_cast<S>(1 / std::sqrt(1 - std::pow(u.beta2, step))),
      .eps = static_cast<S>(u.eps),
      .decay = static_cast<S>(1 - u.lr * u.weight_decay),
      .gradient_scale = static_cast<S>(u.gradient_scale)};
  const auto& kernel = detail::gradient_kernels_of(detail::kernels<S>());
  parallel_ranges(parameter.count(), 1, [&](Index a, Index b) { kernel.adamw(t, a, b); });
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Functions and maxima of the Eigen backend.
template <Scalar S>
struct EigenFunctions {
  using tensor = Dense<S>;

  static tensor atan2(tensor a, tensor b);
  static tensor exp(tensor a);
  static tensor log(tensor a);
  static tensor sqrt(tensor a);
  static tensor tanh(tensor a);
  static tensor erf(tensor a);
  static tensor sin(tensor a);
  static tensor cos(tensor a);
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y);
  static tensor max(const tensor& a, int axis);
};

/// Complete where the bodies of these functions are.
template <Scalar S>
struct EigenBodies;

/// The functions for units that may lack their bodies: the compiler says it, not the linker.
template <Scalar S>
struct CheckedEigenFunctions {
  using tensor = Dense<S>;

  static tensor atan2(tensor a, tensor b) { return checked().atan2(std::move(a), std::move(b)); }
  static tensor exp(tensor a) { return checked().exp(std::move(a)); }
  static tensor log(tensor a) { return checked().log(std::move(a)); }
  static tensor sqrt(tensor a) { return checked().sqrt(std::move(a)); }
  static tensor tanh(tensor a) { return checked().tanh(std::move(a)); }
  static tensor erf(tensor a) { return checked().erf(std::move(a)); }
  static tensor sin(tensor a) { return checked().sin(std::move(a)); }
  static tensor cos(tensor a) { return checked().cos(std::move(a)); }
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y) {
    return checked().where_less(a, b, x, y);
  }
  static tensor max(const tensor& a, int axis) { return checked().max(a, axis); }

 private:
  template <class T = S>
  static EigenFunctions<T> checked() {
    static_assert(
        requires { sizeof(EigenBodies<T>); },
        "motionlang: this calculates with tensors of EigenBackend, so include <motionlang/backend/eigen.hpp>");
    return {};
  }
};

}  // namespace detail

template <Scalar S>
struct EigenBackend : DenseOps<S>, KernelOps<S>, detail::CheckedEigenFunctions<S> {
  using tensor = Dense<S>;
};

MOTIONLANG_NAMESPACE_END

MOTIONLANG_NAMESPACE_BEGIN
static_assert(Backend<EigenBackend<float>> && Backend<EigenBackend<double>>);
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_TIMELINE_TEXT_HPP  // <motionlang/compose/timeline_text.hpp>
#define MOTIONLANG_HAS_COMPOSE_TIMELINE_TEXT_HPP
/// The text form of timelines.
///
///     line      := text "#" start "#" end { "#" body part }          times in seconds
///     timeline  := line { line }
///     file      := timelines separated by blank lines
///
/// Source   STMC (Petrovich et al. 2024), src/stmc.py read_timelines and src/text.py; there is no comment syntax and a
///          text cannot contain '#'
/// Differs  lines of spaces count as blank, any line end is taken (LF, CRLF, CR), a byte order mark is skipped, and an
///          interval that is empty or ends before it starts is refused unless `as_published` is set. Gaps between
///          intervals do not concern the text: see PlanOptions.
/// Throws   timeline_error 501-504, 507, 509; messages begin "name:line:column: ", columns count characters. What is
///          wrong with the whole of a timeline is found when it is planned, and named by line and column of an interval

#ifndef MOTIONLANG_HAS_COMPOSE_TIMELINE_HPP  // <motionlang/compose/timeline.hpp>
#define MOTIONLANG_HAS_COMPOSE_TIMELINE_HPP
/// A timeline: texts, each with its time and its body parts. Reading and writing is in timeline_text.hpp.
///
/// Times are frames (Index) where motion is made, and seconds (double) where files are written and edited; the two are
/// different types, so they cannot be mixed.

#ifndef MOTIONLANG_HAS_KINEMATICS_BODY_PARTITION_HPP  // <motionlang/kinematics/body_partition.hpp>
#define MOTIONLANG_HAS_KINEMATICS_BODY_PARTITION_HPP
/// The parts that a body is divided into: their names, and the part that carries the path over the floor. Timelines,
/// plans and feature layouts hold one; the default is the human body of STMC (body_parts.hpp).
///
///     const BodyPartition dog({.names = {"front left", "front right", "hind left", "hind right", "trunk"},
///                              .path = "trunk",
///                              .synonyms = {{"tail", "trunk"}},
///                              .words = {{"wag", {"trunk"}}, {"dig", {"front left", "front right"}}}});
///     const auto timeline = parse_timeline("trot # 0 # 4\nshake hands # 1 # 2 # front left\n", {.body = dog});
///
/// Differs  from STMC (Petrovich et al. 2024), which knows the human body only. Its base texts are those with legs.
///          Here they are those with the part that carries the path

#ifndef MOTIONLANG_HAS_KINEMATICS_BODY_PARTS_HPP  // <motionlang/kinematics/body_parts.hpp>
#define MOTIONLANG_HAS_KINEMATICS_BODY_PARTS_HPP
/// Body parts: the five of STMC with their names, sets of parts, and the joints of each part on a skeleton. Parts of
/// other bodies are named by a BodyPartition (body_partition.hpp).

#ifndef MOTIONLANG_HAS_KINEMATICS_SKELETON_HPP  // <motionlang/kinematics/skeleton.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SKELETON_HPP
/// A kinematic tree: names, parents and rest offsets of joints, depth first.
///
/// Established here and relied upon everywhere: parents[0] = -1, 0 <= parents[j] < j, names are unique. Algorithms over
/// a skeleton are therefore one loop over j in which the parent has been visited already.

#ifndef MOTIONLANG_HAS_GEOMETRY_VEC_HPP  // <motionlang/geometry/vec.hpp>
#define MOTIONLANG_HAS_GEOMETRY_VEC_HPP
/// Vectors of three coordinates.

MOTIONLANG_NAMESPACE_BEGIN

template <class S>
struct Vec3 {
  S x{}, y{}, z{};

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(const S& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend Vec3 operator*(const Vec3& a, const S& s) { return s * a; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};
template <class S>
Vec3(S, S, S) -> Vec3<S>;

template <class S>
S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class S>
S norm(const Vec3<S>& a) {
  return sqrt(dot(a, a));
}
/// |a| of a vector or quaternion, with slope 0 where a is 0 (shorter than 1e-15) and |a| has none.
template <class V>
auto norm_or_zero(const V& a) {
  const auto squared = dot(a, a);
  using S = std::remove_const_t<decltype(squared)>;
  const S least = S(1e-30);
  return where_less(squared, least, S(0), sqrt(where_less(squared, least, least, squared)));
}

/// a / max(|a|, floor). The published code uses floor = 1e-12: a zero vector stays zero and its derivative stays
/// finite.
template <class S>
Vec3<S> normalized(const Vec3<S>& a, double floor = 1e-12) {
  const S squared = dot(a, a), least = S(floor * floor);
  const S floored = where_less(squared, least, least, squared);
  if constexpr (requires { inverse_sqrt(floored); }) {
    return inverse_sqrt(floored) * a;  // in a register that is cheaper than three divisions
  } else {
    const S length = sqrt(floored);
    return {a.x / length, a.y / length, a.z / length};
  }
}

/// The same vector over another scalar.
template <class S, class T>
Vec3<S> vec_cast(const Vec3<T>& a) {
  return {S(a.x), S(a.y), S(a.z)};
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// One joint as it is written down: its parent by name ("" for the root) and its rest position relative to the parent,
/// metres.
struct Joint {
  std::string name;
  std::string parent;
  Vec3<double> offset;
};

struct Skeleton {
  std::vector<std::string> names;
  std::vector<int> parents;
  std::vector<Vec3<double>> offsets;
  /// Where the bones of joints without children end, relative to them: tips of toes and fingers, as BVH files have
  /// them. One for each joint, (0, 0, 0) where it is not known, or none at all.
  std::vector<Vec3<double>> ends{};

  /// From joints in an order in which parents come first. Throws config_error 106.
  static Skeleton from_joints(std::span<const Joint> joints);
  static Skeleton from_joints(std::initializer_list<Joint> joints) {
    return from_joints(std::span<const Joint>(joints.begin(), joints.size()));
  }
  /// From arrays. Throws config_error 106.
  static Skeleton from_arrays(std::vector<std::string> names, std::vector<int> parents,
                              std::vector<Vec3<double>> offsets);

  int size() const { return static_cast<int>(parents.size()); }

  /// Number of a joint, or -1.
  int find(std::string_view name) const;
  /// Number of a joint. Throws config_error 103.
  int operator[](std::string_view name) const;

  int parent(int joint) const { return parents[static_cast<std::size_t>(joint)]; }
  const std::string& name(int joint) const { return names[static_cast<std::size_t>(joint)]; }
  const Vec3<double>& offset(int joint) const { return offsets[static_cast<std::size_t>(joint)]; }

  /// Children of a joint in order.
  std::vector<int> children(int joint) const;
  /// Rest positions relative to the same origin as the root's offset.
  std::vector<Vec3<double>> rest_positions() const;

  /// Throws config_error 106 unless the promises above hold.
  void validate() const;
  /// Poses of one fit the other: `ends` are of no account.
  bool operator==(const Skeleton& s) const { return names == s.names && parents == s.parents && offsets == s.offsets; }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_SKELETON_IPP  // <motionlang/kinematics/skeleton.ipp>
#define MOTIONLANG_HAS_KINEMATICS_SKELETON_IPP
// Bodies of skeleton.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Skeleton Skeleton::from_joints(std::span<const Joint> joints) {
  Skeleton s;
  for (const Joint& j : joints) {
    const int parent = j.parent.empty() ? -1 : s.find(j.parent);
    if (!j.parent.empty() && parent < 0) {
      raise<config_error>(106, "Skeleton: parent '", j.parent, "' of '", j.name, "' does not come before it");
    }
    s.names.push_back(j.name);
    s.parents.push_back(parent);
    s.offsets.push_back(j.offset);
  }
  s.validate();
  return s;
}

MOTIONLANG_BODY Skeleton Skeleton::from_arrays(std::vector<std::string> names, std::vector<int> parents,
                                               std::vector<Vec3<double>> offsets) {
  Skeleton s{std::move(names), std::move(parents), std::move(offsets)};
  s.validate();
  return s;
}

MOTIONLANG_BODY int Skeleton::find(std::string_view name) const {
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (names[j] == name) return static_cast<int>(j);
  }
  return -1;
}

MOTIONLANG_BODY int Skeleton::operator[](std::string_view name) const {
  const int j = find(name);
  if (j < 0)
    raise<config_error>(103, "Skeleton: no joint '", name, "' among ", size(), " joints (root '",
                        names.empty() ? "" : names.front(), "')");
  return j;
}

MOTIONLANG_BODY std::vector<int> Skeleton::children(int joint) const {
  std::vector<int> out;
  for (int j = joint + 1; j < size(); ++j) {
    if (parent(j) == joint) out.push_back(j);
  }
  return out;
}

MOTIONLANG_BODY std::vector<Vec3<double>> Skeleton::rest_positions() const {
  std::vector<Vec3<double>> p(offsets);
  for (int j = 1; j < size(); ++j) {
    p[static_cast<std::size_t>(j)] = p[static_cast<std::size_t>(parent(j))] + offset(j);
  }
  return p;
}

MOTIONLANG_BODY void Skeleton::validate() const {
  if (parents.empty()) raise<config_error>(106, "Skeleton: no joints");
  if (names.size() != parents.size() || offsets.size() != parents.size()) {
    raise<config_error>(106, "Skeleton: ", names.size(), " names, ", parents.size(), " parents, ", offsets.size(),
                        " offsets");
  }
  if (!ends.empty() && ends.size() != parents.size())
    raise<config_error>(106, "Skeleton: ", ends.size(), " ends of ", parents.size(), " joints");
  for (int j = 0; j < size(); ++j) {
    if (j == 0 ? parent(j) != -1 : parent(j) < 0 || parent(j) >= j) {
      raise<config_error>(106, "Skeleton: joint ", j, " '", name(j), "' has parent ", parent(j),
                          j == 0 ? "; the first joint must be the root (-1)" : "; it must be one of the joints before");
    }
    if (find(name(j)) != j) raise<config_error>(106, "Skeleton: two joints are called '", name(j), "'");
  }
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The number of a body part. The enumerators are the five human parts, in the order that STMC uses everywhere. Other
/// bodies have BodyPart{0}, BodyPart{1}, ... in the order of their BodyPartition.
/// Source  STMC (Petrovich et al., CVPR workshops 2024); the thesis says "torso" for `spine`; neck and head are `head`.
enum class BodyPart : int { left_arm, right_arm, legs, head, spine };
inline constexpr int body_part_count = 5;
inline constexpr std::array<std::string_view, body_part_count> body_part_names{"left arm", "right arm", "legs", "head",
                                                                               "spine"};
/// Other names of the human parts.
inline constexpr std::array<std::pair<std::string_view, BodyPart>, 6> body_part_synonyms{{
    {"torso", BodyPart::spine},
    {"neck", BodyPart::head},
    {"left hand", BodyPart::left_arm},
    {"right hand", BodyPart::right_arm},
    {"left leg", BodyPart::legs},
    {"right leg", BodyPart::legs},
}};
/// A body has this many parts at most.
inline constexpr int most_body_parts = 32;

/// A set of body parts, one bit for each.
struct BodyParts {
  unsigned bits = 0;

  /// The five human parts. BodyPartition::all() gives those of another body.
  static constexpr BodyParts all() { return {(1u << body_part_count) - 1}; }
  /// All parts of any body, for callers that do not know the body.
  static constexpr BodyParts every() { return {~0u}; }
  constexpr bool has(BodyPart p) const { return (bits >> static_cast<unsigned>(p) & 1u) != 0; }
  constexpr BodyParts with(BodyPart p) const { return {bits | 1u << static_cast<unsigned>(p)}; }
  constexpr int count() const {
    int n = 0;
    for (unsigned b = bits; b != 0; b &= b - 1) ++n;
    return n;
  }
  constexpr bool empty() const { return bits == 0; }
  constexpr bool operator==(const BodyParts&) const = default;
};

/// The human part that a timeline file names, also by a synonym. Case-sensitive, as published. Nothing for an unknown
/// name.
constexpr std::optional<BodyPart> parse_body_part(std::string_view name) {
  for (int p = 0; p < body_part_count; ++p) {
    if (name == body_part_names[static_cast<std::size_t>(p)]) return static_cast<BodyPart>(p);
  }
  for (const auto& [synonym, part] : body_part_synonyms) {
    if (name == synonym) return part;
  }
  return std::nullopt;
}
/// The name of a human part. Any other number gives "part 7"; BodyPartition::name knows the names of other bodies.
inline std::string to_string(BodyPart part) {
  const auto p = static_cast<std::size_t>(part);
  return p < body_part_names.size() ? std::string(body_part_names[p]) : concat_text("part ", static_cast<int>(part));
}

/// Part of each SMPL joint (24; the first 22 are HumanML3D's). Collars belong to the arms, the pelvis to the legs.
inline constexpr std::array<BodyPart, 24> smpl_part_of_joint = [] {
  using enum BodyPart;
  return std::array{legs,     legs,      legs,     spine,     legs,     legs,      spine,     legs,
                    legs,     spine,     legs,     legs,      head,     left_arm,  right_arm, head,
                    left_arm, right_arm, left_arm, right_arm, left_arm, right_arm, left_arm,  right_arm};
}();

/// Part of each joint of KIT-ML (21, Master Motor Map): the neck belongs to the head, as in SMPL.
inline constexpr std::array<BodyPart, 21> kit_part_of_joint = [] {
  using enum BodyPart;
  return std::array{legs, spine, spine, head, head, left_arm, left_arm, left_arm, right_arm, right_arm, right_arm,
                    legs, legs,  legs,  legs, legs, legs,     legs,     legs,     legs,      legs};
}();

/// Partner of each SMPL joint under reflection in the sagittal plane.
inline constexpr std::array<int, 24> smpl_mirror_joint{0,  2,  1,  3,  5,  4,  6,  8,  7,  9,  11, 10,
                                                       12, 14, 13, 15, 17, 16, 19, 18, 21, 20, 23, 22};

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Another name of a part.
struct PartSynonym {
  std::string name, part;
};

/// A word that tells which parts a text moves: lower-case letters, the beginning of the word ("walk" for "walking").
struct PartWord {
  std::string stem;
  std::vector<std::string> parts;
};

/// The parts from which a BodyPartition is made.
struct BodyPartNames {
  std::vector<std::string> names;       // in the order of their numbers
  std::string path;                     // the part that carries the others over the floor
  std::vector<PartSynonym> synonyms{};  // for reading
  std::vector<PartWord> words{};        // for guesses, see guess_body_parts
};

/// A value that copies share; it never changes.
class BodyPartition {
 public:
  /// The human body: the five parts of STMC, whose legs carry the path.
  BodyPartition() = default;
  /// Throws config_error 101 without a part, for more than `most_body_parts`, for a name that a timeline file cannot
  /// hold (it is empty, has '#', a line end or outer blanks, or is not UTF-8) and for a word of other characters than
  /// a ... z; 102 for a name that is duplicated; 103 for a part that is not one of the names.
  explicit BodyPartition(const BodyPartNames& names);

  int size() const { return static_cast<int>(names().size()); }
  const std::vector<std::string>& names() const { return state().names; }
  /// Throws config_error 101 for a number that the body does not have.
  const std::string& name(BodyPart part) const;
  /// The part that carries the path: its texts are preferred as base texts, and features of the root belong to it.
  BodyPart path() const { return state().path; }
  /// The set of all parts.
  BodyParts all() const { return {~0u >> (most_body_parts - size())}; }
  /// The part of this name or synonym, case-sensitive. Nothing for an unknown name.
  std::optional<BodyPart> find(std::string_view name) const;
  /// The set of these parts, by name or synonym. Throws config_error 103 for an unknown name.
  BodyParts parts(std::span<const std::string> names) const;
  BodyParts parts(std::initializer_list<std::string> names) const {
    return parts(std::span(names.begin(), names.size()));
  }

  struct Named {
    std::string name;
    BodyPart part;
  };
  struct Word {
    std::string stem;
    BodyParts parts;
  };
  const std::vector<Named>& synonyms() const { return state().synonyms; }
  /// Empty for the human body, whose lexicon is in compose/body_part_lexicon.hpp.
  const std::vector<Word>& words() const { return state().words; }

  /// The same names in the same order, and the same part for the path. Synonyms and words do not count.
  bool operator==(const BodyPartition& other) const;

 private:
  struct State {
    std::vector<std::string> names;
    BodyPart path{};
    std::vector<Named> synonyms;
    std::vector<Word> words;
  };
  static const State& human();
  const State& state() const { return state_ ? *state_ : human(); }

  std::shared_ptr<const State> state_;  // none: the human body
};

/// "front left, front right, hind left, hind right, trunk (with the path)"
std::string to_string(const BodyPartition& body);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_BODY_PARTITION_IPP  // <motionlang/kinematics/body_partition.ipp>
#define MOTIONLANG_HAS_KINEMATICS_BODY_PARTITION_IPP
// Bodies of body_partition.hpp.

#ifndef MOTIONLANG_HAS_CORE_TEXT_LINES_HPP  // <motionlang/core/text_lines.hpp>
#define MOTIONLANG_HAS_CORE_TEXT_LINES_HPP
/// Texts line by line, their blanks and small letters.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// A letter of ASCII in small, whatever the locale.
constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Without the blanks at both ends.
constexpr std::string_view trim(std::string_view s) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  const std::size_t first = s.find_first_not_of(blanks);
  return first == s.npos ? s.substr(0, 0) : s.substr(first, s.find_last_not_of(blanks) - first + 1);
}

/// Calls on_line(line, number) for every line, without its end (LF, CRLF, CR); numbers count from 1. A byte order mark
/// is skipped.
template <class F>
void for_each_line(std::string_view text, F on_line) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (Index number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    on_line(text.substr(0, end), number);
    text.remove_prefix(std::min(text.size(), end + (text.substr(end).starts_with("\r\n") ? 2 : 1)));
  }
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws config_error 101 unless a line of a timeline can hold the name.
inline void check_part_name(std::string_view name) {
  if (name.empty() || name != trim(name) || name.find_first_of("#\r\n") != name.npos || !is_utf8(name))
    raise<config_error>(101, "BodyPartition: '", name, "' cannot be the name of a body part in a timeline");
}

}  // namespace detail

MOTIONLANG_BODY BodyPartition::BodyPartition(const BodyPartNames& names) {
  if (names.names.empty() || names.names.size() > most_body_parts)
    raise<config_error>(101, "BodyPartition: ", counted(names.names.size(), "part"), ", expected 1 to ",
                        most_body_parts);
  const auto made = std::make_shared<State>();
  state_ = made;  // find and parts look at what is there so far
  const auto check_new = [&](const std::string& name) {
    detail::check_part_name(name);
    if (find(name)) raise<config_error>(102, "BodyPartition: '", name, "' is the name of two body parts");
  };
  for (const std::string& name : names.names) {
    check_new(name);
    made->names.push_back(name);
  }
  const auto known = [&](std::string_view name) {
    const auto part = find(name);
    if (!part) raise<config_error>(103, "BodyPartition: '", name, "' is not one of ", join_text(made->names));
    return *part;
  };
  made->path = known(names.path);
  for (const PartSynonym& s : names.synonyms) {
    check_new(s.name);
    made->synonyms.push_back({s.name, known(s.part)});
  }
  for (const PartWord& w : names.words) {
    if (w.stem.empty() || std::any_of(w.stem.begin(), w.stem.end(), [](char c) { return c < 'a' || c > 'z'; }))
      raise<config_error>(101, "BodyPartition: the word '", w.stem, "' has other characters than a to z");
    made->words.push_back({w.stem, parts(w.parts)});
  }
}

MOTIONLANG_BODY const std::string& BodyPartition::name(BodyPart part) const {
  const auto p = static_cast<std::size_t>(part);
  if (p >= names().size())
    raise<config_error>(101, "BodyPartition: part ", static_cast<int>(part), " of a body of ",
                        counted(names().size(), "part"));
  return names()[p];
}

MOTIONLANG_BODY std::optional<BodyPart> BodyPartition::find(std::string_view name) const {
  const auto found = std::find(names().begin(), names().end(), name);
  if (found != names().end()) return static_cast<BodyPart>(found - names().begin());
  for (const Named& s : synonyms()) {
    if (s.name == name) return s.part;
  }
  return std::nullopt;
}

MOTIONLANG_BODY BodyParts BodyPartition::parts(std::span<const std::string> names) const {
  BodyParts out;
  for (const std::string& name : names) {
    const auto part = find(name);
    if (!part) raise<config_error>(103, "BodyPartition: '", name, "' is not one of ", join_text(this->names()));
    out = out.with(*part);
  }
  return out;
}

MOTIONLANG_BODY bool BodyPartition::operator==(const BodyPartition& other) const {
  return state_ == other.state_ || (path() == other.path() && names() == other.names());
}

MOTIONLANG_BODY const BodyPartition::State& BodyPartition::human() {
  static const State human = [] {
    State s{std::vector<std::string>(body_part_names.begin(), body_part_names.end()), BodyPart::legs, {}, {}};
    for (const auto& [name, part] : body_part_synonyms) s.synonyms.push_back({std::string(name), part});
    return s;
  }();
  return human;
}

MOTIONLANG_BODY std::string to_string(const BodyPartition& body) {
  return join_text(body.names(), ", ", [&](const std::string& name) {
    return name == body.name(body.path()) ? name + " (with the path)" : name;
  });
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Where an interval was read, for messages. It says nothing about the interval: all places are equal.
struct TextPlace {
  Index line = 0, column = 0;  // from 1; 0: not from a text
  constexpr bool operator==(const TextPlace&) const { return true; }
};

/// A text that acts on some body parts from `start` up to, not including, `end`.
template <class T>
struct BasicInterval {
  std::string text;
  T start{}, end{};
  BodyParts parts;
  TextPlace place{};
  bool operator==(const BasicInterval&) const = default;
};

/// Intervals in the order of the file, which matters: it decides ties.
template <class T>
struct BasicTimeline {
  std::vector<BasicInterval<T>> intervals;
  BodyPartition body{};  // whose parts the intervals move; the human body unless given

  /// End of the last interval.
  T end() const {
    T last{};
    for (const auto& i : intervals) last = std::max(last, i.end);
    return last;
  }
  bool operator==(const BasicTimeline&) const = default;
};

using Interval = BasicInterval<Index>;
using Timeline = BasicTimeline<Index>;
using IntervalInSeconds = BasicInterval<double>;
using TimelineInSeconds = BasicTimeline<double>;

/// Times beyond this number of frames or seconds are refused.
inline constexpr Index latest_time = 1'000'000'000;

/// trunc(fps * seconds), calculated in double as the published readers do. Throws config_error 101 if it is not a time.
Index frame_at(double seconds, double fps);

/// Moves a timeline so that it begins at 0.
template <class T>
void shift_to_zero(BasicTimeline<T>& timeline) {
  if (timeline.intervals.empty()) return;
  T first = timeline.intervals.front().start;
  for (const auto& i : timeline.intervals) first = std::min(first, i.start);
  for (auto& i : timeline.intervals) i.start -= first, i.end -= first;
}

/// Frames of a timeline, shifted to 0 after the conversion. Throws config_error 101.
Timeline to_frames(const TimelineInSeconds& timeline, double fps);

/// Seconds of a timeline, such that to_frames gives the same frames back. Throws config_error 101.
TimelineInSeconds to_seconds(const Timeline& timeline, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_TIMELINE_IPP  // <motionlang/compose/timeline.ipp>
#define MOTIONLANG_HAS_COMPOSE_TIMELINE_IPP
// Bodies of timeline.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Index frame_at(double seconds, double fps) {
  const double frame = std::trunc(fps * seconds);
  if (!(std::abs(frame) <= static_cast<double>(latest_time))) {
    raise<config_error>(101, "frame_at: ", seconds, " s at ", fps, " frames per second is out of range");
  }
  return static_cast<Index>(frame);
}

MOTIONLANG_BODY Timeline to_frames(const TimelineInSeconds& timeline, double fps) {
  Timeline out{{}, timeline.body};
  for (const auto& i : timeline.intervals) {
    out.intervals.push_back({i.text, frame_at(i.start, fps), frame_at(i.end, fps), i.parts, i.place});
  }
  shift_to_zero(out);
  return out;
}

MOTIONLANG_BODY TimelineInSeconds to_seconds(const Timeline& timeline, double fps) {
  const auto seconds = [&](Index frame) {
    double t = static_cast<double>(frame) / fps;
    while (frame_at(t, fps) < frame) t = std::nextafter(t, HUGE_VAL);  // the quotient was rounded down
    return t;
  };
  TimelineInSeconds out{{}, timeline.body};
  for (const auto& i : timeline.intervals)
    out.intervals.push_back({i.text, seconds(i.start), seconds(i.end), i.parts, i.place});
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct TimelineTextOptions {
  double fps = 20;  // frame = trunc(fps * seconds)
  /// Take intervals without a frame and texts without parts as they are. Else texts without parts move the whole body.
  bool as_published = false;
  std::string_view name = "timeline";  // of the file, for messages
  BodyPartition body{};                // whose parts the texts move
};

/// A text with a length, for motions of one text each: it moves the whole body.
struct TimedText {
  std::string text;
  Index frames = 0;
  bool operator==(const TimedText&) const = default;
};

/// All timelines of a file, in frames, each shifted to begin at 0.
std::vector<Timeline> parse_timelines(std::string_view text, const TimelineTextOptions& options = {});
/// All timelines of a file, in seconds; options.fps has no effect.
std::vector<TimelineInSeconds> parse_timelines_in_seconds(std::string_view text,
                                                          const TimelineTextOptions& options = {});
/// The only timeline of a text. Throws timeline_error 509 if there are several.
///
///     auto timeline = parse_timeline("walking in a circle # 0.0 # 6.0 # legs\n"
///                                    "raising both hands  # 2.0 # 5.0 # left arm # right arm\n", {.fps = 20});
Timeline parse_timeline(std::string_view text, const TimelineTextOptions& options = {});

/// True if a file is a list of single texts ("text # duration") rather than of timelines: every line has fewer than
/// three fields, or a body part where timelines have their second time. The published programs ask for one line of
/// fewer than three fields only (`as_published`), and then blame the others.
bool is_text_list(std::string_view text, const TimelineTextOptions& options = {});

/// Lines "text # duration"; blank lines are skipped. Body parts may follow, as in timelines, and have no effect: a
/// single text moves the whole body. `as_published` takes any further field. Throws timeline_error 501 ... 504, 507.
std::vector<TimedText> parse_text_list(std::string_view text, const TimelineTextOptions& options = {});

/// The text form: fields joined by " # ", body parts in alphabetical order, an empty line after each timeline. Reading
/// it gives the same timelines back (texts trimmed, begin at 0). Throws timeline_error 510 if a text contains '#' or a
/// line end.
std::string write_timelines(std::span<const TimelineInSeconds> timelines);
std::string write_timeline(const TimelineInSeconds& timeline);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_TIMELINE_TEXT_IPP  // <motionlang/compose/timeline_text.ipp>
#define MOTIONLANG_HAS_COMPOSE_TIMELINE_TEXT_IPP
// Bodies of timeline_text.hpp.

#ifndef MOTIONLANG_HAS_COMPOSE_DETAIL_TIMELINE_LINE_HPP  // <motionlang/compose/detail/timeline_line.hpp>
#define MOTIONLANG_HAS_COMPOSE_DETAIL_TIMELINE_LINE_HPP
/// A line of a file of timelines. Only bodies (*.ipp) include it.

#ifndef MOTIONLANG_HAS_COMPOSE_DETAIL_SECONDS_TEXT_HPP  // <motionlang/compose/detail/seconds_text.hpp>
#define MOTIONLANG_HAS_COMPOSE_DETAIL_SECONDS_TEXT_HPP
/// Times in seconds as they are written in timelines.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A time in seconds, finite and not beyond `latest_time`; nothing if the whole text is none.
std::optional<double> parse_seconds(std::string_view text);

/// Shortest decimal form, as Python prints a float: 5.5, 8.0, 1e-05, 1e+16.
void append_python_float(std::string& out, double x);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_DETAIL_SECONDS_TEXT_IPP  // <motionlang/compose/detail/seconds_text.ipp>
#define MOTIONLANG_HAS_COMPOSE_DETAIL_SECONDS_TEXT_IPP
// Bodies of seconds_text.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::optional<double> parse_seconds(std::string_view text) {
  double t = 0;
  const char* last = text.data() + text.size();
  const auto [end, status] = detail::from_chars(text.data(), last, t);
  const bool good = status == std::errc{} && end == last && std::abs(t) <= static_cast<double>(latest_time);
  return good ? std::optional(t) : std::nullopt;
}

MOTIONLANG_BODY void append_python_float(std::string& out, double x) {
  char digits[64];
  const double size = std::abs(x);
  const bool fixed = size == 0 || (size >= 1e-4 && size < 1e16);
  const auto end = detail::to_chars(digits, digits + sizeof digits, x,
                                    fixed ? std::chars_format::fixed : std::chars_format::scientific)
                       .ptr;
  const std::string_view text(digits, static_cast<std::size_t>(end - digits));
  out += text;
  if (fixed && text.find('.') == text.npos) out += ".0";
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws timeline_error with a message that begins "name:line:column: ".
template <class... T>
[[noreturn]] void fail_at(int id, std::string_view name, const TextPlace& place, const T&... what) {
  raise<timeline_error>(id, name, ":", place.line, ":", place.column, ": ", what...);
}

/// One line of a file, split at '#'. Knows where it stands.
class TimelineLine {
 public:
  TimelineLine(std::string_view line, Index number, std::string_view name) : line_(line), number_(number), name_(name) {
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t end = std::min(line.find('#', at), line.size());
      fields_.push_back(trim(line.substr(at, end - at)));
      at = end + 1;
    }
  }

  std::size_t fields() const { return fields_.size(); }
  std::string_view field(std::size_t i) const { return fields_[i]; }

  /// Throws timeline_error at the beginning of a field (past the last one: at the end of the line).
  template <class... T>
  [[noreturn]] void fail(int id, std::size_t field, const T&... what) const {
    fail_at(id, name_, place(field), what...);
  }
  /// The place of the beginning of a field.
  TextPlace place(std::size_t field) const {
    const char* begin = field < fields_.size() ? fields_[field].data() : line_.data() + line_.size();
    Index column = 1;
    for (const char* c = line_.data(); c < begin; ++c) column += (static_cast<unsigned char>(*c) & 0xC0u) != 0x80u;
    return {number_, column};
  }

  std::string text() const {
    if (!is_utf8(fields_[0])) fail(501, 0, "the text is not UTF-8");
    return std::string(fields_[0]);
  }

  /// A time in seconds. Python's spelling: a plus sign is allowed, infinity is not.
  double seconds(std::size_t i) const {
    std::string_view s = fields_[i];
    if (s.size() > 1 && s[0] == '+' && s[1] != '-') s.remove_prefix(1);
    const auto t = parse_seconds(s);
    if (!t) fail(502, i, "'", fields_[i], "' is not a time in seconds");
    return *t;
  }

  /// The parts that the fields from `first` on name.
  BodyParts parts(std::size_t first, const BodyPartition& body) const {
    BodyParts parts;
    for (std::size_t i = first; i < fields_.size(); ++i) {
      const auto part = body.find(fields_[i]);
      if (!part) fail(503, i, "'", fields_[i], "' is not a body part (", join_text(body.names()), ")");
      parts = parts.with(*part);
    }
    return parts;
  }

 private:
  std::string_view line_;
  Index number_;
  std::string_view name_;
  std::vector<std::string_view> fields_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_SORT_HPP  // <motionlang/core/sort.hpp>
#define MOTIONLANG_HAS_CORE_SORT_HPP
/// Sorting of short lists. std::sort is faster on long ones, but every use of it is compiled with some thirty
/// functions.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// Sorts by `less`, which leaves no two elements equal or does not care for their order. Heap sort: n log n steps
/// whatever the list. `List` is a vector.
template <class List, class Less>
void sort(List& list, Less less) {
  const auto sift_down = [&](std::size_t i, std::size_t size) {
    for (std::size_t child; (child = 2 * i + 1) < size; i = child) {
      if (child + 1 < size && less(list[child], list[child + 1])) ++child;
      if (!less(list[i], list[child])) return;
      std::swap(list[i], list[child]);
    }
  };
  for (std::size_t i = list.size() / 2; i-- > 0;) sift_down(i, list.size());
  for (std::size_t size = list.size(); size-- > 1;) {
    std::swap(list[0], list[size]);
    sift_down(0, size);
  }
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// T = Index: frames at options.fps; T = double: seconds.
template <class T>
BasicInterval<T> parse_interval(const TimelineLine& line, const TimelineTextOptions& options) {
  if (line.fields() < 3) line.fail(501, line.fields(), "expected 'text # start # end # body parts'");
  const auto time = [&](std::size_t i) {
    if constexpr (std::is_same_v<T, Index>) {
      const double seconds = line.seconds(i);
      if (std::abs(seconds * options.fps) > double(latest_time)) line.fail(502, i, "'", line.field(i), "' is too late");
      return frame_at(seconds, options.fps);
    } else {
      return line.seconds(i);
    }
  };
  BasicInterval<T> out{line.text(), time(1), time(2), line.parts(3, options.body), line.place(0)};
  if (out.parts == BodyParts{} && !options.as_published) out.parts = options.body.all();
  if (!(out.start < out.end) && !options.as_published) {
    line.fail(504, 2, "the interval ", line.field(1), " to ", line.field(2), " s ",
              line.seconds(1) < line.seconds(2) ? "has no frame" : "is empty or ends before it starts");
  }
  return out;
}

template <class T>
std::vector<BasicTimeline<T>> parse_timelines_as(std::string_view text, const TimelineTextOptions& options) {
  if (!(options.fps > 0)) raise<config_error>(101, "parse_timelines: fps ", options.fps);
  std::vector<BasicTimeline<T>> out;
  bool inside = false;
  for_each_line(text, [&](std::string_view line, Index number) {
    const bool blank = trim(line).empty();
    if (!blank) {
      if (!inside) out.push_back({{}, options.body});
      out.back().intervals.push_back(parse_interval<T>(TimelineLine(line, number, options.name), options));
    }
    inside = !blank;
  });
  if (out.empty()) raise<timeline_error>(507, options.name, ": no line");
  for (auto& timeline : out) {
    shift_to_zero(timeline);
    for (const auto& i : timeline.intervals) {
      if (i.end <= static_cast<T>(latest_time)) continue;
      fail_at(502, options.name, i.place, "a timeline that lasts ", i.end, " is too long");
    }
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<Timeline> parse_timelines(std::string_view text, const TimelineTextOptions& options) {
  return detail::parse_timelines_as<Index>(text, options);
}

MOTIONLANG_BODY std::vector<TimelineInSeconds> parse_timelines_in_seconds(std::string_view text,
                                                                          const TimelineTextOptions& options) {
  return detail::parse_timelines_as<double>(text, options);
}

MOTIONLANG_BODY Timeline parse_timeline(std::string_view text, const TimelineTextOptions& options) {
  auto all = parse_timelines(text, options);
  if (all.size() > 1)
    detail::fail_at(509, options.name, all[1].intervals.front().place, all.size(), " timelines where one is expected");
  return std::move(all.front());
}

MOTIONLANG_BODY bool is_text_list(std::string_view text, const TimelineTextOptions& options) {
  Index lines = 0, short_lines = 0, lines_with_parts = 0;
  detail::for_each_line(text, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    ++lines;
    const detail::TimelineLine line(content, number, options.name);
    if (line.fields() < 3)
      ++short_lines;
    else if (options.body.find(line.field(2)))
      ++lines_with_parts;
  });
  return options.as_published ? short_lines > 0 : lines > 0 && short_lines + lines_with_parts == lines;
}

MOTIONLANG_BODY std::vector<TimedText> parse_text_list(std::string_view text, const TimelineTextOptions& options) {
  std::vector<TimedText> out;
  detail::for_each_line(text, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    const detail::TimelineLine line(content, number, options.name);
    if (line.fields() < 2) line.fail(501, line.fields(), "expected 'text # duration'");
    if (!options.as_published) line.parts(2, options.body);
    const double seconds = line.seconds(1);
    if (std::abs(seconds * options.fps) > double(latest_time)) line.fail(502, 1, "'", line.field(1), "' is too long");
    const Index frames = frame_at(seconds, options.fps);
    if (frames <= 0 && !options.as_published) line.fail(504, 1, "a duration of ", line.field(1), " s has no frame");
    out.push_back({line.text(), frames});
  });
  if (out.empty()) raise<timeline_error>(507, options.name, ": no line");
  return out;
}

MOTIONLANG_BODY std::string write_timelines(std::span<const TimelineInSeconds> timelines) {
  std::string out;
  for (const TimelineInSeconds& timeline : timelines) {
    const BodyPartition& body = timeline.body;
    std::vector<BodyPart> alphabetical;
    alphabetical.reserve(static_cast<std::size_t>(body.size()));
    for (int p = 0; p < body.size(); ++p) alphabetical.push_back(static_cast<BodyPart>(p));
    detail::sort(alphabetical, [&](BodyPart a, BodyPart b) { return body.name(a) < body.name(b); });
    for (const IntervalInSeconds& i : timeline.intervals) {
      if (i.text.find_first_of("#\r\n") != i.text.npos) {
        raise<timeline_error>(510, "write_timelines: the text '", i.text, "' contains '#' or a line end");
      }
      out += i.text + " # ";
      detail::append_python_float(out, i.start);
      out += " # ";
      detail::append_python_float(out, i.end);
      for (BodyPart part : alphabetical) {
        if (i.parts.has(part)) out += " # " + body.name(part);
      }
      out += '\n';
    }
    out += '\n';
  }
  return out;
}

MOTIONLANG_BODY std::string write_timeline(const TimelineInSeconds& timeline) {
  return write_timelines(std::span(&timeline, 1));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_FILE_PATH_HPP  // <motionlang/file/file_path.hpp>
#define MOTIONLANG_HAS_FILE_FILE_PATH_HPP
/// Names of files.

MOTIONLANG_NAMESPACE_BEGIN

/// The name of a file: a string, or a std::filesystem::path, whose header takes longer to compile than this library's
/// io.
class FilePath {
 public:
  FilePath(const char* text) : text_(text) {}
  FilePath(std::string text) : text_(std::move(text)) {}
  template <class Path>
  requires requires(const Path& path) { path.lexically_normal().string(); }
  FilePath(const Path& path) : text_(path.string()) {}

  const std::string& string() const { return text_; }
  const char* c_str() const { return text_.c_str(); }
  /// The name of a file in this folder; "" is the current folder, as parent_path() of a bare name has it.
  std::string inside(const std::string& name) const { return text_.empty() ? name : text_ + "/" + name; }
  /// The last part without its extension: "walk" of "clips/walk.bvh".
  std::string stem() const {
#if defined(_WIN32)
    constexpr const char* separators = "/\\";
#else
    constexpr const char* separators = "/";
#endif
    const std::string name = text_.substr(text_.find_last_of(separators) + 1);
    const std::size_t dot = name.find_last_of('.');
    return dot == 0 ? name : name.substr(0, dot);
  }

 private:
  std::string text_;
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_GENERATE_GENERATE_MOTION_HPP  // <motionlang/generate/generate_motion.hpp>
#define MOTIONLANG_HAS_GENERATE_GENERATE_MOTION_HPP
/// From a timeline of texts to a finished motion, as the program `motionlang generate` makes it: it cuts texts
/// where a model needs that, samples all of them together, smooths the motion and fixes its feet.
///
///     const auto stmc = load_stmc<EigenBackend<float>>("stmc_free.safetensors");
///     const auto timeline = parse_timeline("walk forward # 0 # 6 # legs\nwave # 2 # 5 # left arm\n");
///     const Motion motion = generate_motion(stmc, timeline, {.seed = 7});
///
/// Motion  Y up, metres, on SMPL's 24 joints (KIT's 21 by a model of KIT-ML); of the bundled model it starts facing -Z
/// Models  any Stmc; every other system behind MotionModel (generate/motion_model.hpp)
/// Bodies  motionlang::instantiated has those for Stmc<EigenBackend<float>>. A unit that is compiled with
///         MOTIONLANG_INSTANTIATED and uses another Stmc also includes <motionlang/generate/generate_motion.ipp>

#ifndef MOTIONLANG_HAS_GENERATE_GENERATE_OPTIONS_HPP  // <motionlang/generate/generate_options.hpp>
#define MOTIONLANG_HAS_GENERATE_GENERATE_OPTIONS_HPP
/// Options for generating a motion from a timeline, in one struct for every model.
///
///     const Motion a = generate_motion(stmc, timeline, {.seed = 7});
///     const Motion b = generate_motion(stmc, timeline, {.seed = 7, .steps = 10, .smooth = false});
///
/// The defaults are those of the program `motionlang generate`.

#ifndef MOTIONLANG_HAS_CORE_OPTION_ERROR_HPP  // <motionlang/core/option_error.hpp>
#define MOTIONLANG_HAS_CORE_OPTION_ERROR_HPP
/// Options that a caller cannot have meant.

MOTIONLANG_NAMESPACE_BEGIN

/// Options that a model or a file does not take, or that contradict each other; a result that would take the place of
/// what it is made from: a config_error that is the caller's, not the file's.
struct option_error : config_error {
  using config_error::config_error;
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_SAMPLER_HPP  // <motionlang/diffusion/sampler.hpp>
#define MOTIONLANG_HAS_DIFFUSION_SAMPLER_HPP
/// From noise to a sample: ancestral (DDPM), DDIM with its inversion, and PLMS.
///
/// The loops know nothing of motion. They call
///     network(x, t) -> what the network predicts at index t of the process (already guided), same shape as x
///     noise(draw)   -> standard normal numbers of that shape; draw 0 is the first after the initial tensor
///     fix(x0, t)    -> the clean estimate that is used (inpainting, stitching); identity if not given

#ifndef MOTIONLANG_HAS_CORE_PROGRESS_HPP  // <motionlang/core/progress.hpp>
#define MOTIONLANG_HAS_CORE_PROGRESS_HPP
/// Reports the progress of long work to the caller, who may stop it.

MOTIONLANG_NAMESPACE_BEGIN

/// A reference to a caller's `bool f(Index done, Index total)`; false stops the work with `cancelled`. May be empty.
/// Without exceptions false ends the program, like an error: there the C functions can be cancelled (motionlang/c).
/// Like a pointer: the callable must outlive it, so a temporary one does not compile.
class Progress {
 public:
  Progress() = default;
  template <class F>
  requires(!std::is_same_v<std::remove_cv_t<F>, Progress> && std::is_invocable_r_v<bool, F&, Index, Index>)
      Progress(F& f)
      : object_(address(f)), call_([](void* object, Index done, Index total) -> bool {
          return (*reinterpret_cast<F*>(object))(done, total);
        }) {}

  /// Throws `cancelled` if the caller answers false.
  void operator()(Index done, Index total) const {
    if (call_ != nullptr && !call_(object_, done, total)) detail::throw_exception(cancelled());
  }

 private:
  template <class F>
  static void* address(F& f) {
    if constexpr (std::is_function_v<F>)
      return reinterpret_cast<void*>(&f);
    else
      return const_cast<void*>(static_cast<const void*>(std::addressof(f)));
  }

  void* object_ = nullptr;
  bool (*call_)(void*, Index, Index) = nullptr;
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_GAUSSIAN_HPP  // <motionlang/diffusion/gaussian.hpp>
#define MOTIONLANG_HAS_DIFFUSION_GAUSSIAN_HPP
/// The Gaussian diffusion process: all coefficients of a schedule, noising, the posterior, and the four things that a
/// network may predict, converted into each other.
///
/// Notation (Ho et al. 2020)   beta_t, alpha_t = 1 - beta_t, abar_t = prod_{s <= t} alpha_s, abarp_t = abar_{t-1} (1
///                             for t = 0), abarn_t = abar_{t+1} (0 for the last). Index t stands for t + 1 applications
///                             of noise.
/// Precision   tables are built in double, the entry for t is rounded to the tensor's scalar, then one multiplication
///             and one addition per term in the order written: what the published code does, and what parity needs.

#ifndef MOTIONLANG_HAS_DIFFUSION_SCHEDULE_HPP  // <motionlang/diffusion/schedule.hpp>
#define MOTIONLANG_HAS_DIFFUSION_SCHEDULE_HPP
/// Noise schedules: how much noise step t adds.

MOTIONLANG_NAMESPACE_BEGIN

/// A forward process q(x_t | x_{t-1}) = N(sqrt(1 - beta_t) x_{t-1}, beta_t I), t = 0 ... steps-1 (thesis eq. 6.1).
/// Minimum   steps, beta(t)
/// Deduced   everything in gaussian.hpp
/// Laws      0 < beta(t) <= 1 (checked where the tables are built)
/// Models    LinearSchedule, ScaledLinearSchedule, CosineSchedule, ChenCosineSchedule, BetaList
template <class S>
concept Schedule = requires(const S& s, Index t) {
  { s.steps } -> std::convertible_to<Index>;
  { s.beta(t) } -> std::convertible_to<double>;
};

/// Ho et al. (2020), rescaled so that any number of steps ends in the same noise:
///     beta_t from 0.0001 c to 0.02 c, c = scale_betas 1000 / steps
struct LinearSchedule {
  Index steps = 1000;
  double scale_betas = 1;

  double beta(Index t) const;
};

/// Linear in the square root, as latent diffusion has it.
struct ScaledLinearSchedule {
  Index steps = 1000;
  double b0 = 0.00085, b1 = 0.012;

  double beta(Index t) const;
};

/// Nichol and Dhariwal (2021), eq. 17; the schedule of MDM and, with 100 steps, of STMC (the thesis cites Chen 2023,
/// the released code has this one):
///     f(u) = cos((u + s) / (1 + s) pi / 2)^2,   beta_t = min(1 - f((t + 1) / steps) / f(t / steps), 0.999)
struct CosineSchedule {
  Index steps = 100;
  double s = 0.008;

  double beta(Index t) const;
};

/// Chen (2023), what the thesis cites; no published checkpoint uses it.
///     v(u) = cos((u (end - start) + start) pi / 2)^(2 tau)
///     alpha_bar(u) = clip((v(1) - v(u)) / (v(1) - v(0)), clip_min, 1)
struct ChenCosineSchedule {
  Index steps = 100;
  double start = 0, end = 1, tau = 1, clip_min = 1e-9;

  double alpha_bar(double u) const;
  double beta(Index t) const;
};

/// Any list, for example the betas of a respaced process.
struct BetaList {
  std::vector<double> betas;
  Index steps = static_cast<Index>(betas.size());

  double beta(Index t) const { return betas[static_cast<std::size_t>(t)]; }
};

static_assert(Schedule<LinearSchedule> && Schedule<ScaledLinearSchedule> && Schedule<CosineSchedule> &&
              Schedule<ChenCosineSchedule> && Schedule<BetaList>);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DIFFUSION_SCHEDULE_IPP  // <motionlang/diffusion/schedule.ipp>
#define MOTIONLANG_HAS_DIFFUSION_SCHEDULE_IPP
// Bodies of schedule.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double LinearSchedule::beta(Index t) const {
  const double c = scale_betas * 1000 / static_cast<double>(steps), low = c * 0.0001, high = c * 0.02;
  return steps == 1 ? low : low + (high - low) * static_cast<double>(t) / static_cast<double>(steps - 1);
}

MOTIONLANG_BODY double ScaledLinearSchedule::beta(Index t) const {
  const double a = std::sqrt(b0), b = std::sqrt(b1);
  const double r = steps == 1 ? a : a + (b - a) * static_cast<double>(t) / static_cast<double>(steps - 1);
  return r * r;
}

MOTIONLANG_BODY double CosineSchedule::beta(Index t) const {
  auto f = [&](double u) {
    const double c = std::cos((u + s) / (1 + s) * std::numbers::pi / 2);
    return c * c;
  };
  const double n = static_cast<double>(steps), i = static_cast<double>(t);
  return std::min(1 - f((i + 1) / n) / f(i / n), 0.999);
}

MOTIONLANG_BODY double ChenCosineSchedule::alpha_bar(double u) const {
  auto v = [&](double x) { return std::pow(std::cos((x * (end - start) + start) * std::numbers::pi / 2), 2 * tau); };
  return std::clamp((v(1) - v(u)) / (v(1) - v(0)), clip_min, 1.0);
}

MOTIONLANG_BODY double ChenCosineSchedule::beta(Index t) const {
  const double n = static_cast<double>(steps), i = static_cast<double>(t);
  return std::min(1 - alpha_bar((i + 1) / n) / alpha_bar(i / n), 0.999);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The quantity that a network predicts from x_t.
enum class Prediction { x0, eps, score, x_prev };

/// How much noise an ancestral step adds.
///   posterior_std        the standard deviation of q(x_{t-1} | x_t, x0), 0 at t = 0: DDPM as written in the papers
///   posterior_variance   the variance itself: a quirk of the released STMC code with which all its results were made
enum class NoiseScale { posterior_std, posterior_variance };

/// fixed_small: the posterior variance; fixed_large: beta_t (and the posterior variance at t = 1 for t = 0).
enum class Variance { fixed_small, fixed_large };

class GaussianDiffusion {
 public:
  /// Throws config_error 104 if a beta is outside (0, 1].
  template <Schedule S>
  explicit GaussianDiffusion(const S& schedule) {
    std::vector<double> betas;
    for (Index t = 0; t < static_cast<Index>(schedule.steps); ++t) betas.push_back(schedule.beta(t));
    build(std::move(betas));
    for (Index t = 0; t < steps(); ++t) network_t_.push_back(t);
  }
  /// The process that keeps only some steps (respacing.hpp): beta'_i = 1 - abar[S_i] / abar[S_{i-1}]. The network still
  /// receives the original numbers. Throws config_error 104, 105.
  GaussianDiffusion respaced(std::span<const Index> kept) const;

  Index steps() const { return static_cast<Index>(beta_.size()); }
  /// The number that the network receives at index t of this process.
  Index network_t(Index t) const { return network_t_[at(t)]; }

  double beta(Index t) const { return beta_[at(t)]; }
  double alpha(Index t) const { return 1 - beta_[at(t)]; }
  double abar(Index t) const { return abar_[at(t)]; }
  /// 1 / abar. Throws config_error 104 where nothing of x0 is left: neither noise nor score tell anything of it.
  double inverse_abar(Index t) const;
  double abarp(Index t) const { return t == 0 ? 1 : abar_[at(t) - 1]; }
  double abarn(Index t) const { return t + 1 == steps() ? 0 : abar_[at(t) + 1]; }
  /// Variance of the posterior (thesis eq. 6.4): beta_t (1 - abarp_t) / (1 - abar_t); 0 at t = 0.
  double posterior_variance(Index t) const { return beta(t) * (1 - abarp(t)) / (1 - abar(t)); }
  /// Its logarithm, with index 1 in place of index 0.
  double posterior_log_variance(Index t) const;
  double large_variance(Index t) const;
  /// Weights of x0 and x_t in the posterior mean (thesis eq. 6.3).
  double c0(Index t) const { return beta(t) * std::sqrt(abarp(t)) / (1 - abar(t)); }
  double ct(Index t) const { return (1 - abarp(t)) * std::sqrt(alpha(t)) / (1 - abar(t)); }

  /// Factor of the noise in an ancestral step; 0 at t = 0.
  double noise_factor(Index t, NoiseScale scale, Variance variance = Variance::fixed_small) const;

 private:
  void build(std::vector<double> betas);
  std::size_t at(Index t) const {
    if (t < 0 || t >= steps()) raise<shape_error>(203, "GaussianDiffusion: step ", t, " of ", steps());
    return static_cast<std::size_t>(t);
  }

  std::vector<double> beta_, abar_;
  std::vector<Index> network_t_;
};

/// One coefficient per sample (leading index) as a tensor that broadcasts over the rest; rounded to the scalar.
template <Backend B, int R, class F>
Tensor<B, R> coefficients(std::span<const Index> t, F f) {
  PoolVector<typename B::scalar> values;
  for (Index i : t) values.push_back(static_cast<typename B::scalar>(f(i)));
  Shape s{static_cast<Index>(t.size())};
  for (int i = 1; i < R; ++i) s.push_back(1);
  return Tensor<B, R>::from(std::span<const typename B::scalar>(values), s);
}

/// x_t = sqrt(abar_t) x0 + sqrt(1 - abar_t) eps: the steps 0 ... t of thesis eq. 6.1 at once (Ho et al. 2020, eq. 4).
/// One t per leading index, or one for all.
template <Backend B, int R>
Tensor<B, R> q_sample(const GaussianDiffusion& d, const Tensor<B, R>& x0, std::span<const Index> t,
                      const Tensor<B, R>& eps) {
  return coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.abar(i)); }) * x0 +
         coefficients<B, R>(t, [&](Index i) { return std::sqrt(1 - d.abar(i)); }) * eps;
}

/// Mean of q(x_{t-1} | x_t, x0): c0 x0 + ct x_t.   (thesis eq. 6.3; Ho et al. 2020, eq. 7)
template <Backend B, int R>
Tensor<B, R> posterior_mean(const GaussianDiffusion& d, const Tensor<B, R>& x0, const Tensor<B, R>& x_t,
                            std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return d.c0(i); }) * x0 +
         coefficients<B, R>(t, [&](Index i) { return d.ct(i); }) * x_t;
}
/// The same mean from the noise: (x_t - beta_t / sqrt(1 - abar_t) eps) / sqrt(alpha_t).   (Ho et al. 2020, eq. 11)
template <Backend B, int R>
Tensor<B, R> posterior_mean_from_eps(const GaussianDiffusion& d, const Tensor<B, R>& eps, const Tensor<B, R>& x_t,
                                     std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return 1 / std::sqrt(d.alpha(i)); }) * x_t -
         coefficients<B, R>(t, [&](Index i) {
           return d.beta(i) / (std::sqrt(1 - d.abar(i)) * std::sqrt(d.alpha(i)));
         }) * eps;
}
/// The same mean from the score: (x_t + beta_t score) / sqrt(alpha_t).
template <Backend B, int R>
Tensor<B, R> posterior_mean_from_score(const GaussianDiffusion& d, const Tensor<B, R>& score, const Tensor<B, R>& x_t,
                                       std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return 1 / std::sqrt(d.alpha(i)); }) * x_t +
         coefficients<B, R>(t, [&](Index i) { return d.beta(i) / std::sqrt(d.alpha(i)); }) * score;
}

/// x0 from whatever the network predicted.
///     eps:    sqrt(1/abar) x_t - sqrt(1/abar - 1) eps
///     score:  x_t / sqrt(abar) + (1 - abar) / sqrt(abar) score
///     x_prev: x_prev / c0 - ct / c0 x_t
template <Backend B, int R>
Tensor<B, R> to_x0(const GaussianDiffusion& d, Prediction from, const Tensor<B, R>& value, const Tensor<B, R>& x_t,
                   std::span<const Index> t) {
  auto k = [&](auto f) { return coefficients<B, R>(t, f); };
  switch (from) {
    case Prediction::x0:
      return value;
    case Prediction::eps:
      return k([&](Index i) { return std::sqrt(d.inverse_abar(i)); }) * x_t -
             k([&](Index i) { return std::sqrt(d.inverse_abar(i) - 1); }) * value;
    case Prediction::score:
      return k([&](Index i) { return 1 / std::sqrt(d.abar(i)); }) * x_t +
             k([&](Index i) { return (1 - d.abar(i)) / std::sqrt(d.abar(i)); }) * value;
    case Prediction::x_prev:
      return k([&](Index i) { return 1 / d.c0(i); }) * value - k([&](Index i) { return d.ct(i) / d.c0(i); }) * x_t;
  }
  return value;
}
/// The noise that x_t contains if x0 is right: (sqrt(1/abar) x_t - x0) / sqrt(1/abar - 1).
template <Backend B, int R>
Tensor<B, R> eps_from_x0(const GaussianDiffusion& d, const Tensor<B, R>& x0, const Tensor<B, R>& x_t,
                         std::span<const Index> t) {
  return (coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.inverse_abar(i)); }) * x_t - x0) /
         coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.inverse_abar(i) - 1); });
}
/// The score that belongs to x0: sqrt(abar) / (1 - abar) x0 - x_t / (1 - abar).
template <Backend B, int R>
Tensor<B, R> score_from_x0(const GaussianDiffusion& d, const Tensor<B, R>& x0, const Tensor<B, R>& x_t,
                           std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.abar(i)) / (1 - d.abar(i)); }) * x0 -
         coefficients<B, R>(t, [&](Index i) { return 1 / (1 - d.abar(i)); }) * x_t;
}
/// Any prediction into any other (not into x_prev, which is a sample).
template <Backend B, int R>
Tensor<B, R> convert_prediction(const GaussianDiffusion& d, Prediction from, Prediction to, const Tensor<B, R>& value,
                                const Tensor<B, R>& x_t, std::span<const Index> t) {
  if (from == to) return value;
  if (from == Prediction::eps && to == Prediction::score) {
    return value * coefficients<B, R>(t, [&](Index i) { return -1 / std::sqrt(1 - d.abar(i)); });
  }
  if (from == Prediction::score && to == Prediction::eps) {
    return value * coefficients<B, R>(t, [&](Index i) { return -std::sqrt(1 - d.abar(i)); });
  }
  const auto x0 = to_x0(d, from, value, x_t, t);
  switch (to) {
    case Prediction::x0:
      return x0;
    case Prediction::eps:
      return eps_from_x0(d, x0, x_t, t);
    case Prediction::score:
      return score_from_x0(d, x0, x_t, t);
    case Prediction::x_prev:
      raise<config_error>(102, "convert_prediction: x_prev is a sample, not a statement about x0");
  }
  return x0;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DIFFUSION_GAUSSIAN_IPP  // <motionlang/diffusion/gaussian.ipp>
#define MOTIONLANG_HAS_DIFFUSION_GAUSSIAN_IPP
// Bodies of gaussian.hpp.

#ifndef MOTIONLANG_HAS_DIFFUSION_RESPACING_HPP  // <motionlang/diffusion/respacing.hpp>
#define MOTIONLANG_HAS_DIFFUSION_RESPACING_HPP
/// Which steps of a long process a short sampling run keeps.

MOTIONLANG_NAMESPACE_BEGIN

/// One section of nearly equal size per count; in each, `count` steps evenly from its first to its last, rounded half
/// to even; of 0, none. Source  improved diffusion (Nichol and Dhariwal 2021), `space_timesteps`. Throws config_error
/// 105.
std::vector<Index> respace(Index steps, std::span<const Index> counts);

/// "ddimN": the smallest stride that keeps N steps, starting at 0; or a list of counts "10,15,20" (one number is one
/// section). Empty: all steps. Throws config_error 105.
std::vector<Index> respace(Index steps, std::string_view specification);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DIFFUSION_RESPACING_IPP  // <motionlang/diffusion/respacing.ipp>
#define MOTIONLANG_HAS_DIFFUSION_RESPACING_IPP
// Bodies of respacing.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> respace(Index steps, std::span<const Index> counts) {
  std::vector<Index> kept;
  const auto sections = static_cast<Index>(counts.size());
  if (sections == 0) raise<config_error>(105, "respacing: no sections");
  Index begin = 0;
  for (Index i = 0; i < sections; ++i) {
    const Index size = steps / sections + (i < steps % sections ? 1 : 0), count = counts[static_cast<std::size_t>(i)];
    if (count < 0 || size < count)
      raise<config_error>(105, "respacing: cannot take ", count, " of ", size, " steps in section ", i);
    const double stride = count > 1 ? static_cast<double>(size - 1) / static_cast<double>(count - 1) : 1;
    double position = 0;
    for (Index k = 0; k < count; ++k, position += stride)
      kept.push_back(begin + static_cast<Index>(std::nearbyint(position)));
    begin += size;
  }
  if (kept.empty()) raise<config_error>(105, "respacing: no steps are kept of ", steps);
  return kept;
}

MOTIONLANG_BODY std::vector<Index> respace(Index steps, std::string_view specification) {
  auto number = [&](std::string_view digits) {
    while (digits.starts_with(' ')) digits.remove_prefix(1);  // as Python reads numbers
    while (digits.ends_with(' ')) digits.remove_suffix(1);
    Index n = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), n);
    if (error != std::errc{} || end != digits.data() + digits.size() || n < 0) {
      raise<config_error>(105, "respacing: '", specification, "' is neither ddimN nor a list of counts");
    }
    return n;
  };
  if (specification.empty()) return respace(steps, std::vector<Index>{steps});
  if (specification.starts_with("ddim")) {
    const Index wanted = number(specification.substr(4));
    for (Index stride = 1; stride < steps; ++stride) {
      if ((steps + stride - 1) / stride != wanted) continue;
      std::vector<Index> kept;
      for (Index t = 0; t < steps; t += stride) kept.push_back(t);
      return kept;
    }
    raise<config_error>(105, "respacing: no stride keeps ", wanted, " of ", steps, " steps");
  }
  std::vector<Index> counts;
  for (std::size_t at = 0; at <= specification.size();) {
    const std::size_t comma = std::min(specification.find(',', at), specification.size());
    counts.push_back(number(specification.substr(at, comma - at)));
    at = comma + 1;
  }
  return respace(steps, counts);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GaussianDiffusion GaussianDiffusion::respaced(std::span<const Index> kept) const {
  std::vector<double> betas;
  double last = 1;
  for (Index t : kept) {
    if (t < 0 || t >= steps()) raise<config_error>(105, "respacing: step ", t, " of ", steps());
    betas.push_back(1 - abar(t) / last);
    last = abar(t);
  }
  GaussianDiffusion d{BetaList{betas}};
  d.network_t_.clear();
  for (Index t : kept) d.network_t_.push_back(network_t(t));
  return d;
}

MOTIONLANG_BODY double GaussianDiffusion::inverse_abar(Index t) const {
  if (!(abar(t) > 0)) raise<config_error>(104, "GaussianDiffusion: step ", t, " keeps nothing of x0 (abar is 0)");
  return 1 / abar(t);
}

MOTIONLANG_BODY double GaussianDiffusion::posterior_log_variance(Index t) const {
  return steps() == 1 ? std::log(1e-20) : std::log(posterior_variance(t == 0 ? 1 : t));
}

MOTIONLANG_BODY double GaussianDiffusion::large_variance(Index t) const {
  return t == 0 ? posterior_variance(std::min<Index>(1, steps() - 1)) : beta(t);
}

MOTIONLANG_BODY double GaussianDiffusion::noise_factor(Index t, NoiseScale scale, Variance variance) const {
  if (t == 0) return 0;
  if (scale == NoiseScale::posterior_variance)
    return variance == Variance::fixed_small ? posterior_variance(t) : large_variance(t);
  return std::exp(0.5 * (variance == Variance::fixed_small ? posterior_log_variance(t) : std::log(large_variance(t))));
}

MOTIONLANG_BODY void GaussianDiffusion::build(std::vector<double> betas) {
  double product = 1;
  for (std::size_t t = 0; t < betas.size(); ++t) {
    if (!(betas[t] > 0 && betas[t] <= 1))
      raise<config_error>(104, "diffusion schedule: beta[", t, "] = ", betas[t], " is not in (0, 1]");
    product *= 1 - betas[t];
    abar_.push_back(product);
  }
  if (betas.empty()) raise<config_error>(104, "diffusion schedule: no steps");
  beta_ = std::move(betas);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct StepOptions {
  Prediction prediction = Prediction::x0;
  NoiseScale noise_scale = NoiseScale::posterior_std;
  Variance variance = Variance::fixed_small;
  bool clip = false;  // x0 to [-1, 1]
};

/// The process with this many of its steps, evenly kept; all of them for 0. Throws config_error 105.
GaussianDiffusion with_steps(const GaussianDiffusion& process, Index steps);

/// Standard normal numbers (sequences, frames, features), those of every sequence from its own stream: alone and in a
/// batch it sees the same noise. draw: 0 for the initial tensor, 1, 2, ... for the steps.
template <Backend B>
Tensor<B, 3> sequence_noise(const Philox& rng, Index draw, const Shape& shape) {
  using S = typename B::scalar;
  PoolVector<S> values(static_cast<std::size_t>(shape.count()));
  const auto size = static_cast<std::size_t>(shape[1] * shape[2]);
  for (Index m = 0; m < shape[0]; ++m) {
    auto stream = rng.split("noise").split(static_cast<std::uint64_t>(m)).split(static_cast<std::uint64_t>(draw));
    stream.normal(std::span<S>(values).subspan(static_cast<std::size_t>(m) * size, size));
  }
  return Tensor<B, 3>::from(std::span<const S>(values), shape);
}

/// How a whole reverse process is run.
struct SamplingOptions {
  enum class Sampler { ddpm, ddim };
  Sampler sampler = Sampler::ddpm;
  double eta = 0;  // of ddim
  /// As in STMC's released code. The noise of thesis eq. 6.2 is NoiseScale::posterior_std.
  NoiseScale noise_scale = NoiseScale::posterior_variance;
  bool clip = false;
};
std::string_view to_string(SamplingOptions::Sampler sampler);
/// "ddpm" or "ddim". Throws config_error 103.
SamplingOptions::Sampler parse_sampler(std::string_view name, std::string_view where = "sampler");

/// Names of the steps in the literature: x0 (clean estimate), mean of the posterior, x_{t-1}.
template <Backend B, int R>
struct AncestralStep {
  Tensor<B, R> x0, mean, x_prev;
};

namespace detail {

struct KeepX0 {
  template <class T>
  T operator()(T x0, Index) const {
    return x0;
  }
};

template <Backend B, int R>
Tensor<B, R> clipped(const Tensor<B, R>& x) {
  return -maximum(-maximum(x, Tensor<B, R>(-1.0)), Tensor<B, R>(-1.0));
}
template <Backend B, int R, class Fix>
Tensor<B, R> clean_estimate(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output,
                            std::span<const Index> t, const StepOptions& options, const Fix& fix) {
  auto x0 = to_x0(d, options.prediction, output, x, t);
  if (options.clip) x0 = clipped(x0);
  return fix(std::move(x0), t.front());
}

}  // namespace detail

/// One step of Ho et al. (2020), algorithm 2: x_{t-1} = mean + factor noise, a sample of thesis eq. 6.2.
/// t: one index per sample, or one for all. When the network predicts x_{t-1}, that is the mean.
/// Differs from thesis eq. 6.2 with NoiseScale::posterior_variance: the factor is the variance, as STMC's code has it.
template <Backend B, int R, class Fix = detail::KeepX0>
AncestralStep<B, R> ancestral_step(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output,
                                   const Tensor<B, R>& noise, std::span<const Index> t, const StepOptions& options = {},
                                   const Fix& fix = {}) {
  auto x0 = detail::clean_estimate(d, x, output, t, options, fix);
  auto mean = options.prediction == Prediction::x_prev ? output : posterior_mean(d, x0, x, t);
  // thesis eq. 6.2
  auto x_prev = mean + coefficients<B, R>(t, [&](Index i) {
                         return d.noise_factor(i, options.noise_scale, options.variance);
                       }) * noise;
  return {std::move(x0), std::move(mean), std::move(x_prev)};
}

/// Called after every step with the index just made and the tensors of that step. Does nothing by default.
struct IgnoreSteps {
  void operator()(Index, const auto&) const {}
};

/// All steps from index `first` (the last of the process when -1) down to 0. Returns the x0 of the last step, which is
/// also the last x (c0 is 1 and the noise factor 0 at t = 0); of a network that predicts x_{t-1}, what it says last.
/// Throws `cancelled` if progress says so.
template <Backend B, int R, class Network, class Noise, class Fix = detail::KeepX0, class Watch = IgnoreSteps>
Tensor<B, R> sample_ancestral(const GaussianDiffusion& d, Tensor<B, R> x, Network&& network, Noise&& noise,
                              const StepOptions& options = {}, const Fix& fix = {}, Progress progress = {},
                              Index first = -1, const Watch& watch = {}) {
  if (first < 0) first = d.steps() - 1;
  for (Index t = first; t >= 0; --t) {
    const auto step = ancestral_step(d, x, network(x, t), noise(first - t), std::span(&t, 1), options, fix);
    watch(t, step);
    x = t > 0 || options.prediction == Prediction::x_prev ? step.x_prev : step.x0;
    progress(first - t + 1, first + 1);
  }
  return x;
}

/// One step of DDIM (Song et al. 2021, eq. 12): eta = 0 is deterministic, eta = 1 is ancestral sampling.
///     sigma = eta sqrt((1 - abarp) / (1 - abar)) sqrt(1 - abar / abarp)
///     x_{t-1} = sqrt(abarp) x0 + sqrt(1 - abarp - sigma^2) eps + [t > 0] sigma noise
/// Throws config_error 101 unless 0 <= eta <= 1.
template <Backend B, int R, class Fix = detail::KeepX0>
AncestralStep<B, R> ddim_step(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output,
                              const Tensor<B, R>* noise, Index t, double eta, const StepOptions& options = {},
                              const Fix& fix = {}) {
  if (!(eta >= 0 && eta <= 1)) raise<config_error>(101, "ddim_step: eta = ", eta, " is not in [0, 1]");
  const std::span<const Index> at(&t, 1);
  auto x0 = detail::clean_estimate(d, x, output, at, options, fix);
  const auto eps = eps_from_x0(d, x0, x, at);
  const double sigma = eta * std::sqrt((1 - d.abarp(t)) / (1 - d.abar(t))) * std::sqrt(1 - d.abar(t) / d.abarp(t));
  auto mean = x0 * std::sqrt(d.abarp(t)) + eps * std::sqrt(1 - d.abarp(t) - sigma * sigma);
  auto x_prev = noise != nullptr && t > 0 && sigma > 0 ? mean + *noise * sigma : mean;
  return {std::move(x0), std::move(mean), std::move(x_prev)};
}

/// A whole DDIM run, from index `first` (the last of the process when -1) on. It saves time only on a respaced process.
/// `noise` is asked for only if eta > 0, but then at every step.
template <Backend B, int R, class Network, class Noise, class Fix = detail::KeepX0, class Watch = IgnoreSteps>
Tensor<B, R> sample_ddim(const GaussianDiffusion& d, Tensor<B, R> x, Network&& network, Noise&& noise, double eta,
                         const StepOptions& options = {}, const Fix& fix = {}, Progress progress = {},
                         const Watch& watch = {}, Index first = -1) {
  if (first < 0) first = d.steps() - 1;
  for (Index t = first; t >= 0; --t) {
    const auto output = network(x, t);
    const auto step = [&] {
      if (eta == 0) return ddim_step<B, R>(d, x, output, nullptr, t, eta, options, fix);
      const Tensor<B, R> z = noise(first - t);
      return ddim_step(d, x, output, &z, t, eta, options, fix);
    }();
    watch(t, step);
    x = step.x_prev;
    progress(first - t + 1, first + 1);
  }
  return x;
}

/// From a sample towards its noise: one step from index t to t + 1 (DDIM, eta = 0, backwards).
///     x_{t+1} = sqrt(abarn) x0 + sqrt(1 - abarn) eps
template <Backend B, int R>
Tensor<B, R> ddim_inversion_step(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output, Index t,
                                 const StepOptions& options = {}) {
  const std::span<const Index> at(&t, 1);
  const auto x0 = detail::clean_estimate(d, x, output, at, options, detail::KeepX0{});
  return x0 * std::sqrt(d.abarn(t)) + eps_from_x0(d, x0, x, at) * std::sqrt(1 - d.abarn(t));
}

/// Pseudo linear multistep (Liu et al. 2022) of order 2 ... 4: DDIM steps with an extrapolated eps. The first step
/// averages the eps at (x, t) and at the Euler prediction; later ones use as many old values as there are. Returns the
/// x0 of the last step. Throws config_error 101 for another order.
template <Backend B, int R, class Network, class Watch = IgnoreSteps>
Tensor<B, R> sample_plms(const GaussianDiffusion& d, Tensor<B, R> x, Network&& network, int order,
                         const StepOptions& options = {}, Progress progress = {}, const Watch& watch = {}) {
  if (order < 2 || order > 4) raise<config_error>(101, "sample_plms: order ", order, " is not 2, 3 or 4");
  using T = Tensor<B, R>;
  auto predict = [&](const T& at_x, Index t) {
    const std::span<const Index> at(&t, 1);
    return eps_from_x0(d, detail::clean_estimate(d, at_x, network(at_x, t), at, options, detail::KeepX0{}), at_x, at);
  };
  auto advance = [&](const T& from, const T& eps, Index t) {
    auto x0 = to_x0(d, Prediction::eps, eps, from, std::span<const Index>(&t, 1));
    auto next = x0 * std::sqrt(d.abarp(t)) + eps * std::sqrt(1 - d.abarp(t));
    return AncestralStep<B, R>{std::move(x0), next, next};
  };
  std::vector<T> old;  // newest first
  for (Index t = d.steps() - 1; t >= 0; --t) {
    const T e = predict(x, t);
    T used = e;
    switch (t == 0 ? 0 : std::min<std::size_t>(old.size() + 1, static_cast<std::size_t>(order))) {
      case 0:  // the last step takes x0 of the network itself
        break;
      case 1:
        used = (e + predict(advance(x, e, t).x_prev, t - 1)) * 0.5;
        break;
      case 2:
        used = (e * 3.0 - old[0]) * (1.0 / 2);
        break;
      case 3:
        used = (e * 23.0 - old[0] * 16.0 + old[1] * 5.0) * (1.0 / 12);
        break;
      default:
        used = (e * 55.0 - old[0] * 59.0 + old[1] * 37.0 - old[2] * 9.0) * (1.0 / 24);
        break;
    }
    const auto step = advance(x, used, t);
    watch(t, step);
    x = t > 0 ? step.x_prev : step.x0;
    old.insert(old.begin(), e);
    if (old.size() >= static_cast<std::size_t>(order)) old.pop_back();
    progress(d.steps() - t, d.steps());
  }
  return x;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DIFFUSION_SAMPLER_IPP  // <motionlang/diffusion/sampler.ipp>
#define MOTIONLANG_HAS_DIFFUSION_SAMPLER_IPP
// Bodies of sampler.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GaussianDiffusion with_steps(const GaussianDiffusion& process, Index steps) {
  if (steps == 0 || steps == process.steps()) return process;
  return process.respaced(respace(process.steps(), std::vector<Index>{steps}));
}

MOTIONLANG_BODY std::string_view to_string(SamplingOptions::Sampler sampler) {
  return sampler == SamplingOptions::Sampler::ddim ? "ddim" : "ddpm";
}

MOTIONLANG_BODY SamplingOptions::Sampler parse_sampler(std::string_view name, std::string_view where) {
  if (name == "ddpm") return SamplingOptions::Sampler::ddpm;
  if (name == "ddim") return SamplingOptions::Sampler::ddim;
  raise<config_error>(103, where, " '", name, "' is neither ddpm nor ddim");
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_HPP  // <motionlang/kinematics/motion.hpp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_HPP
/// A clip of motion: a skeleton, a frame rate, and for each frame the root position and all local rotations.
///
/// Inside the library every clip is Y up, right-handed, in metres, and a rest pose faces +Z. Readers and writers
/// convert at the edge (BVH files in centimetres, AMASS with Z up, ...). Double precision: files and features are exact
/// to the last printed digit.

#ifndef MOTIONLANG_HAS_KINEMATICS_FORWARD_HPP  // <motionlang/kinematics/forward.hpp>
#define MOTIONLANG_HAS_KINEMATICS_FORWARD_HPP
/// Forward kinematics: from local rotations to joint positions. One function for a single pose (S = float, double), for
/// derivatives (Dual), for poses side by side in a register (Lane) and for a differentiable batch (Tensor; see
/// forward_batch.hpp).
///
///     R_j = R_parent(j) L_j,   p_j = p_parent(j) + R_parent(j) offset_j,   R_0 = L_0, p_0 = root

#ifndef MOTIONLANG_HAS_GEOMETRY_AXIS_ANGLE_HPP  // <motionlang/geometry/axis_angle.hpp>
#define MOTIONLANG_HAS_GEOMETRY_AXIS_ANGLE_HPP
/// Rotation vectors: the axis times the angle in radians. Exponential and logarithm of SO(3) in quaternion form.

#ifndef MOTIONLANG_HAS_GEOMETRY_QUATERNION_HPP  // <motionlang/geometry/quaternion.hpp>
#define MOTIONLANG_HAS_GEOMETRY_QUATERNION_HPP
/// Unit quaternions (w, x, y, z), Hamilton product.

#ifndef MOTIONLANG_HAS_GEOMETRY_MATRIX_HPP  // <motionlang/geometry/matrix.hpp>
#define MOTIONLANG_HAS_GEOMETRY_MATRIX_HPP
/// Rotation matrices, and the concept of a rotation.
///
/// Conventions of the whole library: right-handed, active rotations, column vectors (v' = R v).

MOTIONLANG_NAMESPACE_BEGIN

/// Three by three numbers, row by row: m[3 * row + column].
template <class S>
struct Matrix3 {
  std::array<S, 9> m{};

  static Matrix3 identity() { return {{S(1), S(0), S(0), S(0), S(1), S(0), S(0), S(0), S(1)}}; }
  static Matrix3 from_rows(const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& c) {
    return {{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}};
  }
  static Matrix3 from_columns(const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& c) {
    return {{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
  }

  const S& operator()(int row, int column) const { return m[static_cast<std::size_t>(3 * row + column)]; }
  S& operator()(int row, int column) { return m[static_cast<std::size_t>(3 * row + column)]; }
  Vec3<S> row(int i) const { return {(*this)(i, 0), (*this)(i, 1), (*this)(i, 2)}; }
  Vec3<S> column(int j) const { return {(*this)(0, j), (*this)(1, j), (*this)(2, j)}; }

  friend Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
    Matrix3 c;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) c(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
    }
    return c;
  }
  friend Vec3<S> operator*(const Matrix3& a, const Vec3<S>& v) {
    return {dot(a.row(0), v), dot(a.row(1), v), dot(a.row(2), v)};
  }
};

template <class S>
Matrix3<S> transpose(const Matrix3<S>& a) {
  return Matrix3<S>::from_columns(a.row(0), a.row(1), a.row(2));
}
template <class S>
Matrix3<S> inverse(const Matrix3<S>& rotation) {
  return transpose(rotation);
}
template <class S>
const Matrix3<S>& to_matrix(const Matrix3<S>& a) {
  return a;
}
template <class S, class T>
Matrix3<S> matrix_cast(const Matrix3<T>& a) {
  Matrix3<S> b;
  for (std::size_t i = 0; i < 9; ++i) b.m[i] = S(a.m[i]);
  return b;
}

/// One parameterisation of rotations in three dimensions.
/// Minimum   to_matrix(r)
/// Deduced   to_quaternion, to_axis_angle, compose, inverse, distance, slerp (so3.hpp, slerp.hpp)
/// Laws      to_matrix(r) is orthonormal with determinant 1; converting there and back gives the same matrix
/// Models    Matrix3, Quaternion, AxisAngle, EulerAngles, Rotation6dRows, Rotation6dColumns
template <class R>
concept Rotation = requires(const R& r) {
  to_matrix(r).m;
};

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

template <class S>
struct Quaternion {
  S w{}, x{}, y{}, z{};

  static Quaternion identity() { return {S(1), S(0), S(0), S(0)}; }
  Vec3<S> vec() const { return {x, y, z}; }

  friend Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
  friend Quaternion operator*(const S& s, const Quaternion& q) { return {s * q.w, s * q.x, s * q.y, s * q.z}; }
  friend Quaternion operator+(const Quaternion& a, const Quaternion& b) {
    return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend Quaternion operator-(const Quaternion& q) { return {-q.w, -q.x, -q.y, -q.z}; }
  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};
template <class S>
Quaternion(S, S, S, S) -> Quaternion<S>;

template <class S>
S dot(const Quaternion<S>& a, const Quaternion<S>& b) {
  return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}
/// The inverse of a unit quaternion.
template <class S>
Quaternion<S> inverse(const Quaternion<S>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
template <class S>
Quaternion<S> normalized(const Quaternion<S>& q) {
  return (S(1) / sqrt(dot(q, q))) * q;
}
/// q v q^-1 = v + 2 (w (u x v) + u x (u x v)), u = (x, y, z). For unit q.
template <class S>
Vec3<S> rotate(const Quaternion<S>& q, const Vec3<S>& v) {
  const Vec3<S> uv = cross(q.vec(), v);
  return v + S(2) * (q.w * uv + cross(q.vec(), uv));
}

/// Matrix of a quaternion; one that is not of unit length is tolerated: factor 2 / (q . q).
template <class S>
Matrix3<S> to_matrix(const Quaternion<S>& q) {
  const S k = S(2) / dot(q, q);
  const S xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const S xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{S(1) - k * (yy + zz), k * (xy - wz), k * (xz + wy),  //
           k * (xy + wz), S(1) - k * (xx + zz), k * (yz - wx),  //
           k * (xz - wy), k * (yz + wx), S(1) - k * (xx + yy)}};
}

/// The quaternion with w >= 0 of a rotation matrix; accurate everywhere, also near half turns.
/// Source  Shepperd (1978): divide by the largest of |w|, |x|, |y|, |z|. All four candidates are computed and one is
///         chosen by where_less, so that SIMD lanes and tensors can do it, too.
template <class S>
Quaternion<S> to_quaternion(const Matrix3<S>& r) {
  const S m00 = r(0, 0), m11 = r(1, 1), m22 = r(2, 2), zero = S(0), tiny = S(1e-12);
  const S sw = S(1) + m00 + m11 + m22, sx = S(1) + m00 - m11 - m22, sy = S(1) - m00 + m11 - m22,
          sz = S(1) - m00 - m11 + m22;
  auto half_root = [&](const S& s) { return S(0.5) * sqrt(where_less(s, tiny, tiny, s)); };
  const S w = half_root(sw), x = half_root(sx), y = half_root(sy), z = half_root(sz);
  const S a = r(2, 1) - r(1, 2), b = r(0, 2) - r(2, 0), c = r(1, 0) - r(0, 1);
  const S d = r(1, 0) + r(0, 1), e = r(0, 2) + r(2, 0), f = r(2, 1) + r(1, 2);
  auto select = [](const S& p, const S& q, const Quaternion<S>& less, const Quaternion<S>& other) {
    return Quaternion<S>{where_less(p, q, less.w, other.w), where_less(p, q, less.x, other.x),
                         where_less(p, q, less.y, other.y), where_less(p, q, less.z, other.z)};
  };
  const S iw = S(0.25) / w, ix = S(0.25) / x, iy = S(0.25) / y, iz = S(0.25) / z;
  const Quaternion<S> by_w{w, a * iw, b * iw, c * iw}, by_x{a * ix, x, d * ix, e * ix};
  const Quaternion<S> by_y{b * iy, d * iy, y, f * iy}, by_z{c * iz, e * iz, f * iz, z};
  const Quaternion<S> wx = select(sw, sx, by_x, by_w), yz = select(sy, sz, by_z, by_y);
  const Quaternion<S> q = select(where_less(sw, sx, sx, sw), where_less(sy, sz, sz, sy), yz, wx);
  return select(q.w, zero, -q, q);
}
template <class S>
const Quaternion<S>& to_quaternion(const Quaternion<S>& q) {
  return q;
}
template <Rotation R>
auto to_quaternion(const R& r) {
  return to_quaternion(to_matrix(r));
}
static_assert(Rotation<Quaternion<double>> && Rotation<Matrix3<float>>);

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

template <class S>
struct AxisAngle {
  Vec3<S> v{};
};
template <class S>
AxisAngle(Vec3<S>) -> AxisAngle<S>;

/// q = (cos(t/2), sin(t/2)/t v), t = |v|. Below t = 1e-3 the factor is 1/2 - t^2/48 + t^4/3840: smooth at 0.
template <class S>
Quaternion<S> to_quaternion(const AxisAngle<S>& r) {
  const S t2 = dot(r.v, r.v), small = S(1e-6);
  const S t = sqrt(where_less(t2, small, small, t2));  // never 0, so that the branch not taken stays finite
  const S series = S(0.5) - t2 * (S(1.0 / 48) - t2 * S(1.0 / 3840));
  const S factor = where_less(t2, small, series, sin(S(0.5) * t) / t);
  const S w = where_less(t2, small, S(1) - t2 * (S(0.125) - t2 * S(1.0 / 384)), cos(S(0.5) * t));
  return {w, factor * r.v.x, factor * r.v.y, factor * r.v.z};
}
template <class S>
Matrix3<S> to_matrix(const AxisAngle<S>& r) {
  return to_matrix(to_quaternion(r));
}
/// Rotation by `angle` radians about a unit axis.
template <class S>
Quaternion<S> from_axis_angle(const Vec3<S>& axis, const S& angle) {
  return to_quaternion(AxisAngle<S>{angle * axis});
}

/// The shortest rotation vector (length at most pi). Right up to and at pi; smooth at 0.
///     v = 2 atan2(n, |w|) / n (x, y, z) sign(w),   n = |(x, y, z)|
///     for small n the factor is 2/w (1 - n^2 / (3 w^2))
template <class S>
AxisAngle<S> to_axis_angle(const Quaternion<S>& q) {
  const S n2 = dot(q.vec(), q.vec()), small = S(1e-8), zero = S(0);
  const S n = sqrt(where_less(n2, small, small, n2));
  const S w = where_less(q.w, zero, -q.w, q.w), sign = where_less(q.w, zero, S(-1), S(1));
  const S safe_w = where_less(n2, small, w, S(1));
  const S series = S(2) / safe_w * (S(1) - n2 / (S(3) * safe_w * safe_w));
  const S factor = sign * where_less(n2, small, series, S(2) * atan2(n, w) / n);
  return {factor * q.vec()};
}
template <class S>
const AxisAngle<S>& to_axis_angle(const AxisAngle<S>& r) {
  return r;
}
template <Rotation R>
auto to_axis_angle(const R& r) {
  return to_axis_angle(to_quaternion(r));
}
static_assert(Rotation<AxisAngle<double>>);

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Local rotations of all joints and the position of the root.
template <ScalarLike S>
struct Pose {
  Vec3<S> root{};
  std::vector<Quaternion<S>> local;

  /// All rotations the identity, the root where the skeleton puts it.
  static Pose rest(const Skeleton& skeleton) {
    return {vec_cast<S>(skeleton.offset(0)),
            std::vector<Quaternion<S>>(static_cast<std::size_t>(skeleton.size()), Quaternion<S>::identity())};
  }
};

/// Positions and rotations of all joints in the world.
template <ScalarLike S>
struct JointTransforms {
  std::vector<Vec3<S>> position;
  std::vector<Matrix3<S>> rotation;
};

namespace detail {

/// Position of joint j, whose parent is done, and its rotation unless nothing hangs on it.
template <Rotation R, ScalarLike S>
void place_joint(const Skeleton& skeleton, std::size_t j, const R& local, const Vec3<S>& root, bool rotate,
                 JointTransforms<S>& world) {
  if (j == 0) {
    world.position[0] = root;
    world.rotation[0] = to_matrix(local);
    return;
  }
  const auto p = static_cast<std::size_t>(skeleton.parents[j]);
  world.position[j] = world.position[p] + world.rotation[p] * vec_cast<S>(skeleton.offsets[j]);
  if (rotate) world.rotation[j] = world.rotation[p] * to_matrix(local);
}

}  // namespace detail

/// local     one rotation per joint, in any representation
/// result    resized to the number of joints; pass the same object again to avoid allocations
/// Throws    shape_error 204 if the number of rotations is not the number of joints
template <Rotation R, ScalarLike S>
void forward_kinematics(const Skeleton& skeleton, std::span<const R> local, const Vec3<S>& root,
                        JointTransforms<S>& result) {
  const auto joints = static_cast<std::size_t>(skeleton.size());
  if (local.size() != joints) {
    raise<shape_error>(204, "forward_kinematics: ", local.size(), " rotations for ", joints, " joints");
  }
  result.position.resize(joints);
  result.rotation.resize(joints);
  for (std::size_t j = 0; j < joints; ++j) detail::place_joint(skeleton, j, local[j], root, true, result);
}

template <Rotation R, ScalarLike S>
JointTransforms<S> forward_kinematics(const Skeleton& skeleton, std::span<const R> local, const Vec3<S>& root) {
  JointTransforms<S> result;
  forward_kinematics(skeleton, local, root, result);
  return result;
}

template <ScalarLike S>
JointTransforms<S> forward_kinematics(const Skeleton& skeleton, const Pose<S>& pose) {
  return forward_kinematics(skeleton, std::span<const Quaternion<S>>(pose.local), pose.root);
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Rotations (frames x joints) of a clip that is made by sampling another; 1.6 GB. More are a frame rate typed wrong.
inline constexpr double max_rotations = 5e7;

struct Motion {
  Skeleton skeleton;
  double fps = 20;
  std::vector<Vec3<double>> root;         // (frames)
  std::vector<Quaternion<double>> local;  // (frames, joints), joint fastest
  std::string name{};                     // of the clip, for messages and files

  Index frames() const { return static_cast<Index>(root.size()); }
  double seconds() const { return static_cast<double>(frames()) / fps; }

  std::span<const Quaternion<double>> rotations(Index frame) const {
    const auto joints = static_cast<std::size_t>(skeleton.size());
    return std::span(local).subspan(static_cast<std::size_t>(frame) * joints, joints);
  }
  std::span<Quaternion<double>> rotations(Index frame) {
    const auto joints = static_cast<std::size_t>(skeleton.size());
    return std::span(local).subspan(static_cast<std::size_t>(frame) * joints, joints);
  }
  const Vec3<double>& root_at(Index frame) const { return root[static_cast<std::size_t>(frame)]; }

  /// Joint positions and rotations of one frame in the world.
  void world(Index frame, JointTransforms<double>& result) const;
  /// Joint positions of all frames, (frames, joints).
  std::vector<Vec3<double>> positions() const;
  /// Throws shape_error 205 if the arrays do not fit, config_error 101 unless the frame rate is positive, or if times
  /// overflow at it, numeric_error 301 on a value that is not finite and on a rotation of length 0.
  void validate() const;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_IPP  // <motionlang/kinematics/motion.ipp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_IPP
// Bodies of motion.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void Motion::world(Index frame, JointTransforms<double>& result) const {
  forward_kinematics(skeleton, rotations(frame), root_at(frame), result);
}

MOTIONLANG_BODY std::vector<Vec3<double>> Motion::positions() const {
  std::vector<Vec3<double>> out;
  out.reserve(local.size());
  JointTransforms<double> t;
  for (Index f = 0; f < frames(); ++f) {
    world(f, t);
    out.insert(out.end(), t.position.begin(), t.position.end());
  }
  return out;
}

MOTIONLANG_BODY void Motion::validate() const {
  skeleton.validate();
  if (local.size() != root.size() * static_cast<std::size_t>(skeleton.size())) {
    raise<shape_error>(205, "Motion '", name, "': ", local.size(), " rotations for ", frames(), " frames of ",
                       skeleton.size(), " joints");
  }
  for (int j = 0; j < skeleton.size(); ++j) {
    const auto o =
        skeleton.ends.empty() ? skeleton.offset(j) : skeleton.offset(j) + skeleton.ends[static_cast<std::size_t>(j)];
    if (!std::isfinite(o.x + o.y + o.z))
      raise<numeric_error>(301, "Motion '", name, "': the offset of joint '", skeleton.name(j), "' is not finite");
  }
  const double seconds_and_one_frame = static_cast<double>(frames() + 1) / fps;
  if (!(fps > 0 && std::isfinite(fps) && std::isfinite(seconds_and_one_frame)))
    raise<config_error>(101, "Motion '", name, "': frame rate ", fps);
  for (std::size_t f = 0; f < root.size(); ++f) {
    const auto& r = root[f];
    if (!std::isfinite(r.x + r.y + r.z))
      raise<numeric_error>(301, "Motion '", name, "': root position of frame ", f, " is not finite");
  }
  for (std::size_t i = 0; i < local.size(); ++i) {
    const auto& q = local[i];
    const bool finite = std::isfinite(q.w + q.x + q.y + q.z);
    if (!finite || dot(q, q) < 1e-12) {
      const std::size_t joints = skeleton.parents.size();
      raise<numeric_error>(301, "Motion '", name, "': rotation of joint '", skeleton.names[i % joints], "' in frame ",
                           i / joints, finite ? " has length 0" : " is not finite");
    }
  }
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_SYSTEMS_STMC_REUSE_HPP  // <motionlang/systems/stmc_reuse.hpp>
#define MOTIONLANG_HAS_SYSTEMS_STMC_REUSE_HPP
/// How much a run of STMC reused of the run before (systems/stmc_edit.hpp).

MOTIONLANG_NAMESPACE_BEGIN

/// How much a run reused.
struct StmcReuse {
  Index frames = 0, kept = 0;      // of the result; those that have the numbers of before
  Index work = 0, whole_work = 0;  // rows through the network in all steps; in a run that takes nothing over
  Index steps = 0;                 // of the run
  Index everywhere = 0;  // the step (from 1) after which no frame of an edited timeline is that of before; 0: none is
  bool exact = true;     // the result is that of a run that takes nothing over, bit for bit
};

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// A motion of which something is kept: the model makes the rest. Frame 0 is that of the timeline.
struct KeptClip {
  Motion motion{};                                   // on any skeleton that can be put on SMPL's joints, at any rate
  std::vector<std::pair<double, double>> seconds{};  // from and to, of what is kept; none: all of it
  BodyParts parts = BodyParts::all();                // that are kept; the way over the ground belongs to the legs
};

/// The report of a run besides its motions. Only models that go through STMC fill it.
struct GenerateNotes {
  std::string layout{};                         // of the features
  std::vector<std::vector<double>> features{};  // of each motion, before smoothing and foot fixing
  std::optional<StmcReuse> reuse{};             // how much was reused
  std::optional<std::uint64_t> seed{};          // of the run that is reused
  double kept_moved = 0;  // the largest distance of a kept frame from its old place, metres on the floor
};

struct GenerateOptions {
  std::uint64_t seed = 0;                             // same seed, same motion, on any number of threads
  std::optional<Index> steps{};                       // of denoising, 0: all; the default is the model's
  std::optional<SamplingOptions::Sampler> sampler{};  // the default is the model's
  std::optional<double> guidance{};                   // weight of the text, 1: none; the default is the model's
  std::optional<double> fact{};  // scales the latent noise: 0 gives the mean motion; the default is 1
  double overlap = 0.5;          // seconds that neighbouring texts share around a cut
  bool cut_texts = true;         // where they lend body parts or regain them, and where they are too long
  bool smooth = true;            // removes jitter, and jerks where texts meet
  bool fix_feet = true;          // keeps standing feet from sliding
  bool fix_floor = true;         // the floor carries the body: no hovering, no sinking, flights are arcs
  bool overlay_arms = false;     // an arm that loses its text moves as the text alone moves it; a second pass
  FilePath noise = "";           // file with noise/000 (initial), noise/001, ... instead of the seed
  FilePath record = "";          // file to write, which a later run can reuse
  FilePath reuse = "";  // such a file; seed, steps, sampler, guidance, overlap and cut_texts are those of its run
  std::optional<double> keep_beyond{};  // of reuse: frames further from the edit, in seconds, stay
  std::optional<KeptClip> keep{};       // of every timeline
  Progress progress{};                  // called after every step, or after every motion; may cancel
  GenerateNotes* notes = nullptr;       // filled if given
};

/// Few steps that do as many prompts as all steps. `motionlang judge --compare` measures that.
inline constexpr Index fast_steps = 10;
inline void use_fast_preset(GenerateOptions& o) { o.sampler = SamplingOptions::Sampler::ddim, o.steps = fast_steps; }
inline void use_full_preset(GenerateOptions& o) { o.sampler = SamplingOptions::Sampler::ddpm, o.steps = 0; }

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_SYSTEMS_STMC_HPP  // <motionlang/systems/stmc.hpp>
#define MOTIONLANG_HAS_SYSTEMS_STMC_HPP
/// STMC: spatio-temporal motion collage. A timeline of texts on several tracks in, one motion out.
///
/// Source  Petrovich, Litany, Iqbal, Black, Varol, Peng, Rempe: "Multi-track timeline control for text-driven 3D human
///         motion generation" (2024). Works at test time with any denoiser of explicit poses; no training
/// Bodies  motionlang::instantiated has those of Stmc<EigenBackend<float>>. A unit that is compiled with
///         MOTIONLANG_INSTANTIATED and uses another Stmc also includes <motionlang/systems/stmc.ipp>; the compiler says
///         so

#ifndef MOTIONLANG_HAS_COMPOSE_PLAN_OPTIONS_HPP  // <motionlang/compose/plan_options.hpp>
#define MOTIONLANG_HAS_COMPOSE_PLAN_OPTIONS_HPP
/// Options for planning timelines.

MOTIONLANG_NAMESPACE_BEGIN

/// The rule for frames without a text: let the model move freely, or throw timeline_error 505.
enum class Gaps { fill, refuse };
/// The rule for a cut at which no part changes its owner, because other texts hide a text: throw timeline_error
/// 506, or leave the transition out (the result is the same without it).
enum class HiddenTexts { refuse, ignore };

/// The default number of frames that go through the denoiser together. It is more than 12 s on five tracks have, with
/// and without their texts. The published network holds about 90 MB for them.
inline constexpr Index usual_rows_at_once = 4096;

struct PlanOptions {
  Index overlap = 10;            // frames in total around a cut; 0.5 s at 20 fps
  bool extend = true;            // intervals reach into their neighbours by the overlap
  bool transition_crops = true;  // an unconditional crop around every cut. Both off: SINC, hard cuts
  Gaps gaps = Gaps::fill;
  HiddenTexts hidden = HiddenTexts::refuse;
  Index longest_crop = 0;  // frames that the denoiser accepts; 0: any
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_MDM_SMPL_HPP  // <motionlang/diffusion/mdm_smpl.hpp>
#define MOTIONLANG_HAS_DIFFUSION_MDM_SMPL_HPP
/// MDM-SMPL: the denoiser of the STMC paper.

#ifndef MOTIONLANG_HAS_DIFFUSION_DENOISER_HPP  // <motionlang/diffusion/denoiser.hpp>
#define MOTIONLANG_HAS_DIFFUSION_DENOISER_HPP
/// The concept of a denoising network, for samplers and for STMC.

#ifndef MOTIONLANG_HAS_CORE_CONTEXT_HPP  // <motionlang/core/context.hpp>
#define MOTIONLANG_HAS_CORE_CONTEXT_HPP
/// Settings of a model call besides its inputs. By default they are empty, and no dropout runs.

MOTIONLANG_NAMESPACE_BEGIN

/// Dropout runs only if the context carries a generator: there is no train or eval flag to forget.
///
///     model(x, t, text, {.dropout = rng.split("dropout").split(step)});
struct Context {
  std::optional<Philox> dropout{};
  mutable std::uint64_t drawn = 0;  // masks handed out so far; every mask has its own stream
  bool recompute = false;  // training keeps what enters a layer and calculates its inside again: less memory, more time

  /// The generator of the next dropout mask. Only when `dropout` is set.
  Philox next_mask() const { return dropout->split(drawn++); }
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_CORE_FIELDS_HPP  // <motionlang/core/fields.hpp>
#define MOTIONLANG_HAS_CORE_FIELDS_HPP
/// Member lists: what a module is made of, and how to walk over it.
///
///     struct Model {
///       Tensor<B, 2> weight;
///       Tensor<B, 1> bias;
///       static constexpr auto fields() { return motionlang::fields("weight", &Model::weight, "bias", &Model::bias); }
///     };
///     Model model;
///     visit(model, [](const std::string& path, auto& tensor) { use(path, tensor); });   // "layers.0.linear1.weight"
///
/// A member may be a leaf (a tensor), a module, or a vector or optional of either. Vector elements are numbered. A name
/// may contain dots ("tx_embedding.0") where the official key has a level that is not a module here, and be empty where
/// the fields of a member have no level of their own (the statistics of a BatchNorm). Two members of one name are a
/// compile error, unless both are optional. A member with nothing to save is an option: a number, an enumeration, a
/// text, or a type that says so (is_option, tensor/module.hpp).

MOTIONLANG_NAMESPACE_BEGIN

template <class M, class T>
struct Field {
  const char* name;
  T M::*member;
};

/// The fields of a module, first and rest; `NoFields` ends the list. (A std::tuple compiles several times slower.)
struct NoFields {};
template <class First, class Rest>
struct FieldList {
  First first;
  Rest rest;
};

/// Pairs (name, pointer to member) to a list of `Field`.
constexpr NoFields fields() { return {}; }
template <class M, class T, class... Others>
constexpr auto fields(const char* name, T M::*member, Others... others) {
  return FieldList<Field<M, T>, decltype(fields(others...))>{{name, member}, fields(others...)};
}

namespace detail {

template <class T>
inline constexpr bool is_vector = false;
template <class T>
inline constexpr bool is_vector<std::vector<T>> = true;
template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

/// True if a list has a member of this name. One of two optional members may be there, under the same name.
template <bool optional, class M, class T, class Rest>
constexpr bool has_name(const FieldList<Field<M, T>, Rest>& list, std::string_view name);
template <bool optional>
constexpr bool has_name(const NoFields&, std::string_view) {
  return false;
}
template <bool optional, class M, class T, class Rest>
constexpr bool has_name(const FieldList<Field<M, T>, Rest>& list, std::string_view name) {
  return (list.first.name == name && !(optional && is_optional<T>)) || has_name<optional>(list.rest, name);
}
/// The first name that is there twice, "" if there is none. (Several members may have no level of their own.)
constexpr std::string_view repeated_name(const NoFields&) { return {}; }
template <class M, class T, class Rest>
constexpr std::string_view repeated_name(const FieldList<Field<M, T>, Rest>& list) {
  const std::string_view name = list.first.name;
  return !name.empty() && has_name<is_optional<T>>(list.rest, name) ? name : repeated_name(list.rest);
}
/// True if the compiler can look at the names of a module.
template <class M>
concept ConstantFields = requires {
  typename std::bool_constant<(static_cast<void>(M::fields()), true)>;
};
/// Two members of one name would share what is kept by name: a place in a file, the moments of an optimiser. A compile
/// error where fields() is constexpr, else config_error 102.
template <Module M>
void check_names() {
  if constexpr (ConstantFields<M>) {
    static_assert(repeated_name(M::fields()).empty(),
                  "motionlang: fields() of a module lists two members by the same name");
  } else if (const std::string_view name = repeated_name(M::fields()); !name.empty()) {
    raise<config_error>(102, "fields() of a module lists two members by the name '", name, "'");
  }
}

inline std::string join_path(const std::string& prefix, std::string_view name) {
  std::string path = prefix;
  if (!path.empty() && !name.empty()) path += '.';
  return path += name;
}

template <class F, class... Objects>
void visit_fields(const std::string& prefix, F& f, Objects&... objects);

/// Walks over one member, or over the same member of several objects of the same structure.
template <class F, class First, class... Others>
void visit_member(const std::string& path, F& f, First& first, Others&... others) {
  using T = std::remove_const_t<First>;
  if constexpr (Module<T>) {
    visit_fields(path, f, first, others...);
  } else if constexpr (is_vector<T>) {
    if (((others.size() != first.size()) || ...)) {
      raise<shape_error>(204, "zip: numbers of ", path, " differ: ", Index(first.size()), ", ",
                         Index(others.size())...);
    }
    for (std::size_t i = 0; i < first.size(); ++i)
      visit_member(join_path(path, std::to_string(i)), f, first[i], others[i]...);
  } else if constexpr (is_optional<T>) {
    if (((others.has_value() != first.has_value()) || ...)) raise<shape_error>(204, "zip: only one side has ", path);
    if (first) visit_member(path, f, *first, (*others)...);
  } else {
    f(path, first, others...);
  }
}

/// An object and those of its fields that are still to be walked over.
template <class List, class Object>
struct Walk {
  List list;
  Object& object;
  auto& member() const { return object.*(list.first.member); }
  auto rest() const { return Walk<decltype(list.rest), Object>{list.rest, object}; }
};
template <class Object>
auto walk(Object& object) {
  check_names<std::remove_const_t<Object>>();
  return Walk<decltype(Object::fields()), Object>{Object::fields(), object};
}

/// Calls f(name, member of first, members of others...) for all fields. The others may be the same template over
/// another backend: fields are matched by position.
template <class F, class First, class... Walks>
void each_field(F& f, const First& first, const Walks&... others) {
  if constexpr (!std::is_same_v<decltype(first.list), NoFields>) {
    f(first.list.first.name, first.member(), others.member()...);
    each_field(f, first.rest(), others.rest()...);
  }
}

template <class F, class First, class... Walks>
void visit_walks(const std::string& prefix, F& f, const First& first, const Walks&... others) {
  if constexpr (!std::is_same_v<decltype(first.list), NoFields>) {
    visit_member(join_path(prefix, first.list.first.name), f, first.member(), others.member()...);
    visit_walks(prefix, f, first.rest(), others.rest()...);
  }
}
template <class F, class... Objects>
void visit_fields(const std::string& prefix, F& f, Objects&... objects) {
  visit_walks(prefix, f, walk(objects)...);
}

}  // namespace detail

/// Calls f(path, leaf) for every leaf below the module, in the order of the fields.
template <class M, class F>
requires Module<std::remove_const_t<M>>
void visit(M& module, F f) { detail::visit_fields("", f, module); }

/// Calls f(path, leaf of a, leaf of b) for two modules of the same structure, perhaps over different backends.
template <class M, class N, class F>
requires Module<std::remove_const_t<M>> && Module<std::remove_const_t<N>>
void zip(M& a, N& b, F f) { detail::visit_fields("", f, a, b); }

namespace detail {

/// A place that is another for every type.
template <class M>
inline constexpr char type_place = 0;

/// True if one module is inside another, and its path from there.
template <Module M>
bool find_module(const M& around, const void* module, const void* type, std::string& path);
template <class T>
bool find_module_in(const T& member, const std::string& name, const void* module, const void* type, std::string& path) {
  if constexpr (Module<T>) {
    if (&member == module && &type_place<T> == type) {
      path = name;
      return true;
    }
    if (!find_module(member, module, type, path)) return false;
    path = join_path(name, path);
    return true;
  } else if constexpr (is_vector<T>) {
    for (std::size_t i = 0; i < member.size(); ++i) {
      if (find_module_in(member[i], join_path(name, std::to_string(i)), module, type, path)) return true;
    }
  } else if constexpr (is_optional<T>) {
    return member && find_module_in(*member, name, module, type, path);
  }
  return false;
}
template <Module M>
bool find_module(const M& around, const void* module, const void* type, std::string& path) {
  bool found = false;
  auto look = [&](const char* name, const auto& member) {
    found = found || find_module_in(member, name, module, type, path);
  };
  each_field(look, walk(around));
  return found;
}

template <class M>
struct StepInto {
  static ModuleStep step(const M& module) {
    return {.name = {}, .module = &module, .type = &type_place<M>, .path_to = &path_to};
  }
  static std::string path_to(const void* around, const void* module, const void* type) {
    std::string path;
    find_module(*static_cast<const M*>(around), module, type, path);
    return path;
  }
};

}  // namespace detail

/// Number of leaves.
template <Module M>
Index count_leaves(const M& module) {
  Index n = 0;
  visit(module, [&](const std::string&, const auto&) { ++n; });
  return n;
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_NN_TEXT_FEATURES_HPP  // <motionlang/nn/text_features.hpp>
#define MOTIONLANG_HAS_NN_TEXT_FEATURES_HPP
/// The output of a text encoder and input of a denoiser: token vectors for every text.

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct TextFeatures {
  Sequences<B> tokens;                // one sequence per text; a pooled encoder gives one row each
  std::vector<Index> end_position{};  // of each text: the row of its end token, for models that read it (MotionDiffuse)
  Index padded_tokens = 0;            // of a batch that is padded beyond its longest text: MDM-SMPL counts padding

  Index count() const { return tokens.count(); }

  /// From one vector per text.
  static TextFeatures pooled(const Tensor<B, 2>& rows) { return {{rows, Offsets::equal(rows.size(0), 1)}}; }
};

/// Texts picked by number, with repetition.
template <Backend B>
TextFeatures<B> gather(const TextFeatures<B>& text, std::span<const Index> which) {
  TextFeatures<B> out;
  for (Index i : which) {
    if (i < 0 || i >= text.count()) raise<shape_error>(203, "gather: text ", i, " of ", text.count());
    if (!text.end_position.empty()) out.end_position.push_back(text.end_position[static_cast<std::size_t>(i)]);
  }
  out.tokens = detail::some_sequences(text.tokens, which);
  out.padded_tokens = text.padded_tokens;
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// How a sequence's result depends on the rest of its batch. A batch with such dependencies cannot be split.
///     longest_text   the length of the longest text (MDM-SMPL with texts of several lengths)
///     all            everything (the released GRU of MDM)
enum class BatchMates { none, longest_text, all };

/// Properties of a denoiser that a host has to know.
struct DenoiserTraits {
  Prediction prediction = Prediction::x0;
  Index crop_frames = 0;            // > 0: every crop has exactly this many frames (MDM and MotionDiffuse: 196)
  Index longest_crop = 0;           // > 0: no crop has more frames
  bool uses_lengths = true;         // false: crops of fixed size are not masked
  bool empty_text_is_null = false;  // MDM: the text "" is the unconditional one, in both calls
  BatchMates mates = BatchMates::none;

  /// Frames that a crop may have; 0: any number.
  Index longest() const { return crop_frames > 0 ? crop_frames : longest_crop; }
};

/// A network that cleans noisy sequences given a text for each.
///     x (frames of all sequences, features), t (one step number per sequence), text (one per sequence) -> as x
/// Laws     a sequence gives the same result alone and in a batch, unless its traits name mates (tests/laws), except
///          the last digits in bf16x3 (core/precision.hpp)
/// Models   MdmSmplDenoiser, MdmDenoiser, MotionDiffuseDenoiser, and yours
template <class D, class B>
concept Denoiser = Module<D> &&
    requires(const D& d, const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text) {
  { d(x, t, text) } -> std::same_as<Sequences<B>>;
  { d.traits() } -> std::same_as<DenoiserTraits>;
};

/// A denoiser that does a part of its work on the texts alone, which is the same at every step:
///     d(x, t, d.encode(text)) == d(x, t, text)
/// Models   MdmSmplDenoiser, MotionDiffuseDenoiser, AnyDenoiser
template <class D, class B>
concept EncodesText = Denoiser<D, B> &&
    requires(const D& d, const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text) {
  { d(x, t, d.encode(text)) } -> std::same_as<Sequences<B>>;
};

/// Denoises frames with several texts each: sequence i of x with the texts uses.begin(i) ...
/// uses.end(i) - 1, such as a text and none, for guidance. t: a step for each text. Throws shape_error 204 for other
/// numbers of sequences, texts or steps. A denoiser that computes once what the texts of a sequence have in common
/// takes `uses` behind x (MdmSmplDenoiser, AnyDenoiser):
///     d(x, uses, t, text) == d(repeat_sequences(x, uses), t, text)
template <Backend B, Denoiser<B> D, class Text>
Sequences<B> denoise_with_texts(const D& denoiser, const Sequences<B>& x, const Offsets& uses, std::span<const Index> t,
                                const Text& text) {
  if constexpr (requires { denoiser(x, uses, t, text); })
    return denoiser(x, uses, t, text);
  else
    return denoiser(repeat_sequences(x, uses), t, text);
}

/// The texts as they are passed to a denoiser at every step.
template <Backend B, Denoiser<B> D>
auto encoded_text(const D& denoiser, TextFeatures<B> text) {
  if constexpr (EncodesText<D, B>)
    return denoiser.encode(text);
  else
    return text;
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_NN_POSITIONAL_ENCODING_HPP  // <motionlang/nn/positional_encoding.hpp>
#define MOTIONLANG_HAS_NN_POSITIONAL_ENCODING_HPP
/// Sinusoidal positions.

MOTIONLANG_NAMESPACE_BEGIN

///     pe[p, 2i] = sin(p w_i),   pe[p, 2i + 1] = cos(p w_i),   w_i = exp(-2i ln(10000) / width)
/// Source  Vaswani et al. (2017), section 3.5. Every intermediate is rounded to float, as in the published tables,
///         whose last digits depend on it. Throws config_error 101 for an odd width.
template <Backend B>
Tensor<B, 2> sinusoidal_positions(Index rows, Index width) {
  if (width % 2 != 0) raise<config_error>(101, "sinusoidal_positions: odd width ", width);
  std::vector<float> frequencies(static_cast<std::size_t>(width / 2));
  const auto c = static_cast<float>(-std::log(10000.0) / static_cast<double>(width));
  for (std::size_t i = 0; i < frequencies.size(); ++i) frequencies[i] = torch_exp(static_cast<float>(2 * i) * c);
  using S = typename B::scalar;
  return Tensor<B, 2>::written({rows, width}, [&](S* table) {
    parallel_ranges(rows, 16 * width, [&](Index first, Index last) {
      S* at = table + first * width;
      for (Index p = first; p < last; ++p) {
        for (const float w : frequencies) {
          const float angle = static_cast<float>(p) * w;
          *at++ = static_cast<S>(std::sin(angle));
          *at++ = static_cast<S>(std::cos(angle));
        }
      }
    });
  });
}

/// The table of a model: computed from its size, so it is neither saved nor loaded.
template <Backend B>
class PositionTable {
 public:
  static constexpr bool is_option = true;  // computed, not saved
  PositionTable() = default;
  PositionTable(Index rows, Index width) : rows_(sinusoidal_positions<B>(rows, width)) {}
  template <Backend C>
  explicit PositionTable(const PositionTable<C>& other) : PositionTable(other.rows().size(0), other.rows().size(1)) {}

  const Tensor<B, 2>& rows() const { return rows_; }

 private:
  Tensor<B, 2> rows_;
};

/// Positions of a sequence that are left out, as if padding stood there: `rows` of them before row `before`.
struct PositionGap {
  Index before = 0, rows = 0;
};

namespace detail {

/// Throws shape_error 203.
template <Backend B>
void require_positions(std::string_view op, const Tensor<B, 2>& table, Index wanted) {
  if (wanted > table.size(0))
    raise<shape_error>(203, op, ": a sequence of ", wanted, " rows; the model has positions for ", table.size(0));
}

}  // namespace detail

/// Adds row i of the table to row i of each sequence; with `gaps`, one for each sequence, later rows move up.
/// Throws shape_error 203 for a sequence longer than the table, 204 for another number of gaps.
template <Backend B>
Sequences<B> add_positions(const Sequences<B>& x, const Tensor<B, 2>& table, std::span<const PositionGap> gaps = {}) {
  if (!gaps.empty() && static_cast<Index>(gaps.size()) != x.count()) {
    raise<shape_error>(204, "add_positions: ", gaps.size(), " gaps for ", x.count(), " sequences");
  }
  PoolVector<Index> rows;
  rows.reserve(static_cast<std::size_t>(x.offsets.rows()));
  for (Index s = 0; s < x.count(); ++s) {
    const PositionGap gap = gaps.empty() ? PositionGap{} : gaps[static_cast<std::size_t>(s)];
    const Index length = x.offsets.length(s);
    detail::require_positions("add_positions", table, length > gap.before ? length + gap.rows : length);
    for (Index i = 0; i < length; ++i) rows.push_back(i < gap.before ? i : i + gap.rows);
  }
  return x.with(gather(table, rows) + x.rows);
}

/// How far each row is through its sequence, (rows, 1): t / (length - 1). Differs from published code where a sequence
/// has one row: 0 instead of a division by 0.
template <Backend B>
Tensor<B, 2> relative_time(const Offsets& offsets) {
  std::vector<typename B::scalar> time;
  for (Index s = 0; s < offsets.count(); ++s) {
    const auto last = static_cast<double>(std::max<Index>(1, offsets.length(s) - 1));
    for (Index t = 0; t < offsets.length(s); ++t)
      time.push_back(static_cast<typename B::scalar>(static_cast<double>(t) / last));
  }
  return Tensor<B, 2>::from(time, {offsets.rows(), 1});
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_NN_TIMESTEP_EMBEDDING_HPP  // <motionlang/nn/timestep_embedding.hpp>
#define MOTIONLANG_HAS_NN_TIMESTEP_EMBEDDING_HPP
/// The token that tells a denoiser which diffusion step it is at.

#ifndef MOTIONLANG_HAS_NN_LINEAR_HPP  // <motionlang/nn/linear.hpp>
#define MOTIONLANG_HAS_NN_LINEAR_HPP
/// Linear layer: y = x W^T + b.

#ifndef MOTIONLANG_HAS_NN_INIT_HPP  // <motionlang/nn/init.hpp>
#define MOTIONLANG_HAS_NN_INIT_HPP
/// Initial values of parameters, as PyTorch draws them (the distributions, not the same numbers).

MOTIONLANG_NAMESPACE_BEGIN

/// While it lives, this thread makes no more parameters than a file of weights justifies: twice its numbers and 16 Mi.
/// So a small file whose sizes are huge is refused before memory is taken for them.
class ParameterRoom {
 public:
  /// file: its name in messages; numbers: of all its tensors
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

/// A generator that gives zeros at no cost: for models whose parameters are about to be loaded.
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

/// Zeros that take no memory before somebody reads them, where the backend's tensors can lie in memory of others.
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
/// Glorot and Bengio (2010), normal: std sqrt(2 / (fan in + fan out)). shape is (out, in), with the kernel behind it if
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

#ifndef MOTIONLANG_HAS_NN_INIT_IPP  // <motionlang/nn/init.ipp>
#define MOTIONLANG_HAS_NN_INIT_IPP
// Bodies of init.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY ParameterRoom::ParameterRoom(std::string file, Index numbers)
    : file_(std::move(file)), numbers_(numbers), before_(std::exchange(innermost(), this)) {}
MOTIONLANG_BODY ParameterRoom::~ParameterRoom() { innermost() = before_; }

MOTIONLANG_BODY void ParameterRoom::take(const Shape& shape) {
  if (innermost() != nullptr) innermost()->take_numbers(shape);
}

MOTIONLANG_BODY ParameterRoom*& ParameterRoom::innermost() {
  struct Innermost {
    ParameterRoom* room = nullptr;
  };
  return thread_object<Innermost, ParameterRoom>().room;
}

MOTIONLANG_BODY void ParameterRoom::take_numbers(const Shape& shape) {
  double count = 1;  // may be beyond Index
  for (const Index n : shape.sizes()) count *= static_cast<double>(n);
  taken_ += count;
  if (taken_ > 2 * static_cast<double>(numbers_) + (1 << 24))
    raise<config_error>(102, file_, ": ", counted(numbers_, "number"), ", a network of its sizes has at least ", taken_,
                        ", with a tensor ", shape);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_TENSOR_MODULE_HPP  // <motionlang/tensor/module.hpp>
#define MOTIONLANG_HAS_TENSOR_MODULE_HPP
/// Operations of every module that lists its fields: visit tensors, count parameters, move to another backend.

MOTIONLANG_NAMESPACE_BEGIN

/// Statistics and tables (`static constexpr bool trainable = false`) are saved and loaded, but get no gradient.
template <class M>
inline constexpr bool is_trainable = [] {
  if constexpr (requires { M::trainable; })
    return M::trainable;
  else
    return true;
}();

/// True if a type that fields() may list has nothing to save or train: numbers, enumerations, texts, and what says so
/// itself (`static constexpr bool is_option = true`, or a specialisation of this variable): sizes, computed tables.
/// Other types need fields() of their own. Without them their tensors would be skipped, hence a compile error.
template <class T>
inline constexpr bool is_option = [] {
  if constexpr (requires { T::is_option; })
    return static_cast<bool>(T::is_option);
  else
    return std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::string>;
}();

/// A tensor of a module, whatever its rank: its path, and its data to read or replace. (In a const module it is const.)
template <Backend B, class Data = typename B::tensor>
struct ModuleTensor {
  std::string path;
  int rank = 0;
  void* tensor = nullptr;  // Tensor<B, rank>
  Data* data = nullptr;
  bool trainable = true;  // is_trainable of the module that lists it

  Shape shape() const { return B::shape(*data); }
  /// The numbers, row-major.
  std::span<const typename B::scalar> span() const { return B::to_span(*data); }
};

namespace detail {

/// The common properties of the tensors below a type: their backend (void: there are none), and which ranks they have,
/// a bit for each.
template <class T>
struct TensorsBelow {
  static_assert(is_option<T>,
                "motionlang: fields() of a module lists a member whose type has no fields(). Write `static constexpr "
                "auto fields()` in that type (core/fields.hpp), or `static constexpr bool is_option = true` if it has "
                "nothing to save or train");
  using backend = void;
  static constexpr unsigned ranks = 0;
};
template <>
struct TensorsBelow<NoFields> {
  using backend = void;
  static constexpr unsigned ranks = 0;
};
template <class B, int R>
struct TensorsBelow<Tensor<B, R>> {
  using backend = B;
  static constexpr unsigned ranks = 1U << R;
};
template <class T>
struct TensorsBelow<std::vector<T>> : TensorsBelow<T> {};
template <class T>
struct TensorsBelow<std::optional<T>> : TensorsBelow<T> {};
template <class M, class T, class Rest>
struct TensorsBelow<FieldList<Field<M, T>, Rest>> {
  using first = TensorsBelow<T>;
  using others = TensorsBelow<Rest>;
  using backend = std::conditional_t<first::ranks != 0, typename first::backend, typename others::backend>;
  static constexpr unsigned ranks = first::ranks | others::ranks;
};
template <Module M>
struct TensorsBelow<M> : TensorsBelow<decltype(M::fields())> {};

/// Lists tensors. One function for every type of module, whatever is done with the tensors then: models are large, and
/// each of their modules would be walked over again for every purpose.
template <Backend B>
class TensorLister {
 public:
  template <Module M>
  void list(M& module) {
    check_names<M>();
    const bool outer = std::exchange(trainable_, is_trainable<M>);
    list_fields(M::fields(), module);
    trainable_ = outer;
  }
  std::vector<ModuleTensor<B>> tensors;

 private:
  template <class Fields, class M>
  [[gnu::always_inline]] void list_fields(const Fields& fields, M& module) {
    if constexpr (!std::is_same_v<Fields, NoFields>) {
      list_member(fields.first.name, module.*(fields.first.member));
      list_fields(fields.rest, module);
    }
  }
  template <class T>
  [[gnu::always_inline]] void list_member(const char* name, T& member) {
    if constexpr (TensorsBelow<T>::ranks != 0) {
      const std::size_t length = open(name);
      if constexpr (is_tensor<T>) {
        add(T::rank, &member, member.mutable_data());
      } else if constexpr (is_vector<T>) {
        for (std::size_t i = 0; i < member.size(); ++i) list_member(std::to_string(i).c_str(), member[i]);
      } else if constexpr (is_optional<T>) {
        if (member) list_member("", *member);
      } else {
        list(member);
      }
      path_.resize(length);
    }
  }
  std::size_t open(std::string_view name) {
    const std::size_t length = path_.size();
    if (length != 0 && !name.empty()) path_ += '.';
    path_ += name;
    return length;
  }
  void add(int rank, void* tensor, typename B::tensor& data) {
    tensors.push_back({path_, rank, tensor, &data, trainable_});
  }

  std::string path_;
  bool trainable_ = true;
};

/// f(path, tensor) with the tensor's rank as a type again.
template <class M, unsigned ranks, Backend B, class F, int R = 0>
void with_rank(const ModuleTensor<B>& t, F& f) {
  if constexpr ((ranks >> R & 1) != 0) {
    using T = std::conditional_t<std::is_const_v<M>, const Tensor<B, R>, Tensor<B, R>>;
    if (t.rank == R) return f(t.path, *static_cast<T*>(t.tensor));
  }
  if constexpr (ranks >> R > 1) with_rank<M, ranks, B, F, R + 1>(t, f);
}

}  // namespace detail

/// The backend of a module's tensors.
template <Module M>
using module_backend = typename detail::TensorsBelow<M>::backend;

/// All tensors of a module in the order of its fields; other fields (sizes, options) are skipped.
template <Module M>
std::vector<ModuleTensor<module_backend<M>>> tensors_of(M& module) {
  detail::TensorLister<module_backend<M>> lister;
  lister.list(module);
  return std::move(lister.tensors);
}
template <Module M>
auto tensors_of(const M& module) {
  using B = module_backend<M>;
  std::vector<ModuleTensor<B, const typename B::tensor>> out;
  for (auto& t : tensors_of(const_cast<M&>(module)))
    out.push_back({std::move(t.path), t.rank, t.tensor, t.data, t.trainable});
  return out;
}

/// Calls f(path, tensor) for all tensors of a module.
template <class M, class F>
requires Module<std::remove_const_t<M>>
void visit_tensors(M& module, F f) {
  using Plain = std::remove_const_t<M>;
  if constexpr (constexpr unsigned ranks = detail::TensorsBelow<Plain>::ranks; ranks != 0) {
    for (const auto& t : tensors_of(const_cast<Plain&>(module))) detail::with_rank<M, ranks>(t, f);
  }
}

/// Calls f(tensor of a, tensor of b), both `ModuleTensor`, for two modules of the same structure, perhaps over
/// different backends. Throws shape_error 204 if they are not.
template <class M, class N, class F>
void zip_tensors(M& a, N& b, F f) {
  const auto first = tensors_of(a);
  const auto second = tensors_of(b);
  if (first.size() != second.size())
    raise<shape_error>(204, "zip_tensors: ", Index(first.size()), " and ", Index(second.size()), " tensors");
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i].path != second[i].path)
      raise<shape_error>(204, "zip_tensors: '", first[i].path, "' beside '", second[i].path, "'");
    f(first[i], second[i]);
  }
}

/// Numbers in all tensors of a module.
template <Module M>
Index parameter_count(const M& module) {
  Index n = 0;
  for (const auto& t : tensors_of(module)) n += t.shape().count();
  return n;
}

namespace detail {

template <class To, class From>
void convert_module(To& to, const From& from);

template <bool trainable, class To, class From>
void convert_member(To& to, const From& from) {
  if constexpr (is_tensor<To>) {
    using B = typename To::backend;
    const std::vector<typename B::scalar> values(from.span().begin(), from.span().end());
    to = To::from(values, from.shape());
    if constexpr (AutodiffBackend<B> && trainable) to = To(B::variable(B::value(to.data())));
  } else if constexpr (Module<To>) {
    convert_module(to, from);
  } else if constexpr (is_vector<To>) {
    to.resize(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) convert_member<trainable>(to[i], from[i]);
  } else if constexpr (is_optional<To>) {
    to.reset();
    if (from) convert_member<trainable>(to.emplace(), *from);
  } else if constexpr (std::is_same_v<To, From>) {
    to = from;
  } else {
    to = To(from);  // tables that are computed, not stored
  }
}

template <class To, class From>
void convert_module(To& to, const From& from) {
  auto member = [](const char*, auto& t, const auto& f) { convert_member<is_trainable<To>>(t, f); };
  each_field(member, walk(to), walk(from));
}

}  // namespace detail

/// The same model over another backend, with copies of all numbers. On an Autodiff backend every trainable tensor
/// becomes a variable.
template <Backend To, template <class> class M, class From>
M<To> convert(const M<From>& model) {
  M<To> out;
  detail::convert_module(out, model);
  return out;
}
/// From training to use: the model without a tape.
template <template <class> class M, AutodiffBackend A>
M<typename A::inner> to_inner(const M<A>& model) {
  return convert<typename A::inner>(model);
}

namespace detail {

/// Matrices, and what has the axes of a convolution's weight: (out, in, taps), (out, in, taps, 1).
template <class B>
bool has_panels(int rank) {
  return PackingBackend<B> && rank >= 2 && rank <= 4;
}

/// Packs a weight; returns whether all its values are finite.
template <PackingBackend B>
bool pack_weight(const typename B::tensor& weight) {
  const Shape shape = B::shape(weight);
  if (shape.rank() < 4) return B::prepare(weight);
  return B::prepare(B::reshape(weight, Shape{shape[0], shape[1], shape[2] * shape[3]}));
}

}  // namespace detail

/// Makes a model ready for inference: weights of linear layers and convolutions are packed for the backend's kernels
/// (and whatever else has two to four axes). The model must not be changed afterwards. Nothing happens on backends
/// without such a layout.
template <Module M>
void prepare(M& model) {
  using B = module_backend<M>;
  if constexpr (PackingBackend<B>) {
    for (const auto& t : tensors_of(model)) {
      if (detail::has_panels<B>(t.rank)) detail::pack_weight<B>(*t.data);
    }
  }
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct Linear {
  Tensor<B, 2> weight;  // (out, in)
  Tensor<B, 1> bias;    // (out)

  static constexpr auto fields() { return motionlang::fields("weight", &Linear::weight, "bias", &Linear::bias); }

  Linear() = default;
  /// PyTorch's initialisation: weight and bias uniform within 1 / sqrt(in).
  Linear(Index in, Index out, Rng auto& rng)
      : weight(uniform_init<B, 2>({out, in}, 1 / std::sqrt(static_cast<double>(in)), rng)),
        bias(uniform_init<B, 1>({out}, 1 / std::sqrt(static_cast<double>(in)), rng)) {}

  Index in() const { return weight.size(1); }
  Index out() const { return weight.size(0); }

  /// x (rows, in) -> dropout(act(x W^T + b)) + residual, (rows, out)
  Tensor<B, 2> operator()(const Tensor<B, 2>& x, Activation act = Activation::none,
                          const Tensor<B, 2>* residual = nullptr, const Dropout& drop = {}) const {
    const ModuleScope scope(*this);
    return linear(x, weight, &bias, act, residual, drop);
  }
  Sequences<B> operator()(const Sequences<B>& x, Activation act = Activation::none) const {
    const ModuleScope scope(*this);
    return x.with((*this)(x.rows, act));
  }
  /// Any leading axes: (..., in) -> (..., out)
  template <int R>
  requires(R == 1 || R > 2) Tensor<B, R>
  operator()(const Tensor<B, R>& x, Activation act = Activation::none) const {
    const ModuleScope scope(*this);
    const Shape s = x.shape();
    Shape to = s;
    to[R - 1] = out();
    const Tensor<B, 2> rows(B::reshape(x.data(), Shape{s.count(0, R - 1), s[R - 1]}));
    return Tensor<B, R>(B::reshape((*this)(rows, act).data(), to));
  }
};

/// Linear layer without bias: y = x W^T.
template <Backend B>
struct LinearMap {
  Tensor<B, 2> weight;  // (out, in)

  static constexpr auto fields() { return motionlang::fields("weight", &LinearMap::weight); }

  LinearMap() = default;
  /// Initialised like the weight of Linear.
  LinearMap(Index in, Index out, Rng auto& rng)
      : weight(uniform_init<B, 2>({out, in}, 1 / std::sqrt(static_cast<double>(in)), rng)) {}

  Tensor<B, 2> operator()(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    return linear<B>(x, weight, nullptr);
  }
};

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

///     e = W2 silu(W1 pe[t])
/// Source  MDM (Tevet et al. 2023), `TimestepEmbedder`; keys time_embed.0 and time_embed.2. The table pe is the one of
///         the positions and belongs to the caller.
template <Backend B>
struct TimestepEmbedding {
  Linear<B> in, out;

  static constexpr auto fields() {
    return motionlang::fields("time_embed.0", &TimestepEmbedding::in, "time_embed.2", &TimestepEmbedding::out);
  }
  TimestepEmbedding() = default;
  TimestepEmbedding(Index width, Rng auto& rng) : in(width, width, rng), out(width, width, rng) {}

  /// t: one step per sequence -> (sequences, width)
  Tensor<B, 2> operator()(const Tensor<B, 2>& table, std::span<const Index> t) const {
    const ModuleScope scope(*this);
    return out(in(gather(table, t), Activation::silu));
  }
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_NN_TRANSFORMER_ENCODER_HPP  // <motionlang/nn/transformer_encoder.hpp>
#define MOTIONLANG_HAS_NN_TRANSFORMER_ENCODER_HPP
/// Transformer encoder over packed sequences, post-norm or pre-norm.

#ifndef MOTIONLANG_HAS_NN_FEED_FORWARD_HPP  // <motionlang/nn/feed_forward.hpp>
#define MOTIONLANG_HAS_NN_FEED_FORWARD_HPP
/// The second half of a transformer layer.

#ifndef MOTIONLANG_HAS_NN_DROPOUT_HPP  // <motionlang/nn/dropout.hpp>
#define MOTIONLANG_HAS_NN_DROPOUT_HPP
/// Dropout that runs only when the call brings a generator.

MOTIONLANG_NAMESPACE_BEGIN

/// The next mask of a context: probability 0 when there is no generator. Throws config_error 101 unless 0 <= p < 1.
inline Dropout next_dropout(double p, const Context& context) {
  detail::check_dropout({.p = p});
  if (!context.dropout || p == 0) return {};
  const Philox g = context.next_mask();
  return {.p = p, .key = g.stream ^ (g.seed * 0x9E3779B97F4A7C15u)};
}
template <Backend B, int R>
Tensor<B, R> dropout(const Tensor<B, R>& x, double p, const Context& context) {
  return dropout(x, next_dropout(p, context));
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// dropout(W2 dropout(act(W1 x))) + residual, row by row: Vaswani et al. (2017), equation 2, with PyTorch's dropout.
template <Backend B>
Tensor<B, 2> feed_forward(const Linear<B>& linear1, const Linear<B>& linear2, Activation activation,
                          const Tensor<B, 2>& x, const Tensor<B, 2>& residual, double dropout_p,
                          const Context& context) {
  const auto inside = linear1(x, activation, nullptr, next_dropout(dropout_p, context));
  return linear2(inside, Activation::none, &residual, next_dropout(dropout_p, context));
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_NN_LAYER_NORM_HPP  // <motionlang/nn/layer_norm.hpp>
#define MOTIONLANG_HAS_NN_LAYER_NORM_HPP
/// Layer normalisation with gain and bias.

MOTIONLANG_NAMESPACE_BEGIN

/// Ba, Kiros, Hinton (2016). eps = 1e-5, as everywhere in the published systems.
template <Backend B>
struct LayerNorm {
  Tensor<B, 1> weight, bias;  // (width)
  double eps = 1e-5;

  static constexpr auto fields() {
    return motionlang::fields("weight", &LayerNorm::weight, "bias", &LayerNorm::bias, "eps", &LayerNorm::eps);
  }
  LayerNorm() = default;
  explicit LayerNorm(Index width) : weight(constant_init<B, 1>({width}, 1)), bias(constant_init<B, 1>({width}, 0)) {}

  Tensor<B, 2> operator()(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    return layer_norm(x, weight, bias, eps);
  }
  /// The norm of x + residual.
  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Tensor<B, 2>& residual) const {
    const ModuleScope scope(*this);
    return add_layer_norm(x, residual, weight, bias, eps);
  }
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_NN_MULTIHEAD_ATTENTION_HPP  // <motionlang/nn/multihead_attention.hpp>
#define MOTIONLANG_HAS_NN_MULTIHEAD_ATTENTION_HPP
/// Multi-head attention with PyTorch's packing of the projections.

MOTIONLANG_NAMESPACE_BEGIN

/// Throws config_error 101 if the heads do not divide the width. In a constant expression the compiler refuses it.
constexpr void check_heads(Index width, Index heads) {
  if (heads < 1 || width % heads != 0) {
    raise<config_error>(101, "MultiheadAttention: ", heads, " heads do not divide width ", width);
  }
}

/// Vaswani et al. (2017), section 3.2.2. `in_proj_weight` (3 width, width) holds the rows of query, key and value in
/// that order.
template <Backend B>
struct MultiheadAttention {
  Tensor<B, 2> in_proj_weight;
  Tensor<B, 1> in_proj_bias;
  Linear<B> out_proj;
  Index heads = 1;
  double dropout_p = 0.1;  // on the attention weights

  static constexpr auto fields() {
    using M = MultiheadAttention;
    return motionlang::fields("in_proj_weight", &M::in_proj_weight, "in_proj_bias", &M::in_proj_bias, "out_proj",
                              &M::out_proj, "heads", &M::heads, "dropout_p", &M::dropout_p);
  }
  MultiheadAttention() = default;
  /// Throws config_error 101 if the heads do not divide the width.
  MultiheadAttention(Index width, Index heads_, double dropout, Rng auto& rng)
      : in_proj_weight(xavier_uniform<B>({3 * width, width}, rng)),
        in_proj_bias(constant_init<B, 1>({3 * width}, 0)),
        out_proj(width, width, rng),
        heads(heads_),
        dropout_p(dropout) {
    check_heads(width, heads);
    out_proj.bias = constant_init<B, 1>({width}, 0);
  }

  /// x (rows, width) attends to itself within each sequence; the result is projected, dropped out with probability
  /// `drop` (where the context brings a generator) and added to `residual`.
  Tensor<B, 2> self(const Tensor<B, 2>& x, const Offsets& offsets, const Context& context,
                    const Tensor<B, 2>* residual = nullptr, bool causal = false, double drop = 0) const {
    return attend(project(x), offsets, context, residual, causal, drop);
  }
  /// Queries, keys and values of each row, (rows, 3 width).
  Tensor<B, 2> project(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    return linear(x, in_proj_weight, &in_proj_bias);
  }
  /// `self` behind `project`.
  Tensor<B, 2> attend(Tensor<B, 2> qkv, const Offsets& offsets, const Context& context,
                      const Tensor<B, 2>* residual = nullptr, bool causal = false, double drop = 0) const {
    const ModuleScope scope(*this);
    const auto read = self_attention(std::move(qkv), offsets,
                                     {.heads = heads, .causal = causal, .dropout = next_dropout(dropout_p, context)});
    return out_proj(read, Activation::none, residual, next_dropout(drop, context));
  }
  /// x attends to `memory`. Where every memory has one row, softmax over one key is 1 and the result is that row's
  /// value.
  Tensor<B, 2> cross(const Tensor<B, 2>& x, const Offsets& offsets, const Sequences<B>& memory,
                     const Context& context) const {
    const ModuleScope scope(*this);
    const Index d = x.size(1);
    auto project = [&](const Tensor<B, 2>& t, Index first, Index last) {
      const auto bias = slice(in_proj_bias, 0, first * d, last * d);
      return linear(t, slice(in_proj_weight, 0, first * d, last * d), &bias);
    };
    const auto q = project(x, 0, 1), k = project(memory.rows, 1, 2), v = project(memory.rows, 2, 3);
    return out_proj(
        attention(q, k, v, offsets, memory.offsets, {.heads = heads, .dropout = next_dropout(dropout_p, context)}));
  }
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_NN_RECOMPUTE_HPP  // <motionlang/nn/recompute.hpp>
#define MOTIONLANG_HAS_NN_RECOMPUTE_HPP
/// Layers whose inside is calculated again in the backward pass, where the context asks for it.

#ifndef MOTIONLANG_HAS_TENSOR_GRADIENT_HPP  // <motionlang/tensor/gradient.hpp>
#define MOTIONLANG_HAS_TENSOR_GRADIENT_HPP
/// Differentiation as user code sees it: variables, `backward`, and gradients as a value.

MOTIONLANG_NAMESPACE_BEGIN

/// The result of `backward`: the gradient of every variable, on the inner backend.
template <AutodiffBackend A>
class Gradients {
 public:
  explicit Gradients(typename A::GradientMap map) : map_(std::move(map)) {}

  /// Gradient of a variable; zeros if the loss does not depend on it. Throws config_error 102 for a constant and for
  /// the result of an operation: only variables have gradients.
  template <int R>
  Tensor<typename A::inner, R> operator[](const Tensor<A, R>& variable) const {
    const auto& node = variable.data().node;
    if (node == nullptr || !node->variable) {
      raise<config_error>(102, "Gradients: a tensor ", variable.shape(), " is ",
                          node == nullptr ? "a constant" : "the result of an operation", ", not a variable");
    }
    const auto* g = find(variable.data());
    return g != nullptr ? Tensor<typename A::inner, R>(*g) : Tensor<typename A::inner, R>::zeros(variable.shape());
  }
  /// Null if the loss does not depend on it, or if it is a constant.
  const typename A::Value* find(const typename A::tensor& variable) const {
    const auto it = map_.find(variable.node.get());
    return it == map_.end() ? nullptr : &it->second;
  }

 private:
  typename A::GradientMap map_;
};

/// Gradients of a scalar with respect to all variables behind it. Only for Autodiff backends.
template <Backend A>
auto backward(const Tensor<A, 0>& loss) {
  static_assert(AutodiffBackend<A>,
                "motionlang::backward(loss) requires a loss computed on Autodiff<B>; this backend keeps no graph");
  return Gradients<A>(A::gradients(loss.data()));
}

/// y, of which the graph keeps `inputs` and not what led from them to y: the backward pass calls again(inputs...),
/// which has to give y once more. Training needs the memory of one such piece instead of all, for a second forward
/// pass.
/// Source   Chen, Xu, Zhang, Guestrin: "Training deep nets with sublinear memory cost" (2016), section 4.1
/// Caution  `again` is copied and called by `backward`: it may hold parameters and constants, but what has been
///          calculated has to be an input (config_error 102). Gradients are the same bits as without
template <AutodiffBackend A, int R, class F, int... Q>
Tensor<A, R> keep_inputs(const Tensor<A, R>& y, F again, const Tensor<A, Q>&... inputs) {
  return Tensor<A, R>(A::checkpoint(
      y.data(), [again = std::move(again)](const auto&... values) { return again(Tensor<A, Q>(values)...).data(); },
      inputs.data()...));
}
/// f(inputs...), of which the graph keeps the inputs only.
template <class F, AutodiffBackend A, int... Q>
auto checkpoint(const F& f, const Tensor<A, Q>&... inputs) {
  return keep_inputs(f(inputs...), f, inputs...);
}

/// A leaf that gradients are wanted for.
template <AutodiffBackend A, int R>
Tensor<A, R> variable(const Tensor<typename A::inner, R>& value) {
  return Tensor<A, R>(A::variable(value.data()));
}
/// The plain value of a differentiable tensor.
template <AutodiffBackend A, int R>
Tensor<typename A::inner, R> value_of(const Tensor<A, R>& t) {
  return Tensor<typename A::inner, R>(A::value(t.data()));
}
/// The same value as a constant: gradients stop here. Where there are none it is the tensor itself.
template <Backend B, int R>
Tensor<B, R> stop_gradient(const Tensor<B, R>& t) {
  if constexpr (AutodiffBackend<B>)
    return Tensor<B, R>(typename B::tensor{B::value(t.data()), nullptr});
  else
    return t;
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// layer(x, offsets, context). With `context.recompute` the graph keeps x and a copy of the layer's handles; what
/// happens inside is calculated once more with the same dropout masks, so gradients are the same bits.
template <class Layer, Backend B>
Tensor<B, 2> run_layer(const Layer& layer, const Tensor<B, 2>& x, const Offsets& offsets, const Context& context) {
  if constexpr (AutodiffBackend<B>) {
    if (context.recompute) {
      auto again = [layer, offsets, before = context](const Tensor<B, 2>& rows) {
        return layer(rows, offsets, Context(before));
      };
      return keep_inputs(layer(x, offsets, context), std::move(again), x);
    }
  }
  return layer(x, offsets, context);
}
/// The same for layers that read a memory: layer(x, offsets, memory, context).
template <class Layer, Backend B>
Tensor<B, 2> run_layer(const Layer& layer, const Tensor<B, 2>& x, const Offsets& offsets, const Sequences<B>& memory,
                       const Context& context) {
  if constexpr (AutodiffBackend<B>) {
    if (context.recompute) {
      auto again = [layer, offsets, of_memory = memory.offsets, before = context](const Tensor<B, 2>& rows,
                                                                                  const Tensor<B, 2>& memory_rows) {
        return layer(rows, offsets, Sequences<B>(memory_rows, of_memory), Context(before));
      };
      return keep_inputs(layer(x, offsets, memory, context), std::move(again), x, memory.rows);
    }
  }
  return layer(x, offsets, memory, context);
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_NN_SEQUENCE_GROUPS_HPP  // <motionlang/nn/sequence_groups.hpp>
#define MOTIONLANG_HAS_NN_SEQUENCE_GROUPS_HPP
/// A few sequences of a batch at a time through a whole stack of layers, every thread with its own.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// How threads share sequences: the thread of each of the first ones.
using SequenceShares = PoolVector<Index>;
/// Each sequence goes to the thread that has the fewest rows so far. As many sequences as make equal shares: no thread
/// has a twentieth more than the mean, and that is at least the 128 rows from which on it pays to read all weights in
/// every thread. None if there is no such number.
SequenceShares share_sequences(const Offsets& offsets, std::span<const Index> order, Index threads);

/// All sequences, the longest first: shares become more equal.
PoolVector<Index> longest_first(const Offsets& offsets);

/// The first sequences that have at most this many rows together; at least one. There must be one.
std::span<const Index> first_group(const Offsets& offsets, std::span<const Index> order, Index rows);

/// Calls put(group) for the sequences that each thread has, in groups of at most this many rows. All threads at once.
template <class F>
void put_shares(const Offsets& offsets, std::span<const Index> order, const SequenceShares& thread_of, Index threads,
                Index rows, const F& put) {
  const auto modules = ModulePath::steps();  // a copy: this thread goes into modules itself
  parallel_for(threads, [&](Index thread) {
    const ModulePath::Continued path(modules);
    PoolVector<Index> mine;
    for (std::size_t i = 0; i < thread_of.size(); ++i) {
      if (thread_of[i] == thread) mine.push_back(order[i]);
    }
    for (std::span<const Index> left(mine), group; !left.empty(); left = left.subspan(group.size())) {
      group = first_group(offsets, left, rows);
      put(group);
    }
  });
}

/// The rows f(which) of the sequences `which` (a span of their numbers), where each has the rows `results` of `width`
/// numbers. f treats each sequence on its own, so that it can be called for a few at a time, as many as have
/// B::rows_in_cache() rows (a longer one alone): what one layer writes is still in the cache when the next reads it.
/// Threads that can share the sequences evenly go through the layers without waiting for each other; what is left over
/// they do together. The numbers are those of all at once. Where the backend says nothing, gradients are kept or
/// dropout counts rows, f is called for all at once. Weights that were not prepared are packed for every group.
template <Backend B, class F>
Tensor<B, 2> in_groups(const Offsets& offsets, const Offsets& results, Index width, const Context& context, F f) {
  const auto whole = [&] {
    PoolVector<Index> all;
    for (Index s = 0; s < offsets.count(); ++s) all.push_back(s);
    return f(std::span<const Index>(all));
  };
  if constexpr (requires { B::rows_in_cache(); }) {
    const RowsTogether in_any_groups(offsets.rows());
    const Index threads = parallel_width(), at_once = B::rows_in_cache(), together = RowsTogether::count();
    const PoolVector<Index> order = longest_first(offsets);
    const bool grouped = offsets.rows() > at_once || !share_sequences(offsets, order, threads).empty();
    if (grouped && !context.dropout) {
      typename B::tensor y(Shape{results.rows(), width});
      const auto put = [&, out = y.data()](std::span<const Index> which) {
        const RowsTogether as_here(together);
        const auto rows = f(which);
        const auto* from = rows.span().data();
        for (Index s : which) {
          const Index n = results.length(s) * width;
          std::copy(from, from + n, out + results.begin(s) * width);
          from += n;
        }
      };
      for (std::span<const Index> left(order); !left.empty();) {
        const SequenceShares shares = share_sequences(offsets, left, threads);
        const auto next = shares.empty() ? first_group(offsets, left, at_once) : left.first(shares.size());
        if (shares.empty())
          put(next);
        else
          put_shares(offsets, next, shares, threads, at_once / threads, put);
        left = left.subspan(next.size());
      }
      return Tensor<B, 2>(std::move(y));
    }
    return whole();
  }
  return whole();
}
/// The same with f(some), `some` being these sequences of x, and results as wide as x.
template <Backend B, class F>
Tensor<B, 2> in_groups(const Sequences<B>& x, const Offsets& results, const Context& context, F f) {
  const auto some = [&](std::span<const Index> which) { return f(some_sequences(x, which)); };
  return in_groups<B>(x.offsets, results, x.width(), context, some);
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_NN_SEQUENCE_GROUPS_IPP  // <motionlang/nn/sequence_groups.ipp>
#define MOTIONLANG_HAS_NN_SEQUENCE_GROUPS_IPP
// Bodies of sequence_groups.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY SequenceShares share_sequences(const Offsets& offsets, std::span<const Index> order, Index threads) {
  SequenceShares out;
  if (threads == 1) return out;
  PoolVector<Index> rows(static_cast<std::size_t>(threads)), thread_of;
  Index total = 0;
  std::size_t shared = 0;
  for (Index s : order) {
    Index* const fewest = std::min_element(rows.begin(), rows.end());
    thread_of.push_back(fewest - rows.begin());
    *fewest += offsets.length(s);
    total += offsets.length(s);
    const Index most = *std::max_element(rows.begin(), rows.end());
    if (total >= 128 * threads && most * threads * 20 <= total * 21) shared = thread_of.size();
  }
  for (std::size_t i = 0; i < shared; ++i) out.push_back(thread_of[i]);
  return out;
}

MOTIONLANG_BODY PoolVector<Index> longest_first(const Offsets& offsets) {
  PoolVector<Index> order;
  for (Index s = 0; s < offsets.count(); ++s) order.push_back(s);
  sort(order, [&](Index a, Index b) {
    return offsets.length(a) != offsets.length(b) ? offsets.length(a) > offsets.length(b) : a < b;
  });
  return order;
}

MOTIONLANG_BODY std::span<const Index> first_group(const Offsets& offsets, std::span<const Index> order, Index rows) {
  std::size_t size = 0;
  Index sum = 0;
  do sum += offsets.length(order[size++]);
  while (size < order.size() && sum + offsets.length(order[size]) <= rows);
  return order.first(size);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct TransformerConfig {
  Index d_model = 512;
  Index heads = 4;
  Index d_ff = 1024;
  Index layers = 8;
  Activation activation = Activation::gelu;
  bool norm_first = false;
  double dropout = 0.1;
  bool causal = false;

  /// Itself. A constant configuration is checked while compiling:
  ///     constexpr auto config = TransformerConfig{.d_model = 256, .heads = 4}.checked();
  constexpr const TransformerConfig& checked() const {
    check_heads(d_model, heads);
    return *this;
  }
};

///     post-norm   x = LN1(x + SA(x));      x = LN2(x + W2 act(W1 x))
///     pre-norm    x = x + SA(LN1 x);       x = x + W2 act(W1 LN2 x)
/// Source  Vaswani et al. (2017), section 3.1; pre-norm: Xiong et al. (2020). Parameter names of PyTorch. Dropout (only
///         with a context) after both halves, inside the feed-forward part and on the attention weights, as PyTorch has
///         it.
template <Backend B>
struct TransformerEncoderLayer {
  MultiheadAttention<B> self_attn;
  Linear<B> linear1, linear2;
  LayerNorm<B> norm1, norm2;
  Activation activation = Activation::gelu;
  bool norm_first = false, causal = false;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = TransformerEncoderLayer;
    return motionlang::fields("self_attn", &M::self_attn, "linear1", &M::linear1, "linear2", &M::linear2, "norm1",
                              &M::norm1, "norm2", &M::norm2, "activation", &M::activation, "norm_first", &M::norm_first,
                              "causal", &M::causal, "dropout_p", &M::dropout_p);
  }
  TransformerEncoderLayer() = default;
  TransformerEncoderLayer(const TransformerConfig& c, Rng auto& rng)
      : self_attn(c.d_model, c.heads, c.dropout, rng),
        linear1(c.d_model, c.d_ff, rng),
        linear2(c.d_ff, c.d_model, rng),
        norm1(c.d_model),
        norm2(c.d_model),
        activation(c.activation),
        norm_first(c.norm_first),
        causal(c.causal),
        dropout_p(c.dropout) {}

  /// x (rows, width) -> (rows, width)
  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Offsets& offsets, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return behind_project(x, project(x), offsets, context);
  }
  /// Queries, keys and values of each row, (rows, 3 width).
  Tensor<B, 2> project(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    return self_attn.project(norm_first ? norm1(x) : x);
  }
  /// The layer behind `project`.
  Tensor<B, 2> behind_project(const Tensor<B, 2>& x, Tensor<B, 2> qkv, const Offsets& offsets,
                              const Context& context = {}) const {
    const ModuleScope scope(*this);
    const auto attended = self_attn.attend(std::move(qkv), offsets, context, &x, causal, dropout_p);
    if (norm_first) return feed(norm2(attended), attended, context);
    const auto y = norm1(attended);
    return norm2(feed(y, y, context));
  }

 private:
  Tensor<B, 2> feed(const Tensor<B, 2>& x, const Tensor<B, 2>& residual, const Context& context) const {
    return feed_forward(linear1, linear2, activation, x, residual, dropout_p, context);
  }
};

/// A stack of layers. None of the published stacks has a final norm.
template <Backend B>
struct TransformerEncoder {
  std::vector<TransformerEncoderLayer<B>> layers;

  static constexpr auto fields() { return motionlang::fields("layers", &TransformerEncoder::layers); }

  TransformerEncoder() = default;
  TransformerEncoder(const TransformerConfig& c, Rng auto& rng) {
    for (Index i = 0; i < c.layers; ++i) layers.emplace_back(c, rng);
  }

  Sequences<B> operator()(const Sequences<B>& x, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return x.with(detail::in_groups(x, x.offsets, context, [&](Sequences<B> some) {
      for (std::size_t i = 0; i < layers.size(); ++i)
        some.rows = run_layer(layers[i], some.rows, some.offsets, context);
      return some.rows;
    }));
  }
  /// Encodes sequences that share endings: sequence j has the rows of heads[j], then those of tails[i], where
  /// uses.begin(i) <= j < uses.end(i). The same numbers as of whole sequences; what the first layer projects of a tail
  /// is computed once. No dropout. Throws shape_error 204 for other numbers of heads or tails.
  Sequences<B> with_tails(const Sequences<B>& heads, const Sequences<B>& tails, const Offsets& uses) const {
    const ModuleScope scope(*this);
    const Offsets repeated = repeat_lengths(tails.offsets, uses);
    if (heads.count() != repeated.count())
      raise<shape_error>(204, "with_tails: ", heads.count(), " heads for ", repeated.count(), " uses of ",
                         tails.count(), " tails");
    PoolVector<Index> lengths;
    for (Index j = 0; j < heads.count(); ++j) lengths.push_back(heads.offsets.length(j) + repeated.length(j));
    const Offsets offsets{std::span<const Index>(lengths)};
    const PoolVector<Index> tail_of = sequence_of_row(uses);
    const auto distinct = concat(0, heads.rows, tails.rows);
    const auto projected = layers.empty() ? distinct : layers.front().project(distinct);
    const auto encode = [&](std::span<const Index> which) {
      PoolVector<Index> pick;
      for (Index j : which) {
        const Index i = tail_of[static_cast<std::size_t>(j)];
        for (Index r = heads.offsets.begin(j); r < heads.offsets.end(j); ++r) pick.push_back(r);
        for (Index r = tails.offsets.begin(i); r < tails.offsets.end(i); ++r) pick.push_back(heads.offsets.rows() + r);
      }
      const Offsets some = detail::some_sequences(offsets, which);
      auto rows = gather(distinct, pick);
      for (std::size_t i = 0; i < layers.size(); ++i)
        rows = i == 0 ? layers[i].behind_project(rows, gather(projected, pick), some) : layers[i](rows, some);
      return rows;
    };
    return {detail::in_groups<B>(offsets, offsets, heads.width(), {}, encode), offsets};
  }
  /// (batch, time, width), all of one length.
  Tensor<B, 3> operator()(const Tensor<B, 3>& x, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return reshape<3>((*this)(from_equal(x), context).rows, {x.size(0), x.size(1), x.size(2)});
  }
};

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Published sizes (27 M parameters).
struct MdmSmplConfig {
  static constexpr bool is_option = true;  // holds no tensors
  Index nfeats = 205;
  Index tx_dim = 512;
  Index latent_dim = 512;
  Index ff_size = 2048;
  Index num_layers = 8;
  Index num_heads = 8;
  Index nb_registers = 2;  // may be none
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  Index max_len = 1024;  // of a sequence with its tokens, and of the diffusion steps

  /// Frames that fit behind the tokens of time and of a text of one token.
  Index longest_crop() const { return max_len - 2 - nb_registers; }
};

/// The sequence [time, text ..., registers, frames] plus sinusoidal positions through a pre-norm transformer encoder;
/// the frames are read off its end.
/// Source   thesis 6.2.4 ("Multi-track timeline control", Petrovich et al. 2024); nv-tlabs/stmc src/model/mdm_smpl.py,
///          whose state-dict keys (behind "denoiser.") are the field names
/// Caution  texts of several tokens are placed as the published code pads them: frames come behind the longest text of
///          the batch, so such a sequence depends on its batch mates. With one token per text (CLIP, ours) none
///          does.
/// Differs  from MDM: pre-norm, a text projection of two layers, register tokens, masks (here: packed sequences)
template <Backend B>
struct MdmSmplDenoiser {
  std::optional<Tensor<B, 2>> registers;  // (nb_registers, latent_dim); without any, files have no such tensor
  Linear<B> text_in, text_out;
  LayerNorm<B> text_norm;
  Linear<B> skel_embedding;
  TimestepEmbedding<B> timestep_encoder;
  TransformerEncoder<B> seqTransEncoder;
  Linear<B> to_skel_layer;
  PositionTable<B> positions;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = MdmSmplDenoiser;
    return motionlang::fields("registers", &M::registers, "tx_embedding.0", &M::text_in, "tx_embedding.2", &M::text_out,
                              "tx_embedding.3", &M::text_norm, "skel_embedding", &M::skel_embedding, "timestep_encoder",
                              &M::timestep_encoder, "seqTransEncoder", &M::seqTransEncoder, "to_skel_layer",
                              &M::to_skel_layer, "positions", &M::positions, "dropout_p", &M::dropout_p);
  }
  MdmSmplDenoiser() = default;
  MdmSmplDenoiser(const MdmSmplConfig& c, Rng auto& rng)
      : registers(c.nb_registers > 0 ? std::optional(normal_init<B, 2>({c.nb_registers, c.latent_dim}, 1, rng))
                                     : std::nullopt),
        text_in(c.tx_dim, 2 * c.latent_dim, rng),
        text_out(2 * c.latent_dim, c.latent_dim, rng),
        text_norm(c.latent_dim),
        skel_embedding(c.nfeats, c.latent_dim, rng),
        timestep_encoder(c.latent_dim, rng),
        seqTransEncoder({.d_model = c.latent_dim,
                         .heads = c.num_heads,
                         .d_ff = c.ff_size,
                         .layers = c.num_layers,
                         .activation = c.activation,
                         .norm_first = true,
                         .dropout = c.dropout},
                        rng),
        to_skel_layer(c.latent_dim, c.nfeats, rng),
        positions(c.max_len, c.latent_dim),
        dropout_p(c.dropout) {}

  /// Behind the tokens for time and text and the registers.
  DenoiserTraits traits() const {
    return {.longest_crop =
                MdmSmplConfig{.nb_registers = register_count(), .max_len = positions.rows().size(0)}.longest_crop(),
            .mates = BatchMates::longest_text};
  }

  Index register_count() const { return registers ? registers->size(0) : 0; }
  /// (sequences, latent)
  Tensor<B, 2> time_tokens(std::span<const Index> t) const { return timestep_encoder(positions.rows(), t); }
  /// Token by token.
  Sequences<B> text_tokens(const TextFeatures<B>& text) const {
    return text.tokens.with(text_norm(text_out(text_in(text.tokens.rows, Activation::gelu))));
  }
  /// The tokens of the texts, which are the same at every step.
  struct EncodedText {
    Sequences<B> tokens;
    Index padded_tokens = 0;  // as in TextFeatures

    Index places() const { return std::max(padded_tokens, tokens.offsets.longest()); }
  };
  EncodedText encode(const TextFeatures<B>& text) const { return {text_tokens(text), text.padded_tokens}; }

  /// The input of the first layer.
  Sequences<B> sequence(const Sequences<B>& x, std::span<const Index> t, const EncodedText& text) const {
    check_counts(x.count(), t, text);
    const auto tokens = concat_tokens(head_tokens(t, text), x.with(skel_embedding(x.rows)));
    return add_positions(tokens, positions.rows(), gaps(text));
  }
  Sequences<B> sequence(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text) const {
    return sequence(x, t, encode(text));
  }
  /// Sequence i with each of the texts uses.begin(i) ... uses.end(i) - 1, without dropout: what they have in common is
  /// computed once. t: a step for each text. Throws shape_error 204 for other numbers of sequences, texts or steps.
  Sequences<B> operator()(const Sequences<B>& x, const Offsets& uses, std::span<const Index> t,
                          const EncodedText& text) const {
    const ModuleScope scope(*this);
    check_counts(uses.rows(), t, text);
    const Offsets lengths = repeat_lengths(x.offsets, uses);
    const auto heads = add_positions(head_tokens(t, text), positions.rows(), gaps(text));
    const PoolVector<PositionGap> before(static_cast<std::size_t>(x.count()),
                                         {0, 1 + text.places() + register_count()});
    const auto frames = add_positions(x.with(skel_embedding(x.rows)), positions.rows(), before);
    return to_skel_layer(last_rows(seqTransEncoder.with_tails(heads, frames, uses), lengths));
  }
  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    return (*this)(x, t, encode(text), context);
  }
  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const EncodedText& text,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    auto tokens = sequence(x, t, text);
    if (context.dropout) tokens = tokens.with(dropout(tokens.rows, dropout_p, context));
    return to_skel_layer(last_rows(seqTransEncoder(tokens, context), x.offsets));
  }

 private:
  static void check_counts(Index n, std::span<const Index> t, const EncodedText& text) {
    if (text.tokens.count() == n && static_cast<Index>(t.size()) == n) return;
    raise<shape_error>(204, "MdmSmplDenoiser: ", n, " sequences, ", text.tokens.count(), " texts, ", t.size(),
                       " steps");
  }
  /// The rows before the frames, without positions.
  Sequences<B> head_tokens(std::span<const Index> t, const EncodedText& text) const {
    const Sequences<B> time(time_tokens(t), Offsets::equal(text.tokens.count(), 1));
    if (!registers) return concat_tokens(time, text.tokens);
    return concat_tokens(time, text.tokens, repeat_sequence(*registers, text.tokens.count()));
  }
  /// Rows after a text have the positions that they have behind the longest text of the batch and its padding.
  static PoolVector<PositionGap> gaps(const EncodedText& text) {
    const Offsets& texts = text.tokens.offsets;
    PoolVector<PositionGap> out;
    for (Index s = 0; s < texts.count(); ++s) out.push_back({1 + texts.length(s), text.places() - texts.length(s)});
    return out;
  }
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_FEATURES_LAYOUT_HPP  // <motionlang/features/layout.hpp>
#define MOTIONLANG_HAS_FEATURES_LAYOUT_HPP
/// Which numbers of a feature vector belong to which body part, and what they mean. Composition needs nothing but the
/// former from a representation.
///
/// Source  STMC (Petrovich et al. 2024), bptools: joint j owns its position, its 6D rotation and its velocity; what
///         belongs to the root, and the foot contacts, go to the legs. The tables are generated from that rule. In
///         other bodies the part with the path takes the place of the legs.
///         Meanings and units: HumanML3D motion_representation.ipynb; STMC src/tools/smplrifke_feats.py; TEMOS
///         temos/transforms/joints2jfeats/rifke.py; TMR src/rifke.py

MOTIONLANG_NAMESPACE_BEGIN

/// Half-open range of positions.
struct IndexRange {
  Index begin = 0, end = 0;
  constexpr Index size() const { return end - begin; }
  bool operator==(const IndexRange&) const = default;
};

/// The meaning of some values of a feature vector. A table of these covers the vector without gap or overlap.
struct FeatureRange {
  IndexRange numbers;
  std::string_view meaning;  // with `joints`: of each of them
  std::string_view unit;     // "1": none; frames are those of the features
  IndexRange joints{};       // they follow one another, each with as many numbers; empty: the root's numbers, contacts
};

/// A feature vector cut into body parts: every number belongs to exactly one. Own representations are a name, a size
/// and their ranges, or `from_owner`:
///
///     const auto owner = [](Index i) { return i < 40 ? BodyPart::legs : BodyPart::head; };
///     auto layout = FeatureLayout::from_owner("my features", 64, owner);
struct FeatureLayout {
  std::string name;
  Index size = 0;                                              // numbers of one frame
  std::array<std::vector<IndexRange>, most_body_parts> parts;  // ascending and separate, in the order of the parts
  BodyPartition body{};                                        // whose parts; the human body unless given

  /// From a function position -> BodyPart, or the number of a part. Throws config_error 102 for a part that the body
  /// does not have.
  template <class F>
  static FeatureLayout from_owner(std::string name, Index size, F owner) {
    return from_owner(std::move(name), size, BodyPartition(), std::move(owner));
  }
  template <class F>
  static FeatureLayout from_owner(std::string name, Index size, BodyPartition body, F owner) {
    FeatureLayout layout{std::move(name), size, {}, std::move(body)};
    for (Index i = 0; i < size; ++i) {
      const auto part = static_cast<Index>(owner(i));
      if (part < 0 || part >= layout.body.size())
        raise<config_error>(102, "FeatureLayout '", layout.name, "': number ", i, " belongs to part ", part, " of ",
                            layout.body.size());
      auto& ranges = layout.parts[static_cast<std::size_t>(part)];
      if (ranges.empty() || ranges.back().end != i) ranges.push_back({i, i});
      ranges.back().end = i + 1;
    }
    return layout;
  }

  const std::vector<IndexRange>& ranges(BodyPart part) const { return parts[static_cast<std::size_t>(part)]; }

  /// All positions of a part, ascending.
  std::vector<Index> indices(BodyPart part) const;

  /// Throws config_error 102 unless the ranges cover 0 ... size-1, each position once, and belong to parts of the body.
  void validate() const;
  bool operator==(const FeatureLayout&) const = default;
};

/// smplrifke: 4 root numbers, 6D rotations of `rotations` joints, positions of joints 1 ... J-1: 4 + 6 * 22 + 3 * 23 =
/// 205 for SMPL.
FeatureLayout smplrifke_layout(std::span<const BodyPart> part_of_joint = smpl_part_of_joint, Index rotations = 22,
                               const BodyPartition& body = {});

/// The meaning of the values of `smplrifke_layout`. World: Z up.
inline constexpr std::array<FeatureRange, 6> smplrifke_ranges{{
    {{0, 1}, "height of the pelvis above the lowest joint of the clip", "m"},
    {{1, 3}, "velocity of the pelvis to the next frame, seen from the body: x, y", "m/frame"},
    {{3, 4}, "turn of the heading to the next frame", "rad/frame"},
    {{4, 10}, "rotation in the world without the heading: the first two rows of the matrix", "1", {0, 1}},
    {{10, 136}, "rotation relative to the parent: the first two rows of the matrix", "1", {1, 22}},
    {{136, 205}, "position relative to the pelvis, seen from the body: x, y, z", "m", {1, 24}},
}};

/// Where things are in the vector of HumanML3D (22 joints: 263 numbers) and of KIT (21: 251); 12 J - 1 in all.
///
///     0              turn of the heading to the next frame: half the angle, radians
///     1:3            velocity of the root along x and z, seen from the body of the next frame
///     3              height of the root
///     positions      joints 1 ... J-1 seen from the body, heights above the floor: 3 each
///     rotations      joints 1 ... J-1: two columns of the matrix, 6 each
///     velocities     joints 0 ... J-1 to the next frame, seen from the body: 3 each
///     contacts       left ankle, left toes, right ankle, right toes: 1 if they stand, else 0
struct Guoh3dSlots {
  Index joints = 22;

  constexpr IndexRange positions() const { return {4, 4 + 3 * (joints - 1)}; }
  constexpr IndexRange rotations() const { return {positions().end, positions().end + 6 * (joints - 1)}; }
  constexpr IndexRange velocities() const { return {rotations().end, rotations().end + 3 * joints}; }
  constexpr IndexRange contacts() const { return {velocities().end, velocities().end + 4}; }
  constexpr Index size() const { return contacts().end; }
  /// The seven groups whose deviations are published as one number each.
  constexpr std::array<IndexRange, 7> groups() const {
    return {{{0, 1}, {1, 3}, {3, 4}, positions(), rotations(), velocities(), contacts()}};
  }
};

/// The vector of HumanML3D or, with 21 joints, of KIT: see Guoh3dSlots. The root and the contacts go to the legs, or to
/// the part with the path.
FeatureLayout guoh3dfeats_layout(std::span<const BodyPart> part_of_joint = std::span(smpl_part_of_joint).first<22>(),
                                 const BodyPartition& body = {});

namespace detail {

constexpr std::array<FeatureRange, 7> guoh3dfeats_ranges_of(const Guoh3dSlots& slots, std::string_view length,
                                                            std::string_view speed, std::string_view contacts) {
  const auto [turn, velocity, height, positions, rotations, velocities, feet] = slots.groups();
  return {{
      {turn, "half the turn of the heading to the next frame", "rad/frame"},
      {velocity, "velocity of the root to the next frame, seen from the body of the next frame: x, z", speed},
      {height, "height of the root above the floor", length},
      {positions, "position from the floor below the root, seen from the body: x, y, z", length, {1, slots.joints}},
      {rotations,
       "rotation of the bone that ends here relative to the one before it in its chain, of the first to the root: "
       "the first two columns of the matrix",
       "1",
       {1, slots.joints}},
      {velocities, "velocity to the next frame, seen from the body: x, y, z", speed, {0, slots.joints}},
      {feet, contacts, "1"},
  }};
}

}  // namespace detail

/// The meaning of the values of `guoh3dfeats_layout`: of HumanML3D, and of KIT with MMM's joints. World: Y up.
inline constexpr auto guoh3dfeats_ranges = detail::guoh3dfeats_ranges_of(
    {22}, "m", "m/frame", "left ankle, left foot, right ankle, right foot: 1 if it stands, else 0");
inline constexpr auto kit_ranges =
    detail::guoh3dfeats_ranges_of({21}, "m/640", "m/640/frame", "RMrot, RF, LMrot, LF: 1 if it stands, else 0");

/// rifke: the root's height, positions of joints 1 ... J-1, the root's turn and velocity (see rifke.hpp): 3 J + 1, 67
/// for SMPL's 22 joints and with `kit_part_of_joint` TEMOS's 64.
FeatureLayout rifke_layout(std::span<const BodyPart> part_of_joint = std::span(smpl_part_of_joint).first<22>(),
                           const BodyPartition& body = {});

/// The meaning of the values of `rifke_layout`: of TMR, Z up, and of TEMOS on KIT, Y up.
inline constexpr std::array<FeatureRange, 4> rifke_ranges{{
    {{0, 1}, "height of the root", "m"},
    {{1, 64}, "position from the ground below the root, seen from the body: x, y, z", "m", {1, 22}},
    {{64, 65}, "turn of the heading to the next frame", "rad/frame"},
    {{65, 67}, "velocity of the root to the next frame, seen from the body: x, y", "m/frame"},
}};
inline constexpr std::array<FeatureRange, 4> rifke64_ranges{{
    {{0, 1}, "height of the root above the floor", "m/640"},
    {{1, 61}, "position from the floor below the root, seen from the body: x, y, z", "m/640", {1, 21}},
    {{61, 62}, "turn of the heading since the frame before", "rad/frame"},
    {{62, 64}, "velocity of the root since the frame before, seen from the body: x, z", "m/640/frame"},
}};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FEATURES_LAYOUT_IPP  // <motionlang/features/layout.ipp>
#define MOTIONLANG_HAS_FEATURES_LAYOUT_IPP
// Bodies of layout.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> FeatureLayout::indices(BodyPart part) const {
  std::vector<Index> out;
  for (const IndexRange& r : ranges(part)) {
    for (Index i = r.begin; i < r.end; ++i) out.push_back(i);
  }
  return out;
}

MOTIONLANG_BODY void FeatureLayout::validate() const {
  std::vector<int> owners(static_cast<std::size_t>(size), 0);
  for (int p = 0; p < most_body_parts; ++p) {
    for (const IndexRange& r : ranges(static_cast<BodyPart>(p))) {
      if (p >= body.size())
        raise<config_error>(102, "FeatureLayout '", name, "': range ", r.begin, ":", r.end, " belongs to part ", p,
                            " of ", body.size());
      if (r.begin < 0 || r.end < r.begin || r.end > size) {
        raise<config_error>(102, "FeatureLayout '", name, "': range ", r.begin, ":", r.end, " of ",
                            body.name(static_cast<BodyPart>(p)), " is not inside 0:", size);
      }
      for (Index i = r.begin; i < r.end; ++i) ++owners[static_cast<std::size_t>(i)];
    }
  }
  for (std::size_t i = 0; i < owners.size(); ++i) {
    if (owners[i] != 1) {
      raise<config_error>(102, "FeatureLayout '", name, "': number ", i, " belongs to ", owners[i], " body parts");
    }
  }
}

MOTIONLANG_BODY FeatureLayout smplrifke_layout(std::span<const BodyPart> part_of_joint, Index rotations,
                                               const BodyPartition& body) {
  const Index joints = std::ssize(part_of_joint), first_position = 4 + 6 * rotations;
  if (joints < 1 || rotations < 0 || rotations > joints) {
    raise<config_error>(101, "smplrifke_layout: ", rotations, " rotations of ", joints, " joints");
  }
  return FeatureLayout::from_owner("smplrifke", first_position + 3 * (joints - 1), body, [&](Index i) {
    if (i < 4) return body.path();
    const Index joint = i < first_position ? (i - 4) / 6 : 1 + (i - first_position) / 3;
    return part_of_joint[static_cast<std::size_t>(joint)];
  });
}

MOTIONLANG_BODY FeatureLayout guoh3dfeats_layout(std::span<const BodyPart> part_of_joint, const BodyPartition& body) {
  const Guoh3dSlots slots{std::ssize(part_of_joint)};
  if (slots.joints < 1) raise<config_error>(101, "guoh3dfeats_layout: no joints");
  return FeatureLayout::from_owner("guoh3dfeats", slots.size(), body, [&](Index i) {
    if (i < slots.positions().begin || i >= slots.contacts().begin) return body.path();
    const Index joint = i < slots.positions().end   ? 1 + (i - slots.positions().begin) / 3
                        : i < slots.rotations().end ? 1 + (i - slots.rotations().begin) / 6
                                                    : (i - slots.velocities().begin) / 3;
    return part_of_joint[static_cast<std::size_t>(joint)];
  });
}

MOTIONLANG_BODY FeatureLayout rifke_layout(std::span<const BodyPart> part_of_joint, const BodyPartition& body) {
  const Index joints = std::ssize(part_of_joint);
  if (joints < 1) raise<config_error>(101, "rifke_layout: no joints");
  return FeatureLayout::from_owner("rifke", 3 * joints + 1, body, [&](Index i) {
    if (i < 1 || i >= 3 * joints - 2) return body.path();
    return part_of_joint[static_cast<std::size_t>(1 + (i - 1) / 3)];
  });
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FEATURES_NORMALIZER_HPP  // <motionlang/features/normalizer.hpp>
#define MOTIONLANG_HAS_FEATURES_NORMALIZER_HPP
/// Features to zero mean and unit deviation, and back.

MOTIONLANG_NAMESPACE_BEGIN

///     x' = (x - mean) / (std + eps),   x = x' (std + eps) + mean
/// Statistics are saved with a model but not trained. eps matters only where std is 0.
template <Backend B>
struct Normalizer {
  static constexpr bool trainable = false;
  Tensor<B, 1> mean, std;  // (features)
  double eps = 1e-12;

  static constexpr auto fields() {
    return motionlang::fields("mean", &Normalizer::mean, "std", &Normalizer::std, "eps", &Normalizer::eps);
  }
  /// Statistics that change nothing.
  static Normalizer identity(Index features) {
    return {Tensor<B, 1>::zeros({features}), Tensor<B, 1>::full({features}, 1)};
  }

  template <int R>
  Tensor<B, R> normalize(const Tensor<B, R>& x) const {
    return (x - mean) / (std + eps);
  }
  template <int R>
  Tensor<B, R> denormalize(const Tensor<B, R>& x) const {
    return x * (std + eps) + mean;
  }
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_TEXT_CAPTION_ENCODER_HPP  // <motionlang/text/caption_encoder.hpp>
#define MOTIONLANG_HAS_TEXT_CAPTION_ENCODER_HPP
/// A small text encoder of our own: word pieces, a transformer, one vector per caption. Below 2 MB, so that it can come
/// with a motion model and be trained together with it.

#ifndef MOTIONLANG_HAS_NN_EMBEDDING_HPP  // <motionlang/nn/embedding.hpp>
#define MOTIONLANG_HAS_NN_EMBEDDING_HPP
/// A learned row for every symbol.

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct Embedding {
  Tensor<B, 2> weight;  // (symbols, width)

  static constexpr auto fields() { return motionlang::fields("weight", &Embedding::weight); }

  Embedding() = default;
  Embedding(Index symbols, Index width, Rng auto& rng, double std = 1)
      : weight(normal_init<B, 2>({symbols, width}, std, rng)) {}

  /// ids -> (ids, width). Throws shape_error 203 for an unknown symbol.
  Tensor<B, 2> operator()(std::span<const Index> ids) const {
    const ModuleScope scope(*this);
    return gather(weight, ids);
  }
};

/// A row for each label with 1 in its column, (labels, classes).
/// Throws shape_error 203 for a label that is not a class.
template <Backend B>
Tensor<B, 2> one_hot(std::span<const Index> labels, Index classes) {
  std::vector<typename B::scalar> rows(labels.size() * static_cast<std::size_t>(classes));
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] < 0 || labels[i] >= classes)
      raise<shape_error>(203, "one_hot: label ", labels[i], " of ", classes, " classes");
    rows[i * static_cast<std::size_t>(classes) + static_cast<std::size_t>(labels[i])] = 1;
  }
  return Tensor<B, 2>::from(rows, {std::ssize(labels), classes});
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_TEXT_TEXT_ENCODER_HPP  // <motionlang/text/text_encoder.hpp>
#define MOTIONLANG_HAS_TEXT_TEXT_ENCODER_HPP
/// The concept of a text encoder.

MOTIONLANG_NAMESPACE_BEGIN

/// Turns texts into vectors: one sequence of tokens for each, a single row if it pools.
/// Laws     a text gives the same features alone and among others (except the last digits in bf16x3); "" is a text like
///          any other
/// Models   CaptionEncoder, and yours
template <class E, class B>
concept TextEncoder = requires(const E& e, std::span<const std::string> texts) {
  { e.template encode<B>(texts) } -> std::same_as<TextFeatures<B>>;
};

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_TEXT_WORD_PIECE_HPP  // <motionlang/text/word_piece.hpp>
#define MOTIONLANG_HAS_TEXT_WORD_PIECE_HPP
/// A small word-piece tokenizer whose vocabulary is learnt from the captions of a training set.
///
/// For plain captions: ASCII letters are lowered, everything that is neither letter nor digit separates words. The
/// tokenizers of BERT and CLIP, with their Unicode rules, are other headers.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
struct WordPieceIds;
}  // namespace detail

/// Pieces that continue a word begin with "##". The first three ids are fixed.
class WordPiece {
 public:
  static constexpr bool is_option = true;  // holds no tensors
  static constexpr Index begin_id = 0, end_id = 1, unknown_id = 2;

  WordPiece() = default;
  /// Throws config_error 107 unless the vocabulary begins with [CLS], [SEP], [UNK] and has no piece twice; `source`
  /// stands in messages.
  explicit WordPiece(std::vector<std::string> vocabulary, std::string_view source = "WordPiece");

  /// Learns a vocabulary: all letters, then the merges with the largest count(ab) / (count(a) count(b)) that occur at
  /// least `least` times, until `size` pieces; ties go to the alphabetically first.
  /// Source  the WordPiece criterion as described for BERT (Schuster and Nakajima 2012)
  static WordPiece learn(std::span<const std::string> texts, Index size, Index least = 2);

  const std::vector<std::string>& vocabulary() const { return pieces_; }
  Index size() const { return static_cast<Index>(pieces_.size()); }

  /// [CLS] pieces [SEP], at most `longest` ids; every word is split greedily into the longest known pieces, a word that
  /// cannot be split is [UNK]. Throws config_error 101 if `longest` leaves no room for [CLS] and [SEP].
  std::vector<Index> encode(std::string_view text, Index longest = 64) const;

  /// Lower-case runs of letters and digits.
  static std::vector<std::string> words(std::string_view text);

 private:
  void append_word(std::vector<Index>& ids, const std::string& word) const;

  std::vector<std::string> pieces_;
  std::shared_ptr<const detail::WordPieceIds> ids_;  // of the pieces; copies share it
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_TEXT_WORD_PIECE_IPP  // <motionlang/text/word_piece.ipp>
#define MOTIONLANG_HAS_TEXT_WORD_PIECE_IPP
// Bodies of word_piece.hpp.

#include <map>            // word counts, in a fixed order
#include <unordered_map>  // piece -> id

#ifndef MOTIONLANG_HAS_TEXT_DETAIL_LONGEST_PIECES_HPP  // <motionlang/text/detail/longest_pieces.hpp>
#define MOTIONLANG_HAS_TEXT_DETAIL_LONGEST_PIECES_HPP
/// Words in their longest known pieces, as word-piece tokenizers split them.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Splits a word from the left into the longest known pieces and appends their ids; `unknown` alone if that fails.
/// find(text, first) is the id of a piece that begins the word (first) or continues it, -1 if there is none.
template <class Find>
void append_longest_pieces(std::vector<Index>& ids, std::string_view word, std::size_t longest, Index unknown,
                           Find find) {
  const std::size_t before = ids.size();
  for (std::size_t at = 0; at < word.size();) {
    std::size_t length = std::min(word.size() - at, longest);
    Index id = -1;
    for (; length > 0 && (id = find(word.substr(at, length), at == 0)) < 0; --length) {}
    if (id < 0) {
      ids.resize(before);
      ids.push_back(unknown);
      return;
    }
    ids.push_back(id);
    at += length;
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The table in which WordPiece looks up pieces.
struct WordPieceIds {
  std::unordered_map<std::string, Index> ids;
  std::size_t longest = 0;  // of all pieces
};

}  // namespace detail

MOTIONLANG_BODY WordPiece::WordPiece(std::vector<std::string> vocabulary, std::string_view source)
    : pieces_(std::move(vocabulary)) {
  if (pieces_.size() < 3 || pieces_[0] != "[CLS]" || pieces_[1] != "[SEP]" || pieces_[2] != "[UNK]") {
    raise<config_error>(107, source, ": a vocabulary of ", pieces_.size(),
                        " pieces does not begin with [CLS], [SEP], [UNK]");
  }
  auto ids = std::make_shared<detail::WordPieceIds>();
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    if (!ids->ids.emplace(pieces_[i], static_cast<Index>(i)).second)
      raise<config_error>(107, source, ": piece '", pieces_[i], "' is duplicated");
    ids->longest = std::max(ids->longest, pieces_[i].size());
  }
  ids_ = std::move(ids);
}

MOTIONLANG_BODY WordPiece WordPiece::learn(std::span<const std::string> texts, Index size, Index least) {
  std::map<std::string, Index> counts;
  for (const std::string& t : texts) {
    for (const std::string& w : words(t)) ++counts[w];
  }
  struct Word {
    std::vector<std::string> pieces;
    Index count;
  };
  std::vector<Word> split;
  std::vector<std::string> vocabulary{"[CLS]", "[SEP]", "[UNK]"};
  std::map<std::string, Index> known;
  for (const auto& [word, count] : counts) {
    Word w{{}, count};
    for (std::size_t i = 0; i < word.size(); ++i) w.pieces.push_back((i == 0 ? "" : "##") + word.substr(i, 1));
    for (const auto& p : w.pieces) known[p] += count;
    split.push_back(std::move(w));
  }
  for (const auto& [piece, count] : known) vocabulary.push_back(piece);
  while (static_cast<Index>(vocabulary.size()) < size) {
    std::map<std::string, Index> single;
    std::map<std::pair<std::string, std::string>, Index> pairs;
    for (const Word& w : split) {
      for (std::size_t i = 0; i < w.pieces.size(); ++i) {
        single[w.pieces[i]] += w.count;
        if (i + 1 < w.pieces.size()) pairs[{w.pieces[i], w.pieces[i + 1]}] += w.count;
      }
    }
    double best_score = 0;
    std::pair<std::string, std::string> best;
    for (const auto& [pair, count] : pairs) {
      if (count < least) continue;
      const double score = static_cast<double>(count) /
                           (static_cast<double>(single[pair.first]) * static_cast<double>(single[pair.second]));
      if (score > best_score) best_score = score, best = pair;
    }
    if (best_score == 0) break;
    const std::string merged = best.first + best.second.substr(2);
    for (Word& w : split) {
      for (std::size_t i = 0; i + 1 < w.pieces.size(); ++i) {
        if (w.pieces[i] != best.first || w.pieces[i + 1] != best.second) continue;
        w.pieces[i] = merged;
        w.pieces.erase(w.pieces.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      }
    }
    vocabulary.push_back(merged);
  }
  return WordPiece(std::move(vocabulary));
}

MOTIONLANG_BODY std::vector<Index> WordPiece::encode(std::string_view text, Index longest) const {
  if (longest < 2) raise<config_error>(101, "WordPiece: at most ", longest, " ids, the frame has 2");
  std::vector<Index> ids{begin_id};
  for (const std::string& w : words(text)) append_word(ids, w);
  if (static_cast<Index>(ids.size()) > longest - 1) ids.resize(static_cast<std::size_t>(longest - 1));
  ids.push_back(end_id);
  return ids;
}

MOTIONLANG_BODY std::vector<std::string> WordPiece::words(std::string_view text) {
  std::vector<std::string> out;
  bool inside = false;
  for (char c : text) {
    c = detail::lower(c);
    const bool part = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (part && !inside) out.emplace_back();
    if (part) out.back() += c;
    inside = part;
  }
  return out;
}

MOTIONLANG_BODY void WordPiece::append_word(std::vector<Index>& ids, const std::string& word) const {
  const std::size_t longest = ids_ == nullptr ? 0 : ids_->longest;
  detail::append_longest_pieces(ids, word, longest, unknown_id, [&](std::string_view part, bool first) {
    const auto found = ids_->ids.find((first ? "" : "##") + std::string(part));
    return found == ids_->ids.end() ? Index{-1} : found->second;
  });
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct CaptionEncoderConfig {
  Index width = 128;
  Index heads = 4;
  Index d_ff = 256;
  Index layers = 2;
  Index out = 128;
  double dropout = 0.1;
  Index longest = 64;  // word pieces of a caption, with begin and end
};

/// Pieces -> embedding + positions -> pre-norm transformer -> norm -> the row of [CLS] -> linear.
template <Backend B>
struct CaptionEncoder {
  Embedding<B> embedding;
  TransformerEncoder<B> encoder;
  LayerNorm<B> norm;
  Linear<B> projection;
  PositionTable<B> positions;
  WordPiece tokenizer;

  static constexpr auto fields() {
    using M = CaptionEncoder;
    return motionlang::fields("embedding", &M::embedding, "encoder", &M::encoder, "norm", &M::norm, "projection",
                              &M::projection, "positions", &M::positions, "tokenizer", &M::tokenizer);
  }
  CaptionEncoder() = default;
  CaptionEncoder(const CaptionEncoderConfig& c, WordPiece pieces, Rng auto& rng)
      : embedding(pieces.size(), c.width, rng, 0.5),
        encoder({.d_model = c.width,
                 .heads = c.heads,
                 .d_ff = c.d_ff,
                 .layers = c.layers,
                 .norm_first = true,
                 .dropout = c.dropout},
                rng),
        norm(c.width),
        projection(c.width, c.out, rng),
        positions(c.longest, c.width),
        tokenizer(std::move(pieces)) {}

  /// (texts, out)
  Tensor<B, 2> operator()(std::span<const std::string> texts, const Context& context = {}) const {
    const ModuleScope scope(*this);
    std::vector<Index> ids, lengths, first;
    for (const std::string& t : texts) {
      const auto pieces = tokenizer.encode(t, positions.rows().size(0));
      first.push_back(static_cast<Index>(ids.size()));
      ids.insert(ids.end(), pieces.begin(), pieces.end());
      lengths.push_back(static_cast<Index>(pieces.size()));
    }
    const auto tokens = add_positions(Sequences<B>(embedding(ids), Offsets(lengths)), positions.rows());
    return projection(norm(gather(encoder(tokens, context).rows, first)));
  }
  template <Backend C>
  requires std::same_as<C, B> TextFeatures<C> encode(std::span<const std::string> texts)
  const { return TextFeatures<C>::pooled((*this)(texts)); }
};

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct BatchPlan;

namespace detail {

/// Complete where the bodies of Stmc are.
template <class T>
struct StmcBodies;
/// True if motionlang::instantiated has the bodies.
template <class T>
inline constexpr bool is_compiled_stmc = false;
/// Says what a unit without the bodies lacks for a function that no library can have compiled. Argument: of it.
template <class T, class Argument>
struct HasStmcBodies {
  static constexpr bool value = true;
  static_assert(
      requires { sizeof(StmcBodies<T>); },
      "motionlang: for generate_from and sample include <motionlang/systems/stmc.ipp>");
};

}  // namespace detail

struct StmcOptions {
  Index overlap = 10;                // frames around a cut, in total
  std::optional<double> guidance{};  // weight of classifier-free guidance, 1: none; the model's own unless given
  std::optional<Index> steps{};      // of sampling, 0: all of the process; the model's own unless given
  std::optional<SamplingOptions> sampling{};  // the model's own unless given
  Gaps gaps = Gaps::fill;
  HiddenTexts hidden = HiddenTexts::refuse;
  Index rows_at_once = usual_rows_at_once;  // frames through the denoiser together; 0: all. Changes the memory only
  Progress progress{};                      // called after every step; may cancel
};

/// Clean motions, normalised, one below the other.
template <Backend B>
struct CleanMotions {
  Tensor<B, 2> rows{};  // (motions * stride, features); those behind the end of a motion mean nothing
  Index stride = 0;     // rows of every motion
};

/// The denoiser and encoder may be any models of `Denoiser<B>` and `TextEncoder<B>`.
///
///     auto stmc = load_stmc<EigenBackend<float>>("model.safetensors");
///     auto timeline = parse_timeline("walk forward # 0 # 6 # legs\nraise both arms # 2 # 5 # left arm # right arm\n");
///     Tensor<B, 2> motion = stmc.generate(timeline, Philox{.seed = 7});      // (frames, features)
template <Backend B, Denoiser<B> D = MdmSmplDenoiser<B>, TextEncoder<B> E = CaptionEncoder<B>>
struct Stmc {
  static_assert(
      detail::is_compiled_stmc<Stmc> || requires { sizeof(detail::StmcBodies<Stmc>); },
      "motionlang: for this backend, denoiser or encoder include <motionlang/systems/stmc.ipp>");

  D denoiser;
  E text_encoder;
  Normalizer<B> motion_normalizer, text_normalizer;
  GaussianDiffusion diffusion{CosineSchedule{.steps = 100}};
  FeatureLayout layout = smplrifke_layout();
  double guidance = 2.5;       // what the model should be sampled with, where the caller does not say
  SamplingOptions sampling{};  // the same
  Index steps = 0;             // the same; 0: all of the process
  double fps = 20;             // of its motions

  /// A text encoder without fields has its weights in files of its own.
  static constexpr auto fields() {
    if constexpr (Module<E>)
      return motionlang::fields("denoiser", &Stmc::denoiser, "text_encoder", &Stmc::text_encoder, "motion_normalizer",
                                &Stmc::motion_normalizer, "text_normalizer", &Stmc::text_normalizer);
    else
      return motionlang::fields("denoiser", &Stmc::denoiser, "motion_normalizer", &Stmc::motion_normalizer,
                                "text_normalizer", &Stmc::text_normalizer);
  }

  /// One motion per timeline, (frames, features), not normalised. All are sampled together; the noise of each depends
  /// only on the generator and its place in the list. Throws timeline_error 504 ... 508, config_error, `cancelled`.
  std::vector<Tensor<B, 2>> generate(std::span<const Timeline> timelines, const Philox& rng,
                                     const StmcOptions& options = {}) const;
  Tensor<B, 2> generate(const Timeline& timeline, const Philox& rng, const StmcOptions& options = {}) const;

  /// The same with the caller's noise: noise(draw, shape) for draw 0 (initial), 1, 2, ... (steps) is a tensor
  /// (sequences, frames, features) as `shape` says.
  template <class Noise, bool = detail::HasStmcBodies<Stmc, Noise>::value>
  std::vector<Tensor<B, 2>> generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                          const StmcOptions& options = {}) const;

  /// The same where someone else calculates the clean estimates: estimate(collage, whole, x, t) -> x0, all of shape
  /// (rows of the collage, features); whole(collage, x, t) is what a plain run takes.
  template <class Noise, class Estimate, bool = detail::HasStmcBodies<Stmc, Noise>::value>
  std::vector<Tensor<B, 2>> generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                          const StmcOptions& options, Estimate&& estimate) const;
  /// The same from a plan made with `plan_options`, by other rules for texts that want a part at the same time, say.
  template <class Noise, class Estimate, bool = detail::HasStmcBodies<Stmc, Noise>::value>
  std::vector<Tensor<B, 2>> generate_from(BatchPlan plan, Noise&& noise, const StmcOptions& options,
                                          Estimate&& estimate) const;

  /// The same motions as they are sampled: still normalised.
  template <class Noise, class Estimate, bool = detail::HasStmcBodies<Stmc, Noise>::value>
  CleanMotions<B> sample(BatchPlan plan, Noise&& noise, const StmcOptions& options, Estimate&& estimate) const;
  /// Each of them by itself, not normalised: (frames of its timeline in the plan, features).
  std::vector<Tensor<B, 2>> separate(const CleanMotions<B>& clean, const BatchPlan& plan) const;

  /// How timelines are planned for this model.
  PlanOptions plan_options(const StmcOptions& options) const;

  /// Standard normal numbers of every sequence from its own stream: a timeline alone and in a batch sees the same
  /// noise.
  Tensor<B, 3> noise(const Philox& rng, Index draw, const Shape& shape) const;

  /// The process with this many steps evenly kept, all when 0; the model's own number unless given. Throws config_error
  /// 105.
  GaussianDiffusion process(std::optional<Index> wanted) const;

 private:
  /// Features of the text of every interval, and of "". Each text goes through the encoder once.
  struct PlanTexts {
    TextFeatures<B> text, null;
  };
  PlanTexts encode(const BatchPlan& plan) const;
};

/// Generated features (frames, 205) as a motion of the 24-joint skeleton, Y up, metres. Bone lengths are the
/// skeleton's: the rotations are used, not the predicted positions. Published generation starts facing pi.
template <Backend B>
Motion stmc_motion(const Tensor<B, 2>& features, double fps = 20);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_SYSTEMS_STMC_IPP  // <motionlang/systems/stmc.ipp>
#define MOTIONLANG_HAS_SYSTEMS_STMC_IPP
// Bodies of the templates of stmc.hpp, for every backend, denoiser and text encoder. Any header may include them.

#ifndef MOTIONLANG_HAS_COMPOSE_COLLAGE_HPP  // <motionlang/compose/collage.hpp>
#define MOTIONLANG_HAS_COMPOSE_COLLAGE_HPP
/// The denoising step of STMC: all crops of all timelines through the network in ragged batches, guided, stitched.
///
/// Independent of the feature type and of the network: any layout with a partition into parts, any `Denoiser`.

#ifndef MOTIONLANG_HAS_COMPOSE_STITCHING_HPP  // <motionlang/compose/stitching.hpp>
#define MOTIONLANG_HAS_COMPOSE_STITCHING_HPP
/// Values of a composition: crops cut out of a motion, and a motion put together from crops, per body part and
/// interval.
///
/// All index lists are made once per plan; cutting and stitching are then gathers and scatters of whole rows.

#ifndef MOTIONLANG_HAS_COMPOSE_PLAN_HPP  // <motionlang/compose/plan.hpp>
#define MOTIONLANG_HAS_COMPOSE_PLAN_HPP
/// From timelines to the integers of a composition: which crops to denoise, and which frames of which crop are added to
/// and subtracted from which frames of the motion, for each body part. No tensors here.
///
/// Source     thesis 6.2.3; STMC (Petrovich et al. 2024); reference: nv-tlabs/stmc src/stmc.py process_timelines
/// Notation   a, b -> start, end of an interval; T -> frames; O, l, r -> Overlap; x -> cut
/// Property   for every body part and frame, additions minus subtractions = 1, however close the cuts are, if extension
///            and transition crops are both on or both off; see net_weights
/// Differs    from the reference, where told to: gaps are filled with the unconditional text "" (the reference stops),
///            and transitions at which no part changes can be left out

#ifndef MOTIONLANG_HAS_COMPOSE_OVERLAP_HPP  // <motionlang/compose/overlap.hpp>
#define MOTIONLANG_HAS_COMPOSE_OVERLAP_HPP
/// Overlap around the cuts of a timeline: how far texts reach beyond their ends, and the windows of transitions.
///
/// Source   thesis 6.2.3, "Temporal stitching"; STMC (Petrovich et al. 2024) src/stmc.py
/// Differs  from the thesis, which gives 0.25 s on each side: the code splits a total overlap, the longer half to the
///          right

MOTIONLANG_NAMESPACE_BEGIN

/// A half-open range of frames.
struct FrameRange {
  Index start = 0, end = 0;
  Index size() const { return end - start; }
  bool operator==(const FrameRange&) const = default;
};

/// A total of O frames: l = O div 2 to the left of a cut, r = O - l to the right.
struct Overlap {
  Index left = 0, right = 0;

  /// Throws config_error 101 if it is negative or beyond `latest_time`.
  static Overlap of_frames(Index total);
  static Overlap of_seconds(double total, double fps) { return of_frames(frame_at(total, fps)); }

  /// [max(s - l, 0), min(e + r, frames))
  FrameRange extend(FrameRange range, Index frames) const {
    return {std::max<Index>(range.start - left, 0), std::min(range.end + right, frames)};
  }
  /// Around a cut x: [max(x - l, 0), min(x + r, frames)).
  FrameRange window(Index cut, Index frames) const { return extend({cut, cut}, frames); }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_OVERLAP_IPP  // <motionlang/compose/overlap.ipp>
#define MOTIONLANG_HAS_COMPOSE_OVERLAP_IPP
// Bodies of overlap.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Overlap Overlap::of_frames(Index total) {
  if (total < 0 || total > latest_time) raise<config_error>(101, "Overlap: ", total, " frames");
  return {total / 2, total - total / 2};
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_SINC_ASSIGNMENT_HPP  // <motionlang/compose/sinc_assignment.hpp>
#define MOTIONLANG_HAS_COMPOSE_SINC_ASSIGNMENT_HPP
/// Which text owns which body part while several texts are active.
///
/// Source   thesis 6.2.3, figure 6.4: the heuristic of SINC (thesis B.2.1) as STMC src/stmc.py applies it. Where papers
///          and code differ (the base is a text with legs first, ties are random), the code is followed.
/// Rule     1. Base: of the texts with the part that carries the path, the legs of a human, the one with the most body
///             parts (of all texts, if none has that part). It gets all parts.
///          2. The others, by number of parts, largest first, in file order among equals, take their parts away from
///             whoever holds them: the text with fewer parts wins, among equals the later one.
/// Ties     between base texts: the first in the file, or random as published when a generator is given

#ifndef MOTIONLANG_HAS_COMPOSE_INTERVALS_HPP  // <motionlang/compose/intervals.hpp>
#define MOTIONLANG_HAS_COMPOSE_INTERVALS_HPP
/// Cutting a timeline at every start and end: between two neighbouring cuts the set of active texts is constant.
///
/// Source  thesis 6.2.3, "Resolving unassigned timeframes"; STMC (Petrovich et al. 2024) src/stmc.py process_timeline

MOTIONLANG_NAMESPACE_BEGIN

/// A stretch without cuts inside, and the intervals that cover it, in file order.
template <class T>
struct BasicPiece {
  T start{}, end{};
  std::vector<Index> intervals;
  bool operator==(const BasicPiece&) const = default;
};
using Piece = BasicPiece<Index>;

/// The pieces between neighbouring cuts; those of gaps have no intervals. Throws config_error 101 if so many intervals
/// lie over each other that the lists would not be reasonable (10 million entries).
template <class T>
std::vector<BasicPiece<T>> elementary_pieces(const BasicTimeline<T>& timeline) {
  std::vector<std::pair<T, Index>> events;  // every start and end, with the number of its interval
  for (Index i = 0; const auto& interval : timeline.intervals) {
    events.emplace_back(interval.start, i);
    events.emplace_back(interval.end, i++);
  }
  detail::sort(events, [](const auto& a, const auto& b) { return a < b; });

  std::vector<BasicPiece<T>> pieces;
  std::vector<Index> active;  // ascending
  std::size_t entries = 0;
  for (std::size_t at = 0; at < events.size();) {
    const T cut = events[at].first;
    for (; at < events.size() && events[at].first == cut; ++at) {
      const Index i = events[at].second;
      const auto& interval = timeline.intervals[static_cast<std::size_t>(i)];
      const auto place = std::lower_bound(active.begin(), active.end(), i);
      const bool is_active = place != active.end() && *place == i;
      if (is_active && interval.end == cut) active.erase(place);
      if (!is_active && interval.start == cut && interval.end > cut) active.insert(place, i);
    }
    if (at == events.size()) break;
    entries += active.size();
    if (entries > 10'000'000) {
      raise<config_error>(101, "elementary_pieces: too many of ", timeline.intervals.size(), " intervals overlap");
    }
    pieces.push_back({cut, events[at].first, active});
  }
  return pieces;
}

/// Adds an interval with the unconditional text "" and all body parts for every stretch from 0 to the end that no text
/// covers.
template <class T>
void fill_gaps(BasicTimeline<T>& timeline) {
  std::vector<std::pair<T, T>> covered;
  for (const auto& i : timeline.intervals) covered.emplace_back(i.start, i.end);
  detail::sort(covered, [](const auto& a, const auto& b) { return a < b; });
  T reached{};
  for (const auto& [start, end] : covered) {
    if (start > reached) timeline.intervals.push_back({"", reached, start, timeline.body.all()});
    reached = std::max(reached, end);
  }
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Number of the interval that owns each body part.
using PartOwners = std::vector<Index>;

/// A generator that can put a list into random order: PythonRandom (as published), NumpyRandom.
template <class G>
concept Shuffler = requires(G& g, std::span<Index> list) {
  g.shuffle(list);
};

/// The library's rule for ties: keep the order of the file.
struct FirstWins {
  void shuffle(std::span<Index>) const {}
};

namespace detail {

/// Among texts with the path (or all, if none has it), the one with the most parts; on a tie, the first after a
/// shuffle.
/// Shuffling one text draws nothing.
template <class T, Shuffler G>
Index base_text(const BasicTimeline<T>& timeline, std::span<const Index> texts, G& ties) {
  const auto parts = [&](Index i) { return timeline.intervals[static_cast<std::size_t>(i)].parts; };
  std::vector<Index> candidates;
  for (Index i : texts) {
    if (parts(i).has(timeline.body.path())) candidates.push_back(i);
  }
  if (candidates.empty()) candidates.assign(texts.begin(), texts.end());
  ties.shuffle(std::span<Index>(candidates));
  Index base = candidates.front();
  for (Index i : candidates) {
    if (parts(i).count() > parts(base).count()) base = i;
  }
  return base;
}

}  // namespace detail

/// Owners of all parts on a piece with at least one text. `texts` are numbers of intervals in file order.
template <class T, Shuffler G>
PartOwners assign_parts(const BasicTimeline<T>& timeline, std::span<const Index> texts, G& ties) {
  const Index base = detail::base_text(timeline, texts, ties);
  const int size = timeline.body.size();
  PartOwners owners(static_cast<std::size_t>(size), base);
  for (int count = size; count > 0; --count) {  // texts with many parts first, in file order among equals
    for (Index i : texts) {
      const BodyParts parts = timeline.intervals[static_cast<std::size_t>(i)].parts;
      if (i == base || parts.count() != count) continue;
      for (int p = 0; p < size; ++p) {
        if (parts.has(static_cast<BodyPart>(p))) owners[static_cast<std::size_t>(p)] = i;
      }
    }
  }
  return owners;
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// A stretch of the timeline that the denoiser sees as one sequence. Crops without frames (overlap 0) are kept, so that
/// numbers agree with the reference; they take part in nothing.
struct Crop {
  Index interval = 0;  // -1: a transition, with the unconditional text
  FrameRange range;
  bool is_transition() const { return interval < 0; }
  bool operator==(const Crop&) const = default;
};

/// A part belongs to one text for a stretch; neighbours have different owners.
struct PartInterval {
  BodyPart part{};
  Index owner = 0;
  FrameRange range;
  bool operator==(const PartInterval&) const = default;
};

/// Frames `from` of a crop go to frames `to` of the motion, for the features of one part.
struct Slice {
  BodyPart part{};
  Index crop = 0;
  FrameRange from, to;
  bool operator==(const Slice&) const = default;
};

/// A window in which a part changes its owner, for interpolation instead of blending (the SINC+lerp baseline).
struct LerpWindow {
  BodyPart part{};
  Index transition = 0;
  FrameRange range;
  bool operator==(const LerpWindow&) const = default;
};

/// Everything about one timeline. All lists are sorted by part, then by time.
struct TimelinePlan {
  Timeline timeline;                 // gaps filled
  Index frames = 0;                  // T
  std::vector<Piece> pieces;         // between cuts
  std::vector<PartOwners> owners;    // on each piece
  std::vector<PartInterval> merged;  // before extension
  std::vector<Crop> crops;           // one for each interval, then the transitions by time
  std::vector<Slice> add, subtract;
  std::vector<LerpWindow> lerp;  // also without transition crops

  /// "" for transitions.
  std::string_view text(const Crop& crop) const {
    if (crop.is_transition()) return {};
    return timeline.intervals[static_cast<std::size_t>(crop.interval)].text;
  }
};

/// Several timelines that are sampled together. The crops of timeline m have the numbers first_crop[m] ...
/// first_crop[m + 1] - 1 in the batch; slices count crops from the first one of their timeline.
struct BatchPlan {
  std::vector<TimelinePlan> timelines;
  std::vector<Index> first_crop{0};
  Index frames = 0;  // of the longest timeline

  Index crops() const { return first_crop.back(); }
};

namespace detail {

/// Throws timeline_error 505 at a piece without a text.
void require_text(const Piece& piece);

/// Throws timeline_error 508 at a crop of more than `longest` frames (0: any number).
void check_crops(const TimelinePlan& plan, Index longest);

/// A plan with its pieces, which have no owners yet. Throws timeline_error 503 ... 505, 507, config_error 101.
TimelinePlan pieces_of(Timeline timeline, const PlanOptions& options);

/// Derives the plan from the owners of the pieces. Throws timeline_error 506, 508.
void finish_plan(TimelinePlan& plan, const PlanOptions& options);

}  // namespace detail

/// The plan of one timeline. `ties` decides between equal base texts: FirstWins, or a generator (see PlanOptions and
/// sinc_assignment.hpp).
/// Throws     timeline_error 503 (parts of another body), 504, 505 (gap), 506 (hidden text), 507, 508 (crop too long),
///            config_error 101
template <Shuffler G>
TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options, G& ties) {
  TimelinePlan plan = detail::pieces_of(std::move(timeline), options);
  for (const Piece& piece : plan.pieces) {
    detail::require_text(piece);
    plan.owners.push_back(assign_parts(plan.timeline, piece.intervals, ties));
  }
  detail::finish_plan(plan, options);
  return plan;
}
TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options = {});

/// Puts plans into one batch.
BatchPlan batch_plans(std::vector<TimelinePlan> plans);

/// Plans of all timelines, in order, with one generator.
template <Shuffler G>
BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options, G& ties) {
  std::vector<TimelinePlan> plans;
  for (const Timeline& t : timelines) plans.push_back(plan_timeline(t, options, ties));
  return batch_plans(std::move(plans));
}
BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options = {});

/// Smallest and largest number of additions minus subtractions over all parts and frames. Both are 1 in a plan that
/// extends and has transition crops, or does neither.
struct NetWeights {
  int smallest = 0, largest = 0;
};
NetWeights net_weights(const TimelinePlan& plan);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_PLAN_IPP  // <motionlang/compose/plan.ipp>
#define MOTIONLANG_HAS_COMPOSE_PLAN_IPP
// Bodies of plan.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string quoted(const Interval& i) { return concat_text("'", i.text, "' (", i.start, " to ", i.end, ")"); }

/// " (line 3, column 1)", nothing if the interval was not read from a text.
inline std::string place_of(const Interval& i) {
  return i.place.line == 0 ? "" : concat_text(" (line ", i.place.line, ", column ", i.place.column, ")");
}

inline void check_timeline(const Timeline& timeline) {
  if (timeline.intervals.empty()) raise<timeline_error>(507, "plan_timeline: no interval");
  for (const Interval& i : timeline.intervals) {
    if (i.start < 0 || i.end < i.start || i.end > latest_time) {
      raise<timeline_error>(504, "plan_timeline: ", quoted(i), " is not a range of frames of the motion");
    }
    if ((i.parts.bits & ~timeline.body.all().bits) != 0) {
      raise<timeline_error>(503, "plan_timeline: ", quoted(i), " moves other body parts than ", timeline.body);
    }
  }
  if (timeline.end() == 0) raise<timeline_error>(504, "plan_timeline: the timeline has no frame");
}

MOTIONLANG_BODY void require_text(const Piece& piece) {
  if (!piece.intervals.empty()) return;
  raise<timeline_error>(505, "plan_timeline: no text covers frames ", piece.start, " to ", piece.end);
}

/// Joins neighbouring pieces of a part that have the same owner.
inline void merge_pieces(TimelinePlan& plan) {
  const auto parts = static_cast<std::size_t>(plan.timeline.body.size());
  for (std::size_t p = 0; p < parts; ++p) {
    for (std::size_t k = 0; k < plan.pieces.size(); ++k) {
      const Piece& piece = plan.pieces[k];
      const Index owner = plan.owners[k][p];
      if (k > 0 && plan.owners[k - 1][p] == owner)
        plan.merged.back().range.end = piece.end;
      else
        plan.merged.push_back({static_cast<BodyPart>(p), owner, {piece.start, piece.end}});
    }
  }
}

/// The cuts at which a transition is made, ascending: all but the first and the last. Throws timeline_error 506 at one
/// where no part changes its owner, or leaves it out.
inline std::vector<Index> transition_cuts(const TimelinePlan& plan, HiddenTexts hidden) {
  std::vector<Index> cuts;
  for (std::size_t k = 1; k < plan.pieces.size(); ++k) {
    const Index cut = plan.pieces[k].start;
    if (plan.owners[k] != plan.owners[k - 1]) {
      cuts.push_back(cut);
    } else if (hidden == HiddenTexts::refuse) {
      for (const Interval& i : plan.timeline.intervals) {
        if (i.start != cut && i.end != cut) continue;
        raise<timeline_error>(506, "plan_timeline: ", quoted(i), " owns no body part at frame ", cut,
                              ": other texts hide it; give it parts that no text with fewer parts takes", place_of(i));
      }
    }
  }
  return cuts;
}

MOTIONLANG_BODY void check_crops(const TimelinePlan& plan, Index longest) {
  for (const Crop& c : plan.crops) {
    if (longest == 0 || c.range.size() <= longest) continue;
    raise<timeline_error>(508, "timeline: '", plan.text(c), "' needs a crop of ", counted(c.range.size(), "frame"),
                          " with its overlap; the denoiser accepts ", longest,
                          c.is_transition() ? ""
                                            : place_of(plan.timeline.intervals[static_cast<std::size_t>(c.interval)]) +
                                                  ". Divide it into shorter ones");
  }
}

inline void make_crops(TimelinePlan& plan, const std::vector<Index>& cuts, const Overlap& overlap,
                       const PlanOptions& options) {
  for (std::size_t i = 0; i < plan.timeline.intervals.size(); ++i) {
    const FrameRange range{plan.timeline.intervals[i].start, plan.timeline.intervals[i].end};
    plan.crops.push_back({static_cast<Index>(i), options.extend ? overlap.extend(range, plan.frames) : range});
  }
  if (options.transition_crops) {
    for (Index cut : cuts) plan.crops.push_back({-1, overlap.window(cut, plan.frames)});
  }
  check_crops(plan, options.longest_crop);
}

/// For each stretch of a part: its extended frames are added from the crop of its owner; where it starts, the window of
/// the transition, which both neighbours have added, is subtracted once.
inline void make_slices(TimelinePlan& plan, const std::vector<Index>& cuts, const Overlap& overlap,
                        const PlanOptions& options) {
  const auto texts = static_cast<Index>(plan.timeline.intervals.size());
  for (const PartInterval& m : plan.merged) {
    const FrameRange to = options.extend ? overlap.extend(m.range, plan.frames) : m.range;
    const Index begin = plan.crops[static_cast<std::size_t>(m.owner)].range.start;
    plan.add.push_back({m.part, m.owner, {to.start - begin, to.end - begin}, to});

    const auto cut = std::lower_bound(cuts.begin(), cuts.end(), m.range.start);
    if (cut == cuts.end() || *cut != m.range.start) continue;  // the beginning
    const Index transition = cut - cuts.begin();
    const FrameRange window = overlap.window(*cut, plan.frames);
    plan.lerp.push_back({m.part, transition, window});
    if (options.transition_crops) plan.subtract.push_back({m.part, texts + transition, {0, window.size()}, window});
  }
}

MOTIONLANG_BODY TimelinePlan pieces_of(Timeline timeline, const PlanOptions& options) {
  check_timeline(timeline);
  Overlap::of_frames(options.overlap);
  TimelinePlan plan;
  if (options.gaps == Gaps::fill) fill_gaps(timeline);
  plan.timeline = std::move(timeline);
  plan.frames = plan.timeline.end();
  plan.pieces = elementary_pieces(plan.timeline);
  const Index first = plan.pieces.empty() ? plan.frames : plan.pieces.front().start;
  if (first > 0) raise<timeline_error>(505, "plan_timeline: no text covers frames 0 to ", first);
  return plan;
}

MOTIONLANG_BODY void finish_plan(TimelinePlan& plan, const PlanOptions& options) {
  const Overlap overlap = Overlap::of_frames(options.overlap);
  merge_pieces(plan);
  const std::vector<Index> cuts = transition_cuts(plan, options.hidden);
  make_crops(plan, cuts, overlap, options);
  make_slices(plan, cuts, overlap, options);
}

}  // namespace detail

MOTIONLANG_BODY TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options) {
  FirstWins ties;
  return plan_timeline(std::move(timeline), options, ties);
}

MOTIONLANG_BODY BatchPlan batch_plans(std::vector<TimelinePlan> plans) {
  BatchPlan batch;
  batch.timelines = std::move(plans);
  for (const TimelinePlan& plan : batch.timelines) {
    batch.first_crop.push_back(batch.first_crop.back() + std::ssize(plan.crops));
    batch.frames = std::max(batch.frames, plan.frames);
  }
  return batch;
}

MOTIONLANG_BODY BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options) {
  FirstWins ties;
  return plan_timelines(timelines, options, ties);
}

MOTIONLANG_BODY NetWeights net_weights(const TimelinePlan& plan) {
  NetWeights net{std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  for (int p = 0; p < plan.timeline.body.size(); ++p) {
    std::vector<std::pair<Index, int>> steps{{0, 0}, {plan.frames, 0}};  // frame, change of the weight
    const auto count = [&](const std::vector<Slice>& slices, int weight) {
      for (const Slice& s : slices) {
        if (s.part != static_cast<BodyPart>(p)) continue;
        steps.emplace_back(s.to.start, weight), steps.emplace_back(s.to.end, -weight);
      }
    };
    count(plan.add, 1), count(plan.subtract, -1);
    detail::sort(steps, [](const auto& a, const auto& b) { return a < b; });
    int weight = 0;
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
      weight += steps[i].second;
      if (steps[i].first == steps[i + 1].first) continue;
      net = {std::min(net.smallest, weight), std::max(net.largest, weight)};
    }
  }
  return net;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// 1 in the columns of a part, else 0: (1, features).
template <Backend B>
Tensor<B, 2> part_mask(const FeatureLayout& layout, BodyPart part) {
  std::vector<typename B::scalar> mask(static_cast<std::size_t>(layout.size));
  for (const IndexRange& r : layout.ranges(part)) {
    for (Index i = r.begin; i < r.end; ++i) mask[static_cast<std::size_t>(i)] = 1;
  }
  return Tensor<B, 2>::from(mask, {1, layout.size});
}

}  // namespace detail

/// The crops of a batch as sequences, in batch order. Motions of the batch lie one after the other, `stride` rows each.
struct CropRows {
  std::vector<Index> rows;  // of the motions, for each row of the crops
  Offsets offsets;          // of the crops
  Index stride = 0;

  /// With crop_frames > 0 every crop has exactly that many frames, whatever follows its range (MDM); the motions need
  /// as many rows behind their end. A crop without frames has no rows.
  static CropRows of(const BatchPlan& plan, Index crop_frames = 0);
};

namespace detail {

/// Rows of crops that are added to rows of motions for one part, with 1 or -1 each.
struct PartMoves {
  std::vector<Index> from, to;
  std::vector<signed char> sign;
};
PartMoves moves_of_part(const BatchPlan& plan, const Offsets& crops, Index stride, BodyPart part);

/// Throws config_error 102 unless the layout gives each number to one body part of the body that the timelines have.
void check_layout(const FeatureLayout& layout, const BatchPlan& plan);

}  // namespace detail

/// Puts crops together: for each body part the additions of the plan, then its subtractions.
///     motion[to, part] = sum crops[from, part] - sum transitions[from, part]
/// Source  thesis 6.2.3, "Spatial (body-part) stitching", "Temporal stitching"; STMC src/stmc.py
///         combine_features_intervals
template <Backend B>
class Stitcher {
 public:
  Stitcher() = default;
  /// `crops`: offsets of the crops in batch order; `stride`: rows per motion. Throws config_error 102 for a layout that
  /// does not give each number to one body part, and for one of another body.
  Stitcher(const BatchPlan& plan, const FeatureLayout& layout, const Offsets& crops, Index stride)
      : rows_(static_cast<Index>(plan.timelines.size()) * stride), features_(layout.size) {
    detail::check_layout(layout, plan);
    for (int p = 0; p < layout.body.size(); ++p) {
      Part part;
      part.mask = detail::part_mask<B>(layout, static_cast<BodyPart>(p));
      auto moves = detail::moves_of_part(plan, crops, stride, static_cast<BodyPart>(p));
      const std::vector<typename B::scalar> sign(moves.sign.begin(), moves.sign.end());
      part.from = std::move(moves.from), part.to = std::move(moves.to);
      part.sign = Tensor<B, 2>::from(sign, {static_cast<Index>(sign.size()), 1});
      parts_.push_back(std::move(part));
    }
  }

  /// crops (rows of all crops, features) -> (motions * stride, features); rows that nothing is added to are 0.
  Tensor<B, 2> operator()(const Tensor<B, 2>& crops) const {
    auto motion = Tensor<B, 2>::zeros({rows_, features_});
    for (const Part& p : parts_)
      motion = std::move(motion) + scatter_add(gather(crops, p.from) * p.sign, p.to, rows_) * p.mask;
    return motion;
  }

 private:
  struct Part {
    std::vector<Index> from, to;
    Tensor<B, 2> sign, mask;  // (rows, 1), (1, features)
  };
  Index rows_ = 0, features_ = 0;
  std::vector<Part> parts_;
};

/// Softens hard cuts (the SINC+lerp baseline): in every window of the plan the part is interpolated
/// linearly between the values at the window's first and last frame.
///     w v_first + (1 - w) v_last,   w = linspace(1, 0, window)
/// All windows read the hard-cut motion; where they overlap the later one wins. Source: STMC src/stmc.py.
/// Throws config_error 102 for a layout that does not give each number to one body part, and for one of another body.
template <Backend B>
Tensor<B, 2> interpolate_transitions(const BatchPlan& plan, const FeatureLayout& layout, const Tensor<B, 2>& motion,
                                     Index stride) {
  using S = typename B::scalar;
  detail::check_layout(layout, plan);
  const auto read = motion.span();
  std::vector<S> out(read.begin(), read.end());
  const auto width = static_cast<std::size_t>(layout.size);
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    for (const LerpWindow& window : plan.timelines[m].lerp) {
      const auto first = m * static_cast<std::size_t>(stride) + static_cast<std::size_t>(window.range.start);
      const auto n = static_cast<std::size_t>(window.range.size());
      for (std::size_t i = 0; i < n; ++i) {
        const S w = n == 1 ? S(1) : S(1) - static_cast<S>(i) / static_cast<S>(n - 1);
        for (const IndexRange& r : layout.ranges(window.part)) {
          for (auto c = static_cast<std::size_t>(r.begin); c < static_cast<std::size_t>(r.end); ++c) {
            out[(first + i) * width + c] = w * read[first * width + c] + (S(1) - w) * read[(first + n - 1) * width + c];
          }
        }
      }
    }
  }
  return Tensor<B, 2>::from(out, motion.shape());
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_STITCHING_IPP  // <motionlang/compose/stitching.ipp>
#define MOTIONLANG_HAS_COMPOSE_STITCHING_IPP
// Bodies of stitching.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY CropRows CropRows::of(const BatchPlan& plan, Index crop_frames) {
  CropRows out;
  out.stride = plan.frames + crop_frames;
  std::vector<Index> lengths;
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    for (const Crop& c : plan.timelines[m].crops) {
      const Index n = crop_frames > 0 && c.range.size() > 0 ? crop_frames : c.range.size();
      for (Index i = 0; i < n; ++i) out.rows.push_back(static_cast<Index>(m) * out.stride + c.range.start + i);
      lengths.push_back(n);
    }
  }
  out.offsets = Offsets(lengths);
  return out;
}

namespace detail {

MOTIONLANG_BODY PartMoves moves_of_part(const BatchPlan& plan, const Offsets& crops, Index stride, BodyPart part) {
  PartMoves out;
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    auto take = [&](const std::vector<Slice>& slices, signed char sign) {
      for (const Slice& slice : slices) {
        if (slice.part != part) continue;
        const Index from = crops.begin(plan.first_crop[m] + slice.crop) + slice.from.start;
        for (Index i = 0; i < slice.to.size(); ++i) {
          out.from.push_back(from + i);
          out.to.push_back(static_cast<Index>(m) * stride + slice.to.start + i);
          out.sign.push_back(sign);
        }
      }
    };
    take(plan.timelines[m].add, 1);
    take(plan.timelines[m].subtract, -1);
  }
  return out;
}

MOTIONLANG_BODY void check_layout(const FeatureLayout& layout, const BatchPlan& plan) {
  layout.validate();
  for (const TimelinePlan& p : plan.timelines) {
    if (p.timeline.body == layout.body) continue;
    raise<config_error>(102, "FeatureLayout '", layout.name, "' is of a body of ", layout.body, "; the timeline's has ",
                        p.timeline.body);
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_GUIDANCE_HPP  // <motionlang/diffusion/guidance.hpp>
#define MOTIONLANG_HAS_DIFFUSION_GUIDANCE_HPP
/// Classifier-free guidance.

MOTIONLANG_NAMESPACE_BEGIN

///     guided = null + w (cond - null)
/// Source  Ho and Salimans (2022), eq. 6 in the form that all motion models use. Applied to whatever the network
///         predicts, before clipping, inpainting and stitching. With w = 1 the unconditional call can be left out.
template <Backend B, int R>
Tensor<B, R> guide(const Tensor<B, R>& cond, const Tensor<B, R>& null, double w) {
  return null + (cond - null) * w;
}
/// One weight per sample (leading index).
template <Backend B, int R>
Tensor<B, R> guide(const Tensor<B, R>& cond, const Tensor<B, R>& null, const Tensor<B, R>& w) {
  return null + (cond - null) * w;
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The results of one step, for those who want to see them. Rows are those of the crops, in batch order.
template <Backend B>
struct CollageStep {
  Tensor<B, 2> crops, cond, null, guided, x0;
};

namespace detail {

/// Jobs that go through the network together: sequences of frames, each with one or several texts.
struct JobBatch {
  std::vector<Index> rows;  // of x
  Offsets frames, uses;     // uses: the texts of each sequence
  std::vector<Index> texts;
};
struct JobBatches {
  std::vector<JobBatch> batches;
  std::vector<Index> cond, null;  // for every row of the crops its row of all batches, with its text and without
};
struct JobOptions {
  bool guided = true;
  bool divide = true;  // whether a sequence has the same result in any batch
  Index rows_at_once = 0;
};

/// texts: of every crop; null: the unconditional one.
JobBatches plan_jobs(const CropRows& crops, std::span<const Index> texts, Index null, const JobOptions& options);

/// For every crop its text as a number: equal texts have the same, "" that of the unconditional one.
std::vector<Index> texts_of_crops(const BatchPlan& plan, Index null);

/// Throws shape_error 204 unless there is a text for every interval, and one unconditional one.
void check_texts(const BatchPlan& plan, Index texts, Index nulls);

/// The rows of crops of fixed size without those behind their own frames.
CropRows own_frames(const BatchPlan& plan, Index stride, Index crop_frames);

Offsets joined(const Offsets& a, const Offsets& b);

}  // namespace detail

/// Source  thesis 6.2.3, figure 6.3 c; STMC (Petrovich et al. 2024) src/model/gaussian.py p_sample_stmc
/// Cost    one call of the network per step and `rows_at_once` frames: what the network holds at a time does not grow
///         with the timelines. Sequences of the same frames and the same text go through it once: both calls of
///         guidance of a crop whose text is "", and the unconditional calls of texts that begin and end together; what
///         a denoiser can compute for the frames of a crop whatever its text is computed once as well. The longest come
///         first, so that threads end together; crops without frames are left out. Texts, offsets and index lists are
///         prepared here, not in the loop.
template <Backend B, Denoiser<B> D>
class Collage {
 public:
  /// text: features of every interval of every timeline, in order; null: of "" (one). The denoiser must outlive the
  /// collage. rows_at_once: frames of a batch, more only if one crop has more; 0: any number. No result depends on it.
  /// Throws shape_error 204 if the number of texts is another, timeline_error 508 if a crop is too long for the
  /// denoiser, config_error 101 for a negative rows_at_once.
  Collage(const D& denoiser, BatchPlan plan, FeatureLayout layout, const TextFeatures<B>& text,
          const TextFeatures<B>& null, double guidance, Index rows_at_once = usual_rows_at_once)
      : denoiser_(&denoiser),
        plan_(std::move(plan)),
        layout_(std::move(layout)),
        texts_{
            {concat(0, text.tokens.rows, null.tokens.rows), detail::joined(text.tokens.offsets, null.tokens.offsets)},
            text.end_position,
            std::max(text.padded_tokens, null.padded_tokens)},
        guidance_(guidance),
        rows_at_once_(rows_at_once) {
    if (rows_at_once < 0) raise<config_error>(101, "Collage: ", rows_at_once, " rows at once");
    texts_.end_position.insert(texts_.end_position.end(), null.end_position.begin(), null.end_position.end());
    detail::check_texts(plan_, text.count(), null.count());
    prepare_step();
  }
  /// The same with some crops and slices of its plan only (compose/edits.hpp).
  Collage with_plan(BatchPlan plan) const {  // NOLINT(performance-unnecessary-value-param): it is moved from
    Collage out = *this;
    out.plan_ = std::move(plan);
    out.prepare_step();
    return out;
  }

  const BatchPlan& plan() const { return plan_; }
  const Offsets& crop_offsets() const { return crops_.offsets; }
  /// Rows of x per timeline, and of all timelines together.
  Index stride() const { return motion_.stride; }
  Index rows() const { return motion_.stride * static_cast<Index>(plan_.timelines.size()); }
  /// Rows that go through the network in a step, without tokens for time and text.
  Index batch_rows() const {
    Index rows = 0;
    for (const Batch& b : batches_) rows += repeat_lengths(b.frames, b.uses).rows();
    return rows;
  }

  /// True if a sequence has the same result in any batch of these texts.
  bool can_divide() const {
    const BatchMates mates = denoiser_->traits().mates;
    const Offsets& texts = texts_.tokens.offsets;
    return mates == BatchMates::none ||
           (mates == BatchMates::longest_text &&
            (texts_.padded_tokens >= texts.longest() || texts.rows() == texts.count() * texts.longest()));
  }

  /// x (rows, features) at network step t -> composite clean estimate. `to_x0` turns the network's output for the crops
  /// into x0 where it predicts something else: to_x0(output rows, crop rows).
  template <class F>
  CollageStep<B> step(const Tensor<B, 2>& x, Index t, F to_x0) const {
    CollageStep<B> s;
    s.crops = gather(x, crops_.rows);
    const auto out = denoised(x, t);
    s.cond = gather(out, cond_);
    s.null = guidance_ == 1 ? s.cond : gather(out, null_);
    s.guided = guidance_ == 1 ? s.cond : guide(s.cond, s.null, guidance_);
    s.x0 = stitch_(to_x0(s.guided, s.crops));
    return s;
  }
  CollageStep<B> step(const Tensor<B, 2>& x, Index t) const {
    return step(x, t, [](const Tensor<B, 2>& output, const Tensor<B, 2>&) { return output; });
  }
  /// Stitches any values of the crops.
  Tensor<B, 2> stitch(const Tensor<B, 2>& crops) const { return stitch_(crops); }

 private:
  /// Jobs that go through the network together: sequences of frames, each with one or several texts.
  struct Batch {
    std::vector<Index> rows;  // of x
    Offsets frames, uses;     // uses: the texts of each sequence
    decltype(encoded_text<B>(std::declval<const D&>(), TextFeatures<B>())) text;
  };

  void prepare_step() {
    const DenoiserTraits traits = denoiser_->traits();
    for (const TimelinePlan& p : plan_.timelines) detail::check_crops(p, traits.longest());
    const bool fixed = traits.crop_frames > 0;
    motion_ = CropRows::of(plan_, traits.crop_frames);
    // With a mask, a crop of fixed size shrinks to its own frames again: masked frames take no part.
    crops_ = fixed && traits.uses_lengths ? detail::own_frames(plan_, motion_.stride, traits.crop_frames) : motion_;
    stitch_ = Stitcher<B>(plan_, layout_, crops_.offsets, motion_.stride);
    build_batch();
  }

  /// The outputs of the network for all jobs, one after the other.
  Tensor<B, 2> denoised(const Tensor<B, 2>& x, Index t) const {
    const detail::RowsTogether in_any_batch(detail::RowsTogether::many);
    const auto of = [&](const Batch& b) {
      const PoolVector<Index> steps(static_cast<std::size_t>(b.uses.rows()), t);
      return denoise_with_texts(*denoiser_, Sequences<B>(gather(x, b.rows), b.frames), b.uses, steps, b.text).rows;
    };
    if (batches_.size() == 1) return of(batches_.front());
    PoolVector<Tensor<B, 2>> parts;
    parts.reserve(batches_.size());
    for (const Batch& b : batches_) parts.push_back(of(b));
    return concat(std::span<const Tensor<B, 2>>(parts), 0);
  }

  void build_batch() {
    const detail::RowsTogether in_any_batch(detail::RowsTogether::many);
    const Index null = texts_.count() - 1;
    auto jobs = detail::plan_jobs(crops_, detail::texts_of_crops(plan_, null), null,
                                  {.guided = guidance_ != 1, .divide = can_divide(), .rows_at_once = rows_at_once_});
    cond_ = std::move(jobs.cond), null_ = std::move(jobs.null);
    batches_.clear();
    for (detail::JobBatch& b : jobs.batches) {
      batches_.push_back({std::move(b.rows), std::move(b.frames), std::move(b.uses),
                          encoded_text<B>(*denoiser_, gather(texts_, b.texts))});
    }
  }

  const D* denoiser_;
  BatchPlan plan_;
  FeatureLayout layout_;
  TextFeatures<B> texts_;  // of all intervals, then the unconditional one
  double guidance_;
  Index rows_at_once_;
  CropRows motion_, crops_;
  Stitcher<B> stitch_;
  std::vector<Batch> batches_;
  std::vector<Index> cond_, null_;  // for every row of the crops its row of all batches, with its text and without
};

/// x0 of all timelines at index t of the process.
template <Backend B, Denoiser<B> D>
Tensor<B, 2> clean_motion(const Collage<B, D>& collage, const GaussianDiffusion& diffusion, Prediction prediction,
                          const Tensor<B, 2>& x, Index t) {
  const auto to_clean = [&](const Tensor<B, 2>& output, const Tensor<B, 2>& crops) {
    return to_x0(diffusion, prediction, output, crops, std::span<const Index>(&t, 1));
  };
  return collage.step(x, diffusion.network_t(t), to_clean).x0;
}

/// The whole reverse process with any clean_motion(x, t). noise(0) is the initial x, noise(1), noise(2), ... belong to
/// the steps; all of shape (rows, features).
/// -> clean motions (rows, features), normalised; rows behind a timeline's end mean nothing. `watch(t, step)` sees
/// every step. Throws `cancelled` if progress says so.
template <Backend B, class Clean, class Noise, class Watch = IgnoreSteps>
Tensor<B, 2> sample_clean_motions(const GaussianDiffusion& diffusion, const Clean& clean_motion, Noise&& noise,
                                  const SamplingOptions& options = {}, Progress progress = {},
                                  const Watch& watch = {}) {
  auto step_noise = [&](Index draw) { return noise(draw + 1); };
  const StepOptions step{.noise_scale = options.noise_scale, .clip = options.clip};
  if (options.sampler == SamplingOptions::Sampler::ddim) {
    return sample_ddim<B, 2>(diffusion, noise(0), clean_motion, step_noise, options.eta, step, detail::KeepX0{},
                             progress, watch);
  }
  return sample_ancestral<B, 2>(diffusion, noise(0), clean_motion, step_noise, step, detail::KeepX0{}, progress, -1,
                                watch);
}
template <Backend B, Denoiser<B> D, class Noise, class Watch = IgnoreSteps>
Tensor<B, 2> sample_collage(const Collage<B, D>& collage, const GaussianDiffusion& diffusion, Prediction prediction,
                            Noise&& noise, const SamplingOptions& options = {}, Progress progress = {},
                            const Watch& watch = {}) {
  const auto clean = [&](const Tensor<B, 2>& x, Index t) { return clean_motion(collage, diffusion, prediction, x, t); };
  return sample_clean_motions<B>(diffusion, clean, noise, options, progress, watch);
}

/// Every interval of a plan as a motion of its own, for text-to-motion without a timeline and for the SINC baselines.
/// With `frames` > 0 all of them have that many frames.
BatchPlan independent_plan(const BatchPlan& plan, Index frames = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_COLLAGE_IPP  // <motionlang/compose/collage.ipp>
#define MOTIONLANG_HAS_COMPOSE_COLLAGE_IPP
// Bodies of collage.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Frames of a crop with a text: what the network sees as one sequence.
struct CropJob {
  Index first, length, text;                         // first: row of the motions
  auto operator<=>(const CropJob&) const = default;  // NOLINT(modernize-use-nullptr): there is no 0
};

/// Where a sequence depends on the others: as published, all crops in their order, and then the same without their
/// texts.
inline JobBatches two_calls(const CropRows& crops, std::span<const Index> texts, Index null, bool guided) {
  JobBatches out;
  const Index rows = crops.offsets.rows();
  for (const bool with_text : {true, false}) {
    if (!with_text && !guided) break;
    std::vector<Index> lengths, which;
    for (Index i = 0; i < crops.offsets.count(); ++i) {
      if (crops.offsets.length(i) == 0) continue;
      lengths.push_back(crops.offsets.length(i));
      which.push_back(with_text ? texts[static_cast<std::size_t>(i)] : null);
    }
    const Offsets frames(lengths);
    out.batches.push_back({crops.rows, frames, Offsets::equal(frames.count(), 1), which});
    for (Index r = 0; r < rows; ++r) (with_text ? out.cond : out.null).push_back(with_text ? r : rows + r);
  }
  return out;
}

MOTIONLANG_BODY JobBatches plan_jobs(const CropRows& crops, std::span<const Index> texts, Index null,
                                     const JobOptions& options) {
  if (!options.divide) return two_calls(crops, texts, null, options.guided);
  std::vector<std::pair<CropJob, CropJob>> pairs;  // with its text, and without
  std::map<CropJob, Index> begin;                  // of all jobs, where their rows begin in the batch
  for (Index i = 0; const Index text : texts) {
    const Index length = crops.offsets.length(i);
    const Index first = length == 0 ? 0 : crops.rows[static_cast<std::size_t>(crops.offsets.begin(i))];
    pairs.push_back({{first, length, text}, {first, length, null}});
    ++i;
    if (length == 0) continue;
    begin[pairs.back().first];
    if (options.guided) begin[pairs.back().second];
  }
  std::vector<CropJob> jobs;
  jobs.reserve(begin.size());
  for (const auto& [job, at] : begin) jobs.push_back(job);
  sort(jobs, [](const CropJob& a, const CropJob& b) { return a.length != b.length ? a.length > b.length : a < b; });

  const Index most = options.rows_at_once > 0 ? options.rows_at_once : std::numeric_limits<Index>::max();
  JobBatches out;
  std::vector<Index> rows, lengths, uses, which;  // of the next batch
  Index results = 0, before = 0;                  // rows of its results, and of those of the batches so far
  const CropJob* last = nullptr;                  // of the batch
  const auto end_batch = [&] {
    out.batches.push_back({rows, Offsets(lengths), Offsets(uses), which});
    before += results;
    results = 0, last = nullptr;
    rows.clear(), lengths.clear(), uses.clear(), which.clear();
  };
  for (const CropJob& job : jobs) {
    if (last != nullptr && results + job.length > most) end_batch();
    begin[job] = before + results;
    results += job.length;
    which.push_back(job.text);
    if (last != nullptr && last->first == job.first && last->length == job.length) {
      ++uses.back();
    } else {
      for (Index r = 0; r < job.length; ++r) rows.push_back(job.first + r);
      lengths.push_back(job.length);
      uses.push_back(1);
    }
    last = &job;
  }
  end_batch();
  for (const auto& [with, without] : pairs) {
    for (Index r = 0; r < with.length; ++r) {
      out.cond.push_back(begin[with] + r);
      if (options.guided) out.null.push_back(begin[without] + r);
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<Index> texts_of_crops(const BatchPlan& plan, Index null) {
  std::vector<Index> out;
  std::map<std::string_view, Index> known{{"", null}};
  Index first = 0;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Crop& c : p.crops)
      out.push_back(c.is_transition() ? null : known.emplace(p.text(c), first + c.interval).first->second);
    first += static_cast<Index>(p.timeline.intervals.size());
  }
  return out;
}

MOTIONLANG_BODY void check_texts(const BatchPlan& plan, Index texts, Index nulls) {
  Index intervals = 0;
  for (const TimelinePlan& p : plan.timelines) intervals += static_cast<Index>(p.timeline.intervals.size());
  if (texts == intervals && nulls == 1) return;
  raise<shape_error>(204, "Collage: ", counted(texts, "text"), " for ", counted(intervals, "interval"), "; ",
                     counted(nulls, "unconditional text"));
}

MOTIONLANG_BODY CropRows own_frames(const BatchPlan& plan, Index stride, Index crop_frames) {
  CropRows out = CropRows::of(plan);
  for (Index& row : out.rows) {  // the same frames in motions with more rows
    const Index m = row / plan.frames;
    row += m * crop_frames;
  }
  out.stride = stride;
  return out;
}

MOTIONLANG_BODY Offsets joined(const Offsets& a, const Offsets& b) {
  std::vector<Index> lengths;
  for (const Offsets* o : {&a, &b}) {
    for (Index i = 0; i < o->count(); ++i) lengths.push_back(o->length(i));
  }
  return Offsets(lengths);
}

}  // namespace detail

MOTIONLANG_BODY BatchPlan independent_plan(const BatchPlan& plan, Index frames) {
  std::vector<TimelinePlan> alone;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Interval& i : p.timeline.intervals) {
      const BodyPartition& body = p.timeline.body;
      alone.push_back(plan_timeline({{{i.text, 0, frames > 0 ? frames : i.end - i.start, body.all()}}, body}));
    }
  }
  return batch_plans(std::move(alone));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_SYSTEMS_DETAIL_STMC_PARTS_HPP  // <motionlang/systems/detail/stmc_parts.hpp>
#define MOTIONLANG_HAS_SYSTEMS_DETAIL_STMC_PARTS_HPP
/// Parts of Stmc that do not depend on a backend.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The texts of a plan, each once; "" is the first one.
struct DifferentTexts {
  std::vector<std::string> texts{""};
  std::vector<Index> which;  // of every interval

  explicit DifferentTexts(const BatchPlan& plan);
};

/// SMPL RIFKE features as a motion that starts facing pi.
Motion published_motion(std::span<const double> features, double fps);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_SYSTEMS_DETAIL_STMC_PARTS_IPP  // <motionlang/systems/detail/stmc_parts.ipp>
#define MOTIONLANG_HAS_SYSTEMS_DETAIL_STMC_PARTS_IPP
// Bodies of stmc_parts.hpp.

#ifndef MOTIONLANG_HAS_FEATURES_SMPLRIFKE_HPP  // <motionlang/features/smplrifke.hpp>
#define MOTIONLANG_HAS_FEATURES_SMPLRIFKE_HPP
/// The 205-vector "smplrifke" of MDM-SMPL and STMC: forward, inverse, and from and to `Motion`. Index ranges of body
/// parts are in layout.hpp.
///
///     0        height of the pelvis above the lowest joint of the clip
///     1:3      its velocity x, y, seen from the body
///     3        turn of the heading to the next frame
///     4:136    22 rotations as 6D rows (rotation6d.hpp)
///     136:205  joints 1 ... 23 relative to the pelvis, seen from the body
/// World: Z up, metres, radians; velocities and turns per frame (the models use 20 frames per second).
/// Source   STMC (Petrovich et al. 2024), src/tools/smplrifke_feats.py

#ifndef MOTIONLANG_HAS_GEOMETRY_EULER_HPP  // <motionlang/geometry/euler.hpp>
#define MOTIONLANG_HAS_GEOMETRY_EULER_HPP
/// Euler angles in all twelve orders.
///
/// Intrinsic angles: order "ZXY" means R = Rz(a) Rx(b) Ry(c) on column vectors, the first letter outermost, which is
/// the order of BVH channels and of pytorch3d's conventions.

MOTIONLANG_NAMESPACE_BEGIN

/// Three axes, 0 = x, 1 = y, 2 = z; neighbours differ.
struct EulerOrder {
  std::array<int, 3> axis{2, 0, 1};

  /// From "XYZ", "ZXZ", ... Throws config_error 103.
  static EulerOrder parse(std::string_view letters) {
    EulerOrder o;
    bool ok = letters.size() == 3;
    for (std::size_t i = 0; ok && i < 3; ++i) {
      const char c = static_cast<char>(letters[i] | 0x20);
      o.axis[i] = c - 'x';
      ok = c >= 'x' && c <= 'z' && (i == 0 || o.axis[i] != o.axis[i - 1]);
    }
    if (!ok) raise<config_error>(103, "EulerOrder: '", letters, "' is not an order of rotation axes");
    return o;
  }
  bool operator==(const EulerOrder&) const = default;
};

/// Radians, in the order of the axes.
template <class S>
struct EulerAngles {
  S a{}, b{}, c{};
  EulerOrder order{};
};

/// Rotation about one coordinate axis (0, 1, 2).
template <class S>
Matrix3<S> axis_rotation(int axis, const S& angle) {
  const S c = cos(angle), s = sin(angle);
  Matrix3<S> m = Matrix3<S>::identity();
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  m(i, i) = c;
  m(j, j) = c;
  m(i, j) = -s;
  m(j, i) = s;
  return m;
}

template <class S>
Matrix3<S> to_matrix(const EulerAngles<S>& e) {
  return axis_rotation(e.order.axis[0], e.a) * axis_rotation(e.order.axis[1], e.b) *
         axis_rotation(e.order.axis[2], e.c);
}

/// The angles of a rotation. The middle one lies in [-pi/2, pi/2] for three different axes, in [0, pi] for a proper
/// order (ZXZ). Arc tangents only, so nothing needs clamping. Where the first and last axis coincide (gimbal lock,
/// within 1e-6) the last angle is `last` and the first takes up the rest.
template <class R>
requires Rotation<R>
auto to_euler(const R& rotation, EulerOrder order, double last = 0.0) {
  const auto& m = to_matrix(rotation);
  using S = std::remove_cvref_t<decltype(m.m[0])>;
  const int i = order.axis[0], j = order.axis[1], k = order.axis[2];
  const bool proper = i == k;
  const int l = proper ? 3 - i - j : k;
  const double sign = (j - i + 3) % 3 == 1 ? 1.0 : -1.0;  // of the permutation (i, j, l)
  const S plus = S(sign), lock = S(1e-6);
  EulerAngles<S> e{.order = order};
  // Product for three axes: m(i, k) = sign sin b, first angle from column k, last from row i. For a proper order: m(i,
  // i) = cos b.
  const S middle = proper ? m(i, i) : plus * m(i, k);
  const S other = proper ? sqrt(m(i, j) * m(i, j) + m(i, l) * m(i, l)) : sqrt(m(i, i) * m(i, i) + m(i, j) * m(i, j));
  e.b = proper ? atan2(other, middle) : atan2(middle, other);
  const S first = proper ? atan2(m(j, i), -(plus * m(l, i))) : atan2(-(plus * m(j, k)), m(k, k));
  const S third = proper ? atan2(m(i, j), plus * m(i, l)) : atan2(-(plus * m(i, j)), m(i, i));
  // Locked: with c given, column j of R Rk(-c) = Ri(a) Rj(b) is that of Ri(a) alone.
  const S c = S(last);
  const Vec3<S> column = m * axis_rotation(k, -c).column(j);
  const std::array<S, 3> turned{column.x, column.y, column.z};
  const S locked_first = atan2(plus * turned[static_cast<std::size_t>(l)], turned[static_cast<std::size_t>(j)]);
  e.a = where_less(other, lock, locked_first, first);
  e.c = where_less(other, lock, c, third);
  return e;
}
static_assert(Rotation<EulerAngles<double>>);

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_GEOMETRY_PYTORCH3D_HPP  // <motionlang/geometry/pytorch3d.hpp>
#define MOTIONLANG_HAS_GEOMETRY_PYTORCH3D_HPP
/// The rotation formulas that the published systems share (an old version of pytorch3d), for parity with their
/// features.
///
/// They differ from quaternion.hpp and axis_angle.hpp where those are more accurate: matrix_to_quaternion loses half of
/// the digits near 0 and near pi and is wrong at pi for axes of mixed signs; quaternion_to_axis_angle does not take the
/// shorter way round. Use them to reproduce published numbers, not otherwise.

#ifndef MOTIONLANG_HAS_GEOMETRY_ROTATION6D_HPP  // <motionlang/geometry/rotation6d.hpp>
#define MOTIONLANG_HAS_GEOMETRY_ROTATION6D_HPP
/// Six numbers for a rotation: two of the three rows, or two of the three columns, of its matrix.
///
/// Source   Zhou et al., "On the continuity of rotation representations in neural networks" (CVPR 2019), section B.
/// Two conventions are in use and must not be mixed, hence two types: ACTOR, TEMOS, TEACH, SINC and the 205-vector take
/// the first two ROWS, row by row; the 263-vector of HumanML3D takes the first two COLUMNS, column by column.

MOTIONLANG_NAMESPACE_BEGIN

template <class S>
struct Rotation6dRows {
  Vec3<S> a{}, b{};
};
template <class S>
struct Rotation6dColumns {
  Vec3<S> a{}, b{};
};

/// Gram-Schmidt: b1 = a / |a|, b2 = (b - (b1 . b) b1) normalised, b3 = b1 x b2; norms are floored at 1e-12.
template <class S>
Matrix3<S> to_matrix(const Rotation6dRows<S>& r) {
  const Vec3<S> b1 = normalized(r.a);
  const Vec3<S> b2 = normalized(r.b - dot(b1, r.b) * b1);
  return Matrix3<S>::from_rows(b1, b2, cross(b1, b2));
}
/// By cross products: x = a / |a|, z = x x b normalised, y = z x x. The same as Gram-Schmidt, up to rounding.
template <class S>
Matrix3<S> to_matrix(const Rotation6dColumns<S>& r) {
  const Vec3<S> x = normalized(r.a);
  const Vec3<S> z = normalized(cross(x, r.b));
  return Matrix3<S>::from_columns(x, cross(z, x), z);
}
template <Rotation R>
auto to_rotation6d_rows(const R& r) {
  const auto m = to_matrix(r);
  return Rotation6dRows<std::remove_cvref_t<decltype(m.m[0])>>{m.row(0), m.row(1)};
}
template <Rotation R>
auto to_rotation6d_columns(const R& r) {
  const auto m = to_matrix(r);
  return Rotation6dColumns<std::remove_cvref_t<decltype(m.m[0])>>{m.column(0), m.column(1)};
}
static_assert(Rotation<Rotation6dRows<double>> && Rotation<Rotation6dColumns<double>>);

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace pytorch3d {

/// w = sqrt(max(0, 1 + m00 + m11 + m22)) / 2, ...; signs of x, y, z are those of the antisymmetric part (0 counts as
/// +).
template <class S>
Quaternion<S> matrix_to_quaternion(const Matrix3<S>& m) {
  const S zero = S(0), one = S(1);
  auto half_root = [&](const S& s) { return S(0.5) * sqrt(where_less(s, zero, zero, s)); };
  auto with_sign = [&](const S& size, const S& sign) { return where_less(sign, zero, -size, size); };
  return {half_root(one + m(0, 0) + m(1, 1) + m(2, 2)),
          with_sign(half_root(one + m(0, 0) - m(1, 1) - m(2, 2)), m(2, 1) - m(1, 2)),
          with_sign(half_root(one - m(0, 0) + m(1, 1) - m(2, 2)), m(0, 2) - m(2, 0)),
          with_sign(half_root(one - m(0, 0) - m(1, 1) + m(2, 2)), m(1, 0) - m(0, 1))};
}

/// v = (x, y, z) / (sin(h) / 2h), h = atan2(|(x, y, z)|, w); the divisor is 1/2 - (2h)^2/48 for |2h| < 1e-6.
template <class S>
Vec3<S> quaternion_to_axis_angle(const Quaternion<S>& q) {
  const S h = atan2(norm(q.vec()), q.w), angle = S(2) * h, size = where_less(angle, S(0), -angle, angle),
          small = S(1e-6);
  const S safe = where_less(size, small, S(1), angle);
  const S divisor = where_less(size, small, S(0.5) - angle * angle / S(48), sin(h) / safe);
  return {q.x / divisor, q.y / divisor, q.z / divisor};
}
template <class S>
Vec3<S> matrix_to_axis_angle(const Matrix3<S>& m) {
  return quaternion_to_axis_angle(matrix_to_quaternion(m));
}
/// The body models' formula: angle = |v + 1e-8|, axis = v / angle, R = I + sin K + (1 - cos) K^2.
template <class S>
Matrix3<S> rodrigues(const Vec3<S>& v) {
  const S e = S(1e-8), angle = norm(v + Vec3<S>{e, e, e}), s = sin(angle), c = S(1) - cos(angle);
  const Vec3<S> a{v.x / angle, v.y / angle, v.z / angle};
  const Matrix3<S> k{{S(0), -a.z, a.y, a.z, S(0), -a.x, -a.y, a.x, S(0)}}, kk = k * k;
  Matrix3<S> r = Matrix3<S>::identity();
  for (std::size_t i = 0; i < 9; ++i) r.m[i] = r.m[i] + s * k.m[i] + c * kk.m[i];
  return r;
}

}  // namespace pytorch3d
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_KNOWN_SKELETONS_HPP  // <motionlang/kinematics/known_skeletons.hpp>
#define MOTIONLANG_HAS_KINEMATICS_KNOWN_SKELETONS_HPP
/// The skeletons of the field: names, order and parents as published; the bone lengths are those of a neutral figure of
/// our own (1.75 m), so that no licensed body model is needed. Rest pose: standing, arms to the sides, Y up, facing +Z,
/// left at +X, metres.

MOTIONLANG_NAMESPACE_BEGIN

/// SMPL, 24 joints. Source: Loper et al. 2015; names as in the smplx package.
const Skeleton& smpl24_skeleton();

/// HumanML3D, 22 joints: SMPL without the hands.
const Skeleton& humanml3d22_skeleton();

/// KIT Motion-Language, 21 joints of the Master Motor Map. Here in metres; the coordinates of the data set have other
/// units.
const Skeleton& kit21_skeleton();

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_KNOWN_SKELETONS_IPP  // <motionlang/kinematics/known_skeletons.ipp>
#define MOTIONLANG_HAS_KINEMATICS_KNOWN_SKELETONS_IPP
// Bodies of known_skeletons.hpp.

MOTIONLANG_NAMESPACE_BEGIN

// clang-format off
MOTIONLANG_BODY const Skeleton& smpl24_skeleton() {
  static const Skeleton skeleton = Skeleton::from_joints({
      {"pelvis", "", {0, 0.95, 0}},
      {"left_hip", "pelvis", {0.09, -0.06, 0}},        {"right_hip", "pelvis", {-0.09, -0.06, 0}},
      {"spine1", "pelvis", {0, 0.11, 0}},
      {"left_knee", "left_hip", {0, -0.41, 0}},        {"right_knee", "right_hip", {0, -0.41, 0}},
      {"spine2", "spine1", {0, 0.13, 0}},
      {"left_ankle", "left_knee", {0, -0.41, 0}},      {"right_ankle", "right_knee", {0, -0.41, 0}},
      {"spine3", "spine2", {0, 0.06, 0}},
      {"left_foot", "left_ankle", {0, -0.06, 0.14}},   {"right_foot", "right_ankle", {0, -0.06, 0.14}},
      {"neck", "spine3", {0, 0.22, 0}},
      {"left_collar", "spine3", {0.07, 0.13, 0}},      {"right_collar", "spine3", {-0.07, 0.13, 0}},
      {"head", "neck", {0, 0.10, 0.02}},
      {"left_shoulder", "left_collar", {0.11, 0.03, 0}},  {"right_shoulder", "right_collar", {-0.11, 0.03, 0}},
      {"left_elbow", "left_shoulder", {0.27, 0, 0}},   {"right_elbow", "right_shoulder", {-0.27, 0, 0}},
      {"left_wrist", "left_elbow", {0.25, 0, 0}},      {"right_wrist", "right_elbow", {-0.25, 0, 0}},
      {"left_hand", "left_wrist", {0.08, 0, 0}},       {"right_hand", "right_wrist", {-0.08, 0, 0}},
  });
  return skeleton;
}

MOTIONLANG_BODY const Skeleton& humanml3d22_skeleton() {
  static const Skeleton skeleton = [] {
    Skeleton s = smpl24_skeleton();
    s.names.resize(22), s.parents.resize(22), s.offsets.resize(22);
    return s;
  }();
  return skeleton;
}

MOTIONLANG_BODY const Skeleton& kit21_skeleton() {
  static const Skeleton skeleton = Skeleton::from_joints({
      {"root", "", {0, 0.95, 0}},
      {"BP", "root", {0, 0.11, 0}},     {"BT", "BP", {0, 0.19, 0}},     {"BLN", "BT", {0, 0.22, 0}},      {"BUN", "BLN", {0, 0.10, 0}},
      {"LS", "BLN", {0.18, -0.06, 0}},  {"LE", "LS", {0.27, 0, 0}},     {"LW", "LE", {0.25, 0, 0}},
      {"RS", "BLN", {-0.18, -0.06, 0}}, {"RE", "RS", {-0.27, 0, 0}},    {"RW", "RE", {-0.25, 0, 0}},
      {"LH", "root", {0.09, -0.06, 0}}, {"LK", "LH", {0, -0.41, 0}},    {"LA", "LK", {0, -0.41, 0}},
      {"LMrot", "LA", {0, -0.06, 0.04}},{"LF", "LMrot", {0, 0, 0.10}},
      {"RH", "root", {-0.09, -0.06, 0}},{"RK", "RH", {0, -0.41, 0}},    {"RA", "RK", {0, -0.41, 0}},
      {"RMrot", "RA", {0, -0.06, 0.04}},{"RF", "RMrot", {0, 0, 0.10}},
  });
  return skeleton;
}
// clang-format on

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

inline constexpr Index smplrifke_size = 205, smplrifke_rotations = 22, smplrifke_joints = 24;

struct SmplRifkeOptions {
  double first_angle = 0;  // heading of the first frame; every published generation takes pi
  bool clamp_asin = true;  // false: as published, where rounding beyond [-1, 1] gives NaN
};

/// A clip in the features' own world (Z up).
template <Scalar S>
struct SmplRifkeMotion {
  std::vector<Vec3<S>> joints;        // (frames, 24)
  std::vector<Vec3<S>> trans;         // (frames): the pelvis
  std::vector<Matrix3<S>> rotations;  // (frames, 22), local; joint 0 in the world

  /// Rotation vectors (frames, 66) by the published formulas (geometry/pytorch3d.hpp), noisy near 0 in float.
  std::vector<S> poses() const {
    std::vector<S> out;
    for (const Matrix3<S>& r : rotations) {
      const Vec3<S> v = pytorch3d::matrix_to_axis_angle(r);
      out.insert(out.end(), {v.x, v.y, v.z});
    }
    return out;
  }
};

namespace detail {

/// R = Rz Ry Rx:  z = atan2(m10, m00), y = asin(-m20), x = atan2(m21, m22).
template <Scalar S>
struct EulerZyx {
  S z, y, x;
};
template <Scalar S>
EulerZyx<S> zyx_angles(const Matrix3<S>& m, bool clamp) {
  const S sine = -m(2, 0), limited = clamp ? std::clamp(sine, S(-1), S(1)) : sine;
  return {std::atan2(m(1, 0), m(0, 0)), std::asin(limited), std::atan2(m(2, 1), m(2, 2))};
}
/// The rotation without its heading.
template <Scalar S>
Matrix3<S> level(const EulerZyx<S>& angles) {
  return axis_rotation(1, angles.y) * axis_rotation(0, angles.x);
}
/// x and y turned by `angle` about Z.
template <Scalar S>
Vec3<S> turn_about_z(const Vec3<S>& v, S angle) {
  const S c = std::cos(angle), s = std::sin(angle);
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}
/// The same angle in [-pi, pi].
template <Scalar S>
S wrapped(S angle) {
  return std::atan2(std::sin(angle), std::cos(angle));
}
/// Differences to the next frame; the last one continues its two predecessors in a line. Of two frames: the same again;
/// of one: zero (the published code fails there).
template <class T, class Difference>
std::vector<T> to_next(std::size_t frames, Difference difference) {
  std::vector<T> d(frames);
  for (std::size_t i = 0; i + 1 < frames; ++i) d[i] = difference(i);
  if (frames >= 3) d[frames - 1] = d[frames - 2] + (d[frames - 2] - d[frames - 3]);
  if (frames == 2) d[1] = d[0];
  return d;
}

}  // namespace detail

/// rotations  (frames, 22), local; joint 0 in the world
/// joints     (frames, 24), world
/// result     (frames, 205)
/// Throws     shape_error 205 if the sizes do not fit
template <Scalar S>
std::vector<S> smplrifke_features(std::span<const Matrix3<S>> rotations, std::span<const Vec3<S>> joints) {
  const std::size_t frames = joints.size() / smplrifke_joints;
  if (joints.size() != frames * smplrifke_joints || rotations.size() != frames * smplrifke_rotations) {
    raise<shape_error>(205, "smplrifke_features: ", joints.size(), " joints and ", rotations.size(),
                       " rotations; expected 24 and 22 for every frame");
  }
  auto pelvis = [&](std::size_t f) -> const Vec3<S>& { return joints[f * smplrifke_joints]; };
  S floor = frames == 0 ? S(0) : joints[0].z;
  for (const Vec3<S>& p : joints) floor = std::min(floor, p.z);
  std::vector<detail::EulerZyx<S>> angles(frames);
  for (std::size_t f = 0; f < frames; ++f) angles[f] = detail::zyx_angles(rotations[f * smplrifke_rotations], true);
  const auto velocity = detail::to_next<Vec3<S>>(frames, [&](std::size_t f) { return pelvis(f + 1) - pelvis(f); });
  const auto turn =
      detail::to_next<S>(frames, [&](std::size_t f) { return detail::wrapped(angles[f + 1].z - angles[f].z); });

  std::vector<S> out;
  out.reserve(frames * smplrifke_size);
  auto put = [&](const Vec3<S>& v) { out.insert(out.end(), {v.x, v.y, v.z}); };
  for (std::size_t f = 0; f < frames; ++f) {
    const S heading = angles[f].z;
    const Vec3<S> speed = detail::turn_about_z(velocity[f], -heading);
    out.insert(out.end(), {pelvis(f).z - floor, speed.x, speed.y, detail::wrapped(turn[f])});
    for (std::size_t j = 0; j < smplrifke_rotations; ++j) {
      const auto r = j == 0 ? detail::level(angles[f]) : rotations[f * smplrifke_rotations + j];
      put(r.row(0));
      put(r.row(1));
    }
    for (std::size_t j = 1; j < smplrifke_joints; ++j) {
      put(detail::turn_about_z(joints[f * smplrifke_joints + j] - pelvis(f), -heading));
    }
  }
  return out;
}

/// The same from rotation vectors (frames, 66) and joints (frames, 72).
template <Scalar S>
std::vector<S> smplrifke_from_poses(std::span<const S> poses, std::span<const S> joints) {
  if (poses.size() % 3 != 0 || joints.size() % 3 != 0) {
    raise<shape_error>(205, "smplrifke_from_poses: ", poses.size(), " and ", joints.size(), " values");
  }
  std::vector<Matrix3<S>> rotations;
  std::vector<Vec3<S>> points;
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    rotations.push_back(to_matrix(AxisAngle<S>{{poses[i], poses[i + 1], poses[i + 2]}}));
  }
  for (std::size_t i = 0; i < joints.size(); i += 3) points.push_back({joints[i], joints[i + 1], joints[i + 2]});
  return smplrifke_features(std::span<const Matrix3<S>>(rotations), std::span<const Vec3<S>>(points));
}

/// features  (frames, 205)
/// The path starts at x = y = 0 with the heading `first_angle`; the velocity and turn of the last frame are not used,
/// nor is what heading the first rotation contains.
/// Throws    shape_error 205 if the size is not a multiple of 205
template <Scalar S>
SmplRifkeMotion<S> smplrifke_inverse(std::span<const S> features, const SmplRifkeOptions& options = {}) {
  if (features.size() % smplrifke_size != 0) {
    raise<shape_error>(205, "smplrifke_inverse: ", features.size(), " values are not rows of ", smplrifke_size);
  }
  const std::size_t frames = features.size() / smplrifke_size;
  SmplRifkeMotion<S> out;
  S heading = S(options.first_angle);
  Vec3<S> position{};
  for (std::size_t f = 0; f < frames; ++f) {
    const auto row = features.subspan(f * smplrifke_size, smplrifke_size);
    auto vector = [&](std::size_t at) { return Vec3<S>{row[at], row[at + 1], row[at + 2]}; };
    position.z = row[0];
    out.trans.push_back(position);
    for (std::size_t j = 0; j < smplrifke_rotations; ++j) {
      const auto r = to_matrix(Rotation6dRows<S>{vector(4 + 6 * j), vector(7 + 6 * j)});
      const auto own =
          j == 0 ? axis_rotation(2, heading) * detail::level(detail::zyx_angles(r, options.clamp_asin)) : r;
      out.rotations.push_back(own);
    }
    out.joints.push_back(position);
    for (std::size_t j = 1; j < smplrifke_joints; ++j) {
      out.joints.push_back(detail::turn_about_z(vector(133 + 3 * j), heading) + position);
    }
    position = position + detail::turn_about_z(Vec3<S>{row[1], row[2], S(0)}, heading);
    heading = heading + row[3];
  }
  return out;
}

/// The features of a clip on SMPL's 24 joints, with the bones that its skeleton has; the hands' own rotations are lost.
/// Resample to the rate of the model first. Throws config_error 103 if the joints are not SMPL's.
std::vector<double> smplrifke_from_motion(const Motion& motion);

/// The clip that the features describe, Y up, on a skeleton with SMPL's 24 joints: rotations and the path are taken,
/// positions of joints are not, so bones keep their lengths. With first_angle 0 the first frame faces +Z, up to what
/// the pelvis itself turns. Throws shape_error 205, config_error 103 if the joints are not SMPL's.
template <Scalar S>
Motion smplrifke_to_motion(std::span<const S> features, const SmplRifkeOptions& options = {}, double fps = 20,
                           const Skeleton& skeleton = smpl24_skeleton()) {
  if (skeleton.names != smpl24_skeleton().names) {
    raise<config_error>(103, "smplrifke_to_motion: the ", skeleton.size(), " joints are not the 24 of SMPL");
  }
  const auto from = smplrifke_inverse(features, options);
  const auto y_up = axis_rotation(0, -std::numbers::pi / 2);
  Motion out;
  out.skeleton = skeleton;
  out.fps = fps;
  for (std::size_t f = 0; f < from.trans.size(); ++f) {
    const auto p = vec_cast<double>(from.trans[f]);
    out.root.push_back({p.x, p.z, -p.y});
    for (std::size_t j = 0; j < smplrifke_rotations; ++j) {
      const auto r = matrix_cast<double>(from.rotations[f * smplrifke_rotations + j]);
      out.local.push_back(to_quaternion(j == 0 ? y_up * r : r));
    }
    out.local.insert(out.local.end(), 2, Quaternion<double>::identity());  // hands
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FEATURES_SMPLRIFKE_IPP  // <motionlang/features/smplrifke.ipp>
#define MOTIONLANG_HAS_FEATURES_SMPLRIFKE_IPP
// Bodies of smplrifke.hpp.

#ifndef MOTIONLANG_HAS_GEOMETRY_SO3_HPP  // <motionlang/geometry/so3.hpp>
#define MOTIONLANG_HAS_GEOMETRY_SO3_HPP
/// Operations of every rotation, whatever its representation: the API deduced from `to_matrix`.

MOTIONLANG_NAMESPACE_BEGIN

/// a after b: the matrix A B.
template <Rotation A, Rotation B>
auto compose(const A& a, const B& b) {
  return to_matrix(a) * to_matrix(b);
}
template <Rotation R>
auto inverse(const R& r) {
  return transpose(to_matrix(r));
}
template <Rotation R, class S>
Vec3<S> rotate(const R& r, const Vec3<S>& v) {
  return to_matrix(r) * v;
}

/// Exponential: rotation vector to matrix (Rodrigues).
///     R = I + (sin t / t) K + ((1 - cos t) / t^2) K^2,   K = hat(v), t = |v|; series below t = 1e-2
template <class S>
Matrix3<S> exp_so3(const Vec3<S>& v) {
  const S t2 = dot(v, v), small = S(1e-4);
  const S safe = where_less(t2, small, small, t2), t = sqrt(safe);
  const S a = where_less(t2, small, S(1) - t2 * (S(1.0 / 6) - t2 * S(1.0 / 120)), sin(t) / t);
  const S b = where_less(t2, small, S(0.5) - t2 * (S(1.0 / 24) - t2 * S(1.0 / 720)), (S(1) - cos(t)) / safe);
  const S xy = b * v.x * v.y, xz = b * v.x * v.z, yz = b * v.y * v.z;
  const S xx = b * v.x * v.x, yy = b * v.y * v.y, zz = b * v.z * v.z;
  return {{S(1) - yy - zz, xy - a * v.z, xz + a * v.y,  //
           xy + a * v.z, S(1) - xx - zz, yz - a * v.x,  //
           xz - a * v.y, yz + a * v.x, S(1) - xx - yy}};
}
/// Logarithm: the shortest rotation vector. The inverse of exp_so3 for |v| <= pi (at pi up to the sign of the axis).
template <Rotation R>
auto log_so3(const R& r) {
  return to_axis_angle(r).v;
}

/// Angle between two rotations, radians in [0, pi]. Its slope is taken as 0 where they are equal.
template <Rotation A, Rotation B>
auto distance(const A& a, const B& b) {
  const auto q = to_quaternion(transpose(to_matrix(a)) * to_matrix(b));
  using S = std::remove_cvref_t<decltype(q.w)>;
  return S(2) * atan2(norm_or_zero(q.vec()), where_less(q.w, S(0), -q.w, q.w));
}

/// The shortest rotation that turns direction `from` into direction `to`. For opposite directions: half a turn about
/// some orthogonal axis, and so up to 1.5e-6 rad from them.
template <class S>
Quaternion<S> rotation_between(const Vec3<S>& from, const Vec3<S>& to) {
  const Vec3<S> a = normalized(from), sum = a + normalized(to), c = cross(a, sum);
  const S w = S(0.5) * dot(sum, sum), ax = where_less(a.x, S(0), -a.x, a.x), limit = S(0.6);
  // an axis orthogonal to a: cross with x or with y, whichever is farther from a
  const Vec3<S> with_x = cross(a, Vec3<S>{S(1), S(0), S(0)}), with_y = cross(a, Vec3<S>{S(0), S(1), S(0)});
  auto pick = [&](const S& near, const S& far) { return where_less(ax, limit, near, far); };
  const Vec3<S> any{pick(with_x.x, with_y.x), pick(with_x.y, with_y.y), pick(with_x.z, with_y.z)};
  const S tiny = S(1e-12);
  return normalized(Quaternion<S>{where_less(w, tiny, S(0), w), where_less(w, tiny, any.x, c.x),
                                  where_less(w, tiny, any.y, c.y), where_less(w, tiny, any.z, c.z)});
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<double> smplrifke_from_motion(const Motion& motion) {
  if (motion.skeleton.names != smpl24_skeleton().names || motion.skeleton.parents != smpl24_skeleton().parents) {
    raise<config_error>(103, "smplrifke_from_motion: the ", motion.skeleton.size(), " joints of '", motion.name,
                        "' are not the 24 of SMPL; retarget first");
  }
  const auto z_up = axis_rotation(0, std::numbers::pi / 2);  // (x, y, z) -> (x, -z, y)
  std::vector<Matrix3<double>> rotations;
  std::vector<Vec3<double>> joints;
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); ++f) {
    motion.world(f, world);
    for (const Vec3<double>& p : world.position) joints.push_back({p.x, -p.z, p.y});
    rotations.push_back(z_up * world.rotation[0]);
    for (const auto& q : motion.rotations(f).subspan(1, smplrifke_rotations - 1)) rotations.push_back(to_matrix(q));
  }
  return smplrifke_features(std::span<const Matrix3<double>>(rotations), std::span<const Vec3<double>>(joints));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY DifferentTexts::DifferentTexts(const BatchPlan& plan) {
  std::map<std::string_view, Index> known{{"", 0}};
  for (const TimelinePlan& p : plan.timelines) {
    for (const Interval& i : p.timeline.intervals) {
      const auto [place, is_new] = known.emplace(i.text, std::ssize(texts));
      if (is_new) texts.push_back(i.text);
      which.push_back(place->second);
    }
  }
}

MOTIONLANG_BODY Motion published_motion(std::span<const double> features, double fps) {
  return smplrifke_to_motion<double>(features, {.first_angle = std::numbers::pi}, fps);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <class T>
struct StmcBodies {};

}  // namespace detail

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate(std::span<const Timeline> timelines, const Philox& rng,
                                                  const StmcOptions& options) const {
  return generate_from(
      timelines, [&](Index draw, const Shape& shape) { return noise(rng, draw, shape); }, options);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Tensor<B, 2> Stmc<B, D, E>::generate(const Timeline& timeline, const Philox& rng, const StmcOptions& options) const {
  return generate(std::span(&timeline, 1), rng, options).front();
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
PlanOptions Stmc<B, D, E>::plan_options(const StmcOptions& options) const {
  return {.overlap = options.overlap,
          .gaps = options.gaps,
          .hidden = options.hidden,
          .longest_crop = denoiser.traits().longest()};
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
template <class Noise, bool>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                                       const StmcOptions& options) const {
  return generate_from(
      timelines, noise, options,
      [](const auto& collage, const auto& whole, const Tensor<B, 2>& x, Index t) { return whole(collage, x, t); });
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
template <class Noise, class Estimate, bool>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                                       const StmcOptions& options, Estimate&& estimate) const {
  return generate_from(plan_timelines(timelines, plan_options(options)), noise, options, estimate);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
template <class Noise, class Estimate, bool>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate_from(BatchPlan plan, Noise&& noise, const StmcOptions& options,
                                                       Estimate&& estimate) const {
  return separate(sample(plan, noise, options, estimate), plan);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
template <class Noise, class Estimate, bool>
CleanMotions<B> Stmc<B, D, E>::sample(BatchPlan plan, Noise&& noise, const StmcOptions& options,
                                      Estimate&& estimate) const {
  const auto [text, null] = encode(plan);
  const Collage<B, D> collage(denoiser, std::move(plan), layout, text, null, options.guidance.value_or(guidance),
                              options.rows_at_once);
  const auto sequences = static_cast<Index>(collage.plan().timelines.size());
  const Shape shape{sequences, collage.stride(), layout.size};
  auto rows = [&](Index draw) {
    const Tensor<B, 3> z = noise(draw, shape);
    if (z.shape() != shape) raise<shape_error>(204, "Stmc: noise ", z.shape(), " where ", shape, " is needed");
    return reshape<2>(z, {sequences * collage.stride(), layout.size});
  };
  const GaussianDiffusion kept = process(options.steps);
  const auto whole = [&](const Collage<B, D>& c, const Tensor<B, 2>& x, Index t) {
    return clean_motion(c, kept, denoiser.traits().prediction, x, t);
  };
  auto x0 = sample_clean_motions<B>(
      kept, [&](const Tensor<B, 2>& x, Index t) { return estimate(collage, whole, x, t); }, rows,
      options.sampling.value_or(sampling), options.progress);
  return {std::move(x0), collage.stride()};
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::separate(const CleanMotions<B>& clean, const BatchPlan& plan) const {
  std::vector<Tensor<B, 2>> out;
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    const Index first = static_cast<Index>(m) * clean.stride;
    out.push_back(motion_normalizer.denormalize(slice(clean.rows, 0, first, first + plan.timelines[m].frames)));
  }
  return out;
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Tensor<B, 3> Stmc<B, D, E>::noise(const Philox& rng, Index draw, const Shape& shape) const {
  return sequence_noise<B>(rng, draw, shape);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
GaussianDiffusion Stmc<B, D, E>::process(std::optional<Index> wanted) const {
  return with_steps(diffusion, wanted.value_or(steps));
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
auto Stmc<B, D, E>::encode(const BatchPlan& plan) const -> PlanTexts {
  const detail::DifferentTexts different(plan);
  const detail::RowsTogether beside_any_others(detail::RowsTogether::few);
  auto features = text_encoder.template encode<B>(std::span<const std::string>(different.texts));
  features.tokens.rows = text_normalizer.normalize(features.tokens.rows);
  if (denoiser.traits().empty_text_is_null) {
    std::vector<typename B::scalar> keep(static_cast<std::size_t>(features.tokens.rows.size(0)), 1);
    std::fill_n(keep.begin(), features.tokens.offsets.length(0), typename B::scalar{0});
    features.tokens.rows = features.tokens.rows * Tensor<B, 2>::from(keep, {std::ssize(keep), 1});
  }
  return {gather(features, different.which), gather(features, std::vector<Index>{0})};
}

template <Backend B>
Motion stmc_motion(const Tensor<B, 2>& features, double fps) {
  const std::vector<double> values(features.span().begin(), features.span().end());
  return detail::published_motion(values, fps);
}

/// The same model over another backend, with copies of all numbers.
template <Backend To, Backend From, template <class> class D, template <class> class E>
Stmc<To, D<To>, E<To>> convert_stmc(const Stmc<From, D<From>, E<From>>& m) {
  return {.denoiser = convert<To>(m.denoiser),
          .text_encoder = convert<To>(m.text_encoder),
          .motion_normalizer = convert<To>(m.motion_normalizer),
          .text_normalizer = convert<To>(m.text_normalizer),
          .diffusion = m.diffusion,
          .layout = m.layout,
          .guidance = m.guidance,
          .sampling = m.sampling,
          .steps = m.steps,
          .fps = m.fps};
}

/// Weights packed for inference. The model must not be changed afterwards.
template <Backend B, class D, class E>
void prepare(Stmc<B, D, E>& stmc) {
  prepare(stmc.denoiser);
  if constexpr (Module<E>) prepare(stmc.text_encoder);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// One motion for each timeline. The noise of each depends on the seed and on its place in the list.
/// Throws  timeline_error 504 ... 508 for timelines that the model cannot make; option_error 101 for kept frames
///         outside of the motion, 102 for options that contradict each other, 105 for more steps than the model has;
///         config_error 102, 103, 107 and io_error 401 ... 407 for files of noise and records; `cancelled`
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Motion> generate_motions(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                                     const GenerateOptions& options = {});
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Motion generate_motion(const Stmc<B, D, E>& stmc, const Timeline& timeline, const GenerateOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_GENERATE_GENERATE_MOTION_IPP  // <motionlang/generate/generate_motion.ipp>
#define MOTIONLANG_HAS_GENERATE_GENERATE_MOTION_IPP
// Bodies of the templates of generate_motion.hpp, for every backend, denoiser and text encoder. Any header may include
// them.

#ifndef MOTIONLANG_HAS_COMPOSE_CUT_TEXTS_HPP  // <motionlang/compose/cut_texts.hpp>
#define MOTIONLANG_HAS_COMPOSE_CUT_TEXTS_HPP
/// Texts cut where a denoiser does them best in parts: where their action is over, where they lend body parts or get
/// them back, and where they are too long.
///
///     const auto motion = stmc.generate(cut_texts(timeline, stmc.fps), rng);
///
/// Differs  from STMC (thesis 6.2.3, "Motion cropping and denoising"), where each text is one crop

MOTIONLANG_NAMESPACE_BEGIN

/// Seconds of a text that a denoiser does as a whole. HumanML3D's clips and ours end at 9.8 s, and the longest crops
/// are what a model has seen least of: ours walks as far in 8 s as in 10.
inline constexpr double longest_whole_text = 8;
/// Seconds below which a part would be too short for the denoiser to do what the text says.
inline constexpr double shortest_part = 0.5;

/// end_actions, cut_at_handovers, divide_long_texts. Throws what they throw.
Timeline cut_texts(const Timeline& timeline, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_CUT_TEXTS_IPP  // <motionlang/compose/cut_texts.ipp>
#define MOTIONLANG_HAS_COMPOSE_CUT_TEXTS_IPP
// Bodies of cut_texts.hpp.

#ifndef MOTIONLANG_HAS_COMPOSE_HANDOVERS_HPP  // <motionlang/compose/handovers.hpp>
#define MOTIONLANG_HAS_COMPOSE_HANDOVERS_HPP
/// Cuts texts where their body parts change.
///
/// A text that goes on while another borrows its arms is one crop as published, so the denoiser sees raised arms in the
/// middle of "walk forward" and keeps them up before and after. Cut at these times, it walks with its own arms, then
/// without them, then with its own again; the transitions are where they were.
///
///     const auto motion = stmc.generate(cut_at_handovers(timeline, 10), rng);
///
/// Differs  from STMC (thesis 6.2.3, "Motion cropping and denoising"), where each text is one crop

MOTIONLANG_NAMESPACE_BEGIN

/// Cuts every text at the times at which it gets or loses body parts, unless a piece would be shorter than `least`
/// frames. Throws config_error 101 if too many texts overlap.
Timeline cut_at_handovers(const Timeline& timeline, Index least);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_HANDOVERS_IPP  // <motionlang/compose/handovers.ipp>
#define MOTIONLANG_HAS_COMPOSE_HANDOVERS_IPP
// Bodies of handovers.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Timeline cut_at_handovers(const Timeline& timeline, Index least) {
  const auto pieces = elementary_pieces(timeline);
  const auto parts = static_cast<std::size_t>(timeline.body.size());
  std::vector<PartOwners> owners;
  owners.reserve(pieces.size());
  FirstWins ties;
  for (const Piece& piece : pieces) {
    owners.push_back(piece.intervals.empty() ? PartOwners(parts) : assign_parts(timeline, piece.intervals, ties));
  }
  least = std::max<Index>(least, 1);
  Timeline out{{}, timeline.body};
  for (Index i = 0; i < std::ssize(timeline.intervals); ++i) {
    Interval rest = timeline.intervals[static_cast<std::size_t>(i)];
    for (std::size_t k = 1; k < pieces.size(); ++k) {
      const Index cut = pieces[k].start;
      const bool changes = [&] {
        for (std::size_t p = 0; p < parts; ++p) {
          if ((owners[k][p] == i) != (owners[k - 1][p] == i)) return true;
        }
        return false;
      }();
      if (!changes || cut - rest.start < least || rest.end - cut < least) continue;
      out.intervals.push_back(rest);
      out.intervals.back().end = cut;
      rest.start = cut;
    }
    out.intervals.push_back(rest);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_LONG_TEXTS_HPP  // <motionlang/compose/long_texts.hpp>
#define MOTIONLANG_HAS_COMPOSE_LONG_TEXTS_HPP
/// Long texts in parts.
///
/// Denoisers learn from clips of ten seconds at most. A text of a minute as one crop makes somebody who stands, or
/// turns in the air; in parts that follow each other it is done all the time.
///
///     const auto motion = stmc.generate(divide_long_texts(timeline, 160), rng);

MOTIONLANG_NAMESPACE_BEGIN

/// The limit for one text: a day in parts of 8 s makes 10,800.
inline constexpr Index most_parts = 100000;

namespace detail {

/// An interval in `count` parts that follow each other, equally long to a frame.
std::vector<Interval> equal_parts(const Interval& whole, Index count);

}  // namespace detail

/// Divides every text of more than `longest` frames into as few parts as will do, which are equally long to a frame.
/// Throws config_error 101 unless longest is 1 or more, and for more than most_parts of a text.
Timeline divide_long_texts(const Timeline& timeline, Index longest);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_LONG_TEXTS_IPP  // <motionlang/compose/long_texts.ipp>
#define MOTIONLANG_HAS_COMPOSE_LONG_TEXTS_IPP
// Bodies of long_texts.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<Interval> equal_parts(const Interval& whole, Index count) {
  std::vector<Interval> parts;
  const Index frames = whole.end - whole.start;
  for (Index i = 0; i < count; ++i) {
    Interval part = whole;
    part.start = whole.start + frames * i / count;
    part.end = whole.start + frames * (i + 1) / count;
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace detail

MOTIONLANG_BODY Timeline divide_long_texts(const Timeline& timeline, Index longest) {
  if (longest < 1) raise<config_error>(101, "divide_long_texts: parts of ", counted(longest, "frame"));
  Timeline out{{}, timeline.body};
  for (const Interval& whole : timeline.intervals) {
    const Index parts = std::max<Index>(1, (whole.end - whole.start + longest - 1) / longest);
    if (parts > most_parts) {
      raise<config_error>(101, "divide_long_texts: '", whole.text, "' of ", counted(whole.end - whole.start, "frame"),
                          " makes ", counted(parts, "part"), ", expected ", most_parts, " at most");
    }
    for (Interval& part : detail::equal_parts(whole, parts)) out.intervals.push_back(std::move(part));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_NATURAL_LENGTHS_HPP  // <motionlang/compose/natural_lengths.hpp>
#define MOTIONLANG_HAS_COMPOSE_NATURAL_LENGTHS_HPP
/// Actions that begin and end: a denoiser that has more time than an action takes does it again, or slowly, and may
/// begin in the middle. Such a text becomes several: standing, the action for as long as people take, what follows.
///
///     const auto length = natural_length("sit down");                     // 2.8 s, then "sit quietly"
///     const Timeline both = end_actions(parse_timeline("sit down # 0 # 8\n"), 20);
///
/// Source  lengths: the third quartile of the segments with such captions in examples/training/captions.tsv

MOTIONLANG_NAMESPACE_BEGIN

/// How long an action takes, and a text of what somebody does then.
struct NaturalLength {
  double seconds = 0;
  std::string then{};
  bool from_rest = false;  // raising arms, bending: begins as somebody stands
};

/// That of an English text of one action that ends: turning, raising arms, sitting down, standing up, jumping, bending,
/// kicking, punching and throwing. Nothing for other texts, and for those with "again", "and", "while", "times", ...
std::optional<NaturalLength> natural_length(std::string_view text);

/// Seconds of "stand still" in front of an action that begins from rest.
inline constexpr double standing_lead_in = 0.5;

/// Every text that lasts at least a second longer than its action becomes the action and what follows it, with the same
/// parts. An action from rest has a standing_lead_in if it has two seconds, all parts and the start of the timeline.
/// For the human body; other timelines stay as they are.
Timeline end_actions(const Timeline& timeline, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_NATURAL_LENGTHS_IPP  // <motionlang/compose/natural_lengths.ipp>
#define MOTIONLANG_HAS_COMPOSE_NATURAL_LENGTHS_IPP
// Bodies of natural_lengths.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The words of a text in lower case.
inline std::vector<std::string> lower_words(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    const char l = lower(c);
    if ((l >= 'a' && l <= 'z') || (l >= '0' && l <= '9') || l == '\'')
      words.back() += l;
    else if (!words.back().empty())
      words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

/// Words of actions that go on, or that need another one.
inline constexpr std::array continuing_words{"again",      "and",  "then",  "while",   "times",  "twice",
                                             "repeatedly", "keep", "keeps", "circles", "circle", "continuously",
                                             "several",    "many", "jacks", "rope",    "walk",   "walks",
                                             "walking",    "run",  "runs",  "running"};

}  // namespace detail

MOTIONLANG_BODY std::optional<NaturalLength> natural_length(std::string_view text) {
  const auto words = detail::lower_words(text);
  const auto says = [&](std::initializer_list<std::string_view> any) {
    return std::any_of(words.begin(), words.end(),
                       [&](const std::string& w) { return std::find(any.begin(), any.end(), w) != any.end(); });
  };
  if (std::any_of(detail::continuing_words.begin(), detail::continuing_words.end(),
                  [&](const char* w) { return says({w}); }))
    return {};
  const bool arm = says({"arm", "arms", "hand", "hands"});
  if (says({"turn", "turns", "turning"}) && says({"left", "right", "around"}) && !arm)
    return NaturalLength{2.4, "stand still"};
  if (says({"raise", "raises", "raising", "lift", "lifts", "lifting"}) && arm) {
    const bool both = says({"both", "arms", "hands"}), left = says({"left"});
    return NaturalLength{2.2,
                         both   ? "hold both arms up"
                         : left ? "hold the left arm up"
                                : "hold the right arm up",
                         true};
  }
  if (says({"sit", "sits", "sitting"}) && says({"down"})) return NaturalLength{2.8, "sit quietly"};
  if (says({"stand", "stands", "get", "gets"}) && says({"up"})) return NaturalLength{2.4, "stand still"};
  if (says({"jump", "jumps", "leap", "leaps"}) && !(says({"up"}) && says({"down"})))
    return NaturalLength{2.8, "stand still"};
  if (says({"bend", "bends", "bending", "bow", "bows", "bowing"}) && !says({"knees", "knee", "arm", "arms"}))
    return NaturalLength{2.2, "stand still", true};
  if (says({"kick", "kicks", "punch", "punches", "throw", "throws"})) return NaturalLength{2.4, "stand still"};
  return {};
}

MOTIONLANG_BODY Timeline end_actions(const Timeline& timeline, double fps) {
  if (!(timeline.body == BodyPartition{})) return timeline;
  Timeline out{{}, timeline.body};
  for (const Interval& whole : timeline.intervals) {
    const auto natural = natural_length(whole.text);
    Interval action = whole;
    if (natural && natural->from_rest && whole.start == 0 && whole.parts == BodyParts::all() &&
        whole.end >= frame_at(2, fps)) {
      out.intervals.push_back(whole);
      out.intervals.back().text = "stand still";
      out.intervals.back().end = action.start = frame_at(standing_lead_in, fps);
    }
    out.intervals.push_back(action);
    if (!natural || action.end - action.start < frame_at(natural->seconds + 1, fps)) continue;
    Interval rest = action;
    out.intervals.back().end = rest.start = action.start + frame_at(natural->seconds, fps);
    rest.text = natural->then;
    out.intervals.push_back(std::move(rest));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Timeline cut_texts(const Timeline& timeline, double fps) {
  const Timeline ended = end_actions(timeline, fps);
  return divide_long_texts(cut_at_handovers(ended, frame_at(shortest_part, fps)), frame_at(longest_whole_text, fps));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FEATURES_FEATURE_ROWS_HPP  // <motionlang/features/feature_rows.hpp>
#define MOTIONLANG_HAS_FEATURES_FEATURE_ROWS_HPP
/// From a motion on any joints to the rows of named features.
///
///     const auto rows = rows_of_motion(motion_features("guoh3d"), read_motion("dance.bvh"), 20);

#ifndef MOTIONLANG_HAS_FEATURES_MOTION_FEATURES_HPP  // <motionlang/features/motion_features.hpp>
#define MOTIONLANG_HAS_FEATURES_MOTION_FEATURES_HPP
/// The feature vectors that systems are trained on, by name: from a clip to rows of numbers, and from these to joints
/// and clips.
///
///     const MotionFeatures& f = motion_features("guoh3d");
///     const auto rows = f.from_motion(resample(retarget(clip), f.fps));
///     const Motion back = motion_of_rows(f, rows);
///
///     guoh3d              263   20    HumanML3D's, of TMR   a row less than the clip has frames; positions alone
///     kit                 251   12.5  KIT's, 21 joints of MMM, reflected, 640 units per metre, bones as long as the
///                         clip's; else as guoh3d
///     rifke                67   12.5  TMR's canonical view, 22 joints; positions alone
///     rifke64              64   12.5  TEMOS on KIT, 21 joints of MMM as in kit ("LMrot" in the middle of the foot),
///                          positions alone
///     smplvelp            135   12.5  TEMOS on SMPL         with the exact heading, so that it is there and back
///     smplvelp-published  135   12.5  TEMOS on SMPL         with the published turn, which is not a heading: see
///                         SmplVelpOptions
///     smplrifke           205   20    STMC
///     actor               150   20    ACTOR and MDM's models of actions: 6D rotations and way, in the world of a
///                         camera
/// Positions alone: the clip that comes back has rotations that fit them (motion_from_joints.hpp).
/// Source  see guoh3d_extraction.hpp, rifke.hpp, smplvelp.hpp, smplrifke.hpp, pose_representation.hpp; MMM:
///         text-to-motion utils/paramUtil.py, TEMOS temos/transforms

#ifndef MOTIONLANG_HAS_FEATURES_SMPLVELP_HPP  // <motionlang/features/smplvelp.hpp>
#define MOTIONLANG_HAS_FEATURES_SMPLVELP_HPP
/// The 135-vector of TEMOS ("smplvelp"), TEACH and SINC ("Globalvelandy"): height, velocity over the ground, rotations.
///
///     0        height of the translation, as it is
///     1:3      its velocity x, y; 0 in the first frame
///     3:135    22 rotations as two rows of the matrix: the body in the world, then joints 1 ... 21
/// World: Z up, metres; velocities per frame (TEMOS 12.5 frames per second, TEACH and SINC 30).
///
/// Source  TEMOS (Petrovich et al., ECCV 2022), appendix B.2, temos/transforms/rots2rfeats/smplvelp.py; TEACH
///         teach/transforms/rots2rfeats/globvelandy.py. Normalise with eps 1e-12, SINC with 1e-5 both ways.

#ifndef MOTIONLANG_HAS_FEATURES_POSE_REPRESENTATION_HPP  // <motionlang/features/pose_representation.hpp>
#define MOTIONLANG_HAS_FEATURES_POSE_REPRESENTATION_HPP
/// Rotations as numbers of a feature vector, the way ACTOR, TEMOS, TEACH and SINC write them, and ACTOR's motions made
/// of them.
///
///     rotvec   3   rotation vector, radians
///     rotquat  4   quaternion, w first
///     rotmat   9   matrix, row by row
///     rot6d    6   first two rows of the matrix; what all published models use
///
/// Source  ACTOR (Petrovich et al., ICCV 2021), src/datasets/dataset.py; conversions: geometry/pytorch3d.hpp;
///         thesis 3.3.2, table 3.1

MOTIONLANG_NAMESPACE_BEGIN

enum class PoseRepresentation : int { rotvec, rotquat, rotmat, rot6d };
inline constexpr std::array<std::string_view, 4> pose_representation_names{"rotvec", "rotquat", "rotmat", "rot6d"};

/// Numbers of one rotation.
constexpr Index size(PoseRepresentation r) {
  constexpr Index sizes[] = {3, 4, 9, 6};
  return sizes[static_cast<int>(r)];
}
/// Throws config_error 103.
PoseRepresentation parse_pose_representation(std::string_view name);

namespace detail {

template <Scalar S>
void append_vector(std::vector<S>& out, const Vec3<S>& v) {
  out.insert(out.end(), {v.x, v.y, v.z});
}
template <Scalar S>
void append_quaternion(std::vector<S>& out, const Quaternion<S>& q) {
  out.insert(out.end(), {q.w, q.x, q.y, q.z});
}

}  // namespace detail

/// Appends the numbers of a matrix.
template <Scalar S>
void append_rotation(std::vector<S>& out, PoseRepresentation r, const Matrix3<S>& m) {
  switch (r) {
    case PoseRepresentation::rotvec:
      return detail::append_vector(out, pytorch3d::matrix_to_axis_angle(m));
    case PoseRepresentation::rotquat:
      return detail::append_quaternion(out, pytorch3d::matrix_to_quaternion(m));
    default:
      out.insert(out.end(), m.m.begin(), m.m.begin() + size(r));  // rows
  }
}
/// Appends the numbers of a rotation vector, which rotvec keeps as it is.
template <Scalar S>
void append_rotation(std::vector<S>& out, PoseRepresentation r, const AxisAngle<S>& v) {
  if (r == PoseRepresentation::rotvec) return detail::append_vector(out, v.v);
  if (r == PoseRepresentation::rotquat) return detail::append_quaternion(out, to_quaternion(v));
  append_rotation(out, r, to_matrix(v));
}
/// The matrix of the numbers, which may be whole tensors. Throws shape_error 205.
template <ScalarLike S>
Matrix3<S> rotation_from(PoseRepresentation r, std::span<const S> n) {
  if (std::ssize(n) != size(r)) {
    raise<shape_error>(205, "rotation_from: ", n.size(), " numbers for '",
                       pose_representation_names[static_cast<std::size_t>(r)], "' of ", size(r));
  }
  switch (r) {
    case PoseRepresentation::rotvec:
      return to_matrix(AxisAngle<S>{{n[0], n[1], n[2]}});
    case PoseRepresentation::rotquat:
      return to_matrix(Quaternion<S>{n[0], n[1], n[2], n[3]});
    case PoseRepresentation::rotmat:
      return {{n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8]}};
    default:
      return to_matrix(Rotation6dRows<S>{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}});
  }
}

struct ActorFeatureOptions {
  PoseRepresentation rotations = PoseRepresentation::rot6d;
  bool translation = true;  // one more row: the root's way since frame 0, filled up with zeros
  bool global = true;       // false: without joint 0

  /// Rows of a frame of this many joints.
  Index rows(Index joints) const { return joints - (global ? 0 : 1) + (translation ? 1 : 0); }
};
/// Joint 0 where features have none, as ACTOR takes it: of a figure that stands on its head in the world of the camera.
inline constexpr Vec3<double> actor_global_rotation{std::numbers::pi, 0, 0};

/// A frame of ACTOR: a rotation of each joint, then the root's way (see `actor_frame_features`), which goes to the
/// part with the path: 150.
FeatureLayout actor_layout(std::span<const BodyPart> part_of_joint = smpl_part_of_joint,
                           const ActorFeatureOptions& options = {}, const BodyPartition& body = {});

/// The meaning of the values of `actor_layout`. World: that of a camera, in which figures stand on their heads.
inline constexpr std::array<FeatureRange, 4> actor_ranges{{
    {{0, 6}, "rotation in the world: the first two rows of the matrix", "1", {0, 1}},
    {{6, 144}, "rotation relative to the parent: the first two rows of the matrix", "1", {1, 24}},
    {{144, 147}, "way of the root since frame 0: x, y, z", "m"},
    {{147, 150}, "0: the root's row is as long as the others", "1"},
}};

/// The input of ACTOR's networks, frame by frame.
/// poses    (frames, joints): rotation vectors or matrices
/// root     (frames), the pelvis; read if `translation` is on
/// result   (frames, rows numbers): a row for each joint, then the root's
/// Throws   shape_error 205 if the sizes do not fit
template <class R, Scalar S>
std::vector<S> actor_frame_features(std::span<const R> poses, std::span<const Vec3<S>> root, Index joints,
                                    const ActorFeatureOptions& options = {}) {
  const Index frames = joints > 0 ? std::ssize(poses) / joints : 0;
  if (joints < 1 || std::ssize(poses) != frames * joints || (options.translation && std::ssize(root) != frames)) {
    raise<shape_error>(205, "actor_frame_features: ", poses.size(), " rotations of ", joints, " joints, ", root.size(),
                       " root positions");
  }
  std::vector<S> out;
  for (Index t = 0; t < frames; ++t) {
    for (Index j = options.global ? 0 : 1; j < joints; ++j) {
      append_rotation(out, options.rotations, poses[static_cast<std::size_t>(t * joints + j)]);
    }
    if (!options.translation) continue;
    detail::append_vector(out, root[static_cast<std::size_t>(t)] - root[0]);
    out.resize(out.size() + static_cast<std::size_t>(size(options.rotations) - 3));
  }
  return out;
}
/// The same with time last, as its repository has it: (rows, numbers, frames).
template <class R, Scalar S>
std::vector<S> actor_features(std::span<const R> poses, std::span<const Vec3<S>> root, Index joints,
                              const ActorFeatureOptions& options = {}) {
  const std::vector<S> by_frame = actor_frame_features(poses, root, joints, options);
  const auto width = static_cast<std::size_t>(options.rows(joints) * size(options.rotations));
  std::vector<S> out(by_frame.size());
  if (width == 0) return out;
  const std::size_t frames = out.size() / width;
  for (std::size_t i = 0; i < out.size(); ++i) out[i % width * frames + i / width] = by_frame[i];
  return out;
}

template <Scalar S>
struct ActorMotion {
  std::vector<Matrix3<S>> rotations;  // (frames, joints)
  std::vector<Vec3<S>> root;          // (frames), since frame 0
};

/// features  (frames, rows numbers), as `actor_frame_features` gives them and networks have them
/// Joint 0 is `actor_global_rotation` where the features have none; the root stays where it is without a translation.
/// Throws    shape_error 205 if the features are not whole frames, config_error 101 for no joints
template <Scalar S>
ActorMotion<S> actor_inverse(std::span<const S> features, Index joints = 24, const ActorFeatureOptions& options = {}) {
  if (joints < 1) raise<config_error>(101, "actor_inverse: ", joints, " joints");
  const auto numbers = static_cast<std::size_t>(size(options.rotations));
  const auto width = static_cast<std::size_t>(options.rows(joints)) * numbers;
  if (width == 0 || features.size() % width != 0)
    raise<shape_error>(205, "actor_inverse: ", features.size(), " values are not frames of ", width);
  ActorMotion<S> out;
  for (std::size_t at = 0; at < features.size(); at += width) {
    std::size_t from = at;
    if (!options.global) out.rotations.push_back(to_matrix(AxisAngle<S>{vec_cast<S>(actor_global_rotation)}));
    for (Index j = options.global ? 0 : 1; j < joints; ++j, from += numbers)
      out.rotations.push_back(rotation_from(options.rotations, features.subspan(from, numbers)));
    out.root.push_back(options.translation ? Vec3<S>{features[from], features[from + 1], features[from + 2]}
                                           : Vec3<S>{});
  }
  return out;
}

/// The same of positions (its representation "xyz"), with the root of frame 0 at the origin.
/// joints (frames, joints) -> (joints, 3, frames). Throws shape_error 205.
template <Scalar S>
std::vector<S> actor_joint_features(std::span<const Vec3<S>> positions, Index joints) {
  if (joints < 1 || std::ssize(positions) % joints != 0) {
    raise<shape_error>(205, "actor_joint_features: ", positions.size(), " positions for frames of ", joints);
  }
  const std::size_t n = static_cast<std::size_t>(joints), frames = positions.size() / n;
  std::vector<S> out(3 * positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3<S> p = positions[i] - positions[0];
    S* to = &out[3 * (i % n) * frames + i / n];
    to[0] = p.x, to[frames] = p.y, to[2 * frames] = p.z;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FEATURES_POSE_REPRESENTATION_IPP  // <motionlang/features/pose_representation.ipp>
#define MOTIONLANG_HAS_FEATURES_POSE_REPRESENTATION_IPP
// Bodies of pose_representation.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY PoseRepresentation parse_pose_representation(std::string_view name) {
  for (std::size_t i = 0; i < pose_representation_names.size(); ++i) {
    if (name == pose_representation_names[i]) return static_cast<PoseRepresentation>(i);
  }
  raise<config_error>(103, "parse_pose_representation: '", name, "' is not rotvec, rotquat, rotmat or rot6d");
}

MOTIONLANG_BODY FeatureLayout actor_layout(std::span<const BodyPart> part_of_joint, const ActorFeatureOptions& options,
                                           const BodyPartition& body) {
  const Index joints = std::ssize(part_of_joint), numbers = motionlang::size(options.rotations);
  if (joints < 1) raise<config_error>(101, "actor_layout: no joints");
  return FeatureLayout::from_owner("actor", options.rows(joints) * numbers, body, [&](Index i) {
    const Index joint = i / numbers + (options.global ? 0 : 1);
    return joint < joints ? part_of_joint[static_cast<std::size_t>(joint)] : body.path();
  });
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct SmplVelpOptions {
  PoseRepresentation rotations = PoseRepresentation::rot6d;
  /// Turns the clip about Z by what `exact_yaw` says of the first frame (and a quarter, `offset`).
  bool canonicalize = true;
  bool offset = true;
  /// false, as published: the z of the first rotation vector. It is not a heading, so a second pass turns again.
  /// true: the heading. Clips that differ by a turn about Z become the same.
  bool exact_yaw = false;
};

template <Scalar S>
struct SmplVelpMotion {
  std::vector<Matrix3<S>> rotations;  // (frames, joints); joint 0 in the world
  std::vector<Vec3<S>> trans;         // (frames)
};

/// smplvelp: the root's height and velocity, then a rotation of each joint as above: 135 for 22 joints in 6D.
inline FeatureLayout smplvelp_layout(
    std::span<const BodyPart> part_of_joint = std::span(smpl_part_of_joint).first<22>(),
    PoseRepresentation rotations = PoseRepresentation::rot6d, const BodyPartition& body = {}) {
  const Index joints = std::ssize(part_of_joint), numbers = motionlang::size(rotations);
  if (joints < 1) raise<config_error>(101, "smplvelp_layout: no joints");
  return FeatureLayout::from_owner("smplvelp", 3 + numbers * joints, body, [&](Index i) {
    return i < 3 ? body.path() : part_of_joint[static_cast<std::size_t>((i - 3) / numbers)];
  });
}

/// The meaning of the values of `smplvelp_layout`. World: Z up, turned as SmplVelpOptions say.
inline constexpr std::array<FeatureRange, 4> smplvelp_ranges{{
    {{0, 1}, "height of the translation in the world", "m"},
    {{1, 3}, "velocity of the translation since the frame before, in the world: x, y", "m/frame"},
    {{3, 9}, "rotation in the world: the first two rows of the matrix", "1", {0, 1}},
    {{9, 135}, "rotation relative to the parent: the first two rows of the matrix", "1", {1, 22}},
}};

/// rotations  (frames, joints); joint 0 in the world
/// trans      (frames)
/// result     (frames, 3 + 6 joints), or 3 + 4 joints for quaternions, ...
/// Throws     shape_error 205 if the sizes do not fit
template <Scalar S>
std::vector<S> smplvelp_features(std::span<const Matrix3<S>> rotations, std::span<const Vec3<S>> trans,
                                 const SmplVelpOptions& options = {}) {
  const std::size_t frames = trans.size(), joints = frames == 0 ? 0 : rotations.size() / frames;
  if (rotations.size() != frames * joints || (frames > 0 && joints == 0)) {
    raise<shape_error>(205, "smplvelp_features: ", rotations.size(), " rotations for ", frames, " frames");
  }
  std::vector<S> out;
  if (frames == 0) return out;
  S angle{};
  if (options.canonicalize) {
    angle =
        options.exact_yaw ? detail::zyx_angles(rotations[0], true).z : pytorch3d::matrix_to_axis_angle(rotations[0]).z;
    if (options.offset) angle += S(std::numbers::pi / 2);
  }
  const Matrix3<S> back = axis_rotation(2, -angle);
  for (std::size_t t = 0; t < frames; ++t) {
    const Vec3<S> velocity = back * (trans[t] - trans[t == 0 ? 0 : t - 1]);
    out.insert(out.end(), {trans[t].z, velocity.x, velocity.y});
    for (std::size_t j = 0; j < joints; ++j) {
      const Matrix3<S>& r = rotations[t * joints + j];
      append_rotation(out, options.rotations, j == 0 ? back * r : r);
    }
  }
  return out;
}

/// features  (frames, 3 + 6 joints), not normalised
/// The path starts at x = y = 0; the heading stays what the features say. Throws shape_error 205.
template <Scalar S>
SmplVelpMotion<S> smplvelp_inverse(std::span<const S> features, Index joints = 22,
                                   PoseRepresentation representation = PoseRepresentation::rot6d) {
  const Index numbers = size(representation), width = 3 + numbers * joints;
  if (joints < 1 || std::ssize(features) % width != 0) {
    raise<shape_error>(205, "smplvelp_inverse: ", features.size(), " values are not rows of ", width);
  }
  SmplVelpMotion<S> out;
  Vec3<S> position{};
  for (std::size_t at = 0; at < features.size(); at += static_cast<std::size_t>(width)) {
    if (at > 0) position = position + Vec3<S>{features[at + 1], features[at + 2], S(0)};
    position.z = features[at];
    out.trans.push_back(position);
    for (Index j = 0; j < joints; ++j) {
      const auto own =
          features.subspan(at + 3 + static_cast<std::size_t>(numbers * j), static_cast<std::size_t>(numbers));
      out.rotations.push_back(rotation_from(representation, own));
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_RETARGET_HPP  // <motionlang/kinematics/retarget.hpp>
#define MOTIONLANG_HAS_KINEMATICS_RETARGET_HPP
/// Retargeting: the same movement on another skeleton, from and to every kind that skeleton_tables.hpp knows.
///
///     G_t(f) = G_s(f) C_s^-1 C_t
/// G_s, G_t: world rotations of a joint s of the source and of the joint t of the target that follows it. C_t: the
/// world rotation of t while the target stands in its T-pose, facing +Z; C_s: that of s while the source stands as the
/// target does then, its limbs along the target's limbs. A source in that pose so gives the target's T-pose, whatever
/// the local axes and the rest poses (T, A, any quarter turn), and chains may have different numbers of joints. Joints
/// that no table knows follow those of the same name, fingers those of the same finger. Bones keep the
/// target's lengths; the path is scaled by the ratio of the legs.

#ifndef MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLES_HPP  // <motionlang/kinematics/skeleton_tables.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLES_HPP
/// Which joint of a known skeleton has the part of which joint of SMPL: the tables behind retargeting, and how to
/// recognise one. They are read in both directions: SMPL's 24 joints are what all skeletons have in common.

#ifndef MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLE_HPP  // <motionlang/kinematics/skeleton_table.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLE_HPP
/// Which joint of a kind of skeleton has the part of which joint of SMPL: one table. Those that are known are in
/// skeleton_tables.hpp.

MOTIONLANG_NAMESPACE_BEGIN

/// A joint's name without what programs put before it: namespaces ("hero:Hips"), and Mixamo's "mixamorig:", also as
/// "mixamorig1:" and, where colons were lost, "mixamorig".
std::string_view bare_joint_name(std::string_view name);

/// The number of a joint by its name, or else by its bare name, or else by that without regard to capital letters
/// ("Hips" is "hips": Unity and Godot write VRM's names so); -1.
int find_joint(const Skeleton& skeleton, std::string_view name);

/// One joint of SMPL and the joint of the known skeleton whose orientation it takes.
struct MappedJoint {
  std::string target;  // name in SMPL
  std::string source;
  /// The two local axes of the source joint that point to the left and up while the figure stands in a T-pose. "+x+y"
  /// for files whose rotations are all zero in that pose.
  std::string axes = "+x+y";
  /// How the frame given by `axes` is turned in the T-pose besides: rotation vector in degrees, x left, y up, z
  /// forward.
  Vec3<double> turn{};
  /// A second source joint and its share, for chains of different lengths. Its axes are those of its own row, else of
  /// its parent.
  std::string second{};
  double share = 0;

  /// True if a skeleton may lack the source: hands, toes and collars.
  bool optional() const {
    return target.ends_with("_hand") || target.ends_with("_foot") || target.ends_with("_collar");
  }
};

/// A kind of skeleton. Hands, toes and collars may be missing; all other joints of the table must be there.
struct SkeletonTable {
  std::string name;
  std::vector<MappedJoint> joints;
  /// True if limbs are turned so that the source's bones take the directions of the target's; false where the zero pose
  /// (with `turn`) is known to be the T-pose although its bones are not straight.
  bool straighten = true;
  /// True if the soles are level in the zero pose although the legs stand apart, as in the pose to which a character's
  /// skin is bound. Otherwise feet lean to the side with their shins.
  bool level_soles = false;

  const MappedJoint* find(std::string_view target) const;
  /// The first joint that the table needs and the skeleton lacks; empty if there is none.
  std::string missing(const Skeleton& source) const;
  /// How many of its joints the skeleton has.
  int found(const Skeleton& source) const;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLE_IPP  // <motionlang/kinematics/skeleton_table.ipp>
#define MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLE_IPP
// Bodies of skeleton_table.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string_view bare_joint_name(std::string_view name) {
  name = name.substr(name.rfind(':') + 1);  // npos + 1 = 0
  constexpr std::string_view mixamo = "mixamorig";
  if (!name.starts_with(mixamo)) return name;
  const std::size_t rest = name.find_first_not_of("0123456789_", mixamo.size());
  return rest == name.npos ? name : name.substr(rest);
}

namespace detail {

inline bool same_but_for_capitals(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace detail

MOTIONLANG_BODY int find_joint(const Skeleton& skeleton, std::string_view name) {
  if (const int j = skeleton.find(name); j >= 0) return j;
  int similar = -1;
  for (int k = 0; k < skeleton.size(); ++k) {
    const std::string_view bare = bare_joint_name(skeleton.name(k));
    if (bare == name) return k;
    if (similar < 0 && detail::same_but_for_capitals(bare, name)) similar = k;
  }
  return similar;
}

MOTIONLANG_BODY const MappedJoint* SkeletonTable::find(std::string_view target) const {
  for (const MappedJoint& j : joints) {
    if (j.target == target) return &j;
  }
  return nullptr;
}

MOTIONLANG_BODY std::string SkeletonTable::missing(const Skeleton& source) const {
  for (const MappedJoint& j : joints) {
    if (!j.optional() && find_joint(source, j.source) < 0) return j.source;
    if (!j.second.empty() && find_joint(source, j.second) < 0) return j.second;
  }
  return {};
}

MOTIONLANG_BODY int SkeletonTable::found(const Skeleton& source) const {
  int n = 0;
  for (const MappedJoint& j : joints) n += find_joint(source, j.source) >= 0 ? 1 : 0;
  return n;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::string_view own_table_hint =
    "a file can name the joints and their axes: read_skeleton_table, option `joints`";

}  // namespace detail

/// The built-in tables.
const std::vector<SkeletonTable>& skeleton_tables();

/// The table whose joints the skeleton has; of several one by which it stands at rest, then the one with the most. Null
/// if none fits.
const SkeletonTable* find_skeleton_table(const Skeleton& source);
/// The same. Throws config_error 103 with the joint that the closest table misses if none fits.
const SkeletonTable& detect_skeleton_table(const Skeleton& source);
/// A built-in table by name. Throws config_error 103.
const SkeletonTable& skeleton_table(std::string_view name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLES_IPP  // <motionlang/kinematics/skeleton_tables.ipp>
#define MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLES_IPP
// Bodies of skeleton_tables.hpp.

#ifndef MOTIONLANG_HAS_KINEMATICS_STANDING_SKELETON_HPP  // <motionlang/kinematics/standing_skeleton.hpp>
#define MOTIONLANG_HAS_KINEMATICS_STANDING_SKELETON_HPP
/// A skeleton as it stands in its T-pose, by the axes that its table states.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A joint of a limb and the one where its bone ends, by SMPL's names.
struct LimbBone {
  std::string_view joint, end;
};

/// True if a text names two different axes, as "+x+y" does.
bool is_axes(std::string_view axes);
/// World rotation of a joint in a T-pose, from "+x+y": its local axes that point left and up.
Quaternion<double> axes_rotation(const MappedJoint& joint);

/// A skeleton as its table sees it, standing in its T-pose, turned by quarters of a circle about y until its left is
/// nearest to +X. Where its limbs do not point to the sides or down, `bone` says where they point.
class StandingSkeleton {
 public:
  Skeleton skeleton;
  SkeletonTable table;
  std::vector<Quaternion<double>> rotation;  // of each joint in the world

  StandingSkeleton(Skeleton s, SkeletonTable t);

  /// The reason why it does not stand and face forward: the head is not over the pelvis, the hips are not side by side,
  /// or toes point back as left and right are exchanged. "" if it stands, or has no such joints.
  std::string lies() const;

  /// The joint with a role, a name of SMPL's; -1 if there is none.
  int joint(std::string_view role) const {
    const MappedJoint* row = table.find(role);
    return row == nullptr ? -1 : find_joint(skeleton, row->source);
  }
  /// The role of a joint: that which it fills with the largest share, of several the last. "" if it has none.
  std::string role(int joint) const;
  /// A bone of a limb; zero without its joints. Where the table says that the zero pose is the T-pose although bones
  /// are not straight: as in SMPL.
  Vec3<double> bone(const LimbBone& limb) const;
  double length(const LimbBone& limb) const;

 private:
  void face_forward();

  std::vector<Vec3<double>> position_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_STANDING_SKELETON_IPP  // <motionlang/kinematics/standing_skeleton.ipp>
#define MOTIONLANG_HAS_KINEMATICS_STANDING_SKELETON_IPP
// Bodies of standing_skeleton.hpp.

#ifndef MOTIONLANG_HAS_GEOMETRY_DEGREE_HPP  // <motionlang/geometry/degree.hpp>
#define MOTIONLANG_HAS_GEOMETRY_DEGREE_HPP
/// Angles in degrees: 30 * degree is in radians, a / degree in degrees.

MOTIONLANG_NAMESPACE_BEGIN

inline constexpr double degree = std::numbers::pi / 180;

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline Vec3<double> local_axis(std::string_view signed_letter) {
  const double sign = signed_letter[0] == '-' ? -1 : 1;
  const char c = signed_letter[1];
  return {c == 'x' ? sign : 0, c == 'y' ? sign : 0, c == 'z' ? sign : 0};
}

MOTIONLANG_BODY bool is_axes(std::string_view axes) {
  const auto sign = [](char c) { return c == '+' || c == '-'; };
  const auto letter = [](char c) { return c >= 'x' && c <= 'z'; };
  return axes.size() == 4 && sign(axes[0]) && letter(axes[1]) && sign(axes[2]) && letter(axes[3]) && axes[1] != axes[3];
}

MOTIONLANG_BODY Quaternion<double> axes_rotation(const MappedJoint& joint) {
  const std::string_view axes = joint.axes;
  if (!is_axes(axes))
    raise<config_error>(103, "SkeletonTable: '", axes, "' of '", joint.source, "' does not name two axes");
  const Vec3<double> left = local_axis(axes.substr(0, 2)), up = local_axis(axes.substr(2, 2));
  const auto frame = to_quaternion(Matrix3<double>::from_rows(left, up, cross(left, up)));
  return to_quaternion(AxisAngle<double>{degree * joint.turn}) * frame;
}

MOTIONLANG_BODY StandingSkeleton::StandingSkeleton(Skeleton s, SkeletonTable t)
    : skeleton(std::move(s)), table(std::move(t)) {
  const auto joints = static_cast<std::size_t>(skeleton.size());
  rotation.assign(joints, Quaternion<double>::identity());
  position_.assign(joints, {});
  std::vector<bool> given(joints, false);
  for (const MappedJoint& m : table.joints) {
    const int j = find_joint(skeleton, m.source);
    if (j < 0) continue;
    rotation[static_cast<std::size_t>(j)] = axes_rotation(m);
    given[static_cast<std::size_t>(j)] = true;
  }
  for (std::size_t j = 1; j < joints; ++j) {
    const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
    if (!given[j]) rotation[j] = rotation[parent];
    position_[j] = position_[parent] + rotate(rotation[parent], skeleton.offsets[j]);
  }
  face_forward();
}

MOTIONLANG_BODY std::string StandingSkeleton::lies() const {
  const double slant = 0.7;  // cosine of some 45 degrees
  const auto between = [&](std::string_view from, std::string_view to) {
    const int a = joint(from), b = joint(to);
    return a < 0 || b < 0 ? Vec3<double>{}
                          : position_[static_cast<std::size_t>(b)] - position_[static_cast<std::size_t>(a)];
  };
  const auto told = [](const char* what, Vec3<double> v, const char* wanted) {
    v = (1 / norm(v)) * v;
    const auto rounded = [](double x) { return std::round(x * 100) / 100; };
    return concat_text(what, " (", rounded(v.x), ", ", rounded(v.y), ", ", rounded(v.z), ") at rest, ", wanted);
  };
  const Vec3<double> trunk = between("pelvis", "head"), across = between("right_hip", "left_hip");
  if (trunk.y < slant * norm(trunk)) return told("the head is from the pelvis in direction", trunk, "not up (0, 1, 0)");
  if (across.x < slant * norm(across))
    return told("the left hip is from the right one in direction", across, "not to the left (1, 0, 0)");
  const Vec3<double> foot = between("left_ankle", "left_foot");
  if (foot.z < -slant * norm(foot))
    return told("the left toes are from the ankle in direction", foot, "not forward (0, 0, 1) with the left hip at +x");
  return {};
}

MOTIONLANG_BODY std::string StandingSkeleton::role(int joint) const {
  std::string best;
  double largest = 0;
  for (const MappedJoint& m : table.joints) {
    const double share = find_joint(skeleton, m.source) == joint                        ? 1 - m.share
                         : !m.second.empty() && find_joint(skeleton, m.second) == joint ? m.share
                                                                                        : 0;
    if (share > 0 && share >= largest) best = m.target, largest = share;
  }
  return best;
}

MOTIONLANG_BODY Vec3<double> StandingSkeleton::bone(const LimbBone& limb) const {
  const int a = joint(limb.joint), b = joint(limb.end);
  if (a < 0 || b < 0) return {};
  if (!table.straighten) return smpl24_skeleton().offset(smpl24_skeleton()[limb.end]);
  return position_[static_cast<std::size_t>(b)] - position_[static_cast<std::size_t>(a)];
}

MOTIONLANG_BODY double StandingSkeleton::length(const LimbBone& limb) const {
  const int a = joint(limb.joint), b = joint(limb.end);
  if (a < 0 || b < 0) return 0;
  return norm(position_[static_cast<std::size_t>(b)] - position_[static_cast<std::size_t>(a)]);
}

MOTIONLANG_BODY void StandingSkeleton::face_forward() {
  const int left = joint("left_hip"), right = joint("right_hip");
  if (left < 0 || right < 0) return;
  const auto across = position_[static_cast<std::size_t>(left)] - position_[static_cast<std::size_t>(right)];
  constexpr double quarter = std::numbers::pi / 2;
  const double quarters = std::round(std::atan2(-across.z, across.x) / quarter);
  if (quarters == 0) return;
  const auto back = from_axis_angle(Vec3<double>{0, 1, 0}, -quarters * quarter);
  for (Quaternion<double>& q : rotation) q = back * q;
  for (Vec3<double>& p : position_) p = rotate(back, p);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A built-in table as a constant. As strings and vectors the tables would be a function of 130 kB.
struct KnownTable {
  struct Joint {
    std::string_view target, source, axes = "+x+y";
    Vec3<double> turn{};
    std::string_view second{};
    double share = 0;
  };
  std::string_view name;
  Joint joints[24];  // as many as SMPL has; those that are not given have no target
  bool straighten = true, level_soles = false;

  operator SkeletonTable() const {
    SkeletonTable table{.name = std::string(name), .joints = {}, .straighten = straighten, .level_soles = level_soles};
    for (const Joint& j : joints) {
      if (j.target.empty()) break;
      table.joints.push_back(
          {std::string(j.target), std::string(j.source), std::string(j.axes), j.turn, std::string(j.second), j.share});
    }
    return table;
  }
};

// clang-format off
// Shares of the spine follow from the heights of the joints between hips and neck.
inline constexpr KnownTable known_tables[] = {
    {"SMPL",
     {{"pelvis", "pelvis"}, {"spine1", "spine1"}, {"spine2", "spine2"}, {"spine3", "spine3"}, {"neck", "neck"}, {"head", "head"},
      {"left_hip", "left_hip"}, {"left_knee", "left_knee"}, {"left_ankle", "left_ankle"}, {"left_foot", "left_foot"},
      {"right_hip", "right_hip"}, {"right_knee", "right_knee"}, {"right_ankle", "right_ankle"}, {"right_foot", "right_foot"},
      {"left_collar", "left_collar"}, {"left_shoulder", "left_shoulder"}, {"left_elbow", "left_elbow"}, {"left_wrist", "left_wrist"}, {"left_hand", "left_hand"},
      {"right_collar", "right_collar"}, {"right_shoulder", "right_shoulder"}, {"right_elbow", "right_elbow"}, {"right_wrist", "right_wrist"}, {"right_hand", "right_hand"}}},
    // Made from the MotionBuilder files. The turns were measured on the 58 trials that exist as both.
    {"CMU Daz",
     {{"pelvis", "hip"}, {"spine1", "hip", "+x+y", {}, "abdomen", 0.74}, {"spine2", "abdomen", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"},
      {"neck", "neck", "+x+y", {6, 0, 0}}, {"head", "head", "+x+y", {-16, 0, 0}},
      {"left_hip", "lThigh", "+x+y", {-4.7, 0, 0}}, {"left_knee", "lShin", "+x+y", {-4.2, 0, 0}}, {"left_ankle", "lFoot"},
      {"right_hip", "rThigh", "+x+y", {-4.7, 0, 0}}, {"right_knee", "rShin", "+x+y", {-4.2, 0, 0}}, {"right_ankle", "rFoot"},
      {"left_collar", "lCollar"}, {"left_shoulder", "lShldr", "+x+y", {0, 0, 8}}, {"left_elbow", "lForeArm", "+x+y", {0, 0, 8}}, {"left_wrist", "lHand", "+x+y", {0, 0, 8}}, {"left_hand", "lMid1"},
      {"right_collar", "rCollar"}, {"right_shoulder", "rShldr", "+x+y", {0, 0, -8}}, {"right_elbow", "rForeArm", "+x+y", {0, 0, -8}}, {"right_wrist", "rHand", "+x+y", {0, 0, -8}}, {"right_hand", "rMid1"}},
     false},
    {"CMU MotionBuilder",
     {{"pelvis", "Hips"}, {"spine1", "LowerBack"}, {"spine2", "Spine"}, {"spine3", "Spine1"}, {"neck", "Neck", "+x+y", {}, "Neck1", 0.5}, {"head", "Head"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
      {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftFingerBase"}, {"left_hand", "LeftHandIndex1"},
      {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightFingerBase"}, {"right_hand", "RightHandIndex1"}}},
    {"CMU ASF",
     {{"pelvis", "root"}, {"spine1", "lowerback"}, {"spine2", "upperback"}, {"spine3", "thorax"}, {"neck", "lowerneck", "+x+y", {}, "upperneck", 0.5}, {"head", "head"},
      {"left_hip", "lfemur"}, {"left_knee", "ltibia"}, {"left_ankle", "lfoot"}, {"left_foot", "ltoes"},
      {"right_hip", "rfemur"}, {"right_knee", "rtibia"}, {"right_ankle", "rfoot"}, {"right_foot", "rtoes"},
      {"left_collar", "lclavicle"}, {"left_shoulder", "lhumerus"}, {"left_elbow", "lradius"}, {"left_wrist", "lhand"}, {"left_hand", "lfingers"},
      {"right_collar", "rclavicle"}, {"right_shoulder", "rhumerus"}, {"right_elbow", "rradius"}, {"right_wrist", "rhand"}, {"right_hand", "rfingers"}}},
    // Local axes of Maya's kind: x runs along the bone (on the right side against it), nothing is zero in a T-pose.
    {"Bandai-Namco",
     {{"pelvis", "Hips", "-y+x"}, {"spine1", "Hips", "-y+x", {}, "Spine", 0.48}, {"spine2", "Spine", "+z+x"}, {"spine3", "Chest", "+z+x"}, {"neck", "Neck", "+z+x"}, {"head", "Head", "+z+x"},
      {"left_hip", "UpperLeg_L", "+y-x"}, {"left_knee", "LowerLeg_L", "+y-x"}, {"left_ankle", "Foot_L", "+y+z", {39.5, 0, 0}}, {"left_foot", "Toes_L", "+y+z", {21, 0, 0}},
      {"right_hip", "UpperLeg_R", "+y+x"}, {"right_knee", "LowerLeg_R", "+y+x"}, {"right_ankle", "Foot_R", "+y-z", {39.5, 0, 0}}, {"right_foot", "Toes_R", "+y-z", {21, 0, 0}},
      {"left_collar", "Shoulder_L", "+x+y"}, {"left_shoulder", "UpperArm_L", "+x+y"}, {"left_elbow", "LowerArm_L", "+x+y"}, {"left_wrist", "Hand_L", "+x+y"},
      {"right_collar", "Shoulder_R", "+x-y"}, {"right_shoulder", "UpperArm_R", "+x-y"}, {"right_elbow", "LowerArm_R", "+x-y"}, {"right_wrist", "Hand_R", "+x-y"}}},
    {"ReactIdle",
     {{"pelvis", "pelvis"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "spine.001", 0.5}, {"spine3", "spine.001"}, {"neck", "neck"}, {"head", "face"},
      {"left_hip", "thigh.L"}, {"left_knee", "shin.L"}, {"left_ankle", "foot.L"},
      {"right_hip", "thigh.R"}, {"right_knee", "shin.R"}, {"right_ankle", "foot.R"},
      {"left_collar", "shoulder.L"}, {"left_shoulder", "upper_arm.L"}, {"left_elbow", "forearm.L"},
      {"right_collar", "shoulder.R"}, {"right_shoulder", "upper_arm.R"}, {"right_elbow", "forearm.R"}}},
    {"ACCAD",
     {{"pelvis", "Hips", "-z+x"}, {"spine1", "ToSpine"}, {"spine2", "Spine", "+z+x"}, {"spine3", "Spine1", "+z+x"}, {"neck", "Neck", "-z+x"}, {"head", "Head", "-y+x"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
      {"left_collar", "LeftShoulder", "+z+x"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"},
      {"right_collar", "RightShoulder", "+z+x"}, {"right_shoulder", "RightArm", "-x+y"}, {"right_elbow", "RightForeArm", "-x+y"}, {"right_wrist", "RightHand", "-x+y"}}},
    // The figure of the first BVH files: upright, but with hanging arms when all rotations are zero.
    {"Biovision",
     {{"pelvis", "Hips"}, {"spine1", "Hips", "+x+y", {}, "Chest", 0.5}, {"spine2", "Chest"}, {"spine3", "Chest"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLowLeg"}, {"left_ankle", "LeftFoot"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLowLeg"}, {"right_ankle", "RightFoot"},
      {"left_collar", "LeftCollar"}, {"left_shoulder", "LeftUpArm", "-y+x"}, {"left_elbow", "LeftLowArm", "-y+x"}, {"left_wrist", "LeftHand", "-y+x"},
      {"right_collar", "RightCollar"}, {"right_shoulder", "RightUpArm", "+y-x"}, {"right_elbow", "RightLowArm", "+y-x"}, {"right_wrist", "RightHand", "+y-x"}}},
    // SMPL's joints as its add-ons for Blender and engines write them.
    {"SMPL add-on",
     {{"pelvis", "Pelvis"}, {"spine1", "Spine1"}, {"spine2", "Spine2"}, {"spine3", "Spine3"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "L_Hip"}, {"left_knee", "L_Knee"}, {"left_ankle", "L_Ankle"}, {"left_foot", "L_Foot"},
      {"right_hip", "R_Hip"}, {"right_knee", "R_Knee"}, {"right_ankle", "R_Ankle"}, {"right_foot", "R_Foot"},
      {"left_collar", "L_Collar"}, {"left_shoulder", "L_Shoulder"}, {"left_elbow", "L_Elbow"}, {"left_wrist", "L_Wrist"}, {"left_hand", "L_Hand"},
      {"right_collar", "R_Collar"}, {"right_shoulder", "R_Shoulder"}, {"right_elbow", "R_Elbow"}, {"right_wrist", "R_Wrist"}, {"right_hand", "R_Hand"}},
     true, true},
    // Noitom's suits (Axis Neuron): a T-pose without rotations, four joints in the spine, no toes.
    {"Noitom",
     {{"pelvis", "Hips"}, {"spine1", "Spine"}, {"spine2", "Spine1", "+x+y", {}, "Spine2", 0.5}, {"spine3", "Spine3"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
      {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"}, {"left_hand", "LeftHandMiddle1"},
      {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightHand"}, {"right_hand", "RightHandMiddle1"}}},
    // Rigs of game characters: as GLB files hold them, rest rotations are taken out, so that all axes are "+x+y".
    {"Mixamo",
     {{"pelvis", "Hips"}, {"spine1", "Spine"}, {"spine2", "Spine1"}, {"spine3", "Spine2"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
      {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"}, {"left_hand", "LeftHandMiddle1"},
      {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightHand"}, {"right_hand", "RightHandMiddle1"}},
     true, true},
    // Ubisoft's LaFAN1 has Mixamo's names, but in its zero pose all bones lie along x. In a T-pose x runs along the bone
    // and y to the front (of feet up); sides are mirrored by z. Offsets show that of the trunk; limbs are taken to be
    // alike, which was not compared with recordings. Feet are turned by the slope of SMPL's.
    {"LaFAN1",
     {{"pelvis", "Hips", "+z+x"}, {"spine1", "Spine", "+z+x"}, {"spine2", "Spine1", "+z+x"}, {"spine3", "Spine2", "+z+x"}, {"neck", "Neck", "+z+x"}, {"head", "Head", "+z+x"},
      {"left_hip", "LeftUpLeg", "-z-x"}, {"left_knee", "LeftLeg", "-z-x"}, {"left_ankle", "LeftFoot", "-z+y", {23, 0, 0}}, {"left_foot", "LeftToe", "-z+y"},
      {"right_hip", "RightUpLeg", "-z-x"}, {"right_knee", "RightLeg", "-z-x"}, {"right_ankle", "RightFoot", "-z+y", {23, 0, 0}}, {"right_foot", "RightToe", "-z+y"},
      {"left_collar", "LeftShoulder", "+x-z"}, {"left_shoulder", "LeftArm", "+x-z"}, {"left_elbow", "LeftForeArm", "+x-z"}, {"left_wrist", "LeftHand", "+x-z"},
      {"right_collar", "RightShoulder", "-x+z"}, {"right_shoulder", "RightArm", "-x+z"}, {"right_elbow", "RightForeArm", "-x+z"}, {"right_wrist", "RightHand", "-x+z"}}},
    // Xsens' suits, and 100STYLE, recorded with one. Chest is their L5, Chest2 L3, Chest3 T12 and Chest4 T8.
    {"Xsens",
     {{"pelvis", "Hips"}, {"spine1", "Chest"}, {"spine2", "Chest2", "+x+y", {}, "Chest3", 0.5}, {"spine3", "Chest4"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftHip"}, {"left_knee", "LeftKnee"}, {"left_ankle", "LeftAnkle"}, {"left_foot", "LeftToe"},
      {"right_hip", "RightHip"}, {"right_knee", "RightKnee"}, {"right_ankle", "RightAnkle"}, {"right_foot", "RightToe"},
      {"left_collar", "LeftCollar"}, {"left_shoulder", "LeftShoulder"}, {"left_elbow", "LeftElbow"}, {"left_wrist", "LeftWrist"},
      {"right_collar", "RightCollar"}, {"right_shoulder", "RightShoulder"}, {"right_elbow", "RightElbow"}, {"right_wrist", "RightWrist"}}},
    // Rokoko's suits, with the names of Studio's own skeleton ("Newton").
    {"Rokoko",
     {{"pelvis", "Hips"}, {"spine1", "Spine1"}, {"spine2", "Spine2", "+x+y", {}, "Spine3", 0.5}, {"spine3", "Spine4"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftThigh"}, {"left_knee", "LeftShin"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToe"},
      {"right_hip", "RightThigh"}, {"right_knee", "RightShin"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToe"},
      {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"}, {"left_hand", "LeftFinger3Proximal"},
      {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightHand"}, {"right_hand", "RightFinger3Proximal"}}},
    // SOMA, the skeleton of Kimodo and BONES-SEED: LeftLeg is the thigh. Bones lie along x without rotations; axes and turns
    // are those of its T-pose.
    {"SOMA",
     {{"pelvis", "Hips", "+z+x"}, {"spine1", "Spine1", "+z+x"}, {"spine2", "Spine2", "+z+x", {-6, 0, 0}}, {"spine3", "Chest", "+z+x"},
      {"neck", "Neck1", "+z+x", {17, 0, 0}}, {"head", "Head", "+z+x", {-7, 0, 0}},
      {"left_hip", "LeftLeg", "+z-x", {1, 0, 0}}, {"left_knee", "LeftShin", "+z-x", {5, 0, 0}}, {"left_ankle", "LeftFoot", "+z-y", {21, 0, 0}}, {"left_foot", "LeftToeBase", "+z-y", {16, 0, 0}},
      {"right_hip", "RightLeg", "+z+x", {1, 0, 0}}, {"right_knee", "RightShin", "+z+x", {5, 0, 0}}, {"right_ankle", "RightFoot", "+z+y", {21, 0, 0}}, {"right_foot", "RightToeBase", "+z+y", {16, 0, 0}},
      {"left_collar", "LeftShoulder", "+x-z", {0, 20, 0}}, {"left_shoulder", "LeftArm", "+x-z"}, {"left_elbow", "LeftForeArm", "+x-z"}, {"left_wrist", "LeftHand", "+x-z", {10, 0, 0}}, {"left_hand", "LeftHandMiddle1", "+x-z", {10, 0, 0}},
      {"right_collar", "RightShoulder", "+x+z", {0, -20, 0}}, {"right_shoulder", "RightArm", "+x+z"}, {"right_elbow", "RightForeArm", "+x+z"}, {"right_wrist", "RightHand", "+x+z", {10, 0, 0}}, {"right_hand", "RightHandMiddle1", "+x+z", {10, 0, 0}}}},
    {"KayKit",
     {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"}, {"neck", "chest", "+x+y", {}, "head", 0.5}, {"head", "head"},
      {"left_hip", "upperleg.l"}, {"left_knee", "lowerleg.l"}, {"left_ankle", "foot.l"}, {"left_foot", "toes.l"},
      {"right_hip", "upperleg.r"}, {"right_knee", "lowerleg.r"}, {"right_ankle", "foot.r"}, {"right_foot", "toes.r"},
      {"left_shoulder", "upperarm.l"}, {"left_elbow", "lowerarm.l"}, {"left_wrist", "wrist.l"}, {"left_hand", "hand.l"},
      {"right_shoulder", "upperarm.r"}, {"right_elbow", "lowerarm.r"}, {"right_wrist", "wrist.r"}, {"right_hand", "hand.r"}},
     true, true},
    {"Quaternius",
     {{"pelvis", "DEF-hips"}, {"spine1", "DEF-spine.001"}, {"spine2", "DEF-spine.002"}, {"spine3", "DEF-spine.003"}, {"neck", "DEF-neck"}, {"head", "DEF-head"},
      {"left_hip", "DEF-thigh.L"}, {"left_knee", "DEF-shin.L"}, {"left_ankle", "DEF-foot.L"}, {"left_foot", "DEF-toe.L"},
      {"right_hip", "DEF-thigh.R"}, {"right_knee", "DEF-shin.R"}, {"right_ankle", "DEF-foot.R"}, {"right_foot", "DEF-toe.R"},
      {"left_collar", "DEF-shoulder.L"}, {"left_shoulder", "DEF-upper_arm.L"}, {"left_elbow", "DEF-forearm.L"}, {"left_wrist", "DEF-hand.L"}, {"left_hand", "DEF-f_middle.01.L"},
      {"right_collar", "DEF-shoulder.R"}, {"right_shoulder", "DEF-upper_arm.R"}, {"right_elbow", "DEF-forearm.R"}, {"right_wrist", "DEF-hand.R"}, {"right_hand", "DEF-f_middle.01.R"}},
     true, true},
    // The mannequins; the fourth has three joints in the spine and one in the neck.
    {"Unreal 5",
     {{"pelvis", "pelvis"}, {"spine1", "spine_01"}, {"spine2", "spine_03"}, {"spine3", "spine_05"}, {"neck", "neck_01", "+x+y", {}, "neck_02", 0.5}, {"head", "head"},
      {"left_hip", "thigh_l"}, {"left_knee", "calf_l"}, {"left_ankle", "foot_l"}, {"left_foot", "ball_l"},
      {"right_hip", "thigh_r"}, {"right_knee", "calf_r"}, {"right_ankle", "foot_r"}, {"right_foot", "ball_r"},
      {"left_collar", "clavicle_l"}, {"left_shoulder", "upperarm_l"}, {"left_elbow", "lowerarm_l"}, {"left_wrist", "hand_l"}, {"left_hand", "middle_01_l"},
      {"right_collar", "clavicle_r"}, {"right_shoulder", "upperarm_r"}, {"right_elbow", "lowerarm_r"}, {"right_wrist", "hand_r"}, {"right_hand", "middle_01_r"}},
     true, true},
    {"Unreal 4",
     {{"pelvis", "pelvis"}, {"spine1", "spine_01"}, {"spine2", "spine_02"}, {"spine3", "spine_03"}, {"neck", "neck_01"}, {"head", "head"},
      {"left_hip", "thigh_l"}, {"left_knee", "calf_l"}, {"left_ankle", "foot_l"}, {"left_foot", "ball_l"},
      {"right_hip", "thigh_r"}, {"right_knee", "calf_r"}, {"right_ankle", "foot_r"}, {"right_foot", "ball_r"},
      {"left_collar", "clavicle_l"}, {"left_shoulder", "upperarm_l"}, {"left_elbow", "lowerarm_l"}, {"left_wrist", "hand_l"}, {"left_hand", "middle_01_l"},
      {"right_collar", "clavicle_r"}, {"right_shoulder", "upperarm_r"}, {"right_elbow", "lowerarm_r"}, {"right_wrist", "hand_r"}, {"right_hand", "middle_01_r"}},
     true, true},
    // The humanoid bones of VRM, of which chest and neck may be missing. Files name their joints as they like and say
    // which bone each is; VRoid's names are below.
    {"VRM",
     {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "chest"}, {"spine3", "upperChest"}, {"neck", "neck"}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRM without upper chest",
     {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"}, {"neck", "neck"}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRM without chest",
     {{"pelvis", "hips"}, {"spine1", "hips", "+x+y", {}, "spine", 0.5}, {"spine2", "spine"}, {"spine3", "spine"}, {"neck", "neck"}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRM without neck",
     {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"}, {"neck", "chest", "+x+y", {}, "head", 0.5}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRM without chest and neck",
     {{"pelvis", "hips"}, {"spine1", "hips", "+x+y", {}, "spine", 0.5}, {"spine2", "spine"}, {"spine3", "spine"}, {"neck", "spine", "+x+y", {}, "head", 0.5}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRoid",
     {{"pelvis", "J_Bip_C_Hips"}, {"spine1", "J_Bip_C_Spine"}, {"spine2", "J_Bip_C_Chest"}, {"spine3", "J_Bip_C_UpperChest"}, {"neck", "J_Bip_C_Neck"}, {"head", "J_Bip_C_Head"},
      {"left_hip", "J_Bip_L_UpperLeg"}, {"left_knee", "J_Bip_L_LowerLeg"}, {"left_ankle", "J_Bip_L_Foot"}, {"left_foot", "J_Bip_L_ToeBase"},
      {"right_hip", "J_Bip_R_UpperLeg"}, {"right_knee", "J_Bip_R_LowerLeg"}, {"right_ankle", "J_Bip_R_Foot"}, {"right_foot", "J_Bip_R_ToeBase"},
      {"left_collar", "J_Bip_L_Shoulder"}, {"left_shoulder", "J_Bip_L_UpperArm"}, {"left_elbow", "J_Bip_L_LowerArm"}, {"left_wrist", "J_Bip_L_Hand"}, {"left_hand", "J_Bip_L_Middle1"},
      {"right_collar", "J_Bip_R_Shoulder"}, {"right_shoulder", "J_Bip_R_UpperArm"}, {"right_elbow", "J_Bip_R_LowerArm"}, {"right_wrist", "J_Bip_R_Hand"}, {"right_hand", "J_Bip_R_Middle1"}},
     true, true},
    // The Master Motor Map as KIT and TEMOS have it, see known_skeletons.hpp. The joints of the shoulders hang on the lower neck.
    {"MMM",
     {{"pelvis", "root"}, {"spine1", "BP"}, {"spine2", "BP", "+x+y", {}, "BT", 0.5}, {"spine3", "BT"}, {"neck", "BLN"}, {"head", "BUN"},
      {"left_hip", "LH"}, {"left_knee", "LK"}, {"left_ankle", "LA"}, {"left_foot", "LMrot"},
      {"right_hip", "RH"}, {"right_knee", "RK"}, {"right_ankle", "RA"}, {"right_foot", "RMrot"},
      {"left_shoulder", "LS"}, {"left_elbow", "LE"}, {"left_wrist", "LW"},
      {"right_shoulder", "RS"}, {"right_elbow", "RE"}, {"right_wrist", "RW"}},
     true, true},
};
// clang-format on

}  // namespace detail

MOTIONLANG_BODY const std::vector<SkeletonTable>& skeleton_tables() {
  static const std::vector<SkeletonTable> tables(std::begin(detail::known_tables), std::end(detail::known_tables));
  return tables;
}

MOTIONLANG_BODY const SkeletonTable* find_skeleton_table(const Skeleton& source) {
  const SkeletonTable* best = nullptr;
  std::pair<bool, int> most{};
  for (const SkeletonTable& table : skeleton_tables()) {
    if (!table.missing(source).empty()) continue;
    const std::pair fits(detail::StandingSkeleton(source, table).lies().empty(), table.found(source));
    if (best == nullptr || fits > most) best = &table, most = fits;
  }
  return best;
}

MOTIONLANG_BODY const SkeletonTable& detect_skeleton_table(const Skeleton& source) {
  if (const SkeletonTable* fits = find_skeleton_table(source)) return *fits;
  const SkeletonTable* closest = &skeleton_tables().front();
  for (const SkeletonTable& table : skeleton_tables()) {
    if (table.found(source) > closest->found(source)) closest = &table;
  }
  raise<config_error>(103, "detect_skeleton_table: no table fits a skeleton of ", source.size(), " joints (root '",
                      source.names.front(), "'); the closest, ", closest->name, ", needs a joint '",
                      closest->missing(source), "'; ", detail::own_table_hint);
}

MOTIONLANG_BODY const SkeletonTable& skeleton_table(std::string_view name) {
  for (const SkeletonTable& table : skeleton_tables()) {
    if (table.name == name) return table;
  }
  raise<config_error>(103, "skeleton_table: no table '", name, "'");
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
class StandingSkeleton;
}

/// How a map matched the joints of both skeletons.
struct RetargetReport {
  std::string table, target_table;                          // the kinds of source and target
  std::vector<std::pair<std::string, std::string>> mapped;  // joint of the target, joint (or "a + b") of the source
  std::vector<std::string> unmapped;                        // joints of the target that stay at rest
  std::vector<std::string> unused;                          // joints of the source that nothing follows
  double leg_ratio = 1, arm_ratio = 1;  // target / source, 0 without arms; the path is scaled by leg_ratio
};
std::string to_string(const RetargetReport& r);

/// How one skeleton follows another; made once, used for every clip.
class SkeletonMap {
 public:
  /// Throws config_error 103 with the name of a joint that the source's table needs and the source lacks (or, for
  /// unknown axes, or hips that a skeleton lacks), and if a skeleton does not stand at rest by its table; 101 if the
  /// legs of a skeleton have no length.
  SkeletonMap(const Skeleton& source, const SkeletonTable& source_table, const Skeleton& target,
              const SkeletonTable& target_table);
  /// The target has SMPL's names.
  SkeletonMap(const Skeleton& source, const Skeleton& target, const SkeletonTable& source_table)
      : SkeletonMap(source, source_table, target, skeleton_table("SMPL")) {}
  /// With the built-in tables that fit.
  explicit SkeletonMap(const Skeleton& source, const Skeleton& target = smpl24_skeleton())
      : SkeletonMap(source, detect_skeleton_table(source), target, detect_skeleton_table(target)) {}

  const Skeleton& source() const { return source_; }
  const Skeleton& target() const { return target_; }
  const RetargetReport& report() const { return report_; }

  /// One frame: world transforms of the source to root position and local rotations of the target.
  void apply(const JointTransforms<double>& from, Vec3<double>& root, std::span<Quaternion<double>> local) const;

 private:
  struct Link {
    int source = -1, second = -1;
    Quaternion<double> undo{1, 0, 0, 0}, undo_second{1, 0, 0, 0};  // C_s^-1 C_t
    Quaternion<double> at_rest{1, 0, 0, 0};                        // of a joint that follows none, seen from its parent
    double share = 0;
  };

  static Quaternion<double> turned(const JointTransforms<double>& from, int joint, const Quaternion<double>& undo) {
    return to_quaternion(from.rotation[static_cast<std::size_t>(joint)]) * undo;
  }
  static const Vec3<double>& position(const JointTransforms<double>& from, int joint) {
    return from.position[static_cast<std::size_t>(joint)];
  }
  /// A joint of the target seen from its root.
  Vec3<double> from_root(int joint, const std::vector<Quaternion<double>>& world) const;

  /// For joints that no table knows: the joint of the same name, or the same joint of the same finger; -1.
  int namesake(const std::string& name) const;
  void connect(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to);

  /// The rotation that brings a joint of the source from its T-pose to the pose in which it stands like the target.
  /// Limbs are turned along, joint by joint; feet only roll with their shins, unless a table says that they stand
  /// level, so that soles stay level; the trunk is taken as it stands.
  static Quaternion<double> bone_turn(std::string_view role, const detail::StandingSkeleton& from,
                                      const detail::StandingSkeleton& to, const Quaternion<double>& up);

  /// Lengths of legs and arms, and where the hips are.
  void measure(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to);

  Skeleton source_, target_;
  RetargetReport report_;
  std::vector<Link> links_;  // of the target's joints
  int left_hip_ = -1, right_hip_ = -1, target_left_hip_ = -1, target_right_hip_ = -1;
};

/// Moves a clip up or down so that its feet stand on y = 0 as they do in the rest pose: the lowest joint of a frame, in
/// all but the lowest 5 % of the frames, is not below the lowest joint at rest. A rest pose that is below the floor
/// tells nothing of it (the root of many BVH files has OFFSET 0); that joint then stands on y = 0 itself. Returns by
/// how much the clip was moved.
double place_on_floor(Motion& motion);

struct RetargetOptions {
  bool floor = true;  // place_on_floor
};

/// The clip on the target of the map. Throws config_error 106 if its skeleton is not the source of the map.
Motion retarget(const Motion& motion, const SkeletonMap& map, const RetargetOptions& options = {});
/// With the built-in tables that fit the clip and the target; on its own skeleton a motion stays as it is. Throws
/// config_error 103 with the joint that is missing.
Motion retarget(const Motion& motion, const Skeleton& target = smpl24_skeleton(), const RetargetOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_RETARGET_IPP  // <motionlang/kinematics/retarget.ipp>
#define MOTIONLANG_HAS_KINEMATICS_RETARGET_IPP
// Bodies of retarget.hpp.

#ifndef MOTIONLANG_HAS_CORE_QUANTILE_HPP  // <motionlang/core/quantile.hpp>
#define MOTIONLANG_HAS_CORE_QUANTILE_HPP
/// Values by their rank: medians, quartiles, "all but the lowest 5 %".

MOTIONLANG_NAMESPACE_BEGIN

/// The value that n others are not above; n below the number of values.
double nth_smallest(std::vector<double> values, std::size_t n);
/// The value below which a share of the values is; 0 of none.
double quantile(std::vector<double> values, double share);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_CORE_QUANTILE_IPP  // <motionlang/core/quantile.ipp>
#define MOTIONLANG_HAS_CORE_QUANTILE_IPP
// Bodies of quantile.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double nth_smallest(std::vector<double> values, std::size_t n) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(n);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

MOTIONLANG_BODY double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto n = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  return nth_smallest(std::move(values), n);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_GEOMETRY_SLERP_HPP  // <motionlang/geometry/slerp.hpp>
#define MOTIONLANG_HAS_GEOMETRY_SLERP_HPP
/// Interpolation between rotations along the shortest arc.

MOTIONLANG_NAMESPACE_BEGIN

/// Spherical linear interpolation: a at t = 0, b at t = 1, constant angular velocity in between.
///     slerp = (sin((1-t) h) a + sin(t h) b) / sin h,   h = angle between the quaternions (shorter arc)
/// Source  Shoemake, "Animating rotation with quaternion curves" (SIGGRAPH 1985). Below h = 1e-3 a normalised lerp.
template <class S>
Quaternion<S> slerp(const Quaternion<S>& a, const Quaternion<S>& other, const S& t) {
  const S d = dot(a, other), sign = where_less(d, S(0), S(-1), S(1));
  const Quaternion<S> b = sign * other;
  const Quaternion<S> chord = b + (S(-1)) * a, sum = b + a;
  const S half = atan2(norm_or_zero(chord), norm_or_zero(sum));  // exact for small and large angles
  const S h = S(2) * half, limit = S(1e-3), safe = where_less(h, limit, S(1), h);
  const S wa = where_less(h, limit, S(1) - t, sin((S(1) - t) * safe) / sin(safe));
  const S wb = where_less(h, limit, t, sin(t * safe) / sin(safe));
  return normalized(wa * a + wb * b);
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_FINGER_NAMES_HPP  // <motionlang/kinematics/finger_names.hpp>
#define MOTIONLANG_HAS_KINEMATICS_FINGER_NAMES_HPP
/// Joints of fingers by their names, which every program forms in its own way. No table lists them: hands may have any
/// number of fingers.

MOTIONLANG_NAMESPACE_BEGIN

/// SMPL-H's name of a joint of a finger, "left_index1": the side, the finger, and 1, 2 or 3 from the hand on. From
/// "LeftHandIndex1" (Mixamo), "index_01_l" (Unreal), "DEF-f_index.01.L" (Rigify), "lIndex1" (Daz), "leftIndexProximal"
/// (VRM, whose thumbs begin with leftThumbMetacarpal) and their like. "" for another joint, and for tips and other
/// metacarpals.
std::string finger_of(std::string_view joint);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_FINGER_NAMES_IPP  // <motionlang/kinematics/finger_names.ipp>
#define MOTIONLANG_HAS_KINEMATICS_FINGER_NAMES_IPP
// Bodies of finger_names.hpp.

#ifndef MOTIONLANG_HAS_KINEMATICS_JOINT_SIDES_HPP  // <motionlang/kinematics/joint_sides.hpp>
#define MOTIONLANG_HAS_KINEMATICS_JOINT_SIDES_HPP
/// The side of the body that the name of a joint tells, and what its partner may be called.

MOTIONLANG_NAMESPACE_BEGIN

/// Side of the body: a rest pose faces +Z, its left is at +X.
enum class Side : int { middle, left, right };

namespace detail {

/// The side that a joint's name tells: left, Left, l_, _L, .l, _L_, lHand, LHip and the same for the right.
Side side_of_name(std::string_view name);

bool has_side_word(std::string_view name);
/// Possible names of the joint on the other side. A letter may be a coincidence ("lowerback"): look the names up.
std::vector<std::string> other_side(const std::string& name);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_JOINT_SIDES_IPP  // <motionlang/kinematics/joint_sides.ipp>
#define MOTIONLANG_HAS_KINEMATICS_JOINT_SIDES_IPP
// Bodies of joint_sides.hpp.

#include <cctype>     // tolower
#include <iterator>   // begin

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The characters that separate the words of a name.
inline bool is_separator(char c) { return c == '_' || c == '.' || c == '-' || c == ' '; }

/// Where a letter stands alone inside of a name (J_Bip_L_Hand, "Bip01 L Thigh"), or npos.
inline std::size_t lone_letter(std::string_view name, char letter) {
  for (std::size_t at = 1; at + 1 < name.size(); ++at) {
    if (name[at] == letter && is_separator(name[at - 1]) && is_separator(name[at + 1])) return at;
  }
  return name.npos;
}

MOTIONLANG_BODY Side side_of_name(std::string_view name) {
  auto lower = [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); };
  auto is_capital = [](char c) { return c >= 'A' && c <= 'Z'; };
  std::string small(name);
  std::transform(small.begin(), small.end(), small.begin(), lower);
  for (const auto& [side, word] : {std::pair{Side::left, std::string_view("left")}, {Side::right, "right"}}) {
    const char letter = word.front();
    if (small.find(word) != std::string::npos) return side;
    if (name.size() < 2) continue;
    const char second = name[1], before_last = name[name.size() - 2];
    if (small.front() == letter && (second == '_' || second == '.' || is_capital(second))) return side;
    if (small.back() == letter && is_separator(before_last)) return side;
    if (lone_letter(small, letter) != small.npos) return side;
  }
  return Side::middle;
}

/// How names mark their side: words anywhere, single letters at either end or alone (lThigh, UpperArm_L, J_Bip_L_Hand).
inline constexpr std::string_view side_words[][2] = {{"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}};

inline constexpr std::string_view side_letters[][2] = {{"l", "r"}, {"L", "R"}};

MOTIONLANG_BODY bool has_side_word(std::string_view name) {
  return std::any_of(std::begin(side_words), std::end(side_words), [&](const auto& pair) {
    return name.find(pair[0]) != name.npos || name.find(pair[1]) != name.npos;
  });
}

MOTIONLANG_BODY std::vector<std::string> other_side(const std::string& name) {
  std::vector<std::string> candidates;
  auto replaced = [&](std::string_view mark, std::string_view other, std::size_t at) {
    candidates.push_back(std::string(name).replace(at, mark.size(), other));
  };
  for (const int side : {0, 1}) {
    for (const auto& pair : side_words) {
      if (const auto at = name.find(pair[side]); at != name.npos) replaced(pair[side], pair[1 - side], at);
    }
    for (const auto& pair : side_letters) {
      if (name.starts_with(pair[side])) replaced(pair[side], pair[1 - side], 0);
      if (name.ends_with(pair[side])) replaced(pair[side], pair[1 - side], name.size() - 1);
      if (const auto at = lone_letter(name, pair[side][0]); at != name.npos) replaced(pair[side], pair[1 - side], at);
    }
  }
  return candidates;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string finger_of(std::string_view joint) {
  const Side side = detail::side_of_name(joint);
  if (side == Side::middle) return "";
  const std::string_view own = side == Side::left ? "left" : "right", opposite = side == Side::left ? "right" : "left";
  std::string name(joint);
  for (char& c : name) c = detail::lower(c);
  const auto has = [&](std::string_view part) { return name.find(part) != name.npos; };
  if (has(opposite)) return "";
  if (joint == concat_text(own, "ThumbMetacarpal")) return concat_text(own, "_thumb1");
  if (joint == concat_text(own, "ThumbProximal")) return concat_text(own, "_thumb2");
  for (const char* other : {"leaf", "end", "tip", "nub", "meta", "twist"}) {
    if (has(other)) return "";
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> fingers{{{"thumb", "thumb"},
                                                                                  {"index", "index"},
                                                                                  {"mid", "middle"},
                                                                                  {"ring", "ring"},
                                                                                  {"pinky", "pinky"},
                                                                                  {"little", "pinky"}}};
  constexpr std::array<std::string_view, 3> phalanges{"proximal", "intermediate", "distal"};
  for (const auto& [part, finger] : fingers) {
    const std::size_t at = name.find(part);
    if (at == name.npos) continue;
    std::size_t number = 0;
    for (std::size_t i = name.find_first_of("0123456789", at);
         i < name.size() && '0' <= name[i] && name[i] <= '9' && number < 10; ++i)
      number = 10 * number + static_cast<std::size_t>(name[i] - '0');
    for (std::size_t i = 0; i < phalanges.size() && number == 0; ++i) number = has(phalanges[i]) ? i + 1 : 0;
    if (number < 1 || number > 3) return "";
    return std::string(own) + "_" + std::string(finger) + static_cast<char>('0' + number);
  }
  return "";
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string to_string(const RetargetReport& r) {
  auto list = [](const std::vector<std::string>& names) {
    return names.empty() ? std::string("none") : join_text(names);
  };
  auto rounded = [](double x) { return std::round(x * 1000) / 1000; };
  std::vector<std::string> pairs;
  pairs.reserve(r.mapped.size());
  for (const auto& [to, from] : r.mapped) pairs.push_back(from + " -> " + to);
  return concat_text(r.table, " -> ", r.target_table, ": ", r.mapped.size(), " of ",
                     r.mapped.size() + r.unmapped.size(), " joints follow, legs x ", rounded(r.leg_ratio), ", arms x ",
                     rounded(r.arm_ratio), "\n  mapped: ", list(pairs), "\n  target joints at rest: ", list(r.unmapped),
                     "\n  source joints not used: ", list(r.unused));
}

namespace detail {

/// The limb joints whose bones are turned to the target's direction in the rest pose.
inline constexpr std::array<LimbBone, 4> leg_bones{{{"left_hip", "left_knee"},
                                                    {"left_knee", "left_ankle"},
                                                    {"right_hip", "right_knee"},
                                                    {"right_knee", "right_ankle"}}};

inline constexpr std::array<LimbBone, 4> arm_bones{{{"left_shoulder", "left_elbow"},
                                                    {"left_elbow", "left_wrist"},
                                                    {"right_shoulder", "right_elbow"},
                                                    {"right_elbow", "right_wrist"}}};

inline constexpr std::array<LimbBone, 2> hand_bones{{{"left_wrist", "left_hand"}, {"right_wrist", "right_hand"}}};

inline const LimbBone* find_limb_bone(std::string_view joint) {
  for (const std::span<const LimbBone> bones : {std::span<const LimbBone>(leg_bones), {arm_bones}, {hand_bones}}) {
    for (const LimbBone& bone : bones) {
      if (bone.joint == joint) return &bone;
    }
  }
  return nullptr;
}

}  // namespace detail

MOTIONLANG_BODY SkeletonMap::SkeletonMap(const Skeleton& source, const SkeletonTable& source_table,
                                         const Skeleton& target, const SkeletonTable& target_table)
    : source_(source), target_(target) {
  const std::string missing = source_table.missing(source);
  if (!missing.empty()) raise<config_error>(103, "SkeletonMap: ", source_table.name, " needs a joint '", missing, "'");
  report_.table = source_table.name;
  report_.target_table = target_table.name;
  const detail::StandingSkeleton from(source, source_table), to(target, target_table);
  for (const detail::StandingSkeleton* s : {&from, &to}) {
    const std::string lies = s->lies();
    if (!lies.empty())
      raise<config_error>(103, "SkeletonMap: a skeleton of ", s->skeleton.size(), " joints (root '",
                          s->skeleton.name(0), "') does not stand as ", s->table.name, ": ", lies, "; ",
                          detail::own_table_hint, "; option `up` turns another axis up");
  }
  connect(from, to);
  measure(from, to);
}

MOTIONLANG_BODY void SkeletonMap::apply(const JointTransforms<double>& from, Vec3<double>& root,
                                        std::span<Quaternion<double>> local) const {
  std::vector<Quaternion<double>> world(links_.size());
  for (std::size_t t = 0; t < links_.size(); ++t) {
    const Link& link = links_[t];
    const int parent = target_.parents[t];
    const auto up = parent < 0 ? Quaternion<double>::identity() : world[static_cast<std::size_t>(parent)];
    world[t] = up * link.at_rest;
    if (link.source >= 0) world[t] = turned(from, link.source, link.undo);
    if (link.second >= 0) world[t] = slerp(world[t], turned(from, link.second, link.undo_second), link.share);
    local[t] = inverse(up) * world[t];
  }
  const Vec3<double> middle = 0.5 * (position(from, left_hip_) + position(from, right_hip_));
  root = report_.leg_ratio * middle - 0.5 * (from_root(target_left_hip_, world) + from_root(target_right_hip_, world));
}

MOTIONLANG_BODY Vec3<double> SkeletonMap::from_root(int joint, const std::vector<Quaternion<double>>& world) const {
  Vec3<double> p{};
  for (; target_.parent(joint) >= 0; joint = target_.parent(joint)) {
    p = p + rotate(world[static_cast<std::size_t>(target_.parent(joint))], target_.offset(joint));
  }
  return p;
}

MOTIONLANG_BODY int SkeletonMap::namesake(const std::string& name) const {
  int s = source_.find(name);
  const std::string finger = finger_of(bare_joint_name(name));
  for (int k = 0; k < source_.size() && s < 0 && !finger.empty(); ++k) {
    if (finger_of(bare_joint_name(source_.name(k))) == finger) s = k;
  }
  return s;
}

MOTIONLANG_BODY void SkeletonMap::connect(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to) {
  links_.resize(static_cast<std::size_t>(target_.size()));
  std::vector<bool> used(static_cast<std::size_t>(source_.size()), false);
  // of the bones of the source, from its T-pose to the target's
  std::vector<Quaternion<double>> turn(links_.size(), Quaternion<double>::identity());
  for (std::size_t t = 0; t < links_.size(); ++t) {
    Link& link = links_[t];
    const int parent = target_.parents[t];
    const auto up = parent < 0 ? Quaternion<double>::identity() : turn[static_cast<std::size_t>(parent)];
    const std::string role = to.role(static_cast<int>(t));
    turn[t] = bone_turn(role, from, to, up);
    if (parent >= 0) link.at_rest = inverse(to.rotation[static_cast<std::size_t>(parent)]) * to.rotation[t];
    auto follow = [&](int s) {
      used[static_cast<std::size_t>(s)] = true;
      return inverse(turn[t] * from.rotation[static_cast<std::size_t>(s)]) * to.rotation[t];
    };
    const MappedJoint* row = role.empty() ? nullptr : from.table.find(role);
    link.source = row != nullptr ? find_joint(source_, row->source) : role.empty() ? namesake(target_.names[t]) : -1;
    if (link.source < 0) {
      report_.unmapped.push_back(target_.names[t]);
      continue;
    }
    link.undo = follow(link.source);
    std::string name = source_.name(link.source);
    if (row != nullptr && !row->second.empty()) {
      link.second = find_joint(source_, row->second);
      link.undo_second = follow(link.second);
      link.share = row->share;
      name += " + " + source_.name(link.second);
    }
    report_.mapped.emplace_back(target_.names[t], std::move(name));
  }
  for (std::size_t s = 0; s < used.size(); ++s) {
    if (!used[s]) report_.unused.push_back(source_.names[s]);
  }
}

MOTIONLANG_BODY Quaternion<double> SkeletonMap::bone_turn(std::string_view role, const detail::StandingSkeleton& from,
                                                          const detail::StandingSkeleton& to,
                                                          const Quaternion<double>& up) {
  if (const detail::LimbBone* limb = detail::find_limb_bone(role)) {
    const Vec3<double> bone = from.bone(*limb), wanted = to.bone(*limb);
    if (norm(bone) < 1e-9 || norm(wanted) < 1e-9) return up;
    return rotation_between(rotate(up, bone), wanted) * up;
  }
  if (role == "left_ankle" || role == "right_ankle") {
    const detail::LimbBone shin{role == "left_ankle" ? "left_knee" : "right_knee", role};
    auto roll = [&](const detail::StandingSkeleton& s) {
      const Vec3<double> bone = s.bone(shin);
      return s.table.level_soles ? 0 : std::atan2(bone.x, -bone.y);
    };
    return from_axis_angle(Vec3<double>{0, 0, 1}, roll(to) - roll(from));
  }
  const bool follows = role.empty() || role.ends_with("_foot") || role.ends_with("_hand");
  return follows ? up : Quaternion<double>::identity();
}

MOTIONLANG_BODY void SkeletonMap::measure(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to) {
  auto hip = [](const detail::StandingSkeleton& s, std::string_view role) {
    const int j = s.joint(role);
    if (j < 0) raise<config_error>(103, "SkeletonMap: ", s.table.name, " has no '", role, "'");
    return j;
  };
  left_hip_ = hip(from, "left_hip");
  right_hip_ = hip(from, "right_hip");
  target_left_hip_ = hip(to, "left_hip");
  target_right_hip_ = hip(to, "right_hip");
  auto ratio = [&](std::span<const detail::LimbBone> bones) {  // over the bones that both skeletons have
    double here = 0, there = 0;
    for (const detail::LimbBone& bone : bones) {
      const double length = from.length(bone), wanted = to.length(bone);
      if (length > 0 && wanted > 0) here += wanted, there += length;
    }
    return there > 0 ? here / there : 0;
  };
  report_.leg_ratio = ratio(detail::leg_bones);
  report_.arm_ratio = ratio(detail::arm_bones);
  if (!(report_.leg_ratio > 0) || !std::isfinite(report_.leg_ratio)) {
    raise<config_error>(101, "SkeletonMap: legs of no length (target / source = ", report_.leg_ratio, ")");
  }
}

MOTIONLANG_BODY double place_on_floor(Motion& motion) {
  if (motion.frames() == 0) return 0;
  auto lowest = [](std::span<const Vec3<double>> joints) {
    return std::min_element(joints.begin(), joints.end(), [](auto& a, auto& b) { return a.y < b.y; })->y;
  };
  const auto rest = motion.skeleton.rest_positions(), positions = motion.positions();
  std::vector<double> heights;
  for (std::size_t at = 0; at < positions.size(); at += rest.size()) {
    heights.push_back(lowest(std::span(positions).subspan(at, rest.size())));
  }
  const std::size_t lowest_frames = heights.size() / 20;
  const double shift = std::max(lowest(rest), 0.0) - nth_smallest(std::move(heights), lowest_frames);
  for (Vec3<double>& r : motion.root) r.y += shift;
  return shift;
}

MOTIONLANG_BODY Motion retarget(const Motion& motion, const SkeletonMap& map, const RetargetOptions& options) {
  if (motion.skeleton.names != map.source().names || motion.skeleton.parents != map.source().parents) {
    raise<config_error>(106, "retarget: '", motion.name, "' has another skeleton than the map was made for");
  }
  Motion out{map.target(), motion.fps, {}, {}, motion.name};
  out.root.resize(motion.root.size());
  out.local.resize(motion.root.size() * static_cast<std::size_t>(out.skeleton.size()));
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); ++f) {
    motion.world(f, world);
    map.apply(world, out.root[static_cast<std::size_t>(f)], out.rotations(f));
  }
  if (options.floor) place_on_floor(out);
  return out;
}

MOTIONLANG_BODY Motion retarget(const Motion& motion, const Skeleton& target, const RetargetOptions& options) {
  if (motion.skeleton == target) {
    Motion out = motion;
    if (options.floor) place_on_floor(out);
    return out;
  }
  return retarget(motion, SkeletonMap(motion.skeleton, target), options);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct MotionFeatures {
  std::string_view name;
  Index width = 0;
  double fps = 0;    // that the published systems use
  Index joints = 0;  // of `joints_of`: the first ones of `skeleton`
  const Skeleton& (*skeleton)();
  FeatureLayout (*layout)();             // which numbers belong to which body part
  std::span<const FeatureRange> ranges;  // what the numbers mean
  /// The rows of a clip on SMPL's 24 joints, or on the joints of `skeleton`, that has the rate already. Throws
  /// config_error 103 if the joints are others, shape_error 205 if it is too short.
  std::vector<double> (*from_motion)(const Motion& motion);
  /// (frames, joints), Y up, from the origin on. Throws shape_error 205.
  std::vector<Vec3<double>> (*joints_of)(std::span<const double> rows);
  /// A clip on the joints of `skeleton`; null where the rows have no rotations.
  Motion (*to_motion)(std::span<const double> rows, double fps);
};

/// Rotations of 22 joints and translation, Z up, as a clip on SMPL's 24 joints.
template <Scalar S>
Motion motion_of_smplvelp(const SmplVelpMotion<S>& from, double fps) {
  const auto y_up = axis_rotation(0, -std::numbers::pi / 2);
  Motion out{smpl24_skeleton(), fps, {}, {}, {}};
  for (const Vec3<S>& p : from.trans)
    out.root.push_back({static_cast<double>(p.x), static_cast<double>(p.z), -static_cast<double>(p.y)});
  for (std::size_t i = 0; i < from.rotations.size(); ++i) {
    const auto r = matrix_cast<double>(from.rotations[i]);
    out.local.push_back(to_quaternion(i % 22 == 0 ? y_up * r : r));
    if (i % 22 == 21) out.local.insert(out.local.end(), 2, Quaternion<double>::identity());  // hands
  }
  return out;
}

/// Rotations and the way of the root as ACTOR and MDM have them of videos, as a clip on SMPL's 24 joints, on the floor.
/// In the world of the camera the figure stands on its head: it is turned by 180 degrees about x.
template <Scalar S>
Motion motion_of_actor(const ActorMotion<S>& from, double fps) {
  const auto upright = axis_rotation(0, std::numbers::pi);
  Motion out{smpl24_skeleton(), fps, {}, {}, {}};
  for (const Vec3<S>& p : from.root) out.root.push_back(upright * vec_cast<double>(p));
  for (std::size_t i = 0; i < from.rotations.size(); ++i) {
    const auto r = matrix_cast<double>(from.rotations[i]);
    out.local.push_back(to_quaternion(i % 24 == 0 ? upright * r : r));
  }
  place_on_floor(out);
  return out;
}

namespace detail {

/// The first `count` joints of every frame, Y up.
std::vector<Vec3<double>> first_joints(const Motion& motion, std::size_t count);
std::vector<Vec3<double>> turned_up(std::vector<Vec3<double>> points, bool to_z_up);

std::vector<double> guoh3d_rows_of(const Motion& motion);
std::vector<Vec3<double>> joints_of_guoh3d(std::span<const double> rows);

std::vector<double> rifke_rows_of(const Motion& motion);
std::vector<Vec3<double>> joints_of_rifke(std::span<const double> rows);

inline constexpr Index mmm_joints = 21;
inline constexpr double mmm_units_per_metre = 640;

/// The vector from between the ankles to the head, mean over the frames; of MMM's or of SMPL's joints.
Vec3<double> mean_height(std::span<const Vec3<double>> joints, std::size_t count);
/// The way back. The joints are in metres or, if they are large, in KIT's units.
std::vector<Vec3<double>> mmm_in_metres(std::vector<Vec3<double>> joints);

std::vector<double> kit_rows_of(const Motion& motion);
std::vector<Vec3<double>> joints_of_kit(std::span<const double> rows);

std::vector<double> rifke64_rows_of(const Motion& motion);
std::vector<Vec3<double>> joints_of_rifke64(std::span<const double> rows);

std::vector<double> smplvelp_rows(const Motion& motion, bool exact_yaw);
template <bool exact_yaw>
std::vector<double> smplvelp_rows_of(const Motion& motion) {
  return smplvelp_rows(motion, exact_yaw);
}
Motion smplvelp_motion(std::span<const double> rows, double fps);
std::vector<Vec3<double>> joints_of_smplvelp(std::span<const double> rows);

Motion smplrifke_motion(std::span<const double> rows, double fps);
std::vector<Vec3<double>> joints_of_smplrifke(std::span<const double> rows);

}  // namespace detail

/// The way back: what ACTOR's networks read of a clip on SMPL's 24 joints. Throws config_error 103 for other joints.
std::vector<double> actor_rows_of_motion(const Motion& motion, const ActorFeatureOptions& options = {});

namespace detail {

std::vector<double> actor_rows_of(const Motion& motion);
Motion actor_motion(std::span<const double> rows, double fps);
std::vector<Vec3<double>> joints_of_actor(std::span<const double> rows);

FeatureLayout layout_of_guoh3d();
FeatureLayout layout_of_kit();
FeatureLayout layout_of_rifke();
FeatureLayout layout_of_rifke64();
FeatureLayout layout_of_smplvelp();
FeatureLayout layout_of_smplrifke();
FeatureLayout layout_of_actor();

}  // namespace detail

inline constexpr std::array<MotionFeatures, 8> all_motion_features{{
    {"guoh3d", 263, 20, 22, &smpl24_skeleton, &detail::layout_of_guoh3d, guoh3dfeats_ranges, &detail::guoh3d_rows_of,
     &detail::joints_of_guoh3d, nullptr},
    {"kit", 251, 12.5, 21, &kit21_skeleton, &detail::layout_of_kit, kit_ranges, &detail::kit_rows_of,
     &detail::joints_of_kit, nullptr},
    {"rifke", 67, 12.5, 22, &smpl24_skeleton, &detail::layout_of_rifke, rifke_ranges, &detail::rifke_rows_of,
     &detail::joints_of_rifke, nullptr},
    {"rifke64", 64, 12.5, 21, &kit21_skeleton, &detail::layout_of_rifke64, rifke64_ranges, &detail::rifke64_rows_of,
     &detail::joints_of_rifke64, nullptr},
    {"smplvelp", 135, 12.5, 22, &smpl24_skeleton, &detail::layout_of_smplvelp, smplvelp_ranges,
     &detail::smplvelp_rows_of<true>, &detail::joints_of_smplvelp, &detail::smplvelp_motion},
    {"smplvelp-published", 135, 12.5, 22, &smpl24_skeleton, &detail::layout_of_smplvelp, smplvelp_ranges,
     &detail::smplvelp_rows_of<false>, &detail::joints_of_smplvelp, &detail::smplvelp_motion},
    {"smplrifke", smplrifke_size, 20, 22, &smpl24_skeleton, &detail::layout_of_smplrifke, smplrifke_ranges,
     &smplrifke_from_motion, &detail::joints_of_smplrifke, &detail::smplrifke_motion},
    {"actor", 150, 20, 22, &smpl24_skeleton, &detail::layout_of_actor, actor_ranges, &detail::actor_rows_of,
     &detail::joints_of_actor, &detail::actor_motion},
}};

/// The clip of rows, on the joints of the features.
/// fps     0: as the published systems have it
/// Throws  shape_error 205, numeric_error 301 for values that are not finite, config_error 101 for such a rate
Motion motion_of_rows(const MotionFeatures& features, std::span<const double> rows, double fps = 0);

/// Throws config_error 103.
const MotionFeatures& motion_features(std::string_view name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FEATURES_MOTION_FEATURES_IPP  // <motionlang/features/motion_features.ipp>
#define MOTIONLANG_HAS_FEATURES_MOTION_FEATURES_IPP
// Bodies of motion_features.hpp.

#ifndef MOTIONLANG_HAS_FEATURES_GUOH3D_HPP  // <motionlang/features/guoh3d.hpp>
#define MOTIONLANG_HAS_FEATURES_GUOH3D_HPP
/// Joint positions from the 263 numbers per frame of HumanML3D ("guoh3dfeats"), or KIT's 251. The other direction:
/// guoh3d_extraction.hpp; which number is what: Guoh3dSlots in layout.hpp.
///
/// Source  Guo et al. (CVPR 2022), motion_representation.ipynb recover_root_rot_pos, recover_from_ric,
///         recover_from_rot
/// World   Y up, frame 0 at x = z = 0; units as the features have them (metres; KIT: about 1/640 m), not normalised

#ifndef MOTIONLANG_HAS_KINEMATICS_CHAIN_KINEMATICS_HPP  // <motionlang/kinematics/chain_kinematics.hpp>
#define MOTIONLANG_HAS_KINEMATICS_CHAIN_KINEMATICS_HPP
/// Rotations from joint positions and back, along chains of bones: the analytic inverse kinematics of HumanML3D.
///
/// The rotation of a joint is that of the bone that ENDS at it; it has no twist; the first rotation of a chain is
/// relative to the root even where the chain begins at another joint. These are not SMPL's rotations.
///
///     g_j = between(direction_j, p_j - p_parent(j)),   g_0 = root,   q_j = g_before(j)^-1 g_j
///     back:  g_j = g_before(j) q_j,   p_j = p_parent(j) + g_j offset_j
/// Source  Guo et al. (CVPR 2022), HumanML3D common/skeleton.py inverse_kinematics_np, forward_kinematics
/// Shapes  joints (frames, joints), joint fastest, any unit of length

#ifndef MOTIONLANG_HAS_GEOMETRY_GUO_HPP  // <motionlang/geometry/guo.hpp>
#define MOTIONLANG_HAS_GEOMETRY_GUO_HPP
/// The quaternion formulas of HumanML3D, T2M and TM2T, for parity with their features. What is not here is the same as
/// in quaternion.hpp, rotation6d.hpp, euler.hpp (`to_euler`) and axis_angle.hpp.
///
/// They differ where the general functions are safer: `between` has no answer for opposite vectors, `slerp` takes the
/// long way if the quaternions lie in different hemispheres. Use them to reproduce published numbers, not otherwise.
/// Source  Guo et al. (CVPR 2022), HumanML3D common/quaternion.py

MOTIONLANG_NAMESPACE_BEGIN
namespace guo {

/// The shortest rotation from a to b, of any length:  q ~ (|a||b| + a . b, a x b).  NaN for opposite vectors.
/// lengths = |a||b|, where it is known.
template <class S>
Quaternion<S> between(const Vec3<S>& a, const Vec3<S>& b, const S& lengths) {
  const Vec3<S> c = cross(a, b);
  return normalized(Quaternion<S>{lengths + dot(a, b), c.x, c.y, c.z});
}
template <class S>
Quaternion<S> between(const Vec3<S>& a, const Vec3<S>& b) {
  return between(a, b, sqrt(dot(a, a) * dot(b, b)));
}

/// Signs such that each quaternion and the same joint's in the frame before are no more than a half turn apart.
/// rotations (frames, joints). Throws shape_error 205.
template <Scalar S>
std::vector<Quaternion<S>> continuous(std::span<const Quaternion<S>> rotations, Index joints) {
  if (joints <= 0 || std::ssize(rotations) % joints != 0) {
    raise<shape_error>(205, "continuous: ", rotations.size(), " rotations for frames of ", joints, " joints");
  }
  std::vector<Quaternion<S>> out(rotations.begin(), rotations.end());
  const auto n = static_cast<std::size_t>(joints);
  for (std::size_t i = n; i < out.size(); ++i) {
    if (dot(out[i - n], out[i]) < 0) out[i] = -out[i];
  }
  return out;
}

/// a at t = 0, b at t = 1; both are normalised first, and no sign is changed.
///     d = b a^-1 = (cos h, sin h u);   slerp = (cos(t h), sin(t h) u) a
template <class S>
Quaternion<S> slerp(const Quaternion<S>& a, const Quaternion<S>& b, const S& t) {
  const Quaternion<S> from = normalized(a), d = normalized(normalized(b) * inverse(from));
  const S h = atan2(norm(d.vec()), d.w);
  const Vec3<S> u = sin(t * h) * normalized(d.vec(), 1e-9);
  return Quaternion<S>{cos(t * h), u.x, u.y, u.z} * from;
}

/// The quaternion whose component that the published code divides by is positive; w may be negative.
template <Scalar S>
Quaternion<S> matrix_to_quaternion(const Matrix3<S>& m) {
  const Quaternion<S> q = to_quaternion(m);
  const S x = m(0, 0), y = m(1, 1), divisor = m(2, 2) < 0 ? (x > y ? q.x : q.y) : (x < -y ? q.z : q.w);
  return divisor < 0 ? -q : q;
}

/// From angles about x, y and z in degrees, whatever the order. For the cyclic orders xyz, yzx and zxy the sign of the
/// quaternion is the other one.
template <Scalar S>
Quaternion<S> from_euler_degrees(const Vec3<S>& angles, EulerOrder order) {
  Quaternion<S> q = Quaternion<S>::identity();
  for (const int axis : order.axis) {
    const Vec3<S> about{S(axis == 0), S(axis == 1), S(axis == 2)};
    q = q * from_axis_angle(about, dot(about, angles) * S(degree));
  }
  return (order.axis[1] - order.axis[0] + 3) % 3 == 1 ? -q : q;
}

}  // namespace guo
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_GAUSSIAN_SMOOTH_HPP  // <motionlang/kinematics/gaussian_smooth.hpp>
#define MOTIONLANG_HAS_KINEMATICS_GAUSSIAN_SMOOTH_HPP
/// Smoothing of curves over time.

MOTIONLANG_NAMESPACE_BEGIN

/// From 0 at 0 to 1 at 1, level at both ends: s^2 (3 - 2 s).
constexpr double smoothstep(double s) { return s * s * (3 - 2 * s); }

/// Gaussian filter along time.
///     y_t = sum_k w_k x_{t+k},   w_k ~ exp(-k^2 / (2 sigma^2)),   |k| <= floor(4 sigma + 1/2),   sum w = 1
/// Beyond the ends the first and last frame go on. The sum is taken in double, as scipy does.
/// Source  scipy.ndimage.gaussian_filter1d, mode "nearest"; MotionDiffuse smooths joints with sigma 1
/// Shapes  values (frames, width) -> the same
/// Throws  config_error 101 (sigma), shape_error 205 (size)
template <Scalar S>
std::vector<S> gaussian_smooth(std::span<const S> values, Index width, double sigma) {
  if (!(sigma > 0) || !std::isfinite(sigma)) raise<config_error>(101, "gaussian_smooth: sigma ", sigma);
  if (width <= 0 || std::ssize(values) % width != 0) {
    raise<shape_error>(205, "gaussian_smooth: ", values.size(), " values are not rows of ", width);
  }
  if (values.empty()) return {};
  const auto radius = static_cast<Index>(4 * sigma + 0.5);  // NOLINT(bugprone-incorrect-roundings): as scipy does
  std::vector<double> kernel;
  double sum = 0;
  for (Index k = -radius; k <= radius; ++k) {
    kernel.push_back(std::exp(-0.5 * static_cast<double>(k * k) / (sigma * sigma)));
    sum += kernel.back();
  }
  for (double& w : kernel) w /= sum;
  const Index frames = std::ssize(values) / width, size = frames * width;
  std::vector<double> longer, sums(values.size());  // the values with the ends going on
  for (Index t = -radius; t < frames + radius; ++t) {
    const auto row = values.subspan(static_cast<std::size_t>(std::clamp<Index>(t, 0, frames - 1) * width));
    for (Index c = 0; c < width; ++c) longer.push_back(static_cast<double>(row[static_cast<std::size_t>(c)]));
  }
  for (Index k = 0; k <= radius; ++k) {  // the kernel is the same on both sides
    const double w = kernel[static_cast<std::size_t>(radius + k)] / (k == 0 ? 2 : 1);
    const double *before = longer.data() + (radius - k) * width, *after = longer.data() + (radius + k) * width;
    for (Index i = 0; i < size; ++i) sums[static_cast<std::size_t>(i)] += w * (before[i] + after[i]);
  }
  return std::vector<S>(sums.begin(), sums.end());
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_GUO_CHAINS_HPP  // <motionlang/kinematics/guo_chains.hpp>
#define MOTIONLANG_HAS_KINEMATICS_GUO_CHAINS_HPP
/// A body as chains of joints with one zero direction for every bone: what HumanML3D and KIT need to know of a
/// skeleton.
///
/// Source  Guo et al., "Generating diverse and natural 3D human motions from text" (CVPR 2022), HumanML3D
///         paramUtil.py
/// World   Y up, a body faces +Z with its left side at +X (KIT's coordinates are mirrored, see below)

MOTIONLANG_NAMESPACE_BEGIN

/// The bone that ends at `joint`. `before` is the joint whose rotation goes ahead of it: the one before in its chain,
/// but the root for the first bone of a chain, also where the chain branches off elsewhere.
struct ChainBone {
  std::size_t joint = 0, parent = 0, before = 0;
};

/// Chains are walked one after the other; each begins at the root (joint 0) or at a joint of an earlier chain.
struct ChainSkeleton {
  std::string name;
  std::vector<std::vector<int>> chains;
  std::vector<Vec3<double>> directions;  // unit vector of the bone that ends at each joint; nothing for the root
  std::array<int, 4> face{};             // right hip, left hip, right shoulder, left shoulder: where it looks
  std::array<int, 2> leg{};              // joints at which thigh and shank end: how tall it is
  std::array<int, 2> left_foot{}, right_foot{};  // ankle and toes: where it touches the floor
  double foot_threshold = 0;                     // a foot stands if its squared displacement per frame is smaller
  double fps = 20;
  std::vector<double> lengths{};  // of the bones of the reference skeleton; empty if not published

  std::size_t size() const { return directions.size(); }

  /// All bones in the order of the chains, parents first. Throws config_error 106 unless every joint but the root ends
  /// one bone, chains begin where earlier ones have been, and all joints and directions are there.
  std::vector<ChainBone> bones() const;
  /// Throws as bones().
  void validate() const { bones(); }
  /// Parent of each joint, -1 for the root.
  std::vector<int> parents() const;
};

/// HumanML3D: the first 22 joints of SMPL, metres, 20 frames per second. Lengths: first frame of its clip 000021.
const ChainSkeleton& humanml3d_chains();

/// KIT Motion-Language: 21 joints of the Master Motor Map, about 640 units per metre, 12.5 frames per second. The names
/// of the data set are mirrored: joints 11 ... 15 and 5 ... 7 ("L") are the right side of the body, and so they are
/// taken. The threshold is published in metres although the data are not, hence contacts are hardly ever on. The
/// lengths of the reference clip 03950 are not published.
const ChainSkeleton& kit_chains();

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_GUO_CHAINS_IPP  // <motionlang/kinematics/guo_chains.ipp>
#define MOTIONLANG_HAS_KINEMATICS_GUO_CHAINS_IPP
// Bodies of guo_chains.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<ChainBone> ChainSkeleton::bones() const {
  std::vector<ChainBone> out;
  std::vector<bool> placed(size(), false);
  auto known = [&](int joint) { return joint >= 0 && static_cast<std::size_t>(joint) < size(); };
  if (size() == 0) raise<config_error>(106, "ChainSkeleton '", name, "': no joints");
  placed[0] = true;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (std::size_t k = 0; k < chains[c].size(); ++k) {
      const int joint = chains[c][k];
      const bool expected = k == 0;
      if (!known(joint) || placed[static_cast<std::size_t>(joint)] != expected) {
        raise<config_error>(106, "ChainSkeleton '", name, "': joint ", joint, " of chain ", c,
                            !known(joint) ? " does not exist"
                            : expected    ? " begins it, but no chain before contains it"
                                          : " has a bone already");
      }
      if (k == 0) continue;
      const auto j = static_cast<std::size_t>(joint), parent = static_cast<std::size_t>(chains[c][k - 1]);
      const double length = norm(directions[j]);
      if (std::abs(length - 1) > 1e-6) {
        raise<config_error>(106, "ChainSkeleton '", name, "': the direction of joint ", j, " has length ", length);
      }
      placed[j] = true;
      out.push_back({j, parent, k == 1 ? 0 : parent});
    }
  }
  if (out.size() + 1 != size()) {
    raise<config_error>(106, "ChainSkeleton '", name, "': bones end at ", out.size(), " of ", size() - 1, " joints");
  }
  for (const int j :
       {face[0], face[1], face[2], face[3], leg[0], leg[1], left_foot[0], left_foot[1], right_foot[0], right_foot[1]}) {
    if (!known(j)) raise<config_error>(106, "ChainSkeleton '", name, "': no joint ", j, " among ", size());
  }
  return out;
}

MOTIONLANG_BODY std::vector<int> ChainSkeleton::parents() const {
  std::vector<int> out(size(), -1);
  for (const ChainBone& b : bones()) out[b.joint] = static_cast<int>(b.parent);
  return out;
}

MOTIONLANG_BODY const ChainSkeleton& humanml3d_chains() {
  static const ChainSkeleton skeleton{
      .name = "HumanML3D",
      .chains = {{0, 2, 5, 8, 11}, {0, 1, 4, 7, 10}, {0, 3, 6, 9, 12, 15}, {9, 14, 17, 19, 21}, {9, 13, 16, 18, 20}},
      .directions = {{0, 0, 0},  {1, 0, 0},  {-1, 0, 0}, {0, 1, 0},  {0, -1, 0}, {0, -1, 0}, {0, 1, 0},  {0, -1, 0},
                     {0, -1, 0}, {0, 1, 0},  {0, 0, 1},  {0, 0, 1},  {0, 1, 0},  {1, 0, 0},  {-1, 0, 0}, {0, 0, 1},
                     {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}},
      .face = {2, 1, 17, 16},
      .leg = {5, 8},
      .left_foot = {7, 10},
      .right_foot = {8, 11},
      .foot_threshold = 0.002,
      .fps = 20,
      .lengths = {0,          0.10307397, 0.10988337, 0.13156824, 0.3936232,  0.39018822, 0.14319022, 0.43243307,
                  0.42564335, 0.05736474, 0.14338182, 0.14941907, 0.21936005, 0.13748677, 0.14338283, 0.10303922,
                  0.13161404, 0.12298438, 0.25684,    0.26309174, 0.26601171, 0.2698764}};
  return skeleton;
}

MOTIONLANG_BODY const ChainSkeleton& kit_chains() {
  static const ChainSkeleton skeleton{
      .name = "KIT",
      .chains = {{0, 11, 12, 13, 14, 15}, {0, 16, 17, 18, 19, 20}, {0, 1, 2, 3, 4}, {3, 5, 6, 7}, {3, 8, 9, 10}},
      .directions = {{0, 0, 0},  {0, 1, 0},  {0, 1, 0},  {0, 1, 0},  {0, 1, 0},  {1, 0, 0},  {0, -1, 0},
                     {0, -1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, -1, 0}, {1, 0, 0},  {0, -1, 0}, {0, -1, 0},
                     {0, 0, 1},  {0, 0, 1},  {-1, 0, 0}, {0, -1, 0}, {0, -1, 0}, {0, 0, 1},  {0, 0, 1}},
      .face = {11, 16, 5, 8},
      .leg = {17, 18},
      .left_foot = {19, 20},
      .right_foot = {14, 15},
      .foot_threshold = 0.05,
      .fps = 12.5};
  return skeleton;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct FacingOptions {
  double sigma = 0;            // frames; of the Gaussian filter over time, 0: none
  bool legacy_forward = true;  // as published: hips count left minus right; false: right minus left, as shoulders do
};
struct ChainRotationOptions {
  FacingOptions facing{};
  bool fix_first_frame = false;     // false, as published: the root of frame 0 is the identity, whatever it faces
  bool fix_opposite_bones = false;  // false, as published: NaN for a bone exactly opposite to its zero direction, and
                                    // for a body that faces -Z
};

namespace detail {

/// Number of frames. Throws shape_error 205 if the joints are not whole frames.
template <class T>
std::size_t chain_frames(std::string_view function, const ChainSkeleton& skeleton, std::span<const T> values) {
  const std::size_t frames = values.size() / std::max<std::size_t>(skeleton.size(), 1);
  if (values.size() != frames * skeleton.size()) {
    raise<shape_error>(205, function, ": ", values.size(), " values are not frames of ", skeleton.size(), " joints");
  }
  return frames;
}

/// Throws numeric_error 302 for a bone of length 0, 301 for one that is not finite.
template <Scalar S>
[[noreturn]] void refuse_bone(const ChainSkeleton& skeleton, const ChainBone& bone, std::size_t frame, S length) {
  raise<numeric_error>(length == 0 ? 302 : 301, "'", skeleton.name, "' frame ", frame, ": the bone from joint ",
                       bone.parent, " to ", bone.joint, " has length ", length);
}
/// The vector from a bone's parent to its joint, and its length, which is positive.
template <Scalar S>
struct MeasuredBone {
  Vec3<S> vector;
  S length;
};
template <Scalar S>
MeasuredBone<S> measure_bone(const ChainSkeleton& skeleton, const ChainBone& bone, const Vec3<S>* joints,
                             std::size_t frame) {
  const Vec3<S> v = joints[bone.joint] - joints[bone.parent];
  const S length = norm(v);
  if (!(length > 0 && length < std::numeric_limits<S>::infinity())) refuse_bone(skeleton, bone, frame, length);
  return {v, length};
}

/// The joint that a skeleton names by number.
template <class T>
const T& joint_of(const T* frame, int joint) {
  return frame[static_cast<std::size_t>(joint)];
}

}  // namespace detail

/// Lengths of the bones in one frame, 0 for the root. Throws shape_error 205, numeric_error 301, 302.
template <Scalar S>
std::vector<S> bone_lengths(const ChainSkeleton& skeleton, std::span<const Vec3<S>> frame) {
  if (frame.size() != skeleton.size()) {
    raise<shape_error>(205, "bone_lengths: ", frame.size(), " joints for a skeleton of ", skeleton.size());
  }
  std::vector<S> out(skeleton.size());
  for (const ChainBone& b : skeleton.bones()) {
    out[b.joint] = detail::measure_bone(skeleton, b, frame.data(), 0).length;
  }
  return out;
}

/// Zero direction times length for every joint. Throws shape_error 204 unless there is one length for each joint.
template <Scalar S, Scalar L>
std::vector<Vec3<S>> chain_offsets(const ChainSkeleton& skeleton, std::span<const L> lengths) {
  if (lengths.size() != skeleton.size()) {
    raise<shape_error>(204, "chain_offsets: ", lengths.size(), " lengths for ", skeleton.size(), " joints");
  }
  std::vector<Vec3<S>> out;
  for (std::size_t j = 0; j < lengths.size(); ++j) {
    out.push_back(static_cast<S>(lengths[j]) * vec_cast<S>(skeleton.directions[j]));
  }
  return out;
}

/// Where a body faces in one frame, frame at its first joint: level, not of unit length (shorter if hips and shoulders
/// are not level).
///     a = (hip_r - hip_l) + (shoulder_r - shoulder_l) normalised,   forward = Y x a
/// legacy: the hips are taken the other way round, as the published inverse kinematics does.
template <Scalar S>
Vec3<S> facing(const ChainSkeleton& skeleton, const Vec3<S>* frame, bool legacy) {
  auto across = [&](std::size_t right, std::size_t left) {
    return detail::joint_of(frame, skeleton.face[right]) - detail::joint_of(frame, skeleton.face[left]);
  };
  const Vec3<S> hips = across(0, 1), a = normalized((legacy ? -hips : hips) + across(2, 3));
  return {a.z, S(0), -a.x};
}

/// Where it faces in every frame, unit vectors. Throws shape_error 205, config_error 101 (sigma) and 106.
template <Scalar S>
std::vector<Vec3<S>> facing_directions(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                       const FacingOptions& options = {}) {
  const std::size_t frames = detail::chain_frames("facing_directions", skeleton, joints);
  skeleton.validate();
  std::vector<S> level;  // (frames, 2): x and z
  for (std::size_t t = 0; t < frames; ++t) {
    const Vec3<S> f = facing(skeleton, &joints[t * skeleton.size()], options.legacy_forward);
    level.insert(level.end(), {f.x, f.z});
  }
  if (options.sigma != 0) level = gaussian_smooth(std::span<const S>(level), 2, options.sigma);
  std::vector<Vec3<S>> out;
  for (std::size_t t = 0; t < frames; ++t) out.push_back(normalized(Vec3<S>{level[2 * t], S(0), level[2 * t + 1]}));
  return out;
}

namespace detail {

/// The turn about Y that takes a level direction onto +Z, half a turn for -Z.
template <Scalar S>
Quaternion<S> turn_ahead(const Vec3<S>& level) {
  const S half = std::atan2(level.x, level.z) / 2;
  return {std::cos(half), S(0), -std::sin(half), S(0)};
}

/// Rotations of the root in all frames.
template <Scalar S>
std::vector<Quaternion<S>> chain_roots(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                       const ChainRotationOptions& options) {
  std::vector<Quaternion<S>> out;
  for (const Vec3<S>& forward : facing_directions(skeleton, joints, options.facing)) {
    const Vec3<S> ahead{S(0), S(0), S(1)};
    const bool replaced = out.empty() && !options.fix_first_frame;
    out.push_back(replaced                     ? Quaternion<S>::identity()
                  : options.fix_opposite_bones ? turn_ahead(forward)
                                               : guo::between(forward, ahead));
  }
  return out;
}

/// Rotations of all joints of one frame, or of one frame in each lane.
/// zero    directions of the bones
/// world   workspace (joints)
/// local   result (joints)
/// Returns 0 where all bones have a length.
template <ScalarLike T>
T chain_rotations(std::span<const ChainBone> bones, std::span<const Vec3<T>> zero, const Vec3<T>* joints,
                  const Quaternion<T>& root, bool fix_opposite, Quaternion<T>* world, Quaternion<T>* local) {
  const T none = T(0), one = T(1), infinite = T(std::numeric_limits<float>::max());
  T bad = none;
  world[0] = local[0] = root;
  for (const ChainBone& b : bones) {
    const Vec3<T> v = joints[b.joint] - joints[b.parent];
    const T squared = dot(v, v);
    bad = bad + where_less(none, squared, where_less(squared, infinite, none, one), one);
    world[b.joint] = fix_opposite ? rotation_between(zero[b.joint], v) : guo::between(zero[b.joint], v, sqrt(squared));
    local[b.joint] = inverse(world[b.before]) * world[b.joint];
  }
  return bad;
}

/// Throws numeric_error 301 or 302 for the first bone of a frame that has no direction.
template <Scalar S>
void require_bones(const ChainSkeleton& skeleton, std::span<const ChainBone> bones, const Vec3<S>* joints,
                   std::size_t frame) {
  for (const ChainBone& b : bones) measure_bone(skeleton, b, joints, frame);
}

}  // namespace detail

/// result  (frames, joints); joint 0: the rotation that turns the facing direction onto +Z
/// Throws  shape_error 205, config_error 101 (sigma) and 106, numeric_error 301 and 302 for a bone without direction
template <Scalar S>
std::vector<Quaternion<S>> chain_inverse_kinematics(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                                    const ChainRotationOptions& options = {}) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("chain_inverse_kinematics", skeleton, joints);
  const auto bones = skeleton.bones();
  const auto roots = detail::chain_roots(skeleton, joints, options);
  const auto zero = chain_offsets<S>(skeleton, std::span<const S>(std::vector<S>(n, S(1))));
  std::vector<Quaternion<S>> out(frames * n), world(n);
  for (std::size_t t = 0; t < frames; ++t) {
    const S bad = detail::chain_rotations<S>(bones, zero, &joints[t * n], roots[t], options.fix_opposite_bones,
                                             world.data(), &out[t * n]);
    if (bad > 0) detail::require_bones(skeleton, bones, &joints[t * n], t);
  }
  return out;
}

/// local    (frames, joints), quaternions or matrices
/// root     (frames)
/// offsets  (joints), or (frames, joints) if bones change over time; see chain_offsets
/// result   (frames, joints)
/// Throws   shape_error 204, 205, config_error 106
template <Rotation R, Scalar S>
std::vector<Vec3<S>> chain_forward_kinematics(const ChainSkeleton& skeleton, std::span<const R> local,
                                              std::span<const Vec3<S>> root, std::span<const Vec3<S>> offsets,
                                              bool root_rotation = true) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("chain_forward_kinematics", skeleton, local);
  if (root.size() != frames || (offsets.size() != n && offsets.size() != local.size())) {
    raise<shape_error>(204, "chain_forward_kinematics: ", frames, " frames of ", n, " joints, ", root.size(),
                       " root positions, ", offsets.size(), " offsets");
  }
  const auto bones = skeleton.bones();
  std::vector<Vec3<S>> out(local.size());
  std::vector<R> world(n);
  for (std::size_t t = 0; t < frames; ++t) {
    Vec3<S>* position = &out[t * n];
    const Vec3<S>* offset = &offsets[offsets.size() == n ? 0 : t * n];
    position[0] = root[t];
    world[0] = root_rotation ? local[t * n] : R::identity();
    for (const ChainBone& b : bones) {
      world[b.joint] = world[b.before] * local[t * n + b.joint];
      position[b.joint] = position[b.parent] + rotate(world[b.joint], offset[b.joint]);
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The path of the root. `turn` takes directions of the world to those seen from the body.
template <Scalar S>
struct Guoh3dRoot {
  std::vector<Quaternion<S>> turn;  // (frames)
  std::vector<Vec3<S>> position;    // (frames)
};

struct Guoh3dRecovery {
  /// Adds the frame behind the last one: as features of T frames of joints are T - 1 rows, this gives all T back. Its
  /// positions are those of the last row moved by the last row's velocities.
  bool last_frame = false;
};

namespace detail {

template <Scalar S>
Vec3<S> vector_at(std::span<const S> values, Index at) {
  const auto i = static_cast<std::size_t>(at);
  return {values[i], values[i + 1], values[i + 2]};
}
/// Rows of the features. Throws shape_error 205 if they are not whole, config_error 101 for a body without joints.
template <Scalar S>
std::size_t guoh3d_rows(std::string_view function, std::span<const S> features, Index joints) {
  const Index width = Guoh3dSlots{joints}.size();
  if (joints < 1) raise<config_error>(101, function, ": ", joints, " joints");
  if (std::ssize(features) % width != 0) {
    raise<shape_error>(205, function, ": ", features.size(), " values are not rows of ", width, " (", joints,
                       " joints)");
  }
  return features.size() / static_cast<std::size_t>(width);
}

}  // namespace detail

/// features (frames, 12 J - 1)
///     a_t = sum_{s<t} f[s, 0],   r_t = (cos a_t, 0, sin a_t, 0)
///     p_t = p_{t-1} + r_t^-1 (f[t-1, 1], 0, f[t-1, 2]),   p_t.y = f[t, 3]
/// Throws shape_error 205, config_error 101
template <Scalar S>
Guoh3dRoot<S> guoh3d_root(std::span<const S> features, Index joints = 22) {
  const std::size_t frames = detail::guoh3d_rows("guoh3d_root", features, joints);
  const auto width = static_cast<std::size_t>(Guoh3dSlots{joints}.size());
  Guoh3dRoot<S> out;
  S angle{};
  Vec3<S> p{};
  for (std::size_t t = 0; t < frames; ++t) {
    const auto row = features.subspan(t * width, width);
    const Quaternion<S> turn{cos(angle), S(0), sin(angle), S(0)};
    if (t > 0) {
      const S* before = row.data() - width;
      p = p + rotate(inverse(turn), Vec3<S>{before[1], S(0), before[2]});
    }
    p.y = row[3];
    out.turn.push_back(turn);
    out.position.push_back(p);
    angle += row[0];
  }
  return out;
}

/// features (frames, 12 J - 1) -> (frames, J), or (frames + 1, J) with `last_frame`, from the positions of the rows.
///     X_{t,j} = r_t^-1 ric_{t,j} + (p_t.x, 0, p_t.z),   X_{t,0} = p_t
/// Throws shape_error 205, config_error 101
template <Scalar S>
std::vector<Vec3<S>> guoh3d_joints(std::span<const S> features, Index joints = 22, const Guoh3dRecovery& options = {}) {
  const auto root = guoh3d_root(features, joints);
  const Guoh3dSlots slots{joints};
  const std::size_t frames = root.turn.size();
  std::vector<Vec3<S>> out;
  out.reserve((frames + 1) * static_cast<std::size_t>(joints));
  for (std::size_t t = 0; t < frames; ++t) {
    const auto row = features.subspan(t * static_cast<std::size_t>(slots.size()));
    const auto back = inverse(root.turn[t]);
    const Vec3<S>& p = root.position[t];
    out.push_back(p);
    for (Index j = 1; j < joints; ++j) {
      out.push_back(rotate(back, detail::vector_at(row, slots.positions().begin + 3 * (j - 1))) +
                    Vec3<S>{p.x, S(0), p.z});
    }
  }
  if (options.last_frame && frames > 0) {
    const auto row = features.last(static_cast<std::size_t>(slots.size()));
    const auto back = inverse(root.turn.back());
    for (Index j = 0; j < joints; ++j) {
      const Vec3<S> before = out[out.size() - static_cast<std::size_t>(joints)];
      out.push_back(before + rotate(back, detail::vector_at(row, slots.velocities().begin + 3 * j)));
    }
  }
  return out;
}

/// The same from the rotations of the rows, on bones of other lengths.
/// offsets  (joints), see chain_offsets
/// Throws   shape_error 204, 205, config_error 101, 106
template <Scalar S>
std::vector<Vec3<S>> guoh3d_joints_from_rotations(const ChainSkeleton& skeleton, std::span<const S> features,
                                                  std::span<const Vec3<S>> offsets) {
  const Guoh3dSlots slots{static_cast<Index>(skeleton.size())};
  const auto root = guoh3d_root(features, slots.joints);
  std::vector<Matrix3<S>> local;
  local.reserve(root.turn.size() * skeleton.size());
  for (std::size_t t = 0; t < root.turn.size(); ++t) {
    const auto row = features.subspan(t * static_cast<std::size_t>(slots.size()));
    local.push_back(to_matrix(root.turn[t]));
    for (Index at = slots.rotations().begin; at < slots.rotations().end; at += 6) {
      local.push_back(to_matrix(Rotation6dColumns<S>{detail::vector_at(row, at), detail::vector_at(row, at + 3)}));
    }
  }
  return chain_forward_kinematics(skeleton, std::span<const Matrix3<S>>(local), std::span<const Vec3<S>>(root.position),
                                  offsets);
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_FEATURES_GUOH3D_EXTRACTION_HPP  // <motionlang/features/guoh3d_extraction.hpp>
#define MOTIONLANG_HAS_FEATURES_GUOH3D_EXTRACTION_HPP
/// The 263 numbers per frame of HumanML3D ("guoh3dfeats"), or KIT's 251, from joint positions: onto the reference
/// skeleton, onto the floor, facing +Z, then rotations, velocities and contacts. Back: guoh3d.hpp.
///
///     auto features = guoh3d_features(humanml3d_chains(), joints);     // (frames, 22) -> (frames - 1, 263)
///
/// Another body is another ChainSkeleton. Which number is what: Guoh3dSlots in layout.hpp.
///
/// Source  Guo et al. (CVPR 2022), motion_representation.ipynb process_file, extract_features
/// World   Y up; velocities and turns per frame (20 frames per second, KIT 12.5)

#ifndef MOTIONLANG_HAS_CORE_LANE_ROWS_HPP  // <motionlang/core/lane_rows.hpp>
#define MOTIONLANG_HAS_CORE_LANE_ROWS_HPP
/// Rows of numbers into lanes, number k of row i in lane i of number k, and back.
///
/// Floats go four at a time: a register is made of pieces of 16 bytes, and piece i of register r takes four numbers of
/// row 4 i + r. In four such registers the squares of four by four that stand at the same piece are transposed.

#ifndef MOTIONLANG_HAS_CORE_LANE_HPP  // <motionlang/core/lane.hpp>
#define MOTIONLANG_HAS_CORE_LANE_HPP
/// A handful of numbers that are calculated with at once: one SIMD register as a `ScalarLike`.
///
/// Geometry over `Lane<float>` treats eight poses at a time with the same source text as for one; with
/// `with_widest_lanes` as many as a register of this processor holds. The compiler's vector types are used, so the code
/// is the same on every processor. Square roots are refined from an estimate (error below 2 ulp).

MOTIONLANG_NAMESPACE_BEGIN

// Everything below is inlined: how such vectors are passed between functions depends on the caller's instruction set.
#define MOTIONLANG_INLINE inline __attribute__((always_inline))

template <Scalar S, int bytes = 32>
struct Lane {
  static constexpr int size = bytes / static_cast<int>(sizeof(S));
  typedef S Register __attribute__((vector_size(bytes)));
  using Bits = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
  typedef Bits BitRegister __attribute__((vector_size(bytes)));

  alignas(bytes) Register v{};  // said, since GCC aligns it less where such registers are not switched on

  Lane() = default;
  /// Not trivial on purpose: other functions then return a lane through memory, whatever their caller was compiled for.
  MOTIONLANG_INLINE Lane(const Lane& other) : v(other.v) {}
  Lane& operator=(const Lane&) = default;
  template <class N>
  requires std::is_arithmetic_v<N>
  explicit MOTIONLANG_INLINE Lane(N x) : v(static_cast<S>(x) - Register{}) {}
  static MOTIONLANG_INLINE Lane from(const Register& r) {
    Lane l;
    l.v = r;
    return l;
  }
  MOTIONLANG_INLINE S& operator[](int i) { return reinterpret_cast<S*>(&v)[i]; }
  MOTIONLANG_INLINE S operator[](int i) const { return v[i]; }

  friend MOTIONLANG_INLINE Lane operator+(const Lane& a, const Lane& b) { return from(a.v + b.v); }
  friend MOTIONLANG_INLINE Lane operator-(const Lane& a, const Lane& b) { return from(a.v - b.v); }
  friend MOTIONLANG_INLINE Lane operator*(const Lane& a, const Lane& b) { return from(a.v * b.v); }
  friend MOTIONLANG_INLINE Lane operator/(const Lane& a, const Lane& b) { return from(a.v / b.v); }
  friend MOTIONLANG_INLINE Lane operator-(const Lane& a) { return from(-a.v); }
  friend MOTIONLANG_INLINE Lane where_less(const Lane& a, const Lane& b, const Lane& x, const Lane& y) {
    return from(a.v < b.v ? x.v : y.v);
  }

  /// 1 / sqrt(x) of a normal number x > 0, error below 2 ulp; finite of 0.
  /// The well-known estimate by shifting the exponent, 3.5 % off, then Householder's iteration: with y = (1 + e) /
  /// sqrt(x) and h = x y^2, the first terms of y / sqrt(h) around h = 1, which leave 2.5 e^3.
  friend MOTIONLANG_INLINE Lane inverse_sqrt(const Lane& x) {
    constexpr Bits magic = sizeof(S) == 4 ? static_cast<Bits>(0x5F375A86) : static_cast<Bits>(0x5FE6EB50C7B537A9);
    Register y = (Register)(magic - ((BitRegister)x.v >> 1));
    for (int i = 0; i < (sizeof(S) == 4 ? 2 : 3); ++i) {
      const Register h = x.v * y * y;
      y = y * (S(1.875) - h * (S(1.25) - S(0.375) * h));
    }
    return from(y);
  }
  /// x / sqrt(x), and one correction of the root itself. 0 for 0.
  friend MOTIONLANG_INLINE Lane sqrt(const Lane& x) {
    const Register y = inverse_sqrt(x).v, r = x.v * y;
    return from(r + S(0.5) * y * (x.v - r * r));
  }
  friend MOTIONLANG_INLINE Lane sin(const Lane& a) {
    return each(a, [](S x) { return std::sin(x); });
  }
  friend MOTIONLANG_INLINE Lane cos(const Lane& a) {
    return each(a, [](S x) { return std::cos(x); });
  }
  friend MOTIONLANG_INLINE Lane atan2(const Lane& y, const Lane& x) {
    Lane r;
    for (int i = 0; i < size; ++i) r.v[i] = std::atan2(y.v[i], x.v[i]);
    return r;
  }

 private:
  template <class F>
  static MOTIONLANG_INLINE Lane each(const Lane& a, F f) {
    Lane r;
    for (int i = 0; i < size; ++i) r.v[i] = f(a.v[i]);
    return r;
  }
};
static_assert(ScalarLike<Lane<float>> && ScalarLike<Lane<double>>);

#undef MOTIONLANG_INLINE

/// Calls f.operator()<Lane<S, bytes>>(), by GCC for the widest registers of this processor, compiled for them with all
/// that it calls.
template <Scalar S, class F>
void with_widest_lanes(const F& f) {
#if defined(MOTIONLANG_WIDER_COPIES)
  static const detail::Isa isa = detail::widest_vectors();
  if (isa == detail::Isa::avx512) return detail::with_avx512([&] { f.template operator()<Lane<S, 64>>(); });
  if (isa == detail::Isa::avx2) return detail::with_avx2([&] { f.template operator()<Lane<S, 32>>(); });
#endif
  f.template operator()<Lane<S, 16>>();
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

// Inlined, as all of lane.hpp.
#define MOTIONLANG_INLINE inline __attribute__((always_inline))

/// Piece i of four numbers of a register is at from + i * step.
template <int bytes>
MOTIONLANG_INLINE void load_pieces(const float* from, std::size_t step, Lane<float, bytes>& to) {
  if constexpr (bytes == 16) {
    std::memcpy(&to.v, from, 16);
  } else {
    Lane<float, bytes / 2> low, high;
    load_pieces(from, step, low);
    load_pieces(from + bytes / 32 * step, step, high);
    [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
      to.v = __builtin_shufflevector(low.v, high.v, i...);
    }
    (std::make_integer_sequence<int, bytes / 4>());
  }
}
template <int bytes>
MOTIONLANG_INLINE void store_pieces(const Lane<float, bytes>& from, float* to, std::size_t step) {
  if constexpr (bytes == 16) {
    std::memcpy(to, &from.v, 16);
  } else {
    Lane<float, bytes / 2> low, high;
    [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
      low.v = __builtin_shufflevector(from.v, from.v, i...);
      high.v = __builtin_shufflevector(from.v, from.v, (i + bytes / 8)...);
    }
    (std::make_integer_sequence<int, bytes / 8>());
    store_pieces(low, to, step);
    store_pieces(high, to + bytes / 32 * step, step);
  }
}

/// In every piece: numbers p and q of a, then r and t of b.
template <int p, int q, int r, int t, int bytes>
MOTIONLANG_INLINE Lane<float, bytes> mix(const Lane<float, bytes>& a, const Lane<float, bytes>& b) {
  constexpr int n = bytes / 4, from[4] = {p, q, n + r, n + t};
  Lane<float, bytes> mixed;
  [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
    mixed.v = __builtin_shufflevector(a.v, b.v, (i / 4 * 4 + from[i % 4])...);
  }
  (std::make_integer_sequence<int, n>());
  return mixed;
}

/// In every piece: number k of in[i] becomes number i of in[k].
template <int bytes>
MOTIONLANG_INLINE void transpose_pieces(Lane<float, bytes> (&in)[4]) {
  const auto low_a = mix<0, 1, 0, 1>(in[0], in[1]), high_a = mix<2, 3, 2, 3>(in[0], in[1]),
             low_b = mix<0, 1, 0, 1>(in[2], in[3]), high_b = mix<2, 3, 2, 3>(in[2], in[3]);
  in[0] = mix<0, 2, 0, 2>(low_a, low_b), in[1] = mix<1, 3, 1, 3>(low_a, low_b);
  in[2] = mix<0, 2, 0, 2>(high_a, high_b), in[3] = mix<1, 3, 1, 3>(high_a, high_b);
}

}  // namespace detail

/// Lane i of number k is from[i * step + k] for the first `count` lanes (at least one); further lanes are as the last
/// of these.
template <Scalar S, int bytes>
MOTIONLANG_INLINE void load_rows(const S* from, std::size_t step, int count, std::span<Lane<S, bytes>> numbers) {
  using L = Lane<S, bytes>;
  constexpr auto lanes = static_cast<std::size_t>(L::size);
  const auto last = static_cast<std::size_t>(count - 1);
  const bool whole = last + 1 == lanes;
  std::size_t k = 0;
  if constexpr (sizeof(S) == 4) {
    for (; k + 4 <= numbers.size(); k += 4) {
      L block[4];
      S copy[4 * lanes];  // where lanes are missing
      if (!whole) {
        for (std::size_t i = 0; i < lanes; ++i) std::memcpy(copy + 4 * i, from + std::min(i, last) * step + k, 16);
      }
      const S* const rows = whole ? from + k : copy;
      const std::size_t row = whole ? step : 4;
      for (std::size_t r = 0; r < 4; ++r) detail::load_pieces(rows + r * row, 4 * row, block[r]);
      detail::transpose_pieces(block);
      for (std::size_t r = 0; r < 4; ++r) numbers[k + r].v = block[r].v;
    }
  }
  for (; k < numbers.size(); ++k) {
    for (std::size_t i = 0; i < lanes; ++i) numbers[k][static_cast<int>(i)] = from[std::min(i, last) * step + k];
  }
}

/// Number k of lane i goes to to[i * step + k] for the first `count` lanes.
template <Scalar S, int bytes>
MOTIONLANG_INLINE void store_rows(std::span<const Lane<S, bytes>> numbers, std::size_t step, int count, S* to) {
  using L = Lane<S, bytes>;
  constexpr auto lanes = static_cast<std::size_t>(L::size);
  const auto used = static_cast<std::size_t>(count);
  const bool whole = used == lanes;
  std::size_t k = 0;
  if constexpr (sizeof(S) == 4) {
    for (; k + 4 <= numbers.size(); k += 4) {
      L block[4];
      S copy[4 * lanes];
      for (std::size_t r = 0; r < 4; ++r) block[r].v = numbers[k + r].v;
      detail::transpose_pieces(block);
      S* const rows = whole ? to + k : copy;
      const std::size_t row = whole ? step : 4;
      for (std::size_t r = 0; r < 4; ++r) detail::store_pieces(block[r], rows + r * row, 4 * row);
      if (!whole) {
        for (std::size_t i = 0; i < used; ++i) std::memcpy(to + i * step + k, copy + 4 * i, 16);
      }
    }
  }
  for (; k < numbers.size(); ++k) {
    for (std::size_t i = 0; i < used; ++i) to[i * step + k] = numbers[k][static_cast<int>(i)];
  }
}

#undef MOTIONLANG_INLINE

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_UNIFORM_SKELETON_HPP  // <motionlang/kinematics/uniform_skeleton.hpp>
#define MOTIONLANG_HAS_KINEMATICS_UNIFORM_SKELETON_HPP
/// Joint positions of anybody on a skeleton of given bone lengths: every bone keeps its direction, the path of the root
/// is scaled with the length of the leg.
///
///     scale = (thigh + shank of the target) / (thigh + shank of frame 0)
///     X_0 = scale p_0,   X_j = X_parent(j) + length_j (p_j - p_parent(j)) / |p_j - p_parent(j)|
///
/// Source  Guo et al. (CVPR 2022), HumanML3D motion_representation.ipynb uniform_skeleton. The
///         published code goes there and back through rotations, which cancel; its NaN for a bone opposite to its zero
///         direction is not reproduced here.

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct UniformJoints {
  std::vector<Vec3<S>> joints;  // (frames, joints)
  S scale{};                    // of the root's path
};

/// joints   (frames, joints)
/// lengths  (joints), of the target's bones
/// The result keeps its own height, without a search for the floor. Without frames it is empty, with scale 0.
/// Throws   shape_error 204, 205, config_error 106, numeric_error 301 for a bone that is not finite, 302 for one of
///          length 0
template <Scalar S>
UniformJoints<S> uniform_skeleton(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                  std::span<const S> lengths) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("uniform_skeleton", skeleton, joints);
  if (lengths.size() != n) {
    raise<shape_error>(204, "uniform_skeleton: ", lengths.size(), " lengths for ", n, " joints");
  }
  UniformJoints<S> out{std::vector<Vec3<S>>(joints.size()), S(0)};
  if (frames == 0) return out;
  const auto source = bone_lengths(skeleton, joints.first(n));
  auto leg = [&](const auto& of) {
    return detail::joint_of(of.data(), skeleton.leg[0]) + detail::joint_of(of.data(), skeleton.leg[1]);
  };
  out.scale = leg(lengths) / leg(source);
  const auto bones = skeleton.bones();
  for (std::size_t t = 0; t < frames; ++t) {
    Vec3<S>* to = &out.joints[t * n];
    to[0] = out.scale * joints[t * n];
    for (const ChainBone& b : bones) {
      const auto [v, length] = detail::measure_bone(skeleton, b, &joints[t * n], t);
      to[b.joint] = to[b.parent] + (lengths[b.joint] / length) * v;
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The defaults are as published.
struct Guoh3dOptions {
  ChainRotationOptions rotations{.facing = {.sigma = 20}};
  /// false: where the heading passes 180 degrees, the turn of that frame gets the wrong sign.
  bool fix_yaw_sign = false;
};

/// Without what the published code gets wrong: the heading follows hips and shoulders alike, does not jump behind the
/// first frame, passes 180 degrees, and a bone may be opposite to its zero direction.
inline Guoh3dOptions guoh3d_corrected() {
  return {.rotations = {.facing = {.sigma = 20, .legacy_forward = false},
                        .fix_first_frame = true,
                        .fix_opposite_bones = true},
          .fix_yaw_sign = true};
}

namespace detail {

/// A turn about Y, as the rotation of a root is: two products for each coordinate instead of a quaternion's.
template <ScalarLike T>
struct LevelTurn {
  T c, s;  // cosine and sine

  explicit LevelTurn(const Quaternion<T>& q) : c(q.w * q.w - q.y * q.y), s(T(2) * q.w * q.y) {}
  Vec3<T> operator()(const Vec3<T>& v) const { return {c * v.x + s * v.z, v.y, c * v.z - s * v.x}; }
};

}  // namespace detail

/// Joints on the floor; frame 0 stands at x = z = 0 and faces +Z.
template <Scalar S>
struct GroundedJoints {
  std::vector<Vec3<S>> joints;  // (frames, joints)
  S floor{};                    // height of the lowest joint of the clip, before
  Quaternion<S> turn{};         // that all joints have been turned by, last
};

/// first   how the facing direction of frame 0 is found; as published, from this frame alone. A body that faces -Z is
///         turned by 180 degrees; published: NaN
/// Throws  shape_error 205 if the joints are not whole frames, config_error 101 (sigma) and 106
template <Scalar S>
GroundedJoints<S> ground_joints(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                const FacingOptions& first = {.legacy_forward = false}) {
  detail::chain_frames("ground_joints", skeleton, joints);
  GroundedJoints<S> out{{}, S(0), Quaternion<S>::identity()};
  if (joints.empty()) return out;
  out.floor = joints[0].y;
  for (const Vec3<S>& p : joints) out.floor = std::min(out.floor, p.y);
  const auto facing = facing_directions(skeleton, first.sigma == 0 ? joints.first(skeleton.size()) : joints, first);
  out.turn = detail::turn_ahead(facing[0]);
  const Vec3<S> origin{joints[0].x, out.floor, joints[0].z};
  out.joints.resize(joints.size());
  const detail::LevelTurn<S> level(out.turn);
  for (std::size_t i = 0; i < joints.size(); ++i) out.joints[i] = level(joints[i] - origin);
  return out;
}

/// 1 while the squared displacement to the next frame is below the threshold, else 0.
template <ScalarLike T>
T guoh3d_contact(const Vec3<T>& now, const Vec3<T>& next, double threshold) {
  const Vec3<T> moved = next - now;
  return where_less(dot(moved, moved), T(threshold), T(1), T(0));
}
/// The same of two joints over time: (frames, joints) -> (frames - 1, 2). Throws shape_error 205, 203 for a joint that
/// does not exist.
template <Scalar S>
std::vector<S> guoh3d_contacts(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                               const std::array<int, 2>& foot) {
  const std::size_t frames = detail::chain_frames("guoh3d_contacts", skeleton, joints);
  for (const int j : foot) {
    if (j < 0 || static_cast<std::size_t>(j) >= skeleton.size())
      raise<shape_error>(203, "guoh3d_contacts: joint ", j, " of ", skeleton.size());
  }
  std::vector<S> out;
  for (std::size_t t = 0; t + 1 < frames; ++t) {
    const Vec3<S>*now = &joints[t * skeleton.size()], *next = now + skeleton.size();
    for (const int j : foot) {
      out.push_back(guoh3d_contact(detail::joint_of(now, j), detail::joint_of(next, j), skeleton.foot_threshold));
    }
  }
  return out;
}

/// The rotation from one root rotation to the next; its y is the sine of half the turn.
/// fix_sign: the shorter way round.
template <ScalarLike T>
Quaternion<T> guoh3d_turn(const Quaternion<T>& root, const Quaternion<T>& next, bool fix_sign = false) {
  const Quaternion<T> q = next * inverse(root);
  return fix_sign ? where_less(q.w, T(0), T(-1), T(1)) * q : q;
}
/// The way of the root to the next frame, seen from the body there.
template <ScalarLike T>
Vec3<T> guoh3d_root_velocity(const Quaternion<T>& next, const Vec3<T>& now_position, const Vec3<T>& next_position) {
  return rotate(next, next_position - now_position);
}
/// A joint seen from the body: x and z relative to the body's root, the height above the floor.
template <ScalarLike T>
Vec3<T> guoh3d_position(const Quaternion<T>& root, const Vec3<T>& root_position, const Vec3<T>& joint) {
  return rotate(root, joint - Vec3<T>{root_position.x, T(0), root_position.z});
}

namespace detail {

/// One row, or one in each lane: rotations of the frame, the root's of the next, joints of both. Number 0 is left as
/// the sine of half the turn.
template <ScalarLike T>
void guoh3d_row(const ChainSkeleton& skeleton, bool fix_yaw_sign, std::span<const Quaternion<T>> local,
                const Quaternion<T>& next_root, std::span<const Vec3<T>> now, std::span<const Vec3<T>> next, T* to) {
  auto put = [&](const Vec3<T>& v) { *to++ = v.x, *to++ = v.y, *to++ = v.z; };
  const Quaternion<T>& root = local[0];
  const LevelTurn<T> level(root);
  const Vec3<T> on_floor{now[0].x, T(0), now[0].z}, speed = LevelTurn<T>(next_root)(next[0] - now[0]);
  *to++ = guoh3d_turn(root, next_root, fix_yaw_sign).y;
  *to++ = speed.x;
  *to++ = speed.z;
  *to++ = now[0].y;
  for (std::size_t j = 1; j < now.size(); ++j) put(level(now[j] - on_floor));
  for (std::size_t j = 1; j < now.size(); ++j) {
    const auto columns = to_rotation6d_columns(local[j]);
    put(columns.a);
    put(columns.b);
  }
  for (std::size_t j = 0; j < now.size(); ++j) put(level(next[j] - now[j]));
  for (const auto& foot : {skeleton.left_foot, skeleton.right_foot}) {
    for (const int j : foot) {
      *to++ = guoh3d_contact(joint_of(now.data(), j), joint_of(next.data(), j), skeleton.foot_threshold);
    }
  }
}

}  // namespace detail

/// joints  (frames, joints), grounded
/// result  (frames - 1, 12 J - 1)
/// Throws  shape_error 205 for fewer than two frames or joints that are not whole frames, config_error 101 (sigma) and
///         106, numeric_error 301, 302
template <Scalar S>
std::vector<S> guoh3d_from_grounded(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                    const Guoh3dOptions& options = {}) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("guoh3d_from_grounded", skeleton, joints);
  if (frames < 2) raise<shape_error>(205, "guoh3d_from_grounded: ", frames, " frames; a row is made of two");
  const auto bones = skeleton.bones();
  const auto roots = detail::chain_roots(skeleton, joints, options.rotations);
  const std::size_t rows = frames - 1, width = static_cast<std::size_t>(Guoh3dSlots{static_cast<Index>(n)}.size());
  std::vector<S> out(width * rows);

  using L = Lane<S>;  // eight frames at once
  const auto zero = [&] {
    std::vector<Vec3<L>> directions;
    for (const auto& d : skeleton.directions) directions.push_back({L(d.x), L(d.y), L(d.z)});
    return directions;
  }();
  std::vector<Vec3<L>> now(n), next(n);
  std::vector<Quaternion<L>> world(n), local(n);
  std::vector<L> row(width);
  for (std::size_t first = 0; first < rows; first += L::size) {
    Quaternion<L> root, next_root;
    for (int i = 0; i < L::size; ++i) {
      const std::size_t t = std::min(first + static_cast<std::size_t>(i), rows - 1);
      auto lane = [i](Vec3<L>& to, const Vec3<S>& v) { to.x[i] = v.x, to.y[i] = v.y, to.z[i] = v.z; };
      auto turn = [i](Quaternion<L>& to, const Quaternion<S>& q) {
        to.w[i] = q.w, to.x[i] = q.x, to.y[i] = q.y, to.z[i] = q.z;
      };
      for (std::size_t j = 0; j < n; ++j) lane(now[j], joints[t * n + j]), lane(next[j], joints[(t + 1) * n + j]);
      turn(root, roots[t]), turn(next_root, roots[t + 1]);
    }
    const L bad = detail::chain_rotations<L>(bones, zero, now.data(), root, options.rotations.fix_opposite_bones,
                                             world.data(), local.data());
    detail::guoh3d_row<L>(skeleton, options.fix_yaw_sign, local, next_root, now, next, row.data());
    const int count = static_cast<int>(std::min<std::size_t>(L::size, rows - first));
    store_rows(std::span<const L>(row), width, count, &out[first * width]);
    for (int i = 0; i < count; ++i) {
      const std::size_t t = first + static_cast<std::size_t>(i);
      if (bad[i] > 0) detail::require_bones(skeleton, bones, &joints[t * n], t);
      S& turn = out[t * width];
      turn = std::asin(std::clamp(turn, S(-1), S(1)));
    }
  }
  detail::require_bones(skeleton, bones, &joints[rows * n], rows);
  return out;
}

/// The whole way.
/// joints   (frames, joints), of anybody, anywhere
/// lengths  (joints), bones of the reference skeleton
/// result   (frames - 1, 12 J - 1)
/// With fix_first_frame the smooth heading of frame 0 is turned onto +Z, so that the identity is right there.
/// Throws   as above; shape_error 204 unless there is one length for each joint
template <Scalar S>
std::vector<S> guoh3d_features(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                               std::span<const S> lengths, const Guoh3dOptions& options = {}) {
  const auto uniform = uniform_skeleton(skeleton, joints, lengths);
  const FacingOptions published{.legacy_forward = false}, &smooth = options.rotations.facing;
  const auto grounded = ground_joints(skeleton, std::span<const Vec3<S>>(uniform.joints),
                                      options.rotations.fix_first_frame ? smooth : published);
  return guoh3d_from_grounded(skeleton, std::span<const Vec3<S>>(grounded.joints), options);
}
/// With the lengths of the skeleton itself. Throws config_error 101 if it has none, as KIT's.
template <Scalar S>
std::vector<S> guoh3d_features(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                               const Guoh3dOptions& options = {}) {
  if (skeleton.lengths.empty()) {
    raise<config_error>(101, "guoh3d_features: '", skeleton.name, "' has 0 bone lengths for ", skeleton.size(),
                        " joints; take those of its reference clip");
  }
  const std::vector<S> lengths(skeleton.lengths.begin(), skeleton.lengths.end());
  return guoh3d_features(skeleton, joints, std::span<const S>(lengths), options);
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_FEATURES_RIFKE_HPP  // <motionlang/features/rifke.hpp>
#define MOTIONLANG_HAS_FEATURES_RIFKE_HPP
/// Rotation invariant forward kinematic encoding of joint positions ("rifke"): TEMOS' 64 numbers of the 21 joints of
/// MMM, SINC's 67 and TMR's 67 or 73 of SMPL's joints. There and back.
///
///     0             height of the root above the floor
///     1:3J-2        joints 1 ... J-1 seen from the body: x', then y and z as the world has them, one of them turned
///     3J-2          turn of the heading, radians per frame
///     3J-1:3J+1     velocity of the root over the ground, seen from the body, per frame
/// World: Y up with x, z level (TEMOS, any unit), or Z up with x, y level (SINC, TMR).
///
/// Source  Holden et al., "A deep learning framework for character motion synthesis and editing" (SIGGRAPH 2016); TEMOS
///         (ECCV 2022), appendix B.1, temos/transforms/joints2jfeats/rifke.py; SINC
///         sinc/transforms/joints2jfeats/rifke.py; TMR src/rifke.py

MOTIONLANG_NAMESPACE_BEGIN

/// One of the published variants, or one of one's own.
struct RifkeVariant {
  Index joints = 0;
  bool z_up = false;
  std::array<std::array<int, 2>, 2> across{};  // pairs (right, left) whose difference points across the body
  std::vector<int> floor{};                    // the lowest of these gives the floor; none: height 0
  bool wrapped_turns = true;                   // turns in (-pi, pi]; false: they jump where the heading passes pi
  bool swapped_forward = false;      // sine and cosine are (-x, y) of the vector across; false: (-y, x), straight ahead
  bool forward_differences = false;  // turns and velocities to the next frame; false: from the one before
  Index size() const { return 3 * joints + 1; }
};

/// TEMOS and TEACH's metrics. The heading is that of knees and elbows, as published (an index is off by one).
inline RifkeVariant temos_rifke() {
  return {.joints = 21, .across = {{{17, 12}, {9, 6}}}, .floor = {14, 15, 19, 20}, .wrapped_turns = false};
}
/// SINC's metrics, whose heading is swapped as published.
inline RifkeVariant sinc_rifke() {
  return {.joints = 22, .z_up = true, .across = {{{2, 1}, {17, 16}}}, .floor = {7, 10, 8, 11}, .swapped_forward = true};
}
/// TMR's canonical view; 22 or 24 joints of SMPL.
inline RifkeVariant tmr_rifke(Index joints = 22) {
  return {.joints = joints, .z_up = true, .across = {{{2, 1}, {17, 16}}}, .forward_differences = true};
}

template <Scalar S>
struct RifkeFeatures {
  std::vector<S> features;                // (frames, 3 J + 1)
  S floor{};                              // height of the floor
  std::vector<std::array<S, 2>> forward;  // (frames): sine and cosine of the heading
  std::vector<S> angles;                  // (frames): the heading
};

namespace detail {

/// Level coordinates and height of a vector.
template <Scalar S>
struct LevelVector {
  S a{}, b{}, height{};
};
template <Scalar S>
LevelVector<S> leveled(const Vec3<S>& v, bool z_up) {
  return z_up ? LevelVector<S>{v.x, v.y, v.z} : LevelVector<S>{v.x, v.z, v.y};
}
template <Scalar S>
Vec3<S> unleveled(const LevelVector<S>& v, bool z_up) {
  return z_up ? Vec3<S>{v.a, v.b, v.height} : Vec3<S>{v.a, v.height, v.b};
}
/// Into the body's view: a' = a cos - b sin, b' = a sin + b cos. With -sine: back.
template <Scalar S>
LevelVector<S> turned(const LevelVector<S>& v, S sine, S cosine) {
  return {v.a * cosine - v.b * sine, v.a * sine + v.b * cosine, v.height};
}
inline std::size_t rifke_frames(std::string_view function, std::size_t values, Index per_frame) {
  if (per_frame < 2 || static_cast<Index>(values) % per_frame != 0) {
    raise<shape_error>(205, function, ": ", values, " values are not frames of ", per_frame);
  }
  return values / static_cast<std::size_t>(per_frame);
}
/// Throws shape_error 203 for a joint that the variant names but does not have.
inline void require_joints(const RifkeVariant& variant) {
  auto require = [&](int joint) {
    if (joint < 0 || joint >= variant.joints) raise<shape_error>(203, "rifke: joint ", joint, " of ", variant.joints);
  };
  for (const auto& [right, left] : variant.across) require(right), require(left);
  for (const int joint : variant.floor) require(joint);
}
/// Smoothing with sigma 2 and zeros beyond the ends.
template <Scalar S>
void filter_forward(std::vector<std::array<S, 2>>& forward) {
  constexpr std::size_t radius = 8;
  std::vector<S> padded((forward.size() + 2 * radius) * 2);
  for (std::size_t t = 0; t < forward.size(); ++t) std::copy_n(forward[t].begin(), 2, &padded[2 * (t + radius)]);
  const auto smooth = gaussian_smooth(std::span<const S>(padded), 2, 2);
  for (std::size_t t = 0; t < forward.size(); ++t) {
    const Vec3<S> f = normalized(Vec3<S>{smooth[2 * (t + radius)], smooth[2 * (t + radius) + 1], S(0)});
    forward[t] = {f.x, f.y};
  }
}

}  // namespace detail

/// joints          (frames, J)
/// forward_filter  smooths the heading, as an option of TEMOS does
/// The floor is soft: m - ln(1/2 + exp(m - M)) for the lowest (m) and highest (M) of the lowest joint's heights.
/// Throws          shape_error 205, 203 if the variant names a joint that it does not have
template <Scalar S>
RifkeFeatures<S> rifke_features(const RifkeVariant& variant, std::span<const Vec3<S>> joints,
                                bool forward_filter = false) {
  const std::size_t frames = detail::rifke_frames("rifke_features", joints.size(), variant.joints);
  detail::require_joints(variant);
  const auto n = static_cast<std::size_t>(variant.joints);
  auto at = [&](std::size_t t, std::size_t j) { return detail::leveled(joints[t * n + j], variant.z_up); };
  RifkeFeatures<S> out;
  if (!variant.floor.empty() && frames > 0) {
    S lowest = std::numeric_limits<S>::infinity(), highest = -lowest;
    for (std::size_t t = 0; t < frames; ++t) {
      S height = std::numeric_limits<S>::infinity();
      for (const int j : variant.floor) height = std::min(height, at(t, static_cast<std::size_t>(j)).height);
      lowest = std::min(lowest, height), highest = std::max(highest, height);
    }
    out.floor = lowest - std::log(S(0.5) + std::exp(lowest - highest));
  }
  for (std::size_t t = 0; t < frames; ++t) {
    S a{}, b{};
    for (const auto& [right, left] : variant.across) {
      const auto r = at(t, static_cast<std::size_t>(right)), l = at(t, static_cast<std::size_t>(left));
      a += r.a - l.a, b += r.b - l.b;
    }
    const Vec3<S> f = normalized(variant.swapped_forward ? Vec3<S>{-a, b, S(0)} : Vec3<S>{-b, a, S(0)});
    out.forward.push_back({f.x, f.y});
  }
  if (forward_filter) detail::filter_forward(out.forward);
  for (const auto& [sine, cosine] : out.forward) out.angles.push_back(std::atan2(sine, cosine));

  auto turn = [&](std::size_t t) {
    const S d = out.angles[t + 1] - out.angles[t];
    return variant.wrapped_turns ? detail::wrapped(d) : d;
  };
  auto way = [&](std::size_t t) { return joints[(t + 1) * n] - joints[t * n]; };
  std::vector<S> turns(frames);
  std::vector<Vec3<S>> ways(frames);
  if (variant.forward_differences) {
    turns = detail::to_next<S>(frames, turn);
    ways = detail::to_next<Vec3<S>>(frames, way);
    if (variant.wrapped_turns && frames > 0) turns.back() = detail::wrapped(turns.back());
  } else {
    for (std::size_t t = 0; t + 1 < frames; ++t) turns[t + 1] = turn(t), ways[t + 1] = way(t);
  }
  out.features.reserve(frames * static_cast<std::size_t>(variant.size()));
  for (std::size_t t = 0; t < frames; ++t) {
    const auto [sine, cosine] = out.forward[t];
    const auto root = at(t, 0);
    out.features.push_back(root.height - out.floor);
    for (std::size_t j = 1; j < n; ++j) {
      const auto p = at(t, j);
      const detail::LevelVector<S> own{p.a - root.a, p.b - root.b, p.height - out.floor};
      const auto v = detail::unleveled(detail::turned(own, sine, cosine), variant.z_up);
      out.features.insert(out.features.end(), {v.x, v.y, v.z});
    }
    const auto v = detail::turned(detail::leveled(ways[t], variant.z_up), sine, cosine);
    out.features.insert(out.features.end(), {turns[t], v.a, v.b});
  }
  return out;
}

/// features  (frames, 3 J + 1), not normalised
/// result    (frames, J); frame 0 stands at the origin with heading 0, on the floor
/// Throws    shape_error 205
template <Scalar S>
std::vector<Vec3<S>> rifke_joints(const RifkeVariant& variant, std::span<const S> features) {
  const std::size_t frames = detail::rifke_frames("rifke_joints", features.size(), variant.size());
  const auto width = static_cast<std::size_t>(variant.size());
  std::vector<Vec3<S>> out;
  S angle{};
  detail::LevelVector<S> root{};
  for (std::size_t t = 0; t < frames; ++t) {
    const auto row = features.subspan(t * width, width);
    const S turn = row[width - 3];
    const detail::LevelVector<S> velocity{row[width - 2], row[width - 1], S(0)};
    auto step = [&] {
      const auto way = detail::turned(velocity, -std::sin(angle), std::cos(angle));
      root.a += way.a, root.b += way.b;
    };
    if (!variant.forward_differences && t > 0) angle += turn, step();
    root.height = row[0];
    out.push_back(detail::unleveled(root, variant.z_up));
    for (std::size_t at = 1; at + 3 < width; at += 3) {
      const auto own = detail::leveled(Vec3<S>{row[at], row[at + 1], row[at + 2]}, variant.z_up);
      const auto p = detail::turned(own, -std::sin(angle), std::cos(angle));
      out.push_back(detail::unleveled<S>({p.a + root.a, p.b + root.b, p.height}, variant.z_up));
    }
    if (variant.forward_differences) step(), angle += turn;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_FROM_JOINTS_HPP  // <motionlang/kinematics/motion_from_joints.hpp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_FROM_JOINTS_HPP
/// A clip from the positions of its joints: what models that predict positions need to become BVH, GLB or AMASS.
///
///     const Motion clip = motion_from_joints(humanml3d22_skeleton(), joints, 20);
///
/// Bones get the mean length that they have in the clip, and where several begin at one joint, the angles between them.
/// Each joint is turned so that its bones at rest come nearest to where they are seen, with as little twist against its
/// parent as that leaves open; positions along bones of constant length are met.
/// Source  Mueller, Bender, Chentanez, Macklin: "A robust method to extract the rotational part of deformations" (MIG
///         2016), eq. 7,
///         on pairs of vectors:   omega = sum_i R a_i x b_i / |sum_i R a_i . b_i|,   R <- exp(omega) R
/// World   Y up, as Motion has it

MOTIONLANG_NAMESPACE_BEGIN

/// A vector at rest and where it is seen.
struct SeenVector {
  Vec3<double> rest, seen;
};

/// The rotation that brings vectors at rest nearest to where they are seen, in the sense of least squares, found from
/// `start` on.
Quaternion<double> fit_rotation(std::span<const SeenVector> vectors, Quaternion<double> start);

/// skeleton  its names, parents and the directions of its bones at rest; joints beyond those that are given stay as at
///           rest
/// joints    (frames, count), count <= the joints of the skeleton, of which they are the first
/// Throws    shape_error 205 unless `joints` are whole frames, config_error 101 for a wrong count or frame rate,
///           numeric_error 301 for a position that is not finite
Motion motion_from_joints(const Skeleton& skeleton, std::span<const Vec3<double>> joints, Index count, double fps);
inline Motion motion_from_joints(const Skeleton& skeleton, std::span<const Vec3<double>> joints, double fps) {
  return motion_from_joints(skeleton, joints, skeleton.size(), fps);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_FROM_JOINTS_IPP  // <motionlang/kinematics/motion_from_joints.ipp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_FROM_JOINTS_IPP
// Bodies of motion_from_joints.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Quaternion<double> fit_rotation(std::span<const SeenVector> vectors, Quaternion<double> start) {
  constexpr int most_steps = 200;
  if (vectors.size() == 1 && norm(vectors[0].rest) > 0 && norm(vectors[0].seen) > 0)
    return rotation_between(rotate(start, vectors[0].rest), vectors[0].seen) * start;
  for (int step = 0; step < most_steps; ++step) {
    Vec3<double> turn{};
    double along = 0;
    for (const SeenVector& v : vectors) {
      const Vec3<double> a = rotate(start, v.rest);
      turn = turn + cross(a, v.seen);
      along += dot(a, v.seen);
    }
    const double size = norm(turn);
    if (!(size > 1e-12 * std::abs(along)) || size < 1e-300) break;
    const double angle = std::min(size / std::max(std::abs(along), 1e-300), 1.0);
    start = normalized(from_axis_angle((1 / size) * turn, angle) * start);
  }
  return start;
}

namespace detail {

inline double misfit(std::span<const SeenVector> vectors, const Quaternion<double>& q) {
  double sum = 0;
  for (const SeenVector& v : vectors) {
    const Vec3<double> d = rotate(q, v.rest) - v.seen;
    sum += dot(d, d);
  }
  return sum;
}

/// Bones that begin at one joint as they lie to one another in the clip, turned as at rest. They keep their lengths.
/// Each round turns the bones of every frame onto those at rest and takes the means.
/// rest   (bones); seen (frames, bones)
inline std::vector<Vec3<double>> bones_of_one_joint(std::vector<Vec3<double>> rest,
                                                    std::span<const Vec3<double>> seen) {
  constexpr int rounds = 10;
  constexpr std::size_t most_frames = 200;
  const std::size_t n = rest.size(), frames = seen.size() / n, step = std::max<std::size_t>(1, frames / most_frames);
  std::vector<Vec3<double>> at_rest = rest;
  auto turn = Quaternion<double>::identity();
  std::vector<SeenVector> pairs(n);
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vec3<double>> sum(n);
    for (std::size_t f = 0; f < frames; f += step) {
      for (std::size_t k = 0; k < n; ++k) pairs[k] = {rest[k], seen[f * n + k]};
      turn = fit_rotation(pairs, turn);
      for (std::size_t k = 0; k < n; ++k) sum[k] = sum[k] + rotate(inverse(turn), seen[f * n + k]);
    }
    for (std::size_t k = 0; k < n; ++k) {
      if (!(norm(sum[k]) > 0)) return at_rest;
      pairs[k] = {(norm(at_rest[k]) / norm(sum[k])) * sum[k], at_rest[k]};
    }
    const Quaternion<double> back = fit_rotation(pairs, Quaternion<double>::identity());
    for (std::size_t k = 0; k < n; ++k) rest[k] = rotate(back, pairs[k].rest);
  }
  return rest;
}

}  // namespace detail

MOTIONLANG_BODY Motion motion_from_joints(const Skeleton& skeleton, std::span<const Vec3<double>> joints, Index count,
                                          double fps) {
  if (count < 1 || count > skeleton.size())
    raise<config_error>(101, "motion_from_joints: ", count, " joints for a skeleton of ", skeleton.size());
  const auto n = static_cast<std::size_t>(count), frames = joints.size() / n;
  if (joints.size() != frames * n)
    raise<shape_error>(205, "motion_from_joints: ", joints.size(), " positions are not frames of ", count, " joints");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!std::isfinite(joints[i].x + joints[i].y + joints[i].z))
      raise<numeric_error>(301, "motion_from_joints: joint ", i % n, " in frame ", i / n, " is not finite");
  }
  Motion out{skeleton, fps, {}, {}, {}};
  std::vector<std::vector<std::size_t>> children(n);
  for (std::size_t j = 1; j < n; ++j) {
    const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
    children[parent].push_back(j);
    double length = 0;
    for (std::size_t f = 0; f < frames; ++f) length += norm(joints[f * n + j] - joints[f * n + parent]);
    const double rest = norm(skeleton.offsets[j]);
    if (rest > 0 && frames > 0)
      out.skeleton.offsets[j] = (length / static_cast<double>(frames) / rest) * skeleton.offsets[j];
  }
  for (std::size_t j = 0; j < n; ++j) {
    if (children[j].size() < 2 || frames == 0) continue;
    std::vector<Vec3<double>> rest, seen;
    for (const std::size_t c : children[j]) rest.push_back(out.skeleton.offsets[c]);
    for (std::size_t f = 0; f < frames; ++f) {
      for (const std::size_t c : children[j]) seen.push_back(joints[f * n + c] - joints[f * n + j]);
    }
    rest = detail::bones_of_one_joint(std::move(rest), seen);
    for (std::size_t k = 0; k < rest.size(); ++k) out.skeleton.offsets[children[j][k]] = rest[k];
  }
  const auto all = static_cast<std::size_t>(skeleton.size());
  std::vector<Quaternion<double>> world(all);
  for (std::size_t f = 0; f < frames; ++f) {
    const auto frame = joints.subspan(f * n, n);
    out.root.push_back(frame[0]);
    for (std::size_t j = 0; j < all; ++j) {
      const int parent = skeleton.parents[j];
      const auto up = parent < 0 ? Quaternion<double>::identity() : world[static_cast<std::size_t>(parent)];
      std::vector<SeenVector> bones;
      if (j < n) {
        for (const std::size_t c : children[j]) bones.push_back({out.skeleton.offsets[c], frame[c] - frame[j]});
      }
      world[j] = fit_rotation(bones, up);
      for (int quarter = 1; parent < 0 && quarter < 4; ++quarter) {  // whatever it faces
        const auto start = from_axis_angle(Vec3<double>{0, 1, 0}, quarter * std::numbers::pi / 2);
        const auto other = fit_rotation(bones, start);
        if (detail::misfit(bones, other) < detail::misfit(bones, world[j]) - 1e-12) world[j] = other;
      }
      out.local.push_back(inverse(up) * world[j]);
    }
  }
  out.validate();
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline void require_smpl24(const Motion& motion) {
  if (motion.skeleton.names != smpl24_skeleton().names || motion.skeleton.parents != smpl24_skeleton().parents) {
    raise<config_error>(103, "motion_features: the ", motion.skeleton.size(), " joints of '", motion.name,
                        "' are not the 24 of SMPL; retarget first");
  }
}

MOTIONLANG_BODY std::vector<Vec3<double>> first_joints(const Motion& motion, std::size_t count) {
  require_smpl24(motion);
  const auto all = motion.positions();
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  std::vector<Vec3<double>> out;
  for (std::size_t at = 0; at < all.size(); at += joints)
    out.insert(out.end(), all.begin() + static_cast<std::ptrdiff_t>(at),
               all.begin() + static_cast<std::ptrdiff_t>(at + count));
  return out;
}

MOTIONLANG_BODY std::vector<Vec3<double>> turned_up(std::vector<Vec3<double>> points, bool to_z_up) {
  for (Vec3<double>& p : points) p = to_z_up ? Vec3<double>{p.x, -p.z, p.y} : Vec3<double>{p.x, p.z, -p.y};
  return points;
}

MOTIONLANG_BODY std::vector<double> guoh3d_rows_of(const Motion& motion) {
  const auto joints = first_joints(motion, 22);
  return guoh3d_features(humanml3d_chains(), std::span<const Vec3<double>>(joints));
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_guoh3d(std::span<const double> rows) { return guoh3d_joints(rows); }

MOTIONLANG_BODY std::vector<double> rifke_rows_of(const Motion& motion) {
  const auto joints = turned_up(first_joints(motion, 22), true);
  return rifke_features(tmr_rifke(22), std::span<const Vec3<double>>(joints)).features;
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_rifke(std::span<const double> rows) {
  return turned_up(rifke_joints(tmr_rifke(22), rows), false);
}

/// MMM's joints of every frame as KIT has them and TEMOS makes them: reflected, Y up.
inline std::vector<Vec3<double>> mmm_joints_of(const Motion& motion) {
  const bool own =
      motion.skeleton.names == kit21_skeleton().names && motion.skeleton.parents == kit21_skeleton().parents;
  if (!own) require_smpl24(motion);
  auto joints = (own ? motion : retarget(motion, kit21_skeleton())).positions();
  for (Vec3<double>& p : joints) p = mmm_units_per_metre * Vec3<double>{-p.x, p.y, p.z};
  return joints;
}

MOTIONLANG_BODY Vec3<double> mean_height(std::span<const Vec3<double>> joints, std::size_t count) {
  const bool mmm = count == mmm_joints;
  const std::size_t head = mmm ? 4 : 15, left = mmm ? 13 : 7, right = mmm ? 18 : 8;
  Vec3<double> sum{};
  for (std::size_t at = 0; at < joints.size(); at += count) {
    sum = sum + joints[at + head] - 0.5 * (joints[at + left] + joints[at + right]);
  }
  return joints.empty() ? sum : (static_cast<double>(count) / static_cast<double>(joints.size())) * sum;
}

MOTIONLANG_BODY std::vector<Vec3<double>> mmm_in_metres(std::vector<Vec3<double>> joints) {
  const double unit = norm(mean_height(joints, mmm_joints)) > 20 ? 1 / mmm_units_per_metre : 1;
  for (Vec3<double>& p : joints) p = unit * Vec3<double>{-p.x, p.y, p.z};
  return joints;
}

MOTIONLANG_BODY std::vector<double> kit_rows_of(const Motion& motion) {
  const auto joints = mmm_joints_of(motion);
  const std::span<const Vec3<double>> all(joints);
  const auto lengths =
      joints.empty() ? std::vector<double>(mmm_joints) : bone_lengths(kit_chains(), all.first(mmm_joints));
  return guoh3d_features(kit_chains(), all, std::span<const double>(lengths));
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_kit(std::span<const double> rows) {
  return mmm_in_metres(guoh3d_joints(rows, mmm_joints));
}

MOTIONLANG_BODY std::vector<double> rifke64_rows_of(const Motion& motion) {
  const auto joints = mmm_joints_of(motion);
  return rifke_features(temos_rifke(), std::span<const Vec3<double>>(joints)).features;
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_rifke64(std::span<const double> rows) {
  return mmm_in_metres(rifke_joints(temos_rifke(), rows));
}

MOTIONLANG_BODY std::vector<double> smplvelp_rows(const Motion& motion, bool exact_yaw) {
  require_smpl24(motion);
  const auto z_up = axis_rotation(0, std::numbers::pi / 2);
  std::vector<Matrix3<double>> rotations;
  for (Index f = 0; f < motion.frames(); ++f) {
    for (std::size_t j = 0; j < 22; ++j) {
      const auto r = to_matrix(motion.rotations(f)[j]);
      rotations.push_back(j == 0 ? z_up * r : r);
    }
  }
  return smplvelp_features(std::span<const Matrix3<double>>(rotations),
                           std::span<const Vec3<double>>(turned_up(motion.root, true)), {.exact_yaw = exact_yaw});
}

MOTIONLANG_BODY Motion smplvelp_motion(std::span<const double> rows, double fps) {
  return motion_of_smplvelp(smplvelp_inverse(rows), fps);
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_smplvelp(std::span<const double> rows) {
  return first_joints(smplvelp_motion(rows, 12.5), 22);
}

MOTIONLANG_BODY Motion smplrifke_motion(std::span<const double> rows, double fps) {
  return smplrifke_to_motion(rows, {}, fps);
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_smplrifke(std::span<const double> rows) {
  return first_joints(smplrifke_motion(rows, 20), 22);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<double> actor_rows_of_motion(const Motion& motion, const ActorFeatureOptions& options) {
  detail::require_smpl24(motion);
  const auto upside_down = axis_rotation(0, std::numbers::pi);
  std::vector<Matrix3<double>> rotations;
  for (std::size_t i = 0; i < motion.local.size(); ++i) {
    const auto r = to_matrix(motion.local[i]);
    rotations.push_back(i % 24 == 0 ? upside_down * r : r);
  }
  std::vector<Vec3<double>> root;
  for (const Vec3<double>& p : motion.root) root.push_back(upside_down * p);
  return actor_frame_features(std::span<const Matrix3<double>>(rotations), std::span<const Vec3<double>>(root), 24,
                              options);
}

namespace detail {

MOTIONLANG_BODY std::vector<double> actor_rows_of(const Motion& motion) { return actor_rows_of_motion(motion); }

MOTIONLANG_BODY Motion actor_motion(std::span<const double> rows, double fps) {
  return motion_of_actor(actor_inverse(rows), fps);
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_actor(std::span<const double> rows) {
  return first_joints(actor_motion(rows, 20), 22);
}

MOTIONLANG_BODY FeatureLayout layout_of_guoh3d() { return guoh3dfeats_layout(); }

MOTIONLANG_BODY FeatureLayout layout_of_kit() { return guoh3dfeats_layout(kit_part_of_joint); }

MOTIONLANG_BODY FeatureLayout layout_of_rifke() { return rifke_layout(); }

MOTIONLANG_BODY FeatureLayout layout_of_rifke64() { return rifke_layout(kit_part_of_joint); }

MOTIONLANG_BODY FeatureLayout layout_of_smplvelp() { return smplvelp_layout(); }

MOTIONLANG_BODY FeatureLayout layout_of_smplrifke() { return smplrifke_layout(); }

MOTIONLANG_BODY FeatureLayout layout_of_actor() { return actor_layout(); }

}  // namespace detail

MOTIONLANG_BODY Motion motion_of_rows(const MotionFeatures& features, std::span<const double> rows, double fps) {
  const double rate = fps > 0 ? fps : features.fps;
  const auto odd = std::find_if(rows.begin(), rows.end(), [](double x) { return !std::isfinite(x); });
  if (odd != rows.end()) {
    const Index at = odd - rows.begin();
    raise<numeric_error>(301, "motion_of_rows: number ", at % features.width, " of frame ", at / features.width,
                         " is not finite");
  }
  if (features.to_motion != nullptr) {
    Motion out = features.to_motion(rows, rate);
    out.validate();
    return out;
  }
  return motion_from_joints(features.skeleton(), features.joints_of(rows), features.joints, rate);
}

MOTIONLANG_BODY const MotionFeatures& motion_features(std::string_view name) {
  for (const MotionFeatures& f : all_motion_features) {
    if (f.name == name) return f;
  }
  raise<config_error>(103, "motion_features: '", name, "' is not one of ",
                      join_text(all_motion_features, ", ", [](const MotionFeatures& f) { return f.name; }));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_ON_SMPL_HPP  // <motionlang/kinematics/on_smpl.hpp>
#define MOTIONLANG_HAS_KINEMATICS_ON_SMPL_HPP
/// A motion on SMPL's 24 joints, whatever skeleton it is on. Models, AMASS files and joint arrays want it there.

MOTIONLANG_NAMESPACE_BEGIN

/// The motion on SMPL's 24 joints. If it has them already, in whatever order (a BVH file goes depth first), they are
/// only put in SMPL's order and the bones keep their lengths. Otherwise it is retargeted.
/// report  is set only if the motion is retargeted
/// Throws  config_error 103 with the joint that is missing, as retarget does
Motion on_smpl(const Motion& motion, RetargetReport* report = nullptr);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_ON_SMPL_IPP  // <motionlang/kinematics/on_smpl.ipp>
#define MOTIONLANG_HAS_KINEMATICS_ON_SMPL_IPP
// Bodies of on_smpl.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Motion on_smpl(const Motion& motion, RetargetReport* report) {
  const Skeleton &own = motion.skeleton, &smpl = smpl24_skeleton();
  std::vector<std::size_t> from;  // our joint for each of SMPL's
  for (int j = 0; j < smpl.size(); ++j) {
    const int k = own.find(smpl.name(j));
    const bool same = k >= 0 && own.size() == smpl.size() && (j == 0) == (own.parent(k) < 0) &&
                      (j == 0 || own.name(own.parent(k)) == smpl.name(smpl.parent(j)));
    if (!same) {
      const SkeletonMap map(own);
      if (report != nullptr) *report = map.report();
      return retarget(motion, map);
    }
    from.push_back(static_cast<std::size_t>(k));
  }
  Motion out{smpl, motion.fps, motion.root, {}, motion.name};
  for (std::size_t j = 0; j < from.size(); ++j) out.skeleton.offsets[j] = own.offsets[from[j]];
  for (Index f = 0; f < motion.frames(); ++f) {
    for (const std::size_t k : from) out.local.push_back(motion.rotations(f)[k]);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// True if a motion has exactly the joints of these features, SMPL's or MMM's: rows are then made of it as it is.
bool has_joints_of(const MotionFeatures& features, const Motion& motion);
/// True if a motion has the joints of any of the known features, in their order: a reader of a joint array, which has
/// no names, takes it for what it is.
bool has_joints_of_arrays(const Motion& motion);
/// The motion as it is if it has the joints of these features, otherwise on SMPL's. Throws what on_smpl throws.
Motion on_joints_of(const MotionFeatures& features, const Motion& motion);

/// The rows of a motion on any joints, (frames, features.width), not normalised.
/// fps     frames per second of the rows, above 0
/// Throws  what on_smpl, resample and MotionFeatures::from_motion throw
std::vector<double> rows_of_motion(const MotionFeatures& features, const Motion& motion, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FEATURES_FEATURE_ROWS_IPP  // <motionlang/features/feature_rows.ipp>
#define MOTIONLANG_HAS_FEATURES_FEATURE_ROWS_IPP
// Bodies of feature_rows.hpp.

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_TOOLS_HPP  // <motionlang/kinematics/motion_tools.hpp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_TOOLS_HPP
/// Editing clips: crop, resample, change speed, join, mirror, and take away the T-pose at the start of CMU files. Pure
/// functions; the clip that is passed stays as it is.

MOTIONLANG_NAMESPACE_BEGIN

/// Frames first ... last - 1. Throws shape_error 203 unless 0 <= first <= last <= frames.
Motion crop(const Motion& motion, Index first, Index last);

/// The clip at another frame rate: frame i shows the moment i / fps, as long as the clip lasts (its last frame stands
/// at (frames - 1) / old fps). Root positions are interpolated linearly, rotations along the shortest arc. Moments that
/// coincide with a frame take it unchanged, so going up by a whole factor and down again gives the same clip.
/// Throws config_error 101 unless fps > 0, and for more than max_rotations.
Motion resample(const Motion& motion, double fps);

/// The clip `factor` times as fast at the same frame rate (0.5: slow motion). Throws config_error 101 unless factor >
/// 0, and for more than max_rotations.
Motion change_speed(const Motion& motion, double factor);

namespace detail {

/// Throws config_error 102 unless both clips have one skeleton and one frame rate.
void require_same_kind(std::string_view function, const Motion& first, const Motion& second);

}  // namespace detail

/// `second` after `first`, as they stand (no blending, no alignment: see blend.hpp). Throws config_error 102 if
/// skeletons or frame rates differ.
Motion concatenate(const Motion& first, const Motion& second);

/// For each joint its partner on the other side, found by name; a joint in the middle is its own partner.
/// Throws config_error 103 if a name says "left" or "right" and its partner is missing.
std::vector<int> mirror_partners(const Skeleton& skeleton);

/// The clip in a mirror that stands in the sagittal plane x = 0: left becomes right.
///     p'_partner(j) = (-x, y, z)_j,   q'_partner(j) = (w, x, -y, -z)_j
/// The skeleton is mirrored too, so that positions are exact images whatever its local axes; a symmetric one stays as
/// it is. Throws config_error 102 if the partners do not pair up or their parents are not partners.
Motion mirror(const Motion& motion, std::span<const int> partners);
/// With the partners that the names of the joints tell.
inline Motion mirror(const Motion& motion) { return mirror(motion, mirror_partners(motion.skeleton)); }

/// How many frames at the start are not performed but an inserted T-pose: exporters put the zero pose in front of CMU
/// trials, and some blend out of it (Daz files, with a spline that swings over for as long again).
///
/// The first pose must be the zero pose (5 degrees in the mean over the joints), and the clip must leave it far faster
/// than it moves afterwards; a performer who really starts in a T-pose is left alone. A pose that is held to the last
/// digit counts as one frame. Returns 0 for skeletons whose zero pose is not a T-pose: call it before retargeting.
Index detect_t_pose_lead_in(const Motion& motion);

/// The clip without those frames.
inline Motion drop_lead_in(const Motion& motion) {
  return crop(motion, detect_t_pose_lead_in(motion), motion.frames());
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_TOOLS_IPP  // <motionlang/kinematics/motion_tools.ipp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_TOOLS_IPP
// Bodies of motion_tools.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Motion crop(const Motion& motion, Index first, Index last) {
  if (first < 0 || last < first || last > motion.frames()) {
    raise<shape_error>(203, "crop: frames ", first, " to ", last, " of a clip of ", motion.frames());
  }
  const Index joints = motion.skeleton.size();
  return {motion.skeleton, motion.fps,
          std::vector<Vec3<double>>(motion.root.begin() + first, motion.root.begin() + last),
          std::vector<Quaternion<double>>(motion.local.begin() + first * joints, motion.local.begin() + last * joints),
          motion.name};
}

MOTIONLANG_BODY Motion resample(const Motion& motion, double fps) {
  if (!(fps > 0) || !std::isfinite(fps)) raise<config_error>(101, "resample: frame rate ", fps);
  Motion out{motion.skeleton, fps, {}, {}, motion.name};
  if (motion.frames() == 0) return out;
  const double step = motion.fps / fps, rounding = 1e-6;  // frame times are not exact in decimal files
  const auto last = static_cast<double>(motion.frames() - 1);
  const double whole_frames = std::floor(last / step + rounding) + 1;
  if (!(whole_frames * motion.skeleton.size() <= max_rotations)) {
    raise<config_error>(101, "resample: '", motion.name, "' of ", motion.seconds(), " s at ", fps,
                        " frames per second has ", whole_frames, " frames of ",
                        counted(motion.skeleton.size(), "joint"), ", more than ", max_rotations, " rotations");
  }
  const auto frames = static_cast<Index>(whole_frames);
  out.root.reserve(static_cast<std::size_t>(frames));
  out.local.reserve(static_cast<std::size_t>(frames * motion.skeleton.size()));
  for (Index i = 0; i < frames; ++i) {
    const double moment = std::min(static_cast<double>(i) * step, last), whole = std::floor(moment + rounding);
    const auto a = static_cast<Index>(whole), b = std::min(a + 1, motion.frames() - 1);
    const double t = moment - whole < rounding ? 0 : moment - whole;
    out.root.push_back((1 - t) * motion.root_at(a) + t * motion.root_at(b));
    const auto from = motion.rotations(a), to = motion.rotations(b);
    for (std::size_t j = 0; j < from.size(); ++j) out.local.push_back(t == 0 ? from[j] : slerp(from[j], to[j], t));
  }
  return out;
}

MOTIONLANG_BODY Motion change_speed(const Motion& motion, double factor) {
  if (!(factor > 0) || !std::isfinite(factor)) raise<config_error>(101, "change_speed: factor ", factor);
  Motion out = resample(motion, motion.fps / factor);
  out.fps = motion.fps;
  return out;
}

namespace detail {

MOTIONLANG_BODY void require_same_kind(std::string_view function, const Motion& first, const Motion& second) {
  if (first.skeleton != second.skeleton || first.fps != second.fps) {
    raise<config_error>(102, function, ": '", first.name, "' has ", counted(first.skeleton.size(), "joint"), " at ",
                        first.fps, " frames per second, '", second.name, "' ", second.skeleton.size(), " at ",
                        second.fps);
  }
}

}  // namespace detail

MOTIONLANG_BODY Motion concatenate(const Motion& first, const Motion& second) {
  detail::require_same_kind("concatenate", first, second);
  Motion out = first;
  out.root.insert(out.root.end(), second.root.begin(), second.root.end());
  out.local.insert(out.local.end(), second.local.begin(), second.local.end());
  return out;
}

MOTIONLANG_BODY std::vector<int> mirror_partners(const Skeleton& skeleton) {
  std::vector<int> partners;
  for (int j = 0; j < skeleton.size(); ++j) {
    const std::string& name = skeleton.name(j);
    int partner = -1;
    for (const std::string& candidate : detail::other_side(name)) {
      if (partner < 0) partner = skeleton.find(candidate);
    }
    if (partner < 0 && detail::has_side_word(name))
      raise<config_error>(103, "mirror_partners: '", name, "' has no partner");
    partners.push_back(partner < 0 ? j : partner);
  }
  return partners;
}

MOTIONLANG_BODY Motion mirror(const Motion& motion, std::span<const int> partners) {
  const Skeleton& skeleton = motion.skeleton;
  const auto joints = static_cast<std::size_t>(skeleton.size());
  if (partners.size() != joints) {
    raise<config_error>(102, "mirror: ", partners.size(), " partners for ", counted(joints, "joint"));
  }
  Motion out = motion;
  for (std::size_t j = 0; j < joints; ++j) {
    const int p = partners[j], parent = skeleton.parents[j];
    const bool paired = p >= 0 && p < skeleton.size() && partners[static_cast<std::size_t>(p)] == static_cast<int>(j);
    if (!paired || skeleton.parent(p) != (parent < 0 ? -1 : partners[static_cast<std::size_t>(parent)])) {
      raise<config_error>(102, "mirror: joint '", skeleton.names[j], "' and its partner are not mirror images");
    }
    const auto mirrored = [](const Vec3<double>& v) { return Vec3<double>{-v.x, v.y, v.z}; };
    out.skeleton.offsets[static_cast<std::size_t>(p)] = mirrored(skeleton.offsets[j]);
    if (!skeleton.ends.empty()) out.skeleton.ends[static_cast<std::size_t>(p)] = mirrored(skeleton.ends[j]);
  }
  for (Vec3<double>& r : out.root) r.x = -r.x;
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto from = motion.rotations(f);
    const auto to = out.rotations(f);
    for (std::size_t j = 0; j < joints; ++j) {
      to[static_cast<std::size_t>(partners[j])] = {from[j].w, from[j].x, -from[j].y, -from[j].z};
    }
  }
  return out;
}

MOTIONLANG_BODY Index detect_t_pose_lead_in(const Motion& motion) {
  const auto same = [&](Index f) {
    return std::equal(motion.rotations(f).begin(), motion.rotations(f).end(), motion.rotations(0).begin(),
                      [](const auto& p, const auto& q) { return distance(p, q) < 1e-6; });
  };
  Index held = 0;  // the last frame of the first pose
  while (held + 1 < motion.frames() && same(held + 1)) ++held;
  constexpr double zero_pose = 5 * degree, fastest = 0.5 * degree;
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  const Index left = motion.frames() - held;
  const auto frames = static_cast<double>(left);  // a rate may be larger than any Index
  const auto longest = static_cast<Index>(std::min(std::ceil(0.1 * motion.fps), frames));  // of a blend, frames
  const Index seen = std::min(left - 1, longest + static_cast<Index>(std::min(motion.fps, frames)));
  if (seen < 2 || joints < 2) return 0;
  double from_zero = 0;
  for (const auto& q : motion.rotations(0).subspan(1)) from_zero += distance(q, Quaternion<double>::identity());
  if (from_zero / static_cast<double>(joints - 1) > zero_pose) return 0;

  std::vector<double> step(static_cast<std::size_t>(seen));  // mean turn of a joint from frame held + f to the next
  for (Index f = 0; f < seen; ++f) {
    const auto a = motion.rotations(held + f), b = motion.rotations(held + f + 1);
    double& turn = step[static_cast<std::size_t>(f)];
    for (std::size_t j = 1; j < joints; ++j) turn += distance(a[j], b[j]) / static_cast<double>(joints - 1);
  }
  const double usual = nth_smallest(std::vector<double>(step.begin() + 1, step.end()), (step.size() - 1) / 2);
  auto inserted = [&](Index f) {
    const double turn = step[static_cast<std::size_t>(f)];
    const double before = f == 0 ? turn : step[static_cast<std::size_t>(f - 1)];
    return turn > 3 * usual && turn > fastest && turn > 0.65 * before;  // a blend slows down gradually
  };
  Index blend = 0;
  while (blend < std::min(longest, seen) && inserted(blend)) ++blend;
  if (blend == 0) return 0;
  return held + (blend < 2 ? blend : std::min(2 * blend, left - 1));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool has_joints_of(const MotionFeatures& features, const Motion& motion) {
  const Skeleton &own = motion.skeleton, &wanted = features.skeleton();
  return own.names == wanted.names && own.parents == wanted.parents;
}

MOTIONLANG_BODY bool has_joints_of_arrays(const Motion& motion) {
  return std::any_of(all_motion_features.begin(), all_motion_features.end(),
                     [&](const MotionFeatures& features) { return has_joints_of(features, motion); });
}

MOTIONLANG_BODY Motion on_joints_of(const MotionFeatures& features, const Motion& motion) {
  return has_joints_of(features, motion) ? motion : on_smpl(motion);
}

MOTIONLANG_BODY std::vector<double> rows_of_motion(const MotionFeatures& features, const Motion& motion, double fps) {
  return features.from_motion(resample(on_joints_of(features, motion), fps));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_GENERATE_ARM_OVERLAY_HPP  // <motionlang/generate/arm_overlay.hpp>
#define MOTIONLANG_HAS_GENERATE_ARM_OVERLAY_HPP
/// Arms that a collage of texts loses: beside a text that sits, stands or bends, a text of an arm may move it half as
/// far as alone, or not at all. What the text makes alone is then laid over the collage.
///
///     for (const ArmText& text : arm_texts(timeline, 10))   // that last ten frames or longer
///       if (is_arm_lost(motion, alone, text)) motion = lay_arm_over(motion, alone, text);    // alone: of text.alone
///
/// Source  the composition of SINC (Athanasiou et al., ICCV 2023; kinematics/overlay.hpp), for the arms only

MOTIONLANG_NAMESPACE_BEGIN

/// A text of one arm or both, while other texts have the legs.
struct ArmText {
  Timeline alone;                // the text by itself, on the whole body
  Index start = 0;               // frame of the timeline in which it begins
  BodyPart arm{};                // left_arm or right_arm
  std::vector<std::uint8_t> on;  // (frames of `alone`): 1 where the arm is the text's
};

/// One entry for each arm of each text that has no other part than arms, where another text has the legs meanwhile.
/// Texts that have the arm for less than `shortest` frames are left out.
std::vector<ArmText> arm_texts(const Timeline& timeline, Index shortest);

/// How far the wrist comes in a clip, seen from the chest: the diagonal of the box in which it stays, metres. SMPL's
/// joints. Counts frames in which `on` is 1; `start` is the frame of the clip where it begins.
double arm_extent(const Motion& motion, BodyPart arm, std::span<const std::uint8_t> on, Index start = 0);

/// A share of the extent of an arm alone. In the collage, an arm that comes less far is lost.
inline constexpr double lost_arm_share = 0.8;

/// True if an arm comes less than lost_arm_share as far as alone.
bool is_arm_lost(const Motion& motion, const Motion& alone, const ArmText& text);

/// The motion with the local rotations of the arm from `alone`; they come and go within `blend` frames, as far as the
/// arm has any before or behind.
Motion lay_arm_over(const Motion& motion, const Motion& alone, const ArmText& text, Index blend = 6);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_GENERATE_ARM_OVERLAY_IPP  // <motionlang/generate/arm_overlay.ipp>
#define MOTIONLANG_HAS_GENERATE_ARM_OVERLAY_IPP
// Bodies of arm_overlay.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<ArmText> arm_texts(const Timeline& timeline, Index shortest) {
  constexpr BodyParts both = BodyParts{}.with(BodyPart::left_arm).with(BodyPart::right_arm);
  std::vector<ArmText> out;
  if (!(timeline.body == BodyPartition{})) return out;
  FirstWins ties;
  const auto pieces = elementary_pieces(timeline);
  for (Index i = 0; i < std::ssize(timeline.intervals); ++i) {
    const Interval& text = timeline.intervals[static_cast<std::size_t>(i)];
    if (text.parts.empty() || (text.parts.bits & ~both.bits) != 0) continue;
    for (const BodyPart arm : {BodyPart::left_arm, BodyPart::right_arm}) {
      ArmText entry{{{{text.text, 0, text.end - text.start, BodyParts::all()}}}, text.start, arm, {}};
      entry.on.assign(static_cast<std::size_t>(text.end - text.start), 0);
      Index frames = 0;
      for (const Piece& piece : pieces) {
        if (piece.intervals.empty()) continue;
        const auto owners = assign_parts(timeline, piece.intervals, ties);
        const auto owner = [&](BodyPart part) { return owners[static_cast<std::size_t>(part)]; };
        if (owner(arm) != i || owner(BodyPart::legs) == i) continue;
        for (Index f = piece.start; f < piece.end; ++f, ++frames)
          entry.on[static_cast<std::size_t>(f - text.start)] = 1;
      }
      if (frames >= shortest) out.push_back(std::move(entry));
    }
  }
  return out;
}

MOTIONLANG_BODY double arm_extent(const Motion& motion, BodyPart arm, std::span<const std::uint8_t> on, Index start) {
  constexpr std::size_t chest = 9;
  const std::size_t wrist = arm == BodyPart::left_arm ? 20 : 21;
  Vec3<double> low{1e9, 1e9, 1e9}, high = -1.0 * low;
  JointTransforms<double> world;
  const Index frames = std::min(std::ssize(on), motion.frames() - start);
  for (Index f = 0; f < frames; ++f) {
    if (on[static_cast<std::size_t>(f)] == 0) continue;
    motion.world(start + f, world);
    const Vec3<double> p =
        rotate(inverse(to_quaternion(world.rotation[chest])), world.position[wrist] - world.position[chest]);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return low.x > high.x ? 0 : norm(high - low);
}

MOTIONLANG_BODY bool is_arm_lost(const Motion& motion, const Motion& alone, const ArmText& text) {
  return arm_extent(motion, text.arm, text.on, text.start) < lost_arm_share * arm_extent(alone, text.arm, text.on);
}

MOTIONLANG_BODY Motion lay_arm_over(const Motion& motion, const Motion& alone, const ArmText& text, Index blend) {
  Motion out = motion;
  const Index frames = std::min({std::ssize(text.on), alone.frames(), motion.frames() - text.start});
  const auto on = [&](Index f) { return f >= 0 && f < frames && text.on[static_cast<std::size_t>(f)] != 0; };
  for (Index f = 0; f < frames; ++f) {
    if (!on(f)) continue;
    Index near = blend + 1;  // frames to where the arm is not the text's, which the ends of the motion are not
    for (Index d = 1; d <= blend; ++d) {
      const bool before = text.start + f - d >= 0 && !on(f - d),
                 behind = text.start + f + d < motion.frames() && !on(f + d);
      if (before || behind) near = std::min(near, d);
    }
    const double weight = smoothstep(static_cast<double>(near) / static_cast<double>(blend + 1));
    const auto from = alone.rotations(f);
    const auto to = out.rotations(text.start + f);
    for (std::size_t j = 1; j < to.size(); ++j) {
      if (smpl_part_of_joint[j] == text.arm) to[j] = slerp(to[j], from[j], weight);
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_GENERATE_DETAIL_KEPT_CLIP_HPP  // <motionlang/generate/detail/kept_clip.hpp>
#define MOTIONLANG_HAS_GENERATE_DETAIL_KEPT_CLIP_HPP
/// The part of generate_motion about options and kept motions that does not depend on the backend.

#ifndef MOTIONLANG_HAS_GENERATE_FINISH_MOTION_HPP  // <motionlang/generate/finish_motion.hpp>
#define MOTIONLANG_HAS_GENERATE_FINISH_MOTION_HPP
/// From the numbers that a model makes to a motion that can be shown: rows of features become a motion, which is
/// smoothed and put on its feet.
///
///     Motion m = motion_of_features(stmc.layout.name, rows, stmc.layout.size, stmc.fps);
///     m = finish_motion(std::move(m), {});

MOTIONLANG_NAMESPACE_BEGIN

/// The named features that a model of this layout and width makes: "guoh3dfeats" is HumanML3D's or KIT's. Throws
/// config_error 103 for another layout.
const MotionFeatures& features_of_layout(std::string_view layout, Index width);

/// rows    (frames, width), not normalised
/// layout  that of a model: "smplrifke", which starts facing pi as published; "guoh3dfeats", of HumanML3D or KIT; or
///         the name of any motion_features
/// Throws  config_error 103 for another layout, and what motion_of_rows throws
Motion motion_of_features(std::string_view layout, std::span<const double> rows, Index width, double fps);
/// fps: 0 is the rate of the features.
Motion motion_of_features(const MotionFeatures& features, std::span<const float> rows, double fps = 0);

/// Removes jitter (smooth_motion), lets the floor carry the body (stand_on_floor), keeps standing feet from sliding
/// (fix_feet) and lifts feet that sink in (lift_sunken_feet), as the options say. Floor and feet are fixed on skeletons
/// with known_legs. Feet come last, because feet that stand are to be still.
Motion finish_motion(Motion motion, const GenerateOptions& options);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_GENERATE_FINISH_MOTION_IPP  // <motionlang/generate/finish_motion.ipp>
#define MOTIONLANG_HAS_GENERATE_FINISH_MOTION_IPP
// Bodies of finish_motion.hpp.

#ifndef MOTIONLANG_HAS_KINEMATICS_FLOOR_FIX_HPP  // <motionlang/kinematics/floor_fix.hpp>
#define MOTIONLANG_HAS_KINEMATICS_FLOOR_FIX_HPP
/// Bodies that the floor carries. Generated bodies hover, sink in, and stay in the air longer than gravity allows.
/// Metres, Y up.
///
///     Motion grounded = fix_floor(motion);      // stand_on_floor, lift_sunken_feet
///
/// Nothing is known of stairs, ladders and seats: what stands on one for long comes down to the floor.

#ifndef MOTIONLANG_HAS_KINEMATICS_FOOT_LOCK_HPP  // <motionlang/kinematics/foot_lock.hpp>
#define MOTIONLANG_HAS_KINEMATICS_FOOT_LOCK_HPP
/// Feet that stay where they stand. Y up, metres. Generated motions slide a little: the path of the root and the legs
/// are predicted side by side and agree only nearly.
///
///     Motion steady = fix_feet(motion);      // turn_from_feet, path_from_feet, lock_feet, raise_swings

#ifndef MOTIONLANG_HAS_KINEMATICS_FOOT_CONTACT_HPP  // <motionlang/kinematics/foot_contact.hpp>
#define MOTIONLANG_HAS_KINEMATICS_FOOT_CONTACT_HPP
/// When feet touch the floor. Y up, metres.

MOTIONLANG_NAMESPACE_BEGIN

/// A joint that may touch the floor, and the height below which it does.
struct ContactJoint {
  int joint = 0;
  double height = 0.05;  // metres above the floor
};
/// The feet of SMPL and HumanML3D. When a foot stands, its ankle is about 7 cm and its toe joint 1 to 2 cm high.
inline constexpr double smpl_ankle_contact = 0.10, smpl_toe_contact = 0.05;
/// Ankles and toes of SMPL (and HumanML3D).
inline constexpr ContactJoint smpl_contact_joints[] = {
    {7, smpl_ankle_contact}, {8, smpl_ankle_contact}, {10, smpl_toe_contact}, {11, smpl_toe_contact}};

namespace detail {

/// The way of a joint over the floor from one frame to the next; `low` if it is below its height in both.
struct Slide {
  bool low = false;
  Vec3<double> step{};
  double length() const { return norm(step); }
};
/// positions (frames, joints); frame + 1 is one of them.
inline Slide slide(std::span<const Vec3<double>> positions, Index joints, Index frame, const ContactJoint& foot,
                   double floor) {
  const auto &a = positions[static_cast<std::size_t>(frame * joints + foot.joint)],
             &b = positions[static_cast<std::size_t>((frame + 1) * joints + foot.joint)];
  return {std::max(a.y, b.y) - floor < foot.height, {b.x - a.x, 0, b.z - a.z}};
}

}  // namespace detail

struct ContactOptions {
  double floor = 0;
  double speed = 0.6;  // m/s over the floor; a joint that is faster is only passing
};

/// (frames, feet): 1 where a foot is below its height and slower than options.speed between a frame and the next (the
/// last frame: the one before). Throws shape_error 203 for a joint out of range.
std::vector<std::uint8_t> foot_contacts(const Motion& motion, std::span<const ContactJoint> feet = smpl_contact_joints,
                                        const ContactOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_FOOT_CONTACT_IPP  // <motionlang/kinematics/foot_contact.ipp>
#define MOTIONLANG_HAS_KINEMATICS_FOOT_CONTACT_IPP
// Bodies of foot_contact.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::uint8_t> foot_contacts(const Motion& motion, std::span<const ContactJoint> feet,
                                                        const ContactOptions& options) {
  const Index joints = motion.skeleton.size(), frames = motion.frames();
  for (const ContactJoint& foot : feet) {
    if (foot.joint < 0 || foot.joint >= joints)
      raise<shape_error>(203, "foot_contacts: joint ", foot.joint, " of ", joints);
  }
  const auto positions = motion.positions();
  std::vector<std::uint8_t> flags;
  for (Index f = 0; f < frames; ++f) {
    const Index from = std::max<Index>(0, std::min(f, frames - 2)), to = std::min(from + 1, frames - 1);
    for (const ContactJoint& foot : feet) {
      auto at = [&](Index frame) { return positions[static_cast<std::size_t>(frame * joints + foot.joint)]; };
      const Vec3<double> step = at(to) - at(from);
      const double speed = norm(Vec3<double>{step.x, 0, step.z}) * motion.fps;
      flags.push_back(at(f).y - options.floor < foot.height && speed < options.speed ? 1 : 0);
    }
  }
  return flags;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_LIMB_IK_HPP  // <motionlang/kinematics/limb_ik.hpp>
#define MOTIONLANG_HAS_KINEMATICS_LIMB_IK_HPP
/// Inverse kinematics of a limb of two bones: hip, knee and ankle, or shoulder, elbow and wrist.

MOTIONLANG_NAMESPACE_BEGIN

/// Joints of a limb, each the parent of the next.
struct Limb {
  int upper = 0, middle = 0, end = 0;
};

namespace detail {

/// Throws config_error 103 unless each joint of the limb is the parent of the next.
void require_limb(std::string_view function, const Skeleton& skeleton, const Limb& limb);

}  // namespace detail

/// Bends and turns a limb so that its end comes to `target`, or as near as its bones reach. The middle joint stays in
/// its plane, and the rotation of the end in the world is kept.
///     cos(middle) = (l1^2 + l2^2 - r^2) / (2 l1 l2),   r = |target - upper|
/// pose        (joints) local rotations of one frame, changed in place
/// world       the same frame by forward kinematics, as it was before; not changed
/// towards     where in the world the middle joint goes if the limb is straight (knees: forward)
/// Throws      config_error 103 if the joints do not hang together, shape_error 205 unless there is one rotation for
///             each joint, numeric_error 302 for a bone that is shorter than 0.1 mm
void reach(const Skeleton& skeleton, std::span<Quaternion<double>> pose, const JointTransforms<double>& world,
           const Limb& limb, const Vec3<double>& target, const Vec3<double>& towards);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_LIMB_IK_IPP  // <motionlang/kinematics/limb_ik.ipp>
#define MOTIONLANG_HAS_KINEMATICS_LIMB_IK_IPP
// Bodies of limb_ik.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void require_limb(std::string_view function, const Skeleton& skeleton, const Limb& limb) {
  auto hangs_on = [&](int joint, int parent) {
    return parent >= 0 && joint >= 0 && joint < skeleton.size() && skeleton.parent(joint) == parent;
  };
  if (!hangs_on(limb.end, limb.middle) || !hangs_on(limb.middle, limb.upper)) {
    raise<config_error>(103, function, ": joints ", limb.upper, ", ", limb.middle, ", ", limb.end,
                        " are not a limb of a skeleton of ", skeleton.size());
  }
}

}  // namespace detail

MOTIONLANG_BODY void reach(const Skeleton& skeleton, std::span<Quaternion<double>> pose,
                           const JointTransforms<double>& world, const Limb& limb, const Vec3<double>& target,
                           const Vec3<double>& towards) {
  detail::require_limb("reach", skeleton, limb);
  if (std::ssize(pose) != skeleton.size())
    raise<shape_error>(205, "reach: ", pose.size(), " rotations for ", skeleton.size(), " joints");
  const auto upper = static_cast<std::size_t>(limb.upper), middle = static_cast<std::size_t>(limb.middle),
             end = static_cast<std::size_t>(limb.end);
  const Vec3<double> a = world.position[upper], b = world.position[middle], c = world.position[end];
  const double l1 = norm(b - a), l2 = norm(c - b);
  constexpr double slack = 1e-4;  // a limb never gets quite straight, where its plane would be lost
  if (std::min(l1, l2) < slack) raise<numeric_error>(302, "reach: bones of ", l1, " m and ", l2, " m");
  const double r = std::clamp(norm(target - a), std::abs(l1 - l2) + slack, l1 + l2 - slack);
  auto angle = [](const Vec3<double>& u, const Vec3<double>& v) {
    return std::acos(std::clamp(dot(normalized(u), normalized(v)), -1.0, 1.0));
  };
  auto corner = [](double left, double right, double opposite) {
    return std::acos(std::clamp((left * left + right * right - opposite * opposite) / (2 * left * right), -1.0, 1.0));
  };
  const Vec3<double> plane = cross(c - a, b - a);
  const Vec3<double> axis = norm(plane) > 1e-6 ? normalized(plane) : normalized(cross(c - a, towards));
  const auto at_upper = from_axis_angle(axis, corner(l1, r, l2) - angle(c - a, b - a));
  const auto at_middle = from_axis_angle(axis, corner(l1, l2, r) - angle(a - b, c - b));
  const auto aim = rotation_between(normalized(c - a), normalized(target - a));

  const std::size_t above = skeleton.parents[upper] < 0 ? upper : static_cast<std::size_t>(skeleton.parents[upper]);
  const auto parent =
      skeleton.parents[upper] < 0 ? Quaternion<double>::identity() : to_quaternion(world.rotation[above]);
  const auto upper_now = aim * at_upper * to_quaternion(world.rotation[upper]);
  const auto middle_now = aim * at_upper * at_middle * to_quaternion(world.rotation[middle]);
  pose[upper] = normalized(inverse(parent) * upper_now);
  pose[middle] = normalized(inverse(upper_now) * middle_now);
  pose[end] = normalized(inverse(middle_now) * to_quaternion(world.rotation[end]));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// A leg and its toe.
struct Leg {
  Limb limb;
  int toe = 0;
};
inline constexpr Leg smpl_legs[] = {{{1, 4, 7}, 10}, {{2, 5, 8}, 11}};
inline constexpr Leg kit_legs[] = {{{11, 12, 13}, 15}, {{16, 17, 18}, 20}};

/// Those of a skeleton with the joints of SMPL, with or without its hands, or of KIT; none of another one.
std::span<const Leg> known_legs(const Skeleton& skeleton);

struct FootFixOptions {
  double floor = 0;
  double ankle_height = smpl_ankle_contact, toe_height = smpl_toe_contact;  // below: in contact
  double speed = 0.5;       // m/s; lock_feet takes a foot that slides faster to swing
  double path_speed = 2;    // m/s; path_from_feet takes no foot that slides faster to carry the body
  double path_sigma = 1.5;  // frames; smoothness of the correction of the path
  Index blend = 4;          // frames before and after a contact in which the leg comes and goes
  double pivot = 15;        // degrees/s; turn_from_feet lets two feet on the floor turn together that fast
  double clearance = 0.03;  // m; toes swing this high above where they stand; in recorded walks mostly 2.7 to 5.5 cm
};

/// The clip turned so that nobody turns like a turntable: what both feet turn together while they are on the floor,
/// beyond `pivot`, the body does not turn. Where it looks is decided by the legs. The way turns with it.
/// Throws config_error 103 if the skeleton has no such legs. A body without two legs stays as it is.
Motion turn_from_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

/// The clip with its path over the floor corrected so that the foot that stands (of the low ones the slowest) does not
/// slide: where somebody goes is decided by the legs. Rotations and heights stay; in the air the path stays, too.
/// Throws config_error 103 if the skeleton has no such legs, 101 unless path_sigma > 0.
Motion path_from_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

namespace detail {

/// Throws config_error 103 unless the skeleton has these legs.
void require_legs(std::string_view function, const Skeleton& skeleton, std::span<const Leg> legs);
/// Moves the foot of a leg in every frame by its offset.
void move_foot(Motion& motion, const Leg& leg, std::span<const Vec3<double>> offset);

}  // namespace detail

/// The clip with legs bent so that ankles and toes in contact stay in place. Between contacts the correction fades out
/// and in. Throws config_error 103 if the skeleton has no such legs, numeric_error 302 if a leg has no length.
Motion lock_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

/// The clip with legs bent so that a foot swings over the floor, not along it: generated ones pass too low. A foot that
/// stands is not moved. Throws as lock_feet.
Motion raise_swings(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

/// turn_from_feet, path_from_feet, lock_feet, raise_swings. Throws what they throw.
inline Motion fix_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                       const FootFixOptions& options = {}) {
  const Motion carried = path_from_feet(turn_from_feet(motion, legs, options), legs, options);
  return raise_swings(lock_feet(carried, legs, options), legs, options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_FOOT_LOCK_IPP  // <motionlang/kinematics/foot_lock.ipp>
#define MOTIONLANG_HAS_KINEMATICS_FOOT_LOCK_IPP
// Bodies of foot_lock.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::span<const Leg> known_legs(const Skeleton& skeleton) {
  auto is = [&](const Skeleton& s) { return skeleton.names == s.names && skeleton.parents == s.parents; };
  if (is(smpl24_skeleton()) || is(humanml3d22_skeleton())) return smpl_legs;
  if (is(kit21_skeleton())) return kit_legs;
  return {};
}

namespace detail {

MOTIONLANG_BODY void require_legs(std::string_view function, const Skeleton& skeleton, std::span<const Leg> legs) {
  for (const Leg& leg : legs) {
    require_limb(function, skeleton, leg.limb);
    if (leg.toe < 0 || leg.toe >= skeleton.size())
      raise<config_error>(103, function, ": toe ", leg.toe, " of a skeleton of ", skeleton.size());
  }
}

/// The two joints of a leg that may stand: ankle and toe.
inline std::array<ContactJoint, 2> feet_of(const Leg& leg, const FootFixOptions& options) {
  return {{{leg.limb.end, options.ankle_height}, {leg.toe, options.toe_height}}};
}

}  // namespace detail

MOTIONLANG_BODY Motion turn_from_feet(const Motion& motion, std::span<const Leg> legs, const FootFixOptions& options) {
  detail::require_legs("turn_from_feet", motion.skeleton, legs);
  if (motion.frames() < 2 || legs.size() != 2) return motion;
  const auto positions = motion.positions();
  const Index joints = motion.skeleton.size();
  const auto at = [&](Index f, int joint) { return positions[static_cast<std::size_t>(f * joints + joint)]; };
  const auto down = [&](Index f) {
    return std::all_of(legs.begin(), legs.end(), [&](const Leg& leg) {
      return at(f, leg.limb.end).y - options.floor < options.ankle_height ||
             at(f, leg.toe).y - options.floor < options.toe_height;
    });
  };
  const double pivot = options.pivot * std::numbers::pi / 180 / motion.fps;
  std::vector<double> turned(static_cast<std::size_t>(motion.frames()), 0.0);  // to each frame, too much
  for (Index f = 0; f + 1 < motion.frames(); ++f) {
    if (!down(f) || !down(f + 1)) continue;
    std::array<double, 2> turn{};
    for (std::size_t side = 0; side < 2; ++side) {
      const Vec3<double> a = at(f, legs[side].toe) - at(f, legs[side].limb.end),
                         b = at(f + 1, legs[side].toe) - at(f + 1, legs[side].limb.end);
      turn[side] = std::remainder(std::atan2(b.x, b.z) - std::atan2(a.x, a.z), 2 * std::numbers::pi);
    }
    if (turn[0] * turn[1] <= 0) continue;
    const double both = std::min(std::abs(turn[0]), std::abs(turn[1]));
    turned[static_cast<std::size_t>(f) + 1] = std::copysign(std::max(0.0, both - pivot), turn[0]);
  }
  const auto smooth = gaussian_smooth(std::span<const double>(turned), 1, options.path_sigma);
  Motion out = motion;
  double back = 0;
  for (std::size_t f = 1; f < smooth.size(); ++f) {
    const Vec3<double> up{0, 1, 0};
    Vec3<double> step = motion.root[f] - motion.root[f - 1];
    step = rotate(from_axis_angle(up, back), step);
    back -= smooth[f];
    out.root[f] = {out.root[f - 1].x + step.x, motion.root[f].y, out.root[f - 1].z + step.z};
    Quaternion<double>& root = out.rotations(static_cast<Index>(f))[0];
    root = normalized(from_axis_angle(up, back) * root);
  }
  return out;
}

MOTIONLANG_BODY Motion path_from_feet(const Motion& motion, std::span<const Leg> legs, const FootFixOptions& options) {
  detail::require_legs("path_from_feet", motion.skeleton, legs);
  const Index joints = motion.skeleton.size(), steps = motion.frames() - 1;
  if (steps < 1) return motion;
  const auto positions = motion.positions();
  std::vector<double> wanted;  // (steps, 3): x, z, weight
  for (Index f = 0; f < steps; ++f) {
    std::optional<detail::Slide> slowest;
    for (const Leg& leg : legs) {
      for (const ContactJoint& foot : detail::feet_of(leg, options)) {
        const auto s = detail::slide(positions, joints, f, foot, options.floor);
        const bool stands = s.low && s.length() * motion.fps < options.path_speed;
        if (stands && (!slowest || s.length() < slowest->length())) slowest = s;
      }
    }
    if (slowest)
      wanted.insert(wanted.end(), {slowest->step.x, slowest->step.z, 1.0});
    else
      wanted.insert(wanted.end(), {0.0, 0.0, 0.0});
  }
  const auto smooth = gaussian_smooth(std::span<const double>(wanted), 3, options.path_sigma);
  Motion out = motion;
  Vec3<double> moved{};
  for (Index f = 0; f < steps; ++f) {
    const double* s = smooth.data() + 3 * f;
    const double weight = std::max(s[2], 0.25);  // few contacts near: less
    moved = moved - Vec3<double>{s[0] / weight, 0, s[1] / weight};
    auto& root = out.root[static_cast<std::size_t>(f) + 1];
    root = root + moved;
  }
  return out;
}

namespace detail {

/// (frames): how far a foot that stands slides to the next frame, on its toe or its ankle, whichever carries it.
/// Nothing for a foot that swings, and in the last frame.
inline std::vector<std::optional<Vec3<double>>> standing_steps(const Motion& motion,
                                                               std::span<const Vec3<double>> positions, const Leg& leg,
                                                               const FootFixOptions& options) {
  std::vector<std::optional<Vec3<double>>> steps(static_cast<std::size_t>(motion.frames()));
  const auto [ankle_joint, toe_joint] = feet_of(leg, options);
  for (Index f = 0; f + 1 < motion.frames(); ++f) {
    const auto ankle = slide(positions, motion.skeleton.size(), f, ankle_joint, options.floor),
               toe = slide(positions, motion.skeleton.size(), f, toe_joint, options.floor);
    const auto& pivot = toe.low && (!ankle.low || toe.length() < ankle.length()) ? toe : ankle;
    if (pivot.low && pivot.length() * motion.fps < options.speed) steps[static_cast<std::size_t>(f)] = pivot.step;
  }
  return steps;
}

/// Where the knee of a straight leg goes, seen from the thigh: where the toes point in the rest pose, whatever that
/// faces. +Z for a foot that does not tell.
inline Vec3<double> forward_of(const Skeleton& skeleton, const Leg& leg) {
  const auto rest = skeleton.rest_positions();
  const auto at = [&](int joint) { return rest[static_cast<std::size_t>(joint)]; };
  const Vec3<double> shank = at(leg.limb.end) - at(leg.limb.upper), foot = at(leg.toe) - at(leg.limb.end);
  const double length = dot(shank, shank);
  const Vec3<double> forward = length > 0 ? foot - (dot(foot, shank) / length) * shank : foot;
  return norm(forward) > 0.1 * norm(foot) ? normalized(forward) : Vec3<double>{0, 0, 1};
}

MOTIONLANG_BODY void move_foot(Motion& motion, const Leg& leg, std::span<const Vec3<double>> offset) {
  JointTransforms<double> world;
  const Vec3<double> forward_at_rest = forward_of(motion.skeleton, leg);
  for (Index f = 0; f < motion.frames(); ++f) {
    const Vec3<double> by = offset[static_cast<std::size_t>(f)];
    if (norm(by) < 1e-6) continue;
    motion.world(f, world);
    const Vec3<double> target = world.position[static_cast<std::size_t>(leg.limb.end)] + by;
    const Vec3<double> forward = world.rotation[static_cast<std::size_t>(leg.limb.upper)] * forward_at_rest;
    reach(motion.skeleton, motion.rotations(f), world, leg.limb, target, forward);
  }
}

/// (frames): by how much a foot has to be raised so that its toe swings `clearance` above the lower of the heights
/// where it left the floor and where it comes back. One bump sin^2 for each swing, no higher than that or a tenth of
/// its way: a foot that only jitters is left alone.
inline std::vector<Vec3<double>> swing_lifts(const Motion& motion, std::span<const Vec3<double>> positions,
                                             const Leg& leg, const FootFixOptions& options) {
  const Index frames = motion.frames(), joints = motion.skeleton.size();
  const auto standing = standing_steps(motion, positions, leg, options);
  auto toe = [&](Index f) { return positions[static_cast<std::size_t>(f * joints + leg.toe)]; };
  std::vector<Vec3<double>> lift(static_cast<std::size_t>(frames));
  for (Index first = 0; first + 1 < frames; ++first) {  // first: the last frame in which the foot stands
    if (standing[static_cast<std::size_t>(first)]) continue;
    Index last = first + 1;  // the next frame in which it stands
    while (last + 1 < frames && !standing[static_cast<std::size_t>(last)]) ++last;
    const bool from_floor = first > 0, to_floor = last + 1 < frames;
    auto bump = [&](Index f) {  // at an end of the clip the foot is in mid-swing
      const double t = static_cast<double>(f - first) / static_cast<double>(last - first);
      const double s = std::sin(std::numbers::pi * (from_floor && to_floor ? t : from_floor ? t / 2 : (1 - t) / 2));
      return s * s;
    };
    if (from_floor || to_floor) {
      const double from = toe(first).y, to = toe(last).y;
      const double level = options.clearance + (!to_floor ? from : !from_floor ? to : std::min(from, to));
      double height = 0, way = 0;
      for (Index f = first; f <= last; ++f) {
        if (bump(f) > 0.5) height = std::max(height, (level - toe(f).y) / bump(f));
        if (f > first) way += norm(Vec3<double>{toe(f).x - toe(f - 1).x, 0, toe(f).z - toe(f - 1).z});
      }
      height = std::min({height, options.clearance, way / 10});
      for (Index f = first; f <= last; ++f) lift[static_cast<std::size_t>(f)].y = height * bump(f);
    }
    first = last - 1;
  }
  return lift;
}

/// (frames): by how much a foot has to be moved to stay where it stands. During a contact the offset undoes the slide;
/// its mean is zero, so that the foot stands where it was on average. Between contacts it fades out and in.
inline std::vector<Vec3<double>> foot_offsets(const Motion& motion, std::span<const Vec3<double>> positions,
                                              const Leg& leg, const FootFixOptions& options) {
  const Index frames = motion.frames();
  const auto standing = standing_steps(motion, positions, leg, options);
  std::vector<std::uint8_t> fixed(standing.size(), 0);
  std::vector<Vec3<double>> offset(standing.size());
  for (std::size_t f = 0; f < standing.size(); ++f) {
    if (!standing[f]) continue;
    const std::size_t first = f;
    Vec3<double> sum{};
    for (; standing[f]; ++f) {  // nothing in the last frame
      offset[f + 1] = offset[f] - *standing[f];
      sum = sum + offset[f + 1];
    }
    const Vec3<double> mean = (1.0 / static_cast<double>(f - first + 1)) * sum;
    for (std::size_t i = first; i <= f; ++i) offset[i] = offset[i] - mean, fixed[i] = 1;
  }
  for (Index f = 0; f < frames; ++f) {
    if (fixed[static_cast<std::size_t>(f)] != 0) continue;
    double share = 0;
    auto fade = [&](Index direction) {  // from the nearest contact on one side
      for (Index d = 1; d <= options.blend; ++d) {
        const Index from = f + direction * d;
        if (from < 0 || from >= frames) break;
        if (fixed[static_cast<std::size_t>(from)] == 0) continue;
        const double weight = smoothstep(1 - static_cast<double>(d) / static_cast<double>(options.blend + 1));
        share += weight;
        return weight * offset[static_cast<std::size_t>(from)];
      }
      return Vec3<double>{};
    };
    const Vec3<double> both = fade(-1) + fade(1);
    offset[static_cast<std::size_t>(f)] = (1 / std::max(share, 1.0)) * both;  // contacts that are near: their mean
  }
  return offset;
}

}  // namespace detail

MOTIONLANG_BODY Motion lock_feet(const Motion& motion, std::span<const Leg> legs, const FootFixOptions& options) {
  detail::require_legs("lock_feet", motion.skeleton, legs);
  if (motion.frames() < 2) return motion;
  const auto positions = motion.positions();
  Motion out = motion;
  for (const Leg& leg : legs) detail::move_foot(out, leg, detail::foot_offsets(motion, positions, leg, options));
  return out;
}

MOTIONLANG_BODY Motion raise_swings(const Motion& motion, std::span<const Leg> legs, const FootFixOptions& options) {
  detail::require_legs("raise_swings", motion.skeleton, legs);
  const auto positions = motion.positions();
  Motion out = motion;
  for (const Leg& leg : legs) detail::move_foot(out, leg, detail::swing_lifts(motion, positions, leg, options));
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct FloorFixOptions {
  double floor = 0;
  double ankle_stands = 0.07, toe_stands = 0.015;  // m; height of these joints of a foot that stands
  double body_rests = 0.05;                        // m; of any other joint on which a body rests
  double tolerance = 0.04;                         // m; a body within this distance of the floor stays
  double longest_flight = 1.2;                     // s; a body that is above the floor for longer hovers
  double gravity = 9.81;                           // m/s^2
  double sigma = 0.05;                             // s; smoothness of the correction
  double foot_sinks = 0.02;                        // m; a foot that is less deep in the floor stays
};

namespace detail {

/// How far a foot is above the height at which it stands, on its toe or its ankle, whichever is nearer to the floor.
inline double foot_over_floor(std::span<const Vec3<double>> pose, const Leg& leg, const FloorFixOptions& options) {
  const auto at = [&](int joint) { return pose[static_cast<std::size_t>(joint)].y - options.floor; };
  return std::min(at(leg.limb.end) - options.ankle_stands, at(leg.toe) - options.toe_stands);
}

}  // namespace detail

/// (frames): how far the lowest part of the body is above the floor, by the heights at which it stands or rests.
/// Negative: it is sunk in. Throws config_error 103 if the skeleton has no such legs.
std::vector<double> heights_over_floor(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                                       const FloorFixOptions& options = {});

/// The clip with its root moved up and down so that the floor carries it: h_f of heights_over_floor becomes 0 where the
/// body stands. Rotations and the way over the floor stay.
///     hovering   what is left of h if flights of at most longest_flight are taken away (a morphological opening)
///     flights    no higher than a thrown body of the same peak:   h_f <= H - g/2 (t_f - t_peak)^2, or 0
///     sunken     raised by as much as they are below the floor
/// A correction starts at `tolerance`, and is full from twice that on.
/// Throws config_error 103 if the skeleton has no such legs, 101 unless longest_flight and sigma are positive.
Motion stand_on_floor(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FloorFixOptions& options = {});

/// The clip with legs bent so that no foot is deeper in the floor than foot_sinks. Throws as lock_feet.
Motion lift_sunken_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                        const FloorFixOptions& options = {});

/// stand_on_floor, lift_sunken_feet. Throws what they throw.
inline Motion fix_floor(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                        const FloorFixOptions& options = {}) {
  return lift_sunken_feet(stand_on_floor(motion, legs, options), legs, options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_FLOOR_FIX_IPP  // <motionlang/kinematics/floor_fix.ipp>
#define MOTIONLANG_HAS_KINEMATICS_FLOOR_FIX_IPP
// Bodies of floor_fix.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The joints of one frame among (frames, joints).
inline std::span<const Vec3<double>> pose_of(std::span<const Vec3<double>> positions, Index joints, Index frame) {
  return positions.subspan(static_cast<std::size_t>(frame * joints), static_cast<std::size_t>(joints));
}

/// 0 up to the tolerance, x from twice that on, and steadily between.
inline double beyond(double x, double tolerance) { return x >= 2 * tolerance ? x : std::max(0.0, 2 * (x - tolerance)); }

/// The smallest (of larger: largest) value within `reach` frames of each.
inline std::vector<double> extremes(std::span<const double> values, Index reach, bool larger) {
  const Index n = std::ssize(values);
  std::vector<double> out;
  for (Index f = 0; f < n; ++f) {
    double best = values[static_cast<std::size_t>(f)];
    for (Index k = std::max<Index>(0, f - reach); k <= std::min(n - 1, f + reach); ++k) {
      const double v = values[static_cast<std::size_t>(k)];
      best = larger ? std::max(best, v) : std::min(best, v);
    }
    out.push_back(best);
  }
  return out;
}

/// By how much each frame of a flight is above the arc of a thrown body with the same peak. The peak is in the middle
/// of the frames that are nearly as high.
/// heights  above the floor, no hovering among them
inline std::vector<double> above_arcs(std::span<const double> heights, double fps, const FloorFixOptions& options) {
  const Index n = std::ssize(heights);
  std::vector<double> above(heights.size(), 0.0);
  const auto h = [&](Index f) { return heights[static_cast<std::size_t>(f)]; };
  for (Index first = 0, last = 0; first < n; first = last + 1) {
    for (last = first; last < n && h(last) > options.tolerance; ++last) {}
    if (first == last) continue;
    double peak = 0;
    for (Index f = first; f < last; ++f) peak = std::max(peak, h(f));
    Index from = last, to = first;
    for (Index f = first; f < last; ++f) {
      if (h(f) >= 0.9 * peak) from = std::min(from, f), to = std::max(to, f);
    }
    const double middle = 0.5 * static_cast<double>(from + to);
    for (Index f = first; f < last; ++f) {
      const double t = (static_cast<double>(f) - middle) / fps;
      above[static_cast<std::size_t>(f)] = h(f) - std::clamp(peak - 0.5 * options.gravity * t * t, 0.0, h(f));
    }
  }
  return above;
}

/// Never below the values, and smooth where they begin and end.
inline std::vector<double> smooth_above(std::span<const double> values, double sigma) {
  const auto wide = extremes(values, 1, true);
  return gaussian_smooth(std::span<const double>(wide), 1, sigma);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<double> heights_over_floor(const Motion& motion, std::span<const Leg> legs,
                                                       const FloorFixOptions& options) {
  detail::require_legs("heights_over_floor", motion.skeleton, legs);
  const auto positions = motion.positions();
  const Index joints = motion.skeleton.size();
  std::vector<bool> of_foot(static_cast<std::size_t>(joints));
  for (const Leg& leg : legs) {
    for (const int joint : {leg.limb.end, leg.toe}) of_foot[static_cast<std::size_t>(joint)] = true;
  }
  std::vector<double> heights;
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto pose = detail::pose_of(positions, joints, f);
    double lowest = pose.front().y - options.floor - options.body_rests;
    for (std::size_t j = 0; j < pose.size(); ++j) {
      if (!of_foot[j]) lowest = std::min(lowest, pose[j].y - options.floor - options.body_rests);
    }
    for (const Leg& leg : legs) lowest = std::min(lowest, detail::foot_over_floor(pose, leg, options));
    heights.push_back(lowest);
  }
  return heights;
}

MOTIONLANG_BODY Motion stand_on_floor(const Motion& motion, std::span<const Leg> legs, const FloorFixOptions& options) {
  if (!(options.longest_flight > 0 && options.sigma > 0))
    raise<config_error>(101, "stand_on_floor: flights of ", options.longest_flight, " s, sigma ", options.sigma, " s");
  const auto heights = heights_over_floor(motion, legs, options);
  if (heights.empty()) return motion;
  const double sigma = options.sigma * motion.fps;  // frames
  const auto reach = static_cast<Index>(
      std::min(0.5 * options.longest_flight * motion.fps + 0.5, static_cast<double>(motion.frames())));
  const auto hovering = detail::extremes(detail::extremes(heights, reach, false), reach, true);
  std::vector<double> down, up, left;
  for (std::size_t f = 0; f < heights.size(); ++f) down.push_back(detail::beyond(hovering[f], options.tolerance));
  down = gaussian_smooth(std::span<const double>(down), 1, 2 * sigma);
  for (std::size_t f = 0; f < heights.size(); ++f) {
    left.push_back(heights[f] - down[f]);
    up.push_back(detail::beyond(-left[f], options.tolerance));
  }
  auto arcs = detail::above_arcs(left, motion.fps, options);
  for (double& a : arcs) a = detail::beyond(a, options.tolerance);
  arcs = gaussian_smooth(std::span<const double>(arcs), 1, sigma);
  up = detail::smooth_above(up, 2 * sigma);
  Motion out = motion;
  for (std::size_t f = 0; f < heights.size(); ++f) out.root[f].y += up[f] - down[f] - arcs[f];
  return out;
}

MOTIONLANG_BODY Motion lift_sunken_feet(const Motion& motion, std::span<const Leg> legs,
                                        const FloorFixOptions& options) {
  detail::require_legs("lift_sunken_feet", motion.skeleton, legs);
  if (motion.frames() == 0) return motion;
  const auto positions = motion.positions();
  Motion out = motion;
  for (const Leg& leg : legs) {
    std::vector<double> sunk;
    for (Index f = 0; f < motion.frames(); ++f)
      sunk.push_back(
          detail::beyond(-detail::foot_over_floor(detail::pose_of(positions, motion.skeleton.size(), f), leg, options),
                         options.foot_sinks));
    std::vector<Vec3<double>> lift;
    for (const double y : detail::smooth_above(sunk, options.sigma * motion.fps)) lift.push_back({0, y, 0});
    detail::move_foot(out, leg, lift);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_SMOOTH_MOTION_HPP  // <motionlang/kinematics/smooth_motion.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SMOOTH_MOTION_HPP
/// Removes jitter from a clip. Slow movement, peaks and the ends of the clip stay where they are.

MOTIONLANG_NAMESPACE_BEGIN

struct SmoothOptions {
  /// Seconds. At 20 frames per second and 0.04 s a movement of 2.5 Hz keeps 98 % of its size, one of 5 Hz 82 %, one of
  /// 10 Hz 35 %. Heels and toes strike the floor at such rates: more makes feet slide.
  double sigma = 0.04;
};

/// The clip with its root positions and local rotations smoothed along time by local parabolas. Rotations are averaged
/// where they are: as rotation vectors seen from the frame itself.
///     p'_f = sum_k c_k p_{f+k},   q'_f = q_f exp(sum_k c_k log(q_f^-1 q_{f+k})),   |k| <= floor(4 sigma fps + 1/2)
/// With fewer than two neighbours on each side within reach nothing changes.
/// Throws config_error 101 unless sigma >= 0.
Motion smooth_motion(const Motion& motion, const SmoothOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_SMOOTH_MOTION_IPP  // <motionlang/kinematics/smooth_motion.ipp>
#define MOTIONLANG_HAS_KINEMATICS_SMOOTH_MOTION_IPP
// Bodies of smooth_motion.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The weights c of x_{first} ... x_{last} (0 is the frame itself) in the value at 0 of the parabola that fits them
/// best, errors weighted by exp(-k^2 / (2 sigma^2)). They sum to 1, and a parabola is its own fit: so peaks are not
/// blunted and ends are not pulled. Fewer than three values: the frame itself.
///     c_k = w_k (1 0 0) M^-1 (1, k, k^2)^T,   M_ab = sum_k w_k k^(a + b)
/// Source  Savitzky and Golay (1964); with Gaussian weights local regression, Cleveland (1979)
inline std::vector<double> parabola_weights(Index first, Index last, double sigma) {
  std::vector<double> c;
  std::array<double, 5> s{};
  for (Index k = first; k <= last; ++k) {
    const auto x = static_cast<double>(k);
    c.push_back(std::exp(-0.5 * x * x / (sigma * sigma)));
    double power = c.back();
    for (double& sum : s) sum += power, power *= x;
  }
  const std::array<double, 3> row{s[2] * s[4] - s[3] * s[3], s[2] * s[3] - s[1] * s[4], s[1] * s[3] - s[2] * s[2]};
  const double determinant = s[0] * row[0] + s[1] * row[1] + s[2] * row[2];
  for (Index k = first; k <= last; ++k) {
    const auto x = static_cast<double>(k);
    double& weight = c[static_cast<std::size_t>(k - first)];
    if (last - first < 2)
      weight = k == 0 ? 1 : 0;
    else
      weight *= (row[0] + row[1] * x + row[2] * x * x) / determinant;
  }
  return c;
}

}  // namespace detail

MOTIONLANG_BODY Motion smooth_motion(const Motion& motion, const SmoothOptions& options) {
  const double sigma = options.sigma * motion.fps;  // frames
  if (!(sigma >= 0) || !std::isfinite(sigma)) raise<config_error>(101, "smooth_motion: sigma ", options.sigma, " s");
  const auto radius = static_cast<Index>(std::min(4 * sigma + 0.5, static_cast<double>(motion.frames())));
  if (radius < 2) return motion;
  const auto inner = detail::parabola_weights(-radius, radius, sigma);
  Motion out = motion;
  for (Index f = 0; f < motion.frames(); ++f) {
    const Index first = std::max(-radius, -f), last = std::min(radius, motion.frames() - 1 - f);
    const auto c = last - first == 2 * radius ? inner : detail::parabola_weights(first, last, sigma);
    auto weight = [&](Index k) { return c[static_cast<std::size_t>(k - first)]; };
    Vec3<double> root{};
    for (Index k = first; k <= last; ++k) root = root + weight(k) * motion.root_at(f + k);
    out.root[static_cast<std::size_t>(f)] = root;
    const auto here = motion.rotations(f);
    for (std::size_t j = 0; j < here.size(); ++j) {
      const Quaternion<double> undo = inverse(here[j]);
      Vec3<double> turn{};
      for (Index k = first; k <= last; ++k) {
        if (k != 0) turn = turn + weight(k) * log_so3(undo * motion.rotations(f + k)[j]);
      }
      out.rotations(f)[j] = normalized(here[j] * to_quaternion(AxisAngle<double>{turn}));
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY const MotionFeatures& features_of_layout(std::string_view layout, Index width) {
  if (layout != "guoh3dfeats") return motion_features(layout);
  const MotionFeatures& kit = motion_features("kit");
  return width == kit.width ? kit : motion_features("guoh3d");
}

MOTIONLANG_BODY Motion motion_of_features(std::string_view layout, std::span<const double> rows, Index width,
                                          double fps) {
  if (layout == "smplrifke") return detail::published_motion(rows, fps);
  return motion_of_rows(features_of_layout(layout, width), rows, fps);
}

MOTIONLANG_BODY Motion motion_of_features(const MotionFeatures& features, std::span<const float> rows, double fps) {
  const std::vector<double> values(rows.begin(), rows.end());
  return motion_of_rows(features, values, fps);
}

MOTIONLANG_BODY Motion finish_motion(Motion motion, const GenerateOptions& options) {
  if (options.smooth) motion = smooth_motion(motion);
  const auto legs = known_legs(motion.skeleton);
  if (legs.empty()) return motion;
  if (options.fix_floor) motion = stand_on_floor(motion, legs);
  if (options.fix_feet) motion = fix_feet(motion, legs);
  if (options.fix_floor) motion = lift_sunken_feet(motion, legs);
  return motion;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws option_error 105 if more steps are wanted than the model has.
void require_steps(const GenerateOptions& options, Index steps);
/// Throws option_error 102 for options of models that go through STMC that contradict each other.
void require_one_source(const GenerateOptions& options);

/// The frames that are kept of a clip of `frames` frames in a timeline of `wanted`. Throws option_error 101 for frames
/// that are not there.
std::vector<IndexRange> kept_frames(const KeptClip& keep, Index frames, Index wanted, double fps);

/// Made frames, at most this many beside those that are kept, lead from the ones to the others.
Motion without_jumps(Motion motion, std::span<const IndexRange> kept, Index frames);

/// Where the clip is, if its way is kept: turned and moved over the floor. Frames that are kept behind made ones are
/// where these lead.
/// clip  what is kept, at the rate of the motion
Motion in_its_place(Motion motion, const Motion& other, Index clip_frames, const GenerateOptions& options);

/// Metres over the floor that the root of any kept frame is from where it was; 0 where the way is not kept.
double farthest_from(const Motion& motion, const Motion& clip, Index clip_frames, const KeptClip& keep);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_GENERATE_DETAIL_KEPT_CLIP_IPP  // <motionlang/generate/detail/kept_clip.ipp>
#define MOTIONLANG_HAS_GENERATE_DETAIL_KEPT_CLIP_IPP
// Bodies of kept_clip.hpp.

#ifndef MOTIONLANG_HAS_KINEMATICS_BLEND_HPP  // <motionlang/kinematics/blend.hpp>
#define MOTIONLANG_HAS_KINEMATICS_BLEND_HPP
/// Blending clips: one into another, the end of a clip into its start, so that it can be repeated for ever, and frames
/// into those beside them.
///
///     Motion both = blend_into(walk, run, 10);      // half a second at 20 frames per second
///     Motion cycle = make_loop(in_place(walk), 8).motion;
///     Motion whole = without_jump(motion, 20, 30);  // frame 20 follows on frame 19, frame 30 is as it was

#ifndef MOTIONLANG_HAS_KINEMATICS_ROOT_MOTION_HPP  // <motionlang/kinematics/root_motion.hpp>
#define MOTIONLANG_HAS_KINEMATICS_ROOT_MOTION_HPP
/// Where a clip stands and goes on the floor: moving a whole clip, clips in place, and the path of the root as a track
/// of its own, as game engines want it. Y up, metres, radians; a turn to the left is positive.

MOTIONLANG_NAMESPACE_BEGIN

/// The turn about the vertical that brings rotation `from` nearest to `to`, in [-pi, pi]. Whatever the local axes of
/// the root are: turn_between(q, Ry(a) q) = a.
///     max over a of |<to, Ry(a) from>|:   a = 2 atan2(d_y, d_w),   d = to from^-1
inline double turn_between(const Quaternion<double>& from, const Quaternion<double>& to) {
  const Quaternion<double> d = to * inverse(from);
  return std::remainder(2 * std::atan2(d.y, d.w), 2 * std::numbers::pi);
}

/// A clip moved over the floor.   p' = Ry(turn) p + shift
struct Placement {
  double turn = 0;
  Vec3<double> shift{};

  Quaternion<double> rotation() const { return from_axis_angle(Vec3<double>{0, 1, 0}, turn); }
  Vec3<double> operator()(const Vec3<double>& p) const { return rotate(rotation(), p) + shift; }
};

/// The transform that moves the root in frame `from` of one clip over the place and heading of the root in frame `to`
/// of another. Heights stay. The frames exist.
Placement placement_between(const Motion& clip, Index from, const Motion& other, Index to);

/// The whole clip moved.
Motion placed(const Motion& motion, const Placement& placement);

struct InPlaceOptions {
  bool keep_height = true;  // false: the root stays at the height of the first frame
};
/// The clip with its root over the origin, x = z = 0, in all frames. Rotations stay, headings with them.
Motion in_place(const Motion& motion, const InPlaceOptions& options = {});

/// The way of a root over the floor.
struct RootMotion {
  double fps = 20;
  std::vector<Vec3<double>> position;  // (frames), y = 0
  std::vector<double> heading;         // (frames), 0 in the first; continuous, so that two turns are 4 pi
};
struct ExtractedRoot {
  RootMotion path;
  Motion pose;  // in place, and always facing where the first frame faces
};

/// Takes the way of the root out of a clip. apply_root_motion puts it back.
///     position = (x, 0, z) of the root,   heading_f = turn_between(q_0, q_f)
///     pose: root (0, y, 0), rotation of the root Ry(-heading_f) q_f, all others as they are
ExtractedRoot extract_root_motion(const Motion& motion);

/// A clip carried along a path, frame by frame. Throws shape_error 204 unless both have as many frames.
Motion apply_root_motion(const Motion& pose, const RootMotion& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_ROOT_MOTION_IPP  // <motionlang/kinematics/root_motion.ipp>
#define MOTIONLANG_HAS_KINEMATICS_ROOT_MOTION_IPP
// Bodies of root_motion.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Placement placement_between(const Motion& clip, Index from, const Motion& other, Index to) {
  Placement p{turn_between(clip.rotations(from)[0], other.rotations(to)[0]), {}};
  const Vec3<double> way = other.root_at(to) - p(clip.root_at(from));
  p.shift = {way.x, 0, way.z};
  return p;
}

MOTIONLANG_BODY Motion placed(const Motion& motion, const Placement& placement) {
  Motion out = motion;
  for (Vec3<double>& r : out.root) r = placement(r);
  const Quaternion<double> turn = placement.rotation();
  for (Index f = 0; f < out.frames(); ++f) out.rotations(f)[0] = turn * out.rotations(f)[0];
  return out;
}

MOTIONLANG_BODY Motion in_place(const Motion& motion, const InPlaceOptions& options) {
  Motion out = motion;
  for (Vec3<double>& r : out.root) r = {0, options.keep_height ? r.y : motion.root_at(0).y, 0};
  return out;
}

MOTIONLANG_BODY ExtractedRoot extract_root_motion(const Motion& motion) {
  ExtractedRoot out{{motion.fps, {}, {}}, in_place(motion)};
  for (Index f = 0; f < motion.frames(); ++f) {
    const Vec3<double>& r = motion.root_at(f);
    const double before = f == 0 ? 0 : out.path.heading.back();
    const double turn = turn_between(motion.rotations(0)[0], motion.rotations(f)[0]);
    const double heading = before + std::remainder(turn - before, 2 * std::numbers::pi);
    out.path.position.push_back({r.x, 0, r.z});
    out.path.heading.push_back(heading);
    out.pose.rotations(f)[0] = Placement{-heading, {}}.rotation() * motion.rotations(f)[0];
  }
  return out;
}

MOTIONLANG_BODY Motion apply_root_motion(const Motion& pose, const RootMotion& path) {
  if (std::ssize(path.position) != pose.frames() || std::ssize(path.heading) != pose.frames()) {
    raise<shape_error>(204, "apply_root_motion: ", pose.frames(), " frames, a path of ", path.position.size(),
                       " positions and ", path.heading.size(), " headings");
  }
  Motion out = pose;
  for (Index f = 0; f < out.frames(); ++f) {
    const auto at = static_cast<std::size_t>(f);
    const Placement p{path.heading[at], path.position[at]};
    out.root[at] = p(pose.root_at(f));
    out.rotations(f)[0] = p.rotation() * pose.rotations(f)[0];
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// `second` after `first`, with `frames` frames over which the first blends into the second. The second clip is
/// turned and moved over the floor so that in the middle of these frames both roots stand over one place and have one
/// heading; heights are only blended. The result has frames(first) + frames(second) - frames frames.
/// Throws config_error 102 if skeletons or frame rates differ, 101 unless 1 <= frames <= those of each clip.
Motion blend_into(const Motion& first, const Motion& second, Index frames);

/// The clip without the jump into frame `from`: that frame goes where the ones before it lead, and what this moves it
/// by fades away until frame `to`, which is as it was. With to < from the same backwards in time: for the jump out of
/// frame `from`. k is the frame before `from`, k' the one before that (k, where the clip has none).
///     r'_i = r_i + w_i (2 r_k - r_k' - r_from),   q'_i = q_i exp(w_i log(q_from^-1 q_k q_k'^-1 q_k)),
///     w_i = 1 - smoothstep(|i - from| / |to - from|)
/// Source  "Inertialization", D. Bollo, GDC 2018; here with the weights of the other blends
/// Throws  config_error 101 unless `from` and k are frames, and -1 <= to <= frames
Motion without_jump(const Motion& motion, Index from, Index to);

/// One round of a loop.
struct LoopRound {
  Motion motion;
  Placement next;  // moves the clip of one round to that of the next
};

/// The clip as one round of a loop: its last `frames` frames are blended into its first ones and then cut off, so that
/// after the last frame the first one, moved by `next`, is the natural following one. `next` turns and moves over the
/// floor only; it is what brings the middle of the first frames over the middle of the last. A walk so goes on from
/// round to round; make a clip in place first and `next` is at most a turn.
/// Throws config_error 101 unless 1 <= frames and 2 frames <= those of the clip.
LoopRound make_loop(const Motion& motion, Index frames);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_KINEMATICS_BLEND_IPP  // <motionlang/kinematics/blend.ipp>
#define MOTIONLANG_HAS_KINEMATICS_BLEND_IPP
// Bodies of blend.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Adds the mix of two frames to a clip: roots in a line, rotations on the shortest arc.
inline void add_mixed_frame(Motion& out, const Motion& a, Index in_a, const Motion& b, Index in_b, double share_of_b) {
  out.root.push_back((1 - share_of_b) * a.root_at(in_a) + share_of_b * b.root_at(in_b));
  const auto from = a.rotations(in_a), to = b.rotations(in_b);
  for (std::size_t j = 0; j < from.size(); ++j) out.local.push_back(slerp(from[j], to[j], share_of_b));
}

/// Share of the second clip in frame i of n blended frames.
inline double share_of_second(Index i, Index n) {
  return smoothstep(static_cast<double>(i + 1) / static_cast<double>(n + 1));
}

}  // namespace detail

MOTIONLANG_BODY Motion blend_into(const Motion& first, const Motion& second, Index frames) {
  detail::require_same_kind("blend_into", first, second);
  if (frames < 1 || frames > std::min(first.frames(), second.frames())) {
    raise<config_error>(101, "blend_into: ", frames, " frames of clips of ", first.frames(), " and ", second.frames());
  }
  const Index start = first.frames() - frames, middle = frames / 2;
  const Motion next = placed(second, placement_between(second, middle, first, start + middle));
  Motion out = crop(first, 0, start);
  for (Index i = 0; i < frames; ++i) {
    detail::add_mixed_frame(out, first, start + i, next, i, detail::share_of_second(i, frames));
  }
  return concatenate(out, crop(next, frames, next.frames()));
}

MOTIONLANG_BODY Motion without_jump(const Motion& motion, Index from, Index to) {
  const Index step = to < from ? -1 : 1, k = from - step, last = motion.frames() - 1;
  if (std::min(from, k) < 0 || std::max(from, k) > last || to < -1 || to > last + 1) {
    raise<config_error>(101, "without_jump: frames ", from, " to ", to, " of a clip of ", motion.frames());
  }
  const Index before = k - step < 0 || k - step > last ? k : k - step;
  const Vec3<double> way = 2 * motion.root_at(k) - motion.root_at(before) - motion.root_at(from);
  std::vector<Vec3<double>> turns;
  for (std::size_t j = 0; j < motion.rotations(k).size(); ++j) {
    const auto of = [&](Index frame) { return motion.rotations(frame)[j]; };
    turns.push_back(log_so3(inverse(of(from)) * of(k) * inverse(of(before)) * of(k)));
  }
  Motion out = motion;
  for (Index i = from; i != to; i += step) {
    const double w = 1 - smoothstep(static_cast<double>(i - from) / static_cast<double>(to - from));
    out.root[static_cast<std::size_t>(i)] = motion.root_at(i) + w * way;
    const auto q = out.rotations(i);
    for (std::size_t j = 0; j < q.size(); ++j) q[j] = normalized(q[j] * to_quaternion(AxisAngle<double>{w * turns[j]}));
  }
  return out;
}

MOTIONLANG_BODY LoopRound make_loop(const Motion& motion, Index frames) {
  if (frames < 1 || frames > motion.frames() / 2) {
    raise<config_error>(101, "make_loop: ", frames, " frames to blend in a clip of ", motion.frames(), " at ",
                        motion.fps, " per second: at most half of it");
  }
  const Index last = motion.frames() - frames, middle = frames / 2;
  const Motion end = placed(motion, placement_between(motion, last + middle, motion, middle));
  LoopRound loop{crop(motion, 0, 0), placement_between(motion, middle, motion, last + middle)};
  for (Index i = 0; i < frames; ++i) {
    detail::add_mixed_frame(loop.motion, end, last + i, motion, i, detail::share_of_second(i, frames));
  }
  loop.motion = concatenate(loop.motion, crop(motion, frames, last));
  return loop;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void require_steps(const GenerateOptions& options, Index steps) {
  if (options.steps.value_or(0) > steps)
    raise<option_error>(105, counted(*options.steps, "step is", "steps are"), " asked for, this model has ", steps);
}

MOTIONLANG_BODY void require_one_source(const GenerateOptions& o) {
  const bool noise = !o.noise.string().empty(), record = !o.record.string().empty(), reuse = !o.reuse.string().empty();
  if (o.keep && (noise || record || reuse)) raise<option_error>(102, "keep excludes noise, record and reuse");
  if (noise && (record || reuse)) raise<option_error>(102, "noise excludes record and reuse");
  if (o.keep_beyond && !reuse) raise<option_error>(102, "keep_beyond needs reuse");
}

MOTIONLANG_BODY std::vector<IndexRange> kept_frames(const KeptClip& keep, Index frames, Index wanted, double fps) {
  const Index common = std::min(frames, wanted);
  if (keep.seconds.empty()) return {{0, common}};
  std::vector<IndexRange> out;
  for (const auto& [from, to] : keep.seconds) {
    const IndexRange range{frame_at(from, fps), frame_at(to, fps)};
    if (range.begin < 0 || range.size() < 1 || range.end > common)
      raise<option_error>(101, "keep: ", from, "-", to, " is frames ", range.begin, ":", range.end, " at ", fps,
                          " per second; the motion to keep has ", frames, ", the timeline ", wanted);
    out.push_back(range);
  }
  return out;
}

MOTIONLANG_BODY Motion without_jumps(Motion motion, std::span<const IndexRange> kept, Index frames) {
  const auto is_kept = [&](Index f) {
    return std::any_of(kept.begin(), kept.end(), [f](const IndexRange& r) { return r.begin <= f && f < r.end; });
  };
  for (Index begin = 0, end = 0; begin < motion.frames(); begin = end) {
    for (end = begin + 1; end < motion.frames() && is_kept(end) == is_kept(begin);) ++end;
    if (is_kept(begin)) continue;
    const Index reach = std::min(frames, end - begin);
    if (begin > 0) motion = without_jump(motion, begin, begin + reach);
    if (end < motion.frames()) motion = without_jump(motion, end - 1, end - 1 - reach);
  }
  return motion;
}

MOTIONLANG_BODY Motion in_its_place(Motion motion, const Motion& other, Index clip_frames,
                                    const GenerateOptions& options) {
  const KeptClip& keep = *options.keep;
  const auto ranges = kept_frames(keep, clip_frames, motion.frames(), motion.fps);
  const Index overlap = frame_at(options.overlap, motion.fps);
  if (options.smooth) motion = without_jumps(std::move(motion), ranges, overlap);
  if (!keep.parts.has(BodyPart::legs)) return motion;
  Index first = ranges.front().begin;
  for (const IndexRange& r : ranges) first = std::min(first, r.begin);
  return placed(motion, placement_between(motion, first, other, first));
}

MOTIONLANG_BODY double farthest_from(const Motion& motion, const Motion& clip, Index clip_frames,
                                     const KeptClip& keep) {
  double out = 0;
  if (!keep.parts.has(BodyPart::legs)) return out;
  for (const IndexRange& r : kept_frames(keep, clip_frames, motion.frames(), motion.fps)) {
    for (Index f = r.begin; f < r.end; ++f) {
      const auto d = motion.root_at(f) - clip.root_at(f);
      out = std::max(out, std::hypot(d.x, d.z));
    }
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_SYSTEMS_STMC_KEEP_HPP  // <motionlang/systems/stmc_keep.hpp>
#define MOTIONLANG_HAS_SYSTEMS_STMC_KEEP_HPP
/// STMC around a motion that is there already: frames or body parts of it are kept, texts make the rest.
///
///     KeptMotion<B> clip{features};                            // (frames, 205), not normalised
///     // Its first and last second: what is between is made. Or its way and steps: texts move the rest.
///     clip.parts = {{{0, 20}}, {{100, 120}}};
///     clip.parts = {{{0, 120}, BodyParts{}.with(BodyPart::legs)}};
///     const std::span<const KeptMotion<B>> kept(&clip, 1);     // one for each timeline
///     auto motions = generate_around(stmc, std::span(&timeline, 1), Philox{.seed = 7}, {}, kept);
///
/// Rule    after every step the clean estimate is overwritten where something is kept; x_t stays as it is
/// Source  MDM (Tevet et al. 2023), section 3 "Editing", MDM sample/edit.py
/// Note    features tell the way over the ground by its velocity: frames that are kept at the end move as they did,
///         from wherever the frames before them have led. Models that do not look at what is kept jump where it begins
///         and ends: `without_jump` (kinematics/blend.hpp), as in the program

MOTIONLANG_NAMESPACE_BEGIN

/// Frames and body parts that are kept. The way over the ground belongs to the part with the path: the legs of a human.
struct KeptPart {
  IndexRange frames;
  BodyParts parts = BodyParts::every();
};

/// The kept part of a motion; nothing without parts. Frame 0 is that of the timeline.
template <Backend B>
struct KeptMotion {
  Tensor<B, 2> features{};  // (frames, features), not normalised
  std::vector<KeptPart> parts{};
};

namespace detail {

/// Positions of all these parts in a feature vector.
std::vector<Index> positions_of(const FeatureLayout& layout, BodyParts parts);

/// Normalised features where they are kept, over whatever is elsewhere.
template <Backend B>
class KeptRows {
 public:
  using S = typename B::scalar;

  /// One motion for each timeline of the plan. Throws config_error 101, 102, shape_error 205, numeric_error 301.
  KeptRows(std::span<const KeptMotion<B>> kept, const BatchPlan& plan, Index stride, const FeatureLayout& layout,
           const Normalizer<B>& normalizer) {
    if (kept.size() != plan.timelines.size())
      raise<config_error>(102, "generate_around: ", kept.size(), " motions to keep for ", plan.timelines.size(),
                          " timelines");
    const Shape shape{std::ssize(kept) * stride, layout.size};
    std::vector<S> open(static_cast<std::size_t>(shape.count()), S{1}), values(open.size(), S{0});
    for (std::size_t m = 0; m < kept.size(); ++m) {
      if (kept[m].parts.empty()) continue;
      require_fitting(kept[m], layout, plan.timelines[m].frames);
      const std::vector<S> rows = normalizer.normalize(kept[m].features).to_vector();
      const std::size_t first = m * static_cast<std::size_t>(stride * layout.size);
      for (const KeptPart& part : kept[m].parts) {
        const std::vector<Index> positions = positions_of(layout, part.parts);
        for (Index f = part.frames.begin; f < part.frames.end; ++f) {
          for (const Index i : positions) {
            const auto at = static_cast<std::size_t>(f * layout.size + i);
            if (!std::isfinite(rows[at]))
              raise<numeric_error>(301, "generate_around: number ", i, " of frame ", f, " that is kept is ", rows[at]);
            values[first + at] = rows[at], open[first + at] = S{0};
          }
        }
      }
    }
    open_ = Tensor<B, 2>::from(open, shape);
    values_ = Tensor<B, 2>::from(values, shape);
  }

  Tensor<B, 2> over(const Tensor<B, 2>& x0) const { return x0 * open_ + values_; }

 private:
  static void require_fitting(const KeptMotion<B>& kept, const FeatureLayout& layout, Index frames) {
    if (kept.features.size(1) != layout.size)
      raise<shape_error>(205, "generate_around: features ", kept.features.shape(), ", the model's '", layout.name,
                         "' are ", layout.size);
    const Index known = kept.features.size(0);
    for (const KeptPart& part : kept.parts) {
      const IndexRange& r = part.frames;
      if (r.begin < 0 || r.size() < 1 || r.end > std::min(known, frames))
        raise<config_error>(101, "generate_around: frames ", r.begin, ":", r.end, " are kept of ", known,
                            " in a timeline of ", frames);
    }
  }

  Tensor<B, 2> open_, values_;  // 1 where nothing is kept, and 0 there
};

}  // namespace detail

/// As stmc.generate, with one motion to keep for each timeline. What is kept comes back as it was, except for the
/// rounding of the normalisation. Throws as generate does; config_error 101 for frames that a motion or its timeline
/// does not have, 102 for another number of motions, shape_error 205 for other features, numeric_error 301.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> generate_around(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                                          const Philox& rng, const StmcOptions& options,
                                          std::span<const KeptMotion<B>> kept) {
  std::optional<detail::KeptRows<B>> rows;
  const auto estimate = [&](const Collage<B, D>& collage, const auto& whole, const Tensor<B, 2>& x, Index t) {
    if (!rows) rows.emplace(kept, collage.plan(), collage.stride(), stmc.layout, stmc.motion_normalizer);
    return rows->over(whole(collage, x, t));
  };
  return stmc.generate_from(
      timelines, [&](Index draw, const Shape& shape) { return stmc.noise(rng, draw, shape); }, options, estimate);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_SYSTEMS_STMC_KEEP_IPP  // <motionlang/systems/stmc_keep.ipp>
#define MOTIONLANG_HAS_SYSTEMS_STMC_KEEP_IPP
// Bodies of stmc_keep.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<Index> positions_of(const FeatureLayout& layout, BodyParts parts) {
  std::vector<Index> out;
  for (int p = 0; p < layout.body.size(); ++p) {
    if (!parts.has(static_cast<BodyPart>(p))) continue;
    const std::vector<Index> own = layout.indices(static_cast<BodyPart>(p));
    out.insert(out.end(), own.begin(), own.end());
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_STMC_RECORD_HPP  // <motionlang/weights/stmc_record.hpp>
#define MOTIONLANG_HAS_WEIGHTS_STMC_RECORD_HPP
/// The record of an STMC run in one safetensors file, for edits in another process.
///
/// Metadata   record = "stmc", format = "1", model (a checksum of the weights), precision (core/precision.hpp), the
///            generator and the options of the run; for another body than the human one body/parts, the names joined by
///            " # ", and body/path
/// Tensors    x0/000, x0/001, ... (timelines * rows, features), normalised; timeline/0, ... (texts, 3): first frame,
///            end, body parts as bits; their texts are metadata text/0/0, ...

#ifndef MOTIONLANG_HAS_FILE_DETAIL_CONTENT_HASH_HPP  // <motionlang/file/detail/content_hash.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_CONTENT_HASH_HPP
/// A checksum of many bytes at the speed of memory. Against accidents, not against forgery.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// FNV-1a over words of 64 bits in four lanes, then over the lanes, the rest and the length. Every step can be undone,
/// so one changed word always changes the result.
inline std::uint64_t content_hash(std::span<const std::byte> bytes, std::uint64_t before = 0xCBF29CE484222325u) {
  constexpr std::uint64_t prime = 0x100000001B3u;
  std::uint64_t lanes[4] = {before, before ^ 1u, before ^ 2u, before ^ 3u}, words[4];
  const std::uint64_t size = bytes.size();
  for (; bytes.size() >= sizeof words; bytes = bytes.subspan(sizeof words)) {
    std::memcpy(words, bytes.data(), sizeof words);
    for (int i = 0; i < 4; ++i) lanes[i] = (lanes[i] ^ words[i]) * prime;
  }
  std::uint64_t h = before;
  for (const std::uint64_t lane : lanes) h = (h ^ lane) * prime;
  for (const std::byte b : bytes) h = (h ^ static_cast<std::uint64_t>(b)) * prime;
  h = (h ^ size) * prime;
  return h ^ h >> 32;
}

inline std::string hexadecimal(std::uint64_t value) {
  std::string out(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4) out[i] = "0123456789abcdef"[value & 15u];
  return out;
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_SYSTEMS_STMC_EDIT_HPP  // <motionlang/systems/stmc_edit.hpp>
#define MOTIONLANG_HAS_SYSTEMS_STMC_EDIT_HPP
/// STMC after an edit of its timelines: what the edit cannot have changed is taken from the run before.
///
///     StmcRecord<B> record;
///     auto motion = generate_recorded(stmc, timelines, Philox{.seed = 7}, {.steps = 10}, record);
///     timelines[0].intervals[2].text = "run";
///     StmcReuse reuse;
///     // The bits of generate(timelines, ...); then another motion than that, but only near the edit.
///     motion = regenerate(stmc, record, timelines, {}, &reuse);
///     motion = regenerate(stmc, record, timelines, {.within = 20}, &reuse);
///
/// The limit of reuse (compose/edits.hpp): an edit spreads by one crop with every step. Texts that follow
/// each other with an overlap are one chain of crops, so after as many steps as the chain has crops beside the edit
/// nothing is reused any more: with 100 steps a few per cent of the work, with 10 steps and a long timeline much of it.
/// Free are timelines of the batch that were not edited, and with overlap 0 all texts behind a cut that nothing spans.
/// For the rest there is an approximation, named `within`: frames further than that from the edit keep their clean
/// estimates of every step, as if painted over, and the frames between are made to fit to them.
/// Memory   a record has (steps, frames, 205) numbers: 20 MB for 12 s and 100 steps, 2 MB with 10

#ifndef MOTIONLANG_HAS_COMPOSE_EDITS_HPP  // <motionlang/compose/edits.hpp>
#define MOTIONLANG_HAS_COMPOSE_EDITS_HPP
/// The frames that an edit of a timeline can change, step by step. No tensors here.
///
/// A step of STMC makes every frame from the crops that are added and subtracted there, and a crop reads all of its
/// frames. So an edit changes in the first step the frames that are made of other crops than before, in the second one
/// all frames of every crop that reads one of these, and so on: it goes one crop further with every step. It stops
/// where nothing spans a cut (overlap 0), and at the end of the run. As the noise belongs to the frame, all other
/// frames are those of before, bit for bit.
///
/// Source   follows from STMC (thesis 6.2.3, figure 6.3 c); not in the thesis
/// Caution  holds for denoisers whose sequences do not depend on their batch mates (see MdmSmplDenoiser)

MOTIONLANG_NAMESPACE_BEGIN

/// The frames that differ between two runs with the same noise, of which the first is recorded, after each step.
class EditSpread {
 public:
  /// The plans of both runs, and how many rows every timeline has in them. The timelines of a batch are compared by
  /// their place in it.
  /// reads   frames that the denoiser reads from the start of a crop; 0: those of the crop
  /// within  frames further than this from the edit are said not to differ, although they would
  EditSpread(const BatchPlan& before, Index rows_before, BatchPlan after, Index rows, Index reads = 0,
             std::optional<Index> within = {});

  /// True if frame f of timeline m differs after this step.
  bool differs(std::size_t m, Index f) const { return differs_[m][static_cast<std::size_t>(f)] != 0; }
  /// Frames of all timelines that differ.
  Index frames() const;

  /// True if every timeline with frames that differ has no others.
  bool everywhere() const;
  /// True if `within` has changed anything so far.
  bool limited() const { return limited_; }

  /// The next step. Whether more frames differ after it.
  bool advance();

  /// The plan with only those crops that make frames that differ; the others have no frames and no slices.
  BatchPlan needed() const;

 private:
  template <class F>
  static void for_each_slice(const TimelinePlan& plan, F f) {
    for (const Slice& s : plan.add) f(s);
    for (const Slice& s : plan.subtract) f(s);
  }
  Index count(std::size_t m) const {
    return std::count(differs_[m].begin(), differs_[m].begin() + plan_.timelines[m].frames, 1);
  }
  bool any(std::size_t m, const FrameRange& range) const;
  /// Frames that are at most `within` away from one that is marked.
  static std::vector<char> near(const std::vector<char>& marked, Index within);

  BatchPlan plan_;
  Index rows_ = 0, reads_ = 0;
  bool limited_ = false;
  std::vector<std::vector<char>> differs_, reachable_;  // of every row of every timeline
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_COMPOSE_EDITS_IPP  // <motionlang/compose/edits.ipp>
#define MOTIONLANG_HAS_COMPOSE_EDITS_IPP
// Bodies of edits.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A crop that is added to a part of a frame, or subtracted from it. Two frames with equal lists are stitched alike.
struct FrameTerm {
  BodyPart part{};
  bool add = true;
  FrameRange crop;
  std::string_view text;
  bool operator==(const FrameTerm&) const = default;
};

/// For `rows` frames; frames behind the end depend on nothing.
inline std::vector<std::vector<FrameTerm>> frame_terms(const TimelinePlan& plan, Index rows) {
  std::vector<std::vector<FrameTerm>> terms(static_cast<std::size_t>(rows));
  const auto note = [&](const std::vector<Slice>& slices, bool add) {
    for (const Slice& s : slices) {
      const Crop& crop = plan.crops[static_cast<std::size_t>(s.crop)];
      for (Index f = s.to.start; f < s.to.end; ++f)
        terms[static_cast<std::size_t>(f)].push_back({s.part, add, crop.range, plan.text(crop)});
    }
  };
  note(plan.add, true), note(plan.subtract, false);
  return terms;
}

}  // namespace detail

MOTIONLANG_BODY EditSpread::EditSpread(const BatchPlan& before, Index rows_before, BatchPlan after, Index rows,
                                       Index reads, std::optional<Index> within)
    : plan_(std::move(after)), rows_(rows), reads_(reads) {
  for (std::size_t m = 0; m < plan_.timelines.size(); ++m) {
    std::vector<char> edited(static_cast<std::size_t>(rows), 1);  // where nothing is recorded, or of another body
    if (m < before.timelines.size() && before.timelines[m].timeline.body == plan_.timelines[m].timeline.body) {
      const Index longest = std::max(rows, rows_before);
      const auto was = detail::frame_terms(before.timelines[m], longest),
                 is = detail::frame_terms(plan_.timelines[m], longest);
      for (std::size_t f = 0; f < edited.size(); ++f)
        edited[f] = std::cmp_greater_equal(f, rows_before) || was[f] != is[f] ? 1 : 0;
    }
    reachable_.push_back(within ? near(edited, *within) : std::vector<char>(edited.size(), 1));
    differs_.push_back(std::move(edited));
  }
}

MOTIONLANG_BODY Index EditSpread::frames() const {
  Index n = 0;
  for (std::size_t m = 0; m < differs_.size(); ++m) n += count(m);
  return n;
}

MOTIONLANG_BODY bool EditSpread::everywhere() const {
  for (std::size_t m = 0; m < differs_.size(); ++m) {
    const FrameRange all{0, plan_.timelines[m].frames};
    if (any(m, all) && count(m) < all.size()) return false;
  }
  return true;
}

MOTIONLANG_BODY bool EditSpread::advance() {
  const Index before = frames();
  for (std::size_t m = 0; m < differs_.size(); ++m) {
    const TimelinePlan& plan = plan_.timelines[m];
    std::vector<char> now = differs_[m];
    for_each_slice(plan, [&](const Slice& s) {
      const FrameRange& crop = plan.crops[static_cast<std::size_t>(s.crop)].range;
      if (crop.size() == 0 || !any(m, {crop.start, reads_ > 0 ? std::min(crop.start + reads_, rows_) : crop.end}))
        return;
      for (auto f = static_cast<std::size_t>(s.to.start); f < static_cast<std::size_t>(s.to.end); ++f) {
        if (reachable_[m][f] != 0) now[f] = 1;
        limited_ |= now[f] == 0;
      }
    });
    differs_[m] = std::move(now);
  }
  return frames() > before;
}

MOTIONLANG_BODY BatchPlan EditSpread::needed() const {
  BatchPlan out = plan_;
  for (std::size_t m = 0; m < differs_.size(); ++m) {
    TimelinePlan& plan = out.timelines[m];
    std::vector<char> used(plan.crops.size());
    for_each_slice(plan, [&](const Slice& s) {
      if (any(m, s.to)) used[static_cast<std::size_t>(s.crop)] = 1;
    });
    const auto unused = [&](const Slice& s) { return used[static_cast<std::size_t>(s.crop)] == 0; };
    std::erase_if(plan.add, unused), std::erase_if(plan.subtract, unused);
    for (std::size_t c = 0; c < used.size(); ++c) {
      if (used[c] == 0) plan.crops[c].range.end = plan.crops[c].range.start;
    }
  }
  return out;
}

MOTIONLANG_BODY bool EditSpread::any(std::size_t m, const FrameRange& range) const {
  const auto begin = differs_[m].begin();
  return std::find(begin + range.start, begin + range.end, 1) != begin + range.end;
}

MOTIONLANG_BODY std::vector<char> EditSpread::near(const std::vector<char>& marked, Index within) {
  std::vector<char> out(marked.size());
  const auto sweep = [&](auto first, auto last, auto to) {
    for (Index left = -1; first != last; ++first, ++to) {
      left = *first != 0 ? within : left - 1;
      if (left >= 0) *to = 1;
    }
  };
  sweep(marked.begin(), marked.end(), out.begin());
  sweep(marked.rbegin(), marked.rend(), out.rbegin());
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// A run as it is needed after an edit.
template <Backend B>
struct StmcRecord {
  std::vector<Timeline> timelines{};
  Philox rng{};
  StmcOptions options{};           // without progress
  Index rows = 0;                  // of every timeline
  std::vector<Tensor<B, 2>> x0{};  // after each step: clean estimate (timelines * rows, features), normalised
  bool exact = true;               // false: not what a run without a record gives, because of `within`
};

struct RegenerateOptions {
  std::optional<Index> within{};  // frames; approximation: what is further from the edit stays as it was
  Progress progress{};
};

namespace detail {

/// The clean estimates of a run: those that can differ from the recorded ones are calculated, the others taken.
template <Backend B, class D>
class Regeneration {
 public:
  Regeneration(const StmcRecord<B>& before, EditSpread spread, const Collage<B, D>& collage)
      : before_(before), spread_(std::move(spread)), needed_(collage) {
    for (const TimelinePlan& p : collage.plan().timelines) reuse_.frames += p.frames;
  }

  template <class Whole>
  Tensor<B, 2> operator()(const Collage<B, D>& collage, const Whole& whole, const Tensor<B, 2>& x, Index t) {
    const std::size_t step = x0_.size();
    if (step == 0 || spread_.advance()) {
      if (spread_.frames() > 0) needed_ = collage.with_plan(spread_.needed());
      find_rows(collage);
      if (reuse_.everywhere == 0 && spread_.frames() > 0 && spread_.everywhere())
        reuse_.everywhere = static_cast<Index>(step) + 1;
    }
    const bool nothing = spread_.frames() == 0;
    reuse_.work += nothing ? 0 : needed_.batch_rows();
    reuse_.whole_work += collage.batch_rows();
    const auto made = nothing ? Tensor<B, 2>::zeros(x.shape()) : whole(needed_, x, t);
    x0_.push_back(gather(concat(0, before_.x0[step], made), rows_));
    return x0_.back();
  }

  std::vector<Tensor<B, 2>> x0() && { return std::move(x0_); }
  StmcReuse reuse() const {
    StmcReuse r = reuse_;
    r.kept = r.frames - spread_.frames();
    r.steps = std::ssize(x0_);
    r.exact = before_.exact && !spread_.limited();
    return r;
  }

 private:
  /// For every row of x0 where it is: among the recorded ones, or behind them among those just made.
  void find_rows(const Collage<B, D>& collage) {
    const Index recorded = before_.x0.front().size(0);
    rows_.clear();
    for (Index r = 0; r < collage.rows(); ++r) {
      const Index m = r / collage.stride(), f = r % collage.stride();
      rows_.push_back(spread_.differs(static_cast<std::size_t>(m), f) ? recorded + r : m * before_.rows + f);
    }
  }

  const StmcRecord<B>& before_;
  EditSpread spread_;
  Collage<B, D> needed_;
  std::vector<Index> rows_;
  std::vector<Tensor<B, 2>> x0_;
  StmcReuse reuse_;
};

template <Backend B, Denoiser<B> D>
void require_own_results(const Collage<B, D>& collage) {
  if (!collage.can_divide())
    raise<config_error>(102,
                        "edits: what this denoiser makes of a crop depends on the other crops, nothing can be kept");
}

}  // namespace detail

/// The motions of stmc.generate(timelines, rng, options), and a record of the run. Throws as it does, config_error 102
/// where crops depend on each other (BatchMates).
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> generate_recorded(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                                            const Philox& rng, const StmcOptions& options, StmcRecord<B>& record) {
  StmcRecord<B> made{.timelines = {timelines.begin(), timelines.end()}, .rng = rng, .options = options};
  made.options.progress = {};
  const auto note = [&](const Collage<B, D>& collage, const auto& whole, const Tensor<B, 2>& x, Index t) {
    detail::require_own_results(collage);
    made.rows = collage.stride();
    made.x0.push_back(whole(collage, x, t));
    return made.x0.back();
  };
  const auto noise = [&](Index draw, const Shape& shape) { return stmc.noise(rng, draw, shape); };
  auto motions = stmc.generate_from(timelines, noise, options, note);
  record = std::move(made);
  return motions;
}

/// The motions of other timelines with seed and options of the record, made from the record as far as possible; the
/// record then is that of this run. Throws as generate does, config_error 102 if the record has another number of
/// steps.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> regenerate(const Stmc<B, D, E>& stmc, StmcRecord<B>& record,
                                     std::span<const Timeline> timelines, const RegenerateOptions& how = {},
                                     StmcReuse* reuse = nullptr) {
  StmcOptions options = record.options;
  options.progress = how.progress;
  const auto steps = stmc.process(options.steps).steps();
  if (std::ssize(record.x0) != steps)
    raise<config_error>(102, "regenerate: the record has ", record.x0.size(), " steps, a run of this model ", steps);
  const DenoiserTraits traits = stmc.denoiser.traits();
  const Index reads = traits.uses_lengths ? 0 : traits.crop_frames;
  std::optional<detail::Regeneration<B, D>> run;
  const auto estimate = [&](const Collage<B, D>& collage, const auto& whole, const Tensor<B, 2>& x, Index t) {
    if (!run) {
      detail::require_own_results(collage);
      const BatchPlan before = plan_timelines(record.timelines, stmc.plan_options(options));
      run.emplace(record, EditSpread(before, record.rows, collage.plan(), collage.stride(), reads, how.within),
                  collage);
    }
    return (*run)(collage, whole, x, t);
  };
  Index rows = 0;
  const auto noise = [&](Index draw, const Shape& shape) {
    return rows = shape[1], stmc.noise(record.rng, draw, shape);
  };
  auto motions = stmc.generate_from(timelines, noise, options, estimate);
  const StmcReuse found = run->reuse();
  if (reuse != nullptr) *reuse = found;
  options.progress = {};
  record = {{timelines.begin(), timelines.end()}, record.rng, options, rows, std::move(*run).x0(), found.exact};
  return motions;
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_STMC_FILE_HPP  // <motionlang/weights/stmc_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_STMC_FILE_HPP
/// An STMC model in one safetensors file: weights under their names, sizes and vocabulary in the metadata.
///
/// Metadata    model = "stmc", format = "1", denoiser.*, text.*, diffusion.*, features, fps; how the model should be
///             sampled: guidance and sampling ("ddpm 20": sampler and steps, all without a number); and, for people:
///             license, provenance, data, command, commit. Nothing in the file is executed.

#ifndef MOTIONLANG_HAS_WEIGHTS_MODULE_FILE_HPP  // <motionlang/weights/module_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_MODULE_FILE_HPP
/// Parameters of modules in files of weights: paths of fields are the names of tensors.
///
///     save_module("model.safetensors", model);
///     load_module(model, "model.safetensors");                          // into a model of the same sizes
///     load_module(model, open_weights("logs/last.ckpt"), "denoiser.");   // any TensorSet (weights/weight_file.hpp)

#include <set>        // names

#ifndef MOTIONLANG_HAS_FILE_KEY_REPORT_HPP  // <motionlang/file/key_report.hpp>
#define MOTIONLANG_HAS_FILE_KEY_REPORT_HPP
/// Names of tensors that do not match between a file and a model, as one list that a person can act on.

MOTIONLANG_NAMESPACE_BEGIN

/// Names that a file lacks, and names that nobody asked for.
struct KeyReport {
  std::vector<std::string> missing, unexpected;
};

/// How many characters have to be inserted, removed or exchanged to make b of a (Levenshtein), or `limit` if it is that
/// many.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit);

/// The name that is most like `name`; empty if none has half of it. Of a long list only the first 2,000 names are
/// looked at.
std::string nearest_name(std::string_view name, const std::vector<std::string>& among);

/// A line for each name, and beside it the name of the other list that is most like it.
std::string to_string(const KeyReport& report);

namespace detail {

[[noreturn]] void raise_key_mismatch(std::string_view file, const KeyReport& report);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_KEY_REPORT_IPP  // <motionlang/file/key_report.ipp>
#define MOTIONLANG_HAS_FILE_KEY_REPORT_IPP
// Bodies of key_report.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) >= limit) return limit;
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t k = 0; k < row.size(); ++k) row[k] = k;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t exchanged = diagonal + (a[i] == b[k] ? 0 : 1);
      diagonal = row[k + 1];
      row[k + 1] = std::min(exchanged, std::min(diagonal, row[k]) + 1);
    }
  }
  return std::min(row.back(), limit);
}

MOTIONLANG_BODY std::string nearest_name(std::string_view name, const std::vector<std::string>& among) {
  constexpr std::size_t longest = 256;
  std::string_view best;
  std::size_t distance = std::min(name.size(), longest) / 2 + 1;
  for (const std::string& candidate : std::span(among).first(std::min<std::size_t>(among.size(), 2000))) {
    if (name.size() > longest || candidate.size() > longest) continue;
    const std::size_t d = edit_distance(name, candidate, distance);
    if (d < distance) distance = d, best = candidate;
  }
  return std::string(best);
}

MOTIONLANG_BODY std::string to_string(const KeyReport& report) {
  constexpr std::size_t most = 20;  // lines of a list
  std::string text;
  const auto list = [&](const char* what, const std::vector<std::string>& names, const std::vector<std::string>& others,
                        const char* has) {
    for (std::size_t i = 0; i < names.size() && i < most; ++i) {
      const std::string like = nearest_name(names[i], others);
      text += concat_text("\n  ", what, " ", names[i]);
      if (!like.empty()) text += concat_text("  (", has, " ", like, ")");
    }
    if (names.size() > most) text += concat_text("\n  ", what, " ", names.size() - most, " more");
  };
  list("missing   ", report.missing, report.unexpected, "the file has");
  list("unexpected", report.unexpected, report.missing, "the model has");
  return text;
}

namespace detail {

MOTIONLANG_BODY void raise_key_mismatch(std::string_view file, const KeyReport& report) {
  raise<io_error>(406, file, ": ", counted(report.missing.size(), "tensor is missing", "tensors are missing"), ", ",
                  counted(report.unexpected.size(), "is", "are"), " not expected:", report);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_SAFETENSORS_HPP  // <motionlang/file/safetensors.hpp>
#define MOTIONLANG_HAS_FILE_SAFETENSORS_HPP
/// safetensors files: reading without a copy, writing. Includes no JSON library (see detail/json_cursor.hpp).
///
///     const auto file = SafetensorsFile::open("weights.safetensors");
///     for (const TensorView& t : file.tensors()) use(t);              // sorted by name
///     std::vector<float> bias = values_of<float>(file.tensor("head.bias"));
///
/// Layout   8 bytes: length N of the header; N bytes: JSON, name -> {dtype, shape, data_offsets}, "__metadata__" -> map
///          of strings; the rest: data, without holes
/// Checked  everything, before any tensor is handed out: lengths, strict JSON, UTF-8, no name
///          twice, products without overflow, ranges that tile the data exactly. Memory stays below a small multiple of
///          the header, and nothing is allocated for what a file merely claims.
/// Caution  a file that another process shortens while it is mapped ends the program (SIGBUS); write_file never does so

#ifndef MOTIONLANG_HAS_FILE_FILE_HPP  // <motionlang/file/file.hpp>
#define MOTIONLANG_HAS_FILE_FILE_HPP
/// Whole files: read, map into memory, and write so that a reader never sees half of one.

MOTIONLANG_NAMESPACE_BEGIN

/// A file mapped into memory for reading. Pages are loaded when they are touched (on Windows, all when it is opened).
class MappedFile {
 public:
  /// Throws io_error 401, also for a pointer of Git LFS, which stands in a repository for a file that was not fetched.
  static std::shared_ptr<const MappedFile> open(const FilePath& path);
  /// These bytes in a file without a name, which is gone with the mapping: memory that can be given back and read
  /// again. Null if there is no place for it.
  static std::shared_ptr<const MappedFile> put_aside(std::span<const std::byte> bytes);
  /// The one in which these bytes lie, or nothing. It lasts as long as whoever keeps the bytes.
  static const MappedFile* that_holds(std::span<const std::byte> bytes);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }
  /// Gives the memory of a part back that will hardly be read again: whoever reads it gets it from the file once more.
  /// The system maps up to two megabytes around a byte that is read, so it takes whole ones.
  void forget(std::span<const std::byte> part) const;
  /// The same of bytes that lie in a mapped file or elsewhere.
  static void forget_if_mapped(std::span<const std::byte> part);

 private:
  explicit MappedFile(const FilePath& path);
  MappedFile() = default;
  bool map(int fd, std::size_t size);
  static std::uintptr_t address(std::span<const std::byte> bytes);

  void* data_ = nullptr;
  std::size_t size_ = 0;
  MappedFile* next_ = nullptr;  // of all that are mapped
};

/// Throws io_error 401 if the bytes of a file are a pointer of Git LFS.
/// Source  the specification of Git LFS, "The Pointer"
void refuse_lfs_pointer(std::span<const std::byte> bytes, std::string_view name);

/// The whole file as text. Throws io_error 401, also for a pointer of Git LFS.
std::string read_file(const FilePath& path);

/// Writes to a temporary name beside `path` and renames: the old file stays whole until the new one is, which has its
/// permissions. Of a symbolic link, the file that it leads to is written. Throws io_error 401, also for devices and
/// pipes.
void write_file(const FilePath& path, std::span<const std::byte> contents);
void write_file(const FilePath& path, std::string_view contents);

/// Makes the folder unless it is there. Its parent has to be. Throws io_error 401.
void make_folder(const FilePath& path);

/// A name as a part of a file's name: characters that some system does not allow there become "_".
std::string safe_file_name(std::string name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_FILE_IPP  // <motionlang/file/file.ipp>
#define MOTIONLANG_HAS_FILE_FILE_IPP
// Bodies of file.hpp.

#include <cerrno>      // errno
#include <filesystem>  // symbolic links

#ifndef MOTIONLANG_HAS_FILE_DETAIL_SYSTEM_FILE_HPP  // <motionlang/file/detail/system_file.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_SYSTEM_FILE_HPP
/// File calls of the system: POSIX, and on Windows those of MinGW's C library. errno says why a call
/// failed.

#include <fcntl.h>     // open
#include <sys/stat.h>  // fstat, fchmod, mkdir
#include <unistd.h>    // read, write, close, getpid
#if defined(_WIN32)
#include <io.h>      // _commit
#include <malloc.h>  // _aligned_malloc

#else
#include <sys/mman.h>  // mmap
#endif

#if defined(_WIN32)
// As windows.h declares it, which would bring macros named min, max, near and far.
extern "C" __declspec(dllimport) int __stdcall MoveFileExA(const char* from, const char* to, unsigned long flags);
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail::system {

/// An open file of a new name where temporary files go, for this user only; -1 if there is no place for it.
inline int create_temporary(std::string& name) {
  std::error_code problem;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(problem);
  name = problem ? "a temporary file" : (folder / "motionlang-XXXXXX").string();
  if (problem) return errno = problem.default_error_condition().value(), -1;
  return ::mkstemp(name.data());
}

#if defined(_WIN32)

inline int open_to_read(const char* path) { return ::open(path, O_RDONLY | O_BINARY | O_NOINHERIT); }
/// A file that is not there yet, else errno is EEXIST.
inline int create(const char* path) { return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_BINARY | O_NOINHERIT, 0666); }
/// An open file that has no name any more. Windows knows none.
inline int create_nameless() { return -1; }
inline bool is_regular(int file, std::uint64_t& size) {
  struct _stat64 s {};
  if (::_fstat64(file, &s) != 0 || !S_ISREG(s.st_mode)) return false;
  size = static_cast<std::uint64_t>(s.st_size);
  return true;
}
inline void copy_permissions(const char*, int) {}  // of a folder, for all in it
inline bool flush(int file) { return ::_commit(file) == 0; }
inline void unmap(void* data, std::size_t) { ::_aligned_free(data); }
/// The whole file, for reading; null if that fails. size > 0. A copy: nobody could write a file anew that is mapped,
/// such as the checkpoint from which a training goes on.
inline void* map(int file, std::size_t size) {
  auto* const data = static_cast<char*>(::_aligned_malloc(size, 64));
  if (data == nullptr) return errno = ENOMEM, nullptr;
  for (std::size_t done = 0; done < size;) {
    const int n = ::read(file, data + done, static_cast<unsigned>(std::min<std::size_t>(size - done, 1u << 30)));
    if (n <= 0) {
      if (n == 0) errno = EIO;  // it has become shorter
      return unmap(data, size), nullptr;
    }
    done += static_cast<std::size_t>(n);
  }
  return data;
}
inline void forget(void*, std::size_t) {}  // there is no other copy
inline bool rename_over(const char* from, const char* to) {
  constexpr unsigned long replace = 1;
  if (::MoveFileExA(from, to, replace) != 0) return true;
  errno = EACCES;  // it is open
  return false;
}
inline bool make_folder(const char* path) { return ::mkdir(path) == 0; }

#else

inline int open_to_read(const char* path) { return ::open(path, O_RDONLY | O_CLOEXEC); }
/// A file that is not there yet, else errno is EEXIST.
inline int create(const char* path) { return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); }
/// An open file that has no name any more; -1 if there is no place for it.
inline int create_nameless() {
  std::string name;
  const int file = create_temporary(name);
  if (file >= 0) ::unlink(name.c_str());
  return file;
}
inline bool is_regular(int file, std::uint64_t& size) {
  struct stat s {};
  if (::fstat(file, &s) != 0 || !S_ISREG(s.st_mode)) return false;
  size = static_cast<std::uint64_t>(s.st_size);
  return true;
}
/// Who may read and write an open file as another one, if that is there. Not every file system knows such permissions.
inline void copy_permissions(const char* from, int to) {
  struct stat s {};
  if (::stat(from, &s) == 0) static_cast<void>(::fchmod(to, s.st_mode & 0777));
}
inline bool flush(int file) { return ::fsync(file) == 0; }
/// The whole file, for reading; null if that fails. size > 0.
inline void* map(int file, std::size_t size) {
  void* const data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  return data == MAP_FAILED ? nullptr : data;
}
inline void unmap(void* data, std::size_t size) { ::munmap(data, size); }
/// Gives memory of a mapping back: whoever reads it gets it from the file once more.
inline void forget(void* data, std::size_t size) { ::madvise(data, size, MADV_DONTNEED); }
inline bool rename_over(const char* from, const char* to) { return std::rename(from, to) == 0; }
inline bool make_folder(const char* path) { return ::mkdir(path, 0777) == 0; }

#endif

inline bool is_folder(const char* path) {
  struct stat s {};
  return ::stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

}  // namespace detail::system
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::mutex mapped_mutex;
inline MappedFile* first_mapped = nullptr;  // all that are mapped

/// A file descriptor that is closed at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  /// To read. Throws io_error 401.
  explicit Descriptor(const FilePath& path) : fd_(system::open_to_read(path.c_str())) {
    if (fd_ < 0) raise<io_error>(401, "cannot open ", path.string(), ": ", std::strerror(errno));
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  /// True if all bytes could be written; errno says why not.
  bool write(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const auto n = ::write(fd_, bytes.data(), static_cast<unsigned>(std::min<std::size_t>(bytes.size(), 1u << 30)));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
    return true;
  }
  std::size_t size(const FilePath& path) const {
    std::uint64_t size = 0;
    if (!system::is_regular(fd_, size)) raise<io_error>(401, path.string(), " is not a regular file");
    return static_cast<std::size_t>(size);
  }

 private:
  int fd_;
};

}  // namespace detail

MOTIONLANG_BODY std::shared_ptr<const MappedFile> MappedFile::open(const FilePath& path) {
  auto file = std::shared_ptr<const MappedFile>(new MappedFile(path));
  refuse_lfs_pointer(file->bytes(), path.string());
  return file;
}

MOTIONLANG_BODY void refuse_lfs_pointer(std::span<const std::byte> bytes, std::string_view name) {
  constexpr std::size_t longest = 1024;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), longest));
  if (bytes.size() >= longest || !text.starts_with("version https://git-lfs.github.com/spec/")) return;
  const std::size_t size = text.find("\nsize ");
  const std::string_view number = size == text.npos ? "?" : text.substr(size + 6, text.find('\n', size + 6) - size - 6);
  raise<io_error>(401, name, " is not the file but a Git LFS pointer to it (", number,
                  " bytes): 'git lfs pull' in its repository fetches the file");
}

MOTIONLANG_BODY std::shared_ptr<const MappedFile> MappedFile::put_aside(std::span<const std::byte> bytes) {
  const detail::Descriptor file(bytes.empty() ? -1 : detail::system::create_nameless());
  if (file.get() < 0 || !file.write(bytes)) return nullptr;
  auto out = std::shared_ptr<MappedFile>(new MappedFile);
  return out->map(file.get(), bytes.size()) ? out : nullptr;
}

MOTIONLANG_BODY const MappedFile* MappedFile::that_holds(std::span<const std::byte> bytes) {
  const std::scoped_lock lock(detail::mapped_mutex);
  const MappedFile* f = detail::first_mapped;
  while (f != nullptr && (address(bytes) < address(f->bytes()) ||
                          address(bytes) + bytes.size() > address(f->bytes()) + f->bytes().size()))
    f = f->next_;
  return f;
}

MOTIONLANG_BODY MappedFile::~MappedFile() {
  if (size_ == 0) return;
  {
    const std::scoped_lock lock(detail::mapped_mutex);
    MappedFile** place = &detail::first_mapped;
    while (*place != this) place = &(*place)->next_;
    *place = next_;
  }
  detail::system::unmap(data_, size_);
}

MOTIONLANG_BODY void MappedFile::forget(std::span<const std::byte> part) const {
  constexpr std::uintptr_t block = std::uintptr_t{2} << 20;
  const std::uintptr_t begin = std::max(address(part) / block * block, address(bytes())),
                       end = std::min((address(part) + part.size() + block - 1) / block * block,
                                      address(bytes()) + size_);
  if (begin < end) detail::system::forget(static_cast<std::byte*>(data_) + (begin - address(bytes())), end - begin);
}

MOTIONLANG_BODY void MappedFile::forget_if_mapped(std::span<const std::byte> part) {
  if (const MappedFile* file = that_holds(part)) file->forget(part);
}

MOTIONLANG_BODY MappedFile::MappedFile(const FilePath& path) {
  const detail::Descriptor file(path);
  const std::size_t size = file.size(path);
  if (size > 0 && !map(file.get(), size))  // an empty mapping is an error of mmap
    raise<io_error>(401, "cannot map ", path.string(), ": ", std::strerror(errno));
}

MOTIONLANG_BODY bool MappedFile::map(int fd, std::size_t size) {
  void* const data = detail::system::map(fd, size);
  if (data == nullptr) return false;
  data_ = data, size_ = size;
  const std::scoped_lock lock(detail::mapped_mutex);
  next_ = std::exchange(detail::first_mapped, this);
  return true;
}

MOTIONLANG_BODY std::uintptr_t MappedFile::address(std::span<const std::byte> bytes) {
  return reinterpret_cast<std::uintptr_t>(bytes.data());
}

MOTIONLANG_BODY std::string read_file(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return std::string(reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size());
}

MOTIONLANG_BODY void write_file(const FilePath& path, std::span<const std::byte> contents) {
  static std::atomic<unsigned> writers{0};
  std::error_code problem;
  std::filesystem::path followed = path.string();
  constexpr int most_links = 40;                                                  // as Linux follows
  for (int links = 0; std::filesystem::is_symlink(followed, problem); ++links) {  // the last may lead to no file yet
    if (links == most_links) raise<io_error>(401, "cannot write ", path.string(), ": more than ", most_links, " links");
    followed = followed.parent_path() / std::filesystem::read_symlink(followed, problem);
  }
  if (std::filesystem::is_other(std::filesystem::status(followed, problem)))
    raise<io_error>(401, "cannot write ", path.string(),
                    ": it is not a file but a device or a pipe, which a file would replace");
  const std::string target = followed.string();
  std::string temporary;
  int opened = -1;
  do {  // a name that no other thread and no other machine has
    temporary = (followed.parent_path() / concat_text(".part-", ::getpid(), "-", writers++)).string();
    opened = detail::system::create(temporary.c_str());
  } while (opened < 0 && errno == EEXIST);
  int reason = 0;
  auto failed = [&](const char* what) {
    if (opened >= 0) std::remove(temporary.c_str());
    raise<io_error>(401, "cannot ", what, " ", path.string(), ": ", std::strerror(reason));
  };
  const char* wrong = nullptr;
  {
    const detail::Descriptor file(opened);
    if (file.get() >= 0) detail::system::copy_permissions(target.c_str(), file.get());
    if (file.get() < 0 || !file.write(contents))
      wrong = "write";
    else if (!detail::system::flush(file.get()))
      wrong = "flush";
    reason = errno;
  }
  if (wrong != nullptr) failed(wrong);
  if (detail::system::rename_over(temporary.c_str(), target.c_str())) return;
  reason = errno;
  failed("rename to");
}

MOTIONLANG_BODY void write_file(const FilePath& path, std::string_view contents) {
  write_file(path, std::as_bytes(std::span(contents.data(), contents.size())));
}

MOTIONLANG_BODY void make_folder(const FilePath& path) {
  if (detail::system::make_folder(path.c_str()) || detail::system::is_folder(path.c_str())) return;
  raise<io_error>(401, "cannot make the folder ", path.string());
}

MOTIONLANG_BODY std::string safe_file_name(std::string name) {
  for (char& c : name) {
    const bool odd =
        static_cast<unsigned char>(c) < ' ' || std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos;
    if (odd) c = '_';
  }
  return name;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_TENSOR_SET_HPP  // <motionlang/file/tensor_set.hpp>
#define MOTIONLANG_HAS_FILE_TENSOR_SET_HPP
/// Named tensors of a file: what every reader of weights gives, and what modules are filled from.

#ifndef MOTIONLANG_HAS_FILE_TENSOR_VIEW_HPP  // <motionlang/file/tensor_view.hpp>
#define MOTIONLANG_HAS_FILE_TENSOR_VIEW_HPP
/// A tensor as a file holds it: name, element type, shape, bytes. Every reader of arrays yields these and every writer
/// takes them; nothing is converted until somebody asks for values.

#ifndef MOTIONLANG_HAS_CORE_HALF_HPP  // <motionlang/core/half.hpp>
#define MOTIONLANG_HAS_CORE_HALF_HPP
/// The two 16-bit floating-point formats in which weights are stored: IEEE half (F16) and bfloat16 (BF16). Conversions
/// only; nothing is calculated in them.

MOTIONLANG_NAMESPACE_BEGIN

/// Value of a half: 1 sign, 5 exponent, 10 fraction bits. Exact, subnormals and NaN payloads included.
constexpr float half_to_float(std::uint16_t h) {
  const std::uint32_t sign = std::uint32_t{h & 0x8000u} << 16, exponent = h >> 10 & 31u, fraction = h & 1023u;
  if (exponent == 0) {  // zero and subnormals: fraction * 2^-24
    return detail::bit_cast<float>(detail::bit_cast<std::uint32_t>(static_cast<float>(fraction) * 0x1p-24f) | sign);
  }
  const std::uint32_t wide = exponent == 31 ? 255 : exponent + (127 - 15);
  return detail::bit_cast<float>(sign | wide << 23 | fraction << 13);
}

/// Nearest half, ties to even; too large becomes infinity.
constexpr std::uint16_t float_to_half(float f) {
  const auto bits = detail::bit_cast<std::uint32_t>(f);
  const std::uint32_t sign = bits >> 16 & 0x8000u, size = bits & 0x7FFFFFFFu;
  if (size > 0x7F800000u) return static_cast<std::uint16_t>(sign | 0x7E00u | (size >> 13 & 0x3FFu));  // quiet NaN
  if (size >= 0x477FF000u) return static_cast<std::uint16_t>(sign | 0x7C00u);  // 65520 and above: infinity
  if (size < 0x38800000u) {  // below 2^-14: adding 0.5 leaves multiples of 2^-24, rounded to even, in the low bits
    const float sum = detail::bit_cast<float>(size) + 0.5f;
    return static_cast<std::uint16_t>(sign | (detail::bit_cast<std::uint32_t>(sum) - 0x3F000000u));
  }
  const std::uint32_t rounded = size + 0xFFFu + (size >> 13 & 1u) - 0x38000000u;
  return static_cast<std::uint16_t>(sign | rounded >> 13);
}

/// Value of a bfloat16: the upper half of a float.
constexpr float bfloat16_to_float(std::uint16_t b) { return detail::bit_cast<float>(std::uint32_t{b} << 16); }

/// Nearest bfloat16, ties to even.
constexpr std::uint16_t float_to_bfloat16(float f) {
  const auto bits = detail::bit_cast<std::uint32_t>(f);
  if ((bits & 0x7FFFFFFFu) > 0x7F800000u) return static_cast<std::uint16_t>(bits >> 16 | 0x40u);  // quiet NaN
  return static_cast<std::uint16_t>((bits + 0x7FFFu + (bits >> 16 & 1u)) >> 16);
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

// clang-format off
/// Element types of safetensors files. Values of those up to F64 can be read; of the others only the size is known.
enum class DType : std::uint8_t {
  BOOL, U8, I8, U16, I16, U32, I32, U64, I64, F16, BF16, F32, F64,
  F8_E5M2, F8_E4M3, F8_E8M0, F8_E4M3FNUZ, F8_E5M2FNUZ, F4, F6_E2M3, F6_E3M2, C64
};

struct DTypeInfo {
  std::string_view name;
  int bits;
};
inline constexpr std::array<DTypeInfo, 22> dtype_table{{
    {"BOOL", 8}, {"U8", 8}, {"I8", 8}, {"U16", 16}, {"I16", 16}, {"U32", 32}, {"I32", 32}, {"U64", 64}, {"I64", 64},
    {"F16", 16}, {"BF16", 16}, {"F32", 32}, {"F64", 64},
    {"F8_E5M2", 8}, {"F8_E4M3", 8}, {"F8_E8M0", 8}, {"F8_E4M3FNUZ", 8}, {"F8_E5M2FNUZ", 8},
    {"F4", 4}, {"F6_E2M3", 6}, {"F6_E3M2", 6}, {"C64", 64}}};
// clang-format on

constexpr const DTypeInfo& info(DType t) { return dtype_table[static_cast<std::size_t>(t)]; }
std::string to_string(DType t);
constexpr std::optional<DType> parse_dtype(std::string_view name) {
  for (std::size_t i = 0; i < dtype_table.size(); ++i) {
    if (dtype_table[i].name == name) return static_cast<DType>(i);
  }
  return std::nullopt;
}
/// True if values of this type are whole numbers.
constexpr bool is_integer(DType t) { return t <= DType::I64; }

/// The element type that holds a C++ number.
template <class T>
requires std::integral<T> || std::floating_point<T>
consteval DType dtype_of() {
  if constexpr (std::same_as<T, bool>) return DType::BOOL;
  if constexpr (std::floating_point<T>) return sizeof(T) == 4 ? DType::F32 : DType::F64;
  constexpr std::array table{DType::U8, DType::U16, DType::U32, DType::U64};
  constexpr auto size = static_cast<unsigned>(std::bit_width(sizeof(T)) - 1);
  return static_cast<DType>(static_cast<unsigned>(table[size]) + (std::signed_integral<T> ? 1u : 0u));
}

/// Sizes of an array in a file, slowest axis first: as many as NumPy and PyTorch allow. A Shape, of what is calculated
/// with, has six at most.
class FileShape {
 public:
  static constexpr int max_rank = 64;

  FileShape() = default;
  FileShape(const Shape& shape);
  FileShape(std::initializer_list<Index> sizes) : FileShape(std::span<const Index>(sizes.begin(), sizes.size())) {}
  explicit FileShape(std::span<const Index> sizes);
  /// Throws shape_error 206 for more than six.
  operator Shape() const { return Shape(std::span<const Index>(sizes_)); }

  int rank() const { return static_cast<int>(sizes_.size()); }
  Index operator[](int axis) const { return sizes_[static_cast<std::size_t>(axis)]; }
  Index& operator[](int axis) { return sizes_[static_cast<std::size_t>(axis)]; }
  std::span<const Index> sizes() const { return sizes_; }
  /// Number of elements.
  Index count() const;
  /// Throws shape_error 205 for a negative size, 206 for more than 64 of them.
  void push_back(Index n);
  friend bool operator==(const FileShape&, const FileShape&) = default;
  friend bool operator==(const FileShape& a, const Shape& b) { return a == FileShape(b); }

 private:
  std::vector<Index> sizes_;
};

/// "(2, 60, 512)"
std::string to_string(const FileShape& s);

/// Row-major, without strides. Does not own its bytes.
struct TensorView {
  std::string name;
  DType dtype = DType::F32;
  FileShape shape;
  std::span<const std::byte> bytes;
};

/// A view of numbers in memory, for writing.
template <class T>
TensorView tensor_view(std::string name, const FileShape& shape, std::span<const T> values) {
  if (static_cast<std::size_t>(shape.count()) != values.size()) {
    raise<shape_error>(205, "tensor_view: ", counted(values.size(), "value"), " for '", name, "' of shape ", shape);
  }
  return {std::move(name), dtype_of<T>(), shape, std::as_bytes(values)};
}

/// The numbers themselves, without a copy: if the view holds Ts and they are aligned.
template <class T>
std::optional<std::span<const T>> direct(const TensorView& view) {
  if (view.dtype != dtype_of<T>() || reinterpret_cast<std::uintptr_t>(view.bytes.data()) % alignof(T) != 0) {
    return std::nullopt;
  }
  return std::span(reinterpret_cast<const T*>(view.bytes.data()), view.bytes.size() / sizeof(T));
}

namespace detail {

template <class Stored, class T, class Decode>
void convert(const TensorView& view, std::span<T> out, Decode decode) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    Stored s;
    std::memcpy(&s, view.bytes.data() + i * sizeof(Stored), sizeof(Stored));
    out[i] = decode(s);
  }
}

template <class Stored, class T>
void convert_numbers(const TensorView& view, std::span<T> out) {
  convert<Stored>(view, out, [&](Stored s) {
    if constexpr (std::integral<Stored> && std::integral<T>) {
      if (!std::in_range<T>(s)) {
        raise<io_error>(407, "tensor '", view.name, "': ", s, " does not fit the integer that is asked for");
      }
    }
    return static_cast<T>(s);
  });
}

}  // namespace detail

/// Copies all values, converted to T. Numbers of every kind become float or double; only whole numbers become integers.
/// Throws shape_error 205 if the sizes differ, io_error 404 for an element type that cannot be read, 407 if the values
/// are not of the kind of T or do not fit.
template <class T>
void copy_values(const TensorView& view, std::span<T> out) {
  if (view.bytes.size() * 8 != out.size() * static_cast<std::size_t>(info(view.dtype).bits)) {
    raise<shape_error>(205, "tensor '", view.name, "' of shape ", view.shape, " does not have ",
                       counted(out.size(), "value"));
  }
  if constexpr (std::integral<T>) {
    if (!is_integer(view.dtype)) {
      raise<io_error>(407, "tensor '", view.name, "' holds ", view.dtype, ", not whole numbers");
    }
  }
  switch (view.dtype) {
    case DType::BOOL:
      return detail::convert<std::uint8_t>(view, out, [](std::uint8_t b) { return static_cast<T>(b != 0); });
    case DType::U8:
      return detail::convert_numbers<std::uint8_t>(view, out);
    case DType::I8:
      return detail::convert_numbers<std::int8_t>(view, out);
    case DType::U16:
      return detail::convert_numbers<std::uint16_t>(view, out);
    case DType::I16:
      return detail::convert_numbers<std::int16_t>(view, out);
    case DType::U32:
      return detail::convert_numbers<std::uint32_t>(view, out);
    case DType::I32:
      return detail::convert_numbers<std::int32_t>(view, out);
    case DType::U64:
      return detail::convert_numbers<std::uint64_t>(view, out);
    case DType::I64:
      return detail::convert_numbers<std::int64_t>(view, out);
    case DType::F16:
      return detail::convert<std::uint16_t>(view, out, [](auto h) { return static_cast<T>(half_to_float(h)); });
    case DType::BF16:
      return detail::convert<std::uint16_t>(view, out, [](auto b) { return static_cast<T>(bfloat16_to_float(b)); });
    case DType::F32:
      return detail::convert_numbers<float>(view, out);
    case DType::F64:
      return detail::convert_numbers<double>(view, out);
    default:
      raise<io_error>(404, "tensor '", view.name, "': elements of type ", view.dtype, " are not supported");
  }
}

template <class T>
std::vector<T> values_of(const TensorView& view) {
  std::vector<T> out(static_cast<std::size_t>(view.shape.count()));
  copy_values(view, std::span<T>(out));
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_TENSOR_VIEW_IPP  // <motionlang/file/tensor_view.ipp>
#define MOTIONLANG_HAS_FILE_TENSOR_VIEW_IPP
// Bodies of tensor_view.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string to_string(DType t) { return std::string(info(t).name); }

MOTIONLANG_BODY FileShape::FileShape(const Shape& shape) {
  for (int i = 0; i < shape.rank(); ++i) push_back(shape[i]);
}

MOTIONLANG_BODY FileShape::FileShape(std::span<const Index> sizes) {
  for (const Index n : sizes) push_back(n);
}

MOTIONLANG_BODY Index FileShape::count() const {
  // beside a 0 the others may be of any size
  if (std::find(sizes_.begin(), sizes_.end(), 0) != sizes_.end()) return 0;
  Index n = 1;
  for (const Index size : sizes_) n *= size;
  return n;
}

MOTIONLANG_BODY void FileShape::push_back(Index n) {
  if (n < 0) raise<shape_error>(205, "FileShape: negative size ", n);
  if (rank() == max_rank) raise<shape_error>(206, "FileShape: more than ", max_rank, " axes");
  sizes_.push_back(n);
}

MOTIONLANG_BODY std::string to_string(const FileShape& s) { return detail::shape_text(s.sizes()); }

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

class TensorSet {
 public:
  /// The name of the file, for messages.
  const std::string& name() const { return name_; }
  /// Keeps the bytes of all tensors alive.
  const std::shared_ptr<const void>& owner() const { return owner_; }

  /// All tensors, sorted by name.
  std::span<const TensorView> tensors() const { return tensors_; }
  std::vector<std::string> names() const;
  /// Null if no tensor has that name.
  const TensorView* find(std::string_view tensor) const;
  /// Throws io_error 406, with the most similar name, if no tensor has that name.
  const TensorView& tensor(std::string_view tensor) const;

 protected:
  TensorSet(std::string name, std::shared_ptr<const void> owner) : name_(std::move(name)), owner_(std::move(owner)) {}

  std::string name_;
  std::shared_ptr<const void> owner_;
  std::vector<TensorView> tensors_;
};

/// A checksum of names, types, shapes and bytes of tensors, whatever their order: equal for equal weights, in
/// hexadecimal.
std::string tensors_checksum(std::span<const TensorView> tensors);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_TENSOR_SET_IPP  // <motionlang/file/tensor_set.ipp>
#define MOTIONLANG_HAS_FILE_TENSOR_SET_IPP
// Bodies of tensor_set.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> TensorSet::names() const {
  std::vector<std::string> out;
  for (const TensorView& t : tensors_) out.push_back(t.name);
  return out;
}

MOTIONLANG_BODY const TensorView* TensorSet::find(std::string_view tensor) const {
  const auto t = std::lower_bound(tensors_.begin(), tensors_.end(), tensor,
                                  [](const TensorView& a, std::string_view b) { return a.name < b; });
  return t != tensors_.end() && t->name == tensor ? &*t : nullptr;
}

MOTIONLANG_BODY const TensorView& TensorSet::tensor(std::string_view tensor) const {
  const TensorView* t = find(tensor);
  if (t != nullptr) return *t;
  const std::string like = nearest_name(tensor, names());
  raise<io_error>(406, name_, ": no tensor '", tensor, "' among ", tensors_.size(),
                  like.empty() ? "" : concat_text("; the file has '", like, "'"));
}

MOTIONLANG_BODY std::string tensors_checksum(std::span<const TensorView> tensors) {
  std::vector<const TensorView*> sorted;
  for (const TensorView& t : tensors) sorted.push_back(&t);
  std::sort(sorted.begin(), sorted.end(), [](const TensorView* a, const TensorView* b) { return a->name < b->name; });
  std::uint64_t hash = 1;
  for (const TensorView* t : sorted) {
    const std::string about = concat_text(t->name, " ", t->dtype, " ", t->shape);
    hash = detail::content_hash(t->bytes, detail::content_hash(std::as_bytes(std::span(about)), hash));
  }
  return detail::hexadecimal(hash);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
class JsonCursor;
}

class SafetensorsFile : public TensorSet {
 public:
  /// Longest header that is read, as in the reference implementation.
  static constexpr std::uint64_t max_header = 100'000'000;

  /// Maps a file. Throws io_error 401 (cannot be opened), 402 (ends too early), 403 (malformed), 404 (more than 64
  /// axes), 405 (impossible sizes).
  static SafetensorsFile open(const FilePath& path);
  /// A file in memory. `owner` keeps the bytes alive; without one they have to outlive the object. `name` stands in
  /// messages.
  static SafetensorsFile from_bytes(std::span<const std::byte> bytes, std::string name = "safetensors data",
                                    std::shared_ptr<const void> owner = {});

  const std::map<std::string, std::string>& metadata() const { return metadata_; }

 private:
  using Cursor = detail::JsonCursor;
  static constexpr std::size_t prefix = 8;  // bytes of the header length

  struct Range {
    std::uint64_t begin, end;
    std::size_t declared_at;  // in the header, for messages
  };

  SafetensorsFile(std::span<const std::byte> bytes, std::string name, std::shared_ptr<const void> owner);

  void read_metadata(Cursor& json);

  Range read_entry(Cursor& json, const std::string& name, std::span<const std::byte> data);

  static DType read_dtype(Cursor& json);

  static FileShape read_shape(Cursor& json);

  /// The range has exactly the bytes that shape and type need; the product of the sizes does not overflow, not even of
  /// those that are not 0.
  static void check_size(const Cursor& json, const TensorView& view, const Range& range);

  /// The ranges follow each other without overlap or hole and end where the data end.
  static void check_tiling(const Cursor& json, std::vector<Range>& ranges, std::uint64_t size);

  std::map<std::string, std::string> metadata_;
};

/// The bytes of a file: tensors by element size, largest first, then by name; the data begin at a multiple of 8, so
/// every element is aligned. What is written is read back before it is returned: a name twice, a size that does not fit
/// the shape, or text that is not UTF-8 throws the io_error of the reader.
std::vector<std::byte> safetensors_bytes(std::span<const TensorView> tensors,
                                         const std::map<std::string, std::string>& metadata = {{"format", "pt"}});

/// Writes a file in one step: readers see the old one or the new one. Throws io_error 401, and what safetensors_bytes
/// throws. The metadata {"format": "pt"} let Python tools accept the file.
void write_safetensors(const FilePath& path, std::span<const TensorView> tensors,
                       const std::map<std::string, std::string>& metadata = {{"format", "pt"}});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_SAFETENSORS_IPP  // <motionlang/file/safetensors.ipp>
#define MOTIONLANG_HAS_FILE_SAFETENSORS_IPP
// Bodies of safetensors.hpp.

#ifndef MOTIONLANG_HAS_FILE_DETAIL_BYTES_HPP  // <motionlang/file/detail/bytes.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_BYTES_HPP
/// Little-endian numbers in byte buffers: checked reading, appending. And base64.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

static_assert(std::endian::native == std::endian::little, "the files are little-endian and are copied as they are");

template <class T>
concept Plain = std::is_trivially_copyable_v<T>;

/// The value stored at `at`. Throws io_error 402 if it does not lie inside; `what` and `file` are for the message.
template <Plain T>
T load(std::span<const std::byte> bytes, std::uint64_t at, std::string_view file, std::string_view what) {
  if (at > bytes.size() || bytes.size() - at < sizeof(T)) {
    raise<io_error>(402, file, ": ends inside ", what, " at byte ", at, " (", counted(bytes.size(), "byte"), ")");
  }
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// `size` bytes from `at`. Throws io_error 402 if they do not lie inside.
std::span<const std::byte> slice(std::span<const std::byte> bytes, std::uint64_t at, std::uint64_t size,
                                 std::string_view file, std::string_view what);

inline void append_bytes(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  const std::size_t size = out.size();
  out.resize(size + bytes.size());
  std::memcpy(out.data() + size, bytes.data(), bytes.size());  // vector::insert makes GCC 12 warn of overflow at -O3
}
inline void append_text(std::vector<std::byte>& out, std::string_view text) {
  append_bytes(out, std::as_bytes(std::span(text.data(), text.size())));
}
template <Plain T>
void append_value(std::vector<std::byte>& out, const T& value) {
  append_bytes(out, std::as_bytes(std::span(&value, 1)));
}

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Source  RFC 4648, section 4.
std::string to_base64(std::span<const std::byte> bytes);

/// White space is skipped. `name` stands in messages. Throws io_error 403 on any other character outside the alphabet.
std::vector<std::byte> from_base64(std::string_view text, std::string_view name = "text");

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_DETAIL_BYTES_IPP  // <motionlang/file/detail/bytes.ipp>
#define MOTIONLANG_HAS_FILE_DETAIL_BYTES_IPP
// Bodies of bytes.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::span<const std::byte> slice(std::span<const std::byte> bytes, std::uint64_t at, std::uint64_t size,
                                                 std::string_view file, std::string_view what) {
  if (at > bytes.size() || bytes.size() - at < size) {
    raise<io_error>(402, file, ": ", what, " needs ", counted(size, "byte"), " at byte ", at, ", the file has ",
                    bytes.size());
  }
  return bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
}

inline constexpr std::string_view base64_alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

MOTIONLANG_BODY std::string to_base64(std::span<const std::byte> bytes) {
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? base64_alphabet[group >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::byte> from_base64(std::string_view text, std::string_view name) {
  std::vector<std::byte> out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t group = 0;
  int bits = 0;
  for (std::size_t i = 0; i < text.size() && text[i] != '='; ++i) {
    if (text[i] == '\n' || text[i] == '\r' || text[i] == ' ') continue;
    const std::size_t digit = base64_alphabet.find(text[i]);
    if (digit == std::string_view::npos) raise<io_error>(403, name, ": character ", i, " is not of base64");
    group = (group << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFFFu;
    if ((bits += 6) >= 8) out.push_back(static_cast<std::byte>(group >> (bits -= 8) & 255u));
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_DETAIL_JSON_CURSOR_HPP  // <motionlang/file/detail/json_cursor.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_JSON_CURSOR_HPP
/// A strict reader for the small JSON subset of a safetensors header, which walks over the text and stores nothing but
/// keys. Documents in general are read by file/json.hpp.
///
/// nlohmann's SAX reader does the same work but costs every translation unit that opens a weight file 1.5 s of
/// compilation (GCC 12, -O0), this one 0.2 s. Stricter than JSON: no name twice in an object, nesting up to
/// `max_depth`.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

class JsonCursor {
 public:
  static constexpr int max_depth = 4;
  static constexpr std::size_t max_members = 100'000;  // of an object: what one needs in memory is many times its text

  /// `offset` is where the text begins in the file; it only serves messages.
  JsonCursor(std::string_view text, std::string_view file, std::size_t offset)
      : text_(text), file_(file), offset_(offset) {}

  /// Throws io_error with the file and the byte of position `at`.
  [[noreturn]] void fail(int id, std::size_t at, std::string_view what) const {
    raise<io_error>(id, file_, ": byte ", offset_ + at, ": ", what);
  }
  std::size_t position() const { return at_; }

  void skip_space() {
    while (at_ < text_.size() && (peek() == ' ' || peek() == '\n' || peek() == '\r' || peek() == '\t')) ++at_;
  }
  bool at_end() const { return at_ == text_.size(); }
  /// The next character, '\0' at the end.
  char peek() const { return at_end() ? '\0' : text_[at_]; }

  /// Takes white space and c, if it is there.
  bool accept(char c) {
    skip_space();
    if (at_end() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(403, at_, concat_text("expected '", c, at_end() ? "', but the header ends" : "'"));
  }

  /// An object: on_value(key) is called for every member and has to take its value.
  template <class F>
  void object(F on_value) {
    enter();
    expect('{');
    std::set<std::string> keys;
    if (!accept('}')) {
      do {
        const std::size_t start = at_;
        const auto [key, is_new] = keys.insert(string());
        if (keys.size() > max_members) fail(405, start, concat_text("more than ", max_members, " names in one object"));
        if (!is_new) fail(403, start, "the name '" + *key + "' is duplicated in one object");
        expect(':');
        on_value(*key);
      } while (accept(','));
      expect('}');
    }
    --depth_;
  }

  /// An array: on_value() is called for every element and has to take it.
  template <class F>
  void array(F on_value) {
    enter();
    expect('[');
    if (!accept(']')) {
      do on_value();
      while (accept(','));
      expect(']');
    }
    --depth_;
  }

  std::string string() {
    expect('"');
    std::string out;
    for (;;) {
      const std::size_t start = at_;
      if (at_end()) fail(403, at_, "a string has no end");
      const char32_t c = decode_utf8(text_, at_);
      if (c == invalid_code_point) fail(403, start, "not UTF-8");
      if (c < 0x20) fail(403, start, "a control character in a string");
      if (c == '"') return out;
      if (c == '\\')
        escape(out);
      else
        out += text_.substr(start, at_ - start);
    }
  }

  /// An integer in 0 ... 2^63-1, written with digits only.
  std::int64_t count() {
    skip_space();
    std::int64_t n = 0;
    const char* first = text_.data() + at_;
    const auto [end, status] = std::from_chars(first, text_.data() + text_.size(), n);
    const auto digits = static_cast<std::size_t>(end - first);
    if (digits == 0 || *first == '-') fail(403, at_, "expected an integer of at least 0");
    if (status != std::errc{}) fail(405, at_, "an integer above 2^63 - 1");
    if (digits > 1 && *first == '0') fail(403, at_, "an integer with a leading zero");
    at_ += digits;
    if (peek() == '.' || peek() == 'e' || peek() == 'E') fail(403, at_, "a fraction where an integer is due");
    return n;
  }

  /// Takes any value and forgets it.
  void skip_value() {
    skip_space();
    const char c = peek();
    if (c == '{') return object([&](const std::string&) { skip_value(); });
    if (c == '[') return array([&] { skip_value(); });
    if (c == '"') return void(string());
    if (c == '-' || (c >= '0' && c <= '9')) return skip_number();
    for (std::string_view word : {"true", "false", "null"}) {
      if (text_.substr(at_).starts_with(word)) return void(at_ += word.size());
    }
    fail(403, at_, "expected a value");
  }

 private:
  void enter() {
    if (++depth_ > max_depth) fail(403, at_, "nested too deeply");
  }

  void skip_digits() {
    const std::size_t start = at_;
    while (peek() >= '0' && peek() <= '9') ++at_;
    if (at_ == start) fail(403, at_, "expected a digit");
  }
  void skip_number() {
    if (peek() == '-') ++at_;
    if (peek() == '0')
      ++at_;
    else
      skip_digits();
    if (peek() == '.') ++at_, skip_digits();
    if (peek() == 'e' || peek() == 'E') {
      ++at_;
      if (peek() == '+' || peek() == '-') ++at_;
      skip_digits();
    }
  }

  void escape(std::string& out) {
    constexpr std::string_view letters = "\"\\/bfnrt", meaning = "\"\\/\b\f\n\r\t";
    const char c = peek();
    if (c == 'u') {
      ++at_;
      return append_utf8(out, escaped_code_point());
    }
    const std::size_t i = letters.find(c);
    if (at_end() || i == letters.npos) fail(403, at_, "an unknown escape in a string");
    out += meaning[i];
    ++at_;
  }
  char32_t escaped_code_point() {
    const std::size_t start = at_;
    const char32_t high = four_hex_digits();
    if (high < 0xD800 || high > 0xDFFF) return high;
    if (high < 0xDC00 && text_.substr(at_).starts_with("\\u")) {
      at_ += 2;
      const char32_t low = four_hex_digits();
      if (low >= 0xDC00 && low <= 0xDFFF) return 0x10000 + ((high - 0xD800) << 10) + (low - 0xDC00);
    }
    fail(403, start, "half of a surrogate pair");
  }
  char32_t four_hex_digits() {
    const std::string_view digits = text_.substr(at_, 4);
    unsigned value = 0;
    const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (status != std::errc{} || end != digits.data() + 4) fail(403, at_, "expected four hexadecimal digits");
    at_ += 4;
    return value;
  }

  std::string_view text_, file_;
  std::size_t offset_, at_ = 0;
  int depth_ = 0;
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SafetensorsFile SafetensorsFile::open(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return from_bytes(file->bytes(), path.string(), file);
}

MOTIONLANG_BODY SafetensorsFile SafetensorsFile::from_bytes(std::span<const std::byte> bytes, std::string name,
                                                            std::shared_ptr<const void> owner) {
  return SafetensorsFile(bytes, std::move(name), std::move(owner));
}

MOTIONLANG_BODY SafetensorsFile::SafetensorsFile(std::span<const std::byte> bytes, std::string name,
                                                 std::shared_ptr<const void> owner)
    : TensorSet(std::move(name), std::move(owner)) {
  const auto length = detail::load<std::uint64_t>(bytes, 0, name_, "the header length");
  if (length > max_header)
    raise<io_error>(405, name_, ": a header of ", counted(length, "byte"), "; at most ", max_header,
                    ". Is it a .safetensors file?");
  const auto header = detail::slice(bytes, prefix, length, name_, "the header");
  Cursor json(detail::as_text(header), name_, prefix);
  const auto data = bytes.subspan(prefix + static_cast<std::size_t>(length));

  std::vector<Range> ranges;
  if (json.peek() != '{') json.fail(403, 0, "a header has to begin with '{'");
  json.object([&](const std::string& key) {
    if (key == "__metadata__")
      read_metadata(json);
    else
      ranges.push_back(read_entry(json, key, data));
  });
  json.skip_space();
  if (!json.at_end()) json.fail(403, json.position(), "text behind the header's object");
  check_tiling(json, ranges, data.size());
  detail::sort(tensors_, [](const TensorView& a, const TensorView& b) { return a.name < b.name; });
}

MOTIONLANG_BODY void SafetensorsFile::read_metadata(Cursor& json) {
  json.object([&](const std::string& key) { metadata_[key] = json.string(); });
}

MOTIONLANG_BODY SafetensorsFile::Range SafetensorsFile::read_entry(Cursor& json, const std::string& name,
                                                                   std::span<const std::byte> data) {
  TensorView view{.name = name, .dtype = {}, .shape = {}, .bytes = {}};
  std::vector<std::int64_t> offsets;
  bool has_type = false, has_shape = false;
  const std::size_t at = json.position();
  json.object([&](const std::string& member) {
    if (member == "dtype") {
      view.dtype = read_dtype(json);
      has_type = true;
    } else if (member == "shape") {
      view.shape = read_shape(json);
      has_shape = true;
    } else if (member == "data_offsets") {
      json.array([&] {
        if (offsets.size() == 2) json.fail(403, json.position(), "more than two data_offsets");
        offsets.push_back(json.count());
      });
    } else {
      json.skip_value();
    }
  });
  if (!has_type || !has_shape || offsets.size() != 2) {
    json.fail(403, at, "tensor '" + view.name + "' lacks one of dtype, shape, data_offsets [begin, end]");
  }
  const Range range{static_cast<std::uint64_t>(offsets[0]), static_cast<std::uint64_t>(offsets[1]), at};
  check_size(json, view, range);
  if (range.end > data.size()) {
    json.fail(
        402, at,
        concat_text("tensor '", view.name, "' ends at ", range.end, ", the data have ", counted(data.size(), "byte")));
  }
  view.bytes = data.subspan(range.begin, range.end - range.begin);
  tensors_.push_back(std::move(view));
  return range;
}

MOTIONLANG_BODY DType SafetensorsFile::read_dtype(Cursor& json) {
  const std::size_t at = json.position();
  const std::string text = json.string();
  const auto dtype = parse_dtype(text);
  if (!dtype) json.fail(404, at, "unknown dtype '" + text + "'");
  return *dtype;
}

MOTIONLANG_BODY FileShape SafetensorsFile::read_shape(Cursor& json) {
  FileShape shape;
  json.array([&] {
    if (shape.rank() == FileShape::max_rank) {
      json.fail(404, json.position(), concat_text("more than ", FileShape::max_rank, " axes are not supported"));
    }
    shape.push_back(json.count());
  });
  return shape;
}

MOTIONLANG_BODY void SafetensorsFile::check_size(const Cursor& json, const TensorView& view, const Range& range) {
  constexpr std::uint64_t most_bits = std::uint64_t{1} << 62;
  std::uint64_t bits = static_cast<std::uint64_t>(info(view.dtype).bits);
  bool empty = false;
  for (int axis = 0; axis < view.shape.rank(); ++axis) {
    const auto n = static_cast<std::uint64_t>(view.shape[axis]);
    empty = empty || n == 0;
    if (n > 1 && bits > most_bits / n) {
      json.fail(405, range.declared_at, concat_text("tensor '", view.name, "': shape ", view.shape, " is too large"));
    }
    bits *= n > 1 ? n : 1;
  }
  if (empty) bits = 0;
  if (range.begin > range.end || bits % 8 != 0 || range.end - range.begin != bits / 8) {
    json.fail(405, range.declared_at,
              concat_text("tensor '", view.name, "': ", view.dtype, " ", view.shape, " does not fill data_offsets [",
                          range.begin, ", ", range.end, "]"));
  }
}

MOTIONLANG_BODY void SafetensorsFile::check_tiling(const Cursor& json, std::vector<Range>& ranges, std::uint64_t size) {
  detail::sort(ranges,
               [](const Range& a, const Range& b) { return a.begin != b.begin ? a.begin < b.begin : a.end < b.end; });
  std::uint64_t end = 0;
  for (const Range& r : ranges) {
    if (r.begin != end) {
      json.fail(
          403, r.declared_at,
          concat_text("data_offsets [", r.begin, ", ", r.end, "] ",
                      r.begin < end ? "overlap the range before, which ends at " : "leave a hole after byte ", end));
    }
    end = r.end;
  }
  if (end != size)
    json.fail(403, 0,
              concat_text(counted(size - end, "byte of data belongs", "bytes of data belong"), " to no tensor"));
}

namespace detail {

/// A JSON string. Throws io_error 403 if the text is not UTF-8.
inline void append_json_string(std::string& out, std::string_view text) {
  if (!is_utf8(text)) raise<io_error>(403, "safetensors: the name '", text, "' is not UTF-8");
  constexpr std::string_view digits = "0123456789abcdef";
  out += '"';
  for (char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\', out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += "\\u00";
      out += digits[static_cast<std::size_t>(c >> 4)], out += digits[static_cast<std::size_t>(c & 15)];
    } else {
      out += c;
    }
  }
  out += '"';
}

inline std::string safetensors_header(std::span<const TensorView* const> order,
                                      const std::map<std::string, std::string>& metadata) {
  std::string json = "{";
  const auto separate = [&] { json += json.size() > 1 ? "," : ""; };
  if (!metadata.empty()) {
    json += "\"__metadata__\":";
    char before = '{';
    for (const auto& [key, value] : metadata) {
      json += std::exchange(before, ',');
      append_json_string(json, key), json += ':', append_json_string(json, value);
    }
    json += '}';
  }
  std::size_t at = 0;
  for (const TensorView* t : order) {
    separate();
    append_json_string(json, t->name);
    json += concat_text(":{\"dtype\":\"", t->dtype, "\",\"shape\":[", join_text(t->shape.sizes(), ","),
                        "],\"data_offsets\":[", at, ",", at + t->bytes.size(), "]}");
    at += t->bytes.size();
  }
  json += '}';
  json.append((8 - json.size() % 8) % 8, ' ');
  return json;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::byte> safetensors_bytes(std::span<const TensorView> tensors,
                                                         const std::map<std::string, std::string>& metadata) {
  std::vector<const TensorView*> order;
  std::size_t size = 0;
  for (const TensorView& t : tensors) order.push_back(&t), size += t.bytes.size();
  detail::sort(order, [](const TensorView* a, const TensorView* b) {
    const int bits_a = info(a->dtype).bits, bits_b = info(b->dtype).bits;
    return bits_a != bits_b ? bits_a > bits_b : a->name < b->name;
  });
  const std::string header = detail::safetensors_header(order, metadata);
  std::vector<std::byte> out;
  out.reserve(sizeof(std::uint64_t) + header.size() + size);
  detail::append_value(out, std::uint64_t{header.size()});
  detail::append_text(out, header);
  for (const TensorView* t : order) detail::append_bytes(out, t->bytes);
  SafetensorsFile::from_bytes(out, "safetensors to be written");
  return out;
}

MOTIONLANG_BODY void write_safetensors(const FilePath& path, std::span<const TensorView> tensors,
                                       const std::map<std::string, std::string>& metadata) {
  write_file(path, safetensors_bytes(tensors, metadata));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The name under which a tensor of the module is filed: its path, unless the module translates (`official_key`).
template <Module M>
std::string tensor_key(const std::string& prefix, const std::string& path) {
  if constexpr (requires { M::official_key(path); })
    return prefix + M::official_key(path);
  else
    return prefix + path;
}

namespace detail {
/// Looks at the bits of the exponent, which are all set in NaN and infinity, because compilers vectorise such a loop.
template <Scalar S>
bool all_finite(std::span<const S> numbers) {
  using Bits = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
  constexpr Bits exponent = detail::bit_cast<Bits>(std::numeric_limits<S>::infinity());
  std::atomic<bool> finite{true};
  parallel_ranges(std::ssize(numbers), 1, [&](Index first, Index last) {
    Bits wrong = 0;
    for (const S x : numbers.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)))
      wrong |= static_cast<Bits>((detail::bit_cast<Bits>(x) & exponent) == exponent);
    if (wrong != 0) finite.store(false, std::memory_order_relaxed);
  });
  return finite;
}
}  // namespace detail

/// Gives a tensor the numbers of a view, converted to its scalar. float from F32 is a view of the file, without a copy.
/// A variable stays the variable it was. NaN is let through. Throws io_error 407 if the shape is another.
template <Backend B>
void assign_tensor(typename B::tensor& tensor, const TensorView& view, const std::shared_ptr<const void>& owner,
                   const std::string& where) {
  if constexpr (AutodiffBackend<B>) {
    assign_tensor<typename B::inner>(B::mutable_value(tensor), view, owner, where);
  } else {
    using S = typename B::scalar;
    const Shape shape = B::shape(tensor);
    if (view.shape != shape)
      raise<io_error>(407, where, ": tensor '", view.name, "' is ", view.shape, ", the model has ", shape);
    if constexpr (std::is_constructible_v<typename B::tensor, const S*, Shape, std::shared_ptr<const void>>) {
      const auto numbers = direct<S>(view);
      if (numbers && owner != nullptr) {
        tensor = typename B::tensor(numbers->data(), view.shape, owner);
        return;
      }
    }
    tensor = written_tensor<B>(
        shape, [&](S* to) { copy_values(view, std::span<S>(to, static_cast<std::size_t>(shape.count()))); });
  }
}
/// The purpose of loading a module. For inference it is made ready as by prepare_loaded, in the same pass over the
/// file: all its matrices are weights, and it is neither trained nor changed afterwards.
enum class LoadFor { any_use, inference };

namespace detail {

/// Throws numeric_error 301 if a number is NaN or infinite.
template <Scalar S>
void require_finite(std::span<const S> numbers, const TensorView& view, const std::string& where) {
  if (all_finite(numbers)) return;
  const auto wrong = std::find_if(numbers.begin(), numbers.end(), [](auto x) { return !std::isfinite(x); });
  raise<numeric_error>(301, where, ": number ", wrong - numbers.begin(), " of tensor '", view.name, "' is ", *wrong);
}

/// Fills tensors from a file by their names. For inference their numbers are looked at later.
struct TensorLoader {
  const TensorSet& file;
  const std::string& prefix;
  std::string (*key)(const std::string& prefix, const std::string& path);
  LoadFor use;
  KeyReport& report;
  std::set<std::string>& known;

  template <Backend B>
  void fill(const ModuleTensor<B>& tensor) const {
    const std::string& name = *known.insert(key(prefix, tensor.path)).first;
    const TensorView* view = file.find(name);
    if (view == nullptr) {
      report.missing.push_back(name);
      return;
    }
    assign_tensor<B>(*tensor.data, *view, file.owner(), file.name());
    if (use == LoadFor::any_use) require_finite<typename B::scalar>(tensor.span(), *view, file.name());
    MappedFile::forget_if_mapped(view->bytes);  // until it is needed
  }
};

/// True if the tensor repeats one of the module under another name. Throws io_error 407 if it should but is different.
template <class M>
bool is_copy(const M& module, const TensorSet& file, const std::string& prefix, const TensorView& t) {
  if constexpr (requires { module.copy_of(t.name); }) {
    const std::string path = module.copy_of(t.name.substr(prefix.size()));
    const TensorView* original = path.empty() ? nullptr : file.find(prefix + path);
    if (original == nullptr) return false;
    if (values_of<double>(*original) != values_of<double>(t))
      raise<io_error>(407, file.name(), ": tensor '", t.name, "' should repeat '", original->name, "' but is another");
    return true;
  }
  return false;
}

}  // namespace detail

/// Tensors on their way into a file, with their own memory.
class TensorStore {
 public:
  /// Copies the numbers, rounded to `dtype` (F32, F64, F16 or BF16). Throws config_error 101 for another, numeric_error
  /// 301 for a number that would become infinite; F16 holds no NaN and infinity either.
  template <Scalar S>
  void add(std::string name, const FileShape& shape, std::span<const S> values, DType dtype) {
    switch (dtype) {
      case DType::F32:
        require_held(name, values, dtype, std::numeric_limits<float>::infinity());
        return put<float>(std::move(name), shape, values, dtype, [](S x) { return static_cast<float>(x); });
      case DType::F64:
        return put<double>(std::move(name), shape, values, dtype, [](S x) { return static_cast<double>(x); });
      case DType::F16:
        require_held(name, values, dtype, 65520);
        return put<std::uint16_t>(std::move(name), shape, values, dtype,
                                  [](S x) { return float_to_half(static_cast<float>(x)); });
      case DType::BF16:
        require_held(name, values, dtype, 0x1.FFp127F);
        return put<std::uint16_t>(std::move(name), shape, values, dtype,
                                  [](S x) { return float_to_bfloat16(static_cast<float>(x)); });
      default:
        raise<config_error>(101, "TensorStore: '", name, "' cannot be stored as ", dtype);
    }
  }
  /// All tensors of a module.
  template <Module M>
  void add_module(const M& module, const std::string& prefix = "", DType dtype = DType::F32) {
    for (const auto& t : tensors_of(module)) add(tensor_key<M>(prefix, t.path), t.shape(), t.span(), dtype);
  }
  std::vector<TensorView> views() const {
    std::vector<TensorView> out;
    for (const Entry& e : entries_) out.push_back({e.name, e.dtype, e.shape, e.bytes});
    return out;
  }

 private:
  struct Entry {
    std::string name;
    DType dtype;
    FileShape shape;
    std::vector<std::byte> bytes;
  };
  /// end   what rounds to infinity, and all above it
  template <Scalar S>
  static void require_held(const std::string& name, std::span<const S> values, DType dtype, float end) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::abs(static_cast<float>(values[i])) < end) continue;
      if (std::isfinite(values[i]) || dtype == DType::F16)
        raise<numeric_error>(301, "TensorStore: number ", i, " of '", name, "' is ", values[i], ", too large for ",
                             dtype);
    }
  }
  template <class Stored, Scalar S, class F>
  void put(std::string name, const FileShape& shape, std::span<const S> values, DType dtype, F convert) {
    Entry e{std::move(name), dtype, shape, std::vector<std::byte>(values.size() * sizeof(Stored))};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Stored v = convert(values[i]);
      std::memcpy(e.bytes.data() + i * sizeof(Stored), &v, sizeof(Stored));
    }
    entries_.push_back(std::move(e));
  }
  std::vector<Entry> entries_;
};

namespace detail {
/// Packs a weight. If it lies in a mapped file, its memory there is given back: who still reads it gets it from the
/// file again. Whether all its numbers are finite.
template <PackingBackend B>
bool pack_loaded(const typename B::tensor& weight) {
  const bool finite = pack_weight<B>(weight);
  MappedFile::forget_if_mapped(std::as_bytes(B::to_span(weight)));
  return finite;
}

/// Numbers that are the weight's own, because they had to be converted, go into a file without a name, where there is a
/// place for it.
template <PackingBackend B>
void put_aside(typename B::tensor& weight) {
  const auto bytes = std::as_bytes(B::to_span(weight));
  if (MappedFile::that_holds(bytes) != nullptr || !weight.unique()) return;
  const auto aside = MappedFile::put_aside(bytes);
  if (aside == nullptr) return;
  const auto* numbers = reinterpret_cast<const typename B::scalar*>(aside->bytes().data());
  weight = typename B::tensor(numbers, B::shape(weight), aside);
  BufferPool::local().trim();  // packed, it may need a larger buffer than the one that it leaves
}

/// A small tensor in a mapped file becomes a copy: for a bias the system may keep two megabytes of the file in memory.
template <Backend B>
void copy_small(typename B::tensor& t) {
  if constexpr (requires { t.attached(); }) {
    constexpr std::size_t small = 1 << 14;
    const auto numbers = B::to_span(t);
    const auto bytes = std::as_bytes(numbers);
    const MappedFile* const file = MappedFile::that_holds(bytes);
    if (file == nullptr || t.attached() != nullptr || numbers.size() >= small) return;
    auto copy = B::from_span(numbers, B::shape(t));
    file->forget(bytes);  // before the tensor, which may be the last to keep the file
    t = std::move(copy);
  }
}

/// Makes a tensor ready; returns whether its numbers are finite, if they are `looked_at`.
template <Backend B>
bool prepare_loaded_tensor(const ModuleTensor<B>& t, bool looked_at) {
  bool finite = true;
  if constexpr (PackingBackend<B>) {
    if (has_panels<B>(t.rank)) {
      finite = pack_loaded<B>(*t.data);
      looked_at = false;
    }
  }
  if (looked_at) finite = all_finite(t.span());
  copy_small<B>(*t.data);
  return finite;
}
/// For large networks: a weight that had to be converted is put aside, so that it is not there twice. If it cannot be,
/// it is not packed.
template <Backend B>
void prepare_loaded_once(const ModuleTensor<B>& t) {
  if constexpr (PackingBackend<B>) {
    if (has_panels<B>(t.rank)) {
      put_aside<B>(*t.data);
      if (MappedFile::that_holds(std::as_bytes(t.span())) != nullptr) pack_loaded<B>(*t.data);
    }
  }
  copy_small<B>(*t.data);
}
/// Every thread takes some tensors: new memory is slow to come, and a thread gets it for itself. `finite` (null: not
/// looked at) becomes false if a number is not.
template <Backend B>
void prepare_in_shares(const std::vector<ModuleTensor<B>>& tensors, std::atomic<bool>* finite) {
  const Index count = std::ssize(tensors), shares = parallel_width();
  parallel_for(shares, [&](Index share) {
    for (Index i = 0; i < count; ++i) {
      if (i * shares / count != share) continue;
      const bool good = prepare_loaded_tensor(tensors[static_cast<std::size_t>(i)], finite != nullptr);
      if (finite != nullptr && !good) finite->store(false);
    }
  });
}
}  // namespace detail

/// `prepare` for networks all of whose matrices are weights, straight from a file: the memory of a mapped file is given
/// back as soon as a weight is packed, so that none is there twice, and small tensors become copies. Whoever still
/// reads the file gets it from the disk. Weights that had to be converted are packed beside their numbers.
template <Module M>
void prepare_loaded(M& model) {
  detail::prepare_in_shares(tensors_of(model), nullptr);
}

/// Fills all tensors of a module from the tensors whose names begin with `prefix`. The module has its sizes already.
/// Returns what did not match (then the module is not made ready); throws io_error 407 for a tensor of another shape,
/// numeric_error 301 for NaN and infinity. A module may say (`copy_of`) which further names repeat a tensor of its own;
/// io_error 407 if such a tensor is another one.
template <Module M>
KeyReport load_module_partly(M& module, const TensorSet& file, const std::string& prefix = "",
                             LoadFor use = LoadFor::any_use) {
  const auto tensors = tensors_of(module);
  KeyReport report;
  std::set<std::string> known;
  const auto fill = [&](LoadFor how) {
    report = {};
    known.clear();
    const detail::TensorLoader loader{file, prefix, &tensor_key<M>, how, report, known};
    for (const auto& t : tensors) loader.fill(t);
  };
  fill(use);
  if (use == LoadFor::inference) {
    std::atomic<bool> finite{report.missing.empty()};
    if (finite) detail::prepare_in_shares(tensors, &finite);
    if (!finite) fill(LoadFor::any_use);  // says which number is not
  }
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(prefix) || known.contains(t.name)) continue;
    if (!detail::is_copy(module, file, prefix, t)) report.unexpected.push_back(t.name);
  }
  return report;
}
/// The same, where every name has to match. Throws io_error 406 with both lists, and what looks like a name of either.
template <Module M>
void load_module(M& module, const TensorSet& file, const std::string& prefix = "", LoadFor use = LoadFor::any_use) {
  const KeyReport report = load_module_partly(module, file, prefix, use);
  if (report.missing.empty() && report.unexpected.empty()) return;
  detail::raise_key_mismatch(file.name(), report);
}
/// The same from a safetensors file, as save_module writes it.
template <Module M>
void load_module(M& module, const FilePath& path, LoadFor use = LoadFor::any_use) {
  load_module(module, SafetensorsFile::open(path), "", use);
}

/// Writes all tensors of a module into a safetensors file, without its sizes and options: the caller makes the module,
/// load_module fills it. `dtype` is that of the module's numbers unless given. Throws io_error 401, and what
/// TensorStore::add throws.
template <Module M>
void save_module(const FilePath& path, const M& module, std::optional<DType> dtype = {},
                 const std::map<std::string, std::string>& metadata = {{"format", "pt"}}) {
  constexpr bool is_double = std::is_same_v<typename module_backend<M>::scalar, double>;
  TensorStore store;
  store.add_module(module, "", dtype.value_or(is_double ? DType::F64 : DType::F32));
  write_safetensors(path, store.views(), metadata);
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes of a bundled model: everything that its constructor needs.
struct StmcModelConfig {
  MdmSmplConfig denoiser{};
  CaptionEncoderConfig text{};
  Index diffusion_steps = 100;
  // How the model should be sampled:
  NoiseScale noise_scale = NoiseScale::posterior_std;
  SamplingOptions::Sampler sampler = SamplingOptions::Sampler::ddpm;
  Index sampling_steps = 0;  // 0: all
  double guidance = 2.5;
  double fps = 20;
};

namespace detail {

using Metadata = std::map<std::string, std::string>;

template <class N>
N number_in_metadata(std::string_view text, const std::string& key, const std::string& file) {
  N value{};
  const auto [end, error] = detail::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    raise<config_error>(107, file, ": metadata '", key, "' = '", text, "' is not a number");
  }
  return value;
}
template <class N>
N metadata_number(const Metadata& metadata, const std::string& key, const std::string& file) {
  const auto found = metadata.find(key);
  if (found == metadata.end()) raise<config_error>(107, file, ": metadata '", key, "' is missing");
  return number_in_metadata<N>(found->second, key, file);
}
std::string metadata_text(const Metadata& metadata, const std::string& key, const std::string& otherwise);
/// A size that a file may ask for: a hostile one must not make us allocate.
Index metadata_size(const Metadata& metadata, const std::string& key, Index largest, const std::string& file,
                    Index smallest = 1);

WordPiece metadata_vocabulary(const Metadata& metadata, const std::string& file);
/// The entries of users about a model or a record. Throws config_error 102 for a key that is there already.
void add_metadata(Metadata& metadata, const Metadata& about, std::string_view whose, const std::string& file);

}  // namespace detail

/// The sizes as metadata. `vocabulary` of the tokenizer. Throws config_error 101 for more steps of sampling than there
/// are.
std::map<std::string, std::string> stmc_metadata(const StmcModelConfig& c, const WordPiece& tokenizer);
/// The sizes that a file declares. Throws config_error 101, 103, 107.
StmcModelConfig stmc_config(const SafetensorsFile& file);

/// A model of the given sizes. `rng` draws the parameters; NoInit leaves them zero.
template <Backend B>
Stmc<B> make_stmc(const StmcModelConfig& c, WordPiece tokenizer, Rng auto rng) {
  auto denoiser_rng = rng.split("denoiser");
  auto text_rng = rng.split("text");
  return {.denoiser = MdmSmplDenoiser<B>(c.denoiser, denoiser_rng),
          .text_encoder = CaptionEncoder<B>(c.text, std::move(tokenizer), text_rng),
          .motion_normalizer = Normalizer<B>::identity(c.denoiser.nfeats),
          .text_normalizer = Normalizer<B>::identity(c.denoiser.tx_dim),
          .diffusion = GaussianDiffusion(CosineSchedule{.steps = c.diffusion_steps}),
          .layout = smplrifke_layout(),
          .guidance = c.guidance,
          .sampling = {.sampler = c.sampler, .noise_scale = c.noise_scale},
          .steps = c.sampling_steps,
          .fps = c.fps};
}

/// Compares the tensors that decide how large a model is with its sizes, before memory is taken for what the metadata
/// claim. Throws io_error 406, 407.
void check_sizes(const SafetensorsFile& file, const StmcModelConfig& c, Index vocabulary);

/// Reads a model and makes it ready for inference. Throws io_error 401 ... 407, config_error 101, 103, 107,
/// numeric_error 301.
template <Backend B>
Stmc<B> load_stmc(const SafetensorsFile& file) {
  const StmcModelConfig c = stmc_config(file);
  WordPiece tokenizer = detail::metadata_vocabulary(file.metadata(), file.name());
  check_sizes(file, c, tokenizer.size());
  Stmc<B> model = make_stmc<B>(c, std::move(tokenizer), NoInit{});
  load_module(model, file, "", LoadFor::inference);
  return model;
}
template <Backend B>
Stmc<B> load_stmc(const FilePath& path) {
  return load_stmc<B>(SafetensorsFile::open(path));
}

/// Writes a model. `about` is added to the metadata: license, provenance, data, command, commit. Throws io_error 401,
/// config_error 102 if `about` would change what the model is.
template <Backend B>
void save_stmc(const FilePath& path, const Stmc<B>& model, const StmcModelConfig& config,
               const std::map<std::string, std::string>& about, DType dtype = DType::F16) {
  TensorStore store;
  store.add_module(model, "", dtype);
  auto metadata = stmc_metadata(config, model.text_encoder.tokenizer);
  detail::add_metadata(metadata, about, "model", path.string());
  write_safetensors(path, store.views(), metadata);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_STMC_FILE_IPP  // <motionlang/weights/stmc_file.ipp>
#define MOTIONLANG_HAS_WEIGHTS_STMC_FILE_IPP
// Bodies of stmc_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string metadata_text(const Metadata& metadata, const std::string& key,
                                          const std::string& otherwise) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? otherwise : found->second;
}

MOTIONLANG_BODY Index metadata_size(const Metadata& metadata, const std::string& key, Index largest,
                                    const std::string& file, Index smallest) {
  const auto n = metadata_number<Index>(metadata, key, file);
  if (n < smallest || n > largest)
    raise<config_error>(101, file, ": metadata '", key, "' = ", n, " is not in ", smallest, " ... ", largest);
  return n;
}

inline double metadata_real(const Metadata& metadata, const std::string& key, double least, double largest,
                            const std::string& file) {
  const auto x = metadata_number<double>(metadata, key, file);
  if (!(x >= least && x <= largest))
    raise<config_error>(101, file, ": metadata '", key, "' = ", x, " is not in ", least, " ... ", largest);
  return x;
}

/// "ddpm 20"; the number is left out for all steps.
inline std::string sampling_text(const StmcModelConfig& c) {
  const std::string_view sampler = to_string(c.sampler);
  return c.sampling_steps == 0 ? std::string(sampler) : concat_text(sampler, ' ', c.sampling_steps);
}

inline void check_sampling_steps(const StmcModelConfig& c, const std::string& where) {
  if (c.sampling_steps < 0 || c.sampling_steps > c.diffusion_steps)
    raise<config_error>(101, where, ": ", counted(c.sampling_steps, "step"), " of sampling, the process has ",
                        c.diffusion_steps);
}

inline void read_sampling(const Metadata& metadata, StmcModelConfig& c, const std::string& file) {
  const std::string wanted = metadata_text(metadata, "sampling", sampling_text({}));
  const std::size_t space = std::min(wanted.find(' '), wanted.size());
  c.sampler = parse_sampler(std::string_view(wanted).substr(0, space), file + ": metadata 'sampling':");
  if (space == wanted.size()) return;
  c.sampling_steps = number_in_metadata<Index>(std::string_view(wanted).substr(space + 1), "sampling", file);
  check_sampling_steps(c, file);
}

MOTIONLANG_BODY WordPiece metadata_vocabulary(const Metadata& metadata, const std::string& file) {
  const auto found = metadata.find("text.vocabulary");
  if (found == metadata.end()) raise<config_error>(107, file, ": metadata 'text.vocabulary' is missing");
  std::vector<std::string> pieces;
  for (std::size_t at = 0; at <= found->second.size();) {
    const std::size_t end = std::min(found->second.find('\n', at), found->second.size());
    pieces.push_back(found->second.substr(at, end - at));
    at = end + 1;
  }
  return WordPiece(std::move(pieces), file + ": metadata 'text.vocabulary'");
}

MOTIONLANG_BODY void add_metadata(Metadata& metadata, const Metadata& about, std::string_view whose,
                                  const std::string& file) {
  for (const auto& [key, value] : about) {
    if (!metadata.emplace(key, value).second)
      raise<config_error>(102, file, ": metadata '", key, "' belongs to the ", whose, " and cannot be given");
  }
}

}  // namespace detail

MOTIONLANG_BODY std::map<std::string, std::string> stmc_metadata(const StmcModelConfig& c, const WordPiece& tokenizer) {
  detail::check_sampling_steps(c, "stmc_metadata");
  std::string vocabulary;
  for (const std::string& piece : tokenizer.vocabulary()) vocabulary += (vocabulary.empty() ? "" : "\n") + piece;
  auto text = [](auto n) { return concat_text(n); };
  return {
      {"model", "stmc"},
      {"format", "1"},
      {"features", "smplrifke"},
      {"fps", text(c.fps)},
      {"denoiser.nfeats", text(c.denoiser.nfeats)},
      {"denoiser.latent_dim", text(c.denoiser.latent_dim)},
      {"denoiser.ff_size", text(c.denoiser.ff_size)},
      {"denoiser.num_layers", text(c.denoiser.num_layers)},
      {"denoiser.num_heads", text(c.denoiser.num_heads)},
      {"denoiser.nb_registers", text(c.denoiser.nb_registers)},
      {"denoiser.activation", std::string(to_string(c.denoiser.activation))},
      {"denoiser.max_len", text(c.denoiser.max_len)},
      {"text.width", text(c.text.width)},
      {"text.heads", text(c.text.heads)},
      {"text.d_ff", text(c.text.d_ff)},
      {"text.layers", text(c.text.layers)},
      {"text.out", text(c.text.out)},
      {"text.longest", text(c.text.longest)},
      {"text.vocabulary", vocabulary},
      {"diffusion.schedule", "cosine"},
      {"diffusion.steps", text(c.diffusion_steps)},
      {"diffusion.noise_scale", c.noise_scale == NoiseScale::posterior_std ? "posterior_std" : "posterior_variance"},
      {"sampling", detail::sampling_text(c)},
      {"guidance", text(c.guidance)}};
}

MOTIONLANG_BODY StmcModelConfig stmc_config(const SafetensorsFile& file) {
  const auto& m = file.metadata();
  const std::string& name = file.name();
  if (detail::metadata_text(m, "model", "") != "stmc" || detail::metadata_text(m, "format", "") != "1") {
    raise<config_error>(103, name, ": not an STMC model of format 1 (metadata 'model' and 'format')");
  }
  if (detail::metadata_text(m, "features", "") != "smplrifke" ||
      detail::metadata_text(m, "diffusion.schedule", "") != "cosine") {
    raise<config_error>(103, name, ": features '", detail::metadata_text(m, "features", ""), "' or schedule '",
                        detail::metadata_text(m, "diffusion.schedule", ""), "' is unknown");
  }
  const std::string scale = detail::metadata_text(m, "diffusion.noise_scale", "posterior_std");
  if (scale != "posterior_std" && scale != "posterior_variance")
    raise<config_error>(103, name, ": diffusion.noise_scale '", scale,
                        "' is neither posterior_std nor posterior_variance");
  auto size = [&](const std::string& key, Index largest) { return detail::metadata_size(m, key, largest, name); };
  auto size_or = [&](const std::string& key, Index largest, Index otherwise) {
    return m.contains(key) ? size(key, largest) : otherwise;
  };
  auto heads = [&](const std::string& key, Index width) {
    const Index n = size(key, 256);
    if (width % n != 0 || width % 2 != 0)
      raise<config_error>(101, name, ": ", key, " = ", n, " does not divide the even width ", width);
    return n;
  };
  StmcModelConfig c;
  c.denoiser.nfeats = size("denoiser.nfeats", 4096);
  if (const Index features = smplrifke_layout().size; c.denoiser.nfeats != features)
    raise<config_error>(101, name, ": denoiser.nfeats is ", c.denoiser.nfeats, ", smplrifke has ",
                        counted(features, "feature"));
  c.denoiser.latent_dim = size("denoiser.latent_dim", 8192);
  c.denoiser.ff_size = size("denoiser.ff_size", 32768);
  c.denoiser.num_layers = size("denoiser.num_layers", 256);
  c.denoiser.num_heads = heads("denoiser.num_heads", c.denoiser.latent_dim);
  c.denoiser.nb_registers = detail::metadata_size(m, "denoiser.nb_registers", 256, name, 0);
  c.text.width = size("text.width", 8192);
  c.text.heads = heads("text.heads", c.text.width);
  c.text.d_ff = size("text.d_ff", 32768);
  c.text.layers = size("text.layers", 256);
  c.text.out = c.denoiser.tx_dim = size("text.out", 8192);
  const std::string activation = detail::metadata_text(m, "denoiser.activation", "gelu");
  if (activation != "gelu" && activation != "relu")
    raise<config_error>(103, name, ": denoiser.activation '", activation, "' is neither gelu nor relu");
  c.denoiser.activation = parse_activation(activation);
  c.denoiser.max_len = size_or("denoiser.max_len", 8192, c.denoiser.max_len);
  c.text.longest = size_or("text.longest", 8192, c.text.longest);
  c.diffusion_steps = size("diffusion.steps", c.denoiser.max_len);  // a row of the table of positions tells the step
  c.fps = detail::metadata_real(m, "fps", 1, 1000, name);
  c.guidance = detail::metadata_real(m, "guidance", 0, 1000, name);
  c.noise_scale = scale == "posterior_std" ? NoiseScale::posterior_std : NoiseScale::posterior_variance;
  detail::read_sampling(m, c, name);
  return c;
}

MOTIONLANG_BODY void check_sizes(const SafetensorsFile& file, const StmcModelConfig& c, Index vocabulary) {
  auto expect = [&](const std::string& name, const Shape& shape) {
    if (const FileShape& found = file.tensor(name).shape; found != shape)
      raise<io_error>(407, file.name(), ": tensor '", name, "' is ", found, ", the metadata say ", shape);
  };
  auto transformer = [&](const std::string& prefix, Index layers, Index width, Index d_ff) {
    for (Index i = 0; i < layers; ++i) {
      const std::string layer = concat_text(prefix, ".layers.", i);
      expect(layer + ".self_attn.in_proj_weight", {3 * width, width});
      expect(layer + ".linear1.weight", {d_ff, width});
    }
  };
  const MdmSmplConfig& d = c.denoiser;
  if (d.nb_registers > 0) expect("denoiser.registers", {d.nb_registers, d.latent_dim});
  expect("denoiser.skel_embedding.weight", {d.latent_dim, d.nfeats});
  expect("denoiser.tx_embedding.0.weight", {2 * d.latent_dim, d.tx_dim});
  transformer("denoiser.seqTransEncoder", d.num_layers, d.latent_dim, d.ff_size);
  expect("text_encoder.embedding.weight", {vocabulary, c.text.width});
  expect("text_encoder.projection.weight", {c.text.out, c.text.width});
  transformer("text_encoder.encoder", c.text.layers, c.text.width, c.text.d_ff);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A checksum of all values of a module and their scalar.
template <Module M>
std::string weights_checksum(const M& module) {
  std::uint64_t h = 0;
  for (const auto& t : tensors_of(module)) h = content_hash(std::as_bytes(t.span()), h);
  return hexadecimal(h);
}
/// "x0/007": names whose order is that of the numbers, below 1000.
std::string numbered_name(const char* what, std::size_t i);

/// The part that does not depend on the backend.
struct RecordAbout {
  std::vector<Timeline> timelines{};
  Philox rng{};
  StmcOptions options{};
  Index rows = 0;
  bool exact = true;
};
/// Guidance and sampling are set in the options. The timelines are put into the store.
Metadata record_metadata(const RecordAbout& run, const std::string& model, std::size_t steps, TensorStore& store);
/// model   the checksum of the weights that are to go on with it
RecordAbout read_record(const SafetensorsFile& file, const std::string& model, Index most_steps);

}  // namespace detail

/// `about` is added to the metadata. Throws io_error 401, config_error 102 if `about` would change what the record is.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
void save_stmc_record(const FilePath& path, const StmcRecord<B>& record, const Stmc<B, D, E>& stmc,
                      const std::map<std::string, std::string>& about = {}) {
  using S = typename B::scalar;
  detail::RecordAbout run{record.timelines, record.rng, record.options, record.rows, record.exact};
  run.options.sampling = record.options.sampling.value_or(stmc.sampling);
  run.options.guidance = record.options.guidance.value_or(stmc.guidance);
  TensorStore store;
  auto metadata = detail::record_metadata(run, detail::weights_checksum(stmc), record.x0.size(), store);
  detail::add_metadata(metadata, about, "record", path.string());
  std::vector<TensorView> views = store.views();
  for (std::size_t k = 0; k < record.x0.size(); ++k) {
    views.push_back({.name = detail::numbered_name("x0", k),
                     .dtype = sizeof(S) == 4 ? DType::F32 : DType::F64,
                     .shape = record.x0[k].shape(),
                     .bytes = std::as_bytes(record.x0[k].span())});
  }
  write_safetensors(path, views, metadata);
}

/// Reads a record and compares it with the model that is to go on with it. Throws io_error 401 ... 407, config_error
/// 101, 102 (made with other weights or another precision), 103 (no record, or of an unknown sampler), 107.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
StmcRecord<B> load_stmc_record(const SafetensorsFile& file, const Stmc<B, D, E>& stmc) {
  detail::RecordAbout run = detail::read_record(file, detail::weights_checksum(stmc), stmc.diffusion.steps());
  const Shape shape{std::ssize(run.timelines) * run.rows, stmc.layout.size};
  StmcRecord<B> out{.timelines = std::move(run.timelines),
                    .rng = run.rng,
                    .options = run.options,
                    .rows = run.rows,
                    .exact = run.exact};
  for (Index k = 0; k < *out.options.steps; ++k) {
    const TensorView& view = file.tensor(detail::numbered_name("x0", static_cast<std::size_t>(k)));
    if (view.shape != shape)
      raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.shape, ", expected ", shape);
    out.x0.push_back(Tensor<B, 2>::from(values_of<typename B::scalar>(view), shape));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_STMC_RECORD_IPP  // <motionlang/weights/stmc_record.ipp>
#define MOTIONLANG_HAS_WEIGHTS_STMC_RECORD_IPP
// Bodies of stmc_record.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string metadata_real_text(double x) {
  std::string out;
  append_python_float(out, x);
  return out;
}

MOTIONLANG_BODY std::string numbered_name(const char* what, std::size_t i) {
  const std::string digits = std::to_string(i);
  return concat_text(what, '/', digits.size() < 3 ? std::string(3 - digits.size(), '0') : "", digits);
}

/// The body of a record's timelines.
inline BodyPartition record_body(const SafetensorsFile& file) {
  const auto parts = file.metadata().find("body/parts");
  if (parts == file.metadata().end()) return {};
  BodyPartNames names{.names = {}, .path = metadata_text(file.metadata(), "body/path", "")};
  for (std::string_view rest = parts->second; !rest.empty();) {
    const std::size_t end = std::min(rest.find('#'), rest.size());
    names.names.emplace_back(trim(rest.substr(0, end)));
    rest.remove_prefix(std::min(rest.size(), end + 1));
  }
  return BodyPartition(names);
}

inline Timeline record_timeline(const SafetensorsFile& file, const BodyPartition& body, std::size_t m, Index rows) {
  const TensorView& view = file.tensor(numbered_name("timeline", m));
  if (view.shape.rank() != 2 || view.shape[1] != 3)
    raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.shape, ", not (texts, 3)");
  const auto numbers = values_of<double>(view);
  Timeline out{{}, body};
  for (std::size_t i = 0; 3 * i < numbers.size(); ++i) {
    const auto number = [&](std::size_t column, Index largest) {
      const double x = numbers[3 * i + column];
      if (!(x >= 0 && x <= static_cast<double>(largest)))
        raise<config_error>(101, file.name(), ": ", x, " in tensor '", view.name, "' is not in 0 ... ", largest);
      return static_cast<Index>(x);
    };
    const auto text = file.metadata().find(concat_text("text/", m, '/', i));
    if (text == file.metadata().end())
      raise<config_error>(107, file.name(), ": metadata 'text/", m, "/", i, "' is missing");
    out.intervals.push_back(
        {text->second, number(0, rows), number(1, rows), {static_cast<unsigned>(number(2, body.all().bits))}});
  }
  return out;
}

MOTIONLANG_BODY Metadata record_metadata(const RecordAbout& run, const std::string& model, std::size_t steps,
                                         TensorStore& store) {
  const StmcOptions& o = run.options;
  const SamplingOptions sampling = *o.sampling;
  auto text = [](auto value) { return std::to_string(value); };
  Metadata metadata{
      {"record", "stmc"},
      {"format", "1"},
      {"model", model},
      {"precision", precision_name(product_precision())},
      {"seed", text(run.rng.seed)},
      {"stream", text(run.rng.stream)},
      {"timelines", text(run.timelines.size())},
      {"steps", text(steps)},
      {"rows", text(run.rows)},
      {"exact", run.exact ? "1" : "0"},
      {"overlap", text(o.overlap)},
      {"guidance", metadata_real_text(*o.guidance)},
      {"sampler", std::string(to_string(sampling.sampler))},
      {"eta", metadata_real_text(sampling.eta)},
      {"noise_scale", sampling.noise_scale == NoiseScale::posterior_std ? "posterior_std" : "posterior_variance"},
      {"clip", sampling.clip ? "1" : "0"},
      {"gaps", o.gaps == Gaps::fill ? "fill" : "refuse"},
      {"hidden", o.hidden == HiddenTexts::refuse ? "refuse" : "ignore"}};
  if (!run.timelines.empty() && run.timelines.front().body != BodyPartition()) {
    const BodyPartition& body = run.timelines.front().body;  // that of all, because it is the layout's
    metadata.emplace("body/parts", join_text(body.names(), " # "));
    metadata.emplace("body/path", body.name(body.path()));
  }
  for (std::size_t m = 0; m < run.timelines.size(); ++m) {
    std::vector<double> rows;
    for (const Interval& i : run.timelines[m].intervals) {
      metadata.emplace(concat_text("text/", m, '/', rows.size() / 3), i.text);
      for (const auto n : {i.start, i.end, static_cast<Index>(i.parts.bits)}) rows.push_back(static_cast<double>(n));
    }
    store.add<double>(numbered_name("timeline", m), {std::ssize(rows) / 3, 3}, rows, DType::F64);
  }
  return metadata;
}

MOTIONLANG_BODY RecordAbout read_record(const SafetensorsFile& file, const std::string& model, Index most_steps) {
  const auto& m = file.metadata();
  const std::string& name = file.name();
  const auto word = [&](const char* key) { return metadata_text(m, key, ""); };
  const auto whole = [&](const char* key) { return metadata_number<std::uint64_t>(m, key, name); };
  const auto real = [&](const char* key) { return metadata_number<double>(m, key, name); };
  if (word("record") != "stmc" || word("format") != "1")
    raise<config_error>(103, name, ": not a record of an STMC run of format 1 (metadata 'record' and 'format')");
  if (word("model") != model)
    raise<config_error>(
        102, name, ": made with weights of checksum ", word("model"), ", these have ", model,
        "; the checksum of the same weights is another in another scalar, which other backends may use");
  const std::string precision = precision_name(product_precision());
  if (word("precision") != precision)
    raise<config_error>(102, name, ": made with products in ", word("precision"), ", not ", precision);
  RecordAbout out{.rng = {.seed = whole("seed"), .stream = whole("stream")}};
  out.rows = metadata_size(m, "rows", latest_time, name);
  out.exact = word("exact") == "1";
  out.options = {.overlap = metadata_number<Index>(m, "overlap", name),
                 .guidance = real("guidance"),
                 .steps = metadata_size(m, "steps", most_steps, name),
                 .sampling = SamplingOptions{.sampler = parse_sampler(word("sampler"), name + ": metadata 'sampler':"),
                                             .eta = real("eta"),
                                             .clip = word("clip") == "1"},
                 .gaps = word("gaps") == "refuse" ? Gaps::refuse : Gaps::fill,
                 .hidden = word("hidden") == "ignore" ? HiddenTexts::ignore : HiddenTexts::refuse};
  if (word("noise_scale") == "posterior_std") out.options.sampling->noise_scale = NoiseScale::posterior_std;
  const Index timelines = metadata_size(m, "timelines", latest_time, name);
  const BodyPartition body = record_body(file);
  for (Index i = 0; i < timelines; ++i) {
    out.timelines.push_back(record_timeline(file, body, static_cast<std::size_t>(i), out.rows));
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The noise of a file: noise/000 is the initial one. Throws io_error 401 ... 407.
template <Backend B>
auto noise_of_file(const FilePath& path) {
  return [file = SafetensorsFile::open(path)](Index draw, const Shape& shape) {
    const auto& view = file.tensor(numbered_name("noise", static_cast<std::size_t>(draw)));
    if (view.shape != shape)
      raise<io_error>(407, file.name(), ": ", view.name, " is ", view.shape, ", this timeline needs ", shape);
    return Tensor<B, 3>::from(values_of<typename B::scalar>(view), shape);
  };
}

/// One call of generate_motions.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
class GenerateRun {
 public:
  GenerateRun(const Stmc<B, D, E>& model, const GenerateOptions& options) : model_(model), o_(options) {
    require_steps(o_, model_.diffusion.steps());
    require_one_source(o_);
    how_.overlap = frame_at(o_.overlap, model_.fps);
    how_.hidden = HiddenTexts::ignore;  // hidden_text_warnings report them
    how_.guidance = o_.guidance;
    how_.steps = o_.steps;
    how_.sampling = model_.sampling;
    if (o_.sampler) how_.sampling->sampler = *o_.sampler;
    if (o_.keep) keep_on_model();
  }

  std::vector<Motion> operator()(std::span<const Timeline> timelines) const {
    if (o_.notes != nullptr) *o_.notes = {.layout = model_.layout.name};
    std::vector<Motion> collages, motions;
    const Arms arms = arms_of(timelines);
    Steps first{&o_.progress, 0, arms.texts.empty() ? 1 : 2}, second{&o_.progress, 1, 2};
    Sampling how{Philox{.seed = o_.seed}, how_, o_.cut_texts};
    how.options.progress = first;
    for (const Tensor<B, 2>& f : features(timelines, how)) {
      const std::vector<double> rows(f.span().begin(), f.span().end());
      if (o_.notes != nullptr) o_.notes->features.push_back(rows);
      collages.push_back(motion_of(rows));
    }
    how.options.progress = second;
    overlay(arms, collages, how);
    for (Motion& motion : collages) {
      if (o_.keep) motion = in_its_place(std::move(motion), clip_, clip_frames_, o_);
      motions.push_back(finish_motion(std::move(motion), o_));
      if (o_.keep && o_.notes != nullptr)
        o_.notes->kept_moved =
            std::max(o_.notes->kept_moved, farthest_from(motions.back(), clip_, clip_frames_, *o_.keep));
    }
    return motions;
  }

 private:
  using Features = std::vector<Tensor<B, 2>>;

  /// The sampling of a run. A run that is reused has it in its record.
  struct Sampling {
    Philox rng{};
    StmcOptions options{};
    bool cut = true;
  };

  Motion motion_of(std::span<const double> rows) const {
    return motion_of_features(model_.layout.name, rows, model_.layout.size, model_.fps);
  }

  /// Counts the steps of one of several runs for the caller.
  struct Steps {
    const Progress* caller;
    Index run, runs;
    bool operator()(Index done, Index total) const { return (*caller)(run * total + done, runs * total), true; }
  };

  /// The texts of arms in the timelines: of which one each is, and what it is alone.
  struct Arms {
    std::vector<std::pair<std::size_t, ArmText>> texts{};
    std::vector<Timeline> alone{};
  };
  Arms arms_of(std::span<const Timeline> timelines) const {
    Arms out;
    const bool possible = o_.overlay_arms && !o_.keep && o_.noise.string().empty() && model_.layout.name == "smplrifke";
    for (std::size_t m = 0; possible && m < timelines.size(); ++m) {
      for (ArmText& text : arm_texts(timelines[m], frame_at(shortest_part, model_.fps))) {
        out.alone.push_back(text.alone);
        out.texts.emplace_back(m, std::move(text));
      }
    }
    return out;
  }
  /// Lays over the motions of the timelines what their texts of arms make alone, where the collage lost it.
  void overlay(const Arms& arms, std::vector<Motion>& motions, const Sampling& how) const {
    if (arms.texts.empty()) return;
    const Features features = model_.generate(cut(arms.alone, how.cut), how.rng, how.options);
    for (std::size_t i = 0; i < arms.texts.size(); ++i) {
      const auto& [m, text] = arms.texts[i];
      const Motion alone = motion_of(std::vector<double>(features[i].span().begin(), features[i].span().end()));
      if (is_arm_lost(motions[m], alone, text)) motions[m] = lay_arm_over(motions[m], alone, text);
    }
  }

  /// (frames, features) of each timeline, not normalised. Sets what a run was sampled with if it is reused.
  Features features(std::span<const Timeline> timelines, Sampling& how) const {
    if (!o_.reuse.string().empty()) return reused(timelines, how);
    const std::vector<Timeline> texts = cut(timelines, o_.cut_texts);
    const Philox& rng = how.rng;
    if (o_.keep) return around(texts, how);
    if (!o_.noise.string().empty()) return model_.generate_from(texts, noise_of_file<B>(o_.noise), how.options);
    if (o_.record.string().empty()) return model_.generate(texts, rng, how.options);
    StmcRecord<B> record;
    Features out = generate_recorded<B>(model_, texts, rng, how.options, record);
    save(record, o_.cut_texts);
    return out;
  }

  std::vector<Timeline> cut(std::span<const Timeline> timelines, bool wanted) const {
    std::vector<Timeline> out;
    for (const Timeline& t : timelines) out.push_back(wanted ? cut_texts(t, model_.fps) : t);
    return out;
  }

  /// The clip that is kept, on the joints and at the rate of the model, and its features.
  void keep_on_model() {
    const MotionFeatures& own = features_of_layout(model_.layout.name, model_.layout.size);
    clip_ = resample(on_joints_of(own, o_.keep->motion), model_.fps);
    const auto rows = own.from_motion(clip_);
    clip_rows_.assign(rows.begin(), rows.end());
    clip_frames_ = std::ssize(rows) / model_.layout.size;
  }
  Features around(std::span<const Timeline> timelines, const Sampling& how) const {
    std::vector<KeptMotion<B>> kept;
    for (const Timeline& t : timelines) {
      auto& own = kept.emplace_back();
      own.features = Tensor<B, 2>::from(clip_rows_, {clip_frames_, model_.layout.size});
      for (const IndexRange& range : kept_frames(*o_.keep, clip_frames_, t.end(), model_.fps))
        own.parts.push_back({range, o_.keep->parts});
    }
    return generate_around<B>(model_, timelines, how.rng, how.options, std::span<const KeptMotion<B>>(kept));
  }

  /// With what the record of an earlier run says about the part that was not edited.
  Features reused(std::span<const Timeline> timelines, Sampling& sampling) const {
    const auto file = SafetensorsFile::open(o_.reuse);
    auto record = load_stmc_record<B>(file, model_);
    const bool was_cut = file.metadata().contains("cut_texts") && file.metadata().at("cut_texts") == "1";
    RegenerateOptions how{.within = {}, .progress = sampling.options.progress};
    if (o_.keep_beyond) how.within = frame_at(*o_.keep_beyond, model_.fps);
    StmcReuse reuse;
    Features out = regenerate<B>(model_, record, cut(timelines, was_cut), how, &reuse);
    if (!o_.record.string().empty()) save(record, was_cut);
    if (o_.notes != nullptr) o_.notes->reuse = reuse, o_.notes->seed = record.rng.seed;
    sampling = {record.rng, record.options, was_cut};
    return out;
  }
  void save(const StmcRecord<B>& record, bool was_cut) const {
    save_stmc_record(o_.record, record, model_, {{"cut_texts", was_cut ? "1" : "0"}});
  }

  const Stmc<B, D, E>& model_;
  const GenerateOptions& o_;
  StmcOptions how_{};
  Motion clip_{};
  std::vector<typename B::scalar> clip_rows_{};
  Index clip_frames_ = 0;  // that the features have
};

}  // namespace detail

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Motion> generate_motions(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                                     const GenerateOptions& options) {
  return detail::GenerateRun<B, D, E>(stmc, options)(timelines);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Motion generate_motion(const Stmc<B, D, E>& stmc, const Timeline& timeline, const GenerateOptions& options) {
  return generate_motions(stmc, std::span(&timeline, 1), options).front();
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#endif

#endif
#elif defined(MOTIONLANG_TEXT_BACKEND_DETAIL_KERNELS_INC)  // <motionlang/backend/detail/kernels.inc>
// All kernels for one instruction set, and their table. Included by kernels.hpp, several times.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail::MOTIONLANG_ISA {

// Vectors of MOTIONLANG_VECTOR_BYTES bytes in the compiler's own vector types, and the elementary functions on them.
// Included once for every instruction set by kernels.hpp; no include guard on purpose.

template <class S>
struct VectorOf {
  typedef S type __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
  typedef S loose __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES), aligned(sizeof(S)), may_alias));
  using bits = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
  typedef bits mask __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
};
template <class S>
using Vec = typename VectorOf<S>::type;
template <class S>
using Mask = typename VectorOf<S>::mask;
template <class S>
inline constexpr int lanes = MOTIONLANG_VECTOR_BYTES / static_cast<int>(sizeof(S));

// Everything below is inlined: passing such vectors between functions would depend on the caller's instruction set.
#define MOTIONLANG_INLINE inline __attribute__((always_inline))

template <class S>
MOTIONLANG_INLINE Vec<S> load(const S* p) {
  return *reinterpret_cast<const typename VectorOf<S>::loose*>(p);
}
template <class S>
MOTIONLANG_INLINE void store(S* p, const Vec<S>& v) {
  *reinterpret_cast<typename VectorOf<S>::loose*>(p) = v;
}
/// Past the caches, to an address that is a multiple of the vector's size. Other threads see it after `end_of_streams`.
template <class S>
MOTIONLANG_INLINE void store_stream(S* p, const Vec<S>& v) {
#if defined(__clang__)
  __builtin_nontemporal_store(v, reinterpret_cast<Vec<S>*>(p));
#elif defined(__x86_64__)
  auto* at = reinterpret_cast<float*>(p);
#if MOTIONLANG_VECTOR_BYTES == 64
  __builtin_ia32_movntps512(at, (Vec<float>)v);
#elif MOTIONLANG_VECTOR_BYTES == 32
  __builtin_ia32_movntps256(at, (Vec<float>)v);
#else
  __builtin_ia32_movntps(at, (Vec<float>)v);
#endif
#else
  store(p, v);
#endif
}
/// Asks for n numbers that are read soon.
template <class Number>
MOTIONLANG_INLINE void fetch(const Number* x, Index n) {
  for (Index i = 0; i < n; i += 64 / static_cast<Index>(sizeof(Number))) __builtin_prefetch(x + i);
}
MOTIONLANG_INLINE void end_of_streams() {
#if defined(__x86_64__)
  __builtin_ia32_sfence();
#endif
}
template <class S>
MOTIONLANG_INLINE Vec<S> splat(S x) {
  return x - Vec<S>{};
}
template <class S>
MOTIONLANG_INLINE Vec<S> load_some(const S* p, Index n) {  // lanes n and above are 0
  alignas(MOTIONLANG_VECTOR_BYTES) S t[static_cast<std::size_t>(lanes<S>)] = {};
  for (Index i = 0; i < n && i < lanes<S>; ++i) t[i] = p[i];
  return load(t);
}
/// The first n numbers (all lanes if there are that many), then zeros; nothing is read if n <= 0.
template <class S>
MOTIONLANG_INLINE Vec<S> load_first(const S* p, Index n) {
  return n >= lanes<S> ? load(p) : load_some(p, n);
}
template <class S>
MOTIONLANG_INLINE void store_some(S* p, const Vec<S>& v, Index n) {
  for (Index i = 0; i < n && i < lanes<S>; ++i) p[i] = v[i];
}
template <class S>
MOTIONLANG_INLINE void store_first(S* p, const Vec<S>& v, Index n) {
  n >= lanes<S> ? store(p, v) : store_some(p, v, n);
}
// The larger and the smaller of two; b where either is NaN, so a bound comes first and data second.
// (Where one of them is a constant, GCC 12 makes two instructions of it for vectors of 64 bytes.)
template <class S>
MOTIONLANG_INLINE Vec<S> vmax(const Vec<S>& a, const Vec<S>& b) {
#if MOTIONLANG_VECTOR_BYTES == 64 && !defined(__clang__)
  if constexpr (sizeof(S) == 4) {
    Vec<S> r;
    asm("vmaxps %2, %1, %0" : "=v"(r) : "v"(a), "vm"(b));
    return r;
  }
#endif
  return a > b ? a : b;
}
template <class S>
MOTIONLANG_INLINE Vec<S> vmin(const Vec<S>& a, const Vec<S>& b) {
#if MOTIONLANG_VECTOR_BYTES == 64 && !defined(__clang__)
  if constexpr (sizeof(S) == 4) {
    Vec<S> r;
    asm("vminps %2, %1, %0" : "=v"(r) : "v"(a), "vm"(b));
    return r;
  }
#endif
  return a < b ? a : b;
}
/// Lanes of `found` become negative where x is NaN or infinite: all bits of its exponent are set.
template <class S>
MOTIONLANG_INLINE void find_not_finite(const Vec<S>& x, Mask<S>& found) {
  constexpr auto exponent = detail::bit_cast<typename VectorOf<S>::bits>(std::numeric_limits<S>::infinity());
  found |= (~(Mask<S>)x & exponent) - 1;
}
template <class S>
MOTIONLANG_INLINE bool any_negative(const Mask<S>& v) {
  bool any = false;
  for (int i = 0; i < lanes<S>; ++i) any |= v[i] < 0;
  return any;
}
/// Lane i + half beside lane i, for the lower halves of blocks of 2 half lanes; the upper halves are of no account.
template <class S, int half, int... l>
MOTIONLANG_INLINE Vec<S> upper_lanes(const Vec<S>& v, std::integer_sequence<int, l...>) {
  return __builtin_shufflevector(v, v, (l + half) % lanes<S>...);
}
// Halves are put together until one lane is left: sums have a fixed order.
template <class S, int half = lanes<S> / 2>
MOTIONLANG_INLINE S reduce_add(const Vec<S>& v) {
  if constexpr (half == 0)
    return v[0];
  else
    return reduce_add<S, half / 2>(v + upper_lanes<S, half>(v, std::make_integer_sequence<int, lanes<S>>{}));
}
template <class S, int half = lanes<S> / 2>
MOTIONLANG_INLINE S reduce_max(const Vec<S>& v) {
  if constexpr (half == 0)
    return v[0];
  else
    return reduce_max<S, half / 2>(vmax<S>(v, upper_lanes<S, half>(v, std::make_integer_sequence<int, lanes<S>>{})));
}

/// Swaps the blocks off the diagonal: lane l + half of a with lane l of b, for every l without the bit `half`.
template <class S, int half, int... l>
MOTIONLANG_INLINE void swap_blocks(Vec<S>& a, Vec<S>& b, std::integer_sequence<int, l...>) {
  constexpr int n = lanes<S>;
  const Vec<S> upper = __builtin_shufflevector(a, b, ((l & half) != 0 ? n + l - half : l)...);
  b = __builtin_shufflevector(a, b, ((l & half) != 0 ? n + l : l + half)...);
  a = upper;
}
/// v[i][j] becomes v[j][i]: blocks of 1, 2, 4, ... lanes are swapped.
template <class S, int half = 1>
MOTIONLANG_INLINE void transpose_lanes(Vec<S>* v) {
  if constexpr (half < lanes<S>) {
#pragma GCC unroll 16
    for (int i = 0; i < lanes<S>; ++i) {
      if ((i & half) == 0) swap_blocks<S, half>(v[i], v[i + half], std::make_integer_sequence<int, lanes<S>>{});
    }
    transpose_lanes<S, 2 * half>(v);
  }
}

/// e^x for x <= 88 (709): x = n ln 2 + f, e^f by its series, 2^n by the exponent bits. Relative error below 1e-7
/// (1e-15). Results below the smallest normal number are 0. 2^n is a factor of its own, so that NaN stays NaN.
template <class S>
MOTIONLANG_INLINE Vec<S> vexp(const Vec<S>& x) {
  constexpr bool single = sizeof(S) == 4;
  constexpr S low = single ? S(-87) : S(-708), high = single ? S(88) : S(709);
  const Vec<S> c = vmin<S>(splat(high), x);
  // 1.5 * 2^23 (2^52), which rounds to an integer what it is added to, and the bias of exponents, which is then in the
  // lowest bits.
  const S magic = single ? S(12582912 + 127) : S(6755399441055744 + 1023);
  const Vec<S> shifted = c * S(1.4426950408889634) + magic;
  const Vec<S> n = shifted - magic;
  const Vec<S> f = (c - n * S(single ? 0.693359375 : 0.693147180369123816490)) -
                   n * S(single ? -2.12194440e-4 : 1.90821492927058770002e-10);
  Vec<S> p = splat(S(single ? 1.0 / 5040 : 1.0 / 6227020800.0));
  if constexpr (!single) {
    for (double k : {1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040})
      p = p * f + S(k);
  }
  for (double k : {1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0}) p = p * f + S(k);
  const Vec<S> power = (Vec<S>)((Mask<S>)shifted << (single ? 23 : 52));
  return x < splat(low) ? Vec<S>{} : p * power;  // so far below, n is nonsense
}

/// Float: (Phi(x) - 1/2) / x for y = x^2 <= 32, Phi being the normal distribution function: a rational function (our
/// own least-squares fit). Of Phi, 2e-8 is wrong by the fit; with what is rounded, below 2.5e-7.
template <class S>
MOTIONLANG_INLINE Vec<S> phi_ratio(const Vec<S>& y) {
  Vec<S> p = splat(S(2.1818830005316466e-08)), q = splat(S(1.1712714934253183e-06));
  p = p * y + S(6.364869382952854e-06);
  q = q * y + S(7.602274008301123e-05);
  p = p * y + S(0.00017693884114677917);
  q = q * y + S(0.0019305587808950675);
  p = p * y + S(0.004725908484413717);
  q = q * y + S(0.029119172061619288);
  p = p * y + S(0.0346923636272431);
  q = q * y + S(0.25362643899642984);
  p = p * y + S(0.3989422129894181);
  q = q * y + S(1);
  return p / q;
}
/// erf(x) = 2 Phi(sqrt(2) x) - 1. Float: absolute error below 5e-7. Double: libm.
template <class S>
MOTIONLANG_INLINE Vec<S> verf(const Vec<S>& x) {
  if constexpr (sizeof(S) == 4) {
    const Vec<S> c = vmin<S>(splat(S(4)), vmax<S>(splat(S(-4)), x));
    return c * phi_ratio<S>(c * c * S(2)) * S(2.8284271247461901);
  } else {
    Vec<S> r{};
    for (int i = 0; i < lanes<S>; ++i) r[i] = std::erf(x[i]);
    return r;
  }
}
#if MOTIONLANG_VECTOR_BYTES == 64
/// 32 numbers: lane i of the result is that which the lowest five bits of index[i] say.
MOTIONLANG_INLINE Vec<float> look_up(const float* table, const Vec<float>& index) {
  Vec<float> r = load(table);
  asm("vpermt2ps %2, %1, %0" : "+v"(r) : "v"(index), "v"(load(table + 16)));
  return r;
}
/// By gelu_table.hpp: absolute error below 1e-7 for x < 0, relative error below 5e-7 for x > 0.
MOTIONLANG_INLINE Vec<float> gelu_by_table(const Vec<float>& x) {
  static_assert(GeluTable::cells == 32 && GeluTable::width == 0.25);
  constexpr auto last = static_cast<float>(GeluTable::width * (GeluTable::cells - 1));
  Vec<float> c, d;
  asm("vrangeps $0xa, %2, %1, %0" : "=v"(c) : "v"(x), "v"(splat(last)));  // min(|x|, last)
  asm("vreduceps $0x24, %1, %0" : "=v"(d) : "v"(c));                      // c - i / 4, i = round(4 c)
  const Vec<float> i = c + 3145728.f;                                     // 1.5 * 2^21: i in the lowest bits
  const auto& table = gelu_table.by_power;
  Vec<float> g = look_up(table[GeluTable::degree], i);
#pragma GCC unroll 8
  for (int n = GeluTable::degree; n-- > 0;) g = g * d + look_up(table[n], i);
  return vmax<float>(Vec<float>{}, x) - g;
}
#endif
/// gelu(x) = x Phi(x) = x/2 + x (Phi(x) - 1/2). The last term is even in x, so that nothing need be bounded before it
/// is known. Float: by look_up where there is one; error below 3e-7 |x|. Of -inf: NaN or about 0.
template <class S>
MOTIONLANG_INLINE Vec<S> vgelu(const Vec<S>& x) {
#if MOTIONLANG_VECTOR_BYTES == 64
  if constexpr (sizeof(S) == 4) return gelu_by_table(x);
#endif
  const Vec<S> h = x * S(0.5);
  if constexpr (sizeof(S) == 4) {
    const Vec<S> y = x * x;
    return h + (y < splat(S(32)) ? y * phi_ratio<S>(y) : (Vec<S>)((Mask<S>)h & 0x7fffffff));
  } else {
    return h + h * verf<S>(x * S(0.70710678118654752));
  }
}

/// Square root of x >= 0: Newton's iteration for 1/sqrt(x) from an estimate by shifting the exponent; within 1 ulp.
template <class S>
MOTIONLANG_INLINE Vec<S> vsqrt(const Vec<S>& x) {
  constexpr bool single = sizeof(S) == 4;
  using Bits = typename VectorOf<S>::bits;
  Vec<S> y = (Vec<S>)(static_cast<Bits>(single ? 0x5F375A86 : 0x5FE6EB50C7B537A9) - ((Mask<S>)x >> 1));
  for (int i = 0; i < (single ? 3 : 5); ++i) y = y * (S(1.5) - x * S(0.5) * y * y);
  const Vec<S> r = x * y;
  return r + S(0.5) * y * (x - r * r);
}

/// Float: relative error below 3e-7; a polynomial near 0 (Cephes, Moshier 1992), 1 - 2 / (exp(2 |x|) + 1) elsewhere.
/// Double: libm.
template <class S>
MOTIONLANG_INLINE Vec<S> vtanh(const Vec<S>& x) {
  if constexpr (sizeof(S) == 4) {
    const Vec<S> y = x * x;
    Vec<S> p = y * S(-5.70498872745e-3) + S(2.06390887954e-2);
    for (double k : {-5.37397155531e-2, 1.33314422036e-1, -3.33332819422e-1}) p = p * y + S(k);
    const Vec<S> size = (Vec<S>)((Mask<S>)x & 0x7fffffff), far = S(1) - S(2) / (vexp<S>(size + size) + S(1));
    const Vec<S> positive = size < splat(S(0.625)) ? size + size * y * p : far;
    return (Vec<S>)((Mask<S>)positive | ((Mask<S>)x & ~0x7fffffff));
  } else {
    Vec<S> r{};
    for (int i = 0; i < lanes<S>; ++i) r[i] = std::tanh(x[i]);
    return r;
  }
}
//
// Nonlinearities and their derivatives. Which one it is, is asked once for many numbers: constants stay in registers.

template <Activation act, class S>
MOTIONLANG_INLINE Vec<S> apply_activation(const Vec<S>& x) {
  switch (act) {
    case Activation::none:
      return x;
    case Activation::relu:
      return vmax<S>(Vec<S>{}, x);
    case Activation::gelu:
      return vgelu<S>(x);
    case Activation::silu:
      return x / (vexp<S>(-x) + S(1));
    case Activation::tanh:
      return vtanh<S>(x);
    case Activation::quick_gelu:
      return x / (vexp<S>(x * S(-1.702)) + S(1));
    case Activation::gelu_new: {
      const Vec<S> h = x * S(0.5);
      return h * vtanh<S>((x + x * x * x * S(0.044715)) * S(0.79788456080286536)) + h;
    }
    case Activation::sigmoid:
      return S(1) / (vexp<S>(-x) + S(1));
  }
  return x;
}

/// Derivative at x.
///     gelu'(x) = Phi(x) + x phi(x),   silu'(x) = s + x s (1 - s),   sigmoid'(x) = s (1 - s) with s = 1 / (1 + exp(-x))
template <Activation act, class S>
MOTIONLANG_INLINE Vec<S> activation_slope(const Vec<S>& x) {
  switch (act) {
    case Activation::none:
      return splat(S(1));
    case Activation::relu:
      return x > Vec<S>{} ? splat(S(1)) : Vec<S>{};
    case Activation::gelu: {
      const Vec<S> phi = vexp<S>(x * x * S(-0.5)) * S(0.39894228040143268);
      return verf<S>(x * S(0.70710678118654752)) * S(0.5) + S(0.5) + x * phi;
    }
    case Activation::silu: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x);
      return s + x * s * (S(1) - s);
    }
    case Activation::tanh: {
      const Vec<S> t = vtanh<S>(x);
      return S(1) - t * t;
    }
    case Activation::quick_gelu: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x * S(1.702));
      return s + x * s * (S(1) - s) * S(1.702);
    }
    case Activation::gelu_new: {
      const Vec<S> t = vtanh<S>((x + x * x * x * S(0.044715)) * S(0.79788456080286536));
      return (t + S(1)) * S(0.5) + x * (S(1) - t * t) * (x * x * S(3 * 0.044715) + S(1)) * S(0.5 * 0.79788456080286536);
    }
    case Activation::sigmoid: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x);
      return s * (S(1) - s);
    }
  }
  return splat(S(1));
}

/// f.operator()<act>().
template <class F>
void with_activation(Activation act, const F& f) {
  switch (act) {
    case Activation::none:
      return f.template operator()<Activation::none>();
    case Activation::relu:
      return f.template operator()<Activation::relu>();
    case Activation::gelu:
      return f.template operator()<Activation::gelu>();
    case Activation::silu:
      return f.template operator()<Activation::silu>();
    case Activation::tanh:
      return f.template operator()<Activation::tanh>();
    case Activation::quick_gelu:
      return f.template operator()<Activation::quick_gelu>();
    case Activation::gelu_new:
      return f.template operator()<Activation::gelu_new>();
    case Activation::sigmoid:
      return f.template operator()<Activation::sigmoid>();
  }
}

/// y = act(x) for this many rows of `width` numbers, which begin ldx and ldy apart; y may be x.
template <class S>
void activate_rows(const S* x, Index ldx, Index rows, Index width, Activation act, S* y, Index ldy) {
  constexpr int l = lanes<S>;
  with_activation(act, [=]<Activation a>() {
    for (Index r = 0; r < rows; ++r) {
      const S* from = x + r * ldx;
      S* to = y + r * ldy;
      Index i = 0;
      for (; i + l <= width; i += l) store(to + i, apply_activation<a, S>(load(from + i)));
      if (i < width) store_some(to + i, apply_activation<a, S>(load_some(from + i, width - i)), width - i);
    }
  });
}
template <class S>
void activate(const S* x, Index n, Activation act, S* y) {
  activate_rows(x, n, 1, n, act, y, n);
}
/// dx = dy act'(x) for n numbers.
template <class S>
void activate_vjp(const S* x, const S* dy, Index n, Activation act, S* dx) {
  constexpr int l = lanes<S>;
  with_activation(act, [=]<Activation a>() {
    Index i = 0;
    for (; i + l <= n; i += l) store(dx + i, load(dy + i) * activation_slope<a, S>(load(x + i)));
    if (i < n) store_some(dx + i, load_some(dy + i, n - i) * activation_slope<a, S>(load_some(x + i, n - i)), n - i);
  });
}
//
// Matrix product with packed right-hand side: register tiles, cache blocks, epilogue in the tile.
//
//   Panels   B (k x n) is stored in panels of `panel_width` columns, k rows each: [panel][k][column], zero padded.
//   Tile     up to `tile_rows` rows of A times one panel, all sums in registers.
//   Block    up to 1024 of k at a time: rows of A stay in the second-level cache, beside one panel or a group of them.
//            If k is in several blocks, eight panels at a time: what the next 1024 of k are added to stays there as
//            well. (All panels at a time where A is copied first.)
//   Walk     a panel times all rows of the block, then the next panel. If the result is larger than the nearer caches
//            and k is one block: a tile's rows times a group of panels, then the next rows. So longer pieces of the
//            result's rows are written, one after the other: the lines under them, which come from memory first, the
//            processor fetches by itself, and fewer pages are in use.
//   Ahead    a tile asks for its part of C and of the residual before it begins, and with every k for a piece of what
//            follows: of the panels of the next group, be it of the product that follows, and, with the first group, of
//            the next rows of A.
//   Order    every element is summed over k in the same order, whatever the tile height, block or thread: same bits.

template <class S>
inline constexpr Index panel_width = 2 * lanes<S>;
inline constexpr Index tile_rows = MOTIONLANG_TILE_ROWS;
inline constexpr Index depth_block = 1024;
inline constexpr Index panel_block = 8;
inline constexpr Index most_tiles = 16;        // of rows in a block
inline constexpr Index near_caches = 4 << 20;  // bytes
// for rows of A, and as much for a group of panels
inline constexpr Index half_cache = 512 * 1024 * MOTIONLANG_VECTOR_BYTES / 64;
template <class S>
// of a tile of a transposed A, copied
inline constexpr Index tile_pitch = (tile_rows + lanes<S> - 1) / lanes<S>* lanes<S>;

template <class S>
constexpr Index bytes(Index count) {
  return count * static_cast<Index>(sizeof(S));
}
template <class S>
const std::byte* as_bytes(const S* x) {
  return reinterpret_cast<const std::byte*>(x);
}

/// Rows of A, `row_bytes` each, in a block of this many bytes: at most most_tiles tiles.
constexpr Index rows_at_once(Index row_bytes, Index tile, Index bytes) {
  return std::clamp<Index>(bytes / std::max<Index>(1, row_bytes) / tile, 1, most_tiles) * tile;
}

/// Rows k0 ... k1-1 of all panels of B, whose element (k, n) is b[k * stride + n].
template <class S>
void pack_rows(const S* b, Index k, Index n, Index stride, Index k0, Index k1, S* panels) {
  constexpr Index w = panel_width<S>, l = lanes<S>;
  constexpr Index ahead = 8;  // rows
  for (Index i = k0; i < k1; ++i) {
    const S* in = b + i * stride;
    S* out = panels + i * w;
    for (Index columns = n; columns > 0; columns -= w, in += w, out += k * w) {
      __builtin_prefetch(in + ahead * stride), __builtin_prefetch(in + ahead * stride + l);
      store(out, load_first(in, columns)), store(out + l, load_first(in + l, columns - l));
    }
  }
}
/// Panels first ... last-1 of B, whose element (k, n) is b[k + n * stride]: read along its rows, a square of lanes at a
/// time. Whether all numbers are finite, if it looks.
template <class S, bool looks>
bool pack_transposed(const S* b, Index k, Index n, Index stride, Index first, Index last, S* panels) {
  constexpr Index w = panel_width<S>, l = lanes<S>;
  Mask<S> found{};
  for (Index j = first; j < last; ++j) {
    S* out = panels + j * k * w;
    const Index columns = n - j * w;
    const S* in = b + j * w * stride;
    for (Index i = 0; i < k; i += l) {
      const Index rows = k - i < l ? k - i : l;
      for (Index c = 0; c < w; c += l) {
        Vec<S> square[lanes<S>];
#pragma GCC unroll 16
        for (int q = 0; q < lanes<S>; ++q) {
          const S* from = in + (c + q) * stride + i;
          square[q] = load_first(from, c + q < columns ? rows : 0);
          if constexpr (looks) find_not_finite<S>(square[q], found);
        }
        transpose_lanes<S>(square);
        for (Index r = 0; r < rows; ++r) store(out + (i + r) * w + c, square[r]);
      }
    }
  }
  return !any_negative<S>(found);
}

/// Rows of A, whose element (i, k) is at[i * stride + k], or, when transposed, at[i + k * stride].
template <class S>
struct Rows {
  const S* at;
  Index stride;
  bool transposed;

  Rows from(Index row) const { return {at + row * (transposed ? 1 : stride), stride, transposed}; }
  Rows from_depth(Index k) const { return {at + k * (transposed ? stride : 1), stride, transposed}; }
};

/// Memory that is read after a tile. It is fetched into the second-level cache: `step` bytes, a line at most, for
/// every row of the panel (bfloat16: pair of rows). What is more than that is left. So where a row is two lines long, a
/// tile alone fetches the first half of the next panel only: every other line of the whole would confuse the processor,
/// which fetches by itself lines that follow each other (20 % slower from memory).
struct Ahead {
  const std::byte* at = nullptr;
  Index step = 0;

  /// Share i of n of `bytes` that begin at `next`, in this many steps: shares rather overlap than leave bytes between
  /// them.
  MOTIONLANG_INLINE static Ahead share(const std::byte* next, Index bytes, Index i, Index n, Index steps) {
    const Index all = std::max<Index>(1, n * steps), step = std::min<Index>(64, (bytes + all - 1) / all);
    return {next + i * step * steps, step};
  }
  MOTIONLANG_INLINE void fetch() { __builtin_prefetch(at, 0, 2), at += step; }
};

/// The end of a tile: add earlier sums (if k is split), bias and residual, then apply the nonlinearity.
template <class S>
struct Epilogue {
  bool accumulate = false;
  const S* bias = nullptr;      // of the panel's first column
  const S* residual = nullptr;  // of the tile's first element
  Index residual_stride = 0;
  Activation act = Activation::none;

  /// The epilogue of the tile at a row and column of a product; `first` and `last` mark blocks of k.
  static Epilogue of(const Gemm<S>& g, Index row, Index column, bool first, bool last) {
    Epilogue e{.accumulate = !first};
    if (!last) return e;
    e.act = g.act;
    if (g.bias != nullptr) e.bias = g.bias + column;
    if (g.residual != nullptr) e.residual = g.residual + row * g.ldr + column, e.residual_stride = g.ldr;
    return e;
  }
  Epilogue from_column(Index column) const {
    Epilogue e = *this;
    if (bias != nullptr) e.bias += column;
    if (residual != nullptr) e.residual += column;
    return e;
  }
  Epilogue from_row(Index row) const {
    Epilogue e = *this;
    if (residual != nullptr) e.residual += row * residual_stride;
    return e;
  }
};

/// Asks for the rows of c and of the residual that a tile is put into.
template <class S, int R>
MOTIONLANG_INLINE void fetch_result(const S* c, Index ldc, const Epilogue<S>& e) {
  constexpr int l = lanes<S>;
  for (int i = 0; i < R; ++i) __builtin_prefetch(c + i * ldc, 1), __builtin_prefetch(c + i * ldc + l, 1);
  if (e.residual == nullptr) return;
  for (int i = 0; i < R; ++i) {
    const S* row = e.residual + i * e.residual_stride;
    __builtin_prefetch(row), __builtin_prefetch(row + l);
  }
}

/// put_result for the last columns of a matrix, when they do not fill a panel: two vectors of sums for every row.
template <class S>
[[gnu::noinline]] void put_narrow_result(const Vec<S>* sums, int rows, S* c, Index ldc, Index columns,
                                         const Epilogue<S>& e) {
  constexpr Index l = lanes<S>;
  for (Index r = 0; r < rows; ++r) {
    for (Index i = 0; i < columns; i += l) {
      const Index n = columns - i;
      S* out = c + r * ldc + i;
      Vec<S> x = sums[2 * r + i / l];
      if (e.accumulate) x += load_first(out, n);
      if (e.bias != nullptr) x += load_first(e.bias + i, n);
      if (e.residual != nullptr) x += load_first(e.residual + r * e.residual_stride + i, n);
      store_first(out, x, n);
    }
  }
}

/// c (R x columns) = the sums of a tile, c0 and c1 being its two vectors of columns.
template <class S, int R>
MOTIONLANG_INLINE void put_result(Vec<S>* c0, Vec<S>* c1, S* c, Index ldc, Index columns, const Epilogue<S>& e) {
  constexpr int l = lanes<S>;
  if (columns >= 2 * l) {
    const Vec<S> z0 = e.bias == nullptr ? Vec<S>{} : load(e.bias), z1 = e.bias == nullptr ? Vec<S>{} : load(e.bias + l);
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      S* out = c + i * ldc;
      if (e.accumulate) c0[i] += load(out), c1[i] += load(out + l);
      c0[i] += z0, c1[i] += z1;
      if (e.residual != nullptr)
        c0[i] += load(e.residual + i * e.residual_stride), c1[i] += load(e.residual + i * e.residual_stride + l);
      store(out, c0[i]), store(out + l, c1[i]);
    }
  } else {
    Vec<S> sums[static_cast<std::size_t>(2 * R)];
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) sums[2 * i] = c0[i], sums[2 * i + 1] = c1[i];
    put_narrow_result(sums, R, c, ldc, columns, e);
  }
  if (e.act != Activation::none) activate_rows<S>(c, ldc, R, std::min(columns, 2 * Index{l}), e.act, c, ldc);
}

/// The kinds of tiles: A as stored, A transposed, or A as stored times only the first half of a panel.
enum class TileKind { plain, transposed, half };

/// c (R x columns) = a (R x k) panel.
template <class S, int R, TileKind kind>
void tile(const Rows<S>& a, const S* panel, Index k, S* c, Index ldc, Index columns, const Epilogue<S>& e,
          Ahead ahead) {
  constexpr Index w = panel_width<S>;
  constexpr int l = lanes<S>;
  constexpr bool transposed = kind == TileKind::transposed, half = kind == TileKind::half;
  Vec<S> c0[R], c1[R];
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<S>{};
  fetch_result<S, R>(c, ldc, e);
  // Rows in groups of three behind five pointers: one address register each, the rest is addressing mode. One of the
  // strides is known to be 1, which saves additions (1 to 4 % of the time).
  const Index row_stride = transposed ? 1 : a.stride, depth_stride = transposed ? a.stride : 1;
  const S *p0 = a.at, *p1 = p0 + 3 * row_stride, *p2 = p0 + 6 * row_stride, *p3 = p0 + 9 * row_stride,
          *p4 = p0 + 12 * row_stride;
#pragma GCC unroll 2
  for (Index at = 0; at < k; ++at) {
    if constexpr (transposed) __builtin_prefetch(p0 + 16 * depth_stride);
    const Vec<S> b0 = load(panel), b1 = half ? Vec<S>{} : load(panel + l);
    panel += w;
    __builtin_prefetch(panel + 16 * w);
    __builtin_prefetch(panel + 16 * w + l);
    ahead.fetch();
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      const S x = i < 3    ? p0[i * row_stride]
                  : i < 6  ? p1[(i - 3) * row_stride]
                  : i < 9  ? p2[(i - 6) * row_stride]
                  : i < 12 ? p3[(i - 9) * row_stride]
                           : p4[(i - 12) * row_stride];
      c0[i] += x * b0;
      if constexpr (!half) c1[i] += x * b1;
    }
    p0 += depth_stride, p1 += depth_stride, p2 += depth_stride, p3 += depth_stride, p4 += depth_stride;
  }
  put_result<S, R>(c0, c1, c, ldc, columns, e);
}

template <class S>
using TileFunction = void (*)(const Rows<S>&, const S*, Index, S*, Index, Index, const Epilogue<S>&, Ahead);
/// The tile of this many rows for what is left of the columns.
template <class S>
TileFunction<S> tile_of(Index rows, bool transposed, Index columns) {
  static constexpr auto table = []<int... R>(std::integer_sequence<int, R...>) {
    return std::array{std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::plain>...},
                      std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::transposed>...},
                      std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::half>...}};
  }
  (std::make_integer_sequence<int, MOTIONLANG_TILE_ROWS>{});
  const TileKind kind = transposed ? TileKind::transposed : columns <= lanes<S> ? TileKind::half : TileKind::plain;
  return table[static_cast<std::size_t>(kind)][static_cast<std::size_t>(rows - 1)];
}

/// First row of part i of n nearly equal parts.
MOTIONLANG_INLINE Index part(Index rows, Index i, Index n) { return rows * i / n; }

/// How a product over k is split: pieces of k, and rows of A at a time.
template <class S>
struct Blocks {
  Index count, rows;

  explicit Blocks(Index k)
      : count(k == 0 ? 1 : (k + depth_block - 1) / depth_block),
        rows(rows_at_once(bytes<S>((k + count - 1) / count), tile_rows, half_cache)) {}
};
template <class S>
Index gemm_rows(Index k) {
  return Blocks<S>(k).rows;
}
/// Numbers of scratch that gemm_block needs.
template <class S>
Index gemm_scratch(Index k) {
  return Blocks<S>(k).rows / tile_rows * tile_pitch<S> * (std::min(k, depth_block) + 16);
}

/// `rows` rows of a transposed A (`depth` of k) tile by tile, [tile][k][row], so that a tile reads one line after the
/// other. `readable`: rows that A has from here on.
template <class S>
void copy_tiles(const S* a, Index lda, Index depth, Index rows, Index readable, S* out) {
  constexpr Index pitch = tile_pitch<S>, l = lanes<S>;
  const Index tiles = (rows + tile_rows - 1) / tile_rows;
  for (Index k = 0; k < depth; ++k, a += lda, out += pitch) {
    if (k + 16 < depth) fetch(a + 16 * lda, rows);  // no prefetcher follows pieces so far apart
    for (Index t = 0; t < tiles; ++t) {
      const Index first = part(rows, t, tiles);
      for (Index i = 0; i < pitch; i += l)
        store(out + t * depth * pitch + i, load_first(a + first + i, readable - first - i));
    }
  }
}

/// The block that is computed at a time: of k the part k0 ... k1-1 of rows top ... below-1 times panels left ...
/// right-1.
template <class S>
struct GemmPiece {
  static constexpr Index w = panel_width<S>;
  const Gemm<S>& g;
  S* scratch;
  bool copies, far;                   // rows of A are copied as they are; the result is larger than the nearer caches
  Index top = 0, below = 0, end = 0;  // end: of the rows that the thread goes on with
  Index left = 0, right = 0;
  Index k0 = 0, k1 = 0;
  // panels that are read after it: at last the first ones once more, if nothing else is known
  const std::byte* next = nullptr;
  Index next_bytes = std::numeric_limits<Index>::max();

  Index depth() const { return k1 - k0; }
  Index pitch() const { return depth() + 16; }
  const S* slice(Index panel) const { return g.panels + (panel * g.k + k0) * w; }

  Rows<S> rows_of(Index tile, Index row) const {
    if (g.a_transposed) return {scratch + tile * depth() * tile_pitch<S>, tile_pitch<S>, true};
    if (copies) return {scratch + (row - top) * pitch(), pitch(), false};
    return {g.a + row * g.lda + k0, g.lda, false};
  }
  void copy_rows(Index first, Index last) const {
    for (Index r = first; r < last; ++r) {
      std::memcpy(scratch + (r - top) * pitch(), g.a + r * g.lda + k0, static_cast<std::size_t>(bytes<S>(depth())));
    }
  }

  void multiply() const {
    const Index depth = this->depth(), tiles = (below - top + tile_rows - 1) / tile_rows;
    const bool whole = depth == g.k, transposed = g.a_transposed;
    const Index together = far && whole ? std::max<Index>(1, half_cache / std::max<Index>(1, bytes<S>(depth * w))) : 1;
    const Index groups = (right - left + together - 1) / together;
    // Rows that are copied: all at once if the result stays in the caches (3 % faster at 408 x 1024 x 512), else a
    // tile's when it is next.
    if (transposed)
      copy_tiles<S>(g.a + k0 * g.lda + top, g.lda, depth, below - top, g.m - top, scratch);
    else if (copies && !far)
      copy_rows(top, below);
    for (Index group = 0; group < groups; ++group) {
      const Index j0 = left + part(right - left, group, groups), j1 = left + part(right - left, group + 1, groups);
      const Index panels = j1 - j0, panel_bytes = bytes<S>(panels * depth * w);
      const std::byte* next_panels = j1 < right ? as_bytes(slice(j1)) : next;
      const Index next_panel_bytes = j1 < right ? panel_bytes : std::min(panel_bytes, next_bytes);
      for (Index t = 0, row = top, height; t < tiles; ++t, row += height) {
        height = top + part(below - top, t + 1, tiles) - row;
        const Index next_row = row + height;
        if (copies && far && group == 0) copy_rows(row, next_row);
        // With half of the first panels the next rows are fetched, if they lie together. (With one panel at a time:
        // none.)
        const bool fetches_rows = group == 0 && !transposed && g.lda <= g.k && next_row < end;
        const Index row_panels = fetches_rows ? panels / 2 : 0, rest = panels - row_panels;
        const Index next_row_bytes = bytes<S>(std::min(height, end - next_row) * g.lda);
        for (Index i = 0; i < panels; ++i) {
          const Index j = j0 + i, columns = g.n - j * w;
          const Ahead ahead =
              i < row_panels
                  ? Ahead::share(as_bytes(g.a + next_row * g.lda), next_row_bytes, i, row_panels, depth)
                  : Ahead::share(next_panels, next_panel_bytes, t * rest + i - row_panels, tiles * rest, depth);
          S* c = g.c + row * g.ldc + j * w;
          const auto e = Epilogue<S>::of(g, row, j * w, k0 == 0, k1 == g.k);
          tile_of<S>(height, transposed, columns)(rows_of(t, row), slice(j), depth, c, g.ldc, columns, e, ahead);
        }
      }
    }
  }
};

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product.
template <class S>
void gemm_block(const Gemm<S>& g, Index r0, Index r1, Index j0, Index j1, S* scratch) {
  const Blocks<S> split(g.k);
  const Index blocks = split.count, row_blocks = (r1 - r0 + split.rows - 1) / split.rows;
  // Rows of A whose distance is a multiple of the page size fall into the same cache set: they are copied side by side,
  // once.
  const bool copies = !g.a_transposed && bytes<S>(g.lda) % 4096 == 0;
  const bool all_panels = copies || g.a_transposed || blocks == 1;
  const Index wide = all_panels ? std::max<Index>(1, j1 - j0) : panel_block, pieces = (j1 - j0 + wide - 1) / wide;
  const bool far = bytes<S>(g.m * g.n) > near_caches;
  for (Index i = 0; i < row_blocks * pieces * blocks; ++i) {
    const Index row_block = i / blocks / pieces, left = j0 + i / blocks % pieces * wide, block = i % blocks;
    GemmPiece<S> piece{.g = g,
                       .scratch = scratch,
                       .copies = copies,
                       .far = far,
                       .top = r0 + part(r1 - r0, row_block, row_blocks),
                       .below = r0 + part(r1 - r0, row_block + 1, row_blocks),
                       .end = r1,
                       .left = left,
                       .right = std::min(j1, left + wide),
                       .k0 = part(g.k, block, blocks),
                       .k1 = part(g.k, block + 1, blocks)};
    const bool next_columns = block + 1 == blocks, next_rows = next_columns && piece.right == j1,
               last = next_rows && piece.below == r1;
    const S* next = g.panels + ((next_rows      ? j0
                                 : next_columns ? piece.right
                                                : left) *
                                    g.k +
                                (next_columns ? 0 : piece.k1)) *
                                   piece.w;
    piece.next = last ? g.following(j0, (g.n + piece.w - 1) / piece.w, next) : as_bytes(next);
    if (last && g.after != nullptr) piece.next_bytes = g.after_bytes;
    piece.multiply();
  }
}
//
// Attention of one head over one sequence, forward and backward. The score matrix exists for one tile of rows (forward)
// or one head (backward), never for a batch.
//
//   S = Q K^T / sqrt(width),   P = softmax(S),   O = P V
//   dV = P^T dO,   dP = dO V^T,   dS = P (dP - rowsum(P dP)),   dQ = dS K / sqrt(width),   dK = dS^T Q / sqrt(width)

/// Softmax of R rows of `n` scores times `scale`, in place; columns up to the next vector are set to 0.
/// `visible[i]` columns of row i take part (causal attention), the rest are 0. Several rows are as many chains of sums:
/// none waits.
template <class S, int R>
MOTIONLANG_INLINE void softmax_rows_at(S* rows, Index pitch, Index n, const Index* visible, S scale) {
  constexpr int l = lanes<S>;
  const Index padded = (n + l - 1) / l * l;
  constexpr S hidden = sizeof(S) == 4 ? S(-1e30) : S(-1e300);
  Vec<S> largest[R], sum[R], inverse[R];
  S shift[R];
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) {
    for (Index c = visible[i]; c < padded; ++c) rows[i * pitch + c] = hidden;
    largest[i] = splat(hidden), sum[i] = Vec<S>{};
  }
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) largest[i] = vmax<S>(largest[i], load(rows + i * pitch + c));
  }
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) shift[i] = reduce_max<S>(largest[i]) * scale;
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      const Vec<S> e = vexp<S>(load(rows + i * pitch + c) * scale - shift[i]);
      store(rows + i * pitch + c, e);
      sum[i] += e;
    }
  }
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) inverse[i] = splat(S(1) / reduce_add<S>(sum[i]));
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) store(rows + i * pitch + c, load(rows + i * pitch + c) * inverse[i]);
  }
}
inline constexpr int softmax_group = 4;  // of rows
/// The same for `count` rows, the first of which is query `first`; causal: row i sees keys up to its own number.
template <class S>
void softmax_rows_of(S* rows, Index pitch, Index count, Index n, Index first, bool causal, S scale) {
  for (Index r = 0; r < count;) {
    Index visible[softmax_group];
    for (int i = 0; i < softmax_group; ++i) visible[i] = causal ? std::min(n, first + r + i + 1) : n;
    if (r + softmax_group <= count)
      softmax_rows_at<S, softmax_group>(rows + r * pitch, pitch, n, visible, scale), r += softmax_group;
    else
      softmax_rows_at<S, 1>(rows + r * pitch, pitch, n, visible, scale), ++r;
  }
}

/// y = x times the factors of Dropout (core/dropout.hpp) at positions first, first + 1, ...; its own derivative.
template <class S>
void dropout(const S* x, Index n, Index first, const Dropout& d, S* y) {
  typedef std::uint32_t Bits __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
  constexpr Index l = MOTIONLANG_VECTOR_BYTES / 4;
  const std::uint32_t limit = d.limit();
  const auto key0 = static_cast<std::uint32_t>(d.key) +
                    static_cast<std::uint32_t>(static_cast<std::uint64_t>(first) >> 32) * 0x27D4EB2Fu;
  const auto key1 = static_cast<std::uint32_t>(d.key >> 32);
  const S keep = static_cast<S>(1.0 / (1.0 - d.p));
  Bits counter;
  for (Index i = 0; i < l; ++i) counter[i] = static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(i);
  for (Index i = 0; i < n; i += l, counter += static_cast<std::uint32_t>(l)) {
    Bits h = counter * 0x9E3779B1u + key0;
    h = (h ^ (h >> 16)) * 0x85EBCA6Bu + key1;
    h = (h ^ (h >> 13)) * 0xC2B2AE35u;
    h = h ^ (h >> 16);
    if (sizeof(S) == 4 && i + l <= n) {
      const Vec<S> kept = load(x + i) * keep;
      store(y + i, (Mask<S>)(h >= limit) ? kept : Vec<S>{});
    } else {
      for (Index c = 0; c < l && i + c < n; ++c) y[i + c] = h[c] >= limit ? x[i + c] * keep : S(0);
    }
  }
}

template <class S>
MOTIONLANG_INLINE Index padded_panels(Index n) {
  return (n + panel_width<S> - 1) / panel_width<S>;
}

/// The products of attention in S. (Bf16Products is the other kind.)
template <class S>
struct FloatProducts {
  using Number = S;
  static constexpr Index rows = tile_rows;  // that products are fastest with
  static void begin() {}
  static void end() {}
  /// Columns that products write of n.
  static Index columns(Index n) { return padded_panels<S>(n) * panel_width<S>; }
  /// Numbers of scratch: panels of a matrix (k, n), and what a product over k needs.
  static Index panels(Index k, Index n) { return columns(n) * k; }
  static Index scratch(Index) { return 0; }

  static void pack(const S* b, Index k, Index n, Index stride_k, Index stride_n, S* panels) {
    if (stride_n == 1)
      pack_rows(b, k, n, stride_k, Index{0}, k, panels);
    else
      pack_transposed<S, false>(b, k, n, stride_n, Index{0}, padded_panels<S>(n), panels);
  }
  /// c = a panels, tile by tile, without blocks of k (all operands are in cache).
  static void multiply(const Rows<S>& a, Index count, Index k, const S* panels, Index n, S* c, Index ldc, S*,
                       bool whole_panels) {
    constexpr Index w = panel_width<S>;
    const Index tiles = (count + tile_rows - 1) / tile_rows;
    const Epilogue<S> plain;
    for (Index j = 0; j < padded_panels<S>(n); ++j) {
      for (Index t = 0; t < tiles; ++t) {
        const Index first = part(count, t, tiles), height = part(count, t + 1, tiles) - first;
        tile_of<S>(height, a.transposed, n - j * w)(a.from(first), panels + j * k * w, k, c + first * ldc + j * w, ldc,
                                                    whole_panels ? w : n - j * w, plain, Ahead{as_bytes(panels)});
      }
    }
  }
};

/// One head over one sequence: where its rows begin. Rows of q, k, v have the strides of the tensors that they are
/// columns of.
template <class S>
struct AttentionHead {
  const Attention<S>& t;
  Index head, q0, k0, queries, keys;
  const S *q, *k, *v;

  AttentionHead(const Attention<S>& a, Index sequence, Index head_number)
      : t(a),
        head(head_number),
        q0(a.q_offsets[sequence]),
        k0(a.k_offsets[sequence]),
        queries(a.q_offsets[sequence + 1] - q0),
        keys(a.k_offsets[sequence + 1] - k0),
        q(a.q + q0 * a.q_stride + head * a.width),
        k(a.k + k0 * a.k_stride + head * a.width),
        v(a.v + k0 * a.v_stride + head * a.width) {}

  S scale() const { return S(1) / std::sqrt(static_cast<S>(t.width)); }
  /// Scores of `count` queries from `first` on, q k^T, become their rows of P: relative scores, softmax, dropout.
  void weights(Index first, Index count, S* rows, Index pitch) const {
    const S unscale = std::sqrt(static_cast<S>(t.width));
    for (Index r = 0; r < count && t.relative_scores != nullptr; ++r) {
      const S* relative = t.relative_scores + head * (2 * t.reach + 1) + t.reach - (first + r);
      for (Index c = 0; c < keys; ++c) rows[r * pitch + c] += relative[c] * unscale;
    }
    softmax_rows_of(rows, pitch, count, keys, first, t.causal, scale());
    for (Index r = 0; r < count && t.dropout.p > 0; ++r)
      dropout(rows + r * pitch, keys, mask_at(first + r), t.dropout, rows + r * pitch);
  }
  Index mask_at(Index query) const {
    return static_cast<Index>(Dropout::attention_position(q0 + query, t.heads, head, 0));
  }
};

/// Distance of rows of scores, whose columns up to the end of a panel are written.
template <class P>
Index score_pitch(Index keys) {
  return P::columns(keys) + 16;
}
/// Numbers of scratch that attention_head needs: K^T, V, and one tile of scores.
template <class P>
Index attention_scratch(Index keys, Index width) {
  return P::panels(width, keys) + P::panels(keys, width) + P::rows * score_pitch<P>(keys) +
         P::scratch(std::max(keys, width));
}
/// Numbers of scratch that attention_head_vjp needs, whose scores are those of all queries.
template <class P>
Index attention_vjp_scratch(Index queries, Index keys, Index width) {
  const Index longest = std::max(keys, queries);
  return P::panels(width, keys) + P::panels(longest, width) + 2 * queries * score_pitch<P>(keys) +
         P::scratch(std::max(longest, width));
}

/// Output of one head, for one of this many pieces of its queries.
template <class P, class S = typename P::Number>
void attention_head(const Attention<S>& t, Index sequence, Index head, Index piece, Index pieces, S* kt) {
  const AttentionHead<S> h(t, sequence, head);
  const Index tiles = (h.queries + P::rows - 1) / P::rows, begin = part(tiles, piece, pieces),
              end = part(tiles, piece + 1, pieces);
  if (begin == end) return;
  const Index pitch = score_pitch<P>(h.keys);
  S* vp = kt + P::panels(t.width, h.keys);
  S* scores = vp + P::panels(h.keys, t.width);
  S* scratch = scores + P::rows * pitch;
  S* o = t.o + h.q0 * t.o_stride + head * t.width;
  P::pack(h.k, t.width, h.keys, Index{1}, t.k_stride, kt);  // K^T
  P::pack(h.v, h.keys, t.width, t.v_stride, Index{1}, vp);
  P::begin();
  for (Index i = begin; i < end; ++i) {
    const Index first = part(h.queries, i, tiles), rows = part(h.queries, i + 1, tiles) - first;
    P::multiply({h.q + first * t.q_stride, t.q_stride, false}, rows, t.width, kt, h.keys, scores, pitch, scratch, true);
    h.weights(first, rows, scores, pitch);
    P::multiply({scores, pitch, false}, rows, h.keys, vp, t.width, o + first * t.o_stride, t.o_stride, scratch, false);
  }
  P::end();
}

/// Gradients of one head; dq, dk, dv are written, with the strides of q, k, v.
template <class P, class S = typename P::Number>
void attention_head_vjp(const Attention<S>& t, const AttentionGradients<S>& g, Index sequence, Index head, S* a) {
  constexpr int l = lanes<S>;
  const AttentionHead<S> h(t, sequence, head);
  const Index queries = h.queries, keys = h.keys, width = t.width, pitch = score_pitch<P>(keys);
  const S* d_o = g.d_o + h.q0 * t.o_stride + head * width;
  const S scale = h.scale();
  S* b = a + P::panels(width, keys);  // panels with the keys or queries as the summed index; a: K^T, then V^T
  S* p = b + P::panels(std::max(keys, queries), width);  // P, later P after dropout
  S* ds = p + queries * pitch;                           // dP, later dS
  S* scratch = ds + queries * pitch;
  P::begin();
  P::pack(h.k, width, keys, Index{1}, t.k_stride, a);
  P::multiply({h.q, t.q_stride, false}, queries, width, a, keys, p, pitch, scratch, true);
  P::pack(h.v, width, keys, Index{1}, t.v_stride, a);
  P::multiply({d_o, t.o_stride, false}, queries, width, a, keys, ds, pitch, scratch, true);
  for (Index r = 0; r < queries; ++r) {
    S *pr = p + r * pitch, *dr = ds + r * pitch;
    if (r % softmax_group == 0)
      softmax_rows_of(pr, pitch, std::min<Index>(softmax_group, queries - r), keys, r, t.causal, scale);
    if (t.dropout.p > 0) dropout(dr, keys, h.mask_at(r), t.dropout, dr);
    Vec<S> sum{};
    for (Index c = 0; c < keys; c += l) sum += load(pr + c) * load(dr + c);  // P is 0 beyond the keys
    const S mean = reduce_add<S>(sum);
    for (Index c = 0; c < keys; c += l) store(dr + c, load(pr + c) * (load(dr + c) - mean) * scale);
    if (t.dropout.p > 0) dropout(pr, keys, h.mask_at(r), t.dropout, pr);
  }
  S* dq = g.d_q + h.q0 * t.q_stride + head * width;
  S* dk = g.d_k + h.k0 * t.k_stride + head * width;
  S* dv = g.d_v + h.k0 * t.v_stride + head * width;
  P::pack(h.k, keys, width, t.k_stride, Index{1}, b);
  P::multiply({ds, pitch, false}, queries, keys, b, width, dq, t.q_stride, scratch, false);
  P::pack(h.q, queries, width, t.q_stride, Index{1}, b);
  P::multiply({ds, pitch, true}, keys, queries, b, width, dk, t.k_stride, scratch, false);
  P::pack(d_o, queries, width, t.o_stride, Index{1}, b);
  P::multiply({p, pitch, true}, keys, queries, b, width, dv, t.v_stride, scratch, false);
  P::end();
}
//
// Row-wise and element-wise kernels: layer norm, softmax, nonlinearities, sums, AdamW.

inline constexpr int norm_group = 4;  // rows at a time in layer norm
/// Means and 1 / sqrt(variance + eps) of R rows of n, side by side. Two passes: no cancellation. Several rows are as
/// many chains of sums: none waits.
template <class S, int R>
MOTIONLANG_INLINE void row_moments(const S* x, Index n, S eps, S* mean, S* rstd) {
  constexpr int l = lanes<S>;
  const Index whole = n / l * l;
  Vec<S> sum[R], square[R];
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) sum[r] = square[r] = Vec<S>{};
  for (Index i = 0; i < whole; i += l) {
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) sum[r] += load(x + r * n + i);
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    S total = reduce_add<S>(sum[r]);
    for (Index i = whole; i < n; ++i) total += x[r * n + i];
    mean[r] = total / static_cast<S>(n);
  }
  for (Index i = 0; i < whole; i += l) {
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> d = load(x + r * n + i) - mean[r];
      square[r] += d * d;
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    S variance = reduce_add<S>(square[r]);
    for (Index i = whole; i < n; ++i) variance += (x[r * n + i] - mean[r]) * (x[r * n + i] - mean[r]);
    rstd[r] = S(1) / std::sqrt(variance / static_cast<S>(n) + eps);
  }
}

/// layer_norm_rows of R rows.
template <class S, int R>
MOTIONLANG_INLINE void normalize_rows(const LayerNorm<S>& t, Index first) {
  constexpr int l = lanes<S>;
  const Index n = t.width, whole = n / l * l;
  const S* x = t.x + first * n;
  S* y = t.y + first * n;
  if (t.residual != nullptr) {
    const S* z = t.residual + first * n;
    for (Index i = 0; i < R * n; i += l)
      store_first(y + i, load_first(x + i, R * n - i) + load_first(z + i, R * n - i), R * n - i);
    x = y;
  }
  S mean[R], rstd[R];
  row_moments<S, R>(x, n, t.eps, mean, rstd);
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i), bias = load(t.bias + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      __builtin_prefetch(x + (R + r) * n + i);  // of the next rows
      store(y + r * n + i, (load(x + r * n + i) - mean[r]) * rstd[r] * weight + bias);
    }
  }
  for (Index i = whole; i < n; ++i) {
    for (int r = 0; r < R; ++r) y[r * n + i] = (x[r * n + i] - mean[r]) * rstd[r] * t.weight[i] + t.bias[i];
  }
}
/// y = (x + residual - mean) rstd weight + bias. The sum stands in y before it is normalized; there may be no residual.
template <class S>
void layer_norm_rows(const LayerNorm<S>& t, Index first, Index last) {
  for (; first + norm_group <= last; first += norm_group) normalize_rows<S, norm_group>(t, first);
  for (; first < last; ++first) normalize_rows<S, 1>(t, first);
}

/// layer_norm_rows_vjp of R rows.
template <class S, int R>
MOTIONLANG_INLINE void normalize_rows_vjp(const LayerNorm<S>& t, const S* dy, S* dx, S* moments, Index first) {
  constexpr int l = lanes<S>;
  const Index n = t.width, whole = n / l * l;
  const S *x = t.x + first * n, *g = dy + first * n;
  S* d = dx + first * n;
  S mean[R], rstd[R], h0[R], h1[R];
  row_moments<S, R>(x, n, t.eps, mean, rstd);
  Vec<S> sum_h[R], sum_hx[R];
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) sum_h[r] = sum_hx[r] = Vec<S>{};
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> h = load(g + r * n + i) * weight;
      sum_h[r] += h;
      sum_hx[r] += h * ((load(x + r * n + i) - mean[r]) * rstd[r]);
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    h0[r] = reduce_add<S>(sum_h[r]), h1[r] = reduce_add<S>(sum_hx[r]);
    for (Index i = whole; i < n; ++i) {
      const S h = g[r * n + i] * t.weight[i];
      h0[r] += h;
      h1[r] += h * ((x[r * n + i] - mean[r]) * rstd[r]);
    }
    h0[r] /= static_cast<S>(n);
    h1[r] /= static_cast<S>(n);
  }
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> xhat = (load(x + r * n + i) - mean[r]) * rstd[r];
      store(d + r * n + i, (load(g + r * n + i) * weight - h0[r] - xhat * h1[r]) * rstd[r]);
    }
  }
  for (int r = 0; r < R; ++r) {
    for (Index i = whole; i < n; ++i) {
      d[r * n + i] = (g[r * n + i] * t.weight[i] - h0[r] - (x[r * n + i] - mean[r]) * rstd[r] * h1[r]) * rstd[r];
    }
    moments[2 * (first + r)] = mean[r], moments[2 * (first + r) + 1] = rstd[r];
  }
}
/// dx = rstd (h - mean(h) - xhat mean(h xhat)),  h = dy weight,  xhat = (x - mean) rstd
template <class S>
void layer_norm_rows_vjp(const LayerNorm<S>& t, const S* dy, S* dx, S* moments, Index first, Index last) {
  for (; first + norm_group <= last; first += norm_group) normalize_rows_vjp<S, norm_group>(t, dy, dx, moments, first);
  for (; first < last; ++first) normalize_rows_vjp<S, 1>(t, dy, dx, moments, first);
}
/// dweight = sum over rows of dy xhat, dbias = sum of dy; columns first ... last-1.
template <class S>
void layer_norm_columns_vjp(const LayerNorm<S>& t, const S* dy, const S* moments, S* dweight, S* dbias, Index rows,
                            Index first, Index last) {
  for (Index i = first; i < last; ++i) dweight[i] = dbias[i] = S(0);
  for (Index r = 0; r < rows; ++r) {
    const S mean = moments[2 * r], rstd = moments[2 * r + 1];
    const S *x = t.x + r * t.width, *g = dy + r * t.width;
    for (Index i = first; i < last; ++i) {
      dweight[i] += g[i] * ((x[i] - mean) * rstd);
      dbias[i] += g[i];
    }
  }
}

/// y = softmax(x) for rows of n; `scratch` holds one row, rounded up to whole vectors.
template <class S>
void softmax_rows(const S* x, Index n, Index first, Index last, S* y, S* scratch) {
  for (Index r = first; r < last; ++r) {
    std::memcpy(scratch, x + r * n, static_cast<std::size_t>(n) * sizeof(S));
    softmax_rows_at<S, 1>(scratch, n, n, &n, S(1));
    std::memcpy(y + r * n, scratch, static_cast<std::size_t>(n) * sizeof(S));
  }
}

/// Columns first ... last-1 of y; first is a multiple of `lanes`.
template <class S>
void transpose(const Transposed<S>& t, Index first, Index last) {
  constexpr Index l = lanes<S>;
  for (Index j = first; j < last; j += l) {
    const Index n = std::min(l, last - j);
    const bool whole = n == l;
    const Vec<S> bias = t.bias == nullptr ? Vec<S>{} : load_some(t.bias + j, n);
    for (Index r = 0; r < t.rows; ++r) {
      const S* z = t.z + j * t.rows + r;
      const S* residual = t.residual == nullptr ? nullptr : t.residual + r * t.width + j;
      S* y = t.y + r * t.width + j;
      Vec<S> x{};
      if (whole) {
#pragma GCC unroll 16
        for (int i = 0; i < lanes<S>; ++i) x[i] = z[i * t.rows];
        x += bias;
        if (residual != nullptr) x += load(residual);
        store(y, x);
      } else {
        for (Index i = 0; i < n; ++i) x[i] = z[i * t.rows];
        x += bias;
        if (residual != nullptr) x += load_some(residual, n);
        store_some(y, x, n);
      }
    }
    if (t.act != Activation::none) activate_rows(t.y + j, t.width, t.rows, n, t.act, t.y + j, t.width);
  }
}

template <BinaryOp op, class S>
MOTIONLANG_INLINE Vec<S> apply_binary(const Vec<S>& a, const Vec<S>& b) {
  switch (op) {
    case BinaryOp::add:
      return a + b;
    case BinaryOp::sub:
      return a - b;
    case BinaryOp::mul:
      return a * b;
    case BinaryOp::div:
      return a / b;
    case BinaryOp::maximum:
      return a < b ? b : a;
  }
  return a;
}
/// A repeated operand is read again and again from one vector of copies.
template <BinaryOp op, class S>
MOTIONLANG_INLINE void binary_loop(const Binary<S>& t) {
  constexpr int l = lanes<S>;
  const Vec<S> copies_a = splat(*t.a), copies_b = splat(*t.b);
  const S *a = t.a_repeated ? reinterpret_cast<const S*>(&copies_a) : t.a,
          *b = t.b_repeated ? reinterpret_cast<const S*>(&copies_b) : t.b;
  const Index step_a = t.a_repeated ? 0 : l, step_b = t.b_repeated ? 0 : l;
  Index i = 0;
  for (; i + l <= t.count; i += l, a += step_a, b += step_b) store(t.y + i, apply_binary<op, S>(load(a), load(b)));
  const Index n = t.count - i;
  store_some(t.y + i, apply_binary<op, S>(load_some(a, n), load_some(b, n)), n);
}
template <class S>
void binary(const Binary<S>& t) {
  switch (t.op) {
    case BinaryOp::add:
      return binary_loop<BinaryOp::add>(t);
    case BinaryOp::sub:
      return binary_loop<BinaryOp::sub>(t);
    case BinaryOp::mul:
      return binary_loop<BinaryOp::mul>(t);
    case BinaryOp::div:
      return binary_loop<BinaryOp::div>(t);
    case BinaryOp::maximum:
      return binary_loop<BinaryOp::maximum>(t);
  }
}

template <class S>
void error_function(const S* x, Index n, S* y) {
  constexpr int l = lanes<S>;
  Index i = 0;
  for (; i + l <= n; i += l) store(y + i, verf<S>(load(x + i)));
  store_some(y + i, verf<S>(load_some(x + i, n - i)), n - i);
}

/// Sums of the rows first ... last-1, of n numbers each. Four chains of sums: none waits.
template <class S>
void row_sums(const S* x, Index n, Index first, Index last, S* y) {
  constexpr int l = lanes<S>;
  for (Index r = first; r < last; ++r) {
    const S* row = x + r * n;
    Vec<S> sums[4] = {};
    Index i = 0;
    for (; i + 4 * l <= n; i += 4 * l) {
#pragma GCC unroll 4
      for (int c = 0; c < 4; ++c) sums[c] += load(row + i + c * l);
    }
    for (; i < n; i += l) sums[0] += load_first(row + i, n - i);
    y[r] = reduce_add<S>(sums[0] + sums[1] + (sums[2] + sums[3]));
  }
}
/// Sums of the columns first ... last-1 over all rows.
template <class S>
void column_sums(const S* x, Index rows, Index width, Index first, Index last, S* y) {
  for (Index i = first; i < last; ++i) y[i] = S(0);
  for (Index r = 0; r < rows; ++r) {
    for (Index i = first; i < last; ++i) y[i] += x[r * width + i];
  }
}

template <class S>
MOTIONLANG_INLINE Vec<S> adamw_update(const AdamwStep<S>& t, const Vec<S>& p, const Vec<S>& gradient, Vec<S>& m,
                                      Vec<S>& v) {
  const Vec<S> g = gradient * t.gradient_scale;
  m = m * t.beta1 + g * t.rest1;
  v = v * t.beta2 + g * g * t.rest2;
  return p * t.decay - t.step * m / (vsqrt<S>(v) * t.correction + t.eps);
}
/// AdamW in one pass over parameter, gradient and moments (see optim/adamw.hpp for the formula).
template <class S>
void adamw(const AdamwStep<S>& t, Index first, Index last) {
  constexpr int l = lanes<S>;
  Index i = first;
  for (; i + l <= last; i += l) {
    Vec<S> m = load(t.m + i), v = load(t.v + i);
    store(t.p + i, adamw_update<S>(t, load(t.p + i), load(t.g + i), m, v));
    store(t.m + i, m), store(t.v + i, v);
  }
  const Index n = last - i;
  Vec<S> m = load_some(t.m + i, n), v = load_some(t.v + i, n);
  store_some(t.p + i, adamw_update<S>(t, load_some(t.p + i, n), load_some(t.g + i, n), m, v), n);
  store_some(t.m + i, m, n), store_some(t.v + i, v, n);
}

#define MOTIONLANG_STRING_OF(x) #x
#define MOTIONLANG_STRING(x) MOTIONLANG_STRING_OF(x)

// Matrix product in bfloat16 with sums in float. Three tiles, one text around them: this file has the tile for any
// processor, which widens bfloat16 to float; bf16_x86.inc has those for vdpbf16ps and for AMX.
//
//   Panels   B (k x n) is rounded and stored in panels of 32 columns, pairs of k side by side: [panel][k /
//            2][column][2], zero padded to a multiple of 32 in k. The same for all tiles, except numbers below 2^-126,
//            which some round to 0.
//   Rows     A is rounded into scratch, a block of rows at a time, zero padded in k: [row][k].
//   Tile     some rows of A times one panel, over k filled up to as many as its instructions take at a time (in pieces
//            of k, if the tile has pieces); what to do with the sums, as in gemm.inc. (In AMX the bias is the first
//            number of a sum.)
//   Order    every element is summed over k in an order that depends on the tile alone: same bits for any block or
//            thread.

typedef std::uint32_t Words __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
typedef std::uint32_t LooseWords __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES), aligned(2), may_alias));
typedef std::uint16_t Halves __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES / 2)));
typedef std::uint16_t LooseHalves __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES / 2), aligned(2), may_alias));
inline constexpr Index word_lanes = MOTIONLANG_VECTOR_BYTES / 4;

/// The nearest bfloat16, ties to even, in the upper half of each word; NaN stays NaN.
MOTIONLANG_INLINE Words round_to_bf16(const Vec<float>& x) {
  const Words w = (Words)x, rounded = w + (w >> 16 & 1u) + 0x7FFFu;
  return ((w & 0x7FFFFFFFu) > 0x7F800000u ? w | 0x400000u : rounded) & 0xFFFF0000u;
}
MOTIONLANG_INLINE void store_rounded(float* y, const Words& w) { store(y, (Vec<float>)w); }
MOTIONLANG_INLINE void store_rounded(std::uint16_t* y, const Words& w) {
  *reinterpret_cast<LooseHalves*>(y) = __builtin_convertvector(w >> 16, Halves);
}

/// A vector of numbers, rounded; zeros from the n-th on.
MOTIONLANG_INLINE Words rounded(const float* x, Index n) { return round_to_bf16(load_first(x, n)); }
/// Packs two vectors of rounded numbers into pairs of bfloat16.
MOTIONLANG_INLINE Words pairs(const Words& first, const Words& second) { return first >> 16 | second; }
MOTIONLANG_INLINE void store_words(std::uint16_t* y, const Words& w) { *reinterpret_cast<LooseWords*>(y) = w; }

/// The same as round_row of a tile (except numbers below 2^-126) for `rows` rows whose numbers are a[k * lda + row]:
/// squares of lanes are transposed.
template <class Element>
void round_columns(const float* a, Index lda, Index rows, Index k, Index padded, Element* y, Index pitch) {
  constexpr Index l = word_lanes, depth = l * (4 / static_cast<Index>(sizeof(Element)));  // of a square
  for (Index r = 0; r < rows; r += l) {
    const Index n = std::min(rows - r, l);
    for (Index i = 0; i < padded; i += depth) {
      Vec<float> square[lanes<float>];
#pragma GCC unroll 16
      for (int q = 0; q < lanes<float>; ++q) {
        const auto row = [&](Index at) {
          // no prefetcher follows pieces so far apart
          if (at + depth < k) __builtin_prefetch(a + (at + depth) * lda + r);
          return rounded(a + at * lda + r, at < k ? n : 0);
        };
        if constexpr (sizeof(Element) == 4) {
          square[q] = (Vec<float>)row(i + q);
        } else {
          square[q] = (Vec<float>)pairs(row(i + 2 * q), row(i + 2 * q + 1));
        }
      }
      transpose_lanes<float>(square);
      for (Index c = 0; c < n; ++c) std::memcpy(y + (r + c) * pitch + i, &square[c], sizeof square[c]);
    }
  }
}

/// Rows k0 ... k1-1 (both even) of all panels of B, whose element (k, n) is b[k * stride + n]: two rows at a
/// time, through as many panels as lie in different parts of the cache.
template <class Tile>
void bf16_pack_rows(const float* b, Index k, Index n, Index stride, Index k0, Index k1, std::uint16_t* panels) {
  constexpr Index ahead = 8;  // rows
  const Index depth = bf16_depth(k), count = (n + bf16_columns - 1) / bf16_columns;
  for (Index left = 0; left < count; left += panel_block) {
    for (Index i = k0; i < k1; i += 2) {
      const float *even = b + i * stride + left * bf16_columns, *odd = even + stride;
      std::uint16_t* out = panels + (left * depth + i) * bf16_columns;
      for (Index j = left; j < std::min(count, left + panel_block);
           ++j, even += bf16_columns, odd += bf16_columns, out += depth * bf16_columns) {
        fetch(even + ahead * stride, bf16_columns), fetch(odd + ahead * stride, bf16_columns);
        const Index columns = n - j * bf16_columns;
        Tile::round_pairs(even, i < k ? columns : 0, odd, i + 1 < k ? columns : 0, out);
      }
    }
  }
}
/// Panels first ... last-1 of B, whose element (k, n) is b[k + n * stride]: read along its rows, a square of lanes at a
/// time. Whether all numbers are finite, if it looks.
template <class Tile, bool looks>
bool bf16_pack_transposed(const float* b, Index k, Index n, Index stride, Index first, Index last,
                          std::uint16_t* panels) {
  constexpr Index l = word_lanes, block = 256, pitch = block + 32;  // of k that are rounded at once
  const Index depth = bf16_depth(k);
  std::uint16_t lines[static_cast<std::size_t>(bf16_columns * pitch)];  // columns of B: [column][k]
  Mask<float> found{};
  for (Index j = first; j < last; ++j) {
    std::uint16_t* out = panels + j * depth * bf16_columns;
    const float* in = b + j * bf16_columns * stride;
    const Index columns = n - j * bf16_columns;
    for (Index i0 = 0; i0 < depth; i0 += block) {
      const Index length = std::min(block, depth - i0);
      for (Index c = 0; c < bf16_columns; ++c) {
        const float* row = in + c * stride + i0;
        const Index there = c < columns ? std::min(k - i0, length) : 0;
        if constexpr (looks) {
          for (Index i = 0; i < there; i += lanes<float>) find_not_finite<float>(load_first(row + i, there - i), found);
        }
        Tile::round_row(row, there, length, lines + c * pitch);
      }
      for (Index i = 0; i < length; i += 2 * l, out += 2 * l * bf16_columns) {
        for (Index c = 0; c < bf16_columns; c += l) {
          Vec<float> square[lanes<float>];  // column, pair
#pragma GCC unroll 16
          for (int q = 0; q < lanes<float>; ++q) std::memcpy(&square[q], lines + (c + q) * pitch + i, sizeof square[q]);
          transpose_lanes<float>(square);
          for (Index p = 0; p < l; ++p) std::memcpy(out + (p * bf16_columns + c) * 2, &square[p], sizeof square[p]);
        }
      }
    }
  }
  return !any_negative<float>(found);
}

/// Bytes of a pair of k in a panel.
inline constexpr Index pair_bytes = 4 * bf16_columns;

/// True if a tile's rows of the result, which are whole lines, are better written past the caches: the caches would
/// read every line before it is overwritten, and forget other things. So for results larger than all of them, and for
/// those larger than the nearer ones whose rows are a multiple of the page size apart: a tile's rows then fall into the
/// same cache set.
inline bool streams(const Gemm<float>& g) {
  constexpr Index all = 16 << 20;
  const bool whole_lines =
      g.n % bf16_columns == 0 && bytes<float>(g.ldc) % 64 == 0 && reinterpret_cast<std::uintptr_t>(g.c) % 64 == 0;
  return whole_lines && bytes<float>(g.m * g.n) > (bytes<float>(g.ldc) % 4096 == 0 ? near_caches : all);
}
/// Rows of one panel's width, from where a tile has put them.
inline void stream_rows(const float* from, Index rows, float* to, Index ldc) {
  for (Index r = 0; r < rows; ++r, from += bf16_columns, to += ldc) {
    for (Index i = 0; i < bf16_columns; i += lanes<float>) store_stream(to + i, load(from + i));
  }
}

class PanelSplit;

/// The task of a tile: c = `height` rows of A, which begin at a, times the first `columns` columns of a panel,
/// over `depth` of k.
template <class Element>
struct TileProduct {
  const Element* a;
  Index pitch, height;
  const std::uint16_t* panel;
  Index depth;
  float* c;
  Index ldc, columns;
  Epilogue<float> e{};
  Ahead ahead{};
  bool panel_stays = true;         // in the cache, for the next tile; else the rows stay
  bool stream = false;             // c is written past the caches
  Index number = 0;                // of the tile among those of this panel
  bool first = true, last = true;  // piece of k
  PanelSplit* next = nullptr;      // of floats in parts: the panel that is split meanwhile
};

/// Tiles that keep their sums in registers: Tile::rows_of<height> does it all. Every tile has besides
///     round_row(x, n, padded, y)       y = n numbers, rounded, then zeros up to `padded`, a multiple of 32
///     round_pairs(x, nx, y, ny, pairs) 32 pairs, rounded: numbers of x (zeros after nx), beside each its like of y
template <class Tile>
struct RegisterTile {
  static constexpr bool even = true;                                 // rows are split evenly among tiles
  static constexpr Index depth(Index k) { return (k + 1) / 2 * 2; }  // that is multiplied, of the padded one
  static constexpr Index pieces(Index, Index) { return 1; }          // of k
  static void begin() {}
  static void end() {}

  template <class Element>
  void multiply(const TileProduct<Element>& t) {
    static constexpr auto table = []<int... R>(std::integer_sequence<int, R...>) {
      return std::array{&Tile::template rows_of<R + 1>...};
    }
    (std::make_integer_sequence<int, Tile::rows>{});
    const auto rows_of = table[static_cast<std::size_t>(t.height - 1)];
    if (!t.stream) return rows_of(t.a, t.pitch, t.panel, t.depth, t.c, t.ldc, t.columns, t.e, t.ahead);
    alignas(64) float result[static_cast<std::size_t>(Tile::rows * bf16_columns)];
    rows_of(t.a, t.pitch, t.panel, t.depth, result, bf16_columns, t.columns, t.e, t.ahead);
    stream_rows(result, t.height, t.c, t.ldc);
  }
  void finish() {}
};

/// For any processor: rows of A are kept as rounded floats, a pair of B is split into two vectors of floats.
struct WideningTile : RegisterTile<WideningTile> {
  using Element = float;
  static constexpr const char* name = MOTIONLANG_STRING(MOTIONLANG_ISA);
  static constexpr int rows = MOTIONLANG_TILE_ROWS > 2 ? MOTIONLANG_TILE_ROWS - 2 : 2;
  template <class Number>
  static void round_row(const float* x, Index n, Index padded, Number* y) {
    for (Index i = 0; i < padded; i += word_lanes) store_rounded(y + i, rounded(x + i, n - i));
  }
  static void round_pairs(const float* x, Index nx, const float* y, Index ny, std::uint16_t* out) {
    for (Index c = 0; c < bf16_columns; c += word_lanes) {
      store_words(out + 2 * c, pairs(rounded(x + c, nx - c), rounded(y + c, ny - c)));
    }
  }

  template <int R>
  static void rows_of(const Element* a, Index pitch, const std::uint16_t* panel, Index depth, float* c, Index ldc,
                      Index columns, const Epilogue<float>& e, Ahead ahead) {
    constexpr int l = lanes<float>;
    for (Index column = 0; column < columns; column += 2 * l) {
      const Epilogue<float> piece = e.from_column(column);
      fetch_result<float, R>(c + column, ldc, piece);
      if (column > 0) ahead.step = 0;  // once is enough
      Vec<float> c0[R], c1[R];
#pragma GCC unroll 16
      for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<float>{};
      const std::uint16_t* b = panel + 2 * column;
      for (Index k = 0; k < depth; k += 2, b += 2 * bf16_columns) {
        ahead.fetch();
        const Words w0 = *reinterpret_cast<const LooseWords*>(b), w1 = *reinterpret_cast<const LooseWords*>(b + 2 * l);
        const Vec<float> even0 = (Vec<float>)(w0 << 16), odd0 = (Vec<float>)(w0 & 0xFFFF0000u);
        const Vec<float> even1 = (Vec<float>)(w1 << 16), odd1 = (Vec<float>)(w1 & 0xFFFF0000u);
#pragma GCC unroll 16
        for (int i = 0; i < R; ++i) {
          const float x = a[i * pitch + k], y = a[i * pitch + k + 1];
          c0[i] += x * even0;
          c1[i] += x * even1;
          c0[i] += y * odd0;
          c1[i] += y * odd1;
        }
      }
      put_result<float, R>(c0, c1, c + column, ldc, columns - column, piece);
    }
  }
};

/// The first `count` rows of A, side by side.
template <class Tile>
void round_rows(const Rows<float>& a, Index count, Index k, Index depth, typename Tile::Element* y, Index pitch) {
  if (a.transposed) return round_columns(a.at, a.stride, count, k, depth, y, pitch);
  for (Index r = 0; r < count; ++r) Tile::round_row(a.from(r).at, k, depth, y + r * pitch);
}

/// Rows of A in scratch at once, and their distance.
template <class Tile>
Index bf16_rows(Index k) {
  return rows_at_once(bytes<typename Tile::Element>(bf16_depth(k)), Tile::rows, half_cache / 2 * 3);
}
template <class Tile>
constexpr Index bf16_pitch(Index depth) {
  return depth + 64 / static_cast<Index>(sizeof(typename Tile::Element));
}
/// Numbers of scratch that bf16_gemm_block needs.
template <class Tile>
Index bf16_scratch(Index k) {
  return bf16_rows<Tile>(k) * bf16_pitch<Tile>(bf16_depth(k));
}

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product with bfloat16 panels.
template <class Tile>
void bf16_gemm_block(const Gemm<float>& g, const std::uint16_t* panels, Index r0, Index r1, Index j0, Index j1,
                     float* scratch) {
  using Element = typename Tile::Element;
  const Index depth = bf16_depth(g.k), pitch = bf16_pitch<Tile>(depth), at_once = bf16_rows<Tile>(g.k);
  Element* a = reinterpret_cast<Element*>(scratch);
  const bool stream = streams(g);
  Tile tile;
  Tile::begin();
  constexpr Index unit = Tile::even ? 1 : Tile::rows;  // of rows that blocks have evenly
  const Index units = (r1 - r0 + unit - 1) / unit, row_blocks = (r1 - r0 + at_once - 1) / at_once;
  for (Index block = 0; block < row_blocks; ++block) {
    const Index top = r0 + unit * part(units, block, row_blocks);
    const Index rows = std::min(r1, r0 + unit * part(units, block + 1, row_blocks)) - top,
                tiles = (rows + Tile::rows - 1) / Tile::rows;
    const Index pieces = Tile::pieces(depth, tiles);
    round_rows<Tile>(Rows<float>{g.a, g.lda, g.a_transposed}.from(top), rows, g.k, depth, a, pitch);
    for (Index j = j0; j < j1; ++j) {
      const std::uint16_t* panel = panels + j * depth * bf16_columns;
      const bool last = j + 1 == j1 && top + rows == r1;
      const std::byte* next = as_bytes(panels + (j + 1 < j1 ? j + 1 : j0) * depth * bf16_columns);
      const auto* following = last ? g.following(j0, (g.n + bf16_columns - 1) / bf16_columns, next) : next;
      for (Index step = 0; step < pieces * tiles; ++step) {
        const Index piece = step / tiles, t = step % tiles;
        const Index k0 = 32 * part(depth / 32, piece, pieces),
                    k1 = std::min(32 * part(depth / 32, piece + 1, pieces), Tile::depth(g.k));
        const Index first = Tile::even ? part(rows, t, tiles) : t * Tile::rows;
        const Index height = (Tile::even ? part(rows, t + 1, tiles) : std::min(rows, first + Tile::rows)) - first;
        const Index row = top + first, column = j * bf16_columns;
        const auto ahead =
            Ahead::share(following + k0 / 2 * pair_bytes, (k1 - k0) / 2 * pair_bytes, t, tiles, (k1 - k0) / 2);
        TileProduct<Element> product{.a = a + first * pitch + k0,
                                     .pitch = pitch,
                                     .height = height,
                                     .panel = panel + k0 * bf16_columns,
                                     .depth = k1 - k0,
                                     .c = g.c + row * g.ldc + column,
                                     .ldc = g.ldc,
                                     .columns = std::min(g.n - column, bf16_columns),
                                     .e = Epilogue<float>::of(g, row, column, true, true),
                                     .ahead = ahead,
                                     .panel_stays = tiles > 1,
                                     .stream = stream,
                                     .number = t,
                                     .first = piece == 0,
                                     .last = piece + 1 == pieces};
        tile.multiply(product);
      }
    }
  }
  tile.finish();
  if (stream) end_of_streams();
  Tile::end();
}

/// The products of attention (attention.inc) in bfloat16; scores and softmax stay in float.
template <class Tile>
struct Bf16Products {
  using Number = float;
  using Element = typename Tile::Element;
  static constexpr Index rows = Tile::rows;
  static void begin() { Tile::begin(); }
  static void end() { Tile::end(); }
  static Index columns(Index n) { return bf16_depth(n); }
  static Index panels(Index k, Index n) { return bf16_depth(k) * bf16_depth(n) / 2; }
  static Index scratch(Index k) { return Tile::rows * bf16_pitch<Tile>(bf16_depth(k)); }

  static void pack(const float* b, Index k, Index n, Index stride_k, Index stride_n, float* panels) {
    auto* out = reinterpret_cast<std::uint16_t*>(panels);
    if (stride_n == 1)
      bf16_pack_rows<Tile>(b, k, n, stride_k, 0, bf16_depth(k), out);
    else
      bf16_pack_transposed<Tile, false>(b, k, n, stride_n, 0, bf16_depth(n) / bf16_columns, out);
  }
  static void multiply(const Rows<float>& a, Index count, Index k, const float* panels, Index n, float* c, Index ldc,
                       float* scratch, bool whole_panels) {
    const Index depth = bf16_depth(k), pitch = bf16_pitch<Tile>(depth);
    auto* rounded_rows = reinterpret_cast<Element*>(scratch);
    Tile tile;
    for (Index first = 0; first < count; first += Tile::rows) {
      const Index height = std::min<Index>(Tile::rows, count - first);
      round_rows<Tile>(a.from(first), height, k, depth, rounded_rows, pitch);
      for (Index j = 0; j < n; j += bf16_columns) {
        const auto* panel = reinterpret_cast<const std::uint16_t*>(panels) + j * depth;
        tile.multiply(TileProduct<Element>{.a = rounded_rows,
                                           .pitch = pitch,
                                           .height = height,
                                           .panel = panel,
                                           .depth = Tile::depth(k),
                                           .c = c + first * ldc + j,
                                           .ldc = ldc,
                                           .columns = whole_panels ? bf16_columns : std::min(n - j, bf16_columns),
                                           .ahead = {as_bytes(panel)},
                                           .panel_stays = false});
      }
    }
    tile.finish();
  }
};

template <class Tile>
const Bf16Kernels& bf16_table() {
  static constexpr Bf16Kernels t{.name = Tile::name,
                                 .tile_rows = Tile::rows,
                                 .gemm_rows = &bf16_rows<Tile>,
                                 .gemm_scratch = &bf16_scratch<Tile>,
                                 .pack_rows = &bf16_pack_rows<Tile>,
                                 .pack_transposed = &bf16_pack_transposed<Tile, true>,
                                 .gemm_block = &bf16_gemm_block<Tile>,
                                 .attention_scratch = &attention_scratch<Bf16Products<Tile>>,
                                 .attention_head = &attention_head<Bf16Products<Tile>>,
                                 .attention_vjp_scratch = &attention_vjp_scratch<Bf16Products<Tile>>,
                                 .attention_head_vjp = &attention_head_vjp<Bf16Products<Tile>>};
  return t;
}

template <class S>
const Kernels<S>& table() {
  static constexpr Kernels<S> t{
      .isa = Isa::MOTIONLANG_ISA,
      .name = MOTIONLANG_STRING(MOTIONLANG_ISA),
      .panel_width = panel_width<S>,
      .tile_rows = tile_rows,
      .gemm_rows = &gemm_rows<S>,
      .gemm_scratch = &gemm_scratch<S>,
      .pack_rows = &pack_rows<S>,
      .pack_transposed = &pack_transposed<S, true>,
      .gemm_block = &gemm_block<S>,
      .attention_scratch = &attention_scratch<FloatProducts<S>>,
      .attention_head = &attention_head<FloatProducts<S>>,
      .dropout = &dropout<S>,
      .layer_norm_rows = &layer_norm_rows<S>,
      .softmax_rows = &softmax_rows<S>,
      .transpose = &transpose<S>,
      .activate = &activate<S>,
      .binary = &binary<S>,
      .error_function = &error_function<S>,
      .row_sums = &row_sums<S>,
      .column_sums = &column_sums<S>,
  };
  return t;
}
template <class S>
const GradientKernels<S>& gradient_table() {
  static constexpr GradientKernels<S> t{
      .attention_scratch = &attention_vjp_scratch<FloatProducts<S>>,
      .attention_head = &attention_head_vjp<FloatProducts<S>>,
      .layer_norm_rows = &layer_norm_rows_vjp<S>,
      .layer_norm_columns = &layer_norm_columns_vjp<S>,
      .activate = &activate_vjp<S>,
      .adamw = &adamw<S>,
  };
  return t;
}

#undef MOTIONLANG_STRING
#undef MOTIONLANG_STRING_OF
#undef MOTIONLANG_INLINE

}  // namespace detail::MOTIONLANG_ISA
MOTIONLANG_NAMESPACE_END
#endif
