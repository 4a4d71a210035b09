// SPDX-License-Identifier: MIT
/// From sequences to one Gaussian each, and back: the common part of the variational autoencoders ACTOR, TEMOS and TMR.
///
///    encoder   learned tokens before the frames, positions, transformer; the outputs of the tokens are the
///              distribution
///    decoder   positions are the queries, the latent is the memory; all frames are written at once
/// Source  Petrovich, Black, Varol: ACTOR (thesis 3.2.1), TEMOS (thesis 4.2.2; paper 3.2), TMR (thesis 5.2.2; paper
///         3.2)
#pragma once

#include <algorithm>  // find

#include <motionlang/nn/pooling.hpp>
#include <motionlang/nn/positional_encoding.hpp>
#include <motionlang/nn/sequence_groups.hpp>
#include <motionlang/nn/transformer_decoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// N(mu, exp(logvar)) for each sequence, with independent coordinates. A deterministic autoencoder has no logvar (its
/// shape is (0)); then every sample is mu.
template <Backend B>
struct LatentGaussian {
  Tensor<B, 2> mu, logvar;  // (sequences, width)

  bool deterministic() const { return logvar.count() == 0; }
  Tensor<B, 2> std() const { return exp(logvar * 0.5); }

  ///     z = mu + fact eps exp(logvar / 2)
  /// Source  Kingma and Welling (2014), section 2.4. Throws shape_error 204 if eps has another shape than mu.
  Tensor<B, 2> sample(const Tensor<B, 2>& eps, double fact = 1) const {
    if (deterministic()) return mu;
    if (eps.shape() != mu.shape()) raise<shape_error>(204, "LatentGaussian: eps ", eps.shape(), " for mu ", mu.shape());
    return mu + eps * std() * fact;
  }
  Tensor<B, 2> sample(Rng auto& rng, double fact = 1) const {
    return deterministic() ? mu : sample(Tensor<B, 2>::randn(mu.shape(), rng), fact);
  }
};

/// `count` rows on the straight line from a to b, both (1, width): the latents of motions between two motions. Throws
/// shape_error 204 unless both are one row of one width, and config_error 101 unless count is 2 or more.
template <Backend B>
Tensor<B, 2> interpolate_rows(const Tensor<B, 2>& a, const Tensor<B, 2>& b, Index count) {
  if (a.shape() != b.shape() || a.size(0) != 1)
    raise<shape_error>(204, "interpolate_rows: from ", a.shape(), " to ", b.shape());
  if (count < 2) raise<config_error>(101, "interpolate_rows: ", count, " rows");
  std::vector<typename B::scalar> u;
  for (Index i = 0; i < count; ++i)
    u.push_back(static_cast<typename B::scalar>(static_cast<double>(i) / static_cast<double>(count - 1)));
  const auto share = Tensor<B, 2>::from(u, {count, 1});
  return a * (1.0 - share) + b * share;
}

/// A stack whose layers all begin with the same values, like PyTorch's stacks, which copy one layer.
template <class Stack>
Stack copied_layers(const TransformerConfig& c, Rng auto& rng) {
  Stack stack;
  const auto first = rng;
  for (Index i = 0; i < c.layers; ++i) {
    rng = first;
    stack.layers.emplace_back(c, rng);
  }
  return stack;
}

/// The first n rows of each sequence. Throws shape_error 207 if one is shorter.
template <Backend B>
Sequences<B> first_rows(const Sequences<B>& x, Index n) {
  PoolVector<Index> pick;
  for (Index s = 0; s < x.count(); ++s) {
    if (n > x.offsets.length(s))
      raise<shape_error>(207, "first_rows: ", n, " of ", x.offsets.length(s), " rows of sequence ", s);
    for (Index i = 0; i < n; ++i) pick.push_back(x.offsets.begin(s) + i);
  }
  return {gather(x.rows, pick), Offsets::equal(x.count(), n)};
}

/// The input of the first layer: the tokens of each sequence, its frames, and positions that start at the first token.
template <Backend B>
Sequences<B> token_sequence(const Sequences<B>& tokens, const Sequences<B>& frames, const Tensor<B, 2>& positions) {
  return add_positions(concat_tokens(tokens, frames), positions);
}

namespace detail {

/// A post-norm layer for rows that attend to `x` but are not attended to: tokens after the last layer, padding.
template <Backend B>
Sequences<B> layer_of_readers(const TransformerEncoderLayer<B>& layer, const Sequences<B>& readers,
                              const Sequences<B>& x, const Context& context) {
  const ModuleScope scope(layer);
  if (layer.norm_first || layer.causal) raise<config_error>(101, "encoder: layers have to be post-norm, not causal");
  const auto read = layer.self_attn.cross(readers.rows, readers.offsets, x, context);
  const auto y = layer.norm1(dropout(read, layer.dropout_p, context), readers.rows);
  return readers.with(
      layer.norm2(feed_forward(layer.linear1, layer.linear2, layer.activation, y, y, layer.dropout_p, context)));
}

}  // namespace detail

/// The first n rows of each sequence after all layers. The last layer is computed only for these rows. `dropout_p` acts
/// on the sequence before the first layer.
template <Backend B>
Sequences<B> encode_tokens(const TransformerEncoder<B>& encoder, const Sequences<B>& sequence, Index n,
                           double dropout_p, const Context& context = {}) {
  const ModuleScope scope(encoder);
  for (Index s = 0; s < sequence.count(); ++s) {
    if (n > sequence.offsets.length(s))
      raise<shape_error>(207, "encode_tokens: ", n, " of ", sequence.offsets.length(s), " rows of sequence ", s);
  }
  auto encode = [&](Sequences<B> x) {
    x.rows = dropout(x.rows, dropout_p, context);
    for (std::size_t i = 0; i < encoder.layers.size(); ++i) {
      if (i + 1 == encoder.layers.size())
        return detail::layer_of_readers(encoder.layers[i], first_rows(x, n), x, context).rows;
      x.rows = run_layer(encoder.layers[i], x.rows, x.offsets, context);
    }
    return first_rows(x, n).rows;
  };
  const auto tokens = Offsets::equal(sequence.count(), n);
  return {detail::in_groups(sequence, tokens, context, encode), tokens};
}

/// The distribution from the rows of its tokens: mean and log-variance, or one row for a deterministic latent.
template <Backend B>
LatentGaussian<B> gaussian_of_tokens(const Sequences<B>& tokens) {
  auto row = [&](Index i) { return pick_rows(tokens, PoolVector<Index>(static_cast<std::size_t>(tokens.count()), i)); };
  if (tokens.offsets.longest() == 1) return {row(0), {}};
  return {row(0), row(1)};
}

/// The queries of a decoder: zeros plus positions, that is rows 0, 1, ... of the table for each sequence. Throws
/// shape_error 203 for a sequence longer than the table.
template <Backend B>
Sequences<B> position_queries(const Tensor<B, 2>& positions, const Offsets& offsets) {
  PoolVector<Index> rows;
  for (Index s = 0; s < offsets.count(); ++s) {
    detail::require_positions("position_queries", positions, offsets.length(s));
    for (Index i = 0; i < offsets.length(s); ++i) rows.push_back(i);
  }
  return {gather(positions, rows), offsets};
}

/// The output of a decoder for queries that are the same for all sequences of one length, projected by `final_layer`.
///    queries(lengths)   the queries of sequences of these lengths
/// Without dropout, the first layer's self-attention is also the same for them, and is computed once for each length.
template <Backend B, class Queries>
Sequences<B> decode_lengths(const TransformerDecoder<B>& decoder, const Linear<B>& final_layer, Queries queries,
                            const Sequences<B>& memory, const Offsets& lengths, double dropout_p,
                            const Context& context) {
  if (context.dropout || decoder.layers.empty()) {
    auto x = queries(lengths);
    x.rows = dropout(x.rows, dropout_p, context);
    return final_layer(decoder(x, memory, context));
  }
  if (memory.count() != lengths.count())
    raise<shape_error>(207, "decoder: ", memory.count(), " memories for ", lengths.count(), " sequences");
  const auto& layers = decoder.layers;
  PoolVector<Index> distinct, kind;  // the different lengths, and the one of each sequence
  for (Index s = 0; s < lengths.count(); ++s) {
    const Index k = std::find(distinct.begin(), distinct.end(), lengths.length(s)) - distinct.begin();
    if (k == std::ssize(distinct)) distinct.push_back(lengths.length(s));
    kind.push_back(k);
  }
  auto each = queries(Offsets(std::span<const Index>(distinct)));
  {
    const ModuleScope scope(decoder);
    each.rows = layers.front().attend_self(each.rows, each.offsets);
  }
  auto decode = [&](std::span<const Index> which) {
    PoolVector<Index> kinds;
    for (Index s : which) kinds.push_back(kind[static_cast<std::size_t>(s)]);
    auto [rows, offsets] = detail::some_sequences(each, kinds);
    const auto read = detail::some_sequences(memory, which);
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const ModuleScope scope(decoder);
      rows = i == 0 ? layers[i].behind_self(rows, offsets, read) : run_layer(layers[i], rows, offsets, read, context);
    }
    return final_layer(rows);
  };
  return {detail::in_groups<B>(lengths, lengths, final_layer.weight.size(0), context, decode), lengths};
}

/// From latents to sequences of any length, with the keys of TEMOS, TMR, TEACH and SINC.
template <Backend B>
struct SequenceDecoder {
  TransformerDecoder<B> seqTransDecoder;
  Linear<B> final_layer;
  PositionTable<B> positions;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = SequenceDecoder;
    return motionlang::fields("seqTransDecoder", &M::seqTransDecoder, "final_layer", &M::final_layer, "positions",
                              &M::positions, "dropout_p", &M::dropout_p);
  }
  SequenceDecoder() = default;
  SequenceDecoder(Index nfeats, const TransformerConfig& c, Index max_len, Rng auto& rng)
      : seqTransDecoder(copied_layers<TransformerDecoder<B>>(c, rng)),
        final_layer(c.d_model, nfeats, rng),
        positions(max_len, c.d_model),
        dropout_p(c.dropout) {}

  /// One or several rows of memory for each sequence; `lengths` gives the frames of each.
  Sequences<B> operator()(const Sequences<B>& memory, const Offsets& lengths, const Context& context = {}) const {
    const ModuleScope scope(*this);
    auto queries = [&](const Offsets& of) { return position_queries(positions.rows(), of); };
    return decode_lengths(seqTransDecoder, final_layer, queries, memory, lengths, dropout_p, context);
  }
  /// z (sequences, width)
  Sequences<B> operator()(const Tensor<B, 2>& z, const Offsets& lengths, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return (*this)(Sequences<B>(z, Offsets::equal(z.size(0), 1)), lengths, context);
  }
};

MOTIONLANG_NAMESPACE_END
