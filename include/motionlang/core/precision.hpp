// SPDX-License-Identifier: MIT
/// The precision of matrix products.
#pragma once

#include <atomic>       // one setting for all threads
#include <optional>     // no such name
#include <string_view>  // names

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// fp32    the values as they are.
/// bf16    Both factors are rounded to bfloat16 (8 bits of significand); products and sums are float. Prepared weights
///         take half the memory. The speed is up to ten times as high where the processor has instructions for it. An
///         element of a product over k differs from the exact one by at most (2^-7 + 2^-16) sum_k |a_k b_k|. The sum,
///         which may start with a bias, is also rounded. Values below 2^-126 may count as 0.
/// bf16x3  fp32 by AMX: a float is the sum of three bfloat16, whose products are added. It is for weights of 128 x 128
///         and more; smaller ones, and other processors, use fp32. It has half the error of fp32 while products are
///         above 2^-108 (below 2^-126 they count as 0). The last digits differ. Use it for many rows and few threads.
///         With two threads, large products take 0.6 to 0.9 of the time, and those of a few rows up to four times as
///         long. With 8 and 16 threads of one machine, large ones took 1.1 to 2.3 times as long, because AMX is slower
///         there when every core uses it.
/// All other arithmetic stays in float. Only the kernels of the Eigen and xtensor backends in float follow this.
enum class Precision { fp32, bf16, bf16x3 };

/// "fp32", ...
inline const char* precision_name(Precision p) {
  return p == Precision::bf16 ? "bf16" : p == Precision::bf16x3 ? "bf16x3" : "fp32";
}
/// The opposite. Nothing if the name is unknown.
inline std::optional<Precision> precision_named(std::string_view name) {
  for (const Precision p : {Precision::fp32, Precision::bf16, Precision::bf16x3}) {
    if (name == precision_name(p)) return p;
  }
  return {};
}

namespace detail {
inline std::atomic<Precision>& current_product_precision() {
  static std::atomic<Precision> current{Precision::fp32};
  return current;
}
}  // namespace detail

/// Precision for the whole process, of weights that are prepared from now on and of products without a prepared weight.
/// backend/precision.hpp changes it, and prepares a model in another.
inline Precision product_precision() { return detail::current_product_precision().load(std::memory_order_acquire); }

MOTIONLANG_NAMESPACE_END
