// SPDX-License-Identifier: MIT
/// Random numbers: a counter-based generator that can be split by name or number.
///
/// Source   Salmon et al., "Parallel random numbers: as easy as 1, 2, 3" (SC 2011): Philox4x32 with 10 rounds.
/// Normals  Box and Muller (1958), computed in double and rounded, because the standard leaves
///          `std::normal_distribution` open and float libraries differ in the last bit.
/// The generators of PyTorch, NumPy and CPython, for parity with published runs, are in torch_random.hpp,
/// numpy_random.hpp and python_random.hpp.
#pragma once

#include <array>        // blocks of four numbers
#include <cmath>        // log, cos, sin
#include <cstdint>      // fixed widths
#include <numbers>      // pi
#include <span>         // output
#include <string_view>  // stream names

#include <motionlang/core/concepts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Philox4x32-10. `seed` is the key, `stream` and `position` are the counter. Any number of any stream can be computed
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

  /// first  begins at this number of what the same call draws from 0 on, without drawing those before it
  template <Scalar S>
  void uniform(std::span<S> out, std::uint64_t first = 0) {
    fill(out, first, [](const Block& b, std::array<double, 4>& v) {
      for (std::size_t i = 0; i < 4; ++i) v[i] = (b[i] >> 8) * 0x1p-24;  // 24 bits: exact in float, never 1
    });
  }
  void uniform(std::span<float> out) { uniform<float>(out); }

  /// Standard normal numbers. first: as for `uniform`.
  template <Scalar S>
  void normal(std::span<S> out, std::uint64_t first = 0) {
    fill(out, first, [](const Block& b, std::array<double, 4>& v) {
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
  void fill(std::span<S> out, std::uint64_t first, F values_of) {
    position += first / 4;
    auto j = static_cast<std::size_t>(first % 4);  // in the block
    std::array<double, 4> v{};
    for (std::size_t i = 0; i < out.size(); j = 0) {
      values_of(block(position++), v);
      for (; j < 4 && i < out.size(); ++j) out[i++] = static_cast<S>(v[j]);
    }
  }
};
static_assert(Rng<Philox>);

MOTIONLANG_NAMESPACE_END
