// SPDX-License-Identifier: MIT
/// TEACH: a sequence of actions, each generated from the end of the one before it. This header assembles it from vae/,
/// nn/sequence_vae.hpp and compose/teach_join.hpp.
///
///     const std::vector<std::string> actions{"walk", "turn left", "sit"};
///     const Sequences<B> states = distilbert(tokenize(tokenizer, actions)).tokens;    // text/bert.hpp
///     const auto parts = actions_to_motion(teach, states, Offsets{60, 40, 90}, Philox{.seed = 7});
///     // Rotations and translation, 30 frames per second.
///     const auto motion = teach_motion(normalizer, parts, teach_window);
///
/// A single action is text_to_motion(teach, states, lengths, rng).
/// Source  Athanasiou, Petrovich, Black, Varol: "TEACH: Temporal action composition for 3D humans" (3DV 2022);
///         thesis, annex A
#pragma once

#include <motionlang/compose/teach_join.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/vae/teach_text_encoder.hpp>
#include <motionlang/vae/teach_training.hpp>
#include <motionlang/vae/temos_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Published sizes. (The published configuration has six heads under a name that is never read; there are four.)
struct TeachConfig {
  static constexpr bool is_option = true;  // holds no tensors
  Index nfeats = 135, text_dim = 768;
  Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  Index hist_frames = 5;        // of the past, with which a text is encoded
  bool z_prev_text = false;     // also the latent of the past
  bool motion_encoder = true;   // for training
  bool unused_encoder = false;  // textencoder.motionTransEncoder of published checkpoints
  bool mask_padding = false;    // true: as in the paper; in training, published code attends to frames of padding
  Index max_len = 5000;
  bool operator==(const TeachConfig&) const = default;
};

/// The number of frames that published evaluations interpolate between two actions.
inline constexpr Index teach_window = 8;

namespace detail {

/// The generated frames of each part: all except the gap before it. Throws config_error 101 if fewer than two remain,
/// and for a negative gap.
Offsets generated_frames(const Offsets& lengths, Index gap);
/// Parts, whose generated frames follow each other, with rows of 0 in the gaps.
template <Backend B>
Sequences<B> with_gaps(const Tensor<B, 2>& frames, const Offsets& lengths, Index gap) {
  PoolVector<Index> pick;
  Index next = 0;
  for (Index i = 0; i < lengths.count(); ++i) {
    for (Index f = 0; f < lengths.length(i); ++f) pick.push_back(i > 0 && f < gap ? frames.size(0) : next++);
  }
  return {gather(concat(0, frames, Tensor<B, 2>::zeros({1, frames.size(1)})), pick), lengths};
}

}  // namespace detail

/// The names are those of the published checkpoints, which also contain DistilBERT (textencoder.text_model.*) and
/// tables of positions.
template <Backend B>
struct Teach {
  TeachTextEncoder<B> textencoder;
  std::optional<TemosMotionEncoder<B>> motionencoder;
  SequenceDecoder<B> motiondecoder;
  TeachConfig config;

  static constexpr auto fields() {
    using M = Teach;
    return motionlang::fields("textencoder", &M::textencoder, "motionencoder", &M::motionencoder, "motiondecoder",
                              &M::motiondecoder, "config", &M::config);
  }
  Teach() = default;
  Teach(const TeachConfig& c, Rng auto& rng)
      : textencoder(c.text_dim, c.nfeats, c.hist_frames, c.unused_encoder, transformer_of(c), c.max_len, rng),
        motiondecoder(c.nfeats, transformer_of(c), c.max_len, rng),
        config(c) {
    if (c.motion_encoder) motionencoder.emplace(c.nfeats, true, transformer_of(c), c.max_len, rng);
  }

  /// tokens: the last states of the language model, with those of [CLS] and [SEP].
  LatentGaussian<B> encode_text(const Sequences<B>& tokens, const TeachPast<B>& past = {},
                                const Context& context = {}) const {
    return textencoder(tokens, past, context);
  }
  /// motion: normalised features. Throws config_error 101 if the model has no motion encoder.
  LatentGaussian<B> encode_motion(const Sequences<B>& motion, const Context& context = {}) const {
    if (!motionencoder) raise<config_error>(101, "Teach: this model has no motion encoder");
    return (*motionencoder)(motion, context);
  }
  /// z (motions, latent) -> normalised features
  Sequences<B> decode(const Tensor<B, 2>& z, const Offsets& lengths, const Context& context = {}) const {
    return motiondecoder(z, lengths, context);
  }
  /// The frames with which the next text is encoded. Throws shape_error 207 for a motion of fewer than hist_frames
  /// frames.
  TeachPast<B> past_of(const Sequences<B>& motion, const Tensor<B, 2>& z) const {
    TeachPast<B> out{last_rows(motion, Offsets::equal(motion.count(), config.hist_frames))};
    if (config.z_prev_text) out.z = z;
    return out;
  }

  /// Both actions of a training step, for teach_losses. The second text sees the end of the first motion as decoded
  /// from the first text, and gradients flow through it. With `teacher_forcing` it sees that of the data.
  /// Source  thesis A.2.3; TEACH teach/model/teach.py allsplit_step
  TeachBranches<B> branches(const TeachPairs<B>& pairs, const TeachNoise<B>& noise, const Context& context = {},
                            bool teacher_forcing = false) const {
    auto branch = [&](LatentGaussian<B> g, const Tensor<B, 2>& eps, double fact, const Sequences<B>& motion) {
      return latent_branch(std::move(g), eps, fact,
                           [&](const Tensor<B, 2>& z) { return decode(z, motion.offsets, context); });
    };
    const auto &first = pairs.first_motion, &second = pairs.second_motion;
    TeachBranches<B> out;
    const auto& text = out.first.text =
        branch(encode_text(pairs.first_text, {}, context), noise.first.text, noise.first.fact, first);
    const auto past = past_of(teacher_forcing ? first : first.with(text.frames), text.z);
    out.past = *past.frames;
    out.second.text =
        branch(encode_text(pairs.second_text, past, context), noise.second.text, noise.second.fact, second);
    if (!motionencoder) return out;
    auto encode = [&](const Sequences<B>& motion, Index longest) {
      return encode_motion(config.mask_padding ? motion : from_equal(to_padded(motion, 0, longest)), context);
    };
    out.first.motion = branch(encode(first, pairs.longest_first), noise.first.motion, noise.first.fact, first);
    out.second.motion = branch(encode(second, pairs.longest_second), noise.second.motion, noise.second.fact, second);
    return out;
  }

  /// The parts of one motion in normalised features, one for each text, in their order.
  /// lengths  frames of the parts, each with the gap of `window` frames before it; the gaps are rows of 0
  /// eps      (texts, latent), standard normal
  /// Throws   shape_error 204, 207; config_error 101 for a part of fewer than two frames after its gap
  /// Source   thesis A.2.3, A.3.4; TEACH teach/model/teach.py forward_seq
  Sequences<B> generate(const Sequences<B>& texts, const Offsets& lengths, const Tensor<B, 2>& eps,
                        Index window = 0) const {
    if (lengths.count() != texts.count() || eps.size(0) != texts.count())
      raise<shape_error>(204, "Teach: ", texts.count(), " texts, ", lengths.count(), " lengths, eps ", eps.shape());
    const Offsets frames = detail::generated_frames(lengths, window);
    std::vector<Tensor<B, 2>> rows;
    TeachPast<B> past;
    for (Index i = 0; i < texts.count(); ++i) {
      const auto z = encode_text({texts[i], Offsets{texts.offsets.length(i)}}, past).sample(slice(eps, 0, i, i + 1));
      const auto part = decode(z, Offsets{frames.length(i)});
      rows.push_back(part.rows);
      if (i + 1 < texts.count()) past = past_of(part, z);
    }
    return detail::with_gaps(concat(std::span<const Tensor<B, 2>>(rows), 0), lengths, window);
  }
};

/// The baseline "independent": independent parts from a model of single actions (Temos with 135 features). The baseline
/// "joint" is text_to_motion of all labels joined by commas. Arguments as in Teach::generate.
template <Backend B, class Model>
Sequences<B> independent_actions(const Model& model, const Sequences<B>& texts, const Offsets& lengths,
                                 const Tensor<B, 2>& eps, Index window = 0) {
  const auto parts = model.decode(model.encode_text(texts).sample(eps), detail::generated_frames(lengths, window));
  return detail::with_gaps(parts.rows, lengths, window);
}

/// The parts of one motion, with noise that depends only on seed and place.
template <Backend B>
Sequences<B> actions_to_motion(const Teach<B>& model, const Sequences<B>& texts, const Offsets& lengths,
                               const Philox& rng, Index window = teach_window, const LatentSampling& sampling = {}) {
  auto noise = rng;
  const auto eps = Tensor<B, 2>::randn({texts.count(), model.config.latent_dim}, noise);
  return model.generate(texts, lengths, eps * (sampling.mean ? 0 : sampling.fact), window);
}

/// Normalised parts to one motion: rotations of 22 joints and translation, metres, Z up, 30 frames per second. Each
/// part is aligned to the end of the one before it, and the gap of `window` frames between them is interpolated.
template <Backend B>
SmplVelpMotion<typename B::scalar> teach_motion(const Normalizer<B>& normalizer, const Sequences<B>& parts,
                                                Index window = 0, Alignment alignment = Alignment::full) {
  const auto features = normalizer.denormalize(parts.rows);
  auto motion = smplvelp_inverse(features.span());
  PoolVector<Index> lengths;
  for (Index i = 0; i < parts.count(); ++i) lengths.push_back(parts.offsets.length(i));
  join_parts(motion, std::span<const Index>(lengths), window, alignment);
  return motion;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/systems/teach.ipp>
#endif
