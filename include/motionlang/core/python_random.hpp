// SPDX-License-Identifier: MIT
/// CPython's generator: `random.seed(seed)` followed by the functions of the module `random`, for parity with published
/// runs (frame sampling, ties of STMC, the MTT data set).
///
/// Source  CPython 3.11, Lib/random.py and Modules/_randommodule.c
#pragma once

#include <algorithm>  // find, upper_bound
#include <bit>        // bit_width
#include <cmath>      // log, cos, sin
#include <concepts>   // integral
#include <cstdint>    // words
#include <numbers>    // pi
#include <numeric>    // iota, partial_sum
#include <optional>   // the second number of gauss
#include <span>       // lists
#include <utility>    // exchange, swap
#include <vector>     // samples

#include <motionlang/core/mt19937.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class PythonRandom {
 public:
  /// For a negative seed, the absolute value counts.
  template <std::integral I>
  explicit PythonRandom(I seed)
      : PythonRandom(seed < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(seed)
                              : static_cast<std::uint64_t>(seed)) {}
  explicit PythonRandom(std::uint64_t seed)
      : PythonRandom(std::span<const std::uint32_t>(Words(seed).w, seed >> 32 != 0 ? 2 : 1)) {}
  /// A seed of any size, as 32-bit words, least significant first.
  explicit PythonRandom(std::span<const std::uint32_t> key) : words_(key) {}

  /// Uniform in [0, 1).
  double random() { return words_.uniform53(); }
  double uniform(double a, double b) { return a + (b - a) * random(); }

  /// An integer of `bits` random bits. Throws config_error 101 above 64 bits.
  std::uint64_t getrandbits(int bits) {
    if (bits < 0 || bits > 64) raise<config_error>(101, "PythonRandom::getrandbits: ", bits, " bits");
    if (bits == 0) return 0;
    if (bits <= 32) return words_() >> (32 - bits);
    const std::uint64_t low = words_();
    return low | std::uint64_t{words_() >> (64 - bits)} << 32;
  }

  /// Uniform in 0 ... n-1, by rejection. Throws config_error 101 if n is 0.
  std::uint64_t below(std::uint64_t n) {
    if (n == 0) raise<config_error>(101, "PythonRandom::below: n is 0");
    const int bits = static_cast<int>(std::bit_width(n));
    std::uint64_t r = getrandbits(bits);
    while (r >= n) r = getrandbits(bits);
    return r;
  }

  /// Uniform in a ... b, both included. Throws config_error 101 if b < a.
  std::int64_t randint(std::int64_t a, std::int64_t b) {
    const std::uint64_t width = static_cast<std::uint64_t>(b) - static_cast<std::uint64_t>(a) + 1;
    if (b < a || width == 0) raise<config_error>(101, "PythonRandom::randint: from ", a, " to ", b);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + below(width));
  }

  /// Position of `random.choice` in a list of n. Throws config_error 101 if n is 0.
  Index choice(Index n) { return static_cast<Index>(below(size_of(n, "choice"))); }

  template <class T>
  void shuffle(std::span<T> list) {
    for (std::size_t i = list.size(); i-- > 1;) std::swap(list[i], list[below(i + 1)]);
  }
  template <class T>
  void shuffle(std::vector<T>& list) {
    shuffle(std::span<T>(list));
  }

  /// Normal number. Two are made at a time; the second is kept for the next call, whatever is drawn in between.
  double gauss(double mean, double standard_deviation) {
    double z = 0;
    if (spare_) {
      z = *std::exchange(spare_, std::nullopt);
    } else {
      const double angle = 2.0 * std::numbers::pi * random(), radius = std::sqrt(-2.0 * std::log(1.0 - random()));
      z = std::cos(angle) * radius;
      spare_ = std::sin(angle) * radius;
    }
    return mean + z * standard_deviation;
  }

  /// `random.sample(range(n), k)`: k different numbers below n. Throws config_error 101 unless 0 <= k <= n.
  std::vector<Index> sample(Index n, Index k) {
    if (k < 0 || k > n) raise<config_error>(101, "PythonRandom::sample: ", k, " of ", n);
    std::vector<Index> out;
    out.reserve(static_cast<std::size_t>(k));
    if (n <= largest_pool(k)) {
      std::vector<Index> pool(static_cast<std::size_t>(n));
      std::iota(pool.begin(), pool.end(), Index{0});
      while (std::ssize(out) < k) {
        const std::size_t j = below(pool.size());
        out.push_back(std::exchange(pool[j], pool.back()));
        pool.pop_back();
      }
    } else {
      std::vector<Index> taken;  // sorted
      while (std::ssize(out) < k) {
        const Index j = choice(n);
        const auto place = std::lower_bound(taken.begin(), taken.end(), j);
        if (place != taken.end() && *place == j) continue;
        taken.insert(place, j);
        out.push_back(j);
      }
    }
    return out;
  }

  /// `random.sample(range(len(counts)), k, counts=counts)`: draws from a list that has element i counts[i] times.
  /// Throws config_error 101 if the list has fewer than k elements or a count is negative.
  std::vector<Index> sample_counts(std::span<const Index> counts, Index k) {
    for (Index c : counts) {
      if (c < 0) raise<config_error>(101, "PythonRandom::sample_counts: count ", c);
    }
    std::vector<Index> upto(counts.size());
    std::partial_sum(counts.begin(), counts.end(), upto.begin());
    std::vector<Index> out = sample(upto.empty() ? 0 : upto.back(), k);
    for (Index& i : out) i = std::upper_bound(upto.begin(), upto.end(), i) - upto.begin();
    return out;
  }

 private:
  struct Words {
    explicit Words(std::uint64_t n) : w{static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(n >> 32)} {}
    std::uint32_t w[2];
  };

  static std::uint64_t size_of(Index n, const char* call) {
    if (n <= 0) raise<config_error>(101, "PythonRandom::", call, ": a list of ", n);
    return static_cast<std::uint64_t>(n);
  }
  /// Up to this size, a list is copied and drawn from. Above it, numbers are drawn again until they are new. The size
  /// is 21 + 4^ceil(log_4(3k)) for k > 5, else 21.
  static Index largest_pool(Index k) {
    Index table = 1;
    while (k > 5 && table < 3 * k) table *= 4;
    return k > 5 ? 21 + table : 21;
  }

  Mt19937 words_;
  std::optional<double> spare_;
};

MOTIONLANG_NAMESPACE_END
