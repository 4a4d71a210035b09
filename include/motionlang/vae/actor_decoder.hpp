// SPDX-License-Identifier: MIT
/// ACTOR's decoder: a latent, an action and a duration become a motion.
#pragma once

#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// How action and time enter the decoder; all but the first are ablations (thesis 3.3.2, table 3.4 c).
enum class ActorConditioning {
  action_bias,    // memory z + b_y, queries are sinusoidal positions
  concat_bias,    // memory of two rows, z and b_y
  zandtime,       // memory W [z, one-hot y]
  time_encoding,  // time_encoding,  // as action_bias, but every component of query t is t / (length - 1)
};

/// Source  thesis 3.2.1, "Decoder"; ACTOR (ICCV 2021) src/models/architectures/transformer.py Decoder_TRANSFORMER
template <Backend B>
struct ActorDecoder {
  std::optional<Tensor<B, 2>> actionBiases;  // (classes, width)
  std::optional<Linear<B>> ztimelinear;      // of zandtime
  TransformerDecoder<B> seqTransDecoder;
  Linear<B> finallayer;
  PositionTable<B> positions;
  ActorConditioning conditioning = ActorConditioning::action_bias;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = ActorDecoder;
    return motionlang::fields("actionBiases", &M::actionBiases, "ztimelinear", &M::ztimelinear, "seqTransDecoder",
                              &M::seqTransDecoder, "finallayer", &M::finallayer, "positions", &M::positions,
                              "conditioning", &M::conditioning, "dropout_p", &M::dropout_p);
  }
  ActorDecoder() = default;
  ActorDecoder(Index nfeats, Index classes, const TransformerConfig& c, Index max_len, ActorConditioning how,
               Rng auto& rng)
      : finallayer(c.d_model, nfeats, rng), positions(max_len, c.d_model), conditioning(how), dropout_p(c.dropout) {
    if (how == ActorConditioning::zandtime)
      ztimelinear.emplace(c.d_model + classes, c.d_model, rng);
    else
      actionBiases = normal_init<B, 2>({classes, c.d_model}, 1, rng);
    seqTransDecoder = copied_layers<TransformerDecoder<B>>(c, rng);
  }

  /// The rows to which the frames of each motion attend. z (motions, width).
  /// Throws shape_error 203 for a label that is not a class, 204 unless there is one label for each motion.
  Sequences<B> memory(const Tensor<B, 2>& z, std::span<const Index> labels) const {
    if (std::ssize(labels) != z.size(0))
      raise<shape_error>(204, "ActorDecoder: ", labels.size(), " labels for ", z.size(0), " motions");
    const auto one = Offsets::equal(z.size(0), 1);
    if (ztimelinear) return {(*ztimelinear)(concat(1, z, one_hot<B>(labels, ztimelinear->in() - z.size(1)))), one};
    const auto bias = gather(*actionBiases, labels);
    if (conditioning == ActorConditioning::concat_bias)
      return concat_tokens(Sequences<B>(z, one), Sequences<B>(bias, one));
    return {z + bias, one};
  }
  Sequences<B> queries(const Offsets& lengths) const {
    if (conditioning != ActorConditioning::time_encoding) return position_queries(positions.rows(), lengths);
    const Index width = finallayer.in();
    return {broadcast_to<2>(relative_time<B>(lengths), {lengths.rows(), width}), lengths};
  }
  Sequences<B> operator()(const Sequences<B>& memory, const Offsets& lengths, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return decode_lengths(
        seqTransDecoder, finallayer, [&](const Offsets& of) { return queries(of); }, memory, lengths, dropout_p,
        context);
  }
  /// Throws shape_error 203, 204.
  Sequences<B> operator()(const Tensor<B, 2>& z, std::span<const Index> labels, const Offsets& lengths,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    return (*this)(memory(z, labels), lengths, context);
  }
};

MOTIONLANG_NAMESPACE_END
