// SPDX-License-Identifier: MIT
/// Dropout masks that are a function of a key and a position. Nothing is stored, and any thread computes any part.
#pragma once

#include <cstdint>  // hash

#include <motionlang/core/shape.hpp>

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
