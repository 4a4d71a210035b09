// SPDX-License-Identifier: MIT
/// Floating-point values as decimal text, made by the C library alone. This is for standard libraries that lack
/// `from_chars` and `to_chars` for them (standard_library.hpp). The results are the same to the last character.
///
/// strtod and printf of all C libraries round correctly, but their decimal point is the locale's. So strtod gets whole
/// numbers with an exponent here, and anything that printf writes between digits counts as a point. This is slower than
/// `to_chars`: a microsecond or two for a value.
#pragma once

#include <cassert>       // formats
#include <charconv>      // results, chars_format
#include <cmath>         // signbit, isfinite
#include <concepts>      // same_as
#include <cstdio>        // snprintf
#include <cstdlib>       // strtod, strtol
#include <limits>        // digits10
#include <string>        // digits
#include <string_view>   // words
#include <system_error>  // errc
#include <utility>       // move

#include <motionlang/version.hpp>

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
