// Replacements for parts that some standard libraries lack: the same characters and bits as everywhere.
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include <motionlang/core/detail/decimal.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/core/standard_library.hpp>
#include <motionlang/datasets/described_motions.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using std::chars_format;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// The functions that the library itself calls: those of the standard library where it has them.
struct Called {
  template <class... T>
  static std::string written(T... value_and_how) {
    char out[1200];
    const auto r = ml::detail::to_chars(out, out + sizeof out, value_and_how...);
    return r.ec == std::errc{} ? std::string(out, r.ptr) : "no room";
  }
  template <class F>
  static auto read(const char* first, const char* last, F& value) {
    return ml::detail::from_chars(first, last, value);
  }
};
/// Ours, which is there with every standard library.
struct Ours {
  template <class F>
  static std::string written(F value, chars_format format = {}) {
    return ml::detail::shortest_text(value, format);
  }
  template <class F>
  static std::string written(F value, chars_format format, int places) {
    return ml::detail::text_with_places(value, format, places);
  }
  template <class F>
  static auto read(const char* first, const char* last, F& value) {
    return ml::detail::read_decimal(first, last, value);
  }
};

/// Value, error and length of what is read: "1.5, all", "2, 3 characters", "out of range, all", "none".
template <class F, class From>
std::string reading(const std::string& text) {
  F value = 42;
  const auto [end, error] = From::read(text.data(), text.data() + text.size(), value);
  if (error == std::errc::invalid_argument) return end == text.data() && value == 42 ? "none" : "moved";
  const auto length = static_cast<std::size_t>(end - text.data());
  const std::string what = error == std::errc::result_out_of_range ? (value == 42 ? "out of range" : "changed")
                           : std::isnan(value)                     ? (std::signbit(value) ? "-nan" : "nan")
                                                                   : Ours::written(value);
  return what + ", " + (length == text.size() ? "all" : std::to_string(length) + " characters");
}

/// Values of every size and of few digits, subnormals, whole numbers, powers of two with their neighbours.
template <class F, class Bits>
F test_value(ml::Philox& rng, int i) {
  const Bits bits = static_cast<Bits>(std::uint64_t{rng.bits()} << 32 | rng.bits());
  constexpr int digits = std::numeric_limits<F>::digits;
  const auto exponent = static_cast<int>(rng.below(static_cast<std::uint32_t>(digits)));
  switch (i % 5) {
    case 0:
      return ml::detail::bit_cast<F>(bits);
    case 1:
      return static_cast<F>(bits >> exponent);
    case 2:
      return static_cast<F>(bits >> (sizeof(F) * 8 - static_cast<std::size_t>(digits)) >> exponent) /
             static_cast<F>(std::pow(10, rng.below(8)));
    case 3:
      return ml::detail::bit_cast<F>(static_cast<Bits>(bits >> (sizeof(F) * 8 - static_cast<std::size_t>(digits) + 1)));
    default:
      return ml::detail::bit_cast<F>(static_cast<Bits>((bits >> (digits - 1) << (digits - 1)) + rng.below(3) - 1));
  }
}

/// Every way in which `value` is written, and how the shortest of them is read.
template <class From, class F>
std::string all_texts(F value, int places) {
  const std::string shortest = From::written(value);
  return shortest + ' ' + From::written(value, chars_format::fixed) + ' ' +
         From::written(value, chars_format::scientific) + ' ' + From::written(value, chars_format::fixed, places) +
         ' ' + From::written(value, chars_format::scientific, places) + ' ' + reading<double, From>(shortest) + ' ' +
         reading<float, From>(shortest);
}
/// Hash of the texts of `count` values. Checks each against the text that our own functions write.
template <class F, class Bits>
std::uint64_t hash_of_texts(int count) {
  std::uint64_t hash = 0xCBF29CE484222325u;  // FNV-1a
  ml::Philox rng{.seed = 11};
  for (int i = 0; i < count; ++i) {
    const F value = test_value<F, Bits>(rng, i);
    const std::string text = all_texts<Called>(value, i % 17);
    if (const std::string ours = all_texts<Ours>(value, i % 17); ours != text) CHECK(ours == text);
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  }
  return hash;
}

}  // namespace

TEST_CASE("bit_cast is there, and a constant is one") {
  static_assert(ml::detail::bit_cast<std::uint32_t>(1.0f) == 0x3F800000u);
  CHECK(ml::detail::bit_cast<double>(std::uint64_t{0x7FF0000000000000u}) == inf);
}

// Recorded with GCC 12's library. Every other library that this test is built with has to give the same.
TEST_CASE("values are written with the same characters, and read with the same bits, everywhere") {
  CHECK(hash_of_texts<double, std::uint64_t>(10'000) == 2830961317808408259u);
  CHECK(hash_of_texts<float, std::uint32_t>(10'000) == 8958669393545711203u);
}

TEST_CASE_TEMPLATE("values with a difficult text", From, Called, Ours) {
  // As they are written: shortest, fixed, scientific.
  const auto texts = [](auto value) {
    return From::written(value) + " | " + From::written(value, chars_format::fixed) + " | " +
           From::written(value, chars_format::scientific);
  };
  CHECK(texts(0.0) == "0 | 0 | 0e+00");
  CHECK(texts(-0.0) == "-0 | -0 | -0e+00");
  CHECK(texts(1e4) == "10000 | 10000 | 1e+04");  // equally long: fixed
  CHECK(texts(1e5) == "1e+05 | 100000 | 1e+05");
  CHECK(texts(1e-4) == "1e-04 | 0.0001 | 1e-04");
  CHECK(texts(0.00015) == "0.00015 | 0.00015 | 1.5e-04");
  CHECK(texts(0.1) == "0.1 | 0.1 | 1e-01");
  CHECK(texts(0.1f) == "0.1 | 0.1 | 1e-01");
  CHECK(texts(16777216.0f) == "16777216 | 16777216 | 1.6777216e+07");
  CHECK(texts(1e22) == "1e+22 | 10000000000000000000000 | 1e+22");
  CHECK(texts(1e23) == "1e+23 | 99999999999999991611392 | 1e+23");  // fixed: the digits of the whole number itself
  CHECK(texts(123456789012345667584.0) == "123456789012345667584 | 123456789012345667584 | 1.2345678901234567e+20");
  CHECK(texts(0x1p53) == "9007199254740992 | 9007199254740992 | 9.007199254740992e+15");
  CHECK(texts(0x1p-44) == "5.684341886080802e-14 | 0.00000000000005684341886080802 | 5.684341886080802e-14");
  CHECK(From::written(5e-324) == "5e-324");
  CHECK(From::written(0x1p-1022) == "2.2250738585072014e-308");
  CHECK(From::written(std::numeric_limits<double>::max()) == "1.7976931348623157e+308");
  CHECK(From::written(1e-45f) == "1e-45");
  CHECK(From::written(std::numeric_limits<float>::max()) == "3.4028235e+38");
  CHECK(texts(inf) == "inf | inf | inf");
  CHECK(texts(-std::numeric_limits<double>::quiet_NaN()) == "-nan | -nan | -nan");
  CHECK(From::written(2.5, chars_format::fixed, 0) == "2");
  CHECK(From::written(-0.125, chars_format::fixed, 2) == "-0.12");
  CHECK(From::written(1e300, chars_format::fixed, 3).size() == 305);
  CHECK(From::written(-inf, chars_format::fixed, 3) == "-inf");
}

TEST_CASE_TEMPLATE("texts that are difficult to read", From, Called, Ours) {
  const auto read = [](const std::string& text) { return reading<double, From>(text); };
  CHECK(read("9007199254740993") == "9007199254740992, all");  // halfway: to the even one
  CHECK(read("9007199254740993." + std::string(1000, '0') + "1") == "9007199254740994, all");
  CHECK(read("8.5e22") == "8.5e+22, all");
  CHECK(read("1e23") == "1e+23, all");
  CHECK(read("2.4703282292062327e-324") == "out of range, all");
  CHECK(read("2.4703282292062328e-324") == "5e-324, all");
  CHECK(read("2.2250738585072011e-308") == "2.225073858507201e-308, all");
  CHECK(read("1.7976931348623158e308") == "1.7976931348623157e+308, all");
  CHECK(read("1.7976931348623159e308") == "out of range, all");
  CHECK(read("-1e400") == "out of range, all");
  CHECK(read("0e99999999999999999999") == "0, all");
  CHECK(read("-0.0e5") == "-0, all");
  CHECK(read("1" + std::string(2000, '0') + "e-2000") == "1, all");
  CHECK(read("0." + std::string(2000, '0') + "1e2001") == "1, all");
  CHECK(reading<float, From>("16777217") == "16777216, all");
  CHECK(reading<float, From>("16777217.0000000000000000001") == "16777218, all");  // no double in between
  CHECK(reading<float, From>("1e-46") == "out of range, all");
  CHECK(reading<float, From>("3.4028236e38") == "out of range, all");

  CHECK(read("5.") == "5, all");
  CHECK(read(".5") == "0.5, all");
  CHECK(read("1E+02") == "100, all");
  CHECK(read("1,5") == "1, 1 characters");
  CHECK(read("1.5.3") == "1.5, 3 characters");
  CHECK(read("1e") == "1, 1 characters");
  CHECK(read("1e-x") == "1, 1 characters");
  CHECK(read("0x10") == "0, 1 characters");
  for (const char* none : {"", "-", "+1", " 1", ".", "-.", "--1", "-+1", "e5", ",5", "i", "na"}) {
    CAPTURE(none);
    CHECK(read(none) == "none");
  }
  CHECK(read("Inf") == "inf, all");
  CHECK(read("-INFINITY") == "-inf, all");
  CHECK(read("infinite") == "inf, 3 characters");
  CHECK(read("nan") == "nan, all");
  CHECK(read("-NaN(a_1)") == "-nan, all");
  CHECK(read("nan(a b)") == "nan, 3 characters");
}

TEST_CASE("a text that does not fit is not written") {
  char out[4] = {};
  const auto r = ml::detail::copy_text("1.25", out, out + 3);
  CHECK(r.ec == std::errc::value_too_large);
  CHECK(r.ptr == out + 3);
  CHECK(ml::detail::copy_text("1.25", out, out + 4).ptr == out + 4);
}

TEST_CASE("a locale with another decimal point changes nothing") {
  CHECK(ml::detail::with_point("-1,50e-05") == "-1.50e-05");
  CHECK(ml::detail::with_point("12\xD9\xAB"
                               "5") == "12.5");              // U+066B, as in Pashto
  const char* name = std::getenv("MOTIONLANG_TEST_LOCALE");  // tests/compile/libcxx makes one
  if (name == nullptr) return;
  REQUIRE(std::setlocale(LC_NUMERIC, name) != nullptr);
  CHECK(std::localeconv()->decimal_point == std::string(","));
  CHECK(Ours::written(0.1) == "0.1");
  CHECK(Ours::written(-1.5, chars_format::fixed, 2) == "-1.50");
  CHECK(reading<double, Ours>("1.25e1") == "12.5, all");
  CHECK(reading<double, Ours>("1,5") == "1, 1 characters");
  std::setlocale(LC_NUMERIC, "C");
}
