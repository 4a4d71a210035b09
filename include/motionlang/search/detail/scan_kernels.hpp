// SPDX-License-Identifier: MIT
/// The kernels of a scan over vectors. They complement those of backend/detail/kernels.hpp and are chosen like them.
#pragma once

#include <motionlang/backend/detail/kernels.hpp>
#include <motionlang/core/half.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// Entry points of one instruction set.
template <class S>
struct ScanKernels {
  void (*dot_rows)(const S* rows, Index count, Index width, const S* query, S* out);
  void (*dot_half_rows)(const std::uint16_t* rows, Index count, Index width, const S* pairs, S* out);
  void (*dot_code_rows)(const std::int8_t* rows, const S* bounds, Index count, Index width, const S* query, S* out);
  void (*widen_codes)(const std::int8_t* x, Index width, S* y);
  void (*bound_rows)(S* c, const S* bounds, Index rows, Index pitch, Index columns);
  void (*split_quads)(const S* x, Index width, S* y);
  void (*split_pairs)(const S* query, Index width, S* pairs);
  void (*widen_row)(const std::uint16_t* x, Index width, S* y);
  void (*column_maxima)(const S* c, Index rows, Index pitch, Index columns, S* out);
  Index (*first_above)(const S* x, Index from, Index n, S limit);
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END

#define MOTIONLANG_INLINE inline __attribute__((always_inline))
#define MOTIONLANG_ISA portable
#include <motionlang/search/detail/scan.inc>
#undef MOTIONLANG_ISA

#ifdef MOTIONLANG_WIDE_KERNELS
MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX2)
#define MOTIONLANG_ISA avx2
#include <motionlang/search/detail/scan.inc>
#undef MOTIONLANG_ISA
MOTIONLANG_TARGET_POP

MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX512)
#define MOTIONLANG_ISA avx512
#include <motionlang/search/detail/scan.inc>
#undef MOTIONLANG_ISA
MOTIONLANG_TARGET_POP
#endif
#undef MOTIONLANG_INLINE

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The scan kernels for the instruction set of `kernels`, whose panels they read.
template <class S>
const ScanKernels<S>& scan_kernels(const Kernels<S>& kernels) {
#ifdef MOTIONLANG_WIDE_KERNELS
  if (kernels.isa == Isa::avx2) return avx2::scan_table<S>();
  if (kernels.isa != Isa::portable) return avx512::scan_table<S>();
#else
  static_cast<void>(kernels);
#endif
  return portable::scan_table<S>();
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
