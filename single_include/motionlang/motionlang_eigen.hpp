// SPDX-License-Identifier: MIT
/// motionlang 0.1.0, generated from include/ by tests/tools/amalgamate.cpp. Changes belong there.
#pragma once

#include <motionlang/motionlang.hpp>

#ifndef MOTIONLANG_HAS_BACKEND_EIGEN_HPP  // <motionlang/backend/eigen.hpp>
#define MOTIONLANG_HAS_BACKEND_EIGEN_HPP
/// Backend over Eigen: functions and maxima are Eigen expressions over mapped memory. Arithmetic, sums, products and
/// fused operations are the kernels of kernel_ops.hpp: they are for the instruction set of the machine whatever the
/// program was built for (Eigen's own product reaches 20 to 50 % of the processor at these shapes), and a program with
/// all the expressions of broadcasting compiles half a second longer.

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_EIGEN_CLASS_HPP  // <motionlang/backend/detail/eigen_class.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_EIGEN_CLASS_HPP
/// What a model needs of the Eigen backend: its operations, and of the bodies those of the kernels, arithmetic among
/// them. Those that include Eigen, functions and maxima, come with <motionlang/backend/eigen.hpp>.

#ifndef MOTIONLANG_HAS_BACKEND_KERNEL_OPS_HPP  // <motionlang/backend/kernel_ops.hpp>
#define MOTIONLANG_HAS_BACKEND_KERNEL_OPS_HPP
/// Arithmetic and the operations of tensor/fused.hpp as kernels over Dense storage, with their derivatives. Shared by
/// the Eigen and xtensor backends: one layer of kernels serves both.
///
/// Declarations only; the bodies are in detail/kernel_ops_impl.hpp, which a program that links motionlang::instantiated
/// need not read.

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct KernelOps {
  using kernel_tensor = Dense<S>;

  // Operands come by value: memory that nobody else holds is reused for the result.
  static Dense<S> add(Dense<S> a, Dense<S> b);
  static Dense<S> sub(Dense<S> a, Dense<S> b);
  static Dense<S> mul(Dense<S> a, Dense<S> b);
  static Dense<S> div(Dense<S> a, Dense<S> b);
  static Dense<S> maximum(Dense<S> a, Dense<S> b);
  static Dense<S> sum(const Dense<S>& a, int axis);

  /// As many rows of a network's inside as stay in the caches of all threads from one layer to the next.
  static Index rows_in_cache();

  /// Product of the last two axes, batched. b is packed on the fly.
  static Dense<S> matmul(const Dense<S>& a, const Dense<S>& b, bool transpose_a, bool transpose_b);

  /// Packs a weight (out, in) once, or that of a convolution (out, in, taps); `linear` and `conv1d` then use the packed
  /// form. For inference: the weight must not change afterwards. Returns whether all its numbers are finite: they are
  /// read anyway.
  static bool prepare(const Dense<S>& weight);
  static Dense<S> linear(const Dense<S>& x, const Dense<S>& weight, const Dense<S>* bias, Activation act,
                         const Dense<S>* residual, const Dropout& drop = {});

  /// nn/conv1d.hpp, without dilation. The sequences of x lie in it by `before`, those of the result by `after`.
  static Dense<S> conv1d(const Dense<S>& x, const Offsets& before, const Offsets& after, const Dense<S>& weight,
                         const Dense<S>* bias, Index stride, Index padding, Activation act);
  static Dense<S> conv1d_weight_vjp(const Dense<S>& x, const Offsets& before, const Offsets& after, Index taps,
                                    Index stride, Index padding, const Dense<S>& dy);
  static Dense<S> conv1d_input_vjp(const Dense<S>& weight, const Offsets& before, const Offsets& after, Index stride,
                                   Index padding, const Dense<S>& dy);

  static Dense<S> activate(const Dense<S>& x, Activation act, const Dropout& drop = {});
  static Dense<S> activate_vjp(const Dense<S>& x, const Dense<S>& dy, Activation act, const Dropout& drop = {});

  static Dense<S> layer_norm(const Dense<S>& x, const Dense<S>& weight, const Dense<S>& bias, double eps);
  static Dense<S> add_layer_norm(const Dense<S>& x, const Dense<S>& residual, const Dense<S>& weight,
                                 const Dense<S>& bias, double eps);
  /// {dx, dweight, dbias}
  static std::array<Dense<S>, 3> layer_norm_vjp(const Dense<S>& x, const Dense<S>& weight, double eps,
                                                const Dense<S>& dy);

  static Dense<S> softmax(const Dense<S>& x);
  static Dense<S> dropout(const Dense<S>& x, const Dropout& d);

  static Dense<S> attention(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v, const Offsets& q_offsets,
                            const Offsets& k_offsets, const AttentionOptions& options,
                            const Dense<S>* relative_scores = nullptr);
  /// {dq, dk, dv}
  static std::array<Dense<S>, 3> attention_vjp(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v,
                                               const Offsets& q_offsets, const Offsets& k_offsets,
                                               const AttentionOptions& options, const Dense<S>& dy);
  static Dense<S> self_attention(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options);
  static Dense<S> self_attention_vjp(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options,
                                     const Dense<S>& dy);

  /// Updates parameter and moments in place when nobody else holds them, else makes new ones.
  static void adamw(Dense<S>& parameter, Dense<S>& m, Dense<S>& v, const Dense<S>& gradient, const AdamwUpdate& update);
};

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::KernelOps<float>;
extern template struct motionlang::KernelOps<double>;
#else
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct EigenBackend : DenseOps<S>, KernelOps<S> {
  using tensor = Dense<S>;

  static tensor atan2(tensor a, tensor b);
  static tensor exp(tensor a);
  static tensor log(tensor a);
  static tensor sqrt(tensor a);
  static tensor tanh(tensor a);
  static tensor erf(tensor a);
  static tensor sin(tensor a);
  static tensor cos(tensor a);
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y);
  static tensor max(const tensor& a, int axis);
};

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::EigenBackend<float>;
extern template struct motionlang::EigenBackend<double>;
#endif

MOTIONLANG_NAMESPACE_BEGIN
static_assert(Backend<EigenBackend<float>> && Backend<EigenBackend<double>>);
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_INSTANTIATED

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_EIGEN_IMPL_HPP  // <motionlang/backend/detail/eigen_impl.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_EIGEN_IMPL_HPP
/// Functions and maxima of eigen.hpp. The only header that includes Eigen.

#include <Eigen/Core>  // arrays

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_KERNELS_HPP  // <motionlang/backend/detail/kernels.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_KERNELS_HPP
/// The kernels behind the Eigen and xtensor backends: one text, compiled for several instruction sets, chosen at run
/// time.
///
/// The files *.inc are included once per instruction set, with the compiler told to generate code for it;
/// `kernels<S>()` is the table of the best one that this processor has. A program built without any -march therefore
/// runs as fast as one built for the machine. Other processors use the first table, in 16-byte vectors of the compiler
/// (SSE2, NEON, ...). Nothing here knows about tensors or threads: pointers, sizes, and ranges of rows.

#ifndef MOTIONLANG_HAS_BACKEND_DETAIL_GELU_TABLE_HPP  // <motionlang/backend/detail/gelu_table.hpp>
#define MOTIONLANG_HAS_BACKEND_DETAIL_GELU_TABLE_HPP
/// What gelu(x) lacks to relu(x), as polynomials of degree 4 around 0, 1/4, 2/4, ... 31/4.
///
/// gelu(x) = x Phi(x) = max(x, 0) - g(|x|),   g(c) = c (1 - Phi(c)) (Hendrycks and Gimpel 2016, Phi: normal
/// distribution function). g is bounded by 0.17 and dies out above c = 5.5. Processors that look up 32 numbers in one
/// instruction so take 14 instructions.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// g(i / 4 + d) = sum over n of by_power[n][i] d^n for |d| <= 1/8. Wrong by 5e-8 at most, by 1e-7 of g for i = 0.
struct GeluTable {
  static constexpr int cells = 32, degree = 4;
  static constexpr double width = 0.25;
  alignas(64) float by_power[degree + 1][cells];
};

/// Taylor's series in every cell, whose powers 5 and 6 are replaced by lower ones (Chebyshev's economisation).
constexpr GeluTable make_gelu_table() {
  constexpr int terms = 16;
  GeluTable table{};
  double density = 0.39894228040143268, above = 0.5;  // phi and 1 - Phi at the middle of the cell
  for (int i = 0; i < GeluTable::cells; ++i) {
    const double c = GeluTable::width * i;
    double p[terms] = {density}, q[terms] = {above}, g[terms] = {c * above};
    for (int n = 1; n < terms; ++n) {
      p[n] = -(c * p[n - 1] + (n > 1 ? p[n - 2] : 0)) / n;  // phi' = -x phi
      q[n] = -p[n - 1] / n;
      g[n] = c * q[n] + q[n - 1];
    }
    // Polynomials that are small for |u| <= 1, u = d / (1/8), are taken away: u^2 T_4(u) / 8 for u^6 (it keeps g(0) =
    // 0), T_5(u) / 16 for u^5.
    constexpr double square = GeluTable::width * GeluTable::width / 4;
    g[4] += g[6] * square, g[2] -= g[6] * square * square / 8;
    g[3] += g[5] * square * 20 / 16, g[1] -= g[5] * square * square * 5 / 16;
    for (int n = 0; n <= GeluTable::degree; ++n) table.by_power[n][i] = static_cast<float>(g[n]);
    density = above = 0;
    for (int n = terms; n-- > 0;) density = density * GeluTable::width + p[n], above = above * GeluTable::width + q[n];
  }
  return table;
}
inline constexpr GeluTable gelu_table = make_gelu_table();

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// c (m x n) = act(a (m x k) B + bias + residual). B is packed in panels.
template <class S>
struct Gemm {
  Index m = 0, n = 0, k = 0;
  const S* a = nullptr;
  Index lda = 0;  // distance of rows of a (of its transpose, (k x m), when a_transposed)
  bool a_transposed = false;
  const S* panels = nullptr;
  S* c = nullptr;
  Index ldc = 0;
  const S* bias = nullptr;
  const S* residual = nullptr;
  Index ldr = 0;
  Activation act = Activation::none;
  const std::byte* after = nullptr;  // what is read after this product: a panel's share of it is fetched meanwhile
  Index after_bytes = 0;

  /// Where in `after` a thread goes on that has multiplied panels first, first + 1, ... of `count`; `otherwise` if
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

/// y[i] = op(a[i], b[i]); an operand that is repeated has one number for all i.
enum class BinaryOp { add, sub, mul, div, maximum };
template <class S>
struct Binary {
  BinaryOp op{};
  const S *a = nullptr, *b = nullptr;
  bool a_repeated = false, b_repeated = false;
  Index count = 0;
  S* y = nullptr;  // may be a or b
};

/// Products with the same panels by tiles of bfloat16, three for every float (Precision::bf16x3, float_tiles.inc).
struct FloatTiles {
  Index tile_rows;
  Index (*gemm_rows)(Index k);
  Index (*gemm_scratch)(Index k);
  void (*gemm_block)(const Gemm<float>&, Index r0, Index r1, Index j0, Index j1, float* scratch);
};

/// Entry points of one instruction set.
template <class S>
struct Kernels {
  const char* name;
  const FloatTiles* tiles;  // none: all products by gemm_block
  Index panel_width, tile_rows;
  Index (*gemm_rows)(Index k);     // of A in a block
  Index (*gemm_scratch)(Index k);  // numbers
  void (*pack_rows)(const S* b, Index k, Index n, Index stride, Index k0, Index k1, S* panels);
  bool (*pack_transposed)(const S* b, Index k, Index n, Index stride, Index first, Index last, S* panels);
  void (*gemm_block)(const Gemm<S>&, Index r0, Index r1, Index j0, Index j1, S* scratch);
  Index (*attention_scratch)(Index keys, Index width);
  Index (*attention_vjp_scratch)(Index queries, Index keys, Index width);
  void (*attention_head)(const Attention<S>&, Index sequence, Index head, Index piece, Index pieces, S* scratch);
  void (*attention_head_vjp)(const Attention<S>&, const AttentionGradients<S>&, Index sequence, Index head, S* scratch);
  void (*dropout)(const S* x, Index n, Index first, const Dropout&, S* y);
  void (*layer_norm_rows)(const LayerNorm<S>&, Index first, Index last);
  void (*layer_norm_rows_vjp)(const LayerNorm<S>&, const S* dy, S* dx, S* moments, Index first, Index last);
  void (*layer_norm_columns_vjp)(const LayerNorm<S>&, const S* dy, const S* moments, S* dweight, S* dbias, Index rows,
                                 Index first, Index last);
  void (*softmax_rows)(const S* x, Index n, Index first, Index last, S* y, S* scratch);
  void (*transpose)(const Transposed<S>&, Index first, Index last);
  void (*activate)(const S* x, Index n, Activation, S* y);
  void (*activate_vjp)(const S* x, const S* dy, Index n, Activation, S* dx);
  void (*binary)(const Binary<S>&);
  void (*error_function)(const S* x, Index n, S* y);
  void (*row_sums)(const S* x, Index n, Index first, Index last, S* y);
  void (*column_sums)(const S* x, Index rows, Index width, Index first, Index last, S* y);
  void (*adamw)(const AdamwStep<S>&, Index first, Index last);
};

/// Products of numbers rounded to bfloat16, with sums in float; attention with such products. B is packed in panels
/// that are the same for all instruction sets, but for numbers below 2^-126.
struct Bf16Kernels {
  const char* name;
  Index tile_rows;
  Index (*gemm_rows)(Index k);     // of A in a block
  Index (*gemm_scratch)(Index k);  // numbers
  void (*pack_rows)(const float* b, Index k, Index n, Index stride, Index k0, Index k1, std::uint16_t* panels);
  bool (*pack_transposed)(const float* b, Index k, Index n, Index stride, Index first, Index last,
                          std::uint16_t* panels);
  void (*gemm_block)(const Gemm<float>&, const std::uint16_t* panels, Index r0, Index r1, Index j0, Index j1,
                     float* scratch);
  Index (*attention_scratch)(Index keys, Index width);
  Index (*attention_vjp_scratch)(Index queries, Index keys, Index width);
  void (*attention_head)(const Attention<float>&, Index sequence, Index head, Index piece, Index pieces,
                         float* scratch);
  void (*attention_head_vjp)(const Attention<float>&, const AttentionGradients<float>&, Index sequence, Index head,
                             float* scratch);
};
/// Columns of a panel, and its rows: k, filled up to whole tiles.
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
// All kernels for one instruction set, and their table. Included by kernels.hpp, several times.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail::MOTIONLANG_ISA {

// Vectors of MOTIONLANG_VECTOR_BYTES bytes in the compiler's own vector types, and the elementary functions on them.
// Included once for every instruction set by kernels.hpp; no include guard on purpose.

template <class S>
struct VectorOf {
  typedef S type __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
  typedef S loose __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES), aligned(sizeof(S)), may_alias));
  using bits = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
  typedef bits mask __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
};
template <class S>
using Vec = typename VectorOf<S>::type;
template <class S>
using Mask = typename VectorOf<S>::mask;
template <class S>
inline constexpr int lanes = MOTIONLANG_VECTOR_BYTES / static_cast<int>(sizeof(S));

// Everything below is inlined: passing such vectors between functions would depend on the caller's instruction set.
#define MOTIONLANG_INLINE inline __attribute__((always_inline))

template <class S>
MOTIONLANG_INLINE Vec<S> load(const S* p) {
  return *reinterpret_cast<const typename VectorOf<S>::loose*>(p);
}
template <class S>
MOTIONLANG_INLINE void store(S* p, const Vec<S>& v) {
  *reinterpret_cast<typename VectorOf<S>::loose*>(p) = v;
}
/// Past the caches, to an address that is a multiple of the vector's size. Other threads see it after `end_of_streams`.
template <class S>
MOTIONLANG_INLINE void store_stream(S* p, const Vec<S>& v) {
#if defined(__clang__)
  __builtin_nontemporal_store(v, reinterpret_cast<Vec<S>*>(p));
#elif defined(__x86_64__)
  auto* at = reinterpret_cast<float*>(p);
#if MOTIONLANG_VECTOR_BYTES == 64
  __builtin_ia32_movntps512(at, (Vec<float>)v);
#elif MOTIONLANG_VECTOR_BYTES == 32
  __builtin_ia32_movntps256(at, (Vec<float>)v);
#else
  __builtin_ia32_movntps(at, (Vec<float>)v);
#endif
#else
  store(p, v);
#endif
}
/// Asks for n numbers that are read soon.
template <class Number>
MOTIONLANG_INLINE void fetch(const Number* x, Index n) {
  for (Index i = 0; i < n; i += 64 / static_cast<Index>(sizeof(Number))) __builtin_prefetch(x + i);
}
MOTIONLANG_INLINE void end_of_streams() {
#if defined(__x86_64__)
  __builtin_ia32_sfence();
#endif
}
template <class S>
MOTIONLANG_INLINE Vec<S> splat(S x) {
  return x - Vec<S>{};
}
template <class S>
MOTIONLANG_INLINE Vec<S> load_some(const S* p, Index n) {  // lanes n and above are 0
  alignas(MOTIONLANG_VECTOR_BYTES) S t[static_cast<std::size_t>(lanes<S>)] = {};
  for (Index i = 0; i < n && i < lanes<S>; ++i) t[i] = p[i];
  return load(t);
}
/// The first n numbers (all lanes if there are so many), then zeros; nothing is read if n <= 0.
template <class S>
MOTIONLANG_INLINE Vec<S> load_first(const S* p, Index n) {
  return n >= lanes<S> ? load(p) : load_some(p, n);
}
template <class S>
MOTIONLANG_INLINE void store_some(S* p, const Vec<S>& v, Index n) {
  for (Index i = 0; i < n && i < lanes<S>; ++i) p[i] = v[i];
}
template <class S>
MOTIONLANG_INLINE void store_first(S* p, const Vec<S>& v, Index n) {
  n >= lanes<S> ? store(p, v) : store_some(p, v, n);
}
// The larger and the smaller of two; b where either is NaN, so a bound comes first and data second.
// (Where one of them is a constant, GCC 12 makes two instructions of it for vectors of 64 bytes.)
template <class S>
MOTIONLANG_INLINE Vec<S> vmax(const Vec<S>& a, const Vec<S>& b) {
#if MOTIONLANG_VECTOR_BYTES == 64 && !defined(__clang__)
  if constexpr (sizeof(S) == 4) {
    Vec<S> r;
    asm("vmaxps %2, %1, %0" : "=v"(r) : "v"(a), "vm"(b));
    return r;
  }
#endif
  return a > b ? a : b;
}
template <class S>
MOTIONLANG_INLINE Vec<S> vmin(const Vec<S>& a, const Vec<S>& b) {
#if MOTIONLANG_VECTOR_BYTES == 64 && !defined(__clang__)
  if constexpr (sizeof(S) == 4) {
    Vec<S> r;
    asm("vminps %2, %1, %0" : "=v"(r) : "v"(a), "vm"(b));
    return r;
  }
#endif
  return a < b ? a : b;
}
/// Lanes of `found` become negative where x is NaN or infinite: all bits of its exponent are set.
template <class S>
MOTIONLANG_INLINE void find_not_finite(const Vec<S>& x, Mask<S>& found) {
  constexpr auto exponent = std::bit_cast<typename VectorOf<S>::bits>(std::numeric_limits<S>::infinity());
  found |= (~(Mask<S>)x & exponent) - 1;
}
template <class S>
MOTIONLANG_INLINE bool any_negative(const Mask<S>& v) {
  bool any = false;
  for (int i = 0; i < lanes<S>; ++i) any |= v[i] < 0;
  return any;
}
/// Lane i + half beside lane i, for the lower halves of blocks of 2 half lanes; the upper halves are of no account.
template <class S, int half, int... l>
MOTIONLANG_INLINE Vec<S> upper_lanes(const Vec<S>& v, std::integer_sequence<int, l...>) {
  return __builtin_shufflevector(v, v, (l + half) % lanes<S>...);
}
// Halves are put together until one lane is left: sums have a fixed order.
template <class S, int half = lanes<S> / 2>
MOTIONLANG_INLINE S reduce_add(const Vec<S>& v) {
  if constexpr (half == 0)
    return v[0];
  else
    return reduce_add<S, half / 2>(v + upper_lanes<S, half>(v, std::make_integer_sequence<int, lanes<S>>{}));
}
template <class S, int half = lanes<S> / 2>
MOTIONLANG_INLINE S reduce_max(const Vec<S>& v) {
  if constexpr (half == 0)
    return v[0];
  else
    return reduce_max<S, half / 2>(vmax<S>(v, upper_lanes<S, half>(v, std::make_integer_sequence<int, lanes<S>>{})));
}

/// Swaps the blocks off the diagonal: lane l + half of a with lane l of b, for every l without the bit `half`.
template <class S, int half, int... l>
MOTIONLANG_INLINE void swap_blocks(Vec<S>& a, Vec<S>& b, std::integer_sequence<int, l...>) {
  constexpr int n = lanes<S>;
  const Vec<S> upper = __builtin_shufflevector(a, b, ((l & half) != 0 ? n + l - half : l)...);
  b = __builtin_shufflevector(a, b, ((l & half) != 0 ? n + l : l + half)...);
  a = upper;
}
/// v[i][j] becomes v[j][i]: blocks of 1, 2, 4, ... lanes are swapped.
template <class S, int half = 1>
MOTIONLANG_INLINE void transpose_lanes(Vec<S>* v) {
  if constexpr (half < lanes<S>) {
#pragma GCC unroll 16
    for (int i = 0; i < lanes<S>; ++i) {
      if ((i & half) == 0) swap_blocks<S, half>(v[i], v[i + half], std::make_integer_sequence<int, lanes<S>>{});
    }
    transpose_lanes<S, 2 * half>(v);
  }
}

/// e^x for x <= 88 (709): x = n ln 2 + f, e^f by its series, 2^n by the exponent bits. Relative error below 1e-7
/// (1e-15). Results below the smallest normal number are 0. 2^n is a factor of its own, so that NaN stays NaN.
template <class S>
MOTIONLANG_INLINE Vec<S> vexp(const Vec<S>& x) {
  constexpr bool single = sizeof(S) == 4;
  constexpr S low = single ? S(-87) : S(-708), high = single ? S(88) : S(709);
  const Vec<S> c = vmin<S>(splat(high), x);
  // 1.5 * 2^23 (2^52), which rounds to an integer what it is added to, and the bias of exponents, which is then in the
  // lowest bits.
  const S magic = single ? S(12582912 + 127) : S(6755399441055744 + 1023);
  const Vec<S> shifted = c * S(1.4426950408889634) + magic;
  const Vec<S> n = shifted - magic;
  const Vec<S> f = (c - n * S(single ? 0.693359375 : 0.693147180369123816490)) -
                   n * S(single ? -2.12194440e-4 : 1.90821492927058770002e-10);
  Vec<S> p = splat(S(single ? 1.0 / 5040 : 1.0 / 6227020800.0));
  if constexpr (!single) {
    for (double k : {1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040})
      p = p * f + S(k);
  }
  for (double k : {1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0}) p = p * f + S(k);
  const Vec<S> power = (Vec<S>)((Mask<S>)shifted << (single ? 23 : 52));
  return x < splat(low) ? Vec<S>{} : p * power;  // so far below, n is nonsense
}

/// Float: (Phi(x) - 1/2) / x for y = x^2 <= 32, Phi being the normal distribution function: a rational function (our
/// own least-squares fit). Of Phi, 2e-8 is wrong by the fit; with what is rounded, below 2.5e-7.
template <class S>
MOTIONLANG_INLINE Vec<S> phi_ratio(const Vec<S>& y) {
  Vec<S> p = splat(S(2.1818830005316466e-08)), q = splat(S(1.1712714934253183e-06));
  p = p * y + S(6.364869382952854e-06);
  q = q * y + S(7.602274008301123e-05);
  p = p * y + S(0.00017693884114677917);
  q = q * y + S(0.0019305587808950675);
  p = p * y + S(0.004725908484413717);
  q = q * y + S(0.029119172061619288);
  p = p * y + S(0.0346923636272431);
  q = q * y + S(0.25362643899642984);
  p = p * y + S(0.3989422129894181);
  q = q * y + S(1);
  return p / q;
}
/// erf(x) = 2 Phi(sqrt(2) x) - 1. Float: absolute error below 5e-7. Double: libm.
template <class S>
MOTIONLANG_INLINE Vec<S> verf(const Vec<S>& x) {
  if constexpr (sizeof(S) == 4) {
    const Vec<S> c = vmin<S>(splat(S(4)), vmax<S>(splat(S(-4)), x));
    return c * phi_ratio<S>(c * c * S(2)) * S(2.8284271247461901);
  } else {
    Vec<S> r{};
    for (int i = 0; i < lanes<S>; ++i) r[i] = std::erf(x[i]);
    return r;
  }
}
#if MOTIONLANG_VECTOR_BYTES == 64
/// 32 numbers: lane i of the result is that which the lowest five bits of index[i] say.
MOTIONLANG_INLINE Vec<float> look_up(const float* table, const Vec<float>& index) {
  Vec<float> r = load(table);
  asm("vpermt2ps %2, %1, %0" : "+v"(r) : "v"(index), "v"(load(table + 16)));
  return r;
}
/// By gelu_table.hpp: absolute error below 1e-7 for x < 0, relative error below 5e-7 for x > 0.
MOTIONLANG_INLINE Vec<float> gelu_by_table(const Vec<float>& x) {
  static_assert(GeluTable::cells == 32 && GeluTable::width == 0.25);
  constexpr auto last = static_cast<float>(GeluTable::width * (GeluTable::cells - 1));
  Vec<float> c, d;
  asm("vrangeps $0xa, %2, %1, %0" : "=v"(c) : "v"(x), "v"(splat(last)));  // min(|x|, last)
  asm("vreduceps $0x24, %1, %0" : "=v"(d) : "v"(c));                      // c - i / 4, i = round(4 c)
  const Vec<float> i = c + 3145728.f;                                     // 1.5 * 2^21: i in the lowest bits
  const auto& table = gelu_table.by_power;
  Vec<float> g = look_up(table[GeluTable::degree], i);
#pragma GCC unroll 8
  for (int n = GeluTable::degree; n-- > 0;) g = g * d + look_up(table[n], i);
  return vmax<float>(Vec<float>{}, x) - g;
}
#endif
/// gelu(x) = x Phi(x) = x/2 + x (Phi(x) - 1/2). The last term is even in x, so that nothing need be bounded before it
/// is known. Float: by look_up where there is one; error below 3e-7 |x|. Of -inf: NaN or about 0.
template <class S>
MOTIONLANG_INLINE Vec<S> vgelu(const Vec<S>& x) {
#if MOTIONLANG_VECTOR_BYTES == 64
  if constexpr (sizeof(S) == 4) return gelu_by_table(x);
#endif
  const Vec<S> h = x * S(0.5);
  if constexpr (sizeof(S) == 4) {
    const Vec<S> y = x * x;
    return h + (y < splat(S(32)) ? y * phi_ratio<S>(y) : (Vec<S>)((Mask<S>)h & 0x7fffffff));
  } else {
    return h + h * verf<S>(x * S(0.70710678118654752));
  }
}

/// Square root of x >= 0: Newton's iteration for 1/sqrt(x) from an estimate by shifting the exponent; within 1 ulp.
template <class S>
MOTIONLANG_INLINE Vec<S> vsqrt(const Vec<S>& x) {
  constexpr bool single = sizeof(S) == 4;
  using Bits = typename VectorOf<S>::bits;
  Vec<S> y = (Vec<S>)(static_cast<Bits>(single ? 0x5F375A86 : 0x5FE6EB50C7B537A9) - ((Mask<S>)x >> 1));
  for (int i = 0; i < (single ? 3 : 5); ++i) y = y * (S(1.5) - x * S(0.5) * y * y);
  const Vec<S> r = x * y;
  return r + S(0.5) * y * (x - r * r);
}

/// Float: relative error below 3e-7; a polynomial near 0 (Cephes, Moshier 1992), 1 - 2 / (exp(2 |x|) + 1) elsewhere.
/// Double: libm.
template <class S>
MOTIONLANG_INLINE Vec<S> vtanh(const Vec<S>& x) {
  if constexpr (sizeof(S) == 4) {
    const Vec<S> y = x * x;
    Vec<S> p = y * S(-5.70498872745e-3) + S(2.06390887954e-2);
    for (double k : {-5.37397155531e-2, 1.33314422036e-1, -3.33332819422e-1}) p = p * y + S(k);
    const Vec<S> size = (Vec<S>)((Mask<S>)x & 0x7fffffff), far = S(1) - S(2) / (vexp<S>(size + size) + S(1));
    const Vec<S> positive = size < splat(S(0.625)) ? size + size * y * p : far;
    return (Vec<S>)((Mask<S>)positive | ((Mask<S>)x & ~0x7fffffff));
  } else {
    Vec<S> r{};
    for (int i = 0; i < lanes<S>; ++i) r[i] = std::tanh(x[i]);
    return r;
  }
}
//
// Nonlinearities and their derivatives. Which one it is, is asked once for many numbers: constants stay in registers.

template <Activation act, class S>
MOTIONLANG_INLINE Vec<S> apply_activation(const Vec<S>& x) {
  switch (act) {
    case Activation::none:
      return x;
    case Activation::relu:
      return vmax<S>(Vec<S>{}, x);
    case Activation::gelu:
      return vgelu<S>(x);
    case Activation::silu:
      return x / (vexp<S>(-x) + S(1));
    case Activation::tanh:
      return vtanh<S>(x);
    case Activation::quick_gelu:
      return x / (vexp<S>(x * S(-1.702)) + S(1));
    case Activation::gelu_new: {
      const Vec<S> h = x * S(0.5);
      return h * vtanh<S>((x + x * x * x * S(0.044715)) * S(0.79788456080286536)) + h;
    }
    case Activation::sigmoid:
      return S(1) / (vexp<S>(-x) + S(1));
  }
  return x;
}

/// Derivative at x.
///     gelu'(x) = Phi(x) + x phi(x),   silu'(x) = s + x s (1 - s),   sigmoid'(x) = s (1 - s) with s = 1 / (1 + exp(-x))
template <Activation act, class S>
MOTIONLANG_INLINE Vec<S> activation_slope(const Vec<S>& x) {
  switch (act) {
    case Activation::none:
      return splat(S(1));
    case Activation::relu:
      return x > Vec<S>{} ? splat(S(1)) : Vec<S>{};
    case Activation::gelu: {
      const Vec<S> phi = vexp<S>(x * x * S(-0.5)) * S(0.39894228040143268);
      return verf<S>(x * S(0.70710678118654752)) * S(0.5) + S(0.5) + x * phi;
    }
    case Activation::silu: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x);
      return s + x * s * (S(1) - s);
    }
    case Activation::tanh: {
      const Vec<S> t = vtanh<S>(x);
      return S(1) - t * t;
    }
    case Activation::quick_gelu: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x * S(1.702));
      return s + x * s * (S(1) - s) * S(1.702);
    }
    case Activation::gelu_new: {
      const Vec<S> t = vtanh<S>((x + x * x * x * S(0.044715)) * S(0.79788456080286536));
      return (t + S(1)) * S(0.5) + x * (S(1) - t * t) * (x * x * S(3 * 0.044715) + S(1)) * S(0.5 * 0.79788456080286536);
    }
    case Activation::sigmoid: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x);
      return s * (S(1) - s);
    }
  }
  return splat(S(1));
}

/// f.operator()<act>().
template <class F>
void with_activation(Activation act, const F& f) {
  switch (act) {
    case Activation::none:
      return f.template operator()<Activation::none>();
    case Activation::relu:
      return f.template operator()<Activation::relu>();
    case Activation::gelu:
      return f.template operator()<Activation::gelu>();
    case Activation::silu:
      return f.template operator()<Activation::silu>();
    case Activation::tanh:
      return f.template operator()<Activation::tanh>();
    case Activation::quick_gelu:
      return f.template operator()<Activation::quick_gelu>();
    case Activation::gelu_new:
      return f.template operator()<Activation::gelu_new>();
    case Activation::sigmoid:
      return f.template operator()<Activation::sigmoid>();
  }
}

/// y = act(x) for so many rows of `width` numbers, which begin ldx and ldy apart; y may be x.
template <class S>
void activate_rows(const S* x, Index ldx, Index rows, Index width, Activation act, S* y, Index ldy) {
  constexpr int l = lanes<S>;
  with_activation(act, [=]<Activation a>() {
    for (Index r = 0; r < rows; ++r) {
      const S* from = x + r * ldx;
      S* to = y + r * ldy;
      Index i = 0;
      for (; i + l <= width; i += l) store(to + i, apply_activation<a, S>(load(from + i)));
      if (i < width) store_some(to + i, apply_activation<a, S>(load_some(from + i, width - i)), width - i);
    }
  });
}
template <class S>
void activate(const S* x, Index n, Activation act, S* y) {
  activate_rows(x, n, 1, n, act, y, n);
}
/// dx = dy act'(x) for n numbers.
template <class S>
void activate_vjp(const S* x, const S* dy, Index n, Activation act, S* dx) {
  constexpr int l = lanes<S>;
  with_activation(act, [=]<Activation a>() {
    Index i = 0;
    for (; i + l <= n; i += l) store(dx + i, load(dy + i) * activation_slope<a, S>(load(x + i)));
    if (i < n) store_some(dx + i, load_some(dy + i, n - i) * activation_slope<a, S>(load_some(x + i, n - i)), n - i);
  });
}
//
// Matrix product with packed right-hand side: register tiles, cache blocks, epilogue in the tile.
//
//   Panels   B (k x n) is stored in panels of `panel_width` columns, k rows each: [panel][k][column], zero padded.
//   Tile     up to `tile_rows` rows of A times one panel, all sums in registers.
//   Block    up to 1024 of k at a time: rows of A stay in the second-level cache, beside one panel or a group of them.
//            If k is in several blocks, eight panels at a time: what the next 1024 of k are added to stays there as
//            well. (All panels at a time where A is copied first.)
//   Walk     a panel times all rows of the block, then the next panel. If the result is larger than the nearer caches
//            and k is one block: a tile's rows times a group of panels, then the next rows. So longer pieces of the
//            result's rows are written, one after the other: the lines under them, which come from memory first, the
//            processor fetches by itself, and fewer pages are in use.
//   Ahead    a tile asks for its part of C and of the residual before it begins, and with every k for a piece of what
//            follows: of the panels of the next group, be it of the product that follows, and, with the first group, of
//            the next rows of A.
//   Order    every element is summed over k in the same order, whatever the tile height, block or thread: same bits.

template <class S>
inline constexpr Index panel_width = 2 * lanes<S>;
inline constexpr Index tile_rows = MOTIONLANG_TILE_ROWS;
inline constexpr Index depth_block = 1024;
inline constexpr Index panel_block = 8;
inline constexpr Index most_tiles = 16;        // of rows in a block
inline constexpr Index near_caches = 4 << 20;  // bytes
// for rows of A, and as much for a group of panels
inline constexpr Index half_cache = 512 * 1024 * MOTIONLANG_VECTOR_BYTES / 64;
template <class S>
// of a tile of a transposed A, copied
inline constexpr Index tile_pitch = (tile_rows + lanes<S> - 1) / lanes<S>* lanes<S>;

template <class S>
constexpr Index bytes(Index count) {
  return count * static_cast<Index>(sizeof(S));
}
template <class S>
const std::byte* as_bytes(const S* x) {
  return reinterpret_cast<const std::byte*>(x);
}

/// Rows of A, `row_bytes` each, in a block of so many bytes: at most most_tiles tiles.
constexpr Index rows_at_once(Index row_bytes, Index tile, Index bytes) {
  return std::clamp<Index>(bytes / std::max<Index>(1, row_bytes) / tile, 1, most_tiles) * tile;
}

/// Rows k0 ... k1-1 of all panels of B, whose element (k, n) is b[k * stride + n].
template <class S>
void pack_rows(const S* b, Index k, Index n, Index stride, Index k0, Index k1, S* panels) {
  constexpr Index w = panel_width<S>, l = lanes<S>;
  constexpr Index ahead = 8;  // rows
  for (Index i = k0; i < k1; ++i) {
    const S* in = b + i * stride;
    S* out = panels + i * w;
    for (Index columns = n; columns > 0; columns -= w, in += w, out += k * w) {
      __builtin_prefetch(in + ahead * stride), __builtin_prefetch(in + ahead * stride + l);
      store(out, load_first(in, columns)), store(out + l, load_first(in + l, columns - l));
    }
  }
}
/// Panels first ... last-1 of B, whose element (k, n) is b[k + n * stride]: read along its rows, a square of lanes at a
/// time. Whether all numbers are finite, if it looks.
template <class S, bool looks>
bool pack_transposed(const S* b, Index k, Index n, Index stride, Index first, Index last, S* panels) {
  constexpr Index w = panel_width<S>, l = lanes<S>;
  Mask<S> found{};
  for (Index j = first; j < last; ++j) {
    S* out = panels + j * k * w;
    const Index columns = n - j * w;
    const S* in = b + j * w * stride;
    for (Index i = 0; i < k; i += l) {
      const Index rows = k - i < l ? k - i : l;
      for (Index c = 0; c < w; c += l) {
        Vec<S> square[lanes<S>];
#pragma GCC unroll 16
        for (int q = 0; q < lanes<S>; ++q) {
          const S* from = in + (c + q) * stride + i;
          square[q] = load_first(from, c + q < columns ? rows : 0);
          if constexpr (looks) find_not_finite<S>(square[q], found);
        }
        transpose_lanes<S>(square);
        for (Index r = 0; r < rows; ++r) store(out + (i + r) * w + c, square[r]);
      }
    }
  }
  return !any_negative<S>(found);
}

/// Rows of A, whose element (i, k) is at[i * stride + k], or, when transposed, at[i + k * stride].
template <class S>
struct Rows {
  const S* at;
  Index stride;
  bool transposed;

  Rows from(Index row) const { return {at + row * (transposed ? 1 : stride), stride, transposed}; }
  Rows from_depth(Index k) const { return {at + k * (transposed ? stride : 1), stride, transposed}; }
};

/// What is read after a tile: it is fetched into the second-level cache meanwhile, `step` bytes, a line at most, for
/// every row of the panel (bfloat16: pair of rows). What is more than that is left. So where a row is two lines long, a
/// tile alone fetches the first half of the next panel only: every other line of the whole would confuse the processor,
/// which fetches by itself lines that follow each other (20 % slower from memory).
struct Ahead {
  const std::byte* at = nullptr;
  Index step = 0;

  /// Share i of n of `bytes` that begin at `next`, in so many steps: shares rather overlap than leave bytes between
  /// them.
  MOTIONLANG_INLINE static Ahead share(const std::byte* next, Index bytes, Index i, Index n, Index steps) {
    const Index all = std::max<Index>(1, n * steps), step = std::min<Index>(64, (bytes + all - 1) / all);
    return {next + i * step * steps, step};
  }
  MOTIONLANG_INLINE void fetch() { __builtin_prefetch(at, 0, 2), at += step; }
};

/// What to do with a finished tile: add what is there already (k is split), bias, residual; then the nonlinearity.
template <class S>
struct Epilogue {
  bool accumulate = false;
  const S* bias = nullptr;      // of the panel's first column
  const S* residual = nullptr;  // of the tile's first element
  Index residual_stride = 0;
  Activation act = Activation::none;

  /// Of the tile that begins at a row and column of a product; `first` and `last`: of the blocks of k.
  static Epilogue of(const Gemm<S>& g, Index row, Index column, bool first, bool last) {
    Epilogue e{.accumulate = !first};
    if (!last) return e;
    e.act = g.act;
    if (g.bias != nullptr) e.bias = g.bias + column;
    if (g.residual != nullptr) e.residual = g.residual + row * g.ldr + column, e.residual_stride = g.ldr;
    return e;
  }
  Epilogue from_column(Index column) const {
    Epilogue e = *this;
    if (bias != nullptr) e.bias += column;
    if (residual != nullptr) e.residual += column;
    return e;
  }
  Epilogue from_row(Index row) const {
    Epilogue e = *this;
    if (residual != nullptr) e.residual += row * residual_stride;
    return e;
  }
};

/// Asks for the rows of c and of the residual that a tile is put into.
template <class S, int R>
MOTIONLANG_INLINE void fetch_result(const S* c, Index ldc, const Epilogue<S>& e) {
  constexpr int l = lanes<S>;
  for (int i = 0; i < R; ++i) __builtin_prefetch(c + i * ldc, 1), __builtin_prefetch(c + i * ldc + l, 1);
  if (e.residual == nullptr) return;
  for (int i = 0; i < R; ++i) {
    const S* row = e.residual + i * e.residual_stride;
    __builtin_prefetch(row), __builtin_prefetch(row + l);
  }
}

/// put_result for the last columns of a matrix, when they do not fill a panel: two vectors of sums for every row.
template <class S>
[[gnu::noinline]] void put_narrow_result(const Vec<S>* sums, int rows, S* c, Index ldc, Index columns,
                                         const Epilogue<S>& e) {
  constexpr Index l = lanes<S>;
  for (Index r = 0; r < rows; ++r) {
    for (Index i = 0; i < columns; i += l) {
      const Index n = columns - i;
      S* out = c + r * ldc + i;
      Vec<S> x = sums[2 * r + i / l];
      if (e.accumulate) x += load_first(out, n);
      if (e.bias != nullptr) x += load_first(e.bias + i, n);
      if (e.residual != nullptr) x += load_first(e.residual + r * e.residual_stride + i, n);
      store_first(out, x, n);
    }
  }
}

/// c (R x columns) = the sums of a tile, c0 and c1 being its two vectors of columns.
template <class S, int R>
MOTIONLANG_INLINE void put_result(Vec<S>* c0, Vec<S>* c1, S* c, Index ldc, Index columns, const Epilogue<S>& e) {
  constexpr int l = lanes<S>;
  if (columns >= 2 * l) {
    const Vec<S> z0 = e.bias == nullptr ? Vec<S>{} : load(e.bias), z1 = e.bias == nullptr ? Vec<S>{} : load(e.bias + l);
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      S* out = c + i * ldc;
      if (e.accumulate) c0[i] += load(out), c1[i] += load(out + l);
      c0[i] += z0, c1[i] += z1;
      if (e.residual != nullptr)
        c0[i] += load(e.residual + i * e.residual_stride), c1[i] += load(e.residual + i * e.residual_stride + l);
      store(out, c0[i]), store(out + l, c1[i]);
    }
  } else {
    Vec<S> sums[static_cast<std::size_t>(2 * R)];
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) sums[2 * i] = c0[i], sums[2 * i + 1] = c1[i];
    put_narrow_result(sums, R, c, ldc, columns, e);
  }
  if (e.act != Activation::none) activate_rows<S>(c, ldc, R, std::min(columns, 2 * Index{l}), e.act, c, ldc);
}

/// What kind of tile: of A as it lies, of a transposed A, or of A as it lies times the first half of a panel only.
enum class TileKind { plain, transposed, half };

/// c (R x columns) = a (R x k) panel.
template <class S, int R, TileKind kind>
void tile(const Rows<S>& a, const S* panel, Index k, S* c, Index ldc, Index columns, const Epilogue<S>& e,
          Ahead ahead) {
  constexpr Index w = panel_width<S>;
  constexpr int l = lanes<S>;
  constexpr bool transposed = kind == TileKind::transposed, half = kind == TileKind::half;
  Vec<S> c0[R], c1[R];
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<S>{};
  fetch_result<S, R>(c, ldc, e);
  // Rows in groups of three behind five pointers: one address register each, the rest is addressing mode. One of the
  // strides is known to be 1, which saves additions (1 to 4 % of the time).
  const Index row_stride = transposed ? 1 : a.stride, depth_stride = transposed ? a.stride : 1;
  const S *p0 = a.at, *p1 = p0 + 3 * row_stride, *p2 = p0 + 6 * row_stride, *p3 = p0 + 9 * row_stride,
          *p4 = p0 + 12 * row_stride;
#pragma GCC unroll 2
  for (Index at = 0; at < k; ++at) {
    if constexpr (transposed) __builtin_prefetch(p0 + 16 * depth_stride);
    const Vec<S> b0 = load(panel), b1 = half ? Vec<S>{} : load(panel + l);
    panel += w;
    __builtin_prefetch(panel + 16 * w);
    __builtin_prefetch(panel + 16 * w + l);
    ahead.fetch();
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      const S x = i < 3    ? p0[i * row_stride]
                  : i < 6  ? p1[(i - 3) * row_stride]
                  : i < 9  ? p2[(i - 6) * row_stride]
                  : i < 12 ? p3[(i - 9) * row_stride]
                           : p4[(i - 12) * row_stride];
      c0[i] += x * b0;
      if constexpr (!half) c1[i] += x * b1;
    }
    p0 += depth_stride, p1 += depth_stride, p2 += depth_stride, p3 += depth_stride, p4 += depth_stride;
  }
  put_result<S, R>(c0, c1, c, ldc, columns, e);
}

template <class S>
using TileFunction = void (*)(const Rows<S>&, const S*, Index, S*, Index, Index, const Epilogue<S>&, Ahead);
/// The tile of so many rows for what is left of the columns.
template <class S>
TileFunction<S> tile_of(Index rows, bool transposed, Index columns) {
  static constexpr auto table = []<int... R>(std::integer_sequence<int, R...>) {
    return std::array{std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::plain>...},
                      std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::transposed>...},
                      std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::half>...}};
  }
  (std::make_integer_sequence<int, MOTIONLANG_TILE_ROWS>{});
  const TileKind kind = transposed ? TileKind::transposed : columns <= lanes<S> ? TileKind::half : TileKind::plain;
  return table[static_cast<std::size_t>(kind)][static_cast<std::size_t>(rows - 1)];
}

/// First row of part i of n nearly equal parts.
MOTIONLANG_INLINE Index part(Index rows, Index i, Index n) { return rows * i / n; }

/// How a product over k is split: pieces of k, and rows of A at a time.
template <class S>
struct Blocks {
  Index count, rows;

  explicit Blocks(Index k)
      : count(k == 0 ? 1 : (k + depth_block - 1) / depth_block),
        rows(rows_at_once(bytes<S>((k + count - 1) / count), tile_rows, half_cache)) {}
};
template <class S>
Index gemm_rows(Index k) {
  return Blocks<S>(k).rows;
}
/// Numbers of scratch that gemm_block needs.
template <class S>
Index gemm_scratch(Index k) {
  return Blocks<S>(k).rows / tile_rows * tile_pitch<S> * (std::min(k, depth_block) + 16);
}

/// `rows` rows of a transposed A (`depth` of k) tile by tile, [tile][k][row], so that a tile reads one line after the
/// other. `readable`: rows that A has from here on.
template <class S>
void copy_tiles(const S* a, Index lda, Index depth, Index rows, Index readable, S* out) {
  constexpr Index pitch = tile_pitch<S>, l = lanes<S>;
  const Index tiles = (rows + tile_rows - 1) / tile_rows;
  for (Index k = 0; k < depth; ++k, a += lda, out += pitch) {
    if (k + 16 < depth) fetch(a + 16 * lda, rows);  // no prefetcher follows pieces so far apart
    for (Index t = 0; t < tiles; ++t) {
      const Index first = part(rows, t, tiles);
      for (Index i = 0; i < pitch; i += l)
        store(out + t * depth * pitch + i, load_first(a + first + i, readable - first - i));
    }
  }
}

/// What is made at a time: of k the part k0 ... k1-1 of rows top ... below-1 times panels left ... right-1.
template <class S>
struct GemmPiece {
  static constexpr Index w = panel_width<S>;
  const Gemm<S>& g;
  S* scratch;
  bool copies, far;                   // rows of A are copied as they are; the result is larger than the nearer caches
  Index top = 0, below = 0, end = 0;  // end: of the rows that the thread goes on with
  Index left = 0, right = 0;
  Index k0 = 0, k1 = 0;
  // panels that are read after it: at last the first ones once more, if nothing else is known
  const std::byte* next = nullptr;
  Index next_bytes = std::numeric_limits<Index>::max();

  Index depth() const { return k1 - k0; }
  Index pitch() const { return depth() + 16; }
  const S* slice(Index panel) const { return g.panels + (panel * g.k + k0) * w; }

  Rows<S> rows_of(Index tile, Index row) const {
    if (g.a_transposed) return {scratch + tile * depth() * tile_pitch<S>, tile_pitch<S>, true};
    if (copies) return {scratch + (row - top) * pitch(), pitch(), false};
    return {g.a + row * g.lda + k0, g.lda, false};
  }
  void copy_rows(Index first, Index last) const {
    for (Index r = first; r < last; ++r) {
      std::memcpy(scratch + (r - top) * pitch(), g.a + r * g.lda + k0, static_cast<std::size_t>(bytes<S>(depth())));
    }
  }

  void multiply() const {
    const Index depth = this->depth(), tiles = (below - top + tile_rows - 1) / tile_rows;
    const bool whole = depth == g.k, transposed = g.a_transposed;
    const Index together = far && whole ? std::max<Index>(1, half_cache / std::max<Index>(1, bytes<S>(depth * w))) : 1;
    const Index groups = (right - left + together - 1) / together;
    // Rows that are copied: all at once if the result stays in the caches (3 % faster at 408 x 1024 x 512), else a
    // tile's when it is next.
    if (transposed)
      copy_tiles<S>(g.a + k0 * g.lda + top, g.lda, depth, below - top, g.m - top, scratch);
    else if (copies && !far)
      copy_rows(top, below);
    for (Index group = 0; group < groups; ++group) {
      const Index j0 = left + part(right - left, group, groups), j1 = left + part(right - left, group + 1, groups);
      const Index panels = j1 - j0, panel_bytes = bytes<S>(panels * depth * w);
      const std::byte* next_panels = j1 < right ? as_bytes(slice(j1)) : next;
      const Index next_panel_bytes = j1 < right ? panel_bytes : std::min(panel_bytes, next_bytes);
      for (Index t = 0, row = top, height; t < tiles; ++t, row += height) {
        height = top + part(below - top, t + 1, tiles) - row;
        const Index next_row = row + height;
        if (copies && far && group == 0) copy_rows(row, next_row);
        // With half of the first panels the next rows are fetched, if they lie together. (With one panel at a time:
        // none.)
        const bool fetches_rows = group == 0 && !transposed && g.lda <= g.k && next_row < end;
        const Index row_panels = fetches_rows ? panels / 2 : 0, rest = panels - row_panels;
        const Index next_row_bytes = bytes<S>(std::min(height, end - next_row) * g.lda);
        for (Index i = 0; i < panels; ++i) {
          const Index j = j0 + i, columns = g.n - j * w;
          const Ahead ahead =
              i < row_panels
                  ? Ahead::share(as_bytes(g.a + next_row * g.lda), next_row_bytes, i, row_panels, depth)
                  : Ahead::share(next_panels, next_panel_bytes, t * rest + i - row_panels, tiles * rest, depth);
          S* c = g.c + row * g.ldc + j * w;
          const auto e = Epilogue<S>::of(g, row, j * w, k0 == 0, k1 == g.k);
          tile_of<S>(height, transposed, columns)(rows_of(t, row), slice(j), depth, c, g.ldc, columns, e, ahead);
        }
      }
    }
  }
};

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product.
template <class S>
void gemm_block(const Gemm<S>& g, Index r0, Index r1, Index j0, Index j1, S* scratch) {
  const Blocks<S> split(g.k);
  const Index blocks = split.count, row_blocks = (r1 - r0 + split.rows - 1) / split.rows;
  // Rows of A whose distance is a multiple of the page size fall into the same cache set: they are copied side by side,
  // once.
  const bool copies = !g.a_transposed && bytes<S>(g.lda) % 4096 == 0;
  const bool all_panels = copies || g.a_transposed || blocks == 1;
  const Index wide = all_panels ? std::max<Index>(1, j1 - j0) : panel_block, pieces = (j1 - j0 + wide - 1) / wide;
  const bool far = bytes<S>(g.m * g.n) > near_caches;
  for (Index i = 0; i < row_blocks * pieces * blocks; ++i) {
    const Index row_block = i / blocks / pieces, left = j0 + i / blocks % pieces * wide, block = i % blocks;
    GemmPiece<S> piece{.g = g,
                       .scratch = scratch,
                       .copies = copies,
                       .far = far,
                       .top = r0 + part(r1 - r0, row_block, row_blocks),
                       .below = r0 + part(r1 - r0, row_block + 1, row_blocks),
                       .end = r1,
                       .left = left,
                       .right = std::min(j1, left + wide),
                       .k0 = part(g.k, block, blocks),
                       .k1 = part(g.k, block + 1, blocks)};
    const bool next_columns = block + 1 == blocks, next_rows = next_columns && piece.right == j1,
               last = next_rows && piece.below == r1;
    const S* next = g.panels + ((next_rows      ? j0
                                 : next_columns ? piece.right
                                                : left) *
                                    g.k +
                                (next_columns ? 0 : piece.k1)) *
                                   piece.w;
    piece.next = last ? g.following(j0, (g.n + piece.w - 1) / piece.w, next) : as_bytes(next);
    if (last && g.after != nullptr) piece.next_bytes = g.after_bytes;
    piece.multiply();
  }
}
//
// Attention of one head over one sequence, forward and backward. The score matrix exists for one tile of rows (forward)
// or one head (backward), never for a batch.
//
//   S = Q K^T / sqrt(width),   P = softmax(S),   O = P V
//   dV = P^T dO,   dP = dO V^T,   dS = P (dP - rowsum(P dP)),   dQ = dS K / sqrt(width),   dK = dS^T Q / sqrt(width)

/// Softmax of R rows of `n` scores times `scale`, in place; columns up to the next vector are set to 0.
/// `visible[i]` columns of row i take part (causal attention), the rest are 0. Several rows are as many chains of sums:
/// none waits.
template <class S, int R>
MOTIONLANG_INLINE void softmax_rows_at(S* rows, Index pitch, Index n, const Index* visible, S scale) {
  constexpr int l = lanes<S>;
  const Index padded = (n + l - 1) / l * l;
  constexpr S hidden = sizeof(S) == 4 ? S(-1e30) : S(-1e300);
  Vec<S> largest[R], sum[R], inverse[R];
  S shift[R];
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) {
    for (Index c = visible[i]; c < padded; ++c) rows[i * pitch + c] = hidden;
    largest[i] = splat(hidden), sum[i] = Vec<S>{};
  }
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) largest[i] = vmax<S>(largest[i], load(rows + i * pitch + c));
  }
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) shift[i] = reduce_max<S>(largest[i]) * scale;
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      const Vec<S> e = vexp<S>(load(rows + i * pitch + c) * scale - shift[i]);
      store(rows + i * pitch + c, e);
      sum[i] += e;
    }
  }
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) inverse[i] = splat(S(1) / reduce_add<S>(sum[i]));
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) store(rows + i * pitch + c, load(rows + i * pitch + c) * inverse[i]);
  }
}
inline constexpr int softmax_group = 4;  // of rows
/// The same for `count` rows, the first of which is query `first`; causal: row i sees keys up to its own number.
template <class S>
void softmax_rows_of(S* rows, Index pitch, Index count, Index n, Index first, bool causal, S scale) {
  for (Index r = 0; r < count;) {
    Index visible[softmax_group];
    for (int i = 0; i < softmax_group; ++i) visible[i] = causal ? std::min(n, first + r + i + 1) : n;
    if (r + softmax_group <= count)
      softmax_rows_at<S, softmax_group>(rows + r * pitch, pitch, n, visible, scale), r += softmax_group;
    else
      softmax_rows_at<S, 1>(rows + r * pitch, pitch, n, visible, scale), ++r;
  }
}

/// y = x times the factors of Dropout (core/dropout.hpp) at positions first, first + 1, ...; its own derivative.
template <class S>
void dropout(const S* x, Index n, Index first, const Dropout& d, S* y) {
  typedef std::uint32_t Bits __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
  constexpr Index l = MOTIONLANG_VECTOR_BYTES / 4;
  const std::uint32_t limit = d.limit();
  const auto key0 = static_cast<std::uint32_t>(d.key) + static_cast<std::uint32_t>(first >> 32) * 0x27D4EB2Fu;
  const auto key1 = static_cast<std::uint32_t>(d.key >> 32);
  const S keep = static_cast<S>(1.0 / (1.0 - d.p));
  Bits counter;
  for (Index i = 0; i < l; ++i) counter[i] = static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(i);
  for (Index i = 0; i < n; i += l, counter += static_cast<std::uint32_t>(l)) {
    Bits h = counter * 0x9E3779B1u + key0;
    h = (h ^ (h >> 16)) * 0x85EBCA6Bu + key1;
    h = (h ^ (h >> 13)) * 0xC2B2AE35u;
    h = h ^ (h >> 16);
    if (sizeof(S) == 4 && i + l <= n) {
      const Vec<S> kept = load(x + i) * keep;
      store(y + i, (Mask<S>)(h >= limit) ? kept : Vec<S>{});
    } else {
      for (Index c = 0; c < l && i + c < n; ++c) y[i + c] = h[c] >= limit ? x[i + c] * keep : S(0);
    }
  }
}

template <class S>
MOTIONLANG_INLINE Index padded_panels(Index n) {
  return (n + panel_width<S> - 1) / panel_width<S>;
}

/// The products of attention in S. (Bf16Products is the other kind.)
template <class S>
struct FloatProducts {
  using Number = S;
  static constexpr Index rows = tile_rows;  // that products are fastest with
  static void begin() {}
  static void end() {}
  /// Columns that products write of n.
  static Index columns(Index n) { return padded_panels<S>(n) * panel_width<S>; }
  /// Numbers of scratch: panels of a matrix (k, n), and what a product over k needs.
  static Index panels(Index k, Index n) { return columns(n) * k; }
  static Index scratch(Index) { return 0; }

  static void pack(const S* b, Index k, Index n, Index stride_k, Index stride_n, S* panels) {
    if (stride_n == 1)
      pack_rows(b, k, n, stride_k, Index{0}, k, panels);
    else
      pack_transposed<S, false>(b, k, n, stride_n, Index{0}, padded_panels<S>(n), panels);
  }
  /// c = a panels, tile by tile, without blocks of k (all operands are in cache).
  static void multiply(const Rows<S>& a, Index count, Index k, const S* panels, Index n, S* c, Index ldc, S*,
                       bool whole_panels) {
    constexpr Index w = panel_width<S>;
    const Index tiles = (count + tile_rows - 1) / tile_rows;
    const Epilogue<S> plain;
    for (Index j = 0; j < padded_panels<S>(n); ++j) {
      for (Index t = 0; t < tiles; ++t) {
        const Index first = part(count, t, tiles), height = part(count, t + 1, tiles) - first;
        tile_of<S>(height, a.transposed, n - j * w)(a.from(first), panels + j * k * w, k, c + first * ldc + j * w, ldc,
                                                    whole_panels ? w : n - j * w, plain, Ahead{as_bytes(panels)});
      }
    }
  }
};

/// One head over one sequence: where its rows begin. Rows of q, k, v have the strides of the tensors that they are
/// columns of.
template <class S>
struct AttentionHead {
  const Attention<S>& t;
  Index head, q0, k0, queries, keys;
  const S *q, *k, *v;

  AttentionHead(const Attention<S>& a, Index sequence, Index head_number)
      : t(a),
        head(head_number),
        q0(a.q_offsets[sequence]),
        k0(a.k_offsets[sequence]),
        queries(a.q_offsets[sequence + 1] - q0),
        keys(a.k_offsets[sequence + 1] - k0),
        q(a.q + q0 * a.q_stride + head * a.width),
        k(a.k + k0 * a.k_stride + head * a.width),
        v(a.v + k0 * a.v_stride + head * a.width) {}

  S scale() const { return S(1) / std::sqrt(static_cast<S>(t.width)); }
  /// Scores of `count` queries from `first` on, q k^T, become their rows of P: relative scores, softmax, dropout.
  void weights(Index first, Index count, S* rows, Index pitch) const {
    const S unscale = std::sqrt(static_cast<S>(t.width));
    for (Index r = 0; r < count && t.relative_scores != nullptr; ++r) {
      const S* relative = t.relative_scores + head * (2 * t.reach + 1) + t.reach - (first + r);
      for (Index c = 0; c < keys; ++c) rows[r * pitch + c] += relative[c] * unscale;
    }
    softmax_rows_of(rows, pitch, count, keys, first, t.causal, scale());
    for (Index r = 0; r < count && t.dropout.p > 0; ++r)
      dropout(rows + r * pitch, keys, mask_at(first + r), t.dropout, rows + r * pitch);
  }
  Index mask_at(Index query) const {
    return static_cast<Index>(Dropout::attention_position(q0 + query, t.heads, head, 0));
  }
};

/// Distance of rows of scores, whose columns up to the end of a panel are written.
template <class P>
Index score_pitch(Index keys) {
  return P::columns(keys) + 16;
}
/// Numbers of scratch that attention_head needs: K^T, V, and one tile of scores.
template <class P>
Index attention_scratch(Index keys, Index width) {
  return P::panels(width, keys) + P::panels(keys, width) + P::rows * score_pitch<P>(keys) +
         P::scratch(std::max(keys, width));
}
/// Numbers of scratch that attention_head_vjp needs, whose scores are those of all queries.
template <class P>
Index attention_vjp_scratch(Index queries, Index keys, Index width) {
  const Index longest = std::max(keys, queries);
  return P::panels(width, keys) + P::panels(longest, width) + 2 * queries * score_pitch<P>(keys) +
         P::scratch(std::max(longest, width));
}

/// Output of one head, for one of so many pieces of its queries.
template <class P, class S = typename P::Number>
void attention_head(const Attention<S>& t, Index sequence, Index head, Index piece, Index pieces, S* kt) {
  const AttentionHead<S> h(t, sequence, head);
  const Index tiles = (h.queries + P::rows - 1) / P::rows, begin = part(tiles, piece, pieces),
              end = part(tiles, piece + 1, pieces);
  if (begin == end) return;
  const Index pitch = score_pitch<P>(h.keys);
  S* vp = kt + P::panels(t.width, h.keys);
  S* scores = vp + P::panels(h.keys, t.width);
  S* scratch = scores + P::rows * pitch;
  S* o = t.o + h.q0 * t.o_stride + head * t.width;
  P::pack(h.k, t.width, h.keys, Index{1}, t.k_stride, kt);  // K^T
  P::pack(h.v, h.keys, t.width, t.v_stride, Index{1}, vp);
  P::begin();
  for (Index i = begin; i < end; ++i) {
    const Index first = part(h.queries, i, tiles), rows = part(h.queries, i + 1, tiles) - first;
    P::multiply({h.q + first * t.q_stride, t.q_stride, false}, rows, t.width, kt, h.keys, scores, pitch, scratch, true);
    h.weights(first, rows, scores, pitch);
    P::multiply({scores, pitch, false}, rows, h.keys, vp, t.width, o + first * t.o_stride, t.o_stride, scratch, false);
  }
  P::end();
}

/// Gradients of one head; dq, dk, dv are written, with the strides of q, k, v.
template <class P, class S = typename P::Number>
void attention_head_vjp(const Attention<S>& t, const AttentionGradients<S>& g, Index sequence, Index head, S* a) {
  constexpr int l = lanes<S>;
  const AttentionHead<S> h(t, sequence, head);
  const Index queries = h.queries, keys = h.keys, width = t.width, pitch = score_pitch<P>(keys);
  const S* d_o = g.d_o + h.q0 * t.o_stride + head * width;
  const S scale = h.scale();
  S* b = a + P::panels(width, keys);  // panels with the keys or queries as the summed index; a: K^T, then V^T
  S* p = b + P::panels(std::max(keys, queries), width);  // P, later P after dropout
  S* ds = p + queries * pitch;                           // dP, later dS
  S* scratch = ds + queries * pitch;
  P::begin();
  P::pack(h.k, width, keys, Index{1}, t.k_stride, a);
  P::multiply({h.q, t.q_stride, false}, queries, width, a, keys, p, pitch, scratch, true);
  P::pack(h.v, width, keys, Index{1}, t.v_stride, a);
  P::multiply({d_o, t.o_stride, false}, queries, width, a, keys, ds, pitch, scratch, true);
  for (Index r = 0; r < queries; ++r) {
    S *pr = p + r * pitch, *dr = ds + r * pitch;
    if (r % softmax_group == 0)
      softmax_rows_of(pr, pitch, std::min<Index>(softmax_group, queries - r), keys, r, t.causal, scale);
    if (t.dropout.p > 0) dropout(dr, keys, h.mask_at(r), t.dropout, dr);
    Vec<S> sum{};
    for (Index c = 0; c < keys; c += l) sum += load(pr + c) * load(dr + c);  // P is 0 beyond the keys
    const S mean = reduce_add<S>(sum);
    for (Index c = 0; c < keys; c += l) store(dr + c, load(pr + c) * (load(dr + c) - mean) * scale);
    if (t.dropout.p > 0) dropout(pr, keys, h.mask_at(r), t.dropout, pr);
  }
  S* dq = g.d_q + h.q0 * t.q_stride + head * width;
  S* dk = g.d_k + h.k0 * t.k_stride + head * width;
  S* dv = g.d_v + h.k0 * t.v_stride + head * width;
  P::pack(h.k, keys, width, t.k_stride, Index{1}, b);
  P::multiply({ds, pitch, false}, queries, keys, b, width, dq, t.q_stride, scratch, false);
  P::pack(h.q, queries, width, t.q_stride, Index{1}, b);
  P::multiply({ds, pitch, true}, keys, queries, b, width, dk, t.k_stride, scratch, false);
  P::pack(d_o, queries, width, t.o_stride, Index{1}, b);
  P::multiply({p, pitch, true}, keys, queries, b, width, dv, t.v_stride, scratch, false);
  P::end();
}
//
// Row-wise and element-wise kernels: layer norm, softmax, nonlinearities, sums, AdamW.

inline constexpr int norm_group = 4;  // rows at a time in layer norm
/// Means and 1 / sqrt(variance + eps) of R rows of n, side by side. Two passes: no cancellation. Several rows are as
/// many chains of sums: none waits.
template <class S, int R>
MOTIONLANG_INLINE void row_moments(const S* x, Index n, S eps, S* mean, S* rstd) {
  constexpr int l = lanes<S>;
  const Index whole = n / l * l;
  Vec<S> sum[R], square[R];
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) sum[r] = square[r] = Vec<S>{};
  for (Index i = 0; i < whole; i += l) {
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) sum[r] += load(x + r * n + i);
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    S total = reduce_add<S>(sum[r]);
    for (Index i = whole; i < n; ++i) total += x[r * n + i];
    mean[r] = total / static_cast<S>(n);
  }
  for (Index i = 0; i < whole; i += l) {
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> d = load(x + r * n + i) - mean[r];
      square[r] += d * d;
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    S variance = reduce_add<S>(square[r]);
    for (Index i = whole; i < n; ++i) variance += (x[r * n + i] - mean[r]) * (x[r * n + i] - mean[r]);
    rstd[r] = S(1) / std::sqrt(variance / static_cast<S>(n) + eps);
  }
}

/// layer_norm_rows of R rows.
template <class S, int R>
MOTIONLANG_INLINE void normalize_rows(const LayerNorm<S>& t, Index first) {
  constexpr int l = lanes<S>;
  const Index n = t.width, whole = n / l * l;
  const S* x = t.x + first * n;
  S* y = t.y + first * n;
  if (t.residual != nullptr) {
    const S* z = t.residual + first * n;
    for (Index i = 0; i < R * n; i += l)
      store_first(y + i, load_first(x + i, R * n - i) + load_first(z + i, R * n - i), R * n - i);
    x = y;
  }
  S mean[R], rstd[R];
  row_moments<S, R>(x, n, t.eps, mean, rstd);
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i), bias = load(t.bias + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      __builtin_prefetch(x + (R + r) * n + i);  // of the next rows
      store(y + r * n + i, (load(x + r * n + i) - mean[r]) * rstd[r] * weight + bias);
    }
  }
  for (Index i = whole; i < n; ++i) {
    for (int r = 0; r < R; ++r) y[r * n + i] = (x[r * n + i] - mean[r]) * rstd[r] * t.weight[i] + t.bias[i];
  }
}
/// y = (x + residual - mean) rstd weight + bias. The sum stands in y before it is normalized; there may be no residual.
template <class S>
void layer_norm_rows(const LayerNorm<S>& t, Index first, Index last) {
  for (; first + norm_group <= last; first += norm_group) normalize_rows<S, norm_group>(t, first);
  for (; first < last; ++first) normalize_rows<S, 1>(t, first);
}

/// layer_norm_rows_vjp of R rows.
template <class S, int R>
MOTIONLANG_INLINE void normalize_rows_vjp(const LayerNorm<S>& t, const S* dy, S* dx, S* moments, Index first) {
  constexpr int l = lanes<S>;
  const Index n = t.width, whole = n / l * l;
  const S *x = t.x + first * n, *g = dy + first * n;
  S* d = dx + first * n;
  S mean[R], rstd[R], h0[R], h1[R];
  row_moments<S, R>(x, n, t.eps, mean, rstd);
  Vec<S> sum_h[R], sum_hx[R];
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) sum_h[r] = sum_hx[r] = Vec<S>{};
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> h = load(g + r * n + i) * weight;
      sum_h[r] += h;
      sum_hx[r] += h * ((load(x + r * n + i) - mean[r]) * rstd[r]);
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    h0[r] = reduce_add<S>(sum_h[r]), h1[r] = reduce_add<S>(sum_hx[r]);
    for (Index i = whole; i < n; ++i) {
      const S h = g[r * n + i] * t.weight[i];
      h0[r] += h;
      h1[r] += h * ((x[r * n + i] - mean[r]) * rstd[r]);
    }
    h0[r] /= static_cast<S>(n);
    h1[r] /= static_cast<S>(n);
  }
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> xhat = (load(x + r * n + i) - mean[r]) * rstd[r];
      store(d + r * n + i, (load(g + r * n + i) * weight - h0[r] - xhat * h1[r]) * rstd[r]);
    }
  }
  for (int r = 0; r < R; ++r) {
    for (Index i = whole; i < n; ++i) {
      d[r * n + i] = (g[r * n + i] * t.weight[i] - h0[r] - (x[r * n + i] - mean[r]) * rstd[r] * h1[r]) * rstd[r];
    }
    moments[2 * (first + r)] = mean[r], moments[2 * (first + r) + 1] = rstd[r];
  }
}
/// dx = rstd (h - mean(h) - xhat mean(h xhat)),  h = dy weight,  xhat = (x - mean) rstd
template <class S>
void layer_norm_rows_vjp(const LayerNorm<S>& t, const S* dy, S* dx, S* moments, Index first, Index last) {
  for (; first + norm_group <= last; first += norm_group) normalize_rows_vjp<S, norm_group>(t, dy, dx, moments, first);
  for (; first < last; ++first) normalize_rows_vjp<S, 1>(t, dy, dx, moments, first);
}
/// dweight = sum over rows of dy xhat, dbias = sum of dy; columns first ... last-1.
template <class S>
void layer_norm_columns_vjp(const LayerNorm<S>& t, const S* dy, const S* moments, S* dweight, S* dbias, Index rows,
                            Index first, Index last) {
  for (Index i = first; i < last; ++i) dweight[i] = dbias[i] = S(0);
  for (Index r = 0; r < rows; ++r) {
    const S mean = moments[2 * r], rstd = moments[2 * r + 1];
    const S *x = t.x + r * t.width, *g = dy + r * t.width;
    for (Index i = first; i < last; ++i) {
      dweight[i] += g[i] * ((x[i] - mean) * rstd);
      dbias[i] += g[i];
    }
  }
}

/// y = softmax(x) for rows of n; `scratch` holds one row, rounded up to whole vectors.
template <class S>
void softmax_rows(const S* x, Index n, Index first, Index last, S* y, S* scratch) {
  for (Index r = first; r < last; ++r) {
    std::memcpy(scratch, x + r * n, static_cast<std::size_t>(n) * sizeof(S));
    softmax_rows_at<S, 1>(scratch, n, n, &n, S(1));
    std::memcpy(y + r * n, scratch, static_cast<std::size_t>(n) * sizeof(S));
  }
}

/// Columns first ... last-1 of y; first is a multiple of `lanes`.
template <class S>
void transpose(const Transposed<S>& t, Index first, Index last) {
  constexpr Index l = lanes<S>;
  for (Index j = first; j < last; j += l) {
    const Index n = std::min(l, last - j);
    const bool whole = n == l;
    const Vec<S> bias = t.bias == nullptr ? Vec<S>{} : load_some(t.bias + j, n);
    for (Index r = 0; r < t.rows; ++r) {
      const S* z = t.z + j * t.rows + r;
      const S* residual = t.residual == nullptr ? nullptr : t.residual + r * t.width + j;
      S* y = t.y + r * t.width + j;
      Vec<S> x{};
      if (whole) {
#pragma GCC unroll 16
        for (int i = 0; i < lanes<S>; ++i) x[i] = z[i * t.rows];
        x += bias;
        if (residual != nullptr) x += load(residual);
        store(y, x);
      } else {
        for (Index i = 0; i < n; ++i) x[i] = z[i * t.rows];
        x += bias;
        if (residual != nullptr) x += load_some(residual, n);
        store_some(y, x, n);
      }
    }
    if (t.act != Activation::none) activate_rows(t.y + j, t.width, t.rows, n, t.act, t.y + j, t.width);
  }
}

template <BinaryOp op, class S>
MOTIONLANG_INLINE Vec<S> apply_binary(const Vec<S>& a, const Vec<S>& b) {
  switch (op) {
    case BinaryOp::add:
      return a + b;
    case BinaryOp::sub:
      return a - b;
    case BinaryOp::mul:
      return a * b;
    case BinaryOp::div:
      return a / b;
    case BinaryOp::maximum:
      return a < b ? b : a;
  }
  return a;
}
/// A repeated operand is read again and again from one vector of copies.
template <BinaryOp op, class S>
MOTIONLANG_INLINE void binary_loop(const Binary<S>& t) {
  constexpr int l = lanes<S>;
  const Vec<S> copies_a = splat(*t.a), copies_b = splat(*t.b);
  const S *a = t.a_repeated ? reinterpret_cast<const S*>(&copies_a) : t.a,
          *b = t.b_repeated ? reinterpret_cast<const S*>(&copies_b) : t.b;
  const Index step_a = t.a_repeated ? 0 : l, step_b = t.b_repeated ? 0 : l;
  Index i = 0;
  for (; i + l <= t.count; i += l, a += step_a, b += step_b) store(t.y + i, apply_binary<op, S>(load(a), load(b)));
  const Index n = t.count - i;
  store_some(t.y + i, apply_binary<op, S>(load_some(a, n), load_some(b, n)), n);
}
template <class S>
void binary(const Binary<S>& t) {
  switch (t.op) {
    case BinaryOp::add:
      return binary_loop<BinaryOp::add>(t);
    case BinaryOp::sub:
      return binary_loop<BinaryOp::sub>(t);
    case BinaryOp::mul:
      return binary_loop<BinaryOp::mul>(t);
    case BinaryOp::div:
      return binary_loop<BinaryOp::div>(t);
    case BinaryOp::maximum:
      return binary_loop<BinaryOp::maximum>(t);
  }
}

template <class S>
void error_function(const S* x, Index n, S* y) {
  constexpr int l = lanes<S>;
  Index i = 0;
  for (; i + l <= n; i += l) store(y + i, verf<S>(load(x + i)));
  store_some(y + i, verf<S>(load_some(x + i, n - i)), n - i);
}

/// Sums of the rows first ... last-1, of n numbers each. Four chains of sums: none waits.
template <class S>
void row_sums(const S* x, Index n, Index first, Index last, S* y) {
  constexpr int l = lanes<S>;
  for (Index r = first; r < last; ++r) {
    const S* row = x + r * n;
    Vec<S> sums[4] = {};
    Index i = 0;
    for (; i + 4 * l <= n; i += 4 * l) {
#pragma GCC unroll 4
      for (int c = 0; c < 4; ++c) sums[c] += load(row + i + c * l);
    }
    for (; i < n; i += l) sums[0] += load_first(row + i, n - i);
    y[r] = reduce_add<S>(sums[0] + sums[1] + (sums[2] + sums[3]));
  }
}
/// Sums of the columns first ... last-1 over all rows.
template <class S>
void column_sums(const S* x, Index rows, Index width, Index first, Index last, S* y) {
  for (Index i = first; i < last; ++i) y[i] = S(0);
  for (Index r = 0; r < rows; ++r) {
    for (Index i = first; i < last; ++i) y[i] += x[r * width + i];
  }
}

template <class S>
MOTIONLANG_INLINE Vec<S> adamw_update(const AdamwStep<S>& t, const Vec<S>& p, const Vec<S>& gradient, Vec<S>& m,
                                      Vec<S>& v) {
  const Vec<S> g = gradient * t.gradient_scale;
  m = m * t.beta1 + g * t.rest1;
  v = v * t.beta2 + g * g * t.rest2;
  return p * t.decay - t.step * m / (vsqrt<S>(v) * t.correction + t.eps);
}
/// AdamW in one pass over parameter, gradient and moments (see optim/adamw.hpp for the formula).
template <class S>
void adamw(const AdamwStep<S>& t, Index first, Index last) {
  constexpr int l = lanes<S>;
  Index i = first;
  for (; i + l <= last; i += l) {
    Vec<S> m = load(t.m + i), v = load(t.v + i);
    store(t.p + i, adamw_update<S>(t, load(t.p + i), load(t.g + i), m, v));
    store(t.m + i, m), store(t.v + i, v);
  }
  const Index n = last - i;
  Vec<S> m = load_some(t.m + i, n), v = load_some(t.v + i, n);
  store_some(t.p + i, adamw_update<S>(t, load_some(t.p + i, n), load_some(t.g + i, n), m, v), n);
  store_some(t.m + i, m, n), store_some(t.v + i, v, n);
}

#define MOTIONLANG_STRING_OF(x) #x
#define MOTIONLANG_STRING(x) MOTIONLANG_STRING_OF(x)

// Matrix product in bfloat16 with sums in float. Three tiles, one text around them: this file has the tile for any
// processor, which widens bfloat16 to float; bf16_x86.inc has those for vdpbf16ps and for AMX.
//
//   Panels   B (k x n) is rounded and stored in panels of 32 columns, pairs of k side by side: [panel][k /
//            2][column][2], zero padded to a multiple of 32 in k. The same for all tiles, but for numbers below 2^-126,
//            which some round to 0.
//   Rows     A is rounded into scratch, a block of rows at a time, zero padded in k: [row][k].
//   Tile     some rows of A times one panel, over k filled up to as many as its instructions take at a time (in pieces
//            of k, if the tile has pieces); what to do with the sums, as in gemm.inc. (In AMX the bias is the first
//            number of a sum.)
//   Order    every element is summed over k in an order that depends on the tile alone: same bits for any block or
//            thread.

typedef std::uint32_t Words __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
typedef std::uint32_t LooseWords __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES), aligned(2), may_alias));
typedef std::uint16_t Halves __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES / 2)));
typedef std::uint16_t LooseHalves __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES / 2), aligned(2), may_alias));
inline constexpr Index word_lanes = MOTIONLANG_VECTOR_BYTES / 4;

/// The nearest bfloat16, ties to even, in the upper half of each word; NaN stays NaN.
MOTIONLANG_INLINE Words round_to_bf16(const Vec<float>& x) {
  const Words w = (Words)x, rounded = w + (w >> 16 & 1u) + 0x7FFFu;
  return ((w & 0x7FFFFFFFu) > 0x7F800000u ? w | 0x400000u : rounded) & 0xFFFF0000u;
}
MOTIONLANG_INLINE void store_rounded(float* y, const Words& w) { store(y, (Vec<float>)w); }
MOTIONLANG_INLINE void store_rounded(std::uint16_t* y, const Words& w) {
  *reinterpret_cast<LooseHalves*>(y) = __builtin_convertvector(w >> 16, Halves);
}

/// A vector of numbers, rounded; zeros from the n-th on.
MOTIONLANG_INLINE Words rounded(const float* x, Index n) { return round_to_bf16(load_first(x, n)); }
/// Of two vectors of rounded numbers: pairs of bfloat16.
MOTIONLANG_INLINE Words pairs(const Words& first, const Words& second) { return first >> 16 | second; }
MOTIONLANG_INLINE void store_words(std::uint16_t* y, const Words& w) { *reinterpret_cast<LooseWords*>(y) = w; }

/// The same as round_row of a tile (but for numbers below 2^-126) for `rows` rows whose numbers are a[k * lda + row]:
/// squares of lanes are transposed.
template <class Element>
void round_columns(const float* a, Index lda, Index rows, Index k, Index padded, Element* y, Index pitch) {
  constexpr Index l = word_lanes, depth = l * (4 / static_cast<Index>(sizeof(Element)));  // of a square
  for (Index r = 0; r < rows; r += l) {
    const Index n = std::min(rows - r, l);
    for (Index i = 0; i < padded; i += depth) {
      Vec<float> square[lanes<float>];
#pragma GCC unroll 16
      for (int q = 0; q < lanes<float>; ++q) {
        const auto row = [&](Index at) {
          // no prefetcher follows pieces so far apart
          if (at + depth < k) __builtin_prefetch(a + (at + depth) * lda + r);
          return rounded(a + at * lda + r, at < k ? n : 0);
        };
        if constexpr (sizeof(Element) == 4) {
          square[q] = (Vec<float>)row(i + q);
        } else {
          square[q] = (Vec<float>)pairs(row(i + 2 * q), row(i + 2 * q + 1));
        }
      }
      transpose_lanes<float>(square);
      for (Index c = 0; c < n; ++c) std::memcpy(y + (r + c) * pitch + i, &square[c], sizeof square[c]);
    }
  }
}

/// Rows k0 ... k1-1 (both even) of all panels of B, whose element (k, n) is b[k * stride + n]: two rows at a
/// time, through as many panels as lie in different parts of the cache.
template <class Tile>
void bf16_pack_rows(const float* b, Index k, Index n, Index stride, Index k0, Index k1, std::uint16_t* panels) {
  constexpr Index ahead = 8;  // rows
  const Index depth = bf16_depth(k), count = (n + bf16_columns - 1) / bf16_columns;
  for (Index left = 0; left < count; left += panel_block) {
    for (Index i = k0; i < k1; i += 2) {
      const float *even = b + i * stride + left * bf16_columns, *odd = even + stride;
      std::uint16_t* out = panels + (left * depth + i) * bf16_columns;
      for (Index j = left; j < std::min(count, left + panel_block);
           ++j, even += bf16_columns, odd += bf16_columns, out += depth * bf16_columns) {
        fetch(even + ahead * stride, bf16_columns), fetch(odd + ahead * stride, bf16_columns);
        const Index columns = n - j * bf16_columns;
        Tile::round_pairs(even, i < k ? columns : 0, odd, i + 1 < k ? columns : 0, out);
      }
    }
  }
}
/// Panels first ... last-1 of B, whose element (k, n) is b[k + n * stride]: read along its rows, a square of lanes at a
/// time. Whether all numbers are finite, if it looks.
template <class Tile, bool looks>
bool bf16_pack_transposed(const float* b, Index k, Index n, Index stride, Index first, Index last,
                          std::uint16_t* panels) {
  constexpr Index l = word_lanes, block = 256, pitch = block + 32;  // of k that are rounded at once
  const Index depth = bf16_depth(k);
  std::uint16_t lines[static_cast<std::size_t>(bf16_columns * pitch)];  // columns of B: [column][k]
  Mask<float> found{};
  for (Index j = first; j < last; ++j) {
    std::uint16_t* out = panels + j * depth * bf16_columns;
    const float* in = b + j * bf16_columns * stride;
    const Index columns = n - j * bf16_columns;
    for (Index i0 = 0; i0 < depth; i0 += block) {
      const Index length = std::min(block, depth - i0);
      for (Index c = 0; c < bf16_columns; ++c) {
        const float* row = in + c * stride + i0;
        const Index there = c < columns ? std::min(k - i0, length) : 0;
        if constexpr (looks) {
          for (Index i = 0; i < there; i += lanes<float>) find_not_finite<float>(load_first(row + i, there - i), found);
        }
        Tile::round_row(row, there, length, lines + c * pitch);
      }
      for (Index i = 0; i < length; i += 2 * l, out += 2 * l * bf16_columns) {
        for (Index c = 0; c < bf16_columns; c += l) {
          Vec<float> square[lanes<float>];  // column, pair
#pragma GCC unroll 16
          for (int q = 0; q < lanes<float>; ++q) std::memcpy(&square[q], lines + (c + q) * pitch + i, sizeof square[q]);
          transpose_lanes<float>(square);
          for (Index p = 0; p < l; ++p) std::memcpy(out + (p * bf16_columns + c) * 2, &square[p], sizeof square[p]);
        }
      }
    }
  }
  return !any_negative<float>(found);
}

/// Bytes of a pair of k in a panel.
inline constexpr Index pair_bytes = 4 * bf16_columns;

/// True if a tile's rows of the result, which are whole lines, are better written past the caches: the caches would
/// read every line before it is overwritten, and forget other things. So for results larger than all of them, and for
/// those larger than the nearer ones whose rows are a multiple of the page size apart: a tile's rows then fall into the
/// same cache set.
inline bool streams(const Gemm<float>& g) {
  constexpr Index all = 16 << 20;
  const bool whole_lines =
      g.n % bf16_columns == 0 && bytes<float>(g.ldc) % 64 == 0 && reinterpret_cast<std::uintptr_t>(g.c) % 64 == 0;
  return whole_lines && bytes<float>(g.m * g.n) > (bytes<float>(g.ldc) % 4096 == 0 ? near_caches : all);
}
/// Rows of one panel's width, from where a tile has put them.
inline void stream_rows(const float* from, Index rows, float* to, Index ldc) {
  for (Index r = 0; r < rows; ++r, from += bf16_columns, to += ldc) {
    for (Index i = 0; i < bf16_columns; i += lanes<float>) store_stream(to + i, load(from + i));
  }
}

class PanelSplit;

/// What a tile is asked for: c = `height` rows of A, which begin at a, times the first `columns` columns of a panel,
/// over `depth` of k.
template <class Element>
struct TileProduct {
  const Element* a;
  Index pitch, height;
  const std::uint16_t* panel;
  Index depth;
  float* c;
  Index ldc, columns;
  Epilogue<float> e{};
  Ahead ahead{};
  bool panel_stays = true;         // in the cache, for the next tile; else the rows stay
  bool stream = false;             // c is written past the caches
  Index number = 0;                // of the tile among those of this panel
  bool first = true, last = true;  // piece of k
  PanelSplit* next = nullptr;      // of floats in parts: the panel that is split meanwhile
};

/// Tiles that keep their sums in registers: Tile::rows_of<height> does it all. Every tile has besides
///     round_row(x, n, padded, y)       y = n numbers, rounded, then zeros up to `padded`, a multiple of 32
///     round_pairs(x, nx, y, ny, pairs) 32 pairs, rounded: numbers of x (zeros after nx), beside each its like of y
template <class Tile>
struct RegisterTile {
  static constexpr bool even = true;                                 // rows are split evenly among tiles
  static constexpr Index depth(Index k) { return (k + 1) / 2 * 2; }  // that is multiplied, of the padded one
  static constexpr Index pieces(Index, Index) { return 1; }          // of k
  static void begin() {}
  static void end() {}

  template <class Element>
  void multiply(const TileProduct<Element>& t) {
    static constexpr auto table = []<int... R>(std::integer_sequence<int, R...>) {
      return std::array{&Tile::template rows_of<R + 1>...};
    }
    (std::make_integer_sequence<int, Tile::rows>{});
    const auto rows_of = table[static_cast<std::size_t>(t.height - 1)];
    if (!t.stream) return rows_of(t.a, t.pitch, t.panel, t.depth, t.c, t.ldc, t.columns, t.e, t.ahead);
    alignas(64) float result[static_cast<std::size_t>(Tile::rows * bf16_columns)];
    rows_of(t.a, t.pitch, t.panel, t.depth, result, bf16_columns, t.columns, t.e, t.ahead);
    stream_rows(result, t.height, t.c, t.ldc);
  }
  void finish() {}
};

/// For any processor: rows of A are kept as rounded floats, a pair of B is split into two vectors of floats.
struct WideningTile : RegisterTile<WideningTile> {
  using Element = float;
  static constexpr const char* name = MOTIONLANG_STRING(MOTIONLANG_ISA);
  static constexpr int rows = MOTIONLANG_TILE_ROWS > 2 ? MOTIONLANG_TILE_ROWS - 2 : 2;
  template <class Number>
  static void round_row(const float* x, Index n, Index padded, Number* y) {
    for (Index i = 0; i < padded; i += word_lanes) store_rounded(y + i, rounded(x + i, n - i));
  }
  static void round_pairs(const float* x, Index nx, const float* y, Index ny, std::uint16_t* out) {
    for (Index c = 0; c < bf16_columns; c += word_lanes) {
      store_words(out + 2 * c, pairs(rounded(x + c, nx - c), rounded(y + c, ny - c)));
    }
  }

  template <int R>
  static void rows_of(const Element* a, Index pitch, const std::uint16_t* panel, Index depth, float* c, Index ldc,
                      Index columns, const Epilogue<float>& e, Ahead ahead) {
    constexpr int l = lanes<float>;
    for (Index column = 0; column < columns; column += 2 * l) {
      const Epilogue<float> piece = e.from_column(column);
      fetch_result<float, R>(c + column, ldc, piece);
      if (column > 0) ahead.step = 0;  // once is enough
      Vec<float> c0[R], c1[R];
#pragma GCC unroll 16
      for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<float>{};
      const std::uint16_t* b = panel + 2 * column;
      for (Index k = 0; k < depth; k += 2, b += 2 * bf16_columns) {
        ahead.fetch();
        const Words w0 = *reinterpret_cast<const LooseWords*>(b), w1 = *reinterpret_cast<const LooseWords*>(b + 2 * l);
        const Vec<float> even0 = (Vec<float>)(w0 << 16), odd0 = (Vec<float>)(w0 & 0xFFFF0000u);
        const Vec<float> even1 = (Vec<float>)(w1 << 16), odd1 = (Vec<float>)(w1 & 0xFFFF0000u);
#pragma GCC unroll 16
        for (int i = 0; i < R; ++i) {
          const float x = a[i * pitch + k], y = a[i * pitch + k + 1];
          c0[i] += x * even0;
          c1[i] += x * even1;
          c0[i] += y * odd0;
          c1[i] += y * odd1;
        }
      }
      put_result<float, R>(c0, c1, c + column, ldc, columns - column, piece);
    }
  }
};

/// The first `count` rows of A, side by side.
template <class Tile>
void round_rows(const Rows<float>& a, Index count, Index k, Index depth, typename Tile::Element* y, Index pitch) {
  if (a.transposed) return round_columns(a.at, a.stride, count, k, depth, y, pitch);
  for (Index r = 0; r < count; ++r) Tile::round_row(a.from(r).at, k, depth, y + r * pitch);
}

/// Rows of A in scratch at once, and their distance.
template <class Tile>
Index bf16_rows(Index k) {
  return rows_at_once(bytes<typename Tile::Element>(bf16_depth(k)), Tile::rows, half_cache / 2 * 3);
}
template <class Tile>
constexpr Index bf16_pitch(Index depth) {
  return depth + 64 / static_cast<Index>(sizeof(typename Tile::Element));
}
/// Numbers of scratch that bf16_gemm_block needs.
template <class Tile>
Index bf16_scratch(Index k) {
  return bf16_rows<Tile>(k) * bf16_pitch<Tile>(bf16_depth(k));
}

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product with bfloat16 panels.
template <class Tile>
void bf16_gemm_block(const Gemm<float>& g, const std::uint16_t* panels, Index r0, Index r1, Index j0, Index j1,
                     float* scratch) {
  using Element = typename Tile::Element;
  const Index depth = bf16_depth(g.k), pitch = bf16_pitch<Tile>(depth), at_once = bf16_rows<Tile>(g.k);
  Element* a = reinterpret_cast<Element*>(scratch);
  const bool stream = streams(g);
  Tile tile;
  Tile::begin();
  constexpr Index unit = Tile::even ? 1 : Tile::rows;  // of rows that blocks have evenly
  const Index units = (r1 - r0 + unit - 1) / unit, row_blocks = (r1 - r0 + at_once - 1) / at_once;
  for (Index block = 0; block < row_blocks; ++block) {
    const Index top = r0 + unit * part(units, block, row_blocks);
    const Index rows = std::min(r1, r0 + unit * part(units, block + 1, row_blocks)) - top,
                tiles = (rows + Tile::rows - 1) / Tile::rows;
    const Index pieces = Tile::pieces(depth, tiles);
    round_rows<Tile>(Rows<float>{g.a, g.lda, g.a_transposed}.from(top), rows, g.k, depth, a, pitch);
    for (Index j = j0; j < j1; ++j) {
      const std::uint16_t* panel = panels + j * depth * bf16_columns;
      const bool last = j + 1 == j1 && top + rows == r1;
      const std::byte* next = as_bytes(panels + (j + 1 < j1 ? j + 1 : j0) * depth * bf16_columns);
      const auto* following = last ? g.following(j0, (g.n + bf16_columns - 1) / bf16_columns, next) : next;
      for (Index step = 0; step < pieces * tiles; ++step) {
        const Index piece = step / tiles, t = step % tiles;
        const Index k0 = 32 * part(depth / 32, piece, pieces),
                    k1 = std::min(32 * part(depth / 32, piece + 1, pieces), Tile::depth(g.k));
        const Index first = Tile::even ? part(rows, t, tiles) : t * Tile::rows;
        const Index height = (Tile::even ? part(rows, t + 1, tiles) : std::min(rows, first + Tile::rows)) - first;
        const Index row = top + first, column = j * bf16_columns;
        const auto ahead =
            Ahead::share(following + k0 / 2 * pair_bytes, (k1 - k0) / 2 * pair_bytes, t, tiles, (k1 - k0) / 2);
        TileProduct<Element> product{.a = a + first * pitch + k0,
                                     .pitch = pitch,
                                     .height = height,
                                     .panel = panel + k0 * bf16_columns,
                                     .depth = k1 - k0,
                                     .c = g.c + row * g.ldc + column,
                                     .ldc = g.ldc,
                                     .columns = std::min(g.n - column, bf16_columns),
                                     .e = Epilogue<float>::of(g, row, column, true, true),
                                     .ahead = ahead,
                                     .panel_stays = tiles > 1,
                                     .stream = stream,
                                     .number = t,
                                     .first = piece == 0,
                                     .last = piece + 1 == pieces};
        tile.multiply(product);
      }
    }
  }
  tile.finish();
  if (stream) end_of_streams();
  Tile::end();
}

/// The products of attention (attention.inc) in bfloat16; scores and softmax stay in float.
template <class Tile>
struct Bf16Products {
  using Number = float;
  using Element = typename Tile::Element;
  static constexpr Index rows = Tile::rows;
  static void begin() { Tile::begin(); }
  static void end() { Tile::end(); }
  static Index columns(Index n) { return bf16_depth(n); }
  static Index panels(Index k, Index n) { return bf16_depth(k) * bf16_depth(n) / 2; }
  static Index scratch(Index k) { return Tile::rows * bf16_pitch<Tile>(bf16_depth(k)); }

  static void pack(const float* b, Index k, Index n, Index stride_k, Index stride_n, float* panels) {
    auto* out = reinterpret_cast<std::uint16_t*>(panels);
    if (stride_n == 1)
      bf16_pack_rows<Tile>(b, k, n, stride_k, 0, bf16_depth(k), out);
    else
      bf16_pack_transposed<Tile, false>(b, k, n, stride_n, 0, bf16_depth(n) / bf16_columns, out);
  }
  static void multiply(const Rows<float>& a, Index count, Index k, const float* panels, Index n, float* c, Index ldc,
                       float* scratch, bool whole_panels) {
    const Index depth = bf16_depth(k), pitch = bf16_pitch<Tile>(depth);
    auto* rounded_rows = reinterpret_cast<Element*>(scratch);
    Tile tile;
    for (Index first = 0; first < count; first += Tile::rows) {
      const Index height = std::min<Index>(Tile::rows, count - first);
      round_rows<Tile>(a.from(first), height, k, depth, rounded_rows, pitch);
      for (Index j = 0; j < n; j += bf16_columns) {
        const auto* panel = reinterpret_cast<const std::uint16_t*>(panels) + j * depth;
        tile.multiply(TileProduct<Element>{.a = rounded_rows,
                                           .pitch = pitch,
                                           .height = height,
                                           .panel = panel,
                                           .depth = Tile::depth(k),
                                           .c = c + first * ldc + j,
                                           .ldc = ldc,
                                           .columns = whole_panels ? bf16_columns : std::min(n - j, bf16_columns),
                                           .ahead = {as_bytes(panel)},
                                           .panel_stays = false});
      }
    }
    tile.finish();
  }
};

template <class Tile>
const Bf16Kernels& bf16_table() {
  static constexpr Bf16Kernels t{.name = Tile::name,
                                 .tile_rows = Tile::rows,
                                 .gemm_rows = &bf16_rows<Tile>,
                                 .gemm_scratch = &bf16_scratch<Tile>,
                                 .pack_rows = &bf16_pack_rows<Tile>,
                                 .pack_transposed = &bf16_pack_transposed<Tile, true>,
                                 .gemm_block = &bf16_gemm_block<Tile>,
                                 .attention_scratch = &attention_scratch<Bf16Products<Tile>>,
                                 .attention_vjp_scratch = &attention_vjp_scratch<Bf16Products<Tile>>,
                                 .attention_head = &attention_head<Bf16Products<Tile>>,
                                 .attention_head_vjp = &attention_head_vjp<Bf16Products<Tile>>};
  return t;
}

template <class S>
const Kernels<S>& table() {
  static constexpr Kernels<S> t{
      .name = MOTIONLANG_STRING(MOTIONLANG_ISA),
      .tiles = nullptr,
      .panel_width = panel_width<S>,
      .tile_rows = tile_rows,
      .gemm_rows = &gemm_rows<S>,
      .gemm_scratch = &gemm_scratch<S>,
      .pack_rows = &pack_rows<S>,
      .pack_transposed = &pack_transposed<S, true>,
      .gemm_block = &gemm_block<S>,
      .attention_scratch = &attention_scratch<FloatProducts<S>>,
      .attention_vjp_scratch = &attention_vjp_scratch<FloatProducts<S>>,
      .attention_head = &attention_head<FloatProducts<S>>,
      .attention_head_vjp = &attention_head_vjp<FloatProducts<S>>,
      .dropout = &dropout<S>,
      .layer_norm_rows = &layer_norm_rows<S>,
      .layer_norm_rows_vjp = &layer_norm_rows_vjp<S>,
      .layer_norm_columns_vjp = &layer_norm_columns_vjp<S>,
      .softmax_rows = &softmax_rows<S>,
      .transpose = &transpose<S>,
      .activate = &activate<S>,
      .activate_vjp = &activate_vjp<S>,
      .binary = &binary<S>,
      .error_function = &error_function<S>,
      .row_sums = &row_sums<S>,
      .column_sums = &column_sums<S>,
      .adamw = &adamw<S>,
  };
  return t;
}

#undef MOTIONLANG_STRING
#undef MOTIONLANG_STRING_OF
#undef MOTIONLANG_INLINE

}  // namespace detail::MOTIONLANG_ISA
MOTIONLANG_NAMESPACE_END
#undef MOTIONLANG_ISA
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS

// Without the optimiser the wider kernels would only take longer to compile.
#if defined(__x86_64__) && defined(__OPTIMIZE__)
#define MOTIONLANG_WIDE_KERNELS
MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX2)
#define MOTIONLANG_ISA avx2
#define MOTIONLANG_VECTOR_BYTES 32
#define MOTIONLANG_TILE_ROWS 6
// All kernels for one instruction set, and their table. Included by kernels.hpp, several times.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail::MOTIONLANG_ISA {

// Vectors of MOTIONLANG_VECTOR_BYTES bytes in the compiler's own vector types, and the elementary functions on them.
// Included once for every instruction set by kernels.hpp; no include guard on purpose.

template <class S>
struct VectorOf {
  typedef S type __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
  typedef S loose __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES), aligned(sizeof(S)), may_alias));
  using bits = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
  typedef bits mask __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
};
template <class S>
using Vec = typename VectorOf<S>::type;
template <class S>
using Mask = typename VectorOf<S>::mask;
template <class S>
inline constexpr int lanes = MOTIONLANG_VECTOR_BYTES / static_cast<int>(sizeof(S));

// Everything below is inlined: passing such vectors between functions would depend on the caller's instruction set.
#define MOTIONLANG_INLINE inline __attribute__((always_inline))

template <class S>
MOTIONLANG_INLINE Vec<S> load(const S* p) {
  return *reinterpret_cast<const typename VectorOf<S>::loose*>(p);
}
template <class S>
MOTIONLANG_INLINE void store(S* p, const Vec<S>& v) {
  *reinterpret_cast<typename VectorOf<S>::loose*>(p) = v;
}
/// Past the caches, to an address that is a multiple of the vector's size. Other threads see it after `end_of_streams`.
template <class S>
MOTIONLANG_INLINE void store_stream(S* p, const Vec<S>& v) {
#if defined(__clang__)
  __builtin_nontemporal_store(v, reinterpret_cast<Vec<S>*>(p));
#elif defined(__x86_64__)
  auto* at = reinterpret_cast<float*>(p);
#if MOTIONLANG_VECTOR_BYTES == 64
  __builtin_ia32_movntps512(at, (Vec<float>)v);
#elif MOTIONLANG_VECTOR_BYTES == 32
  __builtin_ia32_movntps256(at, (Vec<float>)v);
#else
  __builtin_ia32_movntps(at, (Vec<float>)v);
#endif
#else
  store(p, v);
#endif
}
/// Asks for n numbers that are read soon.
template <class Number>
MOTIONLANG_INLINE void fetch(const Number* x, Index n) {
  for (Index i = 0; i < n; i += 64 / static_cast<Index>(sizeof(Number))) __builtin_prefetch(x + i);
}
MOTIONLANG_INLINE void end_of_streams() {
#if defined(__x86_64__)
  __builtin_ia32_sfence();
#endif
}
template <class S>
MOTIONLANG_INLINE Vec<S> splat(S x) {
  return x - Vec<S>{};
}
template <class S>
MOTIONLANG_INLINE Vec<S> load_some(const S* p, Index n) {  // lanes n and above are 0
  alignas(MOTIONLANG_VECTOR_BYTES) S t[static_cast<std::size_t>(lanes<S>)] = {};
  for (Index i = 0; i < n && i < lanes<S>; ++i) t[i] = p[i];
  return load(t);
}
/// The first n numbers (all lanes if there are so many), then zeros; nothing is read if n <= 0.
template <class S>
MOTIONLANG_INLINE Vec<S> load_first(const S* p, Index n) {
  return n >= lanes<S> ? load(p) : load_some(p, n);
}
template <class S>
MOTIONLANG_INLINE void store_some(S* p, const Vec<S>& v, Index n) {
  for (Index i = 0; i < n && i < lanes<S>; ++i) p[i] = v[i];
}
template <class S>
MOTIONLANG_INLINE void store_first(S* p, const Vec<S>& v, Index n) {
  n >= lanes<S> ? store(p, v) : store_some(p, v, n);
}
// The larger and the smaller of two; b where either is NaN, so a bound comes first and data second.
// (Where one of them is a constant, GCC 12 makes two instructions of it for vectors of 64 bytes.)
template <class S>
MOTIONLANG_INLINE Vec<S> vmax(const Vec<S>& a, const Vec<S>& b) {
#if MOTIONLANG_VECTOR_BYTES == 64 && !defined(__clang__)
  if constexpr (sizeof(S) == 4) {
    Vec<S> r;
    asm("vmaxps %2, %1, %0" : "=v"(r) : "v"(a), "vm"(b));
    return r;
  }
#endif
  return a > b ? a : b;
}
template <class S>
MOTIONLANG_INLINE Vec<S> vmin(const Vec<S>& a, const Vec<S>& b) {
#if MOTIONLANG_VECTOR_BYTES == 64 && !defined(__clang__)
  if constexpr (sizeof(S) == 4) {
    Vec<S> r;
    asm("vminps %2, %1, %0" : "=v"(r) : "v"(a), "vm"(b));
    return r;
  }
#endif
  return a < b ? a : b;
}
/// Lanes of `found` become negative where x is NaN or infinite: all bits of its exponent are set.
template <class S>
MOTIONLANG_INLINE void find_not_finite(const Vec<S>& x, Mask<S>& found) {
  constexpr auto exponent = std::bit_cast<typename VectorOf<S>::bits>(std::numeric_limits<S>::infinity());
  found |= (~(Mask<S>)x & exponent) - 1;
}
template <class S>
MOTIONLANG_INLINE bool any_negative(const Mask<S>& v) {
  bool any = false;
  for (int i = 0; i < lanes<S>; ++i) any |= v[i] < 0;
  return any;
}
/// Lane i + half beside lane i, for the lower halves of blocks of 2 half lanes; the upper halves are of no account.
template <class S, int half, int... l>
MOTIONLANG_INLINE Vec<S> upper_lanes(const Vec<S>& v, std::integer_sequence<int, l...>) {
  return __builtin_shufflevector(v, v, (l + half) % lanes<S>...);
}
// Halves are put together until one lane is left: sums have a fixed order.
template <class S, int half = lanes<S> / 2>
MOTIONLANG_INLINE S reduce_add(const Vec<S>& v) {
  if constexpr (half == 0)
    return v[0];
  else
    return reduce_add<S, half / 2>(v + upper_lanes<S, half>(v, std::make_integer_sequence<int, lanes<S>>{}));
}
template <class S, int half = lanes<S> / 2>
MOTIONLANG_INLINE S reduce_max(const Vec<S>& v) {
  if constexpr (half == 0)
    return v[0];
  else
    return reduce_max<S, half / 2>(vmax<S>(v, upper_lanes<S, half>(v, std::make_integer_sequence<int, lanes<S>>{})));
}

/// Swaps the blocks off the diagonal: lane l + half of a with lane l of b, for every l without the bit `half`.
template <class S, int half, int... l>
MOTIONLANG_INLINE void swap_blocks(Vec<S>& a, Vec<S>& b, std::integer_sequence<int, l...>) {
  constexpr int n = lanes<S>;
  const Vec<S> upper = __builtin_shufflevector(a, b, ((l & half) != 0 ? n + l - half : l)...);
  b = __builtin_shufflevector(a, b, ((l & half) != 0 ? n + l : l + half)...);
  a = upper;
}
/// v[i][j] becomes v[j][i]: blocks of 1, 2, 4, ... lanes are swapped.
template <class S, int half = 1>
MOTIONLANG_INLINE void transpose_lanes(Vec<S>* v) {
  if constexpr (half < lanes<S>) {
#pragma GCC unroll 16
    for (int i = 0; i < lanes<S>; ++i) {
      if ((i & half) == 0) swap_blocks<S, half>(v[i], v[i + half], std::make_integer_sequence<int, lanes<S>>{});
    }
    transpose_lanes<S, 2 * half>(v);
  }
}

/// e^x for x <= 88 (709): x = n ln 2 + f, e^f by its series, 2^n by the exponent bits. Relative error below 1e-7
/// (1e-15). Results below the smallest normal number are 0. 2^n is a factor of its own, so that NaN stays NaN.
template <class S>
MOTIONLANG_INLINE Vec<S> vexp(const Vec<S>& x) {
  constexpr bool single = sizeof(S) == 4;
  constexpr S low = single ? S(-87) : S(-708), high = single ? S(88) : S(709);
  const Vec<S> c = vmin<S>(splat(high), x);
  // 1.5 * 2^23 (2^52), which rounds to an integer what it is added to, and the bias of exponents, which is then in the
  // lowest bits.
  const S magic = single ? S(12582912 + 127) : S(6755399441055744 + 1023);
  const Vec<S> shifted = c * S(1.4426950408889634) + magic;
  const Vec<S> n = shifted - magic;
  const Vec<S> f = (c - n * S(single ? 0.693359375 : 0.693147180369123816490)) -
                   n * S(single ? -2.12194440e-4 : 1.90821492927058770002e-10);
  Vec<S> p = splat(S(single ? 1.0 / 5040 : 1.0 / 6227020800.0));
  if constexpr (!single) {
    for (double k : {1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040})
      p = p * f + S(k);
  }
  for (double k : {1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0}) p = p * f + S(k);
  const Vec<S> power = (Vec<S>)((Mask<S>)shifted << (single ? 23 : 52));
  return x < splat(low) ? Vec<S>{} : p * power;  // so far below, n is nonsense
}

/// Float: (Phi(x) - 1/2) / x for y = x^2 <= 32, Phi being the normal distribution function: a rational function (our
/// own least-squares fit). Of Phi, 2e-8 is wrong by the fit; with what is rounded, below 2.5e-7.
template <class S>
MOTIONLANG_INLINE Vec<S> phi_ratio(const Vec<S>& y) {
  Vec<S> p = splat(S(2.1818830005316466e-08)), q = splat(S(1.1712714934253183e-06));
  p = p * y + S(6.364869382952854e-06);
  q = q * y + S(7.602274008301123e-05);
  p = p * y + S(0.00017693884114677917);
  q = q * y + S(0.0019305587808950675);
  p = p * y + S(0.004725908484413717);
  q = q * y + S(0.029119172061619288);
  p = p * y + S(0.0346923636272431);
  q = q * y + S(0.25362643899642984);
  p = p * y + S(0.3989422129894181);
  q = q * y + S(1);
  return p / q;
}
/// erf(x) = 2 Phi(sqrt(2) x) - 1. Float: absolute error below 5e-7. Double: libm.
template <class S>
MOTIONLANG_INLINE Vec<S> verf(const Vec<S>& x) {
  if constexpr (sizeof(S) == 4) {
    const Vec<S> c = vmin<S>(splat(S(4)), vmax<S>(splat(S(-4)), x));
    return c * phi_ratio<S>(c * c * S(2)) * S(2.8284271247461901);
  } else {
    Vec<S> r{};
    for (int i = 0; i < lanes<S>; ++i) r[i] = std::erf(x[i]);
    return r;
  }
}
#if MOTIONLANG_VECTOR_BYTES == 64
/// 32 numbers: lane i of the result is that which the lowest five bits of index[i] say.
MOTIONLANG_INLINE Vec<float> look_up(const float* table, const Vec<float>& index) {
  Vec<float> r = load(table);
  asm("vpermt2ps %2, %1, %0" : "+v"(r) : "v"(index), "v"(load(table + 16)));
  return r;
}
/// By gelu_table.hpp: absolute error below 1e-7 for x < 0, relative error below 5e-7 for x > 0.
MOTIONLANG_INLINE Vec<float> gelu_by_table(const Vec<float>& x) {
  static_assert(GeluTable::cells == 32 && GeluTable::width == 0.25);
  constexpr auto last = static_cast<float>(GeluTable::width * (GeluTable::cells - 1));
  Vec<float> c, d;
  asm("vrangeps $0xa, %2, %1, %0" : "=v"(c) : "v"(x), "v"(splat(last)));  // min(|x|, last)
  asm("vreduceps $0x24, %1, %0" : "=v"(d) : "v"(c));                      // c - i / 4, i = round(4 c)
  const Vec<float> i = c + 3145728.f;                                     // 1.5 * 2^21: i in the lowest bits
  const auto& table = gelu_table.by_power;
  Vec<float> g = look_up(table[GeluTable::degree], i);
#pragma GCC unroll 8
  for (int n = GeluTable::degree; n-- > 0;) g = g * d + look_up(table[n], i);
  return vmax<float>(Vec<float>{}, x) - g;
}
#endif
/// gelu(x) = x Phi(x) = x/2 + x (Phi(x) - 1/2). The last term is even in x, so that nothing need be bounded before it
/// is known. Float: by look_up where there is one; error below 3e-7 |x|. Of -inf: NaN or about 0.
template <class S>
MOTIONLANG_INLINE Vec<S> vgelu(const Vec<S>& x) {
#if MOTIONLANG_VECTOR_BYTES == 64
  if constexpr (sizeof(S) == 4) return gelu_by_table(x);
#endif
  const Vec<S> h = x * S(0.5);
  if constexpr (sizeof(S) == 4) {
    const Vec<S> y = x * x;
    return h + (y < splat(S(32)) ? y * phi_ratio<S>(y) : (Vec<S>)((Mask<S>)h & 0x7fffffff));
  } else {
    return h + h * verf<S>(x * S(0.70710678118654752));
  }
}

/// Square root of x >= 0: Newton's iteration for 1/sqrt(x) from an estimate by shifting the exponent; within 1 ulp.
template <class S>
MOTIONLANG_INLINE Vec<S> vsqrt(const Vec<S>& x) {
  constexpr bool single = sizeof(S) == 4;
  using Bits = typename VectorOf<S>::bits;
  Vec<S> y = (Vec<S>)(static_cast<Bits>(single ? 0x5F375A86 : 0x5FE6EB50C7B537A9) - ((Mask<S>)x >> 1));
  for (int i = 0; i < (single ? 3 : 5); ++i) y = y * (S(1.5) - x * S(0.5) * y * y);
  const Vec<S> r = x * y;
  return r + S(0.5) * y * (x - r * r);
}

/// Float: relative error below 3e-7; a polynomial near 0 (Cephes, Moshier 1992), 1 - 2 / (exp(2 |x|) + 1) elsewhere.
/// Double: libm.
template <class S>
MOTIONLANG_INLINE Vec<S> vtanh(const Vec<S>& x) {
  if constexpr (sizeof(S) == 4) {
    const Vec<S> y = x * x;
    Vec<S> p = y * S(-5.70498872745e-3) + S(2.06390887954e-2);
    for (double k : {-5.37397155531e-2, 1.33314422036e-1, -3.33332819422e-1}) p = p * y + S(k);
    const Vec<S> size = (Vec<S>)((Mask<S>)x & 0x7fffffff), far = S(1) - S(2) / (vexp<S>(size + size) + S(1));
    const Vec<S> positive = size < splat(S(0.625)) ? size + size * y * p : far;
    return (Vec<S>)((Mask<S>)positive | ((Mask<S>)x & ~0x7fffffff));
  } else {
    Vec<S> r{};
    for (int i = 0; i < lanes<S>; ++i) r[i] = std::tanh(x[i]);
    return r;
  }
}
//
// Nonlinearities and their derivatives. Which one it is, is asked once for many numbers: constants stay in registers.

template <Activation act, class S>
MOTIONLANG_INLINE Vec<S> apply_activation(const Vec<S>& x) {
  switch (act) {
    case Activation::none:
      return x;
    case Activation::relu:
      return vmax<S>(Vec<S>{}, x);
    case Activation::gelu:
      return vgelu<S>(x);
    case Activation::silu:
      return x / (vexp<S>(-x) + S(1));
    case Activation::tanh:
      return vtanh<S>(x);
    case Activation::quick_gelu:
      return x / (vexp<S>(x * S(-1.702)) + S(1));
    case Activation::gelu_new: {
      const Vec<S> h = x * S(0.5);
      return h * vtanh<S>((x + x * x * x * S(0.044715)) * S(0.79788456080286536)) + h;
    }
    case Activation::sigmoid:
      return S(1) / (vexp<S>(-x) + S(1));
  }
  return x;
}

/// Derivative at x.
///     gelu'(x) = Phi(x) + x phi(x),   silu'(x) = s + x s (1 - s),   sigmoid'(x) = s (1 - s) with s = 1 / (1 + exp(-x))
template <Activation act, class S>
MOTIONLANG_INLINE Vec<S> activation_slope(const Vec<S>& x) {
  switch (act) {
    case Activation::none:
      return splat(S(1));
    case Activation::relu:
      return x > Vec<S>{} ? splat(S(1)) : Vec<S>{};
    case Activation::gelu: {
      const Vec<S> phi = vexp<S>(x * x * S(-0.5)) * S(0.39894228040143268);
      return verf<S>(x * S(0.70710678118654752)) * S(0.5) + S(0.5) + x * phi;
    }
    case Activation::silu: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x);
      return s + x * s * (S(1) - s);
    }
    case Activation::tanh: {
      const Vec<S> t = vtanh<S>(x);
      return S(1) - t * t;
    }
    case Activation::quick_gelu: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x * S(1.702));
      return s + x * s * (S(1) - s) * S(1.702);
    }
    case Activation::gelu_new: {
      const Vec<S> t = vtanh<S>((x + x * x * x * S(0.044715)) * S(0.79788456080286536));
      return (t + S(1)) * S(0.5) + x * (S(1) - t * t) * (x * x * S(3 * 0.044715) + S(1)) * S(0.5 * 0.79788456080286536);
    }
    case Activation::sigmoid: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x);
      return s * (S(1) - s);
    }
  }
  return splat(S(1));
}

/// f.operator()<act>().
template <class F>
void with_activation(Activation act, const F& f) {
  switch (act) {
    case Activation::none:
      return f.template operator()<Activation::none>();
    case Activation::relu:
      return f.template operator()<Activation::relu>();
    case Activation::gelu:
      return f.template operator()<Activation::gelu>();
    case Activation::silu:
      return f.template operator()<Activation::silu>();
    case Activation::tanh:
      return f.template operator()<Activation::tanh>();
    case Activation::quick_gelu:
      return f.template operator()<Activation::quick_gelu>();
    case Activation::gelu_new:
      return f.template operator()<Activation::gelu_new>();
    case Activation::sigmoid:
      return f.template operator()<Activation::sigmoid>();
  }
}

/// y = act(x) for so many rows of `width` numbers, which begin ldx and ldy apart; y may be x.
template <class S>
void activate_rows(const S* x, Index ldx, Index rows, Index width, Activation act, S* y, Index ldy) {
  constexpr int l = lanes<S>;
  with_activation(act, [=]<Activation a>() {
    for (Index r = 0; r < rows; ++r) {
      const S* from = x + r * ldx;
      S* to = y + r * ldy;
      Index i = 0;
      for (; i + l <= width; i += l) store(to + i, apply_activation<a, S>(load(from + i)));
      if (i < width) store_some(to + i, apply_activation<a, S>(load_some(from + i, width - i)), width - i);
    }
  });
}
template <class S>
void activate(const S* x, Index n, Activation act, S* y) {
  activate_rows(x, n, 1, n, act, y, n);
}
/// dx = dy act'(x) for n numbers.
template <class S>
void activate_vjp(const S* x, const S* dy, Index n, Activation act, S* dx) {
  constexpr int l = lanes<S>;
  with_activation(act, [=]<Activation a>() {
    Index i = 0;
    for (; i + l <= n; i += l) store(dx + i, load(dy + i) * activation_slope<a, S>(load(x + i)));
    if (i < n) store_some(dx + i, load_some(dy + i, n - i) * activation_slope<a, S>(load_some(x + i, n - i)), n - i);
  });
}
//
// Matrix product with packed right-hand side: register tiles, cache blocks, epilogue in the tile.
//
//   Panels   B (k x n) is stored in panels of `panel_width` columns, k rows each: [panel][k][column], zero padded.
//   Tile     up to `tile_rows` rows of A times one panel, all sums in registers.
//   Block    up to 1024 of k at a time: rows of A stay in the second-level cache, beside one panel or a group of them.
//            If k is in several blocks, eight panels at a time: what the next 1024 of k are added to stays there as
//            well. (All panels at a time where A is copied first.)
//   Walk     a panel times all rows of the block, then the next panel. If the result is larger than the nearer caches
//            and k is one block: a tile's rows times a group of panels, then the next rows. So longer pieces of the
//            result's rows are written, one after the other: the lines under them, which come from memory first, the
//            processor fetches by itself, and fewer pages are in use.
//   Ahead    a tile asks for its part of C and of the residual before it begins, and with every k for a piece of what
//            follows: of the panels of the next group, be it of the product that follows, and, with the first group, of
//            the next rows of A.
//   Order    every element is summed over k in the same order, whatever the tile height, block or thread: same bits.

template <class S>
inline constexpr Index panel_width = 2 * lanes<S>;
inline constexpr Index tile_rows = MOTIONLANG_TILE_ROWS;
inline constexpr Index depth_block = 1024;
inline constexpr Index panel_block = 8;
inline constexpr Index most_tiles = 16;        // of rows in a block
inline constexpr Index near_caches = 4 << 20;  // bytes
// for rows of A, and as much for a group of panels
inline constexpr Index half_cache = 512 * 1024 * MOTIONLANG_VECTOR_BYTES / 64;
template <class S>
// of a tile of a transposed A, copied
inline constexpr Index tile_pitch = (tile_rows + lanes<S> - 1) / lanes<S>* lanes<S>;

template <class S>
constexpr Index bytes(Index count) {
  return count * static_cast<Index>(sizeof(S));
}
template <class S>
const std::byte* as_bytes(const S* x) {
  return reinterpret_cast<const std::byte*>(x);
}

/// Rows of A, `row_bytes` each, in a block of so many bytes: at most most_tiles tiles.
constexpr Index rows_at_once(Index row_bytes, Index tile, Index bytes) {
  return std::clamp<Index>(bytes / std::max<Index>(1, row_bytes) / tile, 1, most_tiles) * tile;
}

/// Rows k0 ... k1-1 of all panels of B, whose element (k, n) is b[k * stride + n].
template <class S>
void pack_rows(const S* b, Index k, Index n, Index stride, Index k0, Index k1, S* panels) {
  constexpr Index w = panel_width<S>, l = lanes<S>;
  constexpr Index ahead = 8;  // rows
  for (Index i = k0; i < k1; ++i) {
    const S* in = b + i * stride;
    S* out = panels + i * w;
    for (Index columns = n; columns > 0; columns -= w, in += w, out += k * w) {
      __builtin_prefetch(in + ahead * stride), __builtin_prefetch(in + ahead * stride + l);
      store(out, load_first(in, columns)), store(out + l, load_first(in + l, columns - l));
    }
  }
}
/// Panels first ... last-1 of B, whose element (k, n) is b[k + n * stride]: read along its rows, a square of lanes at a
/// time. Whether all numbers are finite, if it looks.
template <class S, bool looks>
bool pack_transposed(const S* b, Index k, Index n, Index stride, Index first, Index last, S* panels) {
  constexpr Index w = panel_width<S>, l = lanes<S>;
  Mask<S> found{};
  for (Index j = first; j < last; ++j) {
    S* out = panels + j * k * w;
    const Index columns = n - j * w;
    const S* in = b + j * w * stride;
    for (Index i = 0; i < k; i += l) {
      const Index rows = k - i < l ? k - i : l;
      for (Index c = 0; c < w; c += l) {
        Vec<S> square[lanes<S>];
#pragma GCC unroll 16
        for (int q = 0; q < lanes<S>; ++q) {
          const S* from = in + (c + q) * stride + i;
          square[q] = load_first(from, c + q < columns ? rows : 0);
          if constexpr (looks) find_not_finite<S>(square[q], found);
        }
        transpose_lanes<S>(square);
        for (Index r = 0; r < rows; ++r) store(out + (i + r) * w + c, square[r]);
      }
    }
  }
  return !any_negative<S>(found);
}

/// Rows of A, whose element (i, k) is at[i * stride + k], or, when transposed, at[i + k * stride].
template <class S>
struct Rows {
  const S* at;
  Index stride;
  bool transposed;

  Rows from(Index row) const { return {at + row * (transposed ? 1 : stride), stride, transposed}; }
  Rows from_depth(Index k) const { return {at + k * (transposed ? stride : 1), stride, transposed}; }
};

/// What is read after a tile: it is fetched into the second-level cache meanwhile, `step` bytes, a line at most, for
/// every row of the panel (bfloat16: pair of rows). What is more than that is left. So where a row is two lines long, a
/// tile alone fetches the first half of the next panel only: every other line of the whole would confuse the processor,
/// which fetches by itself lines that follow each other (20 % slower from memory).
struct Ahead {
  const std::byte* at = nullptr;
  Index step = 0;

  /// Share i of n of `bytes` that begin at `next`, in so many steps: shares rather overlap than leave bytes between
  /// them.
  MOTIONLANG_INLINE static Ahead share(const std::byte* next, Index bytes, Index i, Index n, Index steps) {
    const Index all = std::max<Index>(1, n * steps), step = std::min<Index>(64, (bytes + all - 1) / all);
    return {next + i * step * steps, step};
  }
  MOTIONLANG_INLINE void fetch() { __builtin_prefetch(at, 0, 2), at += step; }
};

/// What to do with a finished tile: add what is there already (k is split), bias, residual; then the nonlinearity.
template <class S>
struct Epilogue {
  bool accumulate = false;
  const S* bias = nullptr;      // of the panel's first column
  const S* residual = nullptr;  // of the tile's first element
  Index residual_stride = 0;
  Activation act = Activation::none;

  /// Of the tile that begins at a row and column of a product; `first` and `last`: of the blocks of k.
  static Epilogue of(const Gemm<S>& g, Index row, Index column, bool first, bool last) {
    Epilogue e{.accumulate = !first};
    if (!last) return e;
    e.act = g.act;
    if (g.bias != nullptr) e.bias = g.bias + column;
    if (g.residual != nullptr) e.residual = g.residual + row * g.ldr + column, e.residual_stride = g.ldr;
    return e;
  }
  Epilogue from_column(Index column) const {
    Epilogue e = *this;
    if (bias != nullptr) e.bias += column;
    if (residual != nullptr) e.residual += column;
    return e;
  }
  Epilogue from_row(Index row) const {
    Epilogue e = *this;
    if (residual != nullptr) e.residual += row * residual_stride;
    return e;
  }
};

/// Asks for the rows of c and of the residual that a tile is put into.
template <class S, int R>
MOTIONLANG_INLINE void fetch_result(const S* c, Index ldc, const Epilogue<S>& e) {
  constexpr int l = lanes<S>;
  for (int i = 0; i < R; ++i) __builtin_prefetch(c + i * ldc, 1), __builtin_prefetch(c + i * ldc + l, 1);
  if (e.residual == nullptr) return;
  for (int i = 0; i < R; ++i) {
    const S* row = e.residual + i * e.residual_stride;
    __builtin_prefetch(row), __builtin_prefetch(row + l);
  }
}

/// put_result for the last columns of a matrix, when they do not fill a panel: two vectors of sums for every row.
template <class S>
[[gnu::noinline]] void put_narrow_result(const Vec<S>* sums, int rows, S* c, Index ldc, Index columns,
                                         const Epilogue<S>& e) {
  constexpr Index l = lanes<S>;
  for (Index r = 0; r < rows; ++r) {
    for (Index i = 0; i < columns; i += l) {
      const Index n = columns - i;
      S* out = c + r * ldc + i;
      Vec<S> x = sums[2 * r + i / l];
      if (e.accumulate) x += load_first(out, n);
      if (e.bias != nullptr) x += load_first(e.bias + i, n);
      if (e.residual != nullptr) x += load_first(e.residual + r * e.residual_stride + i, n);
      store_first(out, x, n);
    }
  }
}

/// c (R x columns) = the sums of a tile, c0 and c1 being its two vectors of columns.
template <class S, int R>
MOTIONLANG_INLINE void put_result(Vec<S>* c0, Vec<S>* c1, S* c, Index ldc, Index columns, const Epilogue<S>& e) {
  constexpr int l = lanes<S>;
  if (columns >= 2 * l) {
    const Vec<S> z0 = e.bias == nullptr ? Vec<S>{} : load(e.bias), z1 = e.bias == nullptr ? Vec<S>{} : load(e.bias + l);
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      S* out = c + i * ldc;
      if (e.accumulate) c0[i] += load(out), c1[i] += load(out + l);
      c0[i] += z0, c1[i] += z1;
      if (e.residual != nullptr)
        c0[i] += load(e.residual + i * e.residual_stride), c1[i] += load(e.residual + i * e.residual_stride + l);
      store(out, c0[i]), store(out + l, c1[i]);
    }
  } else {
    Vec<S> sums[static_cast<std::size_t>(2 * R)];
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) sums[2 * i] = c0[i], sums[2 * i + 1] = c1[i];
    put_narrow_result(sums, R, c, ldc, columns, e);
  }
  if (e.act != Activation::none) activate_rows<S>(c, ldc, R, std::min(columns, 2 * Index{l}), e.act, c, ldc);
}

/// What kind of tile: of A as it lies, of a transposed A, or of A as it lies times the first half of a panel only.
enum class TileKind { plain, transposed, half };

/// c (R x columns) = a (R x k) panel.
template <class S, int R, TileKind kind>
void tile(const Rows<S>& a, const S* panel, Index k, S* c, Index ldc, Index columns, const Epilogue<S>& e,
          Ahead ahead) {
  constexpr Index w = panel_width<S>;
  constexpr int l = lanes<S>;
  constexpr bool transposed = kind == TileKind::transposed, half = kind == TileKind::half;
  Vec<S> c0[R], c1[R];
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<S>{};
  fetch_result<S, R>(c, ldc, e);
  // Rows in groups of three behind five pointers: one address register each, the rest is addressing mode. One of the
  // strides is known to be 1, which saves additions (1 to 4 % of the time).
  const Index row_stride = transposed ? 1 : a.stride, depth_stride = transposed ? a.stride : 1;
  const S *p0 = a.at, *p1 = p0 + 3 * row_stride, *p2 = p0 + 6 * row_stride, *p3 = p0 + 9 * row_stride,
          *p4 = p0 + 12 * row_stride;
#pragma GCC unroll 2
  for (Index at = 0; at < k; ++at) {
    if constexpr (transposed) __builtin_prefetch(p0 + 16 * depth_stride);
    const Vec<S> b0 = load(panel), b1 = half ? Vec<S>{} : load(panel + l);
    panel += w;
    __builtin_prefetch(panel + 16 * w);
    __builtin_prefetch(panel + 16 * w + l);
    ahead.fetch();
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      const S x = i < 3    ? p0[i * row_stride]
                  : i < 6  ? p1[(i - 3) * row_stride]
                  : i < 9  ? p2[(i - 6) * row_stride]
                  : i < 12 ? p3[(i - 9) * row_stride]
                           : p4[(i - 12) * row_stride];
      c0[i] += x * b0;
      if constexpr (!half) c1[i] += x * b1;
    }
    p0 += depth_stride, p1 += depth_stride, p2 += depth_stride, p3 += depth_stride, p4 += depth_stride;
  }
  put_result<S, R>(c0, c1, c, ldc, columns, e);
}

template <class S>
using TileFunction = void (*)(const Rows<S>&, const S*, Index, S*, Index, Index, const Epilogue<S>&, Ahead);
/// The tile of so many rows for what is left of the columns.
template <class S>
TileFunction<S> tile_of(Index rows, bool transposed, Index columns) {
  static constexpr auto table = []<int... R>(std::integer_sequence<int, R...>) {
    return std::array{std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::plain>...},
                      std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::transposed>...},
                      std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::half>...}};
  }
  (std::make_integer_sequence<int, MOTIONLANG_TILE_ROWS>{});
  const TileKind kind = transposed ? TileKind::transposed : columns <= lanes<S> ? TileKind::half : TileKind::plain;
  return table[static_cast<std::size_t>(kind)][static_cast<std::size_t>(rows - 1)];
}

/// First row of part i of n nearly equal parts.
MOTIONLANG_INLINE Index part(Index rows, Index i, Index n) { return rows * i / n; }

/// How a product over k is split: pieces of k, and rows of A at a time.
template <class S>
struct Blocks {
  Index count, rows;

  explicit Blocks(Index k)
      : count(k == 0 ? 1 : (k + depth_block - 1) / depth_block),
        rows(rows_at_once(bytes<S>((k + count - 1) / count), tile_rows, half_cache)) {}
};
template <class S>
Index gemm_rows(Index k) {
  return Blocks<S>(k).rows;
}
/// Numbers of scratch that gemm_block needs.
template <class S>
Index gemm_scratch(Index k) {
  return Blocks<S>(k).rows / tile_rows * tile_pitch<S> * (std::min(k, depth_block) + 16);
}

/// `rows` rows of a transposed A (`depth` of k) tile by tile, [tile][k][row], so that a tile reads one line after the
/// other. `readable`: rows that A has from here on.
template <class S>
void copy_tiles(const S* a, Index lda, Index depth, Index rows, Index readable, S* out) {
  constexpr Index pitch = tile_pitch<S>, l = lanes<S>;
  const Index tiles = (rows + tile_rows - 1) / tile_rows;
  for (Index k = 0; k < depth; ++k, a += lda, out += pitch) {
    if (k + 16 < depth) fetch(a + 16 * lda, rows);  // no prefetcher follows pieces so far apart
    for (Index t = 0; t < tiles; ++t) {
      const Index first = part(rows, t, tiles);
      for (Index i = 0; i < pitch; i += l)
        store(out + t * depth * pitch + i, load_first(a + first + i, readable - first - i));
    }
  }
}

/// What is made at a time: of k the part k0 ... k1-1 of rows top ... below-1 times panels left ... right-1.
template <class S>
struct GemmPiece {
  static constexpr Index w = panel_width<S>;
  const Gemm<S>& g;
  S* scratch;
  bool copies, far;                   // rows of A are copied as they are; the result is larger than the nearer caches
  Index top = 0, below = 0, end = 0;  // end: of the rows that the thread goes on with
  Index left = 0, right = 0;
  Index k0 = 0, k1 = 0;
  // panels that are read after it: at last the first ones once more, if nothing else is known
  const std::byte* next = nullptr;
  Index next_bytes = std::numeric_limits<Index>::max();

  Index depth() const { return k1 - k0; }
  Index pitch() const { return depth() + 16; }
  const S* slice(Index panel) const { return g.panels + (panel * g.k + k0) * w; }

  Rows<S> rows_of(Index tile, Index row) const {
    if (g.a_transposed) return {scratch + tile * depth() * tile_pitch<S>, tile_pitch<S>, true};
    if (copies) return {scratch + (row - top) * pitch(), pitch(), false};
    return {g.a + row * g.lda + k0, g.lda, false};
  }
  void copy_rows(Index first, Index last) const {
    for (Index r = first; r < last; ++r) {
      std::memcpy(scratch + (r - top) * pitch(), g.a + r * g.lda + k0, static_cast<std::size_t>(bytes<S>(depth())));
    }
  }

  void multiply() const {
    const Index depth = this->depth(), tiles = (below - top + tile_rows - 1) / tile_rows;
    const bool whole = depth == g.k, transposed = g.a_transposed;
    const Index together = far && whole ? std::max<Index>(1, half_cache / std::max<Index>(1, bytes<S>(depth * w))) : 1;
    const Index groups = (right - left + together - 1) / together;
    // Rows that are copied: all at once if the result stays in the caches (3 % faster at 408 x 1024 x 512), else a
    // tile's when it is next.
    if (transposed)
      copy_tiles<S>(g.a + k0 * g.lda + top, g.lda, depth, below - top, g.m - top, scratch);
    else if (copies && !far)
      copy_rows(top, below);
    for (Index group = 0; group < groups; ++group) {
      const Index j0 = left + part(right - left, group, groups), j1 = left + part(right - left, group + 1, groups);
      const Index panels = j1 - j0, panel_bytes = bytes<S>(panels * depth * w);
      const std::byte* next_panels = j1 < right ? as_bytes(slice(j1)) : next;
      const Index next_panel_bytes = j1 < right ? panel_bytes : std::min(panel_bytes, next_bytes);
      for (Index t = 0, row = top, height; t < tiles; ++t, row += height) {
        height = top + part(below - top, t + 1, tiles) - row;
        const Index next_row = row + height;
        if (copies && far && group == 0) copy_rows(row, next_row);
        // With half of the first panels the next rows are fetched, if they lie together. (With one panel at a time:
        // none.)
        const bool fetches_rows = group == 0 && !transposed && g.lda <= g.k && next_row < end;
        const Index row_panels = fetches_rows ? panels / 2 : 0, rest = panels - row_panels;
        const Index next_row_bytes = bytes<S>(std::min(height, end - next_row) * g.lda);
        for (Index i = 0; i < panels; ++i) {
          const Index j = j0 + i, columns = g.n - j * w;
          const Ahead ahead =
              i < row_panels
                  ? Ahead::share(as_bytes(g.a + next_row * g.lda), next_row_bytes, i, row_panels, depth)
                  : Ahead::share(next_panels, next_panel_bytes, t * rest + i - row_panels, tiles * rest, depth);
          S* c = g.c + row * g.ldc + j * w;
          const auto e = Epilogue<S>::of(g, row, j * w, k0 == 0, k1 == g.k);
          tile_of<S>(height, transposed, columns)(rows_of(t, row), slice(j), depth, c, g.ldc, columns, e, ahead);
        }
      }
    }
  }
};

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product.
template <class S>
void gemm_block(const Gemm<S>& g, Index r0, Index r1, Index j0, Index j1, S* scratch) {
  const Blocks<S> split(g.k);
  const Index blocks = split.count, row_blocks = (r1 - r0 + split.rows - 1) / split.rows;
  // Rows of A whose distance is a multiple of the page size fall into the same cache set: they are copied side by side,
  // once.
  const bool copies = !g.a_transposed && bytes<S>(g.lda) % 4096 == 0;
  const bool all_panels = copies || g.a_transposed || blocks == 1;
  const Index wide = all_panels ? std::max<Index>(1, j1 - j0) : panel_block, pieces = (j1 - j0 + wide - 1) / wide;
  const bool far = bytes<S>(g.m * g.n) > near_caches;
  for (Index i = 0; i < row_blocks * pieces * blocks; ++i) {
    const Index row_block = i / blocks / pieces, left = j0 + i / blocks % pieces * wide, block = i % blocks;
    GemmPiece<S> piece{.g = g,
                       .scratch = scratch,
                       .copies = copies,
                       .far = far,
                       .top = r0 + part(r1 - r0, row_block, row_blocks),
                       .below = r0 + part(r1 - r0, row_block + 1, row_blocks),
                       .end = r1,
                       .left = left,
                       .right = std::min(j1, left + wide),
                       .k0 = part(g.k, block, blocks),
                       .k1 = part(g.k, block + 1, blocks)};
    const bool next_columns = block + 1 == blocks, next_rows = next_columns && piece.right == j1,
               last = next_rows && piece.below == r1;
    const S* next = g.panels + ((next_rows      ? j0
                                 : next_columns ? piece.right
                                                : left) *
                                    g.k +
                                (next_columns ? 0 : piece.k1)) *
                                   piece.w;
    piece.next = last ? g.following(j0, (g.n + piece.w - 1) / piece.w, next) : as_bytes(next);
    if (last && g.after != nullptr) piece.next_bytes = g.after_bytes;
    piece.multiply();
  }
}
//
// Attention of one head over one sequence, forward and backward. The score matrix exists for one tile of rows (forward)
// or one head (backward), never for a batch.
//
//   S = Q K^T / sqrt(width),   P = softmax(S),   O = P V
//   dV = P^T dO,   dP = dO V^T,   dS = P (dP - rowsum(P dP)),   dQ = dS K / sqrt(width),   dK = dS^T Q / sqrt(width)

/// Softmax of R rows of `n` scores times `scale`, in place; columns up to the next vector are set to 0.
/// `visible[i]` columns of row i take part (causal attention), the rest are 0. Several rows are as many chains of sums:
/// none waits.
template <class S, int R>
MOTIONLANG_INLINE void softmax_rows_at(S* rows, Index pitch, Index n, const Index* visible, S scale) {
  constexpr int l = lanes<S>;
  const Index padded = (n + l - 1) / l * l;
  constexpr S hidden = sizeof(S) == 4 ? S(-1e30) : S(-1e300);
  Vec<S> largest[R], sum[R], inverse[R];
  S shift[R];
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) {
    for (Index c = visible[i]; c < padded; ++c) rows[i * pitch + c] = hidden;
    largest[i] = splat(hidden), sum[i] = Vec<S>{};
  }
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) largest[i] = vmax<S>(largest[i], load(rows + i * pitch + c));
  }
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) shift[i] = reduce_max<S>(largest[i]) * scale;
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      const Vec<S> e = vexp<S>(load(rows + i * pitch + c) * scale - shift[i]);
      store(rows + i * pitch + c, e);
      sum[i] += e;
    }
  }
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) inverse[i] = splat(S(1) / reduce_add<S>(sum[i]));
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) store(rows + i * pitch + c, load(rows + i * pitch + c) * inverse[i]);
  }
}
inline constexpr int softmax_group = 4;  // of rows
/// The same for `count` rows, the first of which is query `first`; causal: row i sees keys up to its own number.
template <class S>
void softmax_rows_of(S* rows, Index pitch, Index count, Index n, Index first, bool causal, S scale) {
  for (Index r = 0; r < count;) {
    Index visible[softmax_group];
    for (int i = 0; i < softmax_group; ++i) visible[i] = causal ? std::min(n, first + r + i + 1) : n;
    if (r + softmax_group <= count)
      softmax_rows_at<S, softmax_group>(rows + r * pitch, pitch, n, visible, scale), r += softmax_group;
    else
      softmax_rows_at<S, 1>(rows + r * pitch, pitch, n, visible, scale), ++r;
  }
}

/// y = x times the factors of Dropout (core/dropout.hpp) at positions first, first + 1, ...; its own derivative.
template <class S>
void dropout(const S* x, Index n, Index first, const Dropout& d, S* y) {
  typedef std::uint32_t Bits __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
  constexpr Index l = MOTIONLANG_VECTOR_BYTES / 4;
  const std::uint32_t limit = d.limit();
  const auto key0 = static_cast<std::uint32_t>(d.key) + static_cast<std::uint32_t>(first >> 32) * 0x27D4EB2Fu;
  const auto key1 = static_cast<std::uint32_t>(d.key >> 32);
  const S keep = static_cast<S>(1.0 / (1.0 - d.p));
  Bits counter;
  for (Index i = 0; i < l; ++i) counter[i] = static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(i);
  for (Index i = 0; i < n; i += l, counter += static_cast<std::uint32_t>(l)) {
    Bits h = counter * 0x9E3779B1u + key0;
    h = (h ^ (h >> 16)) * 0x85EBCA6Bu + key1;
    h = (h ^ (h >> 13)) * 0xC2B2AE35u;
    h = h ^ (h >> 16);
    if (sizeof(S) == 4 && i + l <= n) {
      const Vec<S> kept = load(x + i) * keep;
      store(y + i, (Mask<S>)(h >= limit) ? kept : Vec<S>{});
    } else {
      for (Index c = 0; c < l && i + c < n; ++c) y[i + c] = h[c] >= limit ? x[i + c] * keep : S(0);
    }
  }
}

template <class S>
MOTIONLANG_INLINE Index padded_panels(Index n) {
  return (n + panel_width<S> - 1) / panel_width<S>;
}

/// The products of attention in S. (Bf16Products is the other kind.)
template <class S>
struct FloatProducts {
  using Number = S;
  static constexpr Index rows = tile_rows;  // that products are fastest with
  static void begin() {}
  static void end() {}
  /// Columns that products write of n.
  static Index columns(Index n) { return padded_panels<S>(n) * panel_width<S>; }
  /// Numbers of scratch: panels of a matrix (k, n), and what a product over k needs.
  static Index panels(Index k, Index n) { return columns(n) * k; }
  static Index scratch(Index) { return 0; }

  static void pack(const S* b, Index k, Index n, Index stride_k, Index stride_n, S* panels) {
    if (stride_n == 1)
      pack_rows(b, k, n, stride_k, Index{0}, k, panels);
    else
      pack_transposed<S, false>(b, k, n, stride_n, Index{0}, padded_panels<S>(n), panels);
  }
  /// c = a panels, tile by tile, without blocks of k (all operands are in cache).
  static void multiply(const Rows<S>& a, Index count, Index k, const S* panels, Index n, S* c, Index ldc, S*,
                       bool whole_panels) {
    constexpr Index w = panel_width<S>;
    const Index tiles = (count + tile_rows - 1) / tile_rows;
    const Epilogue<S> plain;
    for (Index j = 0; j < padded_panels<S>(n); ++j) {
      for (Index t = 0; t < tiles; ++t) {
        const Index first = part(count, t, tiles), height = part(count, t + 1, tiles) - first;
        tile_of<S>(height, a.transposed, n - j * w)(a.from(first), panels + j * k * w, k, c + first * ldc + j * w, ldc,
                                                    whole_panels ? w : n - j * w, plain, Ahead{as_bytes(panels)});
      }
    }
  }
};

/// One head over one sequence: where its rows begin. Rows of q, k, v have the strides of the tensors that they are
/// columns of.
template <class S>
struct AttentionHead {
  const Attention<S>& t;
  Index head, q0, k0, queries, keys;
  const S *q, *k, *v;

  AttentionHead(const Attention<S>& a, Index sequence, Index head_number)
      : t(a),
        head(head_number),
        q0(a.q_offsets[sequence]),
        k0(a.k_offsets[sequence]),
        queries(a.q_offsets[sequence + 1] - q0),
        keys(a.k_offsets[sequence + 1] - k0),
        q(a.q + q0 * a.q_stride + head * a.width),
        k(a.k + k0 * a.k_stride + head * a.width),
        v(a.v + k0 * a.v_stride + head * a.width) {}

  S scale() const { return S(1) / std::sqrt(static_cast<S>(t.width)); }
  /// Scores of `count` queries from `first` on, q k^T, become their rows of P: relative scores, softmax, dropout.
  void weights(Index first, Index count, S* rows, Index pitch) const {
    const S unscale = std::sqrt(static_cast<S>(t.width));
    for (Index r = 0; r < count && t.relative_scores != nullptr; ++r) {
      const S* relative = t.relative_scores + head * (2 * t.reach + 1) + t.reach - (first + r);
      for (Index c = 0; c < keys; ++c) rows[r * pitch + c] += relative[c] * unscale;
    }
    softmax_rows_of(rows, pitch, count, keys, first, t.causal, scale());
    for (Index r = 0; r < count && t.dropout.p > 0; ++r)
      dropout(rows + r * pitch, keys, mask_at(first + r), t.dropout, rows + r * pitch);
  }
  Index mask_at(Index query) const {
    return static_cast<Index>(Dropout::attention_position(q0 + query, t.heads, head, 0));
  }
};

/// Distance of rows of scores, whose columns up to the end of a panel are written.
template <class P>
Index score_pitch(Index keys) {
  return P::columns(keys) + 16;
}
/// Numbers of scratch that attention_head needs: K^T, V, and one tile of scores.
template <class P>
Index attention_scratch(Index keys, Index width) {
  return P::panels(width, keys) + P::panels(keys, width) + P::rows * score_pitch<P>(keys) +
         P::scratch(std::max(keys, width));
}
/// Numbers of scratch that attention_head_vjp needs, whose scores are those of all queries.
template <class P>
Index attention_vjp_scratch(Index queries, Index keys, Index width) {
  const Index longest = std::max(keys, queries);
  return P::panels(width, keys) + P::panels(longest, width) + 2 * queries * score_pitch<P>(keys) +
         P::scratch(std::max(longest, width));
}

/// Output of one head, for one of so many pieces of its queries.
template <class P, class S = typename P::Number>
void attention_head(const Attention<S>& t, Index sequence, Index head, Index piece, Index pieces, S* kt) {
  const AttentionHead<S> h(t, sequence, head);
  const Index tiles = (h.queries + P::rows - 1) / P::rows, begin = part(tiles, piece, pieces),
              end = part(tiles, piece + 1, pieces);
  if (begin == end) return;
  const Index pitch = score_pitch<P>(h.keys);
  S* vp = kt + P::panels(t.width, h.keys);
  S* scores = vp + P::panels(h.keys, t.width);
  S* scratch = scores + P::rows * pitch;
  S* o = t.o + h.q0 * t.o_stride + head * t.width;
  P::pack(h.k, t.width, h.keys, Index{1}, t.k_stride, kt);  // K^T
  P::pack(h.v, h.keys, t.width, t.v_stride, Index{1}, vp);
  P::begin();
  for (Index i = begin; i < end; ++i) {
    const Index first = part(h.queries, i, tiles), rows = part(h.queries, i + 1, tiles) - first;
    P::multiply({h.q + first * t.q_stride, t.q_stride, false}, rows, t.width, kt, h.keys, scores, pitch, scratch, true);
    h.weights(first, rows, scores, pitch);
    P::multiply({scores, pitch, false}, rows, h.keys, vp, t.width, o + first * t.o_stride, t.o_stride, scratch, false);
  }
  P::end();
}

/// Gradients of one head; dq, dk, dv are written, with the strides of q, k, v.
template <class P, class S = typename P::Number>
void attention_head_vjp(const Attention<S>& t, const AttentionGradients<S>& g, Index sequence, Index head, S* a) {
  constexpr int l = lanes<S>;
  const AttentionHead<S> h(t, sequence, head);
  const Index queries = h.queries, keys = h.keys, width = t.width, pitch = score_pitch<P>(keys);
  const S* d_o = g.d_o + h.q0 * t.o_stride + head * width;
  const S scale = h.scale();
  S* b = a + P::panels(width, keys);  // panels with the keys or queries as the summed index; a: K^T, then V^T
  S* p = b + P::panels(std::max(keys, queries), width);  // P, later P after dropout
  S* ds = p + queries * pitch;                           // dP, later dS
  S* scratch = ds + queries * pitch;
  P::begin();
  P::pack(h.k, width, keys, Index{1}, t.k_stride, a);
  P::multiply({h.q, t.q_stride, false}, queries, width, a, keys, p, pitch, scratch, true);
  P::pack(h.v, width, keys, Index{1}, t.v_stride, a);
  P::multiply({d_o, t.o_stride, false}, queries, width, a, keys, ds, pitch, scratch, true);
  for (Index r = 0; r < queries; ++r) {
    S *pr = p + r * pitch, *dr = ds + r * pitch;
    if (r % softmax_group == 0)
      softmax_rows_of(pr, pitch, std::min<Index>(softmax_group, queries - r), keys, r, t.causal, scale);
    if (t.dropout.p > 0) dropout(dr, keys, h.mask_at(r), t.dropout, dr);
    Vec<S> sum{};
    for (Index c = 0; c < keys; c += l) sum += load(pr + c) * load(dr + c);  // P is 0 beyond the keys
    const S mean = reduce_add<S>(sum);
    for (Index c = 0; c < keys; c += l) store(dr + c, load(pr + c) * (load(dr + c) - mean) * scale);
    if (t.dropout.p > 0) dropout(pr, keys, h.mask_at(r), t.dropout, pr);
  }
  S* dq = g.d_q + h.q0 * t.q_stride + head * width;
  S* dk = g.d_k + h.k0 * t.k_stride + head * width;
  S* dv = g.d_v + h.k0 * t.v_stride + head * width;
  P::pack(h.k, keys, width, t.k_stride, Index{1}, b);
  P::multiply({ds, pitch, false}, queries, keys, b, width, dq, t.q_stride, scratch, false);
  P::pack(h.q, queries, width, t.q_stride, Index{1}, b);
  P::multiply({ds, pitch, true}, keys, queries, b, width, dk, t.k_stride, scratch, false);
  P::pack(d_o, queries, width, t.o_stride, Index{1}, b);
  P::multiply({p, pitch, true}, keys, queries, b, width, dv, t.v_stride, scratch, false);
  P::end();
}
//
// Row-wise and element-wise kernels: layer norm, softmax, nonlinearities, sums, AdamW.

inline constexpr int norm_group = 4;  // rows at a time in layer norm
/// Means and 1 / sqrt(variance + eps) of R rows of n, side by side. Two passes: no cancellation. Several rows are as
/// many chains of sums: none waits.
template <class S, int R>
MOTIONLANG_INLINE void row_moments(const S* x, Index n, S eps, S* mean, S* rstd) {
  constexpr int l = lanes<S>;
  const Index whole = n / l * l;
  Vec<S> sum[R], square[R];
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) sum[r] = square[r] = Vec<S>{};
  for (Index i = 0; i < whole; i += l) {
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) sum[r] += load(x + r * n + i);
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    S total = reduce_add<S>(sum[r]);
    for (Index i = whole; i < n; ++i) total += x[r * n + i];
    mean[r] = total / static_cast<S>(n);
  }
  for (Index i = 0; i < whole; i += l) {
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> d = load(x + r * n + i) - mean[r];
      square[r] += d * d;
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    S variance = reduce_add<S>(square[r]);
    for (Index i = whole; i < n; ++i) variance += (x[r * n + i] - mean[r]) * (x[r * n + i] - mean[r]);
    rstd[r] = S(1) / std::sqrt(variance / static_cast<S>(n) + eps);
  }
}

/// layer_norm_rows of R rows.
template <class S, int R>
MOTIONLANG_INLINE void normalize_rows(const LayerNorm<S>& t, Index first) {
  constexpr int l = lanes<S>;
  const Index n = t.width, whole = n / l * l;
  const S* x = t.x + first * n;
  S* y = t.y + first * n;
  if (t.residual != nullptr) {
    const S* z = t.residual + first * n;
    for (Index i = 0; i < R * n; i += l)
      store_first(y + i, load_first(x + i, R * n - i) + load_first(z + i, R * n - i), R * n - i);
    x = y;
  }
  S mean[R], rstd[R];
  row_moments<S, R>(x, n, t.eps, mean, rstd);
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i), bias = load(t.bias + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      __builtin_prefetch(x + (R + r) * n + i);  // of the next rows
      store(y + r * n + i, (load(x + r * n + i) - mean[r]) * rstd[r] * weight + bias);
    }
  }
  for (Index i = whole; i < n; ++i) {
    for (int r = 0; r < R; ++r) y[r * n + i] = (x[r * n + i] - mean[r]) * rstd[r] * t.weight[i] + t.bias[i];
  }
}
/// y = (x + residual - mean) rstd weight + bias. The sum stands in y before it is normalized; there may be no residual.
template <class S>
void layer_norm_rows(const LayerNorm<S>& t, Index first, Index last) {
  for (; first + norm_group <= last; first += norm_group) normalize_rows<S, norm_group>(t, first);
  for (; first < last; ++first) normalize_rows<S, 1>(t, first);
}

/// layer_norm_rows_vjp of R rows.
template <class S, int R>
MOTIONLANG_INLINE void normalize_rows_vjp(const LayerNorm<S>& t, const S* dy, S* dx, S* moments, Index first) {
  constexpr int l = lanes<S>;
  const Index n = t.width, whole = n / l * l;
  const S *x = t.x + first * n, *g = dy + first * n;
  S* d = dx + first * n;
  S mean[R], rstd[R], h0[R], h1[R];
  row_moments<S, R>(x, n, t.eps, mean, rstd);
  Vec<S> sum_h[R], sum_hx[R];
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) sum_h[r] = sum_hx[r] = Vec<S>{};
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> h = load(g + r * n + i) * weight;
      sum_h[r] += h;
      sum_hx[r] += h * ((load(x + r * n + i) - mean[r]) * rstd[r]);
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    h0[r] = reduce_add<S>(sum_h[r]), h1[r] = reduce_add<S>(sum_hx[r]);
    for (Index i = whole; i < n; ++i) {
      const S h = g[r * n + i] * t.weight[i];
      h0[r] += h;
      h1[r] += h * ((x[r * n + i] - mean[r]) * rstd[r]);
    }
    h0[r] /= static_cast<S>(n);
    h1[r] /= static_cast<S>(n);
  }
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> xhat = (load(x + r * n + i) - mean[r]) * rstd[r];
      store(d + r * n + i, (load(g + r * n + i) * weight - h0[r] - xhat * h1[r]) * rstd[r]);
    }
  }
  for (int r = 0; r < R; ++r) {
    for (Index i = whole; i < n; ++i) {
      d[r * n + i] = (g[r * n + i] * t.weight[i] - h0[r] - (x[r * n + i] - mean[r]) * rstd[r] * h1[r]) * rstd[r];
    }
    moments[2 * (first + r)] = mean[r], moments[2 * (first + r) + 1] = rstd[r];
  }
}
/// dx = rstd (h - mean(h) - xhat mean(h xhat)),  h = dy weight,  xhat = (x - mean) rstd
template <class S>
void layer_norm_rows_vjp(const LayerNorm<S>& t, const S* dy, S* dx, S* moments, Index first, Index last) {
  for (; first + norm_group <= last; first += norm_group) normalize_rows_vjp<S, norm_group>(t, dy, dx, moments, first);
  for (; first < last; ++first) normalize_rows_vjp<S, 1>(t, dy, dx, moments, first);
}
/// dweight = sum over rows of dy xhat, dbias = sum of dy; columns first ... last-1.
template <class S>
void layer_norm_columns_vjp(const LayerNorm<S>& t, const S* dy, const S* moments, S* dweight, S* dbias, Index rows,
                            Index first, Index last) {
  for (Index i = first; i < last; ++i) dweight[i] = dbias[i] = S(0);
  for (Index r = 0; r < rows; ++r) {
    const S mean = moments[2 * r], rstd = moments[2 * r + 1];
    const S *x = t.x + r * t.width, *g = dy + r * t.width;
    for (Index i = first; i < last; ++i) {
      dweight[i] += g[i] * ((x[i] - mean) * rstd);
      dbias[i] += g[i];
    }
  }
}

/// y = softmax(x) for rows of n; `scratch` holds one row, rounded up to whole vectors.
template <class S>
void softmax_rows(const S* x, Index n, Index first, Index last, S* y, S* scratch) {
  for (Index r = first; r < last; ++r) {
    std::memcpy(scratch, x + r * n, static_cast<std::size_t>(n) * sizeof(S));
    softmax_rows_at<S, 1>(scratch, n, n, &n, S(1));
    std::memcpy(y + r * n, scratch, static_cast<std::size_t>(n) * sizeof(S));
  }
}

/// Columns first ... last-1 of y; first is a multiple of `lanes`.
template <class S>
void transpose(const Transposed<S>& t, Index first, Index last) {
  constexpr Index l = lanes<S>;
  for (Index j = first; j < last; j += l) {
    const Index n = std::min(l, last - j);
    const bool whole = n == l;
    const Vec<S> bias = t.bias == nullptr ? Vec<S>{} : load_some(t.bias + j, n);
    for (Index r = 0; r < t.rows; ++r) {
      const S* z = t.z + j * t.rows + r;
      const S* residual = t.residual == nullptr ? nullptr : t.residual + r * t.width + j;
      S* y = t.y + r * t.width + j;
      Vec<S> x{};
      if (whole) {
#pragma GCC unroll 16
        for (int i = 0; i < lanes<S>; ++i) x[i] = z[i * t.rows];
        x += bias;
        if (residual != nullptr) x += load(residual);
        store(y, x);
      } else {
        for (Index i = 0; i < n; ++i) x[i] = z[i * t.rows];
        x += bias;
        if (residual != nullptr) x += load_some(residual, n);
        store_some(y, x, n);
      }
    }
    if (t.act != Activation::none) activate_rows(t.y + j, t.width, t.rows, n, t.act, t.y + j, t.width);
  }
}

template <BinaryOp op, class S>
MOTIONLANG_INLINE Vec<S> apply_binary(const Vec<S>& a, const Vec<S>& b) {
  switch (op) {
    case BinaryOp::add:
      return a + b;
    case BinaryOp::sub:
      return a - b;
    case BinaryOp::mul:
      return a * b;
    case BinaryOp::div:
      return a / b;
    case BinaryOp::maximum:
      return a < b ? b : a;
  }
  return a;
}
/// A repeated operand is read again and again from one vector of copies.
template <BinaryOp op, class S>
MOTIONLANG_INLINE void binary_loop(const Binary<S>& t) {
  constexpr int l = lanes<S>;
  const Vec<S> copies_a = splat(*t.a), copies_b = splat(*t.b);
  const S *a = t.a_repeated ? reinterpret_cast<const S*>(&copies_a) : t.a,
          *b = t.b_repeated ? reinterpret_cast<const S*>(&copies_b) : t.b;
  const Index step_a = t.a_repeated ? 0 : l, step_b = t.b_repeated ? 0 : l;
  Index i = 0;
  for (; i + l <= t.count; i += l, a += step_a, b += step_b) store(t.y + i, apply_binary<op, S>(load(a), load(b)));
  const Index n = t.count - i;
  store_some(t.y + i, apply_binary<op, S>(load_some(a, n), load_some(b, n)), n);
}
template <class S>
void binary(const Binary<S>& t) {
  switch (t.op) {
    case BinaryOp::add:
      return binary_loop<BinaryOp::add>(t);
    case BinaryOp::sub:
      return binary_loop<BinaryOp::sub>(t);
    case BinaryOp::mul:
      return binary_loop<BinaryOp::mul>(t);
    case BinaryOp::div:
      return binary_loop<BinaryOp::div>(t);
    case BinaryOp::maximum:
      return binary_loop<BinaryOp::maximum>(t);
  }
}

template <class S>
void error_function(const S* x, Index n, S* y) {
  constexpr int l = lanes<S>;
  Index i = 0;
  for (; i + l <= n; i += l) store(y + i, verf<S>(load(x + i)));
  store_some(y + i, verf<S>(load_some(x + i, n - i)), n - i);
}

/// Sums of the rows first ... last-1, of n numbers each. Four chains of sums: none waits.
template <class S>
void row_sums(const S* x, Index n, Index first, Index last, S* y) {
  constexpr int l = lanes<S>;
  for (Index r = first; r < last; ++r) {
    const S* row = x + r * n;
    Vec<S> sums[4] = {};
    Index i = 0;
    for (; i + 4 * l <= n; i += 4 * l) {
#pragma GCC unroll 4
      for (int c = 0; c < 4; ++c) sums[c] += load(row + i + c * l);
    }
    for (; i < n; i += l) sums[0] += load_first(row + i, n - i);
    y[r] = reduce_add<S>(sums[0] + sums[1] + (sums[2] + sums[3]));
  }
}
/// Sums of the columns first ... last-1 over all rows.
template <class S>
void column_sums(const S* x, Index rows, Index width, Index first, Index last, S* y) {
  for (Index i = first; i < last; ++i) y[i] = S(0);
  for (Index r = 0; r < rows; ++r) {
    for (Index i = first; i < last; ++i) y[i] += x[r * width + i];
  }
}

template <class S>
MOTIONLANG_INLINE Vec<S> adamw_update(const AdamwStep<S>& t, const Vec<S>& p, const Vec<S>& gradient, Vec<S>& m,
                                      Vec<S>& v) {
  const Vec<S> g = gradient * t.gradient_scale;
  m = m * t.beta1 + g * t.rest1;
  v = v * t.beta2 + g * g * t.rest2;
  return p * t.decay - t.step * m / (vsqrt<S>(v) * t.correction + t.eps);
}
/// AdamW in one pass over parameter, gradient and moments (see optim/adamw.hpp for the formula).
template <class S>
void adamw(const AdamwStep<S>& t, Index first, Index last) {
  constexpr int l = lanes<S>;
  Index i = first;
  for (; i + l <= last; i += l) {
    Vec<S> m = load(t.m + i), v = load(t.v + i);
    store(t.p + i, adamw_update<S>(t, load(t.p + i), load(t.g + i), m, v));
    store(t.m + i, m), store(t.v + i, v);
  }
  const Index n = last - i;
  Vec<S> m = load_some(t.m + i, n), v = load_some(t.v + i, n);
  store_some(t.p + i, adamw_update<S>(t, load_some(t.p + i, n), load_some(t.g + i, n), m, v), n);
  store_some(t.m + i, m, n), store_some(t.v + i, v, n);
}

#define MOTIONLANG_STRING_OF(x) #x
#define MOTIONLANG_STRING(x) MOTIONLANG_STRING_OF(x)

// Matrix product in bfloat16 with sums in float. Three tiles, one text around them: this file has the tile for any
// processor, which widens bfloat16 to float; bf16_x86.inc has those for vdpbf16ps and for AMX.
//
//   Panels   B (k x n) is rounded and stored in panels of 32 columns, pairs of k side by side: [panel][k /
//            2][column][2], zero padded to a multiple of 32 in k. The same for all tiles, but for numbers below 2^-126,
//            which some round to 0.
//   Rows     A is rounded into scratch, a block of rows at a time, zero padded in k: [row][k].
//   Tile     some rows of A times one panel, over k filled up to as many as its instructions take at a time (in pieces
//            of k, if the tile has pieces); what to do with the sums, as in gemm.inc. (In AMX the bias is the first
//            number of a sum.)
//   Order    every element is summed over k in an order that depends on the tile alone: same bits for any block or
//            thread.

typedef std::uint32_t Words __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
typedef std::uint32_t LooseWords __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES), aligned(2), may_alias));
typedef std::uint16_t Halves __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES / 2)));
typedef std::uint16_t LooseHalves __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES / 2), aligned(2), may_alias));
inline constexpr Index word_lanes = MOTIONLANG_VECTOR_BYTES / 4;

/// The nearest bfloat16, ties to even, in the upper half of each word; NaN stays NaN.
MOTIONLANG_INLINE Words round_to_bf16(const Vec<float>& x) {
  const Words w = (Words)x, rounded = w + (w >> 16 & 1u) + 0x7FFFu;
  return ((w & 0x7FFFFFFFu) > 0x7F800000u ? w | 0x400000u : rounded) & 0xFFFF0000u;
}
MOTIONLANG_INLINE void store_rounded(float* y, const Words& w) { store(y, (Vec<float>)w); }
MOTIONLANG_INLINE void store_rounded(std::uint16_t* y, const Words& w) {
  *reinterpret_cast<LooseHalves*>(y) = __builtin_convertvector(w >> 16, Halves);
}

/// A vector of numbers, rounded; zeros from the n-th on.
MOTIONLANG_INLINE Words rounded(const float* x, Index n) { return round_to_bf16(load_first(x, n)); }
/// Of two vectors of rounded numbers: pairs of bfloat16.
MOTIONLANG_INLINE Words pairs(const Words& first, const Words& second) { return first >> 16 | second; }
MOTIONLANG_INLINE void store_words(std::uint16_t* y, const Words& w) { *reinterpret_cast<LooseWords*>(y) = w; }

/// The same as round_row of a tile (but for numbers below 2^-126) for `rows` rows whose numbers are a[k * lda + row]:
/// squares of lanes are transposed.
template <class Element>
void round_columns(const float* a, Index lda, Index rows, Index k, Index padded, Element* y, Index pitch) {
  constexpr Index l = word_lanes, depth = l * (4 / static_cast<Index>(sizeof(Element)));  // of a square
  for (Index r = 0; r < rows; r += l) {
    const Index n = std::min(rows - r, l);
    for (Index i = 0; i < padded; i += depth) {
      Vec<float> square[lanes<float>];
#pragma GCC unroll 16
      for (int q = 0; q < lanes<float>; ++q) {
        const auto row = [&](Index at) {
          // no prefetcher follows pieces so far apart
          if (at + depth < k) __builtin_prefetch(a + (at + depth) * lda + r);
          return rounded(a + at * lda + r, at < k ? n : 0);
        };
        if constexpr (sizeof(Element) == 4) {
          square[q] = (Vec<float>)row(i + q);
        } else {
          square[q] = (Vec<float>)pairs(row(i + 2 * q), row(i + 2 * q + 1));
        }
      }
      transpose_lanes<float>(square);
      for (Index c = 0; c < n; ++c) std::memcpy(y + (r + c) * pitch + i, &square[c], sizeof square[c]);
    }
  }
}

/// Rows k0 ... k1-1 (both even) of all panels of B, whose element (k, n) is b[k * stride + n]: two rows at a
/// time, through as many panels as lie in different parts of the cache.
template <class Tile>
void bf16_pack_rows(const float* b, Index k, Index n, Index stride, Index k0, Index k1, std::uint16_t* panels) {
  constexpr Index ahead = 8;  // rows
  const Index depth = bf16_depth(k), count = (n + bf16_columns - 1) / bf16_columns;
  for (Index left = 0; left < count; left += panel_block) {
    for (Index i = k0; i < k1; i += 2) {
      const float *even = b + i * stride + left * bf16_columns, *odd = even + stride;
      std::uint16_t* out = panels + (left * depth + i) * bf16_columns;
      for (Index j = left; j < std::min(count, left + panel_block);
           ++j, even += bf16_columns, odd += bf16_columns, out += depth * bf16_columns) {
        fetch(even + ahead * stride, bf16_columns), fetch(odd + ahead * stride, bf16_columns);
        const Index columns = n - j * bf16_columns;
        Tile::round_pairs(even, i < k ? columns : 0, odd, i + 1 < k ? columns : 0, out);
      }
    }
  }
}
/// Panels first ... last-1 of B, whose element (k, n) is b[k + n * stride]: read along its rows, a square of lanes at a
/// time. Whether all numbers are finite, if it looks.
template <class Tile, bool looks>
bool bf16_pack_transposed(const float* b, Index k, Index n, Index stride, Index first, Index last,
                          std::uint16_t* panels) {
  constexpr Index l = word_lanes, block = 256, pitch = block + 32;  // of k that are rounded at once
  const Index depth = bf16_depth(k);
  std::uint16_t lines[static_cast<std::size_t>(bf16_columns * pitch)];  // columns of B: [column][k]
  Mask<float> found{};
  for (Index j = first; j < last; ++j) {
    std::uint16_t* out = panels + j * depth * bf16_columns;
    const float* in = b + j * bf16_columns * stride;
    const Index columns = n - j * bf16_columns;
    for (Index i0 = 0; i0 < depth; i0 += block) {
      const Index length = std::min(block, depth - i0);
      for (Index c = 0; c < bf16_columns; ++c) {
        const float* row = in + c * stride + i0;
        const Index there = c < columns ? std::min(k - i0, length) : 0;
        if constexpr (looks) {
          for (Index i = 0; i < there; i += lanes<float>) find_not_finite<float>(load_first(row + i, there - i), found);
        }
        Tile::round_row(row, there, length, lines + c * pitch);
      }
      for (Index i = 0; i < length; i += 2 * l, out += 2 * l * bf16_columns) {
        for (Index c = 0; c < bf16_columns; c += l) {
          Vec<float> square[lanes<float>];  // column, pair
#pragma GCC unroll 16
          for (int q = 0; q < lanes<float>; ++q) std::memcpy(&square[q], lines + (c + q) * pitch + i, sizeof square[q]);
          transpose_lanes<float>(square);
          for (Index p = 0; p < l; ++p) std::memcpy(out + (p * bf16_columns + c) * 2, &square[p], sizeof square[p]);
        }
      }
    }
  }
  return !any_negative<float>(found);
}

/// Bytes of a pair of k in a panel.
inline constexpr Index pair_bytes = 4 * bf16_columns;

/// True if a tile's rows of the result, which are whole lines, are better written past the caches: the caches would
/// read every line before it is overwritten, and forget other things. So for results larger than all of them, and for
/// those larger than the nearer ones whose rows are a multiple of the page size apart: a tile's rows then fall into the
/// same cache set.
inline bool streams(const Gemm<float>& g) {
  constexpr Index all = 16 << 20;
  const bool whole_lines =
      g.n % bf16_columns == 0 && bytes<float>(g.ldc) % 64 == 0 && reinterpret_cast<std::uintptr_t>(g.c) % 64 == 0;
  return whole_lines && bytes<float>(g.m * g.n) > (bytes<float>(g.ldc) % 4096 == 0 ? near_caches : all);
}
/// Rows of one panel's width, from where a tile has put them.
inline void stream_rows(const float* from, Index rows, float* to, Index ldc) {
  for (Index r = 0; r < rows; ++r, from += bf16_columns, to += ldc) {
    for (Index i = 0; i < bf16_columns; i += lanes<float>) store_stream(to + i, load(from + i));
  }
}

class PanelSplit;

/// What a tile is asked for: c = `height` rows of A, which begin at a, times the first `columns` columns of a panel,
/// over `depth` of k.
template <class Element>
struct TileProduct {
  const Element* a;
  Index pitch, height;
  const std::uint16_t* panel;
  Index depth;
  float* c;
  Index ldc, columns;
  Epilogue<float> e{};
  Ahead ahead{};
  bool panel_stays = true;         // in the cache, for the next tile; else the rows stay
  bool stream = false;             // c is written past the caches
  Index number = 0;                // of the tile among those of this panel
  bool first = true, last = true;  // piece of k
  PanelSplit* next = nullptr;      // of floats in parts: the panel that is split meanwhile
};

/// Tiles that keep their sums in registers: Tile::rows_of<height> does it all. Every tile has besides
///     round_row(x, n, padded, y)       y = n numbers, rounded, then zeros up to `padded`, a multiple of 32
///     round_pairs(x, nx, y, ny, pairs) 32 pairs, rounded: numbers of x (zeros after nx), beside each its like of y
template <class Tile>
struct RegisterTile {
  static constexpr bool even = true;                                 // rows are split evenly among tiles
  static constexpr Index depth(Index k) { return (k + 1) / 2 * 2; }  // that is multiplied, of the padded one
  static constexpr Index pieces(Index, Index) { return 1; }          // of k
  static void begin() {}
  static void end() {}

  template <class Element>
  void multiply(const TileProduct<Element>& t) {
    static constexpr auto table = []<int... R>(std::integer_sequence<int, R...>) {
      return std::array{&Tile::template rows_of<R + 1>...};
    }
    (std::make_integer_sequence<int, Tile::rows>{});
    const auto rows_of = table[static_cast<std::size_t>(t.height - 1)];
    if (!t.stream) return rows_of(t.a, t.pitch, t.panel, t.depth, t.c, t.ldc, t.columns, t.e, t.ahead);
    alignas(64) float result[static_cast<std::size_t>(Tile::rows * bf16_columns)];
    rows_of(t.a, t.pitch, t.panel, t.depth, result, bf16_columns, t.columns, t.e, t.ahead);
    stream_rows(result, t.height, t.c, t.ldc);
  }
  void finish() {}
};

/// For any processor: rows of A are kept as rounded floats, a pair of B is split into two vectors of floats.
struct WideningTile : RegisterTile<WideningTile> {
  using Element = float;
  static constexpr const char* name = MOTIONLANG_STRING(MOTIONLANG_ISA);
  static constexpr int rows = MOTIONLANG_TILE_ROWS > 2 ? MOTIONLANG_TILE_ROWS - 2 : 2;
  template <class Number>
  static void round_row(const float* x, Index n, Index padded, Number* y) {
    for (Index i = 0; i < padded; i += word_lanes) store_rounded(y + i, rounded(x + i, n - i));
  }
  static void round_pairs(const float* x, Index nx, const float* y, Index ny, std::uint16_t* out) {
    for (Index c = 0; c < bf16_columns; c += word_lanes) {
      store_words(out + 2 * c, pairs(rounded(x + c, nx - c), rounded(y + c, ny - c)));
    }
  }

  template <int R>
  static void rows_of(const Element* a, Index pitch, const std::uint16_t* panel, Index depth, float* c, Index ldc,
                      Index columns, const Epilogue<float>& e, Ahead ahead) {
    constexpr int l = lanes<float>;
    for (Index column = 0; column < columns; column += 2 * l) {
      const Epilogue<float> piece = e.from_column(column);
      fetch_result<float, R>(c + column, ldc, piece);
      if (column > 0) ahead.step = 0;  // once is enough
      Vec<float> c0[R], c1[R];
#pragma GCC unroll 16
      for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<float>{};
      const std::uint16_t* b = panel + 2 * column;
      for (Index k = 0; k < depth; k += 2, b += 2 * bf16_columns) {
        ahead.fetch();
        const Words w0 = *reinterpret_cast<const LooseWords*>(b), w1 = *reinterpret_cast<const LooseWords*>(b + 2 * l);
        const Vec<float> even0 = (Vec<float>)(w0 << 16), odd0 = (Vec<float>)(w0 & 0xFFFF0000u);
        const Vec<float> even1 = (Vec<float>)(w1 << 16), odd1 = (Vec<float>)(w1 & 0xFFFF0000u);
#pragma GCC unroll 16
        for (int i = 0; i < R; ++i) {
          const float x = a[i * pitch + k], y = a[i * pitch + k + 1];
          c0[i] += x * even0;
          c1[i] += x * even1;
          c0[i] += y * odd0;
          c1[i] += y * odd1;
        }
      }
      put_result<float, R>(c0, c1, c + column, ldc, columns - column, piece);
    }
  }
};

/// The first `count` rows of A, side by side.
template <class Tile>
void round_rows(const Rows<float>& a, Index count, Index k, Index depth, typename Tile::Element* y, Index pitch) {
  if (a.transposed) return round_columns(a.at, a.stride, count, k, depth, y, pitch);
  for (Index r = 0; r < count; ++r) Tile::round_row(a.from(r).at, k, depth, y + r * pitch);
}

/// Rows of A in scratch at once, and their distance.
template <class Tile>
Index bf16_rows(Index k) {
  return rows_at_once(bytes<typename Tile::Element>(bf16_depth(k)), Tile::rows, half_cache / 2 * 3);
}
template <class Tile>
constexpr Index bf16_pitch(Index depth) {
  return depth + 64 / static_cast<Index>(sizeof(typename Tile::Element));
}
/// Numbers of scratch that bf16_gemm_block needs.
template <class Tile>
Index bf16_scratch(Index k) {
  return bf16_rows<Tile>(k) * bf16_pitch<Tile>(bf16_depth(k));
}

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product with bfloat16 panels.
template <class Tile>
void bf16_gemm_block(const Gemm<float>& g, const std::uint16_t* panels, Index r0, Index r1, Index j0, Index j1,
                     float* scratch) {
  using Element = typename Tile::Element;
  const Index depth = bf16_depth(g.k), pitch = bf16_pitch<Tile>(depth), at_once = bf16_rows<Tile>(g.k);
  Element* a = reinterpret_cast<Element*>(scratch);
  const bool stream = streams(g);
  Tile tile;
  Tile::begin();
  constexpr Index unit = Tile::even ? 1 : Tile::rows;  // of rows that blocks have evenly
  const Index units = (r1 - r0 + unit - 1) / unit, row_blocks = (r1 - r0 + at_once - 1) / at_once;
  for (Index block = 0; block < row_blocks; ++block) {
    const Index top = r0 + unit * part(units, block, row_blocks);
    const Index rows = std::min(r1, r0 + unit * part(units, block + 1, row_blocks)) - top,
                tiles = (rows + Tile::rows - 1) / Tile::rows;
    const Index pieces = Tile::pieces(depth, tiles);
    round_rows<Tile>(Rows<float>{g.a, g.lda, g.a_transposed}.from(top), rows, g.k, depth, a, pitch);
    for (Index j = j0; j < j1; ++j) {
      const std::uint16_t* panel = panels + j * depth * bf16_columns;
      const bool last = j + 1 == j1 && top + rows == r1;
      const std::byte* next = as_bytes(panels + (j + 1 < j1 ? j + 1 : j0) * depth * bf16_columns);
      const auto* following = last ? g.following(j0, (g.n + bf16_columns - 1) / bf16_columns, next) : next;
      for (Index step = 0; step < pieces * tiles; ++step) {
        const Index piece = step / tiles, t = step % tiles;
        const Index k0 = 32 * part(depth / 32, piece, pieces),
                    k1 = std::min(32 * part(depth / 32, piece + 1, pieces), Tile::depth(g.k));
        const Index first = Tile::even ? part(rows, t, tiles) : t * Tile::rows;
        const Index height = (Tile::even ? part(rows, t + 1, tiles) : std::min(rows, first + Tile::rows)) - first;
        const Index row = top + first, column = j * bf16_columns;
        const auto ahead =
            Ahead::share(following + k0 / 2 * pair_bytes, (k1 - k0) / 2 * pair_bytes, t, tiles, (k1 - k0) / 2);
        TileProduct<Element> product{.a = a + first * pitch + k0,
                                     .pitch = pitch,
                                     .height = height,
                                     .panel = panel + k0 * bf16_columns,
                                     .depth = k1 - k0,
                                     .c = g.c + row * g.ldc + column,
                                     .ldc = g.ldc,
                                     .columns = std::min(g.n - column, bf16_columns),
                                     .e = Epilogue<float>::of(g, row, column, true, true),
                                     .ahead = ahead,
                                     .panel_stays = tiles > 1,
                                     .stream = stream,
                                     .number = t,
                                     .first = piece == 0,
                                     .last = piece + 1 == pieces};
        tile.multiply(product);
      }
    }
  }
  tile.finish();
  if (stream) end_of_streams();
  Tile::end();
}

/// The products of attention (attention.inc) in bfloat16; scores and softmax stay in float.
template <class Tile>
struct Bf16Products {
  using Number = float;
  using Element = typename Tile::Element;
  static constexpr Index rows = Tile::rows;
  static void begin() { Tile::begin(); }
  static void end() { Tile::end(); }
  static Index columns(Index n) { return bf16_depth(n); }
  static Index panels(Index k, Index n) { return bf16_depth(k) * bf16_depth(n) / 2; }
  static Index scratch(Index k) { return Tile::rows * bf16_pitch<Tile>(bf16_depth(k)); }

  static void pack(const float* b, Index k, Index n, Index stride_k, Index stride_n, float* panels) {
    auto* out = reinterpret_cast<std::uint16_t*>(panels);
    if (stride_n == 1)
      bf16_pack_rows<Tile>(b, k, n, stride_k, 0, bf16_depth(k), out);
    else
      bf16_pack_transposed<Tile, false>(b, k, n, stride_n, 0, bf16_depth(n) / bf16_columns, out);
  }
  static void multiply(const Rows<float>& a, Index count, Index k, const float* panels, Index n, float* c, Index ldc,
                       float* scratch, bool whole_panels) {
    const Index depth = bf16_depth(k), pitch = bf16_pitch<Tile>(depth);
    auto* rounded_rows = reinterpret_cast<Element*>(scratch);
    Tile tile;
    for (Index first = 0; first < count; first += Tile::rows) {
      const Index height = std::min<Index>(Tile::rows, count - first);
      round_rows<Tile>(a.from(first), height, k, depth, rounded_rows, pitch);
      for (Index j = 0; j < n; j += bf16_columns) {
        const auto* panel = reinterpret_cast<const std::uint16_t*>(panels) + j * depth;
        tile.multiply(TileProduct<Element>{.a = rounded_rows,
                                           .pitch = pitch,
                                           .height = height,
                                           .panel = panel,
                                           .depth = Tile::depth(k),
                                           .c = c + first * ldc + j,
                                           .ldc = ldc,
                                           .columns = whole_panels ? bf16_columns : std::min(n - j, bf16_columns),
                                           .ahead = {as_bytes(panel)},
                                           .panel_stays = false});
      }
    }
    tile.finish();
  }
};

template <class Tile>
const Bf16Kernels& bf16_table() {
  static constexpr Bf16Kernels t{.name = Tile::name,
                                 .tile_rows = Tile::rows,
                                 .gemm_rows = &bf16_rows<Tile>,
                                 .gemm_scratch = &bf16_scratch<Tile>,
                                 .pack_rows = &bf16_pack_rows<Tile>,
                                 .pack_transposed = &bf16_pack_transposed<Tile, true>,
                                 .gemm_block = &bf16_gemm_block<Tile>,
                                 .attention_scratch = &attention_scratch<Bf16Products<Tile>>,
                                 .attention_vjp_scratch = &attention_vjp_scratch<Bf16Products<Tile>>,
                                 .attention_head = &attention_head<Bf16Products<Tile>>,
                                 .attention_head_vjp = &attention_head_vjp<Bf16Products<Tile>>};
  return t;
}

template <class S>
const Kernels<S>& table() {
  static constexpr Kernels<S> t{
      .name = MOTIONLANG_STRING(MOTIONLANG_ISA),
      .tiles = nullptr,
      .panel_width = panel_width<S>,
      .tile_rows = tile_rows,
      .gemm_rows = &gemm_rows<S>,
      .gemm_scratch = &gemm_scratch<S>,
      .pack_rows = &pack_rows<S>,
      .pack_transposed = &pack_transposed<S, true>,
      .gemm_block = &gemm_block<S>,
      .attention_scratch = &attention_scratch<FloatProducts<S>>,
      .attention_vjp_scratch = &attention_vjp_scratch<FloatProducts<S>>,
      .attention_head = &attention_head<FloatProducts<S>>,
      .attention_head_vjp = &attention_head_vjp<FloatProducts<S>>,
      .dropout = &dropout<S>,
      .layer_norm_rows = &layer_norm_rows<S>,
      .layer_norm_rows_vjp = &layer_norm_rows_vjp<S>,
      .layer_norm_columns_vjp = &layer_norm_columns_vjp<S>,
      .softmax_rows = &softmax_rows<S>,
      .transpose = &transpose<S>,
      .activate = &activate<S>,
      .activate_vjp = &activate_vjp<S>,
      .binary = &binary<S>,
      .error_function = &error_function<S>,
      .row_sums = &row_sums<S>,
      .column_sums = &column_sums<S>,
      .adamw = &adamw<S>,
  };
  return t;
}

#undef MOTIONLANG_STRING
#undef MOTIONLANG_STRING_OF
#undef MOTIONLANG_INLINE

}  // namespace detail::MOTIONLANG_ISA
MOTIONLANG_NAMESPACE_END
#undef MOTIONLANG_ISA
#undef MOTIONLANG_VECTOR_BYTES
#undef MOTIONLANG_TILE_ROWS
MOTIONLANG_TARGET_POP

MOTIONLANG_TARGET_PUSH(MOTIONLANG_AVX512)
#define MOTIONLANG_ISA avx512
#define MOTIONLANG_VECTOR_BYTES 64
#define MOTIONLANG_TILE_ROWS 14
// All kernels for one instruction set, and their table. Included by kernels.hpp, several times.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail::MOTIONLANG_ISA {

// Vectors of MOTIONLANG_VECTOR_BYTES bytes in the compiler's own vector types, and the elementary functions on them.
// Included once for every instruction set by kernels.hpp; no include guard on purpose.

template <class S>
struct VectorOf {
  typedef S type __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
  typedef S loose __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES), aligned(sizeof(S)), may_alias));
  using bits = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
  typedef bits mask __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
};
template <class S>
using Vec = typename VectorOf<S>::type;
template <class S>
using Mask = typename VectorOf<S>::mask;
template <class S>
inline constexpr int lanes = MOTIONLANG_VECTOR_BYTES / static_cast<int>(sizeof(S));

// Everything below is inlined: passing such vectors between functions would depend on the caller's instruction set.
#define MOTIONLANG_INLINE inline __attribute__((always_inline))

template <class S>
MOTIONLANG_INLINE Vec<S> load(const S* p) {
  return *reinterpret_cast<const typename VectorOf<S>::loose*>(p);
}
template <class S>
MOTIONLANG_INLINE void store(S* p, const Vec<S>& v) {
  *reinterpret_cast<typename VectorOf<S>::loose*>(p) = v;
}
/// Past the caches, to an address that is a multiple of the vector's size. Other threads see it after `end_of_streams`.
template <class S>
MOTIONLANG_INLINE void store_stream(S* p, const Vec<S>& v) {
#if defined(__clang__)
  __builtin_nontemporal_store(v, reinterpret_cast<Vec<S>*>(p));
#elif defined(__x86_64__)
  auto* at = reinterpret_cast<float*>(p);
#if MOTIONLANG_VECTOR_BYTES == 64
  __builtin_ia32_movntps512(at, (Vec<float>)v);
#elif MOTIONLANG_VECTOR_BYTES == 32
  __builtin_ia32_movntps256(at, (Vec<float>)v);
#else
  __builtin_ia32_movntps(at, (Vec<float>)v);
#endif
#else
  store(p, v);
#endif
}
/// Asks for n numbers that are read soon.
template <class Number>
MOTIONLANG_INLINE void fetch(const Number* x, Index n) {
  for (Index i = 0; i < n; i += 64 / static_cast<Index>(sizeof(Number))) __builtin_prefetch(x + i);
}
MOTIONLANG_INLINE void end_of_streams() {
#if defined(__x86_64__)
  __builtin_ia32_sfence();
#endif
}
template <class S>
MOTIONLANG_INLINE Vec<S> splat(S x) {
  return x - Vec<S>{};
}
template <class S>
MOTIONLANG_INLINE Vec<S> load_some(const S* p, Index n) {  // lanes n and above are 0
  alignas(MOTIONLANG_VECTOR_BYTES) S t[static_cast<std::size_t>(lanes<S>)] = {};
  for (Index i = 0; i < n && i < lanes<S>; ++i) t[i] = p[i];
  return load(t);
}
/// The first n numbers (all lanes if there are so many), then zeros; nothing is read if n <= 0.
template <class S>
MOTIONLANG_INLINE Vec<S> load_first(const S* p, Index n) {
  return n >= lanes<S> ? load(p) : load_some(p, n);
}
template <class S>
MOTIONLANG_INLINE void store_some(S* p, const Vec<S>& v, Index n) {
  for (Index i = 0; i < n && i < lanes<S>; ++i) p[i] = v[i];
}
template <class S>
MOTIONLANG_INLINE void store_first(S* p, const Vec<S>& v, Index n) {
  n >= lanes<S> ? store(p, v) : store_some(p, v, n);
}
// The larger and the smaller of two; b where either is NaN, so a bound comes first and data second.
// (Where one of them is a constant, GCC 12 makes two instructions of it for vectors of 64 bytes.)
template <class S>
MOTIONLANG_INLINE Vec<S> vmax(const Vec<S>& a, const Vec<S>& b) {
#if MOTIONLANG_VECTOR_BYTES == 64 && !defined(__clang__)
  if constexpr (sizeof(S) == 4) {
    Vec<S> r;
    asm("vmaxps %2, %1, %0" : "=v"(r) : "v"(a), "vm"(b));
    return r;
  }
#endif
  return a > b ? a : b;
}
template <class S>
MOTIONLANG_INLINE Vec<S> vmin(const Vec<S>& a, const Vec<S>& b) {
#if MOTIONLANG_VECTOR_BYTES == 64 && !defined(__clang__)
  if constexpr (sizeof(S) == 4) {
    Vec<S> r;
    asm("vminps %2, %1, %0" : "=v"(r) : "v"(a), "vm"(b));
    return r;
  }
#endif
  return a < b ? a : b;
}
/// Lanes of `found` become negative where x is NaN or infinite: all bits of its exponent are set.
template <class S>
MOTIONLANG_INLINE void find_not_finite(const Vec<S>& x, Mask<S>& found) {
  constexpr auto exponent = std::bit_cast<typename VectorOf<S>::bits>(std::numeric_limits<S>::infinity());
  found |= (~(Mask<S>)x & exponent) - 1;
}
template <class S>
MOTIONLANG_INLINE bool any_negative(const Mask<S>& v) {
  bool any = false;
  for (int i = 0; i < lanes<S>; ++i) any |= v[i] < 0;
  return any;
}
/// Lane i + half beside lane i, for the lower halves of blocks of 2 half lanes; the upper halves are of no account.
template <class S, int half, int... l>
MOTIONLANG_INLINE Vec<S> upper_lanes(const Vec<S>& v, std::integer_sequence<int, l...>) {
  return __builtin_shufflevector(v, v, (l + half) % lanes<S>...);
}
// Halves are put together until one lane is left: sums have a fixed order.
template <class S, int half = lanes<S> / 2>
MOTIONLANG_INLINE S reduce_add(const Vec<S>& v) {
  if constexpr (half == 0)
    return v[0];
  else
    return reduce_add<S, half / 2>(v + upper_lanes<S, half>(v, std::make_integer_sequence<int, lanes<S>>{}));
}
template <class S, int half = lanes<S> / 2>
MOTIONLANG_INLINE S reduce_max(const Vec<S>& v) {
  if constexpr (half == 0)
    return v[0];
  else
    return reduce_max<S, half / 2>(vmax<S>(v, upper_lanes<S, half>(v, std::make_integer_sequence<int, lanes<S>>{})));
}

/// Swaps the blocks off the diagonal: lane l + half of a with lane l of b, for every l without the bit `half`.
template <class S, int half, int... l>
MOTIONLANG_INLINE void swap_blocks(Vec<S>& a, Vec<S>& b, std::integer_sequence<int, l...>) {
  constexpr int n = lanes<S>;
  const Vec<S> upper = __builtin_shufflevector(a, b, ((l & half) != 0 ? n + l - half : l)...);
  b = __builtin_shufflevector(a, b, ((l & half) != 0 ? n + l : l + half)...);
  a = upper;
}
/// v[i][j] becomes v[j][i]: blocks of 1, 2, 4, ... lanes are swapped.
template <class S, int half = 1>
MOTIONLANG_INLINE void transpose_lanes(Vec<S>* v) {
  if constexpr (half < lanes<S>) {
#pragma GCC unroll 16
    for (int i = 0; i < lanes<S>; ++i) {
      if ((i & half) == 0) swap_blocks<S, half>(v[i], v[i + half], std::make_integer_sequence<int, lanes<S>>{});
    }
    transpose_lanes<S, 2 * half>(v);
  }
}

/// e^x for x <= 88 (709): x = n ln 2 + f, e^f by its series, 2^n by the exponent bits. Relative error below 1e-7
/// (1e-15). Results below the smallest normal number are 0. 2^n is a factor of its own, so that NaN stays NaN.
template <class S>
MOTIONLANG_INLINE Vec<S> vexp(const Vec<S>& x) {
  constexpr bool single = sizeof(S) == 4;
  constexpr S low = single ? S(-87) : S(-708), high = single ? S(88) : S(709);
  const Vec<S> c = vmin<S>(splat(high), x);
  // 1.5 * 2^23 (2^52), which rounds to an integer what it is added to, and the bias of exponents, which is then in the
  // lowest bits.
  const S magic = single ? S(12582912 + 127) : S(6755399441055744 + 1023);
  const Vec<S> shifted = c * S(1.4426950408889634) + magic;
  const Vec<S> n = shifted - magic;
  const Vec<S> f = (c - n * S(single ? 0.693359375 : 0.693147180369123816490)) -
                   n * S(single ? -2.12194440e-4 : 1.90821492927058770002e-10);
  Vec<S> p = splat(S(single ? 1.0 / 5040 : 1.0 / 6227020800.0));
  if constexpr (!single) {
    for (double k : {1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040})
      p = p * f + S(k);
  }
  for (double k : {1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0}) p = p * f + S(k);
  const Vec<S> power = (Vec<S>)((Mask<S>)shifted << (single ? 23 : 52));
  return x < splat(low) ? Vec<S>{} : p * power;  // so far below, n is nonsense
}

/// Float: (Phi(x) - 1/2) / x for y = x^2 <= 32, Phi being the normal distribution function: a rational function (our
/// own least-squares fit). Of Phi, 2e-8 is wrong by the fit; with what is rounded, below 2.5e-7.
template <class S>
MOTIONLANG_INLINE Vec<S> phi_ratio(const Vec<S>& y) {
  Vec<S> p = splat(S(2.1818830005316466e-08)), q = splat(S(1.1712714934253183e-06));
  p = p * y + S(6.364869382952854e-06);
  q = q * y + S(7.602274008301123e-05);
  p = p * y + S(0.00017693884114677917);
  q = q * y + S(0.0019305587808950675);
  p = p * y + S(0.004725908484413717);
  q = q * y + S(0.029119172061619288);
  p = p * y + S(0.0346923636272431);
  q = q * y + S(0.25362643899642984);
  p = p * y + S(0.3989422129894181);
  q = q * y + S(1);
  return p / q;
}
/// erf(x) = 2 Phi(sqrt(2) x) - 1. Float: absolute error below 5e-7. Double: libm.
template <class S>
MOTIONLANG_INLINE Vec<S> verf(const Vec<S>& x) {
  if constexpr (sizeof(S) == 4) {
    const Vec<S> c = vmin<S>(splat(S(4)), vmax<S>(splat(S(-4)), x));
    return c * phi_ratio<S>(c * c * S(2)) * S(2.8284271247461901);
  } else {
    Vec<S> r{};
    for (int i = 0; i < lanes<S>; ++i) r[i] = std::erf(x[i]);
    return r;
  }
}
#if MOTIONLANG_VECTOR_BYTES == 64
/// 32 numbers: lane i of the result is that which the lowest five bits of index[i] say.
MOTIONLANG_INLINE Vec<float> look_up(const float* table, const Vec<float>& index) {
  Vec<float> r = load(table);
  asm("vpermt2ps %2, %1, %0" : "+v"(r) : "v"(index), "v"(load(table + 16)));
  return r;
}
/// By gelu_table.hpp: absolute error below 1e-7 for x < 0, relative error below 5e-7 for x > 0.
MOTIONLANG_INLINE Vec<float> gelu_by_table(const Vec<float>& x) {
  static_assert(GeluTable::cells == 32 && GeluTable::width == 0.25);
  constexpr auto last = static_cast<float>(GeluTable::width * (GeluTable::cells - 1));
  Vec<float> c, d;
  asm("vrangeps $0xa, %2, %1, %0" : "=v"(c) : "v"(x), "v"(splat(last)));  // min(|x|, last)
  asm("vreduceps $0x24, %1, %0" : "=v"(d) : "v"(c));                      // c - i / 4, i = round(4 c)
  const Vec<float> i = c + 3145728.f;                                     // 1.5 * 2^21: i in the lowest bits
  const auto& table = gelu_table.by_power;
  Vec<float> g = look_up(table[GeluTable::degree], i);
#pragma GCC unroll 8
  for (int n = GeluTable::degree; n-- > 0;) g = g * d + look_up(table[n], i);
  return vmax<float>(Vec<float>{}, x) - g;
}
#endif
/// gelu(x) = x Phi(x) = x/2 + x (Phi(x) - 1/2). The last term is even in x, so that nothing need be bounded before it
/// is known. Float: by look_up where there is one; error below 3e-7 |x|. Of -inf: NaN or about 0.
template <class S>
MOTIONLANG_INLINE Vec<S> vgelu(const Vec<S>& x) {
#if MOTIONLANG_VECTOR_BYTES == 64
  if constexpr (sizeof(S) == 4) return gelu_by_table(x);
#endif
  const Vec<S> h = x * S(0.5);
  if constexpr (sizeof(S) == 4) {
    const Vec<S> y = x * x;
    return h + (y < splat(S(32)) ? y * phi_ratio<S>(y) : (Vec<S>)((Mask<S>)h & 0x7fffffff));
  } else {
    return h + h * verf<S>(x * S(0.70710678118654752));
  }
}

/// Square root of x >= 0: Newton's iteration for 1/sqrt(x) from an estimate by shifting the exponent; within 1 ulp.
template <class S>
MOTIONLANG_INLINE Vec<S> vsqrt(const Vec<S>& x) {
  constexpr bool single = sizeof(S) == 4;
  using Bits = typename VectorOf<S>::bits;
  Vec<S> y = (Vec<S>)(static_cast<Bits>(single ? 0x5F375A86 : 0x5FE6EB50C7B537A9) - ((Mask<S>)x >> 1));
  for (int i = 0; i < (single ? 3 : 5); ++i) y = y * (S(1.5) - x * S(0.5) * y * y);
  const Vec<S> r = x * y;
  return r + S(0.5) * y * (x - r * r);
}

/// Float: relative error below 3e-7; a polynomial near 0 (Cephes, Moshier 1992), 1 - 2 / (exp(2 |x|) + 1) elsewhere.
/// Double: libm.
template <class S>
MOTIONLANG_INLINE Vec<S> vtanh(const Vec<S>& x) {
  if constexpr (sizeof(S) == 4) {
    const Vec<S> y = x * x;
    Vec<S> p = y * S(-5.70498872745e-3) + S(2.06390887954e-2);
    for (double k : {-5.37397155531e-2, 1.33314422036e-1, -3.33332819422e-1}) p = p * y + S(k);
    const Vec<S> size = (Vec<S>)((Mask<S>)x & 0x7fffffff), far = S(1) - S(2) / (vexp<S>(size + size) + S(1));
    const Vec<S> positive = size < splat(S(0.625)) ? size + size * y * p : far;
    return (Vec<S>)((Mask<S>)positive | ((Mask<S>)x & ~0x7fffffff));
  } else {
    Vec<S> r{};
    for (int i = 0; i < lanes<S>; ++i) r[i] = std::tanh(x[i]);
    return r;
  }
}
//
// Nonlinearities and their derivatives. Which one it is, is asked once for many numbers: constants stay in registers.

template <Activation act, class S>
MOTIONLANG_INLINE Vec<S> apply_activation(const Vec<S>& x) {
  switch (act) {
    case Activation::none:
      return x;
    case Activation::relu:
      return vmax<S>(Vec<S>{}, x);
    case Activation::gelu:
      return vgelu<S>(x);
    case Activation::silu:
      return x / (vexp<S>(-x) + S(1));
    case Activation::tanh:
      return vtanh<S>(x);
    case Activation::quick_gelu:
      return x / (vexp<S>(x * S(-1.702)) + S(1));
    case Activation::gelu_new: {
      const Vec<S> h = x * S(0.5);
      return h * vtanh<S>((x + x * x * x * S(0.044715)) * S(0.79788456080286536)) + h;
    }
    case Activation::sigmoid:
      return S(1) / (vexp<S>(-x) + S(1));
  }
  return x;
}

/// Derivative at x.
///     gelu'(x) = Phi(x) + x phi(x),   silu'(x) = s + x s (1 - s),   sigmoid'(x) = s (1 - s) with s = 1 / (1 + exp(-x))
template <Activation act, class S>
MOTIONLANG_INLINE Vec<S> activation_slope(const Vec<S>& x) {
  switch (act) {
    case Activation::none:
      return splat(S(1));
    case Activation::relu:
      return x > Vec<S>{} ? splat(S(1)) : Vec<S>{};
    case Activation::gelu: {
      const Vec<S> phi = vexp<S>(x * x * S(-0.5)) * S(0.39894228040143268);
      return verf<S>(x * S(0.70710678118654752)) * S(0.5) + S(0.5) + x * phi;
    }
    case Activation::silu: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x);
      return s + x * s * (S(1) - s);
    }
    case Activation::tanh: {
      const Vec<S> t = vtanh<S>(x);
      return S(1) - t * t;
    }
    case Activation::quick_gelu: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x * S(1.702));
      return s + x * s * (S(1) - s) * S(1.702);
    }
    case Activation::gelu_new: {
      const Vec<S> t = vtanh<S>((x + x * x * x * S(0.044715)) * S(0.79788456080286536));
      return (t + S(1)) * S(0.5) + x * (S(1) - t * t) * (x * x * S(3 * 0.044715) + S(1)) * S(0.5 * 0.79788456080286536);
    }
    case Activation::sigmoid: {
      const Vec<S> s = apply_activation<Activation::sigmoid, S>(x);
      return s * (S(1) - s);
    }
  }
  return splat(S(1));
}

/// f.operator()<act>().
template <class F>
void with_activation(Activation act, const F& f) {
  switch (act) {
    case Activation::none:
      return f.template operator()<Activation::none>();
    case Activation::relu:
      return f.template operator()<Activation::relu>();
    case Activation::gelu:
      return f.template operator()<Activation::gelu>();
    case Activation::silu:
      return f.template operator()<Activation::silu>();
    case Activation::tanh:
      return f.template operator()<Activation::tanh>();
    case Activation::quick_gelu:
      return f.template operator()<Activation::quick_gelu>();
    case Activation::gelu_new:
      return f.template operator()<Activation::gelu_new>();
    case Activation::sigmoid:
      return f.template operator()<Activation::sigmoid>();
  }
}

/// y = act(x) for so many rows of `width` numbers, which begin ldx and ldy apart; y may be x.
template <class S>
void activate_rows(const S* x, Index ldx, Index rows, Index width, Activation act, S* y, Index ldy) {
  constexpr int l = lanes<S>;
  with_activation(act, [=]<Activation a>() {
    for (Index r = 0; r < rows; ++r) {
      const S* from = x + r * ldx;
      S* to = y + r * ldy;
      Index i = 0;
      for (; i + l <= width; i += l) store(to + i, apply_activation<a, S>(load(from + i)));
      if (i < width) store_some(to + i, apply_activation<a, S>(load_some(from + i, width - i)), width - i);
    }
  });
}
template <class S>
void activate(const S* x, Index n, Activation act, S* y) {
  activate_rows(x, n, 1, n, act, y, n);
}
/// dx = dy act'(x) for n numbers.
template <class S>
void activate_vjp(const S* x, const S* dy, Index n, Activation act, S* dx) {
  constexpr int l = lanes<S>;
  with_activation(act, [=]<Activation a>() {
    Index i = 0;
    for (; i + l <= n; i += l) store(dx + i, load(dy + i) * activation_slope<a, S>(load(x + i)));
    if (i < n) store_some(dx + i, load_some(dy + i, n - i) * activation_slope<a, S>(load_some(x + i, n - i)), n - i);
  });
}
//
// Matrix product with packed right-hand side: register tiles, cache blocks, epilogue in the tile.
//
//   Panels   B (k x n) is stored in panels of `panel_width` columns, k rows each: [panel][k][column], zero padded.
//   Tile     up to `tile_rows` rows of A times one panel, all sums in registers.
//   Block    up to 1024 of k at a time: rows of A stay in the second-level cache, beside one panel or a group of them.
//            If k is in several blocks, eight panels at a time: what the next 1024 of k are added to stays there as
//            well. (All panels at a time where A is copied first.)
//   Walk     a panel times all rows of the block, then the next panel. If the result is larger than the nearer caches
//            and k is one block: a tile's rows times a group of panels, then the next rows. So longer pieces of the
//            result's rows are written, one after the other: the lines under them, which come from memory first, the
//            processor fetches by itself, and fewer pages are in use.
//   Ahead    a tile asks for its part of C and of the residual before it begins, and with every k for a piece of what
//            follows: of the panels of the next group, be it of the product that follows, and, with the first group, of
//            the next rows of A.
//   Order    every element is summed over k in the same order, whatever the tile height, block or thread: same bits.

template <class S>
inline constexpr Index panel_width = 2 * lanes<S>;
inline constexpr Index tile_rows = MOTIONLANG_TILE_ROWS;
inline constexpr Index depth_block = 1024;
inline constexpr Index panel_block = 8;
inline constexpr Index most_tiles = 16;        // of rows in a block
inline constexpr Index near_caches = 4 << 20;  // bytes
// for rows of A, and as much for a group of panels
inline constexpr Index half_cache = 512 * 1024 * MOTIONLANG_VECTOR_BYTES / 64;
template <class S>
// of a tile of a transposed A, copied
inline constexpr Index tile_pitch = (tile_rows + lanes<S> - 1) / lanes<S>* lanes<S>;

template <class S>
constexpr Index bytes(Index count) {
  return count * static_cast<Index>(sizeof(S));
}
template <class S>
const std::byte* as_bytes(const S* x) {
  return reinterpret_cast<const std::byte*>(x);
}

/// Rows of A, `row_bytes` each, in a block of so many bytes: at most most_tiles tiles.
constexpr Index rows_at_once(Index row_bytes, Index tile, Index bytes) {
  return std::clamp<Index>(bytes / std::max<Index>(1, row_bytes) / tile, 1, most_tiles) * tile;
}

/// Rows k0 ... k1-1 of all panels of B, whose element (k, n) is b[k * stride + n].
template <class S>
void pack_rows(const S* b, Index k, Index n, Index stride, Index k0, Index k1, S* panels) {
  constexpr Index w = panel_width<S>, l = lanes<S>;
  constexpr Index ahead = 8;  // rows
  for (Index i = k0; i < k1; ++i) {
    const S* in = b + i * stride;
    S* out = panels + i * w;
    for (Index columns = n; columns > 0; columns -= w, in += w, out += k * w) {
      __builtin_prefetch(in + ahead * stride), __builtin_prefetch(in + ahead * stride + l);
      store(out, load_first(in, columns)), store(out + l, load_first(in + l, columns - l));
    }
  }
}
/// Panels first ... last-1 of B, whose element (k, n) is b[k + n * stride]: read along its rows, a square of lanes at a
/// time. Whether all numbers are finite, if it looks.
template <class S, bool looks>
bool pack_transposed(const S* b, Index k, Index n, Index stride, Index first, Index last, S* panels) {
  constexpr Index w = panel_width<S>, l = lanes<S>;
  Mask<S> found{};
  for (Index j = first; j < last; ++j) {
    S* out = panels + j * k * w;
    const Index columns = n - j * w;
    const S* in = b + j * w * stride;
    for (Index i = 0; i < k; i += l) {
      const Index rows = k - i < l ? k - i : l;
      for (Index c = 0; c < w; c += l) {
        Vec<S> square[lanes<S>];
#pragma GCC unroll 16
        for (int q = 0; q < lanes<S>; ++q) {
          const S* from = in + (c + q) * stride + i;
          square[q] = load_first(from, c + q < columns ? rows : 0);
          if constexpr (looks) find_not_finite<S>(square[q], found);
        }
        transpose_lanes<S>(square);
        for (Index r = 0; r < rows; ++r) store(out + (i + r) * w + c, square[r]);
      }
    }
  }
  return !any_negative<S>(found);
}

/// Rows of A, whose element (i, k) is at[i * stride + k], or, when transposed, at[i + k * stride].
template <class S>
struct Rows {
  const S* at;
  Index stride;
  bool transposed;

  Rows from(Index row) const { return {at + row * (transposed ? 1 : stride), stride, transposed}; }
  Rows from_depth(Index k) const { return {at + k * (transposed ? stride : 1), stride, transposed}; }
};

/// What is read after a tile: it is fetched into the second-level cache meanwhile, `step` bytes, a line at most, for
/// every row of the panel (bfloat16: pair of rows). What is more than that is left. So where a row is two lines long, a
/// tile alone fetches the first half of the next panel only: every other line of the whole would confuse the processor,
/// which fetches by itself lines that follow each other (20 % slower from memory).
struct Ahead {
  const std::byte* at = nullptr;
  Index step = 0;

  /// Share i of n of `bytes` that begin at `next`, in so many steps: shares rather overlap than leave bytes between
  /// them.
  MOTIONLANG_INLINE static Ahead share(const std::byte* next, Index bytes, Index i, Index n, Index steps) {
    const Index all = std::max<Index>(1, n * steps), step = std::min<Index>(64, (bytes + all - 1) / all);
    return {next + i * step * steps, step};
  }
  MOTIONLANG_INLINE void fetch() { __builtin_prefetch(at, 0, 2), at += step; }
};

/// What to do with a finished tile: add what is there already (k is split), bias, residual; then the nonlinearity.
template <class S>
struct Epilogue {
  bool accumulate = false;
  const S* bias = nullptr;      // of the panel's first column
  const S* residual = nullptr;  // of the tile's first element
  Index residual_stride = 0;
  Activation act = Activation::none;

  /// Of the tile that begins at a row and column of a product; `first` and `last`: of the blocks of k.
  static Epilogue of(const Gemm<S>& g, Index row, Index column, bool first, bool last) {
    Epilogue e{.accumulate = !first};
    if (!last) return e;
    e.act = g.act;
    if (g.bias != nullptr) e.bias = g.bias + column;
    if (g.residual != nullptr) e.residual = g.residual + row * g.ldr + column, e.residual_stride = g.ldr;
    return e;
  }
  Epilogue from_column(Index column) const {
    Epilogue e = *this;
    if (bias != nullptr) e.bias += column;
    if (residual != nullptr) e.residual += column;
    return e;
  }
  Epilogue from_row(Index row) const {
    Epilogue e = *this;
    if (residual != nullptr) e.residual += row * residual_stride;
    return e;
  }
};

/// Asks for the rows of c and of the residual that a tile is put into.
template <class S, int R>
MOTIONLANG_INLINE void fetch_result(const S* c, Index ldc, const Epilogue<S>& e) {
  constexpr int l = lanes<S>;
  for (int i = 0; i < R; ++i) __builtin_prefetch(c + i * ldc, 1), __builtin_prefetch(c + i * ldc + l, 1);
  if (e.residual == nullptr) return;
  for (int i = 0; i < R; ++i) {
    const S* row = e.residual + i * e.residual_stride;
    __builtin_prefetch(row), __builtin_prefetch(row + l);
  }
}

/// put_result for the last columns of a matrix, when they do not fill a panel: two vectors of sums for every row.
template <class S>
[[gnu::noinline]] void put_narrow_result(const Vec<S>* sums, int rows, S* c, Index ldc, Index columns,
                                         const Epilogue<S>& e) {
  constexpr Index l = lanes<S>;
  for (Index r = 0; r < rows; ++r) {
    for (Index i = 0; i < columns; i += l) {
      const Index n = columns - i;
      S* out = c + r * ldc + i;
      Vec<S> x = sums[2 * r + i / l];
      if (e.accumulate) x += load_first(out, n);
      if (e.bias != nullptr) x += load_first(e.bias + i, n);
      if (e.residual != nullptr) x += load_first(e.residual + r * e.residual_stride + i, n);
      store_first(out, x, n);
    }
  }
}

/// c (R x columns) = the sums of a tile, c0 and c1 being its two vectors of columns.
template <class S, int R>
MOTIONLANG_INLINE void put_result(Vec<S>* c0, Vec<S>* c1, S* c, Index ldc, Index columns, const Epilogue<S>& e) {
  constexpr int l = lanes<S>;
  if (columns >= 2 * l) {
    const Vec<S> z0 = e.bias == nullptr ? Vec<S>{} : load(e.bias), z1 = e.bias == nullptr ? Vec<S>{} : load(e.bias + l);
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      S* out = c + i * ldc;
      if (e.accumulate) c0[i] += load(out), c1[i] += load(out + l);
      c0[i] += z0, c1[i] += z1;
      if (e.residual != nullptr)
        c0[i] += load(e.residual + i * e.residual_stride), c1[i] += load(e.residual + i * e.residual_stride + l);
      store(out, c0[i]), store(out + l, c1[i]);
    }
  } else {
    Vec<S> sums[static_cast<std::size_t>(2 * R)];
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) sums[2 * i] = c0[i], sums[2 * i + 1] = c1[i];
    put_narrow_result(sums, R, c, ldc, columns, e);
  }
  if (e.act != Activation::none) activate_rows<S>(c, ldc, R, std::min(columns, 2 * Index{l}), e.act, c, ldc);
}

/// What kind of tile: of A as it lies, of a transposed A, or of A as it lies times the first half of a panel only.
enum class TileKind { plain, transposed, half };

/// c (R x columns) = a (R x k) panel.
template <class S, int R, TileKind kind>
void tile(const Rows<S>& a, const S* panel, Index k, S* c, Index ldc, Index columns, const Epilogue<S>& e,
          Ahead ahead) {
  constexpr Index w = panel_width<S>;
  constexpr int l = lanes<S>;
  constexpr bool transposed = kind == TileKind::transposed, half = kind == TileKind::half;
  Vec<S> c0[R], c1[R];
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<S>{};
  fetch_result<S, R>(c, ldc, e);
  // Rows in groups of three behind five pointers: one address register each, the rest is addressing mode. One of the
  // strides is known to be 1, which saves additions (1 to 4 % of the time).
  const Index row_stride = transposed ? 1 : a.stride, depth_stride = transposed ? a.stride : 1;
  const S *p0 = a.at, *p1 = p0 + 3 * row_stride, *p2 = p0 + 6 * row_stride, *p3 = p0 + 9 * row_stride,
          *p4 = p0 + 12 * row_stride;
#pragma GCC unroll 2
  for (Index at = 0; at < k; ++at) {
    if constexpr (transposed) __builtin_prefetch(p0 + 16 * depth_stride);
    const Vec<S> b0 = load(panel), b1 = half ? Vec<S>{} : load(panel + l);
    panel += w;
    __builtin_prefetch(panel + 16 * w);
    __builtin_prefetch(panel + 16 * w + l);
    ahead.fetch();
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      const S x = i < 3    ? p0[i * row_stride]
                  : i < 6  ? p1[(i - 3) * row_stride]
                  : i < 9  ? p2[(i - 6) * row_stride]
                  : i < 12 ? p3[(i - 9) * row_stride]
                           : p4[(i - 12) * row_stride];
      c0[i] += x * b0;
      if constexpr (!half) c1[i] += x * b1;
    }
    p0 += depth_stride, p1 += depth_stride, p2 += depth_stride, p3 += depth_stride, p4 += depth_stride;
  }
  put_result<S, R>(c0, c1, c, ldc, columns, e);
}

template <class S>
using TileFunction = void (*)(const Rows<S>&, const S*, Index, S*, Index, Index, const Epilogue<S>&, Ahead);
/// The tile of so many rows for what is left of the columns.
template <class S>
TileFunction<S> tile_of(Index rows, bool transposed, Index columns) {
  static constexpr auto table = []<int... R>(std::integer_sequence<int, R...>) {
    return std::array{std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::plain>...},
                      std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::transposed>...},
                      std::array<TileFunction<S>, sizeof...(R)>{&tile<S, R + 1, TileKind::half>...}};
  }
  (std::make_integer_sequence<int, MOTIONLANG_TILE_ROWS>{});
  const TileKind kind = transposed ? TileKind::transposed : columns <= lanes<S> ? TileKind::half : TileKind::plain;
  return table[static_cast<std::size_t>(kind)][static_cast<std::size_t>(rows - 1)];
}

/// First row of part i of n nearly equal parts.
MOTIONLANG_INLINE Index part(Index rows, Index i, Index n) { return rows * i / n; }

/// How a product over k is split: pieces of k, and rows of A at a time.
template <class S>
struct Blocks {
  Index count, rows;

  explicit Blocks(Index k)
      : count(k == 0 ? 1 : (k + depth_block - 1) / depth_block),
        rows(rows_at_once(bytes<S>((k + count - 1) / count), tile_rows, half_cache)) {}
};
template <class S>
Index gemm_rows(Index k) {
  return Blocks<S>(k).rows;
}
/// Numbers of scratch that gemm_block needs.
template <class S>
Index gemm_scratch(Index k) {
  return Blocks<S>(k).rows / tile_rows * tile_pitch<S> * (std::min(k, depth_block) + 16);
}

/// `rows` rows of a transposed A (`depth` of k) tile by tile, [tile][k][row], so that a tile reads one line after the
/// other. `readable`: rows that A has from here on.
template <class S>
void copy_tiles(const S* a, Index lda, Index depth, Index rows, Index readable, S* out) {
  constexpr Index pitch = tile_pitch<S>, l = lanes<S>;
  const Index tiles = (rows + tile_rows - 1) / tile_rows;
  for (Index k = 0; k < depth; ++k, a += lda, out += pitch) {
    if (k + 16 < depth) fetch(a + 16 * lda, rows);  // no prefetcher follows pieces so far apart
    for (Index t = 0; t < tiles; ++t) {
      const Index first = part(rows, t, tiles);
      for (Index i = 0; i < pitch; i += l)
        store(out + t * depth * pitch + i, load_first(a + first + i, readable - first - i));
    }
  }
}

/// What is made at a time: of k the part k0 ... k1-1 of rows top ... below-1 times panels left ... right-1.
template <class S>
struct GemmPiece {
  static constexpr Index w = panel_width<S>;
  const Gemm<S>& g;
  S* scratch;
  bool copies, far;                   // rows of A are copied as they are; the result is larger than the nearer caches
  Index top = 0, below = 0, end = 0;  // end: of the rows that the thread goes on with
  Index left = 0, right = 0;
  Index k0 = 0, k1 = 0;
  // panels that are read after it: at last the first ones once more, if nothing else is known
  const std::byte* next = nullptr;
  Index next_bytes = std::numeric_limits<Index>::max();

  Index depth() const { return k1 - k0; }
  Index pitch() const { return depth() + 16; }
  const S* slice(Index panel) const { return g.panels + (panel * g.k + k0) * w; }

  Rows<S> rows_of(Index tile, Index row) const {
    if (g.a_transposed) return {scratch + tile * depth() * tile_pitch<S>, tile_pitch<S>, true};
    if (copies) return {scratch + (row - top) * pitch(), pitch(), false};
    return {g.a + row * g.lda + k0, g.lda, false};
  }
  void copy_rows(Index first, Index last) const {
    for (Index r = first; r < last; ++r) {
      std::memcpy(scratch + (r - top) * pitch(), g.a + r * g.lda + k0, static_cast<std::size_t>(bytes<S>(depth())));
    }
  }

  void multiply() const {
    const Index depth = this->depth(), tiles = (below - top + tile_rows - 1) / tile_rows;
    const bool whole = depth == g.k, transposed = g.a_transposed;
    const Index together = far && whole ? std::max<Index>(1, half_cache / std::max<Index>(1, bytes<S>(depth * w))) : 1;
    const Index groups = (right - left + together - 1) / together;
    // Rows that are copied: all at once if the result stays in the caches (3 % faster at 408 x 1024 x 512), else a
    // tile's when it is next.
    if (transposed)
      copy_tiles<S>(g.a + k0 * g.lda + top, g.lda, depth, below - top, g.m - top, scratch);
    else if (copies && !far)
      copy_rows(top, below);
    for (Index group = 0; group < groups; ++group) {
      const Index j0 = left + part(right - left, group, groups), j1 = left + part(right - left, group + 1, groups);
      const Index panels = j1 - j0, panel_bytes = bytes<S>(panels * depth * w);
      const std::byte* next_panels = j1 < right ? as_bytes(slice(j1)) : next;
      const Index next_panel_bytes = j1 < right ? panel_bytes : std::min(panel_bytes, next_bytes);
      for (Index t = 0, row = top, height; t < tiles; ++t, row += height) {
        height = top + part(below - top, t + 1, tiles) - row;
        const Index next_row = row + height;
        if (copies && far && group == 0) copy_rows(row, next_row);
        // With half of the first panels the next rows are fetched, if they lie together. (With one panel at a time:
        // none.)
        const bool fetches_rows = group == 0 && !transposed && g.lda <= g.k && next_row < end;
        const Index row_panels = fetches_rows ? panels / 2 : 0, rest = panels - row_panels;
        const Index next_row_bytes = bytes<S>(std::min(height, end - next_row) * g.lda);
        for (Index i = 0; i < panels; ++i) {
          const Index j = j0 + i, columns = g.n - j * w;
          const Ahead ahead =
              i < row_panels
                  ? Ahead::share(as_bytes(g.a + next_row * g.lda), next_row_bytes, i, row_panels, depth)
                  : Ahead::share(next_panels, next_panel_bytes, t * rest + i - row_panels, tiles * rest, depth);
          S* c = g.c + row * g.ldc + j * w;
          const auto e = Epilogue<S>::of(g, row, j * w, k0 == 0, k1 == g.k);
          tile_of<S>(height, transposed, columns)(rows_of(t, row), slice(j), depth, c, g.ldc, columns, e, ahead);
        }
      }
    }
  }
};

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product.
template <class S>
void gemm_block(const Gemm<S>& g, Index r0, Index r1, Index j0, Index j1, S* scratch) {
  const Blocks<S> split(g.k);
  const Index blocks = split.count, row_blocks = (r1 - r0 + split.rows - 1) / split.rows;
  // Rows of A whose distance is a multiple of the page size fall into the same cache set: they are copied side by side,
  // once.
  const bool copies = !g.a_transposed && bytes<S>(g.lda) % 4096 == 0;
  const bool all_panels = copies || g.a_transposed || blocks == 1;
  const Index wide = all_panels ? std::max<Index>(1, j1 - j0) : panel_block, pieces = (j1 - j0 + wide - 1) / wide;
  const bool far = bytes<S>(g.m * g.n) > near_caches;
  for (Index i = 0; i < row_blocks * pieces * blocks; ++i) {
    const Index row_block = i / blocks / pieces, left = j0 + i / blocks % pieces * wide, block = i % blocks;
    GemmPiece<S> piece{.g = g,
                       .scratch = scratch,
                       .copies = copies,
                       .far = far,
                       .top = r0 + part(r1 - r0, row_block, row_blocks),
                       .below = r0 + part(r1 - r0, row_block + 1, row_blocks),
                       .end = r1,
                       .left = left,
                       .right = std::min(j1, left + wide),
                       .k0 = part(g.k, block, blocks),
                       .k1 = part(g.k, block + 1, blocks)};
    const bool next_columns = block + 1 == blocks, next_rows = next_columns && piece.right == j1,
               last = next_rows && piece.below == r1;
    const S* next = g.panels + ((next_rows      ? j0
                                 : next_columns ? piece.right
                                                : left) *
                                    g.k +
                                (next_columns ? 0 : piece.k1)) *
                                   piece.w;
    piece.next = last ? g.following(j0, (g.n + piece.w - 1) / piece.w, next) : as_bytes(next);
    if (last && g.after != nullptr) piece.next_bytes = g.after_bytes;
    piece.multiply();
  }
}
//
// Attention of one head over one sequence, forward and backward. The score matrix exists for one tile of rows (forward)
// or one head (backward), never for a batch.
//
//   S = Q K^T / sqrt(width),   P = softmax(S),   O = P V
//   dV = P^T dO,   dP = dO V^T,   dS = P (dP - rowsum(P dP)),   dQ = dS K / sqrt(width),   dK = dS^T Q / sqrt(width)

/// Softmax of R rows of `n` scores times `scale`, in place; columns up to the next vector are set to 0.
/// `visible[i]` columns of row i take part (causal attention), the rest are 0. Several rows are as many chains of sums:
/// none waits.
template <class S, int R>
MOTIONLANG_INLINE void softmax_rows_at(S* rows, Index pitch, Index n, const Index* visible, S scale) {
  constexpr int l = lanes<S>;
  const Index padded = (n + l - 1) / l * l;
  constexpr S hidden = sizeof(S) == 4 ? S(-1e30) : S(-1e300);
  Vec<S> largest[R], sum[R], inverse[R];
  S shift[R];
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) {
    for (Index c = visible[i]; c < padded; ++c) rows[i * pitch + c] = hidden;
    largest[i] = splat(hidden), sum[i] = Vec<S>{};
  }
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) largest[i] = vmax<S>(largest[i], load(rows + i * pitch + c));
  }
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) shift[i] = reduce_max<S>(largest[i]) * scale;
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) {
      const Vec<S> e = vexp<S>(load(rows + i * pitch + c) * scale - shift[i]);
      store(rows + i * pitch + c, e);
      sum[i] += e;
    }
  }
#pragma GCC unroll 16
  for (int i = 0; i < R; ++i) inverse[i] = splat(S(1) / reduce_add<S>(sum[i]));
  for (Index c = 0; c < padded; c += l) {
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) store(rows + i * pitch + c, load(rows + i * pitch + c) * inverse[i]);
  }
}
inline constexpr int softmax_group = 4;  // of rows
/// The same for `count` rows, the first of which is query `first`; causal: row i sees keys up to its own number.
template <class S>
void softmax_rows_of(S* rows, Index pitch, Index count, Index n, Index first, bool causal, S scale) {
  for (Index r = 0; r < count;) {
    Index visible[softmax_group];
    for (int i = 0; i < softmax_group; ++i) visible[i] = causal ? std::min(n, first + r + i + 1) : n;
    if (r + softmax_group <= count)
      softmax_rows_at<S, softmax_group>(rows + r * pitch, pitch, n, visible, scale), r += softmax_group;
    else
      softmax_rows_at<S, 1>(rows + r * pitch, pitch, n, visible, scale), ++r;
  }
}

/// y = x times the factors of Dropout (core/dropout.hpp) at positions first, first + 1, ...; its own derivative.
template <class S>
void dropout(const S* x, Index n, Index first, const Dropout& d, S* y) {
  typedef std::uint32_t Bits __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
  constexpr Index l = MOTIONLANG_VECTOR_BYTES / 4;
  const std::uint32_t limit = d.limit();
  const auto key0 = static_cast<std::uint32_t>(d.key) + static_cast<std::uint32_t>(first >> 32) * 0x27D4EB2Fu;
  const auto key1 = static_cast<std::uint32_t>(d.key >> 32);
  const S keep = static_cast<S>(1.0 / (1.0 - d.p));
  Bits counter;
  for (Index i = 0; i < l; ++i) counter[i] = static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(i);
  for (Index i = 0; i < n; i += l, counter += static_cast<std::uint32_t>(l)) {
    Bits h = counter * 0x9E3779B1u + key0;
    h = (h ^ (h >> 16)) * 0x85EBCA6Bu + key1;
    h = (h ^ (h >> 13)) * 0xC2B2AE35u;
    h = h ^ (h >> 16);
    if (sizeof(S) == 4 && i + l <= n) {
      const Vec<S> kept = load(x + i) * keep;
      store(y + i, (Mask<S>)(h >= limit) ? kept : Vec<S>{});
    } else {
      for (Index c = 0; c < l && i + c < n; ++c) y[i + c] = h[c] >= limit ? x[i + c] * keep : S(0);
    }
  }
}

template <class S>
MOTIONLANG_INLINE Index padded_panels(Index n) {
  return (n + panel_width<S> - 1) / panel_width<S>;
}

/// The products of attention in S. (Bf16Products is the other kind.)
template <class S>
struct FloatProducts {
  using Number = S;
  static constexpr Index rows = tile_rows;  // that products are fastest with
  static void begin() {}
  static void end() {}
  /// Columns that products write of n.
  static Index columns(Index n) { return padded_panels<S>(n) * panel_width<S>; }
  /// Numbers of scratch: panels of a matrix (k, n), and what a product over k needs.
  static Index panels(Index k, Index n) { return columns(n) * k; }
  static Index scratch(Index) { return 0; }

  static void pack(const S* b, Index k, Index n, Index stride_k, Index stride_n, S* panels) {
    if (stride_n == 1)
      pack_rows(b, k, n, stride_k, Index{0}, k, panels);
    else
      pack_transposed<S, false>(b, k, n, stride_n, Index{0}, padded_panels<S>(n), panels);
  }
  /// c = a panels, tile by tile, without blocks of k (all operands are in cache).
  static void multiply(const Rows<S>& a, Index count, Index k, const S* panels, Index n, S* c, Index ldc, S*,
                       bool whole_panels) {
    constexpr Index w = panel_width<S>;
    const Index tiles = (count + tile_rows - 1) / tile_rows;
    const Epilogue<S> plain;
    for (Index j = 0; j < padded_panels<S>(n); ++j) {
      for (Index t = 0; t < tiles; ++t) {
        const Index first = part(count, t, tiles), height = part(count, t + 1, tiles) - first;
        tile_of<S>(height, a.transposed, n - j * w)(a.from(first), panels + j * k * w, k, c + first * ldc + j * w, ldc,
                                                    whole_panels ? w : n - j * w, plain, Ahead{as_bytes(panels)});
      }
    }
  }
};

/// One head over one sequence: where its rows begin. Rows of q, k, v have the strides of the tensors that they are
/// columns of.
template <class S>
struct AttentionHead {
  const Attention<S>& t;
  Index head, q0, k0, queries, keys;
  const S *q, *k, *v;

  AttentionHead(const Attention<S>& a, Index sequence, Index head_number)
      : t(a),
        head(head_number),
        q0(a.q_offsets[sequence]),
        k0(a.k_offsets[sequence]),
        queries(a.q_offsets[sequence + 1] - q0),
        keys(a.k_offsets[sequence + 1] - k0),
        q(a.q + q0 * a.q_stride + head * a.width),
        k(a.k + k0 * a.k_stride + head * a.width),
        v(a.v + k0 * a.v_stride + head * a.width) {}

  S scale() const { return S(1) / std::sqrt(static_cast<S>(t.width)); }
  /// Scores of `count` queries from `first` on, q k^T, become their rows of P: relative scores, softmax, dropout.
  void weights(Index first, Index count, S* rows, Index pitch) const {
    const S unscale = std::sqrt(static_cast<S>(t.width));
    for (Index r = 0; r < count && t.relative_scores != nullptr; ++r) {
      const S* relative = t.relative_scores + head * (2 * t.reach + 1) + t.reach - (first + r);
      for (Index c = 0; c < keys; ++c) rows[r * pitch + c] += relative[c] * unscale;
    }
    softmax_rows_of(rows, pitch, count, keys, first, t.causal, scale());
    for (Index r = 0; r < count && t.dropout.p > 0; ++r)
      dropout(rows + r * pitch, keys, mask_at(first + r), t.dropout, rows + r * pitch);
  }
  Index mask_at(Index query) const {
    return static_cast<Index>(Dropout::attention_position(q0 + query, t.heads, head, 0));
  }
};

/// Distance of rows of scores, whose columns up to the end of a panel are written.
template <class P>
Index score_pitch(Index keys) {
  return P::columns(keys) + 16;
}
/// Numbers of scratch that attention_head needs: K^T, V, and one tile of scores.
template <class P>
Index attention_scratch(Index keys, Index width) {
  return P::panels(width, keys) + P::panels(keys, width) + P::rows * score_pitch<P>(keys) +
         P::scratch(std::max(keys, width));
}
/// Numbers of scratch that attention_head_vjp needs, whose scores are those of all queries.
template <class P>
Index attention_vjp_scratch(Index queries, Index keys, Index width) {
  const Index longest = std::max(keys, queries);
  return P::panels(width, keys) + P::panels(longest, width) + 2 * queries * score_pitch<P>(keys) +
         P::scratch(std::max(longest, width));
}

/// Output of one head, for one of so many pieces of its queries.
template <class P, class S = typename P::Number>
void attention_head(const Attention<S>& t, Index sequence, Index head, Index piece, Index pieces, S* kt) {
  const AttentionHead<S> h(t, sequence, head);
  const Index tiles = (h.queries + P::rows - 1) / P::rows, begin = part(tiles, piece, pieces),
              end = part(tiles, piece + 1, pieces);
  if (begin == end) return;
  const Index pitch = score_pitch<P>(h.keys);
  S* vp = kt + P::panels(t.width, h.keys);
  S* scores = vp + P::panels(h.keys, t.width);
  S* scratch = scores + P::rows * pitch;
  S* o = t.o + h.q0 * t.o_stride + head * t.width;
  P::pack(h.k, t.width, h.keys, Index{1}, t.k_stride, kt);  // K^T
  P::pack(h.v, h.keys, t.width, t.v_stride, Index{1}, vp);
  P::begin();
  for (Index i = begin; i < end; ++i) {
    const Index first = part(h.queries, i, tiles), rows = part(h.queries, i + 1, tiles) - first;
    P::multiply({h.q + first * t.q_stride, t.q_stride, false}, rows, t.width, kt, h.keys, scores, pitch, scratch, true);
    h.weights(first, rows, scores, pitch);
    P::multiply({scores, pitch, false}, rows, h.keys, vp, t.width, o + first * t.o_stride, t.o_stride, scratch, false);
  }
  P::end();
}

/// Gradients of one head; dq, dk, dv are written, with the strides of q, k, v.
template <class P, class S = typename P::Number>
void attention_head_vjp(const Attention<S>& t, const AttentionGradients<S>& g, Index sequence, Index head, S* a) {
  constexpr int l = lanes<S>;
  const AttentionHead<S> h(t, sequence, head);
  const Index queries = h.queries, keys = h.keys, width = t.width, pitch = score_pitch<P>(keys);
  const S* d_o = g.d_o + h.q0 * t.o_stride + head * width;
  const S scale = h.scale();
  S* b = a + P::panels(width, keys);  // panels with the keys or queries as the summed index; a: K^T, then V^T
  S* p = b + P::panels(std::max(keys, queries), width);  // P, later P after dropout
  S* ds = p + queries * pitch;                           // dP, later dS
  S* scratch = ds + queries * pitch;
  P::begin();
  P::pack(h.k, width, keys, Index{1}, t.k_stride, a);
  P::multiply({h.q, t.q_stride, false}, queries, width, a, keys, p, pitch, scratch, true);
  P::pack(h.v, width, keys, Index{1}, t.v_stride, a);
  P::multiply({d_o, t.o_stride, false}, queries, width, a, keys, ds, pitch, scratch, true);
  for (Index r = 0; r < queries; ++r) {
    S *pr = p + r * pitch, *dr = ds + r * pitch;
    if (r % softmax_group == 0)
      softmax_rows_of(pr, pitch, std::min<Index>(softmax_group, queries - r), keys, r, t.causal, scale);
    if (t.dropout.p > 0) dropout(dr, keys, h.mask_at(r), t.dropout, dr);
    Vec<S> sum{};
    for (Index c = 0; c < keys; c += l) sum += load(pr + c) * load(dr + c);  // P is 0 beyond the keys
    const S mean = reduce_add<S>(sum);
    for (Index c = 0; c < keys; c += l) store(dr + c, load(pr + c) * (load(dr + c) - mean) * scale);
    if (t.dropout.p > 0) dropout(pr, keys, h.mask_at(r), t.dropout, pr);
  }
  S* dq = g.d_q + h.q0 * t.q_stride + head * width;
  S* dk = g.d_k + h.k0 * t.k_stride + head * width;
  S* dv = g.d_v + h.k0 * t.v_stride + head * width;
  P::pack(h.k, keys, width, t.k_stride, Index{1}, b);
  P::multiply({ds, pitch, false}, queries, keys, b, width, dq, t.q_stride, scratch, false);
  P::pack(h.q, queries, width, t.q_stride, Index{1}, b);
  P::multiply({ds, pitch, true}, keys, queries, b, width, dk, t.k_stride, scratch, false);
  P::pack(d_o, queries, width, t.o_stride, Index{1}, b);
  P::multiply({p, pitch, true}, keys, queries, b, width, dv, t.v_stride, scratch, false);
  P::end();
}
//
// Row-wise and element-wise kernels: layer norm, softmax, nonlinearities, sums, AdamW.

inline constexpr int norm_group = 4;  // rows at a time in layer norm
/// Means and 1 / sqrt(variance + eps) of R rows of n, side by side. Two passes: no cancellation. Several rows are as
/// many chains of sums: none waits.
template <class S, int R>
MOTIONLANG_INLINE void row_moments(const S* x, Index n, S eps, S* mean, S* rstd) {
  constexpr int l = lanes<S>;
  const Index whole = n / l * l;
  Vec<S> sum[R], square[R];
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) sum[r] = square[r] = Vec<S>{};
  for (Index i = 0; i < whole; i += l) {
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) sum[r] += load(x + r * n + i);
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    S total = reduce_add<S>(sum[r]);
    for (Index i = whole; i < n; ++i) total += x[r * n + i];
    mean[r] = total / static_cast<S>(n);
  }
  for (Index i = 0; i < whole; i += l) {
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> d = load(x + r * n + i) - mean[r];
      square[r] += d * d;
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    S variance = reduce_add<S>(square[r]);
    for (Index i = whole; i < n; ++i) variance += (x[r * n + i] - mean[r]) * (x[r * n + i] - mean[r]);
    rstd[r] = S(1) / std::sqrt(variance / static_cast<S>(n) + eps);
  }
}

/// layer_norm_rows of R rows.
template <class S, int R>
MOTIONLANG_INLINE void normalize_rows(const LayerNorm<S>& t, Index first) {
  constexpr int l = lanes<S>;
  const Index n = t.width, whole = n / l * l;
  const S* x = t.x + first * n;
  S* y = t.y + first * n;
  if (t.residual != nullptr) {
    const S* z = t.residual + first * n;
    for (Index i = 0; i < R * n; i += l)
      store_first(y + i, load_first(x + i, R * n - i) + load_first(z + i, R * n - i), R * n - i);
    x = y;
  }
  S mean[R], rstd[R];
  row_moments<S, R>(x, n, t.eps, mean, rstd);
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i), bias = load(t.bias + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      __builtin_prefetch(x + (R + r) * n + i);  // of the next rows
      store(y + r * n + i, (load(x + r * n + i) - mean[r]) * rstd[r] * weight + bias);
    }
  }
  for (Index i = whole; i < n; ++i) {
    for (int r = 0; r < R; ++r) y[r * n + i] = (x[r * n + i] - mean[r]) * rstd[r] * t.weight[i] + t.bias[i];
  }
}
/// y = (x + residual - mean) rstd weight + bias. The sum stands in y before it is normalized; there may be no residual.
template <class S>
void layer_norm_rows(const LayerNorm<S>& t, Index first, Index last) {
  for (; first + norm_group <= last; first += norm_group) normalize_rows<S, norm_group>(t, first);
  for (; first < last; ++first) normalize_rows<S, 1>(t, first);
}

/// layer_norm_rows_vjp of R rows.
template <class S, int R>
MOTIONLANG_INLINE void normalize_rows_vjp(const LayerNorm<S>& t, const S* dy, S* dx, S* moments, Index first) {
  constexpr int l = lanes<S>;
  const Index n = t.width, whole = n / l * l;
  const S *x = t.x + first * n, *g = dy + first * n;
  S* d = dx + first * n;
  S mean[R], rstd[R], h0[R], h1[R];
  row_moments<S, R>(x, n, t.eps, mean, rstd);
  Vec<S> sum_h[R], sum_hx[R];
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) sum_h[r] = sum_hx[r] = Vec<S>{};
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> h = load(g + r * n + i) * weight;
      sum_h[r] += h;
      sum_hx[r] += h * ((load(x + r * n + i) - mean[r]) * rstd[r]);
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r) {
    h0[r] = reduce_add<S>(sum_h[r]), h1[r] = reduce_add<S>(sum_hx[r]);
    for (Index i = whole; i < n; ++i) {
      const S h = g[r * n + i] * t.weight[i];
      h0[r] += h;
      h1[r] += h * ((x[r * n + i] - mean[r]) * rstd[r]);
    }
    h0[r] /= static_cast<S>(n);
    h1[r] /= static_cast<S>(n);
  }
  for (Index i = 0; i < whole; i += l) {
    const Vec<S> weight = load(t.weight + i);
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const Vec<S> xhat = (load(x + r * n + i) - mean[r]) * rstd[r];
      store(d + r * n + i, (load(g + r * n + i) * weight - h0[r] - xhat * h1[r]) * rstd[r]);
    }
  }
  for (int r = 0; r < R; ++r) {
    for (Index i = whole; i < n; ++i) {
      d[r * n + i] = (g[r * n + i] * t.weight[i] - h0[r] - (x[r * n + i] - mean[r]) * rstd[r] * h1[r]) * rstd[r];
    }
    moments[2 * (first + r)] = mean[r], moments[2 * (first + r) + 1] = rstd[r];
  }
}
/// dx = rstd (h - mean(h) - xhat mean(h xhat)),  h = dy weight,  xhat = (x - mean) rstd
template <class S>
void layer_norm_rows_vjp(const LayerNorm<S>& t, const S* dy, S* dx, S* moments, Index first, Index last) {
  for (; first + norm_group <= last; first += norm_group) normalize_rows_vjp<S, norm_group>(t, dy, dx, moments, first);
  for (; first < last; ++first) normalize_rows_vjp<S, 1>(t, dy, dx, moments, first);
}
/// dweight = sum over rows of dy xhat, dbias = sum of dy; columns first ... last-1.
template <class S>
void layer_norm_columns_vjp(const LayerNorm<S>& t, const S* dy, const S* moments, S* dweight, S* dbias, Index rows,
                            Index first, Index last) {
  for (Index i = first; i < last; ++i) dweight[i] = dbias[i] = S(0);
  for (Index r = 0; r < rows; ++r) {
    const S mean = moments[2 * r], rstd = moments[2 * r + 1];
    const S *x = t.x + r * t.width, *g = dy + r * t.width;
    for (Index i = first; i < last; ++i) {
      dweight[i] += g[i] * ((x[i] - mean) * rstd);
      dbias[i] += g[i];
    }
  }
}

/// y = softmax(x) for rows of n; `scratch` holds one row, rounded up to whole vectors.
template <class S>
void softmax_rows(const S* x, Index n, Index first, Index last, S* y, S* scratch) {
  for (Index r = first; r < last; ++r) {
    std::memcpy(scratch, x + r * n, static_cast<std::size_t>(n) * sizeof(S));
    softmax_rows_at<S, 1>(scratch, n, n, &n, S(1));
    std::memcpy(y + r * n, scratch, static_cast<std::size_t>(n) * sizeof(S));
  }
}

/// Columns first ... last-1 of y; first is a multiple of `lanes`.
template <class S>
void transpose(const Transposed<S>& t, Index first, Index last) {
  constexpr Index l = lanes<S>;
  for (Index j = first; j < last; j += l) {
    const Index n = std::min(l, last - j);
    const bool whole = n == l;
    const Vec<S> bias = t.bias == nullptr ? Vec<S>{} : load_some(t.bias + j, n);
    for (Index r = 0; r < t.rows; ++r) {
      const S* z = t.z + j * t.rows + r;
      const S* residual = t.residual == nullptr ? nullptr : t.residual + r * t.width + j;
      S* y = t.y + r * t.width + j;
      Vec<S> x{};
      if (whole) {
#pragma GCC unroll 16
        for (int i = 0; i < lanes<S>; ++i) x[i] = z[i * t.rows];
        x += bias;
        if (residual != nullptr) x += load(residual);
        store(y, x);
      } else {
        for (Index i = 0; i < n; ++i) x[i] = z[i * t.rows];
        x += bias;
        if (residual != nullptr) x += load_some(residual, n);
        store_some(y, x, n);
      }
    }
    if (t.act != Activation::none) activate_rows(t.y + j, t.width, t.rows, n, t.act, t.y + j, t.width);
  }
}

template <BinaryOp op, class S>
MOTIONLANG_INLINE Vec<S> apply_binary(const Vec<S>& a, const Vec<S>& b) {
  switch (op) {
    case BinaryOp::add:
      return a + b;
    case BinaryOp::sub:
      return a - b;
    case BinaryOp::mul:
      return a * b;
    case BinaryOp::div:
      return a / b;
    case BinaryOp::maximum:
      return a < b ? b : a;
  }
  return a;
}
/// A repeated operand is read again and again from one vector of copies.
template <BinaryOp op, class S>
MOTIONLANG_INLINE void binary_loop(const Binary<S>& t) {
  constexpr int l = lanes<S>;
  const Vec<S> copies_a = splat(*t.a), copies_b = splat(*t.b);
  const S *a = t.a_repeated ? reinterpret_cast<const S*>(&copies_a) : t.a,
          *b = t.b_repeated ? reinterpret_cast<const S*>(&copies_b) : t.b;
  const Index step_a = t.a_repeated ? 0 : l, step_b = t.b_repeated ? 0 : l;
  Index i = 0;
  for (; i + l <= t.count; i += l, a += step_a, b += step_b) store(t.y + i, apply_binary<op, S>(load(a), load(b)));
  const Index n = t.count - i;
  store_some(t.y + i, apply_binary<op, S>(load_some(a, n), load_some(b, n)), n);
}
template <class S>
void binary(const Binary<S>& t) {
  switch (t.op) {
    case BinaryOp::add:
      return binary_loop<BinaryOp::add>(t);
    case BinaryOp::sub:
      return binary_loop<BinaryOp::sub>(t);
    case BinaryOp::mul:
      return binary_loop<BinaryOp::mul>(t);
    case BinaryOp::div:
      return binary_loop<BinaryOp::div>(t);
    case BinaryOp::maximum:
      return binary_loop<BinaryOp::maximum>(t);
  }
}

template <class S>
void error_function(const S* x, Index n, S* y) {
  constexpr int l = lanes<S>;
  Index i = 0;
  for (; i + l <= n; i += l) store(y + i, verf<S>(load(x + i)));
  store_some(y + i, verf<S>(load_some(x + i, n - i)), n - i);
}

/// Sums of the rows first ... last-1, of n numbers each. Four chains of sums: none waits.
template <class S>
void row_sums(const S* x, Index n, Index first, Index last, S* y) {
  constexpr int l = lanes<S>;
  for (Index r = first; r < last; ++r) {
    const S* row = x + r * n;
    Vec<S> sums[4] = {};
    Index i = 0;
    for (; i + 4 * l <= n; i += 4 * l) {
#pragma GCC unroll 4
      for (int c = 0; c < 4; ++c) sums[c] += load(row + i + c * l);
    }
    for (; i < n; i += l) sums[0] += load_first(row + i, n - i);
    y[r] = reduce_add<S>(sums[0] + sums[1] + (sums[2] + sums[3]));
  }
}
/// Sums of the columns first ... last-1 over all rows.
template <class S>
void column_sums(const S* x, Index rows, Index width, Index first, Index last, S* y) {
  for (Index i = first; i < last; ++i) y[i] = S(0);
  for (Index r = 0; r < rows; ++r) {
    for (Index i = first; i < last; ++i) y[i] += x[r * width + i];
  }
}

template <class S>
MOTIONLANG_INLINE Vec<S> adamw_update(const AdamwStep<S>& t, const Vec<S>& p, const Vec<S>& gradient, Vec<S>& m,
                                      Vec<S>& v) {
  const Vec<S> g = gradient * t.gradient_scale;
  m = m * t.beta1 + g * t.rest1;
  v = v * t.beta2 + g * g * t.rest2;
  return p * t.decay - t.step * m / (vsqrt<S>(v) * t.correction + t.eps);
}
/// AdamW in one pass over parameter, gradient and moments (see optim/adamw.hpp for the formula).
template <class S>
void adamw(const AdamwStep<S>& t, Index first, Index last) {
  constexpr int l = lanes<S>;
  Index i = first;
  for (; i + l <= last; i += l) {
    Vec<S> m = load(t.m + i), v = load(t.v + i);
    store(t.p + i, adamw_update<S>(t, load(t.p + i), load(t.g + i), m, v));
    store(t.m + i, m), store(t.v + i, v);
  }
  const Index n = last - i;
  Vec<S> m = load_some(t.m + i, n), v = load_some(t.v + i, n);
  store_some(t.p + i, adamw_update<S>(t, load_some(t.p + i, n), load_some(t.g + i, n), m, v), n);
  store_some(t.m + i, m, n), store_some(t.v + i, v, n);
}

#define MOTIONLANG_STRING_OF(x) #x
#define MOTIONLANG_STRING(x) MOTIONLANG_STRING_OF(x)

// Matrix product in bfloat16 with sums in float. Three tiles, one text around them: this file has the tile for any
// processor, which widens bfloat16 to float; bf16_x86.inc has those for vdpbf16ps and for AMX.
//
//   Panels   B (k x n) is rounded and stored in panels of 32 columns, pairs of k side by side: [panel][k /
//            2][column][2], zero padded to a multiple of 32 in k. The same for all tiles, but for numbers below 2^-126,
//            which some round to 0.
//   Rows     A is rounded into scratch, a block of rows at a time, zero padded in k: [row][k].
//   Tile     some rows of A times one panel, over k filled up to as many as its instructions take at a time (in pieces
//            of k, if the tile has pieces); what to do with the sums, as in gemm.inc. (In AMX the bias is the first
//            number of a sum.)
//   Order    every element is summed over k in an order that depends on the tile alone: same bits for any block or
//            thread.

typedef std::uint32_t Words __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES)));
typedef std::uint32_t LooseWords __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES), aligned(2), may_alias));
typedef std::uint16_t Halves __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES / 2)));
typedef std::uint16_t LooseHalves __attribute__((vector_size(MOTIONLANG_VECTOR_BYTES / 2), aligned(2), may_alias));
inline constexpr Index word_lanes = MOTIONLANG_VECTOR_BYTES / 4;

/// The nearest bfloat16, ties to even, in the upper half of each word; NaN stays NaN.
MOTIONLANG_INLINE Words round_to_bf16(const Vec<float>& x) {
  const Words w = (Words)x, rounded = w + (w >> 16 & 1u) + 0x7FFFu;
  return ((w & 0x7FFFFFFFu) > 0x7F800000u ? w | 0x400000u : rounded) & 0xFFFF0000u;
}
MOTIONLANG_INLINE void store_rounded(float* y, const Words& w) { store(y, (Vec<float>)w); }
MOTIONLANG_INLINE void store_rounded(std::uint16_t* y, const Words& w) {
  *reinterpret_cast<LooseHalves*>(y) = __builtin_convertvector(w >> 16, Halves);
}

/// A vector of numbers, rounded; zeros from the n-th on.
MOTIONLANG_INLINE Words rounded(const float* x, Index n) { return round_to_bf16(load_first(x, n)); }
/// Of two vectors of rounded numbers: pairs of bfloat16.
MOTIONLANG_INLINE Words pairs(const Words& first, const Words& second) { return first >> 16 | second; }
MOTIONLANG_INLINE void store_words(std::uint16_t* y, const Words& w) { *reinterpret_cast<LooseWords*>(y) = w; }

/// The same as round_row of a tile (but for numbers below 2^-126) for `rows` rows whose numbers are a[k * lda + row]:
/// squares of lanes are transposed.
template <class Element>
void round_columns(const float* a, Index lda, Index rows, Index k, Index padded, Element* y, Index pitch) {
  constexpr Index l = word_lanes, depth = l * (4 / static_cast<Index>(sizeof(Element)));  // of a square
  for (Index r = 0; r < rows; r += l) {
    const Index n = std::min(rows - r, l);
    for (Index i = 0; i < padded; i += depth) {
      Vec<float> square[lanes<float>];
#pragma GCC unroll 16
      for (int q = 0; q < lanes<float>; ++q) {
        const auto row = [&](Index at) {
          // no prefetcher follows pieces so far apart
          if (at + depth < k) __builtin_prefetch(a + (at + depth) * lda + r);
          return rounded(a + at * lda + r, at < k ? n : 0);
        };
        if constexpr (sizeof(Element) == 4) {
          square[q] = (Vec<float>)row(i + q);
        } else {
          square[q] = (Vec<float>)pairs(row(i + 2 * q), row(i + 2 * q + 1));
        }
      }
      transpose_lanes<float>(square);
      for (Index c = 0; c < n; ++c) std::memcpy(y + (r + c) * pitch + i, &square[c], sizeof square[c]);
    }
  }
}

/// Rows k0 ... k1-1 (both even) of all panels of B, whose element (k, n) is b[k * stride + n]: two rows at a
/// time, through as many panels as lie in different parts of the cache.
template <class Tile>
void bf16_pack_rows(const float* b, Index k, Index n, Index stride, Index k0, Index k1, std::uint16_t* panels) {
  constexpr Index ahead = 8;  // rows
  const Index depth = bf16_depth(k), count = (n + bf16_columns - 1) / bf16_columns;
  for (Index left = 0; left < count; left += panel_block) {
    for (Index i = k0; i < k1; i += 2) {
      const float *even = b + i * stride + left * bf16_columns, *odd = even + stride;
      std::uint16_t* out = panels + (left * depth + i) * bf16_columns;
      for (Index j = left; j < std::min(count, left + panel_block);
           ++j, even += bf16_columns, odd += bf16_columns, out += depth * bf16_columns) {
        fetch(even + ahead * stride, bf16_columns), fetch(odd + ahead * stride, bf16_columns);
        const Index columns = n - j * bf16_columns;
        Tile::round_pairs(even, i < k ? columns : 0, odd, i + 1 < k ? columns : 0, out);
      }
    }
  }
}
/// Panels first ... last-1 of B, whose element (k, n) is b[k + n * stride]: read along its rows, a square of lanes at a
/// time. Whether all numbers are finite, if it looks.
template <class Tile, bool looks>
bool bf16_pack_transposed(const float* b, Index k, Index n, Index stride, Index first, Index last,
                          std::uint16_t* panels) {
  constexpr Index l = word_lanes, block = 256, pitch = block + 32;  // of k that are rounded at once
  const Index depth = bf16_depth(k);
  std::uint16_t lines[static_cast<std::size_t>(bf16_columns * pitch)];  // columns of B: [column][k]
  Mask<float> found{};
  for (Index j = first; j < last; ++j) {
    std::uint16_t* out = panels + j * depth * bf16_columns;
    const float* in = b + j * bf16_columns * stride;
    const Index columns = n - j * bf16_columns;
    for (Index i0 = 0; i0 < depth; i0 += block) {
      const Index length = std::min(block, depth - i0);
      for (Index c = 0; c < bf16_columns; ++c) {
        const float* row = in + c * stride + i0;
        const Index there = c < columns ? std::min(k - i0, length) : 0;
        if constexpr (looks) {
          for (Index i = 0; i < there; i += lanes<float>) find_not_finite<float>(load_first(row + i, there - i), found);
        }
        Tile::round_row(row, there, length, lines + c * pitch);
      }
      for (Index i = 0; i < length; i += 2 * l, out += 2 * l * bf16_columns) {
        for (Index c = 0; c < bf16_columns; c += l) {
          Vec<float> square[lanes<float>];  // column, pair
#pragma GCC unroll 16
          for (int q = 0; q < lanes<float>; ++q) std::memcpy(&square[q], lines + (c + q) * pitch + i, sizeof square[q]);
          transpose_lanes<float>(square);
          for (Index p = 0; p < l; ++p) std::memcpy(out + (p * bf16_columns + c) * 2, &square[p], sizeof square[p]);
        }
      }
    }
  }
  return !any_negative<float>(found);
}

/// Bytes of a pair of k in a panel.
inline constexpr Index pair_bytes = 4 * bf16_columns;

/// True if a tile's rows of the result, which are whole lines, are better written past the caches: the caches would
/// read every line before it is overwritten, and forget other things. So for results larger than all of them, and for
/// those larger than the nearer ones whose rows are a multiple of the page size apart: a tile's rows then fall into the
/// same cache set.
inline bool streams(const Gemm<float>& g) {
  constexpr Index all = 16 << 20;
  const bool whole_lines =
      g.n % bf16_columns == 0 && bytes<float>(g.ldc) % 64 == 0 && reinterpret_cast<std::uintptr_t>(g.c) % 64 == 0;
  return whole_lines && bytes<float>(g.m * g.n) > (bytes<float>(g.ldc) % 4096 == 0 ? near_caches : all);
}
/// Rows of one panel's width, from where a tile has put them.
inline void stream_rows(const float* from, Index rows, float* to, Index ldc) {
  for (Index r = 0; r < rows; ++r, from += bf16_columns, to += ldc) {
    for (Index i = 0; i < bf16_columns; i += lanes<float>) store_stream(to + i, load(from + i));
  }
}

class PanelSplit;

/// What a tile is asked for: c = `height` rows of A, which begin at a, times the first `columns` columns of a panel,
/// over `depth` of k.
template <class Element>
struct TileProduct {
  const Element* a;
  Index pitch, height;
  const std::uint16_t* panel;
  Index depth;
  float* c;
  Index ldc, columns;
  Epilogue<float> e{};
  Ahead ahead{};
  bool panel_stays = true;         // in the cache, for the next tile; else the rows stay
  bool stream = false;             // c is written past the caches
  Index number = 0;                // of the tile among those of this panel
  bool first = true, last = true;  // piece of k
  PanelSplit* next = nullptr;      // of floats in parts: the panel that is split meanwhile
};

/// Tiles that keep their sums in registers: Tile::rows_of<height> does it all. Every tile has besides
///     round_row(x, n, padded, y)       y = n numbers, rounded, then zeros up to `padded`, a multiple of 32
///     round_pairs(x, nx, y, ny, pairs) 32 pairs, rounded: numbers of x (zeros after nx), beside each its like of y
template <class Tile>
struct RegisterTile {
  static constexpr bool even = true;                                 // rows are split evenly among tiles
  static constexpr Index depth(Index k) { return (k + 1) / 2 * 2; }  // that is multiplied, of the padded one
  static constexpr Index pieces(Index, Index) { return 1; }          // of k
  static void begin() {}
  static void end() {}

  template <class Element>
  void multiply(const TileProduct<Element>& t) {
    static constexpr auto table = []<int... R>(std::integer_sequence<int, R...>) {
      return std::array{&Tile::template rows_of<R + 1>...};
    }
    (std::make_integer_sequence<int, Tile::rows>{});
    const auto rows_of = table[static_cast<std::size_t>(t.height - 1)];
    if (!t.stream) return rows_of(t.a, t.pitch, t.panel, t.depth, t.c, t.ldc, t.columns, t.e, t.ahead);
    alignas(64) float result[static_cast<std::size_t>(Tile::rows * bf16_columns)];
    rows_of(t.a, t.pitch, t.panel, t.depth, result, bf16_columns, t.columns, t.e, t.ahead);
    stream_rows(result, t.height, t.c, t.ldc);
  }
  void finish() {}
};

/// For any processor: rows of A are kept as rounded floats, a pair of B is split into two vectors of floats.
struct WideningTile : RegisterTile<WideningTile> {
  using Element = float;
  static constexpr const char* name = MOTIONLANG_STRING(MOTIONLANG_ISA);
  static constexpr int rows = MOTIONLANG_TILE_ROWS > 2 ? MOTIONLANG_TILE_ROWS - 2 : 2;
  template <class Number>
  static void round_row(const float* x, Index n, Index padded, Number* y) {
    for (Index i = 0; i < padded; i += word_lanes) store_rounded(y + i, rounded(x + i, n - i));
  }
  static void round_pairs(const float* x, Index nx, const float* y, Index ny, std::uint16_t* out) {
    for (Index c = 0; c < bf16_columns; c += word_lanes) {
      store_words(out + 2 * c, pairs(rounded(x + c, nx - c), rounded(y + c, ny - c)));
    }
  }

  template <int R>
  static void rows_of(const Element* a, Index pitch, const std::uint16_t* panel, Index depth, float* c, Index ldc,
                      Index columns, const Epilogue<float>& e, Ahead ahead) {
    constexpr int l = lanes<float>;
    for (Index column = 0; column < columns; column += 2 * l) {
      const Epilogue<float> piece = e.from_column(column);
      fetch_result<float, R>(c + column, ldc, piece);
      if (column > 0) ahead.step = 0;  // once is enough
      Vec<float> c0[R], c1[R];
#pragma GCC unroll 16
      for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<float>{};
      const std::uint16_t* b = panel + 2 * column;
      for (Index k = 0; k < depth; k += 2, b += 2 * bf16_columns) {
        ahead.fetch();
        const Words w0 = *reinterpret_cast<const LooseWords*>(b), w1 = *reinterpret_cast<const LooseWords*>(b + 2 * l);
        const Vec<float> even0 = (Vec<float>)(w0 << 16), odd0 = (Vec<float>)(w0 & 0xFFFF0000u);
        const Vec<float> even1 = (Vec<float>)(w1 << 16), odd1 = (Vec<float>)(w1 & 0xFFFF0000u);
#pragma GCC unroll 16
        for (int i = 0; i < R; ++i) {
          const float x = a[i * pitch + k], y = a[i * pitch + k + 1];
          c0[i] += x * even0;
          c1[i] += x * even1;
          c0[i] += y * odd0;
          c1[i] += y * odd1;
        }
      }
      put_result<float, R>(c0, c1, c + column, ldc, columns - column, piece);
    }
  }
};

/// The first `count` rows of A, side by side.
template <class Tile>
void round_rows(const Rows<float>& a, Index count, Index k, Index depth, typename Tile::Element* y, Index pitch) {
  if (a.transposed) return round_columns(a.at, a.stride, count, k, depth, y, pitch);
  for (Index r = 0; r < count; ++r) Tile::round_row(a.from(r).at, k, depth, y + r * pitch);
}

/// Rows of A in scratch at once, and their distance.
template <class Tile>
Index bf16_rows(Index k) {
  return rows_at_once(bytes<typename Tile::Element>(bf16_depth(k)), Tile::rows, half_cache / 2 * 3);
}
template <class Tile>
constexpr Index bf16_pitch(Index depth) {
  return depth + 64 / static_cast<Index>(sizeof(typename Tile::Element));
}
/// Numbers of scratch that bf16_gemm_block needs.
template <class Tile>
Index bf16_scratch(Index k) {
  return bf16_rows<Tile>(k) * bf16_pitch<Tile>(bf16_depth(k));
}

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product with bfloat16 panels.
template <class Tile>
void bf16_gemm_block(const Gemm<float>& g, const std::uint16_t* panels, Index r0, Index r1, Index j0, Index j1,
                     float* scratch) {
  using Element = typename Tile::Element;
  const Index depth = bf16_depth(g.k), pitch = bf16_pitch<Tile>(depth), at_once = bf16_rows<Tile>(g.k);
  Element* a = reinterpret_cast<Element*>(scratch);
  const bool stream = streams(g);
  Tile tile;
  Tile::begin();
  constexpr Index unit = Tile::even ? 1 : Tile::rows;  // of rows that blocks have evenly
  const Index units = (r1 - r0 + unit - 1) / unit, row_blocks = (r1 - r0 + at_once - 1) / at_once;
  for (Index block = 0; block < row_blocks; ++block) {
    const Index top = r0 + unit * part(units, block, row_blocks);
    const Index rows = std::min(r1, r0 + unit * part(units, block + 1, row_blocks)) - top,
                tiles = (rows + Tile::rows - 1) / Tile::rows;
    const Index pieces = Tile::pieces(depth, tiles);
    round_rows<Tile>(Rows<float>{g.a, g.lda, g.a_transposed}.from(top), rows, g.k, depth, a, pitch);
    for (Index j = j0; j < j1; ++j) {
      const std::uint16_t* panel = panels + j * depth * bf16_columns;
      const bool last = j + 1 == j1 && top + rows == r1;
      const std::byte* next = as_bytes(panels + (j + 1 < j1 ? j + 1 : j0) * depth * bf16_columns);
      const auto* following = last ? g.following(j0, (g.n + bf16_columns - 1) / bf16_columns, next) : next;
      for (Index step = 0; step < pieces * tiles; ++step) {
        const Index piece = step / tiles, t = step % tiles;
        const Index k0 = 32 * part(depth / 32, piece, pieces),
                    k1 = std::min(32 * part(depth / 32, piece + 1, pieces), Tile::depth(g.k));
        const Index first = Tile::even ? part(rows, t, tiles) : t * Tile::rows;
        const Index height = (Tile::even ? part(rows, t + 1, tiles) : std::min(rows, first + Tile::rows)) - first;
        const Index row = top + first, column = j * bf16_columns;
        const auto ahead =
            Ahead::share(following + k0 / 2 * pair_bytes, (k1 - k0) / 2 * pair_bytes, t, tiles, (k1 - k0) / 2);
        TileProduct<Element> product{.a = a + first * pitch + k0,
                                     .pitch = pitch,
                                     .height = height,
                                     .panel = panel + k0 * bf16_columns,
                                     .depth = k1 - k0,
                                     .c = g.c + row * g.ldc + column,
                                     .ldc = g.ldc,
                                     .columns = std::min(g.n - column, bf16_columns),
                                     .e = Epilogue<float>::of(g, row, column, true, true),
                                     .ahead = ahead,
                                     .panel_stays = tiles > 1,
                                     .stream = stream,
                                     .number = t,
                                     .first = piece == 0,
                                     .last = piece + 1 == pieces};
        tile.multiply(product);
      }
    }
  }
  tile.finish();
  if (stream) end_of_streams();
  Tile::end();
}

/// The products of attention (attention.inc) in bfloat16; scores and softmax stay in float.
template <class Tile>
struct Bf16Products {
  using Number = float;
  using Element = typename Tile::Element;
  static constexpr Index rows = Tile::rows;
  static void begin() { Tile::begin(); }
  static void end() { Tile::end(); }
  static Index columns(Index n) { return bf16_depth(n); }
  static Index panels(Index k, Index n) { return bf16_depth(k) * bf16_depth(n) / 2; }
  static Index scratch(Index k) { return Tile::rows * bf16_pitch<Tile>(bf16_depth(k)); }

  static void pack(const float* b, Index k, Index n, Index stride_k, Index stride_n, float* panels) {
    auto* out = reinterpret_cast<std::uint16_t*>(panels);
    if (stride_n == 1)
      bf16_pack_rows<Tile>(b, k, n, stride_k, 0, bf16_depth(k), out);
    else
      bf16_pack_transposed<Tile, false>(b, k, n, stride_n, 0, bf16_depth(n) / bf16_columns, out);
  }
  static void multiply(const Rows<float>& a, Index count, Index k, const float* panels, Index n, float* c, Index ldc,
                       float* scratch, bool whole_panels) {
    const Index depth = bf16_depth(k), pitch = bf16_pitch<Tile>(depth);
    auto* rounded_rows = reinterpret_cast<Element*>(scratch);
    Tile tile;
    for (Index first = 0; first < count; first += Tile::rows) {
      const Index height = std::min<Index>(Tile::rows, count - first);
      round_rows<Tile>(a.from(first), height, k, depth, rounded_rows, pitch);
      for (Index j = 0; j < n; j += bf16_columns) {
        const auto* panel = reinterpret_cast<const std::uint16_t*>(panels) + j * depth;
        tile.multiply(TileProduct<Element>{.a = rounded_rows,
                                           .pitch = pitch,
                                           .height = height,
                                           .panel = panel,
                                           .depth = Tile::depth(k),
                                           .c = c + first * ldc + j,
                                           .ldc = ldc,
                                           .columns = whole_panels ? bf16_columns : std::min(n - j, bf16_columns),
                                           .ahead = {as_bytes(panel)},
                                           .panel_stays = false});
      }
    }
    tile.finish();
  }
};

template <class Tile>
const Bf16Kernels& bf16_table() {
  static constexpr Bf16Kernels t{.name = Tile::name,
                                 .tile_rows = Tile::rows,
                                 .gemm_rows = &bf16_rows<Tile>,
                                 .gemm_scratch = &bf16_scratch<Tile>,
                                 .pack_rows = &bf16_pack_rows<Tile>,
                                 .pack_transposed = &bf16_pack_transposed<Tile, true>,
                                 .gemm_block = &bf16_gemm_block<Tile>,
                                 .attention_scratch = &attention_scratch<Bf16Products<Tile>>,
                                 .attention_vjp_scratch = &attention_vjp_scratch<Bf16Products<Tile>>,
                                 .attention_head = &attention_head<Bf16Products<Tile>>,
                                 .attention_head_vjp = &attention_head_vjp<Bf16Products<Tile>>};
  return t;
}

template <class S>
const Kernels<S>& table() {
  static constexpr Kernels<S> t{
      .name = MOTIONLANG_STRING(MOTIONLANG_ISA),
      .tiles = nullptr,
      .panel_width = panel_width<S>,
      .tile_rows = tile_rows,
      .gemm_rows = &gemm_rows<S>,
      .gemm_scratch = &gemm_scratch<S>,
      .pack_rows = &pack_rows<S>,
      .pack_transposed = &pack_transposed<S, true>,
      .gemm_block = &gemm_block<S>,
      .attention_scratch = &attention_scratch<FloatProducts<S>>,
      .attention_vjp_scratch = &attention_vjp_scratch<FloatProducts<S>>,
      .attention_head = &attention_head<FloatProducts<S>>,
      .attention_head_vjp = &attention_head_vjp<FloatProducts<S>>,
      .dropout = &dropout<S>,
      .layer_norm_rows = &layer_norm_rows<S>,
      .layer_norm_rows_vjp = &layer_norm_rows_vjp<S>,
      .layer_norm_columns_vjp = &layer_norm_columns_vjp<S>,
      .softmax_rows = &softmax_rows<S>,
      .transpose = &transpose<S>,
      .activate = &activate<S>,
      .activate_vjp = &activate_vjp<S>,
      .binary = &binary<S>,
      .error_function = &error_function<S>,
      .row_sums = &row_sums<S>,
      .column_sums = &column_sums<S>,
      .adamw = &adamw<S>,
  };
  return t;
}

#undef MOTIONLANG_STRING
#undef MOTIONLANG_STRING_OF
#undef MOTIONLANG_INLINE

}  // namespace detail::MOTIONLANG_ISA
MOTIONLANG_NAMESPACE_END
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
// Tiles of bf16.inc for the instructions of x86 processors that multiply bfloat16. As assembly: the intrinsics would
// need a large header, and their types differ between compilers.

/// Rounds in one instruction: numbers below 2^-126 to 0.
class ConvertingTile {
 public:
  using Element = std::uint16_t;
  static void round_row(const float* x, Index n, Index padded, Element* y) {
    for (Index i = 0; i < padded; i += lanes<float>) {
      *reinterpret_cast<LooseHalves*>(y + i) = rounded(x + i, n - i);
    }
  }
  static void round_pairs(const float* x, Index nx, const float* y, Index ny, std::uint16_t* out) {
    for (Index c = 0; c < bf16_columns; c += lanes<float>) {
      const Words first = __builtin_convertvector(rounded(x + c, nx - c), Words),
                  second = __builtin_convertvector(rounded(y + c, ny - c), Words);
      store_words(out + 2 * c, first | second << 16);
    }
  }

 private:
  MOTIONLANG_INLINE static Halves rounded(const float* x, Index n) {
    const Vec<float> from = load_first(x, n);
    Halves h;
    asm("vcvtneps2bf16 %1, %0" : "=v"(h) : "v"(from));
    return h;
  }
};

/// AVX512-BF16: one instruction adds 16 sums of two products. AMD since Zen 4, Intel since Cooper Lake.
struct DotTile : RegisterTile<DotTile>, ConvertingTile {
  static constexpr const char* name = "avx512_bf16";
  static constexpr int rows = MOTIONLANG_TILE_ROWS;

  MOTIONLANG_INLINE static Vec<float> add_products(Vec<float> c, const Words& x, const Words& b) {
    asm("vdpbf16ps %2, %1, %0" : "+v"(c) : "v"(x), "v"(b));
    return c;
  }
  template <int R>
  static void rows_of(const Element* a, Index pitch, const std::uint16_t* panel, Index depth, float* c, Index ldc,
                      Index columns, const Epilogue<float>& e, Ahead ahead) {
    Vec<float> c0[R], c1[R];
#pragma GCC unroll 16
    for (int i = 0; i < R; ++i) c0[i] = c1[i] = Vec<float>{};
    fetch_result<float, R>(c, ldc, e);
    for (Index k = 0; k < depth; k += 2, panel += 2 * bf16_columns) {
      ahead.fetch();
      const Words b0 = *reinterpret_cast<const LooseWords*>(panel),
                  b1 = *reinterpret_cast<const LooseWords*>(panel + bf16_columns);
#pragma GCC unroll 16
      for (int i = 0; i < R; ++i) {
        std::uint32_t pair;
        std::memcpy(&pair, a + i * pitch + k, sizeof pair);
        const Words x = pair - Words{};
        c0[i] = add_products(c0[i], x, b0);
        c1[i] = add_products(c1[i], x, b1);
      }
    }
    put_result<float, R>(c0, c1, c, ldc, columns, e);
  }
};

MOTIONLANG_INLINE bool any_nan(const Vec<float>& x) {
  bool any = false;
  for (int i = 0; i < lanes<float>; ++i) any |= x[i] != x[i];
  return any;
}

/// The three parts of floats in a panel of `k` rows, filled up to whole tiles: [k / 32][part][pair of k][column][2].
/// The parts are cut off, not rounded: that takes a third of the time.
class PanelSplit {
 public:
  static constexpr Index parts = 3;
  Index each = 0;  // pairs of k with every step of a tile

  PanelSplit() = default;
  /// following: what is read after the panel; it is fetched into the second-level cache meanwhile.
  PanelSplit(const float* panel, Index k, const std::byte* following, std::uint16_t* out)
      : from_(panel), following_(following), k_(k), depth_(bf16_depth(k)), begin_(out) {}
  const std::uint16_t* begin() const { return begin_; }
  /// Whether all numbers so far were finite.
  bool sound() const { return !any_nan(left_); }

  /// The next pairs of k.
  MOTIONLANG_INLINE void some(Index pairs_of_k) {
    for (const Index end = std::min(depth_, at_ + 2 * pairs_of_k); at_ < end; at_ += 2) {
      const float* from = from_ + at_ * bf16_columns;
      constexpr Index row_bytes = 4 * bf16_columns;
      for (Index byte = 0; byte < 2 * row_bytes; byte += 64)
        __builtin_prefetch(following_ + at_ * row_bytes + byte, 0, 2);
      std::uint16_t* out = begin_ + (at_ / 32 * 32 * parts + at_ % 32) * bf16_columns;
#pragma GCC unroll 2
      for (Index c = 0; c < bf16_columns; c += lanes<float>) {
        Vec<float> even = at_ < k_ ? load(from + c) : Vec<float>{},
                   odd = at_ + 1 < k_ ? load(from + bf16_columns + c) : Vec<float>{};
#pragma GCC unroll 3
        for (Index p = 0; p < parts; ++p) {
          if (p + 1 == parts) left_ += even + odd;
          const Words first = (Words)even & 0xFFFF0000u, second = (Words)odd & 0xFFFF0000u;
          store_words(out + p * 32 * bf16_columns + 2 * c, pairs(first, second));
          even -= (Vec<float>)first, odd -= (Vec<float>)second;
        }
      }
    }
  }
  void finish() { some(depth_); }

 private:
  const float* from_ = nullptr;
  const std::byte* following_ = nullptr;
  Index k_ = 0, depth_ = 0, at_ = 0;
  std::uint16_t* begin_ = nullptr;
  Vec<float> left_{};  // the sum of what the first two parts leave: NaN if a number is not finite
};

/// AMX: registers of 16 rows of 64 bytes; one instruction multiplies 16 x 32 by 32 x 16. Intel since Sapphire Rapids.
/// Registers 0 1 / 2 3 are the sums of 32 rows and 32 columns, 4 5 the rows of A, 6 7 the columns of B.
///
/// These instructions are 16 times as fast as those in float, so that everything else counts. The sums begin with the
/// bias (of bfloat16). A piece of a panel stays in the first-level cache while rows of A pass by it (tileloaddt1). What
/// else is to be done with a tile is done beside the products of the next one, some rows with every step of k: the
/// vector units are idle then.
///
/// Parts: of every number; more than one are those of floats (float_tiles.inc). The parts of 32 numbers lie together,
/// part after part.
template <Index Parts>
class AmxTile : public ConvertingTile {
 public:
  static constexpr const char* name = "amx";
  static constexpr Index parts = Parts;
  static constexpr int rows = 32;
  static constexpr bool even = false;             // 32 rows cost as much as 17
  static constexpr bool bias_first = parts == 1;  // else at last, as with multiply-adds
  static constexpr Index depth(Index k) { return bf16_depth(k); }
  static constexpr Index pieces(Index depth, Index tiles) { return tiles > 3 ? (depth + 511) / 512 : 1; }

  static void begin() {
    static constexpr Shapes shapes;
    asm volatile("ldtilecfg %0" : : "m"(shapes));
  }
  static void end() { asm volatile("tilerelease"); }

  void multiply(const TileProduct<Element>& t) {
    const bool lower = t.height > 16, once = t.first && t.last;
    const bool plain = t.e.residual == nullptr && !t.e.accumulate && (bias_first || t.e.bias == nullptr) &&
                       t.e.act == Activation::none;
    const bool direct = once && plain && t.height == rows && t.columns == bf16_columns && !t.stream;
    if (once) turn_ = 1 - turn_;
    float* own = sums_[once ? turn_ : t.number];
    if (t.first)
      begin_with(bias_first ? t.e.bias : nullptr, t.columns, lower);
    else
      load_sums(own, bf16_columns, lower);
    const Element* a = t.a;
    const std::uint16_t* panel = t.panel;
    const Index a_stride = 2 * t.pitch, steps = t.depth / 32;
    const Index put_each = (waiting_.height - put_ + steps - 1) / steps;
    const std::byte* ahead = t.ahead.at;
    const Index ahead_bytes = 16 * t.ahead.step;  // with every step
    const auto products = [&]<bool panel_stays>() {
      for (Index step = 0; step < steps; ++step, a += 32 * parts, panel += 32 * parts * bf16_columns) {
        add_products<panel_stays>(a, a_stride, a + 16 * t.pitch, panel, lower);
        for (Index byte = 0; byte < ahead_bytes; byte += 64) __builtin_prefetch(ahead + byte, 0, 2);
        ahead += ahead_bytes;
        if constexpr (parts > 1) t.next->some(t.next->each);
        put(put_each);
      }
    };
    t.panel_stays ? products.template operator()<true>() : products.template operator()<false>();
    store_sums(direct ? t.c : own, direct ? t.ldc : bf16_columns, lower);
    if (t.last && !direct) waiting_ = t, waiting_sums_ = own, put_ = 0;
  }
  void finish() { put(waiting_.height - put_); }

 private:
  struct alignas(64) Shapes {
    std::uint8_t palette = 1, start_row = 0, reserved[14] = {};
    std::uint16_t row_bytes[16] = {64, 64, 64, 64, 64, 64, 64, 64};
    std::uint8_t rows[16] = {16, 16, 16, 16, 16, 16, 16, 16};
  };

  static void begin_with(const float* bias, Index columns, bool lower) {
    if (bias == nullptr) {
      asm volatile("tilezero %%tmm0\n\ttilezero %%tmm1\n\ttilezero %%tmm2\n\ttilezero %%tmm3" : : : "memory");
      return;
    }
    float some[bf16_columns] = {};
    if (columns < bf16_columns) {
      std::copy(bias, bias + columns, some);
      bias = some;
    }
    load_sums(bias, 0, lower);  // the same row, 16 times
  }
  /// Part p of 32 rows (16 unless `lower`) of 32 numbers, into registers 4 and 5, and of 32 columns, into 6 and 7. What
  /// does not stay in the first-level cache is loaded past it. Memory is read, which the compiler is not told: it knows
  /// of those instructions that begin and store the sums.
  template <Index p, bool stays>
  MOTIONLANG_INLINE static void load_rows(const Element* upper, const Element* below, Index stride, bool lower) {
    if constexpr (stays) {
      asm volatile("tileloadd %c2(%0,%1,1), %%tmm4" : : "r"(upper), "r"(stride), "i"(64 * p));
      if (lower) asm volatile("tileloadd %c2(%0,%1,1), %%tmm5" : : "r"(below), "r"(stride), "i"(64 * p));
    } else {
      asm volatile("tileloaddt1 %c2(%0,%1,1), %%tmm4" : : "r"(upper), "r"(stride), "i"(64 * p));
      if (lower) asm volatile("tileloaddt1 %c2(%0,%1,1), %%tmm5" : : "r"(below), "r"(stride), "i"(64 * p));
    }
  }
  template <Index p, bool stays>
  MOTIONLANG_INLINE static void load_columns(const std::uint16_t* panel) {
    constexpr Index at = p * 16 * pair_bytes;
    if constexpr (stays) {
      asm volatile("tileloadd %c2(%0,%1,1), %%tmm6\n\ttileloadd %c3(%0,%1,1), %%tmm7"
                   :
                   : "r"(panel), "r"(Index{pair_bytes}), "i"(at), "i"(at + 64));
    } else {
      asm volatile("tileloaddt1 %c2(%0,%1,1), %%tmm6\n\ttileloaddt1 %c3(%0,%1,1), %%tmm7"
                   :
                   : "r"(panel), "r"(Index{pair_bytes}), "i"(at), "i"(at + 64));
    }
  }
  MOTIONLANG_INLINE static void add_loaded(bool lower) {
    asm volatile("tdpbf16ps %tmm6, %tmm4, %tmm0\n\ttdpbf16ps %tmm7, %tmm4, %tmm1");
    if (lower) asm volatile("tdpbf16ps %tmm6, %tmm5, %tmm2\n\ttdpbf16ps %tmm7, %tmm5, %tmm3");
  }
  /// 32 rows times 32 columns, 32 of k. Of parts the largest product comes last; the order saves loads.
  template <bool panel_stays>
  MOTIONLANG_INLINE static void add_products(const Element* upper, Index stride, const Element* below,
                                             const std::uint16_t* panel, bool lower) {
    const auto rows_part = [&]<Index p>(std::integral_constant<Index, p>) {
      load_rows<p, !panel_stays>(upper, below, stride, lower);
    };
    const auto columns_part = [&]<Index p>(std::integral_constant<Index, p>) { load_columns<p, panel_stays>(panel); };
    constexpr std::integral_constant<Index, 0> first;
    if constexpr (parts == 1) {
      columns_part(first), rows_part(first), add_loaded(lower);
    } else {
      constexpr std::integral_constant<Index, 1> second;
      constexpr std::integral_constant<Index, 2> third;
      rows_part(first), columns_part(third), add_loaded(lower);
      columns_part(second), add_loaded(lower);
      rows_part(second), add_loaded(lower);
      columns_part(first), add_loaded(lower);
      rows_part(third), add_loaded(lower);
      rows_part(first), add_loaded(lower);
    }
  }
  static void load_sums(const float* c, Index ldc, bool lower) {
    asm volatile("tileloadd (%0,%1,1), %%tmm0\n\ttileloadd 64(%0,%1,1), %%tmm1" : : "r"(c), "r"(4 * ldc) : "memory");
    if (lower)
      asm volatile("tileloadd (%0,%1,1), %%tmm2\n\ttileloadd 64(%0,%1,1), %%tmm3"
                   :
                   : "r"(c + 16 * ldc), "r"(4 * ldc)
                   : "memory");
  }
  static void store_sums(float* c, Index ldc, bool lower) {
    asm volatile("tilestored %%tmm0, (%0,%1,1)\n\ttilestored %%tmm1, 64(%0,%1,1)" : : "r"(c), "r"(4 * ldc) : "memory");
    if (lower)
      asm volatile("tilestored %%tmm2, (%0,%1,1)\n\ttilestored %%tmm3, 64(%0,%1,1)"
                   :
                   : "r"(c + 16 * ldc), "r"(4 * ldc)
                   : "memory");
  }

  /// Puts the next rows of the tile that waits.
  MOTIONLANG_INLINE void put(Index count) {
    const TileProduct<Element>& w = waiting_;
    const Index first = put_, n = std::min(count, w.height - first);
    if (n <= 0) return;
    put_ += n;
    float *own = waiting_sums_ + first * bf16_columns, *c = w.c + first * w.ldc;
    const bool act = w.e.act != Activation::none;
    const bool adds = w.e.residual != nullptr || w.e.accumulate || (!bias_first && w.e.bias != nullptr);
    for (Index r = 0; r < n && (adds || !act); ++r) {
      constexpr Index l = lanes<float>;
      Vec<float> c0 = load(own + r * bf16_columns), c1 = load(own + r * bf16_columns + l);
      // Not by put_result, which may be given other rows than those of c.
      if (w.e.accumulate)
        c0 += load_first(c + r * w.ldc, w.columns), c1 += load_first(c + r * w.ldc + l, w.columns - l);
      Epilogue<float> e = w.e.from_row(first + r);
      if (bias_first) e.bias = nullptr;
      e.accumulate = false, e.act = Activation::none;
      put_result<float, 1>(&c0, &c1, act || w.stream ? own + r * bf16_columns : c + r * w.ldc, w.ldc, w.columns, e);
    }
    if (act)
      activate_rows<float>(own, bf16_columns, n, w.columns, w.e.act, w.stream ? own : c,
                           w.stream ? bf16_columns : w.ldc);
    if (w.stream) stream_rows(own, n, c, w.ldc);
  }

  alignas(64) float sums_[most_tiles][rows * bf16_columns];  // of the tiles of a panel, or of two tiles in turn
  TileProduct<Element> waiting_{
      .a = nullptr, .pitch = 0, .height = 0, .panel = nullptr, .depth = 0, .c = nullptr, .ldc = 0, .columns = 0};
  float* waiting_sums_ = nullptr;
  Index put_ = 0;   // rows that are put already
  Index turn_ = 0;  // which of two sums
};
using FloatTile = AmxTile<3>;
//
// Products of floats by AMX, which multiplies bfloat16 16 times as fast as other instructions multiply floats.
//
//   Parts    a float is the sum of three bfloat16: 24 bits are three times 8. Of the nine products of the parts of two
//            floats the six largest are added up, the others are at most 3 2^-24 of the whole together, a tenth of that
//            mostly, and of either sign. The instruction adds up 32 products before it adds them to the sum, so that
//            the error is about half of that of one multiply-add after the other.
//   Panels   those of gemm.inc. A panel is split into scratch, beside the products with the panel before it, and so are
//            the rows of A.
//   Block    up to 1024 of k at a time: rows of A stay in the second-level cache (2 MB where there is AMX) beside the
//            split panel.
//   Order    as in gemm.inc: depends on k alone.
//   Limits   parts and their products below 2^-126 count as 0: exact are products of more than 2^-108. A sum that
//            overflows may be NaN. Rows of A and panels of B with a number that is not finite (or whose nearest
//            bfloat16 is not: from 3.39e38 on) have no parts: they are multiplied by gemm.inc.

/// 16 numbers, in parts: each the nearest bfloat16 to what those before it leave. What the last one leaves: 0, or NaN
/// if there are no parts.
MOTIONLANG_INLINE Vec<float> split_lanes(Vec<float> x, std::uint16_t* y) {
#pragma GCC unroll 3
  for (Index p = 0; p < FloatTile::parts; ++p) {
    Halves part;
    Words wide;
    asm("vcvtneps2bf16 %2, %0\n\tvpmovzxwd %0, %1" : "=v"(part), "=v"(wide) : "v"(x));
    *reinterpret_cast<LooseHalves*>(y + 32 * p) = part;
    x -= (Vec<float>)(wide << 16);
  }
  return x;
}
/// `count` rows of A, k numbers each, filled up to `depth`: [row][k / 32][part][k]. Whether all numbers have parts.
inline bool split_rows(const Rows<float>& a, Index count, Index k, Index depth, std::uint16_t* y, Index pitch) {
  constexpr Index l = lanes<float>;
  Vec<float> left{};
  const auto place = [&](Index row, Index at) { return y + row * pitch + at / 32 * 32 * FloatTile::parts + at % 32; };
  if (!a.transposed) {
    for (Index r = 0; r < count; ++r) {
      for (Index i = 0; i < depth; i += l) left += split_lanes(load_first(a.at + r * a.stride + i, k - i), place(r, i));
    }
    return !any_nan(left);
  }
  for (Index r = 0; r < count; r += l) {
    for (Index i = 0; i < depth; i += l) {
      Vec<float> square[lanes<float>];
#pragma GCC unroll 16
      for (int q = 0; q < lanes<float>; ++q) {
        const float* from = a.at + (i + q) * a.stride + r;
        if (i + q + l < k) __builtin_prefetch(from + l * a.stride);  // no prefetcher follows pieces so far apart
        square[q] = load_first(from, i + q < k ? count - r : 0);
      }
      transpose_lanes<float>(square);
      for (Index q = 0; q < std::min(count - r, l); ++q) left += split_lanes(square[q], place(r + q, i));
    }
  }
  return !any_nan(left);
}

/// The rows and panels of a product that have numbers without parts, by multiply-adds.
inline void multiply_odd_parts(const Gemm<float>& g, Index r0, Index r1, Index j0, Index j1, float* scratch) {
  for (Index j = j0; j < j1; ++j) {
    Mask<float> found{};
    const float* panel = g.panels + j * g.k * bf16_columns;
    for (Index i = 0; i < g.k * bf16_columns; i += lanes<float>) find_not_finite<float>(load(panel + i), found);
    if (any_negative<float>(found)) gemm_block(g, r0, r1, j, j + 1, scratch);
  }
  const Rows<float> rows{g.a, g.lda, g.a_transposed};
  for (Index r = r0; r < r1; ++r) {
    std::uint16_t parts[FloatTile::parts * 32];
    bool sound = true;
    for (Index k = 0; k < g.k; ++k) sound &= split_rows(rows.from(r).from_depth(k), 1, 1, 32, parts, 0);
    if (!sound) gemm_block(g, r, r + 1, j0, j1, scratch);
  }
}

/// How a product over k is split: blocks of k, and rows of A at a time.
struct FloatBlocks {
  Index all, count, depth, pitch, rows;  // depth: of a block at most; pitch: of rows in scratch

  explicit FloatBlocks(Index k)
      : all(bf16_depth(k)),
        count((all + depth_block - 1) / depth_block),
        depth(bf16_depth((all + count - 1) / count)),
        pitch(depth * FloatTile::parts + 32),
        rows(rows_at_once(2 * pitch, FloatTile::rows, 1280 * 1024)) {}
};
inline Index float_tile_rows(Index k) { return FloatBlocks(k).rows; }
/// Numbers of scratch that float_tile_block needs.
inline Index float_tile_scratch(Index k) {
  const FloatBlocks split(k);
  return (split.rows * split.pitch + 2 * split.depth * FloatTile::parts * bf16_columns) / 2;
}

/// Rows r0 ... r1-1 and panels j0 ... j1-1 of a product.
inline void float_tile_block(const Gemm<float>& g, Index r0, Index r1, Index j0, Index j1, float* scratch) {
  bool sound = true;  // all numbers have parts
  const FloatBlocks split(g.k);
  const Index panel_size = split.depth * FloatTile::parts * bf16_columns;
  auto* const panels = reinterpret_cast<std::uint16_t*>(scratch);  // two in turn
  auto* const a = panels + 2 * panel_size;
  const bool stream = split.count == 1 && streams(g);
  FloatTile tile;
  FloatTile::begin();
  constexpr Index unit = FloatTile::rows;
  const Index units = (r1 - r0 + unit - 1) / unit, row_blocks = (r1 - r0 + split.rows - 1) / split.rows;
  const auto first_of = [&](Index block) { return 32 * part(split.all / 32, block, split.count); };
  int turn = 0;
  const auto splitting = [&](Index row_block, Index block, Index j) {
    const Index begin = first_of(block), end = std::min(g.k, first_of(block + 1));
    const float* from = g.panels + (j * g.k + begin) * bf16_columns;
    const float* next = j + 1 < j1 ? from + g.k * bf16_columns
                                   : g.panels + (j0 * g.k + (block + 1 < split.count ? end : 0)) * bf16_columns;
    const bool last = j + 1 == j1 && block + 1 == split.count && row_block + 1 == row_blocks;
    const auto* following = last ? g.following(j0, (g.n + bf16_columns - 1) / bf16_columns, next) : as_bytes(next);
    turn = 1 - turn;
    return PanelSplit(from, end - begin, following, panels + turn * panel_size);
  };
  PanelSplit panel = splitting(0, 0, j0);
  for (Index row_block = 0; row_block < row_blocks; ++row_block) {
    const Index top = r0 + unit * part(units, row_block, row_blocks);
    const Index rows = std::min(r1, r0 + unit * part(units, row_block + 1, row_blocks)) - top,
                tiles = (rows + unit - 1) / unit;
    for (Index block = 0; block < split.count; ++block) {
      const Index begin = first_of(block), k = std::min(g.k, first_of(block + 1)) - begin, depth = bf16_depth(k);
      sound &= split_rows(Rows<float>{g.a, g.lda, g.a_transposed}.from(top).from_depth(begin), rows, k, depth, a,
                          split.pitch);
      for (Index j = j0; j < j1; ++j) {
        panel.finish();
        sound &= panel.sound();
        const Index next_block = block + (j + 1 == j1 ? 1 : 0), next_rows = row_block + next_block / split.count;
        PanelSplit next = next_rows == row_blocks
                              ? PanelSplit()
                              : splitting(next_rows, next_block % split.count, j + 1 == j1 ? j0 : j + 1);
        next.each = (16 + tiles - 1) / tiles;
        for (Index t = 0; t < tiles; ++t) {
          const Index first = t * unit, row = top + first, column = j * bf16_columns;
          TileProduct<std::uint16_t> product{
              .a = a + first * split.pitch,
              .pitch = split.pitch,
              .height = std::min(rows - first, unit),
              .panel = panel.begin(),
              .depth = depth,
              .c = g.c + row * g.ldc + column,
              .ldc = g.ldc,
              .columns = std::min(g.n - column, bf16_columns),
              .e = Epilogue<float>::of(g, row, column, block == 0, block + 1 == split.count),
              .stream = stream,
              .next = &next};
          tile.multiply(product);
        }
        panel = next;
      }
    }
  }
  tile.finish();
  if (stream) end_of_streams();
  FloatTile::end();
  if (!sound) multiply_odd_parts(g, r0, r1, j0, j1, scratch);
}

/// The kernels of AVX-512, with AMX for products.
inline const Kernels<float>& table_with_tiles() {
  static constexpr FloatTiles tiles{FloatTile::rows, &float_tile_rows, &float_tile_scratch, &float_tile_block};
  static const Kernels<float> t = [] {
    Kernels<float> k = table<float>();
    k.name = FloatTile::name, k.tiles = &tiles;
    return k;
  }();
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
    if (isa == Isa::amx) return processor_has(isa) ? &avx512::table_with_tiles() : nullptr;
  }
  if (isa != Isa::best) return processor_has(Isa::avx512) ? &avx512::table<S>() : nullptr;
#endif
  if (isa != Isa::best) return nullptr;
  for (Isa better : {Isa::amx, Isa::avx512, Isa::avx2}) {
    if (const auto* k = kernels_for<S>(better)) return k;
  }
  return &portable::table<S>();
}
/// The same for products of bfloat16. The best is AMX; vdpbf16ps where there is none (beside AMX it runs at half the
/// speed of products in float); else float instructions.
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

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <class S>
using EigenArray = Eigen::Array<S, Eigen::Dynamic, 1>;

template <class S>
auto eigen_map(const S* data, Index n) {
  return Eigen::Map<const EigenArray<S>>(data, n);
}
template <class S>
auto eigen_map(S* data, Index n) {
  return Eigen::Map<EigenArray<S>>(data, n);
}

/// out = f(a) as arrays; a's memory is reused when nobody else holds it.
template <class S, class F>
Dense<S> eigen_unary(Dense<S> a, F f) {
  Dense<S> out = a.unique() ? a : Dense<S>(a.shape());
  parallel_ranges(a.count(), 1, [&](Index first, Index last) {
    eigen_map(out.data() + first, last - first) = f(eigen_map(std::as_const(a).data() + first, last - first));
  });
  return out;
}

}  // namespace detail

template <Scalar S>
Dense<S> EigenBackend<S>::atan2(tensor a, tensor b) {
  const Shape s = broadcast_shapes(a.shape(), b.shape(), "atan2");
  a = DenseOps<S>::broadcast(a, s), b = DenseOps<S>::broadcast(b, s);
  tensor out(s);
  for (Index i = 0, n = s.count(); i < n; ++i)
    out.data()[i] = std::atan2(std::as_const(a).data()[i], std::as_const(b).data()[i]);
  return out;
}
template <Scalar S>
Dense<S> EigenBackend<S>::exp(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.exp(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::log(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.log(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::sqrt(tensor a) {
  // Eigen's own root of a packet is rounded otherwise than its root of a single number
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.unaryExpr([](S v) { return std::sqrt(v); }); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::tanh(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.tanh(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::erf(tensor a) {  // Eigen's is in an unsupported module
  tensor out(a.shape());
  detail::kernels<S>().error_function(std::as_const(a).data(), a.count(), out.data());
  return out;
}
template <Scalar S>
Dense<S> EigenBackend<S>::sin(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.sin(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::cos(tensor a) {
  return detail::eigen_unary(std::move(a), [](const auto& x) { return x.cos(); });
}
template <Scalar S>
Dense<S> EigenBackend<S>::where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y) {
  const Shape s = broadcast_shapes(broadcast_shapes(a.shape(), b.shape(), "where_less"),
                                   broadcast_shapes(x.shape(), y.shape(), "where_less"), "where_less");
  const Index n = s.count();
  const tensor la = DenseOps<S>::broadcast(a, s), lb = DenseOps<S>::broadcast(b, s);
  const tensor lx = DenseOps<S>::broadcast(x, s), ly = DenseOps<S>::broadcast(y, s);
  tensor out(s);
  parallel_ranges(n, 1, [&](Index first, Index last) {
    auto piece = [&](const tensor& t) { return detail::eigen_map(t.data() + first, last - first); };
    detail::eigen_map(out.data() + first, last - first) = (piece(la) < piece(lb)).select(piece(lx), piece(ly));
  });
  return out;
}
template <Scalar S>
Dense<S> EigenBackend<S>::max(const tensor& a, int axis) {
  const Shape& s = a.shape();
  const Index n = s[axis], inner = s.count(axis + 1, s.rank());
  tensor out = tensor::full(s.without(axis), -std::numeric_limits<S>::infinity());
  if (n == 0) return out;
  const auto rows = [&](Index first, Index last) {
    for (Index i = first; i < last; ++i) out.data()[i] = detail::eigen_map(a.data() + i * n, n).maxCoeff();
  };
  const auto columns = [&](Index i, Index first, Index last) {
    auto largest = detail::eigen_map(out.data() + i * inner + first, last - first);
    for (Index l = 0; l < n; ++l)
      largest = largest.max(detail::eigen_map(a.data() + (i * n + l) * inner + first, last - first));
  };
  detail::for_reduction(s, axis, rows, columns);
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif
#endif
