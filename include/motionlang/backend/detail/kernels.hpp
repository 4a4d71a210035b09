// SPDX-License-Identifier: MIT
/// The kernels behind the Eigen and xtensor backends: one source, compiled for several instruction sets, chosen at run
/// time.
///
/// The files *.inc are included once per instruction set, and the compiler generates code for that set. `kernels<S>()`
/// is the table of the best set that this processor has. So a program that is built without -march runs as fast as one
/// that is built for the machine. Other processors use the first table, in 16-byte vectors of the compiler (SSE2, NEON,
/// ...). Kernels know pointers, sizes and ranges of rows, but no tensors or threads.
#pragma once

#include <algorithm>    // min, max
#include <atomic>       // kernels of the current precision
#include <cmath>        // sqrt, erf, tanh
#include <cstddef>      // byte
#include <cstdint>      // bit patterns
#include <cstring>      // memcpy
#include <limits>       // infinity
#include <type_traits>  // conditional
#include <utility>      // integer_sequence

#include <motionlang/backend/detail/gelu_table.hpp>
#include <motionlang/core/activation.hpp>
#include <motionlang/core/concepts.hpp>
#include <motionlang/core/dropout.hpp>
#include <motionlang/core/error.hpp>
#include <motionlang/core/instruction_set.hpp>
#include <motionlang/core/standard_library.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// c (m x n) = act(a (m x k) B + bias + residual). B is packed in panels.
template <class S>
struct Gemm {
  Index m = 0, n = 0, k = 0;
  const S* a = nullptr;
  Index lda = 0;  // distance between rows of a (of its transpose, (k x m), if a_transposed)
  bool a_transposed = false;
  const S* panels = nullptr;
  S* c = nullptr;
  Index ldc = 0;
  const S* bias = nullptr;
  const S* residual = nullptr;
  Index ldr = 0;
  Activation act = Activation::none;
  const std::byte* after = nullptr;  // read after this product: each panel prefetches its share of it
  Index after_bytes = 0;

  /// The place in `after` for a thread that has multiplied panels first, first + 1, ... of `count`; `otherwise` if
  /// there is no `after`.
  const std::byte* following(Index first, Index count, const void* otherwise) const {
    return after == nullptr ? static_cast<const std::byte*>(otherwise) : after + after_bytes / 64 * first / count * 64;
  }
};

/// Attention over packed sequences: q (query rows, heads * width), k and v (key rows, ...), each a part of a wider
/// tensor.
template <class S>
struct Attention {
  const S *q = nullptr, *k = nullptr, *v = nullptr;
  Index q_stride = 0, k_stride = 0, v_stride = 0;
  S* o = nullptr;
  Index o_stride = 0;
  const Index *q_offsets = nullptr, *k_offsets = nullptr;
  Index heads = 1, width = 0;
  bool causal = false;
  Dropout dropout{};
  // forward only: (heads, 2 reach + 1), the number of distance d in column d + reach
  const S* relative_scores = nullptr;
  Index reach = 0;
};
template <class S>
struct AttentionGradients {
  const S* d_o = nullptr;
  S *d_q = nullptr, *d_k = nullptr, *d_v = nullptr;  // strides as q, k, v
};

template <class S>
struct LayerNorm {
  const S *x = nullptr, *residual = nullptr, *weight = nullptr, *bias = nullptr;
  Index width = 0;
  S eps = S(1e-5);
  S* y = nullptr;
};

/// y (rows, width) = act(z^T + bias + residual), z (width, rows).
template <class S>
struct Transposed {
  const S *z = nullptr, *bias = nullptr, *residual = nullptr;
  Index rows = 0, width = 0;
  Activation act = Activation::none;
  S* y = nullptr;
};

template <class S>
struct AdamwStep {
  S *p = nullptr, *m = nullptr, *v = nullptr;
  const S* g = nullptr;
  S beta1{}, rest1{}, beta2{}, rest2{}, step{}, correction{}, eps{}, decay{}, gradient_scale{};
};

/// y[i] = op(a[i], b[i]). A repeated operand has one value for all i.
enum class BinaryOp { add, sub, mul, div, maximum };
template <class S>
struct Binary {
  BinaryOp op{};
  const S *a = nullptr, *b = nullptr;
  bool a_repeated = false, b_repeated = false;
  Index count = 0;
  S* y = nullptr;  // may be a or b
};

/// Products with the same panels in tiles of bfloat16. Every float becomes three bfloat16 (Precision::bf16x3,
/// float_tiles.inc).
struct FloatTiles {
  Index tile_rows;
  Index (*gemm_rows)(Index k);
  Index (*gemm_scratch)(Index k);
  void (*gemm_block)(const Gemm<float>&, Index r0, Index r1, Index j0, Index j1, float* scratch);
};

/// Entry points of one instruction set.
template <class S>
struct Kernels {
  Isa isa;
  const char* name;
  Index panel_width, tile_rows;
  Index (*gemm_rows)(Index k);     // of A in a block
  Index (*gemm_scratch)(Index k);  // values
  void (*pack_rows)(const S* b, Index k, Index n, Index stride, Index k0, Index k1, S* panels);
  bool (*pack_transposed)(const S* b, Index k, Index n, Index stride, Index first, Index last, S* panels);
  void (*gemm_block)(const Gemm<S>&, Index r0, Index r1, Index j0, Index j1, S* scratch);
  Index (*attention_scratch)(Index keys, Index width);
  void (*attention_head)(const Attention<S>&, Index sequence, Index head, Index piece, Index pieces, S* scratch);
  void (*dropout)(const S* x, Index n, Index first, const Dropout&, S* y);
  void (*layer_norm_rows)(const LayerNorm<S>&, Index first, Index last);
  void (*softmax_rows)(const S* x, Index n, Index first, Index last, S* y, S* scratch);
  void (*transpose)(const Transposed<S>&, Index first, Index last);
  void (*activate)(const S* x, Index n, Activation, S* y);
  void (*binary)(const Binary<S>&);
  void (*error_function)(const S* x, Index n, S* y);
  void (*row_sums)(const S* x, Index n, Index first, Index last, S* y);
  void (*column_sums)(const S* x, Index rows, Index width, Index first, Index last, S* y);
};
/// The same for training. It is a table of its own, so programs that do not train do not compile it.
template <class S>
struct GradientKernels {
  Index (*attention_scratch)(Index queries, Index keys, Index width);
  void (*attention_head)(const Attention<S>&, const AttentionGradients<S>&, Index sequence, Index head, S* scratch);
  void (*layer_norm_rows)(const LayerNorm<S>&, const S* dy, S* dx, S* moments, Index first, Index last);
  void (*layer_norm_columns)(const LayerNorm<S>&, const S* dy, const S* moments, S* dweight, S* dbias, Index rows,
                             Index first, Index last);
  void (*activate)(const S* x, const S* dy, Index n, Activation, S* dx);
  void (*adamw)(const AdamwStep<S>&, Index first, Index last);
};

/// Products of values that are rounded to bfloat16, with sums in float, and attention with such products. B is packed
/// in panels that are the same for all instruction sets, except values below 2^-126.
struct Bf16Kernels {
  const char* name;
  Index tile_rows;
  Index (*gemm_rows)(Index k);     // of A in a block
  Index (*gemm_scratch)(Index k);  // values
  void (*pack_rows)(const float* b, Index k, Index n, Index stride, Index k0, Index k1, std::uint16_t* panels);
  bool (*pack_transposed)(const float* b, Index k, Index n, Index stride, Index first, Index last,
                          std::uint16_t* panels);
  void (*gemm_block)(const Gemm<float>&, const std::uint16_t* panels, Index r0, Index r1, Index j0, Index j1,
                     float* scratch);
  Index (*attention_scratch)(Index keys, Index width);
  void (*attention_head)(const Attention<float>&, Index sequence, Index head, Index piece, Index pieces,
                         float* scratch);
  Index (*attention_vjp_scratch)(Index queries, Index keys, Index width);
  void (*attention_head_vjp)(const Attention<float>&, const AttentionGradients<float>&, Index sequence, Index head,
                             float* scratch);
};
/// The columns of a panel, and its rows: k, padded to whole tiles.
inline constexpr Index bf16_columns = 32;
constexpr Index bf16_depth(Index k) { return std::max<Index>(32, (k + 31) / 32 * 32); }

}  // namespace detail
MOTIONLANG_NAMESPACE_END

// GCC and clang spell "generate code for these instructions" differently.
#if defined(__clang__)
#define MOTIONLANG_PRAGMA(text) _Pragma(#text)
#define MOTIONLANG_TARGET_PUSH(features) \
  MOTIONLANG_PRAGMA(clang attribute push(__attribute__((target(features))), apply_to = function))
#define MOTIONLANG_TARGET_POP _Pragma("clang attribute pop")
#else
#define MOTIONLANG_PRAGMA(text) _Pragma(#text)
#define MOTIONLANG_TARGET_PUSH(features) _Pragma("GCC push_options") MOTIONLANG_PRAGMA(GCC target(features))
#define MOTIONLANG_TARGET_POP _Pragma("GCC pop_options")
#endif

#define MOTIONLANG_ISA portable
#define MOTIONLANG_VECTOR_BYTES 16
#if defined(__OPTIMIZE__)
#define MOTIONLANG_TILE_ROWS 6
#else  // without the optimiser higher tiles would only take longer to compile
#define MOTIONLANG_TILE_ROWS 2
#endif
#include <motionlang/backend/detail/kernels.inc>
#undef MOTIONLANG_ISA
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS

// Without the optimiser the wider kernels would only compile more slowly.
#if defined(__x86_64__) && defined(__OPTIMIZE__)
#define MOTIONLANG_WIDE_KERNELS
MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX2)
#define MOTIONLANG_ISA avx2
#define MOTIONLANG_VECTOR_BYTES 32
#define MOTIONLANG_TILE_ROWS 6
#include <motionlang/backend/detail/kernels.inc>
#undef MOTIONLANG_ISA
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS
MOTIONLANG_TARGET_POP

MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX512)
#define MOTIONLANG_ISA avx512
#define MOTIONLANG_VECTOR_BYTES 64
#define MOTIONLANG_TILE_ROWS 14
#include <motionlang/backend/detail/kernels.inc>
#undef MOTIONLANG_ISA
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS
MOTIONLANG_TARGET_POP

#define MOTIONLANG_VECTOR_BYTES 64
#define MOTIONLANG_TILE_ROWS 14
#define MOTIONLANG_INLINE inline __attribute__((always_inline))
MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX512 ",avx512bf16,amx-tile,amx-bf16")
MOTIONLANG_NAMESPACE_BEGIN
namespace detail::avx512 {
#include <motionlang/backend/detail/bf16_x86.inc>
//
#include <motionlang/backend/detail/float_tiles.inc>

/// The kernels of AVX-512 under the name of AMX, because its tiles (float_tiles) belong to them.
inline const Kernels<float>& amx_table() {
  static const Kernels<float> t = [] {
    Kernels<float> k = table<float>();
    k.isa = Isa::amx, k.name = FloatTile::name;
    return k;
  }();
  return t;
}
inline const FloatTiles& float_tiles() {
  static constexpr FloatTiles t{FloatTile::rows, &float_tile_rows, &float_tile_scratch, &float_tile_block};
  return t;
}
}  // namespace detail::avx512
MOTIONLANG_NAMESPACE_END
MOTIONLANG_TARGET_POP
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS
#undef MOTIONLANG_INLINE
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The kernels of one instruction set, or nothing if this processor or this build does not have it.
template <class S>
const Kernels<S>* kernels_for(Isa isa) {
  if (isa == Isa::portable) return &portable::table<S>();
#if defined(MOTIONLANG_WIDE_KERNELS)
  if (isa == Isa::avx2) return processor_has(isa) ? &avx2::table<S>() : nullptr;
  if constexpr (std::is_same_v<S, float>) {
    if (isa == Isa::amx) return processor_has(isa) ? &avx512::amx_table() : nullptr;
  }
  if (isa != Isa::best) return processor_has(Isa::avx512) ? &avx512::table<S>() : nullptr;
#endif
  if (isa != Isa::best) return nullptr;
  for (Isa better : {Isa::amx, Isa::avx512, Isa::avx2}) {
    if (const auto* k = kernels_for<S>(better)) return k;
  }
  return &portable::table<S>();
}
/// The kernels for training of the instruction set of `kernels`.
template <class S>
const GradientKernels<S>& gradient_kernels_of(const Kernels<S>& kernels) {
#if defined(MOTIONLANG_WIDE_KERNELS)
  if (kernels.isa == Isa::avx2) return avx2::gradient_table<S>();
  if (kernels.isa != Isa::portable) return avx512::gradient_table<S>();
#else
  static_cast<void>(kernels);
#endif
  return portable::gradient_table<S>();
}
/// The tiles that belong to `kernels`. Nothing if all products use multiply-adds.
inline const FloatTiles* float_tiles_of(const Kernels<float>& kernels) {
#if defined(MOTIONLANG_WIDE_KERNELS)
  if (kernels.isa == Isa::amx) return &avx512::float_tiles();
#else
  static_cast<void>(kernels);
#endif
  return nullptr;
}
/// The same for products of bfloat16. AMX is best, then vdpbf16ps, then float instructions. On processors with AMX,
/// vdpbf16ps runs at half the speed of products in float.
inline const Bf16Kernels* bf16_kernels_for(Isa isa) {
  if (isa == Isa::portable) return &portable::bf16_table<portable::WideningTile>();
#if defined(MOTIONLANG_WIDE_KERNELS)
  if (!processor_has(isa)) return nullptr;
  if (isa == Isa::avx2) return &avx2::bf16_table<avx2::WideningTile>();
  if (isa == Isa::avx512) return &avx512::bf16_table<avx512::WideningTile>();
  if (isa == Isa::avx512_bf16) return &avx512::bf16_table<avx512::DotTile>();
  if (isa == Isa::amx) return &avx512::bf16_table<avx512::AmxTile<1>>();
  if (const auto* k = bf16_kernels_for(Isa::amx)) return k;
  if (!has_amx_bf16()) {
    if (const auto* k = bf16_kernels_for(Isa::avx512_bf16)) return k;
  }
#endif
  if (isa != Isa::best) return nullptr;
  for (Isa better : {Isa::avx512, Isa::avx2}) {
    if (const auto* k = bf16_kernels_for(better)) return k;
  }
  return bf16_kernels_for(Isa::portable);
}

/// `kernels`, if this build has them. Throws config_error 103.
template <class K>
const K* present(const K* kernels) {
  if (kernels == nullptr)
    raise<config_error>(103,
                        "MOTIONLANG_KERNELS: compiled without optimisation, a program has only the portable kernels");
  return kernels;
}

/// The table in use. Chosen once; tests and benchmarks may point it elsewhere.
template <class S>
const Kernels<S>*& current_kernels() {
  static const Kernels<S>* chosen = present(kernels_for<S>(wanted_isa()));
  return chosen;
}
template <class S>
const Kernels<S>& kernels() {
  return *current_kernels<S>();
}
inline const Bf16Kernels*& current_bf16_kernels() {
  static const Bf16Kernels* chosen = present(bf16_kernels_for(wanted_isa()));
  return chosen;
}

/// The kernels of precisions other than fp32. Only backend/precision.hpp and searches in bfloat16 compile them.
inline std::atomic<const Bf16Kernels*& (*)()> bf16_products{nullptr};
inline std::atomic<const FloatTiles* (*)(const Kernels<float>&)> tile_products{nullptr};
/// Makes bf16_product_kernels() callable. Call it before packing panels in bfloat16.
inline void use_bf16_products() { bf16_products.store(&current_bf16_kernels, std::memory_order_relaxed); }
/// The kernels of products in bfloat16. Precondition: use_bf16_products() was called.
inline const Bf16Kernels& bf16_product_kernels() { return *bf16_products.load(std::memory_order_relaxed)(); }

}  // namespace detail
MOTIONLANG_NAMESPACE_END
