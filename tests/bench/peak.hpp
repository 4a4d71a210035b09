// The measured peak of the machine: independent multiply-adds that stay in registers, on all threads of the pool. It
// changes with the clock and with other programs, so each comparison measures it again. MOTIONLANG_KERNELS limits its
// instructions, as it limits the kernels.
#pragma once

#include <algorithm>
#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <motionlang/core/instruction_set.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/core/precision.hpp>

#include "clock.hpp"

namespace bench {

namespace detail {

using motionlang::detail::Isa;
inline bool may_use(Isa isa) {
  return motionlang::detail::wanted_isa() >= isa && motionlang::detail::processor_has(isa);
}

/// A piece of work for one thread: so many multiplications and additions.
struct Piece {
  void (*run)();
  double flop;
};
constexpr long rounds = 2000;

// Twelve sums: more than latency times units of any processor so far, and registers for all of them. The numbers stay
// close to 1. The compiler must not know that they are equal.
#define MOTIONLANG_BENCH_UNKNOWN(a, b, c, d, e, f) asm volatile("" : MOTIONLANG_BENCH_REGISTERS(a, b, c, d, e, f))
#define MOTIONLANG_BENCH_FMA(name, attribute, bytes)                                            \
  attribute __attribute__((noinline)) inline void name() {                                      \
    typedef float Vector __attribute__((vector_size(bytes)));                                   \
    const Vector x = Vector{} + 0.5f, y = x;                                                    \
    Vector a = x, b = x, c = x, d = x, e = x, f = x, g = x, h = x, i = x, j = x, k = x, l = x;  \
    MOTIONLANG_BENCH_UNKNOWN(a, b, c, d, e, f);                                                 \
    MOTIONLANG_BENCH_UNKNOWN(g, h, i, j, k, l);                                                 \
    for (long n = 0; n < rounds; ++n) {                                                         \
      a = a * x + y, b = b * x + y, c = c * x + y, d = d * x + y, e = e * x + y, f = f * x + y; \
      g = g * x + y, h = h * x + y, i = i * x + y, j = j * x + y, k = k * x + y, l = l * x + y; \
    }                                                                                           \
    MOTIONLANG_BENCH_UNKNOWN(a, b, c, d, e, f);                                                 \
    MOTIONLANG_BENCH_UNKNOWN(g, h, i, j, k, l);                                                 \
  }

#if defined(__x86_64__)
#define MOTIONLANG_BENCH_REGISTERS(a, b, c, d, e, f) "+v"(a), "+v"(b), "+v"(c), "+v"(d), "+v"(e), "+v"(f)
MOTIONLANG_BENCH_FMA(fma_512, __attribute__((target("avx512f"))), 64)
MOTIONLANG_BENCH_FMA(fma_256, __attribute__((target("avx2,fma"))), 32)
#else
#define MOTIONLANG_BENCH_REGISTERS(a, b, c, d, e, f) "+w"(a), "+w"(b), "+w"(c), "+w"(d), "+w"(e), "+w"(f)
#endif
MOTIONLANG_BENCH_FMA(fma_128, , 16)

inline Piece fp32_piece() {
  constexpr double lanes = 12 * 2.0 * rounds / 4;  // of a vector of one byte
#if defined(__x86_64__)
  if (may_use(Isa::avx512)) return {fma_512, 64 * lanes};
  if (may_use(Isa::avx2)) return {fma_256, 32 * lanes};
#endif
  return {fma_128, 16 * lanes};
}

#if defined(__x86_64__)
__attribute__((target("avx512f,avx512bf16"), noinline)) inline void dot_products() {
  const __m512bh x = (__m512bh)_mm512_set1_epi16(0x3c00), y = x;  // 1/128
  __m512 a{}, b = a, c = a, d = a, e = a, f = a, g = a, h = a, i = a, j = a, k = a, l = a;
  MOTIONLANG_BENCH_UNKNOWN(a, b, c, d, e, f);
  MOTIONLANG_BENCH_UNKNOWN(g, h, i, j, k, l);
  for (long n = 0; n < rounds; ++n) {
    a = _mm512_dpbf16_ps(a, x, y), b = _mm512_dpbf16_ps(b, x, y), c = _mm512_dpbf16_ps(c, x, y);
    d = _mm512_dpbf16_ps(d, x, y), e = _mm512_dpbf16_ps(e, x, y), f = _mm512_dpbf16_ps(f, x, y);
    g = _mm512_dpbf16_ps(g, x, y), h = _mm512_dpbf16_ps(h, x, y), i = _mm512_dpbf16_ps(i, x, y);
    j = _mm512_dpbf16_ps(j, x, y), k = _mm512_dpbf16_ps(k, x, y), l = _mm512_dpbf16_ps(l, x, y);
  }
  MOTIONLANG_BENCH_UNKNOWN(a, b, c, d, e, f);
  MOTIONLANG_BENCH_UNKNOWN(g, h, i, j, k, l);
}

struct alignas(64) TileShapes {
  std::uint8_t palette = 1, start = 0, reserved[14] = {};
  std::uint16_t bytes[16] = {64, 64, 64, 64, 64, 64};
  std::uint8_t rows[16] = {16, 16, 16, 16, 16, 16};
};
/// Four tiles of sums, each 16 x 16 products of 32 numbers a time. The thread's own tile shapes are put back.
__attribute__((target("amx-tile,amx-bf16"), noinline)) inline void tile_products() {
  alignas(64) unsigned char before[64];
  static constexpr TileShapes
      ours;  // not on the stack: the intrinsic names the first bytes only, the rest would not be written
  _tile_storeconfig(before);
  _tile_loadconfig(&ours);
  _tile_zero(0);
  _tile_zero(1);
  _tile_zero(2);
  _tile_zero(3);
  _tile_zero(4);
  _tile_zero(5);
  for (long n = 0; n < rounds / 10; ++n) {
    _tile_dpbf16ps(0, 4, 5);
    _tile_dpbf16ps(1, 4, 5);
    _tile_dpbf16ps(2, 4, 5);
    _tile_dpbf16ps(3, 4, 5);
  }
  if (before[0] == 0) return _tile_release();
  _tile_loadconfig(before);
}
#endif

/// bfloat16 factors, float sums: by tiles, by dot products, or as numbers in float.
inline Piece bf16_piece() {
#if defined(__x86_64__)
  if (may_use(Isa::amx)) return {tile_products, 4 * 2.0 * 16 * 16 * 32 * static_cast<double>(rounds / 10)};
  if (may_use(Isa::avx512_bf16)) return {dot_products, 12 * 2.0 * 32 * static_cast<double>(rounds)};
#endif
  return fp32_piece();
}

#undef MOTIONLANG_BENCH_REGISTERS
#undef MOTIONLANG_BENCH_UNKNOWN
#undef MOTIONLANG_BENCH_FMA

}  // namespace detail

/// The most that was seen in ten pieces, half a millisecond together, in 1e9 multiplications and additions a second.
inline double peak_gflops(motionlang::Precision precision) {
  static const detail::Piece pieces[] = {detail::fp32_piece(), detail::bf16_piece()};
  const auto& piece = pieces[precision == motionlang::Precision::bf16 ? 1 : 0];
  const motionlang::Index count = 16 * motionlang::thread_count();
  double best = 0;
  for (int i = 0; i < 10; ++i) {
    const double start = now();
    motionlang::parallel_for(count, [&](motionlang::Index) { piece.run(); });
    best = std::max(best, static_cast<double>(count) * piece.flop / (now() - start));
  }
  return best * 1e-9;
}

}  // namespace bench
