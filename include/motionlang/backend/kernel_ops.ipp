// SPDX-License-Identifier: MIT
/// Bodies of kernel_ops.hpp: shapes to pointers, and the split of the work over threads.
///
/// Work is split over rows or columns of the result only, never over a summed index.
#pragma once

#include <algorithm>  // copy, fill, swap, min
#include <array>      // axes, several gradients
#include <atomic>     // a finding of several threads, the weight prepared next
#include <memory>     // shared_ptr
#include <numeric>    // gcd
#include <utility>    // move

#include <motionlang/backend/dense_ops.hpp>
#include <motionlang/backend/detail/broadcast.hpp>
#include <motionlang/backend/detail/kernels.hpp>
#include <motionlang/backend/kernel_ops.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/core/precision.hpp>
#include <motionlang/core/thread_object.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Scratch memory for the kernels of a parallel region, a piece for every thread. The caller allocates it, so that a
/// repeated region takes nothing from the system, for any choice of threads.
template <class S>
class Scratch {
 public:
  explicit Scratch(Index count)
      : piece_((count + 63) / 64 * 64),
        pieces_(parallel_width()),
        memory_(static_cast<std::size_t>(piece_ * pieces_) * sizeof(S)) {}
  /// The piece of the calling thread.
  S* mine() const { return static_cast<S*>(memory_.data()) + (pieces_ == 1 ? 0 : piece_ * thread_number()); }

 private:
  Index piece_, pieces_;
  BufferHandle memory_;
};

/// A matrix (k, n) in panels: of S for `kernels`, or of bfloat16. They know how products with them are made, so that
/// nothing but the arguments of an operation decides its bits.
template <class S>
struct Panels {
  Index k = 0, n = 0;
  Precision precision = Precision::fp32;
  const Kernels<S>* kernels = nullptr;  // null: bfloat16
  const FloatTiles* tiles = nullptr;    // null: multiply-adds
  BufferHandle memory;

  const S* data() const { return static_cast<const S*>(memory.data()); }
  const std::uint16_t* bf16() const { return static_cast<const std::uint16_t*>(memory.data()); }
  Index width() const { return kernels == nullptr ? bf16_columns : kernels->panel_width; }
  Index count() const { return (n + width() - 1) / width(); }
  Index bytes() const {
    const Index column = kernels == nullptr ? bf16_depth(k) * 2 : k * static_cast<Index>(sizeof(S));
    return count() * width() * column;
  }
};

/// The panels of a prepared weight, and those of the weight prepared after it, which is probably multiplied next. For
/// the latter only the address is known, for prefetching: they may have been freed.
template <class S>
struct PreparedPanels {
  PreparedPanels(Panels<S> p, Index t) : panels(std::move(p)), taps(t) {}

  Panels<S> panels;
  Index taps;  // of a convolution's weight
  mutable std::atomic<const std::byte*> next{nullptr};
  mutable std::atomic<Index> next_bytes{0};
};

inline Index parts(Index count, Index size) { return (count + size - 1) / size; }

/// Precision of products of S with what is not prepared.
template <class S>
Precision precision_of() {
  return std::is_same_v<S, float> ? product_precision() : Precision::fp32;
}

/// The rows that products with a weight are taken to have: more than any.
inline constexpr Index any_rows = Index{1} << 20;
/// Tiles for a product of m x k and k x n in bf16x3, if there are any that are faster than multiply-adds: of less,
/// splitting panels and rows takes as long as is saved. With a weight m is `any_rows`: a row of x has the same bits
/// alone, in any batch, and on any number of threads.
inline const FloatTiles* float_tiles(Precision precision, Index m, Index n, Index k) {
  if (precision != Precision::bf16x3) return nullptr;
  const bool pays = m >= 128 && n >= 128 && k >= 128 && m * n >= (k < 256 ? 131072 : 32768);
  return pays ? tile_products.load(std::memory_order_relaxed)(kernels<float>()) : nullptr;
}

/// Room for a matrix, packed, that matrices of m rows are multiplied with.
template <class S>
Panels<S> panels_for(Index k, Index n, Precision precision, Index m = any_rows) {
  const bool bf16 = precision == Precision::bf16;
  Panels<S> p{k, n, precision, bf16 ? nullptr : &kernels<S>(), float_tiles(precision, m, n, k), {}};
  p.memory = BufferHandle(static_cast<std::size_t>(p.bytes()));
  return p;
}
/// Element (k, n) of the packed matrix is b[k * stride_k + n * stride_n]; one stride is 1. `finite`, for a transposed B
/// (stride_k is 1), becomes false if a value is not finite.
template <class S>
void pack_into(Panels<S>& p, const S* b, Index stride_k, Index stride_n, std::atomic<bool>* finite = nullptr) {
  const Index k = p.k, n = p.n;
  const bool bf16 = p.kernels == nullptr;
  // A task reads rows that lie together: rows of B as stored (in pairs, for bfloat16), or panels of a transposed B. A
  // column is both, but is only checked for finite values as transposed.
  const bool as_it_lies = stride_n == 1 && finite == nullptr;
  const Index count = !as_it_lies ? p.count() : bf16 ? bf16_depth(k) : k;
  const Index each = p.width() * (as_it_lies ? p.count() : k), step = as_it_lies ? 2 : 1;
  const Index at_once = std::max<Index>(1, 65536 / std::max<Index>(1, each) / step) * step;
  const auto pack = [&](const auto& with, auto* out) {
    parallel_for(parts(count, at_once), [&](Index i) {
      const Index first = i * at_once, last = std::min(count, first + at_once);
      if (as_it_lies)
        with.pack_rows(b, k, n, stride_k, first, last, out);
      else if (!with.pack_transposed(b, k, n, stride_n, first, last, out) && finite != nullptr)
        *finite = false;
    });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (bf16) {
      pack(bf16_product_kernels(), static_cast<std::uint16_t*>(p.memory.data()));
      return;
    }
  }
  pack(*p.kernels, static_cast<S*>(p.memory.data()));
}
template <class S>
Panels<S> pack_panels(const S* b, Index k, Index n, Index stride_k, Index stride_n,
                      Precision precision = Precision::fp32, std::atomic<bool>* finite = nullptr) {
  auto p = panels_for<S>(k, n, precision);
  pack_into(p, b, stride_k, stride_n, finite);
  return p;
}

/// True if a product of m x k and k x n is split.
inline bool worth_threads(Index m, Index n, Index k) { return m * n * k >= 100'000; }

/// The prepared form of a weight, if these kernels can read it.
template <class S>
const PreparedPanels<S>* prepared_panels(const Dense<S>& weight, Index n, Index k, Index taps) {
  const auto* p = static_cast<const PreparedPanels<S>*>(weight.attached());
  const bool fits = p != nullptr && p->panels.n == n && p->panels.k == k && p->taps == taps &&
                    (p->panels.precision == Precision::bf16 || p->panels.kernels == &kernels<S>());
  return fits ? p : nullptr;
}
/// The weight (out, in, taps) of a convolution as the matrix (out, taps in) that windows of rows are multiplied with.
template <class S>
Dense<S> window_matrix(const Dense<S>& weight) {
  const std::array axes{0, 2, 1};
  return DenseOps<S>::permute(weight, axes).reshaped(Shape{weight.shape()[0], weight.shape()[1] * weight.shape()[2]});
}

/// Scratch of products with such panels.
template <class S>
Scratch<S> gemm_scratch(const Panels<S>& p) {
  if constexpr (std::is_same_v<S, float>) {
    if (p.kernels == nullptr) return Scratch<S>(bf16_product_kernels().gemm_scratch(p.k));
  }
  return Scratch<S>(std::max(p.tiles == nullptr ? 0 : p.tiles->gemm_scratch(p.k), p.kernels->gemm_scratch(p.k)));
}
/// True if every thread takes its own rows of A and multiplies them with all panels. Otherwise threads share rows and
/// split the panels. A thread finds its own rows in its cache, where it wrote them. The rows of others come slowly:
/// with 16 threads a byte of them costs about as much as five bytes of panels, which are prefetched. False if there are
/// few rows and many panels, or if the rows do not fill tiles.
inline bool takes_own_rows(Index each, Index a_bytes, Index panel_bytes, Index rows_at_once, Index tile_rows) {
  const bool fills_tiles = each > 0 && 4 * each >= 3 * tile_rows * parts(each, tile_rows);
  return each >= std::max(tile_rows, rows_at_once / 4) || (fills_tiles && 5 * a_bytes >= panel_bytes);
}
/// The sharing of a product among threads.
struct Sharing {
  Index rows_at_once;     // in a block
  bool own_rows = false;  // takes_own_rows
  // Each thread has a part. Fast threads take the rest of a slower one (another kind of core, a busy one).
  Index pieces = 1;
};
/// Calls block(r0, r1, j0, j1) for parts of a product of this many rows and panels.
template <class F>
void for_blocks(Index rows, Index panels, bool split, const Sharing& how, const F& block) {
  const Index threads = split ? parallel_width() : 1, blocks = threads == 1 ? 1 : parts(rows, how.rows_at_once);
  // The same number for every thread.
  const Index row_parts = blocks > threads ? parts(blocks, threads) * threads : how.own_rows ? threads : blocks;
  const Index panel_parts = threads == 1 ? 1 : std::min(panels, parts(threads * how.pieces, row_parts));
  parallel_for(row_parts * panel_parts, [&](Index task) {
    const Index r = task / panel_parts, j = task % panel_parts;
    block(rows * r / row_parts, rows * (r + 1) / row_parts, panels * j / panel_parts, panels * (j + 1) / panel_parts);
  });
}

/// Nothing to be done behind a block of a product.
struct NothingBehind {
  void operator()(Index, Index, Index, Index) const {}
};
/// g with the right-hand side `p`; then each thread calls behind(r0, r1, c0, c1) for its own blocks of rows and
/// columns.
template <class S, class F = NothingBehind>
void run_gemm(Gemm<S> g, const Panels<S>& p, const Scratch<S>& scratch, const F& behind = {}) {
  if (g.m == 0 || g.n == 0) return;
  const bool split = worth_threads(g.m, g.n, g.k);
  const Index width = p.width(), a_bytes = g.m * g.k * static_cast<Index>(sizeof(S));
  const auto run = [&](const auto& kernel, Index pieces, const auto& multiply) {
    Sharing how{.rows_at_once = kernel.gemm_rows(g.k)};
    how.own_rows = takes_own_rows(g.m / parallel_width(), a_bytes, p.bytes(), how.rows_at_once, kernel.tile_rows);
    how.pieces = pieces;
    for_blocks(g.m, p.count(), split, how, [&](Index r0, Index r1, Index j0, Index j1) {
      multiply(r0, r1, j0, j1);
      behind(r0, r1, j0 * width, std::min(g.n, j1 * width));
    });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (p.kernels == nullptr) {
      const Bf16Kernels& kernel = bf16_product_kernels();
      run(kernel, 1, [&](Index r0, Index r1, Index j0, Index j1) {  // rows would be rounded for every piece
        kernel.gemm_block(g, p.bf16(), r0, r1, j0, j1, scratch.mine());
      });
      return;
    }
  }
  g.panels = p.data();
  const auto run_floats = [&](const auto& kernel, Index pieces) {
    run(kernel, pieces,
        [&](Index r0, Index r1, Index j0, Index j1) { kernel.gemm_block(g, r0, r1, j0, j1, scratch.mine()); });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (p.tiles != nullptr) return run_floats(*p.tiles, 1);
  }
  run_floats(*p.kernels, parallel_width() > 2 ? 3 : 1);
}

/// The number of the `count` products of m x k and k x n that single threads compute: a multiple of the threads. All
/// threads together compute each of the others.
inline Index products_apart(Index count, Index m, Index n, Index k) {
  return worth_threads(count * m, n, k) ? count - count % parallel_width() : 0;
}
/// Calls product(i) for 0 ... count-1.
template <class F>
void for_products(Index count, Index apart, const F& product) {
  parallel_for(apart, product);
  for (Index i = apart; i < count; ++i) product(i);
}

/// Packed sequences with rows of zeros at both ends of each. The windows of such a sequence have the layout of a matrix
/// in memory, but they overlap.
template <class S>
struct WithMargins {
  const Offsets& inside;
  Index margin, width;
  Dense<S> rows;

  WithMargins(const Dense<S>& x, const Offsets& o, Index m) : inside(o), margin(m), width(x.shape()[1]), rows(x) {
    if (margin == 0) return;
    rows = Dense<S>(Shape{inside.rows() + 2 * margin * inside.count(), width});
    parallel_ranges(inside.count(), inside.longest() * width, [&](Index first, Index last) {
      for (Index s = first; s < last; ++s) {
        S* to = std::fill_n(rows.data() + at(s), margin * width, S(0));
        to = std::copy_n(x.data() + inside.begin(s) * width, inside.length(s) * width, to);
        std::fill_n(to, margin * width, S(0));
      }
    });
  }
  /// The start of sequence s with its margin, among all values.
  Index at(Index s) const { return (inside.begin(s) + 2 * margin * s) * width; }
};

/// Calls f(place of a window's first value, its row among all windows) for every window of `size` values. One thread
/// handles all windows of a sequence.
template <class S, class F>
void for_windows(const WithMargins<S>& margins, const Offsets& windows, Index stride, Index size, const F& f) {
  parallel_ranges(windows.count(), windows.longest() * size, [&](Index first, Index last) {
    for (Index s = first; s < last; ++s) {
      for (Index t = 0; t < windows.length(s); ++t) f(margins.at(s) + t * stride * margins.width, windows.begin(s) + t);
    }
  });
}

/// Windows of x times a matrix (taps in, n), sequence by sequence.
template <class S>
Dense<S> convolve(const Dense<S>& x, const Offsets& before, const Offsets& after, const Panels<S>& matrix,
                  const S* bias, Index stride, Index padding, Activation act) {
  const WithMargins<S> margins(x, before, padding);
  Dense<S> y(Shape{after.rows(), matrix.n});
  const Scratch<S> scratch = gemm_scratch(matrix);
  for_products(after.count(), products_apart(after.count(), after.longest(), matrix.n, matrix.k), [&](Index s) {
    run_gemm(Gemm<S>{.m = after.length(s),
                     .n = matrix.n,
                     .k = matrix.k,
                     .a = margins.rows.data() + margins.at(s),
                     .lda = stride * margins.width,
                     .c = y.data() + after.begin(s) * matrix.n,
                     .ldc = matrix.n,
                     .bias = bias,
                     .act = act},
             matrix, scratch);
  });
  return y;
}

template <class S>
Attention<S> attention_arguments(const Offsets& q_offsets, const Offsets& k_offsets, Index width,
                                 const AttentionOptions& options) {
  return {.q_offsets = q_offsets.list().data(),
          .k_offsets = k_offsets.list().data(),
          .heads = options.heads,
          .width = width / options.heads,
          .causal = options.causal,
          .dropout = options.dropout};
}
template <class S>
void run_attention(const Attention<S>& t, const Offsets& q, const Offsets& k, Precision precision) {
  const auto run = [&](const auto& kernel) {
    const Scratch<S> scratch(kernel.attention_scratch(k.longest(), t.width));
    // Few heads: the queries of each are split, so that every thread has as many tasks. Each task packs keys and
    // values.
    const Index heads = q.count() * t.heads, threads = parallel_width();
    const Index equal = heads < 4 * threads ? threads / std::gcd(heads, threads) : 1;
    const Index pieces = std::clamp<Index>(equal, 1, std::max<Index>(1, parts(q.longest(), kernel.tile_rows)));
    parallel_for(heads * pieces, [&](Index task) {
      const Index i = task / pieces;
      if (q.length(i / t.heads) > 0)
        kernel.attention_head(t, i / t.heads, i % t.heads, task % pieces, pieces, scratch.mine());
    });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (precision == Precision::bf16) return run(bf16_product_kernels());
  }
  run(kernels<S>());
}
template <class S>
void run_attention_vjp(const Attention<S>& t, const AttentionGradients<S>& g, const Offsets& q, const Offsets& k,
                       Precision precision) {
  const auto run = [&](const auto& scratch_of, const auto& vjp) {
    const Scratch<S> scratch(scratch_of(q.longest(), k.longest(), t.width));
    parallel_for(q.count() * t.heads, [&](Index i) { vjp(t, g, i / t.heads, i % t.heads, scratch.mine()); });
  };
  if constexpr (std::is_same_v<S, float>) {
    if (precision == Precision::bf16) {
      const Bf16Kernels& kernel = bf16_product_kernels();
      return run(kernel.attention_vjp_scratch, kernel.attention_head_vjp);
    }
  }
  const GradientKernels<S>& kernel = gradient_kernels_of(kernels<S>());
  run(kernel.attention_scratch, kernel.attention_head);
}

/// `linear` with exchanged sides, y^T = weight x^T: the weight is read in its place, and only x is packed. The sums are
/// the same in the same order as with panels of the weight, so the results have the same bits (for multiply-adds; tiles
/// do not treat both sides alike).
template <class S>
Dense<S> exchanged_linear(const Dense<S>& x, const Dense<S>& weight, const S* bias, Activation act, const S* residual) {
  const Index n = weight.shape()[0], k = weight.shape()[1], m = x.shape()[0];
  const auto panels = pack_panels(x.data(), k, m, Index{1}, k);
  Dense<S> z(Shape{n, m}), y(Shape{m, n});
  run_gemm(Gemm<S>{.m = n, .n = m, .k = k, .a = weight.data(), .lda = k, .c = z.data(), .ldc = m}, panels,
           gemm_scratch(panels));
  const Transposed<S> t{
      .z = z.data(), .bias = bias, .residual = residual, .rows = m, .width = n, .act = act, .y = y.data()};
  constexpr Index columns = 64;
  parallel_for(parts(n, columns),
               [&](Index i) { kernels<S>().transpose(t, i * columns, std::min(n, (i + 1) * columns)); });
  return y;
}

/// Calls f(first, n) for pieces of a ... b-1 that stay in the first-level cache during several operations.
template <class F>
void pieces_of(Index a, Index b, const F& f) {
  constexpr Index piece = 2048;
  for (; a < b; a += piece) f(a, std::min(piece, b - a));
}
/// The same for 0 ... count-1, by all threads.
template <class F>
void in_pieces(Index count, const F& f) {
  parallel_ranges(count, 1, [&](Index a, Index b) { pieces_of(a, b, f); });
}

template <class S>
LayerNorm<S> layer_norm_arguments(const Dense<S>& x, const Dense<S>& weight, const S* bias, double eps, S* y) {
  return {.x = x.data(),
          .weight = weight.data(),
          .bias = bias,
          .width = x.shape().back(),
          .eps = static_cast<S>(eps),
          .y = y};
}

/// out = op(a, b) with broadcasting, row by row; the memory of an operand is reused if nobody else holds it.
template <class S>
Dense<S> kernel_binary(BinaryOp op, Dense<S> a, Dense<S> b) {
  const Shape s = a.shape() == b.shape() ? a.shape() : broadcast_shapes(a.shape(), b.shape(), "binary operation");
  const auto pattern = broadcast_pattern(a.shape(), b.shape(), s);
  if (!pattern) return kernel_binary(op, DenseOps<S>::broadcast(a, s), DenseOps<S>::broadcast(b, s));
  const auto& [outer, inner, walk_a, walk_b] = *pattern;
  Dense<S> out = a.unique() && a.shape() == s ? a : b.unique() && b.shape() == s ? b : Dense<S>(s);
  if (inner == 0) return out;
  auto apply = [&, pattern = *pattern](Index i, Index first, Index last) {  // columns first ... last-1 of row i
    auto at = [&](const Dense<S>& x, const BroadcastPattern::Operand& walk) {
      return x.data() + (walk.outer ? i * (walk.inner ? pattern.inner : 1) : 0) + (walk.inner ? first : 0);
    };
    kernels<S>().binary({.op = op,
                         .a = at(a, pattern.a),
                         .b = at(b, pattern.b),
                         .a_repeated = !pattern.a.inner,
                         .b_repeated = !pattern.b.inner,
                         .count = last - first,
                         .y = out.data() + i * pattern.inner + first});
  };
  if (outer == 1) {
    parallel_ranges(inner, 1, [&](Index first, Index last) { apply(0, first, last); });
  } else {
    parallel_ranges(outer, inner, [&, n = inner](Index first, Index last) {
      for (Index i = first; i < last; ++i) apply(i, 0, n);
    });
  }
  return out;
}

}  // namespace detail

template <Scalar S>
Dense<S> KernelOps<S>::add(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::add, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> KernelOps<S>::sub(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::sub, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> KernelOps<S>::mul(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::mul, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> KernelOps<S>::div(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::div, std::move(a), std::move(b));
}
template <Scalar S>
Dense<S> KernelOps<S>::maximum(Dense<S> a, Dense<S> b) {
  return detail::kernel_binary(detail::BinaryOp::maximum, std::move(a), std::move(b));
}

template <Scalar S>
Dense<S> KernelOps<S>::sum(const Dense<S>& a, int axis) {
  const Shape& s = a.shape();
  const Index n = s[axis], inner = s.count(axis + 1, s.rank());
  Dense<S> y(s.without(axis));
  const detail::Kernels<S>& kernel = detail::kernels<S>();
  const auto rows = [&](Index first, Index last) { kernel.row_sums(a.data(), n, first, last, y.data()); };
  const auto columns = [&](Index i, Index first, Index last) {
    kernel.column_sums(a.data() + i * n * inner, n, inner, first, last, y.data() + i * inner);
  };
  detail::for_reduction(s, axis, rows, columns);
  return y;
}

template <Scalar S>
Dense<S> KernelOps<S>::matmul(const Dense<S>& a, const Dense<S>& b, bool transpose_a, bool transpose_b) {
  const int r = a.shape().rank();
  const Index m = a.shape()[r - (transpose_a ? 1 : 2)], k = a.shape()[r - (transpose_a ? 2 : 1)];
  const Index n = b.shape()[r - (transpose_b ? 2 : 1)];
  Shape s = a.shape();
  s[r - 2] = m;
  s[r - 1] = n;
  Dense<S> out(s);
  const Index count = s.count(0, r - 2), apart = detail::products_apart(count, m, n, k);
  PoolVector<detail::Panels<S>> rooms;  // one for every thread that packs
  for (int i = 0; i < (apart > 0 ? parallel_width() : 1); ++i)
    rooms.push_back(detail::panels_for<S>(k, n, detail::precision_of<S>(), m));
  const auto scratch = detail::gemm_scratch(rooms[0]);
  detail::for_products(count, apart, [&](Index i) {
    auto& panels = rooms[rooms.size() == 1 ? 0 : static_cast<std::size_t>(thread_number())];
    detail::pack_into(panels, b.data() + i * k * n, transpose_b ? 1 : n, transpose_b ? k : 1);
    detail::run_gemm(detail::Gemm<S>{.m = m,
                                     .n = n,
                                     .k = k,
                                     .a = a.data() + i * m * k,
                                     .lda = transpose_a ? m : k,
                                     .a_transposed = transpose_a,
                                     .c = out.data() + i * m * n,
                                     .ldc = n},
                     panels, scratch);
  });
  return out;
}

template <Scalar S>
Index KernelOps<S>::rows_in_cache() {
  return 256 * parallel_width();  // of a few thousand numbers each, 2 to 4 MB
}

template <Scalar S>
bool KernelOps<S>::prepare(const Dense<S>& weight, Precision precision) {
  const Index taps = weight.shape().rank() == 3 ? weight.shape()[2] : 1;
  const Dense<S> matrix = taps > 1 ? detail::window_matrix(weight) : weight;
  const Index n = weight.shape()[0], k = taps * weight.shape()[1];
  std::atomic<bool> finite{true};
  auto& before = thread_object<std::weak_ptr<const detail::PreparedPanels<S>>>();
  const auto prepared = std::make_shared<const detail::PreparedPanels<S>>(
      detail::pack_panels(matrix.data(), k, n, Index{1}, k, std::is_same_v<S, float> ? precision : Precision::fp32,
                          &finite),
      taps);
  if (const auto last = before.lock()) {
    last->next_bytes = prepared->panels.bytes();
    last->next = static_cast<const std::byte*>(prepared->panels.memory.data());
  }
  before = prepared;
  weight.attach(prepared);
  return finite;
}

template <Scalar S>
Precision KernelOps<S>::precision_of(const Dense<S>& weight) {
  const auto* p = static_cast<const detail::PreparedPanels<S>*>(weight.attached());
  return p == nullptr ? detail::precision_of<S>() : p->panels.precision;
}

template <Scalar S>
Dense<S> KernelOps<S>::linear(const Dense<S>& x, const Dense<S>& weight, const Dense<S>* bias, Activation act,
                              const Dense<S>* residual, const Dropout& drop) {
  const Index n = weight.shape()[0], k = weight.shape()[1], m = x.shape()[0];
  const auto* prepared = detail::prepared_panels(weight, n, k, 1);
  const auto* ready = prepared == nullptr ? nullptr : &prepared->panels;
  // The kernel applies the nonlinearity last, and does not support dropout.
  const bool last = drop.p == 0 && (residual == nullptr || act == Activation::none);
  detail::Panels<S> packed;
  Dense<S> y;
  const auto finish = [&](Index first, Index count) {
    const detail::Kernels<S>& kernel = detail::kernels<S>();
    S* to = y.data() + first;
    if (drop.p > 0) kernel.dropout(to, count, first, drop, to);
    if (residual != nullptr)
      kernel.binary({.op = detail::BinaryOp::add, .a = to, .b = residual->data() + first, .count = count, .y = to});
  };
  const auto behind = [&](Index r0, Index r1, Index c0, Index c1) {
    if (last) return;
    if (c1 - c0 == n) return detail::pieces_of(r0 * n, r1 * n, finish);
    for (Index r = r0; r < r1; ++r) finish(r * n + c0, c1 - c0);
  };
  if (ready == nullptr) {
    const Precision precision = precision_of(weight);  // of panels that other kernels have packed, too
    if (precision != Precision::bf16 && m > 0 && m * (n + k) < n * k &&  // x and y are smaller than the weight
        detail::float_tiles(precision, detail::any_rows, n, k) == nullptr) {
      y = detail::exchanged_linear(x, weight, bias == nullptr ? nullptr : bias->data(), act,
                                   residual == nullptr || !last ? nullptr : residual->data());
      behind(0, m, 0, n);
      return y;
    }
    packed = detail::pack_panels(weight.data(), k, n, Index{1}, k, precision);
    ready = &packed;
  }
  y = Dense<S>(Shape{m, n});
  detail::run_gemm(
      detail::Gemm<S>{.m = m,
                      .n = n,
                      .k = k,
                      .a = x.data(),
                      .lda = k,
                      .c = y.data(),
                      .ldc = n,
                      .bias = bias == nullptr ? nullptr : bias->data(),
                      .residual = residual == nullptr || !last ? nullptr : residual->data(),
                      .ldr = n,
                      .act = act,
                      .after = ready == &packed ? nullptr : prepared->next.load(std::memory_order_relaxed),
                      .after_bytes = ready == &packed ? 0 : prepared->next_bytes.load(std::memory_order_relaxed)},
      *ready, detail::gemm_scratch(*ready), behind);
  return y;
}

template <Scalar S>
Dense<S> KernelOps<S>::conv1d(const Dense<S>& x, const Offsets& before, const Offsets& after, const Dense<S>& weight,
                              const Dense<S>* bias, Index stride, Index padding, Activation act) {
  const Index n = weight.shape()[0], taps = weight.shape()[2], k = taps * weight.shape()[1];
  const auto* prepared = detail::prepared_panels(weight, n, k, taps);
  detail::Panels<S> packed;
  if (prepared == nullptr)
    packed = detail::pack_panels(detail::window_matrix(weight).data(), k, n, Index{1}, k, precision_of(weight));
  return detail::convolve(x, before, after, prepared == nullptr ? packed : prepared->panels,
                          bias == nullptr ? nullptr : bias->data(), stride, padding, act);
}
template <Scalar S>
Dense<S> KernelOps<S>::conv1d_weight_vjp(const Dense<S>& x, const Offsets& before, const Offsets& after, Index taps,
                                         Index stride, Index padding, const Dense<S>& dy) {
  const Index n = dy.shape()[1], in = x.shape()[1];
  const detail::WithMargins<S> margins(x, before, padding);
  Dense<S> windows(Shape{after.rows(), taps * in});
  detail::for_windows(margins, after, stride, taps * in, [&](Index from, Index row) {
    std::copy_n(margins.rows.data() + from, taps * in, windows.data() + row * taps * in);
  });
  const std::array axes{0, 2, 1};
  return DenseOps<S>::permute(matmul(dy, windows, true, false).reshaped(Shape{n, taps, in}), axes);
}
template <Scalar S>
Dense<S> KernelOps<S>::conv1d_input_vjp(const Dense<S>& weight, const Offsets& before, const Offsets& after,
                                        Index stride, Index padding, const Dense<S>& dy) {
  const Index n = weight.shape()[0], in = weight.shape()[1], taps = weight.shape()[2];
  if (stride == 1 && padding < taps) {  // also a convolution, with its taps in the opposite order
    const std::array axes{1, 2, 0};
    Dense<S> turned = DenseOps<S>::permute(weight, axes);  // (in, taps, out)
    parallel_ranges(in, taps * n, [&](Index first, Index last) {
      for (Index i = first; i < last; ++i) {
        S* rows = turned.data() + i * taps * n;
        for (Index j = 0; 2 * j + 1 < taps; ++j)
          std::swap_ranges(rows + j * n, rows + (j + 1) * n, rows + (taps - 1 - j) * n);
      }
    });
    const auto panels =
        detail::pack_panels(std::as_const(turned).data(), taps * n, in, Index{1}, taps * n, detail::precision_of<S>());
    return detail::convolve<S>(dy, after, before, panels, nullptr, 1, taps - 1 - padding, Activation::none);
  }
  const Dense<S> windows = matmul(dy, detail::window_matrix(weight), false, false);
  detail::WithMargins<S> margins(Dense<S>::full(Shape{before.rows(), in}, S(0)), before, padding);
  detail::for_windows(margins, after, stride, taps * in, [&](Index to, Index row) {
    const S* from = windows.data() + row * taps * in;
    for (Index i = 0; i < taps * in; ++i) margins.rows.data()[to + i] += from[i];
  });
  Dense<S> dx(Shape{before.rows(), in});
  for (Index s = 0; s < before.count(); ++s) {
    std::copy_n(std::as_const(margins.rows).data() + margins.at(s) + padding * in, before.length(s) * in,
                dx.data() + before.begin(s) * in);
  }
  return dx;
}

template <Scalar S>
Dense<S> KernelOps<S>::activate(const Dense<S>& x, Activation act, const Dropout& drop) {
  Dense<S> y(x.shape());
  detail::in_pieces(x.count(), [&](Index a, Index n) {
    detail::kernels<S>().activate(x.data() + a, n, act, y.data() + a);
    if (drop.p > 0) detail::kernels<S>().dropout(y.data() + a, n, a, drop, y.data() + a);
  });
  return y;
}
template <Scalar S>
Dense<S> KernelOps<S>::activate_vjp(const Dense<S>& x, const Dense<S>& dy, Activation act, const Dropout& drop) {
  Dense<S> dx(x.shape());
  const auto& kernel = detail::gradient_kernels_of(detail::kernels<S>());
  detail::in_pieces(x.count(), [&](Index a, Index n) {
    const S* g = dy.data() + a;
    if (drop.p > 0) detail::kernels<S>().dropout(g, n, a, drop, dx.data() + a), g = dx.data() + a;
    kernel.activate(x.data() + a, g, n, act, dx.data() + a);
  });
  return dx;
}

template <Scalar S>
Dense<S> KernelOps<S>::layer_norm(const Dense<S>& x, const Dense<S>& weight, const Dense<S>& bias, double eps) {
  Dense<S> y(x.shape());
  const auto t = detail::layer_norm_arguments(x, weight, bias.data(), eps, y.data());
  parallel_ranges(x.shape()[0], t.width, [&](Index a, Index b) { detail::kernels<S>().layer_norm_rows(t, a, b); });
  return y;
}
template <Scalar S>
Dense<S> KernelOps<S>::add_layer_norm(const Dense<S>& x, const Dense<S>& residual, const Dense<S>& weight,
                                      const Dense<S>& bias, double eps) {
  Dense<S> y(x.shape());
  auto t = detail::layer_norm_arguments(x, weight, bias.data(), eps, y.data());
  t.residual = residual.data();
  parallel_ranges(x.shape()[0], t.width, [&](Index a, Index b) { detail::kernels<S>().layer_norm_rows(t, a, b); });
  return y;
}
template <Scalar S>
std::array<Dense<S>, 3> KernelOps<S>::layer_norm_vjp(const Dense<S>& x, const Dense<S>& weight, double eps,
                                                     const Dense<S>& dy) {
  const Index rows = x.shape()[0];
  const auto t = detail::layer_norm_arguments<S>(x, weight, nullptr, eps, nullptr);
  Dense<S> dx(x.shape()), dweight(weight.shape()), dbias(weight.shape()), moments(Shape{rows, 2});
  const auto& kernel = detail::gradient_kernels_of(detail::kernels<S>());
  parallel_ranges(rows, t.width,
                  [&](Index a, Index b) { kernel.layer_norm_rows(t, dy.data(), dx.data(), moments.data(), a, b); });
  parallel_columns(rows, t.width, [&](Index a, Index b) {
    kernel.layer_norm_columns(t, dy.data(), moments.data(), dweight.data(), dbias.data(), rows, a, b);
  });
  return {std::move(dx), std::move(dweight), std::move(dbias)};
}

template <Scalar S>
Dense<S> KernelOps<S>::softmax(const Dense<S>& x) {
  Dense<S> y(x.shape());
  const Index n = x.shape().back();
  const detail::Scratch<S> scratch(n + 64);
  parallel_ranges(x.shape()[0], n, [&](Index a, Index b) {
    detail::kernels<S>().softmax_rows(x.data(), n, a, b, y.data(), scratch.mine());
  });
  return y;
}
template <Scalar S>
Dense<S> KernelOps<S>::dropout(const Dense<S>& x, const Dropout& d) {
  Dense<S> y(x.shape());
  parallel_ranges(x.count(), 1,
                  [&](Index a, Index b) { detail::kernels<S>().dropout(x.data() + a, b - a, a, d, y.data() + a); });
  return y;
}
template <Scalar S>
Dense<S> KernelOps<S>::attention(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v, const Offsets& q_offsets,
                                 const Offsets& k_offsets, const AttentionOptions& options,
                                 const Dense<S>* relative_scores) {
  const Index d = q.shape()[1];
  Dense<S> o(q.shape());
  auto t = detail::attention_arguments<S>(q_offsets, k_offsets, d, options);
  if (relative_scores != nullptr)
    t.relative_scores = relative_scores->data(), t.reach = relative_scores->shape()[1] / 2;
  t.q = q.data(), t.k = k.data(), t.v = v.data(), t.o = o.data();
  t.q_stride = t.k_stride = t.v_stride = t.o_stride = d;
  detail::run_attention(t, q_offsets, k_offsets, options.precision);
  return o;
}
template <Scalar S>
std::array<Dense<S>, 3> KernelOps<S>::attention_vjp(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v,
                                                    const Offsets& q_offsets, const Offsets& k_offsets,
                                                    const AttentionOptions& options, const Dense<S>& dy) {
  const Index d = q.shape()[1];
  Dense<S> dq(q.shape()), dk(k.shape()), dv(v.shape());
  auto t = detail::attention_arguments<S>(q_offsets, k_offsets, d, options);
  t.q = q.data(), t.k = k.data(), t.v = v.data();
  t.q_stride = t.k_stride = t.v_stride = t.o_stride = d;
  detail::run_attention_vjp(t, detail::AttentionGradients<S>{dy.data(), dq.data(), dk.data(), dv.data()}, q_offsets,
                            k_offsets, options.precision);
  return {std::move(dq), std::move(dk), std::move(dv)};
}
template <Scalar S>
Dense<S> KernelOps<S>::self_attention(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options) {
  const Index d = qkv.shape()[1] / 3;
  Dense<S> o(Shape{qkv.shape()[0], d});
  auto t = detail::attention_arguments<S>(offsets, offsets, d, options);
  t.q = qkv.data(), t.k = qkv.data() + d, t.v = qkv.data() + 2 * d, t.o = o.data();
  t.q_stride = t.k_stride = t.v_stride = 3 * d, t.o_stride = d;
  detail::run_attention(t, offsets, offsets, options.precision);
  return o;
}
template <Scalar S>
Dense<S> KernelOps<S>::self_attention_vjp(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options,
                                          const Dense<S>& dy) {
  const Index d = qkv.shape()[1] / 3;
  Dense<S> g(qkv.shape());
  auto t = detail::attention_arguments<S>(offsets, offsets, d, options);
  t.q = qkv.data(), t.k = qkv.data() + d, t.v = qkv.data() + 2 * d;
  t.q_stride = t.k_stride = t.v_stride = 3 * d, t.o_stride = d;
  detail::run_attention_vjp(t, detail::AttentionGradients<S>{dy.data(), g.data(), g.data() + d, g.data() + 2 * d},
                            offsets, offsets, options.precision);
  return g;
}

template <Scalar S>
void KernelOps<S>::adamw(Dense<S>& parameter, Dense<S>& m, Dense<S>& v, const Dense<S>& gradient,
                         const AdamwUpdate& u) {
  for (Dense<S>* d : {&parameter, &m, &v}) {
    if (!d->unique()) *d = Dense<S>::from_span(d->span(), d->shape());
  }
  const double step = static_cast<double>(u.step);
  const detail::AdamwStep<S> t{
      .p = parameter.data(),
      .m = m.data(),
      .v = v.data(),
      .g = gradient.data(),
      .beta1 = static_cast<S>(u.beta1),
      .rest1 = static_cast<S>(1 - u.beta1),  // in double: in float the fifth digit would be wrong
      .beta2 = static_cast<S>(u.beta2),
      .rest2 = static_cast<S>(1 - u.beta2),
      .step = static_cast<S>(u.lr / (1 - std::pow(u.beta1, step))),
      .correction = static_cast<S>(1 / std::sqrt(1 - std::pow(u.beta2, step))),
      .eps = static_cast<S>(u.eps),
      .decay = static_cast<S>(1 - u.lr * u.weight_decay),
      .gradient_scale = static_cast<S>(u.gradient_scale)};
  const auto& kernel = detail::gradient_kernels_of(detail::kernels<S>());
  parallel_ranges(parameter.count(), 1, [&](Index a, Index b) { kernel.adamw(t, a, b); });
}

MOTIONLANG_NAMESPACE_END
