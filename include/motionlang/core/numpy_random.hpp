// SPDX-License-Identifier: MIT
/// NumPy's legacy generator: `numpy.random.seed(seed)` followed by the functions of the module, for parity with
/// published runs (captions, crops for FID, pairs for diversity).
///
/// Source  numpy 1.24, numpy/random/mtrand.pyx, src/distributions (masked rejection), src/legacy (polar method)
#pragma once

#include <bit>       // bit_width
#include <cmath>     // log, sqrt
#include <cstdint>   // words
#include <numeric>   // iota
#include <optional>  // the second number of randn
#include <span>      // lists
#include <utility>   // exchange, swap
#include <vector>    // permutations

#include <motionlang/core/mt19937.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class NumpyRandom {
 public:
  explicit NumpyRandom(std::uint32_t seed) : words_(seed) {}

  /// Uniform in low ... high-1. Throws config_error 101 if that range is empty.
  std::int64_t randint(std::int64_t low, std::int64_t high) {
    if (high <= low) raise<config_error>(101, "NumpyRandom::randint: from ", low, " to below ", high);
    const std::uint64_t largest = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) - 1;
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + at_most(largest));
  }

  template <class T>
  void shuffle(std::span<T> list) {
    for (std::size_t i = list.size(); i-- > 1;) std::swap(list[i], list[at_most(i)]);
  }
  template <class T>
  void shuffle(std::vector<T>& list) {
    shuffle(std::span<T>(list));
  }

  /// 0 ... n-1 in random order. Throws config_error 101 if n is negative.
  std::vector<Index> permutation(Index n) {
    if (n < 0) raise<config_error>(101, "NumpyRandom::permutation: of ", n);
    std::vector<Index> list(static_cast<std::size_t>(n));
    std::iota(list.begin(), list.end(), Index{0});
    shuffle(list);
    return list;
  }

  /// `choice(n, k, replace=False)`: the first k of a permutation. Throws config_error 101 unless 0 <= k <= n.
  std::vector<Index> choice(Index n, Index k) {
    if (k < 0 || k > n) raise<config_error>(101, "NumpyRandom::choice: ", k, " of ", n);
    std::vector<Index> list = permutation(n);
    list.resize(static_cast<std::size_t>(k));
    return list;
  }

  /// Uniform in [0, 1) with 53 bits.
  double rand() { return words_.uniform53(); }

  /// A standard normal value, by the polar method. Two are made at a time; the second is kept for the next call.
  double randn() {
    if (spare_) return *std::exchange(spare_, std::nullopt);
    double x = 0, y = 0, r2 = 0;
    do {
      x = 2.0 * rand() - 1.0;
      y = 2.0 * rand() - 1.0;
      r2 = x * x + y * y;
    } while (r2 >= 1.0 || r2 == 0.0);
    const double factor = std::sqrt(-2.0 * std::log(r2) / r2);
    spare_ = factor * x;
    return factor * y;
  }

 private:
  /// Uniform in 0 ... largest: words cut to the bits of `largest` until one fits. 0 draws nothing.
  std::uint64_t at_most(std::uint64_t largest) {
    if (largest == 0) return 0;
    const std::uint64_t mask = ~std::uint64_t{0} >> (64 - std::bit_width(largest));
    std::uint64_t r = 0;
    do {
      r = words_();
      if (largest >> 32 != 0) r = r << 32 | words_();
      r &= mask;
    } while (r > largest);
    return r;
  }

  Mt19937 words_;
  std::optional<double> spare_;
};

MOTIONLANG_NAMESPACE_END
