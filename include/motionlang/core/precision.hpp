// SPDX-License-Identifier: MIT
/// How exactly products of matrices are computed.
#pragma once

#include <atomic>  // one setting for all threads

#include <motionlang/version.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// fp32  the numbers as they are, sums in float. With AMX (amx, core/instruction_set.hpp) products of many rows are calculated from three
///       bfloat16 for each float, which together are the float: 1.2 to 1.7 times as fast, half the error, other last digits. So the last
///       digits of a few rows may differ alone and in a larger batch; MOTIONLANG_KERNELS=avx512 multiplies both alike.
/// bf16  both factors rounded to bfloat16 (8 bits of significand), products and sums in float: half the memory for
///       prepared weights, and up to ten times the speed where the processor has instructions for it. An element of a
///       product over k differs from the exact one by at most (2^-7 + 2^-16) sum_k |a_k b_k|, besides the rounding of
///       the sum, of which a bias may be the first number. Numbers below 2^-126 may count as 0.
///       All other arithmetic stays in float. For the kernels of the Eigen and xtensor backends in float; others ignore it.
enum class Precision { fp32, bf16 };

namespace detail {
inline std::atomic<Precision>& current_product_precision() {
  static std::atomic<Precision> current{Precision::fp32};
  return current;
}
}  // namespace detail

inline Precision product_precision() { return detail::current_product_precision().load(std::memory_order_relaxed); }

/// Changes the precision of products for the whole process. Weights that were prepared in another precision are packed anew at every
/// use: set it before preparing a model.
inline void set_product_precision(Precision p) { detail::current_product_precision().store(p, std::memory_order_relaxed); }

}  // namespace motionlang::inline MOTIONLANG_ABI
