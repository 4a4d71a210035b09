// SPDX-License-Identifier: MIT
/// Bodies of kernel_ops.hpp: shapes to pointers, and the split of the work over threads.
///
/// Work is split over rows or columns of the result only, never over a summed index.
#pragma once

#include <atomic>   // a finding of several threads, the weight prepared next
#include <memory>   // shared_ptr
#include <utility>  // move

#include <motionlang/backend/detail/kernels.hpp>
#include <motionlang/backend/kernel_ops.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/core/precision.hpp>
#include <motionlang/core/thread_object.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// Memory that the kernels of a parallel region may scribble on, a piece for every thread. The caller takes it, so that a
/// region that ran before takes nothing from the system, whichever threads do the work.
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

/// A matrix (k, n) in panels: of S for `kernels`, or of bfloat16.
template <class S>
struct Panels {
  Index k = 0, n = 0;
  const Kernels<S>* kernels = nullptr;  // none: bfloat16
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

/// The panels of a weight that was prepared, and those of the weight that was prepared after it: probably multiplied with next. Of these only
/// the place is known, for the cache: they may be gone.
template <class S>
struct PreparedPanels {
  explicit PreparedPanels(Panels<S> p) : panels(std::move(p)) {}

  Panels<S> panels;
  mutable std::atomic<const std::byte*> next{nullptr};
  mutable std::atomic<Index> next_bytes{0};
};

inline Index parts(Index count, Index size) { return (count + size - 1) / size; }

/// Precision of products of S.
template <class S>
Precision precision_of() {
  return std::is_same_v<S, float> ? product_precision() : Precision::fp32;
}

/// Element (k, n) of the packed matrix is b[k * stride_k + n * stride_n]; one stride is 1. `finite`, for a
/// transposed B (stride_k is 1), becomes false if a number is not.
template <class S>
Panels<S> pack_panels(const S* b, Index k, Index n, Index stride_k, Index stride_n,
                      Precision precision = Precision::fp32, std::atomic<bool>* finite = nullptr) {
  const Kernels<S>& kernel = kernels<S>();
  const bool bf16 = precision == Precision::bf16;
  Panels<S> p{k, n, bf16 ? nullptr : &kernel, {}};
  p.memory = BufferHandle(static_cast<std::size_t>(p.bytes()));
  // What a task reads lies together: rows of B as it lies (in pairs, for bfloat16), panels of a transposed B. A column is both, but only
  // as transposed is it looked at.
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
      pack(*current_bf16_kernels(), static_cast<std::uint16_t*>(p.memory.data()));
      return p;
    }
  }
  pack(kernel, static_cast<S*>(p.memory.data()));
  return p;
}

/// Calls block(r0, r1, j0, j1, scratch) for parts of a product of so many rows and panels.
template <class S, class F>
void for_blocks(Index rows, Index panels, Index rows_at_once, bool small, Index scratch_count, const F& block) {
  const Index threads = small ? 1 : parallel_width(), blocks = threads == 1 ? 1 : parts(rows, rows_at_once);
  // As many for every thread; fewer rows than fill a block are shared as long as each thread has some tiles of them.
  const Index row_parts = blocks > threads                       ? parts(blocks, threads) * threads
                          : rows >= threads * (rows_at_once / 4) ? threads
                                                                 : blocks;
  const Index panel_parts = threads == 1 ? 1 : std::min(panels, parts(threads, row_parts));
  const Scratch<S> scratch(scratch_count);
  parallel_for(row_parts * panel_parts, [&](Index task) {
    const Index r = task / panel_parts, j = task % panel_parts;
    block(rows * r / row_parts, rows * (r + 1) / row_parts, panels * j / panel_parts, panels * (j + 1) / panel_parts,
          scratch.mine());
  });
}

/// Nothing to be done behind a block of a product.
struct NothingBehind {
  void operator()(Index, Index, Index, Index) const {}
};
/// g with the right-hand side `p`; then behind(r0, r1, c0, c1) for every thread's blocks of rows and columns, by that thread.
template <class S, class F = NothingBehind>
void run_gemm(Gemm<S> g, const Panels<S>& p, const F& behind = {}) {
  if (g.m == 0 || g.n == 0) return;
  const bool small = g.m * g.n * g.k < 100'000;
  const Index width = p.width();
  if constexpr (std::is_same_v<S, float>) {
    if (p.kernels == nullptr) {
      const Bf16Kernels& kernel = *current_bf16_kernels();
      for_blocks<S>(g.m, p.count(), kernel.gemm_rows(g.k), small, kernel.gemm_scratch(g.k),
                    [&](Index r0, Index r1, Index j0, Index j1, S* scratch) {
                      kernel.gemm_block(g, p.bf16(), r0, r1, j0, j1, scratch);
                      behind(r0, r1, j0 * width, std::min(g.n, j1 * width));
                    });
      return;
    }
  }
  const Kernels<S>& kernel = kernels<S>();
  g.panels = p.data();
  for_blocks<S>(g.m, p.count(), kernel.gemm_rows(g.k), small, kernel.gemm_scratch(g.k),
                [&](Index r0, Index r1, Index j0, Index j1, S* scratch) {
                  kernel.gemm_block(g, r0, r1, j0, j1, scratch);
                  behind(r0, r1, j0 * width, std::min(g.n, j1 * width));
                });
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
/// f(kernels), whose attention is that of the current precision.
template <class S, class F>
void with_attention_kernels(const F& f) {
  if constexpr (std::is_same_v<S, float>) {
    if (product_precision() == Precision::bf16) return f(*current_bf16_kernels());
  }
  f(kernels<S>());
}
template <class S>
void run_attention(const Attention<S>& t, const Offsets& q, const Offsets& k) {
  with_attention_kernels<S>([&](const auto& kernel) {
    const Scratch<S> scratch(kernel.attention_scratch(k.longest(), t.width));
    parallel_for(q.count() * t.heads, [&](Index i) {
      if (q.length(i / t.heads) > 0) kernel.attention_head(t, i / t.heads, i % t.heads, scratch.mine());
    });
  });
}
template <class S>
void run_attention_vjp(const Attention<S>& t, const AttentionGradients<S>& g, const Offsets& q, const Offsets& k) {
  with_attention_kernels<S>([&](const auto& kernel) {
    const Scratch<S> scratch(kernel.attention_vjp_scratch(q.longest(), k.longest(), t.width));
    parallel_for(q.count() * t.heads,
                 [&](Index i) { kernel.attention_head_vjp(t, g, i / t.heads, i % t.heads, scratch.mine()); });
  });
}

/// linear with the sides exchanged, y^T = weight x^T: the weight is read where it lies, only x is packed. The same sums in the same
/// order as with panels of the weight, so the same bits.
template <class S>
Dense<S> exchanged_linear(const Dense<S>& x, const Dense<S>& weight, const S* bias, Activation act, const S* residual) {
  const Index n = weight.shape()[0], k = weight.shape()[1], m = x.shape()[0];
  const auto panels = pack_panels(x.data(), k, m, Index{1}, k);
  Dense<S> z(Shape{n, m}), y(Shape{m, n});
  run_gemm(Gemm<S>{.m = n, .n = m, .k = k, .a = weight.data(), .lda = k, .c = z.data(), .ldc = m}, panels);
  const Transposed<S> t{
      .z = z.data(), .bias = bias, .residual = residual, .rows = m, .width = n, .act = act, .y = y.data()};
  constexpr Index columns = 64;
  parallel_for(parts(n, columns),
               [&](Index i) { kernels<S>().transpose(t, i * columns, std::min(n, (i + 1) * columns)); });
  return y;
}

/// f(first, n) for pieces of a ... b-1 that stay in the first-level cache while several things are done with them.
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

}  // namespace detail

template <Scalar S>
Dense<S> KernelOps<S>::matmul(const Dense<S>& a, const Dense<S>& b, bool transpose_a, bool transpose_b) {
  const int r = a.shape().rank();
  const Index m = a.shape()[r - (transpose_a ? 1 : 2)], k = a.shape()[r - (transpose_a ? 2 : 1)];
  const Index n = b.shape()[r - (transpose_b ? 2 : 1)];
  Shape s = a.shape();
  s[r - 2] = m;
  s[r - 1] = n;
  Dense<S> out(s);
  for (Index i = 0; i < s.count(0, r - 2); ++i) {
    const auto panels = detail::pack_panels(b.data() + i * k * n, k, n, transpose_b ? 1 : n, transpose_b ? k : 1,
                                            detail::precision_of<S>());
    detail::run_gemm(detail::Gemm<S>{.m = m,
                                     .n = n,
                                     .k = k,
                                     .a = a.data() + i * m * k,
                                     .lda = transpose_a ? m : k,
                                     .a_transposed = transpose_a,
                                     .c = out.data() + i * m * n,
                                     .ldc = n},
                     panels);
  }
  return out;
}

template <Scalar S>
Index KernelOps<S>::rows_in_cache() {
  return 256 * parallel_width();  // of a few thousand numbers each, 2 to 4 MB
}

template <Scalar S>
bool KernelOps<S>::prepare(const Dense<S>& weight) {
  const Index n = weight.shape()[0], k = weight.shape()[1];
  std::atomic<bool> finite{true};
  auto& before = thread_object<std::weak_ptr<const detail::PreparedPanels<S>>>();
  const auto prepared = std::make_shared<const detail::PreparedPanels<S>>(
      detail::pack_panels(weight.data(), k, n, Index{1}, k, detail::precision_of<S>(), &finite));
  if (const auto last = before.lock()) {
    last->next_bytes = prepared->panels.bytes();
    last->next = static_cast<const std::byte*>(prepared->panels.memory.data());
  }
  before = prepared;
  weight.attach(prepared);
  return finite;
}

template <Scalar S>
Dense<S> KernelOps<S>::linear(const Dense<S>& x, const Dense<S>& weight, const Dense<S>* bias, Activation act,
                              const Dense<S>* residual, const Dropout& drop) {
  const Index n = weight.shape()[0], k = weight.shape()[1], m = x.shape()[0];
  const auto* prepared = static_cast<const detail::PreparedPanels<S>*>(weight.attached());
  const auto* ready = prepared == nullptr ? nullptr : &prepared->panels;
  // The kernel applies the nonlinearity after everything, and knows no dropout.
  const bool last = drop.p == 0 && (residual == nullptr || act == Activation::none);
  detail::Panels<S> packed;
  const Precision precision = detail::precision_of<S>();
  const detail::Kernels<S>* wanted = precision == Precision::bf16 ? nullptr : &detail::kernels<S>();
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
  if (ready == nullptr || ready->kernels != wanted || ready->n != n || ready->k != k) {
    if (wanted != nullptr && m > 0 && m * (n + k) < n * k) {  // x and y are smaller than the weight
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
      *ready, behind);
  return y;
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
  detail::in_pieces(x.count(), [&](Index a, Index n) {
    const S* g = dy.data() + a;
    if (drop.p > 0) detail::kernels<S>().dropout(g, n, a, drop, dx.data() + a), g = dx.data() + a;
    detail::kernels<S>().activate_vjp(x.data() + a, g, n, act, dx.data() + a);
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
  parallel_ranges(rows, t.width, [&](Index a, Index b) {
    detail::kernels<S>().layer_norm_rows_vjp(t, dy.data(), dx.data(), moments.data(), a, b);
  });
  const Index columns = std::max<Index>(64, detail::parts(t.width, parallel_width()));
  parallel_for(detail::parts(t.width, columns), [&](Index i) {
    detail::kernels<S>().layer_norm_columns_vjp(t, dy.data(), moments.data(), dweight.data(), dbias.data(), rows,
                                                i * columns, std::min(t.width, (i + 1) * columns));
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
Dense<S> KernelOps<S>::column_sums(const Dense<S>& x) {
  const Index rows = x.shape()[0], width = x.shape()[1],
              columns = std::max<Index>(64, detail::parts(width, parallel_width()));
  Dense<S> y(Shape{width});
  parallel_for(detail::parts(width, columns), [&](Index i) {
    detail::kernels<S>().column_sums(x.data(), rows, width, i * columns, std::min(width, (i + 1) * columns), y.data());
  });
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
  detail::run_attention(t, q_offsets, k_offsets);
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
                            k_offsets);
  return {std::move(dq), std::move(dk), std::move(dv)};
}
template <Scalar S>
Dense<S> KernelOps<S>::self_attention(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options) {
  const Index d = qkv.shape()[1] / 3;
  Dense<S> o(Shape{qkv.shape()[0], d});
  auto t = detail::attention_arguments<S>(offsets, offsets, d, options);
  t.q = qkv.data(), t.k = qkv.data() + d, t.v = qkv.data() + 2 * d, t.o = o.data();
  t.q_stride = t.k_stride = t.v_stride = 3 * d, t.o_stride = d;
  detail::run_attention(t, offsets, offsets);
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
                            offsets, offsets);
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
      .rest1 = static_cast<S>(1 - u.beta1),  // of doubles: of floats it is wrong in the fifth digit
      .beta2 = static_cast<S>(u.beta2),
      .rest2 = static_cast<S>(1 - u.beta2),
      .step = static_cast<S>(u.lr / (1 - std::pow(u.beta1, step))),
      .correction = static_cast<S>(1 / std::sqrt(1 - std::pow(u.beta2, step))),
      .eps = static_cast<S>(u.eps),
      .decay = static_cast<S>(1 - u.lr * u.weight_decay),
      .gradient_scale = static_cast<S>(u.gradient_scale)};
  parallel_ranges(parameter.count(), 1, [&](Index a, Index b) { detail::kernels<S>().adamw(t, a, b); });
}

}  // namespace motionlang::inline MOTIONLANG_ABI
