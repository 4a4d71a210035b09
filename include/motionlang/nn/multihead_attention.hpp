// SPDX-License-Identifier: MIT
/// Multi-head attention with PyTorch's packing of the projections.
#pragma once

#include <motionlang/nn/dropout.hpp>
#include <motionlang/nn/linear.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Throws config_error 101 if the heads do not divide the width. In a constant expression this is a compile error.
constexpr void check_heads(Index width, Index heads) {
  if (heads < 1 || width % heads != 0) {
    raise<config_error>(101, "MultiheadAttention: ", heads, " heads do not divide width ", width);
  }
}

/// Vaswani et al. (2017), section 3.2.2. `in_proj_weight` (3 width, width) holds the rows of query, key and value in
/// that order.
template <Backend B>
struct MultiheadAttention {
  Tensor<B, 2> in_proj_weight;
  Tensor<B, 1> in_proj_bias;
  Linear<B> out_proj;
  Index heads = 1;
  double dropout_p = 0.1;  // on the attention weights

  static constexpr auto fields() {
    using M = MultiheadAttention;
    return motionlang::fields("in_proj_weight", &M::in_proj_weight, "in_proj_bias", &M::in_proj_bias, "out_proj",
                              &M::out_proj, "heads", &M::heads, "dropout_p", &M::dropout_p);
  }
  MultiheadAttention() = default;
  /// Throws config_error 101 if the heads do not divide the width.
  MultiheadAttention(Index width, Index heads_, double dropout, Rng auto& rng)
      : in_proj_weight(xavier_uniform<B>({3 * width, width}, rng)),
        in_proj_bias(constant_init<B, 1>({3 * width}, 0)),
        out_proj(width, width, rng),
        heads(heads_),
        dropout_p(dropout) {
    check_heads(width, heads);
    out_proj.bias = constant_init<B, 1>({width}, 0);
  }

  /// x (rows, width) attends to itself within each sequence. The result is projected, gets dropout with probability
  /// `drop` (if the context has a generator), and is added to `residual`.
  Tensor<B, 2> self(const Tensor<B, 2>& x, const Offsets& offsets, const Context& context,
                    const Tensor<B, 2>* residual = nullptr, bool causal = false, double drop = 0) const {
    return attend(project(x), offsets, context, residual, causal, drop);
  }
  /// Queries, keys and values of each row, (rows, 3 width).
  Tensor<B, 2> project(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    return linear(x, in_proj_weight, &in_proj_bias);
  }
  /// `self` after `project`.
  Tensor<B, 2> attend(Tensor<B, 2> qkv, const Offsets& offsets, const Context& context,
                      const Tensor<B, 2>* residual = nullptr, bool causal = false, double drop = 0) const {
    const ModuleScope scope(*this);
    const auto read = self_attention(std::move(qkv), offsets,
                                     {.heads = heads,
                                      .causal = causal,
                                      .dropout = next_dropout(dropout_p, context),
                                      .precision = precision_of(in_proj_weight)});
    return out_proj(read, Activation::none, residual, next_dropout(drop, context));
  }
  /// x attends to `memory`. If every memory has one row, the softmax over one key is 1 and the result is that row's
  /// value.
  Tensor<B, 2> cross(const Tensor<B, 2>& x, const Offsets& offsets, const Sequences<B>& memory,
                     const Context& context) const {
    const ModuleScope scope(*this);
    const Index d = x.size(1);
    auto project = [&](const Tensor<B, 2>& t, Index first, Index last) {
      const auto bias = slice(in_proj_bias, 0, first * d, last * d);
      return linear(t, slice(in_proj_weight, 0, first * d, last * d), &bias);
    };
    const auto q = project(x, 0, 1), k = project(memory.rows, 1, 2), v = project(memory.rows, 2, 3);
    return out_proj(attention(
        q, k, v, offsets, memory.offsets,
        {.heads = heads, .dropout = next_dropout(dropout_p, context), .precision = precision_of(in_proj_weight)}));
  }
};

MOTIONLANG_NAMESPACE_END
