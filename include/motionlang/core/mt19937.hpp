// SPDX-License-Identifier: MIT
/// The Mersenne Twister, with both of its seedings. Do not use it for new work (see Philox in rng.hpp). The generators
/// of PyTorch, NumPy and CPython are built on it, and with them published runs can be repeated number by number.
///
/// Source  Matsumoto and Nishimura, "Mersenne Twister" (ACM TOMACS 8, 1998), and the seeding of 2002. `std::mt19937` is
///         the same engine, but it has no init_by_array.
#pragma once

#include <array>    // state
#include <cstddef>  // size_t
#include <cstdint>  // words
#include <span>     // key

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class Mt19937 {
 public:
  /// init_genrand: x_0 = seed, x_i = 1812433253 (x_{i-1} xor (x_{i-1} >> 30)) + i
  explicit Mt19937(std::uint32_t seed) {
    state_[0] = seed;
    for (std::uint32_t i = 1; i < size; ++i) state_[i] = 1812433253u * mixed(i - 1) + i;
  }

  /// init_by_array. An empty key counts as the key {0}.
  explicit Mt19937(std::span<const std::uint32_t> key) : Mt19937(19650218u) {
    static constexpr std::uint32_t zero[] = {0};
    if (key.empty()) key = zero;
    std::size_t i = 1, j = 0;
    auto next = [&] {
      if (++i == size) state_[0] = state_[size - 1], i = 1;
    };
    for (std::size_t n = key.size() > size ? key.size() : size; n > 0; --n) {
      state_[i] = (state_[i] ^ mixed(i - 1) * 1664525u) + key[j] + static_cast<std::uint32_t>(j);
      next();
      if (++j == key.size()) j = 0;
    }
    for (std::size_t n = size - 1; n > 0; --n) {
      state_[i] = (state_[i] ^ mixed(i - 1) * 1566083941u) - static_cast<std::uint32_t>(i);
      next();
    }
    state_[0] = 0x80000000u;
  }

  /// The next 32 bits.
  std::uint32_t operator()() {
    if (at_ == size) twist();
    std::uint32_t y = state_[at_++];
    y ^= y >> 11;
    y ^= (y << 7) & 0x9D2C5680u;
    y ^= (y << 15) & 0xEFC60000u;
    return y ^ (y >> 18);
  }

  /// Uniform in [0, 1) with 53 bits from two words, as NumPy and CPython take them: (27 bits, then 26 bits) / 2^53.
  double uniform53() {
    const std::uint32_t high = (*this)() >> 5, low = (*this)() >> 6;
    return (high * 67108864.0 + low) * 0x1p-53;
  }

 private:
  static constexpr std::size_t size = 624, shift = 397;

  std::uint32_t mixed(std::size_t i) const { return state_[i] ^ (state_[i] >> 30); }

  void twist() {
    for (std::size_t i = 0; i < size; ++i) {
      const std::uint32_t y = (state_[i] & 0x80000000u) | (state_[(i + 1) % size] & 0x7FFFFFFFu);
      state_[i] = state_[(i + shift) % size] ^ (y >> 1) ^ ((y & 1u) != 0 ? 0x9908B0DFu : 0u);
    }
    at_ = 0;
  }

  std::array<std::uint32_t, size> state_{};
  std::size_t at_ = size;
};

MOTIONLANG_NAMESPACE_END
