// SPDX-License-Identifier: MIT
/// Instruction sets beyond the plain ones of the compiler, chosen while the program runs: one binary for all
/// processors.
///
/// MOTIONLANG_KERNELS (portable, avx2, avx512, avx512_bf16, amx) in the environment chooses instead of the processor.
#pragma once

#include <array>    // names
#include <cstdlib>  // getenv
#include <cstring>  // strcmp

#if defined(__x86_64__)
#include <cpuid.h>  // what the processor has
#if defined(__linux__)
#include <sys/syscall.h>  // arch_prctl
#include <unistd.h>       // syscall
#endif
#endif

#include <motionlang/core/error.hpp>

#if defined(__x86_64__)
// What a compiler may use in code for these sets (GCC and clang: target attribute), and what processor_has asks for.
#define MOTIONLANG_AVX2 "avx2,fma"
#define MOTIONLANG_AVX512 "avx512f,avx512vl,avx512dq,avx512bw," MOTIONLANG_AVX2
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Each has those before it; the last two differ from avx512 in products of bfloat16 only.
enum class Isa { portable, avx2, avx512, avx512_bf16, amx, best };

#if defined(__x86_64__)
/// Bit of a register (EAX 0 ... EDX 3) that the CPUID instruction gives for leaf 7.
inline bool cpuid_bit(unsigned subleaf, int register_number, int bit) {
  unsigned r[4] = {};
  return __get_cpuid_count(7, subleaf, &r[0], &r[1], &r[2], &r[3]) != 0 && (r[register_number] >> bit & 1u) != 0;
}
inline bool has_amx_bf16() { return cpuid_bit(0, 3, 24) && cpuid_bit(0, 3, 22); }
/// Programs must ask Linux for the registers of AMX once (ARCH_REQ_XCOMP_PERM, XFEATURE_XTILEDATA).
inline bool may_use_amx() {
#if defined(__linux__)
  return syscall(SYS_arch_prctl, 0x1023, 18) == 0;
#else
  return false;
#endif
}
#endif

inline bool processor_has(Isa isa) {
#if defined(__x86_64__)
  switch (isa) {
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case Isa::avx512:
      return processor_has(Isa::avx2) && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
    case Isa::avx512_bf16:
      return processor_has(Isa::avx512) && cpuid_bit(1, 0, 5);
    case Isa::amx:
      return processor_has(Isa::avx512) && has_amx_bf16() && may_use_amx();
    default:
      return true;
  }
#else
  return isa == Isa::portable || isa == Isa::best;
#endif
}

/// What MOTIONLANG_KERNELS names, or the best. Throws config_error 103 for a name that is none, or that this processor
/// lacks.
inline Isa wanted_isa() {
  static const Isa wanted = [] {
    const char* name = std::getenv("MOTIONLANG_KERNELS");
    if (name == nullptr || *name == 0) return Isa::best;
    constexpr std::array<const char*, 5> names{"portable", "avx2", "avx512", "avx512_bf16", "amx"};
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto isa = static_cast<Isa>(i);
      if (std::strcmp(name, names[i]) == 0 && processor_has(isa)) return isa;
    }
    raise<config_error>(103, "MOTIONLANG_KERNELS=", name,
                        " is not one of portable, avx2, avx512, avx512_bf16, amx, or not in this processor");
  }();
  return wanted;
}

// Clang inlines less into such functions than GCC, and what is not inlined stays narrow.
#if defined(__x86_64__) && !defined(__clang__)
#define MOTIONLANG_WIDER_COPIES
/// avx512, avx2 or portable: what code with vectors only can be told apart by.
inline Isa widest_vectors() {
  for (const Isa isa : {Isa::avx512, Isa::avx2}) {
    if (wanted_isa() >= isa && processor_has(isa)) return isa;
  }
  return Isa::portable;
}
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
