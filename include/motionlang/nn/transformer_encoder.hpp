// SPDX-License-Identifier: MIT
/// Transformer encoder over packed sequences, post-norm or pre-norm.
#pragma once

#include <motionlang/nn/feed_forward.hpp>
#include <motionlang/nn/layer_norm.hpp>
#include <motionlang/nn/multihead_attention.hpp>
#include <motionlang/nn/recompute.hpp>
#include <motionlang/nn/sequence_groups.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TransformerConfig {
  Index d_model = 512;
  Index heads = 4;
  Index d_ff = 1024;
  Index layers = 8;
  Activation activation = Activation::gelu;
  bool norm_first = false;
  double dropout = 0.1;
  bool causal = false;

  /// Returns itself. A constant configuration is checked at compile time:
  ///     constexpr auto config = TransformerConfig{.d_model = 256, .heads = 4}.checked();
  constexpr const TransformerConfig& checked() const {
    check_heads(d_model, heads);
    return *this;
  }
};

///     post-norm   x = LN1(x + SA(x));      x = LN2(x + W2 act(W1 x))
///     pre-norm    x = x + SA(LN1 x);       x = x + W2 act(W1 LN2 x)
/// Source  Vaswani et al. (2017), section 3.1; pre-norm: Xiong et al. (2020). Parameter names of PyTorch. Dropout (only
///         with a context) follows both halves, inside the feed-forward part and on the attention weights, as in
///         PyTorch.
template <Backend B>
struct TransformerEncoderLayer {
  MultiheadAttention<B> self_attn;
  Linear<B> linear1, linear2;
  LayerNorm<B> norm1, norm2;
  Activation activation = Activation::gelu;
  bool norm_first = false, causal = false;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = TransformerEncoderLayer;
    return motionlang::fields("self_attn", &M::self_attn, "linear1", &M::linear1, "linear2", &M::linear2, "norm1",
                              &M::norm1, "norm2", &M::norm2, "activation", &M::activation, "norm_first", &M::norm_first,
                              "causal", &M::causal, "dropout_p", &M::dropout_p);
  }
  TransformerEncoderLayer() = default;
  TransformerEncoderLayer(const TransformerConfig& c, Rng auto& rng)
      : self_attn(c.d_model, c.heads, c.dropout, rng),
        linear1(c.d_model, c.d_ff, rng),
        linear2(c.d_ff, c.d_model, rng),
        norm1(c.d_model),
        norm2(c.d_model),
        activation(c.activation),
        norm_first(c.norm_first),
        causal(c.causal),
        dropout_p(c.dropout) {}

  /// x (rows, width) -> (rows, width)
  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Offsets& offsets, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return behind_project(x, project(x), offsets, context);
  }
  /// Queries, keys and values of each row, (rows, 3 width).
  Tensor<B, 2> project(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    return self_attn.project(norm_first ? norm1(x) : x);
  }
  /// The layer after `project`.
  Tensor<B, 2> behind_project(const Tensor<B, 2>& x, Tensor<B, 2> qkv, const Offsets& offsets,
                              const Context& context = {}) const {
    const ModuleScope scope(*this);
    const auto attended = self_attn.attend(std::move(qkv), offsets, context, &x, causal, dropout_p);
    if (norm_first) return feed(norm2(attended), attended, context);
    const auto y = norm1(attended);
    return norm2(feed(y, y, context));
  }

 private:
  Tensor<B, 2> feed(const Tensor<B, 2>& x, const Tensor<B, 2>& residual, const Context& context) const {
    return feed_forward(linear1, linear2, activation, x, residual, dropout_p, context);
  }
};

/// A stack of layers. None of the published stacks has a final norm.
template <Backend B>
struct TransformerEncoder {
  std::vector<TransformerEncoderLayer<B>> layers;

  static constexpr auto fields() { return motionlang::fields("layers", &TransformerEncoder::layers); }

  TransformerEncoder() = default;
  TransformerEncoder(const TransformerConfig& c, Rng auto& rng) {
    for (Index i = 0; i < c.layers; ++i) layers.emplace_back(c, rng);
  }

  Sequences<B> operator()(const Sequences<B>& x, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return x.with(detail::in_groups(x, x.offsets, context, [&](Sequences<B> some) {
      for (std::size_t i = 0; i < layers.size(); ++i)
        some.rows = run_layer(layers[i], some.rows, some.offsets, context);
      return some.rows;
    }));
  }
  /// Encodes sequences that share endings. Sequence j has the rows of heads[j], then those of tails[i], where
  /// uses.begin(i) <= j < uses.end(i). The results equal those of whole sequences, but the first layer projects a tail
  /// only once. There is no dropout. Throws shape_error 204 for other numbers of heads or tails.
  Sequences<B> with_tails(const Sequences<B>& heads, const Sequences<B>& tails, const Offsets& uses) const {
    const ModuleScope scope(*this);
    const Offsets repeated = repeat_lengths(tails.offsets, uses);
    if (heads.count() != repeated.count())
      raise<shape_error>(204, "with_tails: ", heads.count(), " heads for ", repeated.count(), " uses of ",
                         tails.count(), " tails");
    PoolVector<Index> lengths;
    for (Index j = 0; j < heads.count(); ++j) lengths.push_back(heads.offsets.length(j) + repeated.length(j));
    const Offsets offsets{std::span<const Index>(lengths)};
    const PoolVector<Index> tail_of = sequence_of_row(uses);
    const auto distinct = concat(0, heads.rows, tails.rows);
    const auto projected = layers.empty() ? distinct : layers.front().project(distinct);
    const auto encode = [&](std::span<const Index> which) {
      PoolVector<Index> pick;
      for (Index j : which) {
        const Index i = tail_of[static_cast<std::size_t>(j)];
        for (Index r = heads.offsets.begin(j); r < heads.offsets.end(j); ++r) pick.push_back(r);
        for (Index r = tails.offsets.begin(i); r < tails.offsets.end(i); ++r) pick.push_back(heads.offsets.rows() + r);
      }
      const Offsets some = detail::some_sequences(offsets, which);
      auto rows = gather(distinct, pick);
      for (std::size_t i = 0; i < layers.size(); ++i)
        rows = i == 0 ? layers[i].behind_project(rows, gather(projected, pick), some) : layers[i](rows, some);
      return rows;
    };
    return {detail::in_groups<B>(offsets, offsets, heads.width(), {}, encode), offsets};
  }
  /// (batch, time, width), all of one length.
  Tensor<B, 3> operator()(const Tensor<B, 3>& x, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return reshape<3>((*this)(from_equal(x), context).rows, {x.size(0), x.size(1), x.size(2)});
  }
};

MOTIONLANG_NAMESPACE_END
