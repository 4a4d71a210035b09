// SPDX-License-Identifier: MIT
/// A decoder that writes one frame after the other, with which ACTOR's decoder is compared (thesis table 3.4 a). It
/// comes from the joeynmt project: pre-norm layers with ReLU, separate matrices of attention.
#pragma once

#include <motionlang/nn/feed_forward.hpp>
#include <motionlang/nn/layer_norm.hpp>
#include <motionlang/vae/actor_gru.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Multi-head attention with separate layers for the projections.
template <Backend B>
struct SeparateAttention {
  Linear<B> k_layer, v_layer, q_layer, output_layer;
  Index heads = 1;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = SeparateAttention;
    return motionlang::fields("k_layer", &M::k_layer, "v_layer", &M::v_layer, "q_layer", &M::q_layer, "output_layer",
                              &M::output_layer, "heads", &M::heads, "dropout_p", &M::dropout_p);
  }
  SeparateAttention() = default;
  SeparateAttention(Index width, Index heads_, double dropout, Rng auto& rng)
      : k_layer(width, width, rng),
        v_layer(width, width, rng),
        q_layer(width, width, rng),
        output_layer(width, width, rng),
        heads(heads_),
        dropout_p(dropout) {
    check_heads(width, heads);
  }
  Tensor<B, 2> operator()(const Sequences<B>& query, const Sequences<B>& memory, const Context& context,
                          bool causal = false) const {
    const ModuleScope scope(*this);
    return output_layer(attention(q_layer(query.rows), k_layer(memory.rows), v_layer(memory.rows), query.offsets,
                                  memory.offsets,
                                  {.heads = heads,
                                   .causal = causal,
                                   .dropout = next_dropout(dropout_p, context),
                                   .precision = precision_of(q_layer.weight)}));
  }
};

///     a = LN_x(h);  h1 = h + SA(a);  v = h1 + CA(LN_dec(h1), memory);  h = v + W2 relu(W1 LN_ff(v))
/// Source  thesis 3.3.2, table 3.4 a; ACTOR src/models/architectures/autotrans.py Decoder_AUTOTRANS
template <Backend B>
struct ActorAutoregressiveLayer {
  SeparateAttention<B> trg_trg_att, src_trg_att;
  LayerNorm<B> feed_forward_norm;
  Linear<B> feed_forward_in, feed_forward_out;
  LayerNorm<B> x_layer_norm, dec_layer_norm;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = ActorAutoregressiveLayer;
    return motionlang::fields("trg_trg_att", &M::trg_trg_att, "src_trg_att", &M::src_trg_att, "feed_forward.layer_norm",
                              &M::feed_forward_norm, "feed_forward.pwff_layer.0", &M::feed_forward_in,
                              "feed_forward.pwff_layer.3", &M::feed_forward_out, "x_layer_norm", &M::x_layer_norm,
                              "dec_layer_norm", &M::dec_layer_norm, "dropout_p", &M::dropout_p);
  }
  ActorAutoregressiveLayer() = default;
  ActorAutoregressiveLayer(const TransformerConfig& c, Rng auto& rng)
      : trg_trg_att(c.d_model, c.heads, c.dropout, rng),
        src_trg_att(c.d_model, c.heads, c.dropout, rng),
        feed_forward_norm(c.d_model),
        feed_forward_in(c.d_model, c.d_ff, rng),
        feed_forward_out(c.d_ff, c.d_model, rng),
        x_layer_norm(c.d_model),
        dec_layer_norm(c.d_model),
        dropout_p(c.dropout) {
    for (LayerNorm<B>* norm : {&feed_forward_norm, &x_layer_norm, &dec_layer_norm}) norm->eps = 1e-6;
  }
  Sequences<B> operator()(const Sequences<B>& x, const Sequences<B>& memory, const Context& context) const {
    const ModuleScope scope(*this);
    auto drop = [&](const Tensor<B, 2>& t) { return dropout(t, dropout_p, context); };
    const auto a = x.with(x_layer_norm(x.rows));
    const auto h = x.rows + drop(trg_trg_att(a, a, context, true));
    const auto v = h + drop(src_trg_att(x.with(dec_layer_norm(h)), memory, context));
    return x.with(
        feed_forward(feed_forward_in, feed_forward_out, Activation::relu, feed_forward_norm(v), v, dropout_p, context));
  }
};

///     memory_t = W [z, one-hot y, time],   frame t = V LN(layers(W_x [frame t - 1, one-hot y, time] + positions))
template <Backend B>
struct ActorAutoregressiveDecoder {
  Linear<B> embedding, embedding_x;
  std::vector<ActorAutoregressiveLayer<B>> layers;
  LayerNorm<B> layer_norm;
  Tensor<B, 2> output_layer;  // (features, width), without bias
  PositionTable<B> positions;
  bool concatenate_time = true;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = ActorAutoregressiveDecoder;
    return motionlang::fields("embedding", &M::embedding, "embedding_x", &M::embedding_x, "layers", &M::layers,
                              "layer_norm", &M::layer_norm, "output_layer.weight", &M::output_layer, "positions",
                              &M::positions, "concatenate_time", &M::concatenate_time, "dropout_p", &M::dropout_p);
  }
  ActorAutoregressiveDecoder() = default;
  ActorAutoregressiveDecoder(Index nfeats, Index classes, const TransformerConfig& c, Index max_len, bool time,
                             Rng auto& rng)
      : embedding(c.d_model + classes + (time ? 1 : 0), c.d_model, rng),
        embedding_x(nfeats + classes + (time ? 1 : 0), c.d_model, rng),
        layer_norm(c.d_model),
        output_layer(uniform_init<B, 2>({nfeats, c.d_model}, 1 / std::sqrt(static_cast<double>(c.d_model)), rng)),
        positions(max_len, c.d_model),
        concatenate_time(time),
        dropout_p(c.dropout) {
    layer_norm.eps = 1e-6;
    for (Index i = 0; i < c.layers; ++i) layers.emplace_back(c, rng);
  }

  /// The motions as the decoder writes them: every frame from the frames that it wrote before, and from the whole
  /// memory.
  Sequences<B> operator()(const Tensor<B, 2>& z, std::span<const Index> labels, const Offsets& lengths) const {
    const ModuleScope scope(*this);
    Sequences<B> x(Tensor<B, 2>::zeros({lengths.rows(), output_layer.size(0)}), lengths);
    for (Index t = 0; t < lengths.longest(); ++t) {
      PoolVector<Index> now;  // frame t of each motion that has one: it depends on earlier frames only
      for (Index s = 0; s < lengths.count(); ++s) {
        if (lengths.length(s) > t) now.push_back(lengths.begin(s) + t);
      }
      x.rows = x.rows + scatter_add(gather(teach(z, labels, x).rows, now), now, lengths.rows());
    }
    return x;
  }

  /// Training: every frame from the true ones before it (teacher forcing).
  Sequences<B> teach(const Tensor<B, 2>& z, std::span<const Index> labels, const Sequences<B>& x,
                     const Context& context = {}) const {
    const Offsets& lengths = x.offsets;
    const auto targets = detail::frames_before(x).rows;
    const Index classes = embedding.in() - z.size(1) - (concatenate_time ? 1 : 0);
    const auto side = detail::action_and_time<B>(labels, classes, lengths, concatenate_time);
    const auto memory = embedding(x.with(concat(1, repeat_for_rows(z, lengths), side)));
    auto h = add_positions(embedding_x(x.with(concat(1, targets, side))), positions.rows());
    h.rows = dropout(h.rows, dropout_p, context);
    for (const auto& layer : layers) h = layer(h, memory, context);
    const Tensor<B, 1>* const no_bias = nullptr;
    return h.with(linear(layer_norm(h.rows), output_layer, no_bias));
  }
};

MOTIONLANG_NAMESPACE_END
