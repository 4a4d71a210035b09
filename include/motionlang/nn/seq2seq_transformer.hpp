// SPDX-License-Identifier: MIT
/// The sequence-to-sequence transformer of TM2T: motion tokens to words, and words to motion tokens.
///
///     // From IdSequences, word vectors, or shares of symbols; then the next word after each word, (rows, words).
///     const auto memory = m.encode(tokens);
///     const auto logits = m.logits(words.without_ends(0, 1), memory);
///
/// Source  Vaswani et al., "Attention is all you need" (NIPS 2017); TM2T networks/transformer.py (TransformerV1 to V3)
/// Differs from nn/transformer_decoder.hpp in the names and number of the projections, and in the eps of the norms
#pragma once

#include <cmath>  // sqrt

#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/nn/pooling.hpp>
#include <motionlang/nn/positional_encoding.hpp>
#include <motionlang/nn/transformer_encoder.hpp>
#include <motionlang/tensor/id_sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Published sizes of motion to text.
struct Seq2SeqConfig {
  Index source_symbols = 1027;  // 0: the source are vectors
  Index source_width = 0;       // of these vectors
  Index target_symbols = 4200;  // of the written sequence
  Index target_width = 0;       // of the vectors that the decoder reads; 0: it reads symbols
  Index d_model = 512, d_inner = 2048, heads = 8, head_width = 64;
  Index value_width = 0;  // of each head; 0: as wide as its queries
  Index encoder_layers = 4, decoder_layers = 4;
  Index source_positions = 100, target_positions = 50;
  bool shared_projection = true;  // the output projection uses the vectors of the input symbols
  double dropout = 0.1;
};

namespace detail {

constexpr double seq2seq_eps = 1e-6;  // of all norms

template <Backend B>
motionlang::LayerNorm<B> seq2seq_norm(Index width) {  // not the kernels' LayerNorm
  motionlang::LayerNorm<B> norm(width);
  norm.eps = seq2seq_eps;
  return norm;
}
template <Backend B>
Linear<B> xavier_uniform_linear(Index in, Index out, Rng auto& rng) {
  Linear<B> layer(in, out, rng);
  layer.weight = xavier_uniform<B>({out, in}, rng);
  return layer;
}

/// Changes the width of heads that are side by side: adds zeros to each head, or takes the first columns of each.
template <Backend B>
Tensor<B, 2> resized_heads(const Tensor<B, 2>& x, Index heads, Index width) {
  const Index own = x.size(1) / heads;
  if (own == width) return x;
  const auto each = reshape<2>(x, {x.size(0) * heads, own});
  return reshape<2>(
      own < width ? concat(1, each, Tensor<B, 2>::zeros({each.size(0), width - own})) : slice(each, 1, 0, width),
      {x.size(0), heads * width});
}

}  // namespace detail

///     LN(x + W_o attention(W_q x, W_k memory, W_v memory))
template <Backend B>
struct Seq2SeqAttention {
  Linear<B> w_qs, w_ks, w_vs, fc;
  LayerNorm<B> layer_norm;
  Index heads = 8;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = Seq2SeqAttention;
    return motionlang::fields("w_qs", &M::w_qs, "w_ks", &M::w_ks, "w_vs", &M::w_vs, "fc", &M::fc, "layer_norm",
                              &M::layer_norm, "heads", &M::heads, "dropout_p", &M::dropout_p);
  }
  Seq2SeqAttention() = default;
  Seq2SeqAttention(const Seq2SeqConfig& c, Rng auto& rng)
      : w_qs(detail::xavier_uniform_linear<B>(c.d_model, c.heads * c.head_width, rng)),
        w_ks(detail::xavier_uniform_linear<B>(c.d_model, c.heads * c.head_width, rng)),
        w_vs(detail::xavier_uniform_linear<B>(c.d_model, c.heads * value_width(c), rng)),
        fc(detail::xavier_uniform_linear<B>(c.heads * value_width(c), c.d_model, rng)),
        layer_norm(detail::seq2seq_norm<B>(c.d_model)),
        heads(c.heads),
        dropout_p(c.dropout) {}
  static Index value_width(const Seq2SeqConfig& c) { return c.value_width > 0 ? c.value_width : c.head_width; }

  /// causal: row i reads the memory up to row i.
  Tensor<B, 2> operator()(const Sequences<B>& x, const Sequences<B>& memory, bool causal,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    return read(x, memory.with(w_ks(memory.rows)), w_vs(memory.rows), causal, context);
  }
  /// The same with known keys and values.
  Tensor<B, 2> read(const Sequences<B>& x, const Sequences<B>& keys, const Tensor<B, 2>& values, bool causal,
                    const Context& context = {}) const {
    const AttentionOptions options{.heads = heads,
                                   .causal = causal,
                                   .dropout = next_dropout(dropout_p, context),
                                   .precision = precision_of(w_qs.weight)};
    const auto queries = w_qs(x.rows);
    // Heads of one width: zeros add nothing to products, and the columns after the values are cut off again.
    const Index key = keys.width() / heads, value = values.size(1) / heads, wide = std::max(key, value);
    const auto heard =
        key == value ? attention(queries, keys.rows, values, x.offsets, keys.offsets, options)
                     : detail::resized_heads(
                           attention(detail::resized_heads(queries, heads, wide) *
                                         std::sqrt(static_cast<double>(wide) / static_cast<double>(key)),
                                     detail::resized_heads(keys.rows, heads, wide),
                                     detail::resized_heads(values, heads, wide), x.offsets, keys.offsets, options),
                           heads, value);
    return layer_norm(fc(heard, Activation::none, &x.rows, next_dropout(dropout_p, context)));
  }
};

///     LN(x + W_2 relu(W_1 x))
template <Backend B>
struct Seq2SeqFeedForward {
  Linear<B> w_1, w_2;
  LayerNorm<B> layer_norm;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = Seq2SeqFeedForward;
    return motionlang::fields("w_1", &M::w_1, "w_2", &M::w_2, "layer_norm", &M::layer_norm, "dropout_p", &M::dropout_p);
  }
  Seq2SeqFeedForward() = default;
  Seq2SeqFeedForward(const Seq2SeqConfig& c, Rng auto& rng)
      : w_1(detail::xavier_uniform_linear<B>(c.d_model, c.d_inner, rng)),
        w_2(detail::xavier_uniform_linear<B>(c.d_inner, c.d_model, rng)),
        layer_norm(detail::seq2seq_norm<B>(c.d_model)),
        dropout_p(c.dropout) {}

  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return layer_norm(w_2(w_1(x, Activation::relu), Activation::none, &x, next_dropout(dropout_p, context)));
  }
};

template <Backend B>
struct Seq2SeqEncoderLayer {
  Seq2SeqAttention<B> slf_attn;
  Seq2SeqFeedForward<B> pos_ffn;

  static constexpr auto fields() {
    using M = Seq2SeqEncoderLayer;
    return motionlang::fields("slf_attn", &M::slf_attn, "pos_ffn", &M::pos_ffn);
  }
  Seq2SeqEncoderLayer() = default;
  Seq2SeqEncoderLayer(const Seq2SeqConfig& c, Rng auto& rng) : slf_attn(c, rng), pos_ffn(c, rng) {}

  /// Rows of x attend to those of `visible`, which equal x after training.
  Tensor<B, 2> operator()(const Sequences<B>& x, const Sequences<B>& visible, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return pos_ffn(slf_attn(x, visible, false, context), context);
  }
};

template <Backend B>
struct Seq2SeqDecoderLayer {
  Seq2SeqAttention<B> slf_attn, enc_attn;
  Seq2SeqFeedForward<B> pos_ffn;

  static constexpr auto fields() {
    using M = Seq2SeqDecoderLayer;
    return motionlang::fields("slf_attn", &M::slf_attn, "enc_attn", &M::enc_attn, "pos_ffn", &M::pos_ffn);
  }
  Seq2SeqDecoderLayer() = default;
  Seq2SeqDecoderLayer(const Seq2SeqConfig& c, Rng auto& rng) : slf_attn(c, rng), enc_attn(c, rng), pos_ffn(c, rng) {}

  /// Rows of x attend to those of `visible` before them, which equal x after training, and to all of the memory.
  Tensor<B, 2> operator()(const Sequences<B>& x, const Sequences<B>& visible, const Sequences<B>& memory,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    const auto own = slf_attn(x, visible, true, context);
    return pos_ffn(enc_attn(x.with(own), memory, false, context), context);
  }
};

/// The sinusoidal table, which is stored in the published files.
template <Backend B>
struct StoredPositions {
  static constexpr bool trainable = false;
  Tensor<B, 2> positional_encoding;  // (rows, width)

  static constexpr auto fields() {
    return motionlang::fields("positional_encoding", &StoredPositions::positional_encoding);
  }
};

namespace detail {

/// From vectors to the input of a stack of layers:  sqrt(width) x + positions.
template <Backend B>
Sequences<B> seq2seq_input(const Sequences<B>& x, const StoredPositions<B>& positions) {
  return add_positions(x.with(x.rows * std::sqrt(static_cast<double>(x.width()))), positions.positional_encoding);
}
template <class M>
const M& present(const std::optional<M>& part, const char* what) {
  if (!part) raise<config_error>(101, "Seq2SeqTransformer: ", what);
  return *part;
}

}  // namespace detail

template <Backend B>
struct Seq2SeqEncoder {
  std::optional<Embedding<B>> src_word_emb;  // the source are symbols
  std::optional<LinearMap<B>> emb;           // or vectors
  StoredPositions<B> position_enc;
  std::vector<Seq2SeqEncoderLayer<B>> layer_stack;

  static constexpr auto fields() {
    using M = Seq2SeqEncoder;
    return motionlang::fields("src_word_emb", &M::src_word_emb, "emb", &M::emb, "position_enc", &M::position_enc,
                              "layer_stack", &M::layer_stack);
  }

  /// From embedded rows. Throws shape_error 203 for a sequence longer than the positions.
  Sequences<B> operator()(const Sequences<B>& embedded, const Context& context = {}) const {
    const ModuleScope scope(*this);
    auto x = detail::seq2seq_input(embedded, position_enc);
    for (const auto& layer : layer_stack) x.rows = layer(x, x, context);
    return x;
  }
};

template <Backend B>
struct Seq2SeqDecoder {
  std::optional<Embedding<B>> symbols;  // trg_word_emb: the decoder reads symbols
  std::optional<LinearMap<B>> vectors;  // or vectors, under the same name
  StoredPositions<B> position_enc;
  std::vector<Seq2SeqDecoderLayer<B>> layer_stack;

  static constexpr auto fields() {
    using M = Seq2SeqDecoder;
    return motionlang::fields("trg_word_emb", &M::symbols, "trg_word_emb", &M::vectors, "position_enc",
                              &M::position_enc, "layer_stack", &M::layer_stack);
  }

  Sequences<B> operator()(const Sequences<B>& embedded, const Sequences<B>& memory, const Context& context = {}) const {
    const ModuleScope scope(*this);
    auto x = detail::seq2seq_input(embedded, position_enc);
    for (const auto& layer : layer_stack) x.rows = layer(x, x, memory, context);
    return x;
  }
};

/// The names are those of the published checkpoints.
template <Backend B>
struct Seq2SeqTransformer {
  Seq2SeqEncoder<B> encoder;
  Seq2SeqDecoder<B> decoder;
  std::optional<LinearMap<B>> trg_word_prj;  // none: the projection is shared

  static constexpr auto fields() {
    using M = Seq2SeqTransformer;
    return motionlang::fields("encoder", &M::encoder, "decoder", &M::decoder, "trg_word_prj", &M::trg_word_prj);
  }
  /// Files contain a shared projection under both names.
  std::string copy_of(const std::string& path) const {
    return !trg_word_prj && path == "trg_word_prj.weight" ? "decoder.trg_word_emb.weight" : "";
  }

  Seq2SeqTransformer() = default;
  /// Throws config_error 101 for a projection that is shared with vectors.
  Seq2SeqTransformer(const Seq2SeqConfig& c, Rng auto& rng) {
    auto rows = [&](Index symbols) {
      NoInit none;
      Embedding<B> e(symbols, c.d_model, none);
      e.weight = xavier_uniform<B>({symbols, c.d_model}, rng);
      return e;
    };
    auto map = [&](Index in, Index out) {
      NoInit none;
      LinearMap<B> m(in, out, none);
      m.weight = xavier_uniform<B>({out, in}, rng);
      return m;
    };
    if (c.shared_projection && c.target_width > 0)
      raise<config_error>(101, "Seq2SeqTransformer: a projection cannot be shared with vectors of ", c.target_width);
    if (c.source_symbols > 0)
      encoder.src_word_emb = rows(c.source_symbols);
    else
      encoder.emb = map(c.source_width, c.d_model);
    if (c.target_width == 0)
      decoder.symbols = rows(c.target_symbols);
    else
      decoder.vectors = map(c.target_width, c.d_model);
    encoder.position_enc = {sinusoidal_positions<B>(c.source_positions, c.d_model)};
    decoder.position_enc = {sinusoidal_positions<B>(c.target_positions, c.d_model)};
    for (Index i = 0; i < c.encoder_layers; ++i) encoder.layer_stack.emplace_back(c, rng);
    for (Index i = 0; i < c.decoder_layers; ++i) decoder.layer_stack.emplace_back(c, rng);
    if (!c.shared_projection) trg_word_prj = map(c.d_model, c.target_symbols);
  }

  /// Throws config_error 101 if the encoder reads another kind of input.
  Sequences<B> encode(const IdSequences& source, const Context& context = {}) const {
    const auto& e = detail::present(encoder.src_word_emb, "its source are vectors");
    return encoder({e(source.ids), source.offsets}, context);
  }
  Sequences<B> encode(const Sequences<B>& vectors, const Context& context = {}) const {
    const auto& m = detail::present(encoder.emb, "its source are symbols");
    return encoder(vectors.with(m(vectors.rows)), context);
  }
  /// Rows of shares of the symbols, one-hot for certain ones. Through them gradients reach the writer of the source.
  Sequences<B> encode_shares(const Sequences<B>& shares, const Context& context = {}) const {
    const auto& e = detail::present(encoder.src_word_emb, "its source are vectors");
    return encoder(shares.with(matmul(shares.rows, e.weight)), context);
  }

  Sequences<B> embed_target(const IdSequences& target) const {
    const auto& e = detail::present(decoder.symbols, "its decoder reads vectors");
    return {e(target.ids), target.offsets};
  }
  Sequences<B> embed_target(const Sequences<B>& vectors) const {
    return vectors.with(detail::present(decoder.vectors, "its decoder reads symbols")(vectors.rows));
  }
  /// For each row of the target, the logits of the next symbol, (rows, symbols). target: symbols or vectors, beginning
  /// with the start mark; memory: one sequence for each.
  template <class Target>
  Tensor<B, 2> logits(const Target& target, const Sequences<B>& memory, const Context& context = {}) const {
    return project(decoder(embed_target(target), memory, context).rows);
  }
  /// The same for only the last symbol of each sequence. Seq2SeqWriter computes these values with less work for growing
  /// sequences.
  Tensor<B, 2> next_logits(const IdSequences& target, const Sequences<B>& memory) const {
    return project(last_row(decoder(embed_target(target), memory)));
  }
  Tensor<B, 2> project(const Tensor<B, 2>& rows) const {
    return linear<B>(rows, trg_word_prj ? trg_word_prj->weight : decoder.symbols->weight, nullptr);
  }
};

MOTIONLANG_NAMESPACE_END
