// SPDX-License-Identifier: MIT
// Bodies of instruction_set.hpp.
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
#include <motionlang/core/instruction_set.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

#if defined(__x86_64__)
/// Bit of a register (EAX 0 ... EDX 3) that the CPUID instruction gives for leaf 7.
inline bool cpuid_bit(unsigned subleaf, int register_number, int bit) {
  unsigned r[4] = {};
  return __get_cpuid_count(7, subleaf, &r[0], &r[1], &r[2], &r[3]) != 0 && (r[register_number] >> bit & 1u) != 0;
}
MOTIONLANG_BODY bool has_amx_bf16() { return cpuid_bit(0, 3, 24) && cpuid_bit(0, 3, 22); }

/// Programs must ask Linux for the registers of AMX once (ARCH_REQ_XCOMP_PERM, XFEATURE_XTILEDATA).
inline bool may_use_amx() {
#if defined(__linux__)
  return syscall(SYS_arch_prctl, 0x1023, 18) == 0;
#else
  return false;
#endif
}
#endif

MOTIONLANG_BODY bool processor_has(Isa isa) {
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

MOTIONLANG_BODY Isa wanted_isa() {
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

#ifdef MOTIONLANG_WIDER_COPIES
MOTIONLANG_BODY Isa widest_vectors() {
  for (const Isa isa : {Isa::avx512, Isa::avx2}) {
    if (wanted_isa() >= isa && processor_has(isa)) return isa;
  }
  return Isa::portable;
}
#endif

}  // namespace detail

MOTIONLANG_NAMESPACE_END
