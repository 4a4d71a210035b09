// SPDX-License-Identifier: MIT
/// Instruction sets beyond the compiler's default, chosen at run time: one binary for all processors.
///
/// The environment variable MOTIONLANG_KERNELS (portable, avx2, avx512, avx512_bf16, amx) overrides the choice.
#pragma once

#include <motionlang/version.hpp>

#if defined(__x86_64__)
// Features for the target attribute of GCC and Clang in code for these sets; processor_has asks for them.
#define MOTIONLANG_AVX2 "avx2,fma"
#define MOTIONLANG_AVX512 "avx512f,avx512vl,avx512dq,avx512bw," MOTIONLANG_AVX2
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Each set includes those before it. The last two differ from avx512 only in products of bfloat16.
enum class Isa { portable, avx2, avx512, avx512_bf16, amx, best };

#if defined(__x86_64__)
bool has_amx_bf16();
#endif

bool processor_has(Isa isa);

/// The set that MOTIONLANG_KERNELS names, or the best one. Throws config_error 103 for an unknown name and for one that
/// this processor lacks.
Isa wanted_isa();

// Clang inlines less into such functions than GCC, and code that is not inlined uses narrow registers.
#if defined(__x86_64__) && !defined(__clang__)
#define MOTIONLANG_WIDER_COPIES
/// avx512, avx2 or portable: the sets that matter for code without products of bfloat16.
Isa widest_vectors();
template <class F>
__attribute__((target(MOTIONLANG_AVX2), flatten)) void with_avx2(const F& f) {
  f();
}
template <class F>
__attribute__((target(MOTIONLANG_AVX512), flatten)) void with_avx512(const F& f) {
  f();
}
#endif

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/instruction_set.ipp>
#endif
