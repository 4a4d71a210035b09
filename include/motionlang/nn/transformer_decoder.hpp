// SPDX-License-Identifier: MIT
/// Transformer decoder over packed sequences, post-norm (MDM's trans_dec, ACTOR, TEMOS, TMR).
#pragma once

#include <algorithm>  // equal
#include <vector>     // weights, layers

#include <motionlang/nn/transformer_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Cross-attention to one row of memory per sequence. The softmax over one key is 1, so every query reads the value of
/// that row. The value is computed once for each sequence; weights of queries and keys have no effect and get gradient
/// 0. Dropout keeps or drops one weight for each query and head. Queries of one sequence that keep the same heads read
/// the same value, which is also computed once.
/// value, which is computed once.
template <Backend B>
Tensor<B, 2> attend_one_row(const MultiheadAttention<B>& attention, const Tensor<B, 2>& memory, const Offsets& offsets,
                            const Context& context) {
  const Index d = attention.in_proj_weight.size(1), heads = attention.heads;
  const auto bias = slice(attention.in_proj_bias, 0, 2 * d, 3 * d);
  const auto value = linear(memory, slice(attention.in_proj_weight, 0, 2 * d, 3 * d), &bias);
  const Dropout drop = next_dropout(attention.dropout_p, context);
  if (drop.p == 0) return repeat_for_rows(attention.out_proj(value), offsets);
  using S = typename B::scalar;
  std::vector<S> weights;                      // of the heads, for each reading
  PoolVector<Index> sequence, reading_of_row;  // sequence: of each reading
  for (Index s = 0; s < offsets.count(); ++s) {
    const auto first = static_cast<Index>(sequence.size());
    for (Index row = offsets.begin(s); row < offsets.end(s); ++row) {
      for (Index h = 0; h < heads; ++h)
        weights.push_back(static_cast<S>(drop.factor(static_cast<std::uint64_t>(row * heads + h))));
      const auto known = static_cast<Index>(sequence.size());
      const auto mine = weights.begin() + known * heads;
      Index same = first;
      while (same < known && !std::equal(mine, weights.end(), weights.begin() + same * heads)) ++same;
      if (same == known)
        sequence.push_back(s);
      else
        weights.erase(mine, weights.end());
      reading_of_row.push_back(same);
    }
  }
  const auto readings = static_cast<Index>(sequence.size());
  const auto values = reshape<2>(gather(value, sequence), {readings * heads, d / heads});
  const auto kept = values * Tensor<B, 2>::from(weights, {readings * heads, 1});
  return gather(attention.out_proj(reshape<2>(kept, {readings, d})), reading_of_row);
}

}  // namespace detail

///     x = LN1(x + SA(x));   x = LN2(x + CA(x, memory));   x = LN3(x + W2 act(W1 x))
/// Source  Vaswani et al. (2017), section 3.1, without the causal mask. Parameter names of PyTorch.
template <Backend B>
struct TransformerDecoderLayer {
  MultiheadAttention<B> self_attn, multihead_attn;
  Linear<B> linear1, linear2;
  LayerNorm<B> norm1, norm2, norm3;
  Activation activation = Activation::gelu;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = TransformerDecoderLayer;
    return motionlang::fields("self_attn", &M::self_attn, "multihead_attn", &M::multihead_attn, "linear1", &M::linear1,
                              "linear2", &M::linear2, "norm1", &M::norm1, "norm2", &M::norm2, "norm3", &M::norm3,
                              "activation", &M::activation, "dropout_p", &M::dropout_p);
  }
  TransformerDecoderLayer() = default;
  TransformerDecoderLayer(const TransformerConfig& c, Rng auto& rng)
      : self_attn(c.d_model, c.heads, c.dropout, rng),
        multihead_attn(c.d_model, c.heads, c.dropout, rng),
        linear1(c.d_model, c.d_ff, rng),
        linear2(c.d_ff, c.d_model, rng),
        norm1(c.d_model),
        norm2(c.d_model),
        norm3(c.d_model),
        activation(c.activation),
        dropout_p(c.dropout) {}

  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Offsets& offsets, const Sequences<B>& memory,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    return behind_self(attend_self(x, offsets, context), offsets, memory, context);
  }
  /// The layer without its first third, whose result is x.
  Tensor<B, 2> behind_self(const Tensor<B, 2>& x, const Offsets& offsets, const Sequences<B>& memory,
                           const Context& context = {}) const {
    const ModuleScope scope(*this);
    const auto z = attend_memory(x, offsets, memory, context);
    return norm3(feed_forward(linear1, linear2, activation, z, z, dropout_p, context));
  }
  /// The first third of the layer, LN1(x + SA(x)).
  Tensor<B, 2> attend_self(const Tensor<B, 2>& x, const Offsets& offsets, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return norm1(self_attn.self(x, offsets, context, &x, false, dropout_p));
  }
  /// The second third, LN2(x + CA(x, memory)).
  Tensor<B, 2> attend_memory(const Tensor<B, 2>& x, const Offsets& offsets, const Sequences<B>& memory,
                             const Context& context = {}) const {
    const ModuleScope scope(*this);
    const bool single = memory.offsets == Offsets::equal(offsets.count(), 1);
    const auto read = single ? detail::attend_one_row(multihead_attn, memory.rows, offsets, context)
                             : multihead_attn.cross(x, offsets, memory, context);
    return norm2(dropout(read, dropout_p, context), x);
  }
};

template <Backend B>
struct TransformerDecoder {
  std::vector<TransformerDecoderLayer<B>> layers;

  static constexpr auto fields() { return motionlang::fields("layers", &TransformerDecoder::layers); }

  TransformerDecoder() = default;
  TransformerDecoder(const TransformerConfig& c, Rng auto& rng) {
    for (Index i = 0; i < c.layers; ++i) layers.emplace_back(c, rng);
  }
  /// x: queries; memory: as many sequences, else shape_error 207.
  Sequences<B> operator()(const Sequences<B>& x, const Sequences<B>& memory, const Context& context = {}) const {
    const ModuleScope scope(*this);
    if (memory.count() != x.count())
      raise<shape_error>(207, "TransformerDecoder: ", memory.count(), " memories for ", x.count(), " sequences");
    return x.with(detail::in_groups<B>(x.offsets, x.offsets, x.width(), context, [&](std::span<const Index> which) {
      auto some = detail::some_sequences(x, which);
      const auto read = detail::some_sequences(memory, which);
      for (std::size_t i = 0; i < layers.size(); ++i)
        some.rows = run_layer(layers[i], some.rows, some.offsets, read, context);
      return some.rows;
    }));
  }
};

MOTIONLANG_NAMESPACE_END
