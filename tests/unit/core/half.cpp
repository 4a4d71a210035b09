// Half precision: every 16-bit pattern there and back; known pairs; rounding.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include <motionlang/core/half.hpp>

namespace ml = motionlang;

TEST_CASE("known pairs") {  // IEEE 754 binary16
  CHECK(ml::half_to_float(0x3C00) == 1.0f);
  CHECK(ml::half_to_float(0x7BFF) == 65504.0f);
  CHECK(ml::half_to_float(0x0001) == 5.960464477539063e-08f);
  CHECK(ml::half_to_float(0x0400) == 6.103515625e-05f);
  CHECK(std::signbit(ml::half_to_float(0x8000)));
  CHECK(ml::half_to_float(0x8000) == 0.0f);
  CHECK(ml::half_to_float(0x7C00) == std::numeric_limits<float>::infinity());
  CHECK(ml::half_to_float(0x3555) == 0.333251953125f);
  CHECK(std::isnan(ml::half_to_float(0xFE00)));
  CHECK(ml::half_to_float(0xC100) == -2.5f);
  CHECK(ml::float_to_half(2049.0f) == 0x6800);
  CHECK(ml::bfloat16_to_float(0x3F80) == 1.0f);
  CHECK(ml::bfloat16_to_float(0xC020) == -2.5f);
  CHECK(ml::float_to_bfloat16(3.1415927f) == 0x4049);
  CHECK(ml::float_to_bfloat16(std::bit_cast<float>(0x3F808000u)) == 0x3F80);
  CHECK(ml::float_to_bfloat16(std::bit_cast<float>(0x3F818000u)) == 0x3F82);
  CHECK(ml::float_to_bfloat16(std::bit_cast<float>(0x7F7FC99Eu)) == 0x7F80);
}

TEST_CASE("every pattern survives the way to float and back") {
  int wrong = 0;
  for (unsigned i = 0; i <= 0xFFFF; ++i) {
    const auto bits = static_cast<std::uint16_t>(i);
    const bool half_nan = (bits & 0x7C00) == 0x7C00 && (bits & 0x3FF) != 0;
    const bool bfloat_nan = (bits & 0x7F80) == 0x7F80 && (bits & 0x7F) != 0;
    const float h = ml::half_to_float(bits), b = ml::bfloat16_to_float(bits);
    wrong += half_nan ? !std::isnan(h) || !std::isnan(ml::half_to_float(ml::float_to_half(h)))
                      : ml::float_to_half(h) != bits;
    wrong += bfloat_nan ? !std::isnan(b) || !std::isnan(ml::bfloat16_to_float(ml::float_to_bfloat16(b)))
                        : ml::float_to_bfloat16(b) != bits;
  }
  CHECK(wrong == 0);
}

TEST_CASE("rounding is to the nearest, ties to even, at every boundary between two halves") {
  int wrong = 0;
  for (std::uint16_t low = 0; low < 0x7BFF; ++low) {
    const float a = ml::half_to_float(low), b = ml::half_to_float(static_cast<std::uint16_t>(low + 1));
    const float middle = a + (b - a) / 2;  // exact: halves have 11 bits
    wrong += ml::float_to_half(middle) != (low % 2 == 0 ? low : low + 1);
    wrong += ml::float_to_half(std::nextafter(middle, 0.0f)) != low;
    wrong += ml::float_to_half(std::nextafter(middle, 1e6f)) != low + 1;
    wrong += ml::float_to_half(-middle) != (0x8000 | (low % 2 == 0 ? low : low + 1));
  }
  CHECK(wrong == 0);
  CHECK(ml::float_to_half(65519.996f) == 0x7BFF);
  CHECK(ml::float_to_half(65520.0f) == 0x7C00);
  CHECK(ml::float_to_half(1e-10f) == 0);
}
