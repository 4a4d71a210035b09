// SPDX-License-Identifier: MIT
/// PyTorch's CPU generator: `torch.manual_seed(seed)` followed by `torch.randn` or `torch.rand`, for parity with
/// published runs. The streams of CUDA come from another generator, which is not covered.
///
/// Source      torch 1.13, aten/src/ATen/native/cpu/DistributionTemplates.h (normal_fill) and
///             ATen/core/DistributionsHelper.h (small draws)
/// Differs     by less than 1e-6 from torch's vectorised kernels, which approximate log and cos. Uniform values and the
///             float64 path do not differ
#pragma once

#include <cmath>     // log, cos, sin
#include <cstdint>   // seed
#include <numbers>   // pi
#include <optional>  // the spare number of small draws
#include <span>      // output
#include <utility>   // exchange

#include <motionlang/core/concepts.hpp>
#include <motionlang/core/mt19937.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class TorchRandom {
 public:
  /// Only the low 32 bits of the seed count, as in PyTorch.
  explicit TorchRandom(std::uint64_t seed = 5489) : words_(static_cast<std::uint32_t>(seed)) {}

  /// `torch.rand`: 24 bits of one word for float, 53 bits of two words for double.
  template <Scalar S>
  void uniform(std::span<S> out) {
    for (S& u : out) u = uniform<S>();
  }
  void uniform(std::span<float> out) { uniform<float>(out); }

  /// `torch.randn` of a whole tensor of out.size() elements. The result depends on the division of a draw into tensors.
  /// Fewer than 16 elements: one pair of values at a time in double, the second kept for the next small draw.
  /// Otherwise, all elements are first filled with uniform values. Then every block of 16 is transformed (Box-Muller,
  /// element j with element j + 8). If blocks do not fit, the last 16 elements are drawn again.
  template <Scalar S>
  void normal(std::span<S> out) {
    if (out.size() < block) {
      for (S& z : out) z = static_cast<S>(one_normal());
      return;
    }
    uniform(out);
    const std::size_t rest = out.size() % block;
    for (std::size_t at = 0; at + block <= out.size(); at += block) to_normal(out.subspan(at).template first<block>());
    if (rest != 0) {
      const auto last = out.template last<block>();
      uniform(std::span<S>(last));
      to_normal(last);
    }
  }
  void normal(std::span<float> out) { normal<float>(out); }

 private:
  static constexpr std::size_t block = 16;

  template <Scalar S>
  S uniform() {
    if constexpr (sizeof(S) == 4) return static_cast<S>(words_() & 0xFFFFFFu) * S(0x1p-24);
    const std::uint64_t high = words_(), low = words_();
    return static_cast<S>(static_cast<double>((high << 32 | low) & ((std::uint64_t{1} << 53) - 1)) * 0x1p-53);
  }

  double one_normal() {
    if (spare_) return *std::exchange(spare_, std::nullopt);
    const double u1 = uniform<double>(), u2 = uniform<double>();
    const double radius = std::sqrt(-2.0 * std::log1p(-u2)), angle = 2.0 * std::numbers::pi * u1;
    spare_ = radius * std::sin(angle);
    return radius * std::cos(angle);
  }

  template <Scalar S>
  static void to_normal(std::span<S, block> values) {
    for (std::size_t j = 0; j < block / 2; ++j) {
      const double radius = std::sqrt(-2.0 * std::log(1.0 - static_cast<double>(values[j])));
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(values[j + block / 2]);
      values[j] = static_cast<S>(radius * std::cos(angle));
      values[j + block / 2] = static_cast<S>(radius * std::sin(angle));
    }
  }

  Mt19937 words_;
  std::optional<double> spare_;
};

MOTIONLANG_NAMESPACE_END
