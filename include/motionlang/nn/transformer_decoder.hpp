// SPDX-License-Identifier: MIT
/// Transformer decoder over packed sequences, post-norm (MDM's trans_dec, ACTOR, TEMOS, TMR).
#pragma once

#include <motionlang/nn/transformer_encoder.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

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
    auto drop = [&](const Tensor<B, 2>& t) { return dropout(t, dropout_p, context); };
    const auto y = norm1(drop(self_attn.self(x, offsets, context)), x);
    const auto z = norm2(drop(multihead_attn.cross(y, offsets, memory, context)), y);
    return norm3(drop(linear2(drop(linear1(z, activation)))), z);
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
  /// x: queries; memory: as many sequences.
  Sequences<B> operator()(const Sequences<B>& x, const Sequences<B>& memory, const Context& context = {}) const {
    Tensor<B, 2> rows = x.rows;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const ModuleScope scope("layers.", i);
      rows = layers[i](rows, x.offsets, memory, context);
    }
    return x.with(std::move(rows));
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
