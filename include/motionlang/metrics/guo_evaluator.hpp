// SPDX-License-Identifier: MIT
/// The networks of Guo et al. that judge generated motions. They put a text and its motion close to each other.
///
///     const auto text = evaluator.embed_texts(words.encode<B>(texts).tokens);       // text/glove.hpp
///     const auto motion = evaluator.embed_motions(normalized);                      // (motions, 512), in their order
///     metric.add(Rows(text.span(), 512), Rows(motion.span(), 512));                 // metrics/matching.hpp
///
/// Source  Guo et al., "Generating diverse and natural 3D human motions from text" (CVPR 2022), section 5.2;
///         text-to-motion networks/modules.py, networks/evaluator_wrapper.py; TM2T (ECCV 2022), appendix C
/// Differs from the wrapper: rows keep the order of the caller, while the wrapper returns the longest motion first.
#pragma once

#include <motionlang/metrics/guo_movement.hpp>
#include <motionlang/nn/bi_gru.hpp>
#include <motionlang/nn/layer_norm.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// From the ends of a BiGruEncoder to the common space:  W3 leaky_relu(LN(W0 x)).
template <Backend B>
struct CoEmbedding {
  Linear<B> linear_0;
  LayerNorm<B> norm;
  Linear<B> linear_3;

  static constexpr auto fields() {
    return motionlang::fields("0", &CoEmbedding::linear_0, "1", &CoEmbedding::norm, "3", &CoEmbedding::linear_3);
  }
  CoEmbedding() = default;
  CoEmbedding(Index hidden, Index out, Rng auto& rng)
      : linear_0(detail::xavier_linear<B>(2 * hidden, hidden, rng)),
        norm(hidden),
        linear_3(detail::xavier_linear<B>(hidden, out, rng)) {}

  Tensor<B, 2> operator()(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    return linear_3(leaky_relu(norm(linear_0(x))));
  }
};

/// Rows of word vectors followed by parts of speech, as `GloVe::encode` makes them.
template <Backend B>
struct GuoTextEncoder {
  Linear<B> pos_emb;
  BiGruEncoder<B> encoder;
  CoEmbedding<B> output_net;

  static constexpr auto fields() {
    using M = GuoTextEncoder;
    return motionlang::fields("pos_emb", &M::pos_emb, "", &M::encoder, "output_net", &M::output_net);
  }
  GuoTextEncoder() = default;
  GuoTextEncoder(Index word, Index pos, Index hidden, Index out, Rng auto& rng)
      : pos_emb(detail::xavier_linear<B>(pos, word, rng)), encoder(word, hidden, rng), output_net(hidden, out, rng) {}

  /// (texts, out). Throws shape_error 203 for a text without words.
  Tensor<B, 2> operator()(const Sequences<B>& words) const {
    const ModuleScope scope(*this);
    const Index word = pos_emb.out();
    if (words.width() != word + pos_emb.in())
      raise<shape_error>(204, "GuoTextEncoder: rows of ", words.width(), " numbers, ", word, " and ", pos_emb.in(),
                         " are expected");
    const auto tags = pos_emb(slice(words.rows, 1, word, words.width()));
    return output_net(encoder(words.with(slice(words.rows, 1, 0, word) + tags)).ends());
  }
};

/// Rows of movements.
template <Backend B>
struct GuoMotionEncoder {
  BiGruEncoder<B> encoder;
  CoEmbedding<B> output_net;

  static constexpr auto fields() {
    using M = GuoMotionEncoder;
    return motionlang::fields("", &M::encoder, "output_net", &M::output_net);
  }
  GuoMotionEncoder() = default;
  GuoMotionEncoder(Index in, Index hidden, Index out, Rng auto& rng)
      : encoder(in, hidden, rng), output_net(hidden, out, rng) {}

  /// (motions, out). Throws shape_error 203 for a motion without movements.
  Tensor<B, 2> operator()(const Sequences<B>& movements) const {
    const ModuleScope scope(*this);
    return output_net(encoder(movements).ends());
  }
};

/// Published sizes.
struct GuoEvaluatorConfig {
  Index features = 263;  // with the contacts, which are not read; KIT: 251
  Index movement_hidden = 512, movement_latent = 512;
  Index word = 300, pos = 15, text_hidden = 512, motion_hidden = 1024, embedding = 512;
};

/// The names are those of the published checkpoint.
template <Backend B>
struct GuoEvaluator {
  MovementEncoder<B> movement_encoder;
  GuoTextEncoder<B> text_encoder;
  GuoMotionEncoder<B> motion_encoder;

  static constexpr auto fields() {
    using M = GuoEvaluator;
    return motionlang::fields("movement_encoder", &M::movement_encoder, "text_encoder", &M::text_encoder,
                              "motion_encoder", &M::motion_encoder);
  }
  GuoEvaluator() = default;
  GuoEvaluator(const GuoEvaluatorConfig& c, Rng auto& rng)
      : movement_encoder(c.features - 4, c.movement_hidden, c.movement_latent, rng),
        text_encoder(c.word, c.pos, c.text_hidden, c.embedding, rng),
        motion_encoder(c.movement_latent, c.motion_hidden, c.embedding, rng) {}

  Tensor<B, 2> embed_texts(const Sequences<B>& words) const { return text_encoder(words); }
  Tensor<B, 2> embed_motions(const Sequences<B>& motions) const { return motion_encoder(movements(motions)); }

  /// Converts normalised features to floor(frames / 4) movements each. As published, every motion is padded with zeros
  /// before the convolutions, which read beyond its end. The padding is to 196 frames, but only the two after the last
  /// movement matter. No gradient reaches the convolutions, because they are trained beforehand. Throws shape_error
  /// 203, 204, 205.
  Sequences<B> movements(const Sequences<B>& motions, Index longest = 196) const {
    const Index width = motions.width() - 4;
    std::vector<Index> lengths;
    for (Index s = 0; s < motions.count(); ++s) lengths.push_back(motions.offsets.length(s) / 4);
    const auto padded = to_padded(motions.with(slice(motions.rows, 1, 0, width)), 0, longest);
    const auto all = movement_encoder(from_equal(padded));
    const auto layout = reshape<3>(all.rows, {motions.count(), longest / 4, all.width()});
    const auto valid = from_padded(layout, std::span<const Index>(lengths));
    return valid.with(stop_gradient(valid.rows));
  }
};

MOTIONLANG_NAMESPACE_END
