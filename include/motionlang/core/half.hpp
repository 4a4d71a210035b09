// SPDX-License-Identifier: MIT
/// The two 16-bit floating-point formats in which weights are stored: IEEE half (F16) and bfloat16 (BF16). Conversions
/// only; nothing is calculated in them.
#pragma once

#include <cstdint>  // bits

#include <motionlang/core/standard_library.hpp>

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
