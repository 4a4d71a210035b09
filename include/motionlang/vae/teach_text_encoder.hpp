// SPDX-License-Identifier: MIT
/// TEACH's text encoder: the latent of an action depends on the frames before it.
#pragma once

#include <motionlang/vae/parted_text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TeachTextKeys {
  static constexpr const char* separation_token = "seperation_token";  // the published spelling
};

/// The motion before an action.
template <Backend B>
struct TeachPast {
  std::optional<Sequences<B>>
      frames{};  // the last `hist_frames` normalised frames of each motion; none before the first action
  std::optional<Tensor<B, 2>> z{};  // the latents that gave them, only if the model reads them (z_prev_text)
};

///     [mu, logvar, past, z, separation, text] -> encoder -> mu, logvar          past = encoder(W p + positions)
/// Past and text have positions of their own; the tokens and z have none.
/// Source   thesis A.2.2, "Past-conditioned Text Encoder"; TEACH (3DV 2022) teach/model/textencoder/text_hist.py
/// Differs  from the paper, as published: the past goes through the transformer of the text. The transformer that the
///          paper describes for the past is in the checkpoints and is never called
template <Backend B>
struct TeachTextEncoder {
  PartedTextEncoder<B, TeachTextKeys> text;
  Linear<B> skel_embedding;
  std::optional<TransformerEncoder<B>> motionTransEncoder;  // never called
  Index hist_frames = 5;

  static constexpr auto fields() {
    using M = TeachTextEncoder;
    return motionlang::fields("", &M::text, "skel_embedding", &M::skel_embedding, "motionTransEncoder",
                              &M::motionTransEncoder, "hist_frames", &M::hist_frames);
  }
  TeachTextEncoder() = default;
  TeachTextEncoder(Index text_dim, Index nfeats, Index past_frames, bool unused_encoder, const TransformerConfig& c,
                   Index max_len, Rng auto& rng)
      : text(text_dim, c, max_len, rng), skel_embedding(nfeats, c.d_model, rng), hist_frames(past_frames) {
    if (unused_encoder) motionTransEncoder = copied_layers<TransformerEncoder<B>>(c, rng);
  }

  /// The tokens of the texts, projected, with positions.
  Sequences<B> text_tokens(const Sequences<B>& states, const Context& context = {}) const {
    return text.placed(text.projected(states), context);
  }
  /// Throws shape_error 205 unless each past has hist_frames frames.
  Sequences<B> encode_past(const Sequences<B>& frames, const Context& context = {}) const {
    if (!(frames.offsets == Offsets::equal(frames.count(), hist_frames)))
      raise<shape_error>(205, "TeachTextEncoder: ", frames.count(), " pasts of ", frames.offsets.rows(),
                         " frames together; each has to have ", hist_frames);
    return text.seqTransEncoder(text.placed(skel_embedding(frames), context), context);
  }
  /// states: the last states of the language model, with those of [CLS] and [SEP].
  LatentGaussian<B> operator()(const Sequences<B>& states, const TeachPast<B>& past = {},
                               const Context& context = {}) const {
    const ModuleScope scope(*this);
    auto sequence = repeat_sequence(text.beginning(), states.count());
    if (past.frames) sequence = concat_tokens(sequence, encode_past(*past.frames, context));
    if (past.z) sequence = concat_tokens(sequence, Sequences<B>(*past.z, Offsets::equal(past.z->size(0), 1)));
    const auto separation = repeat_sequence(text.separation(), states.count());
    return text.encode(concat_tokens(sequence, separation, text_tokens(states, context)), context);
  }
};

MOTIONLANG_NAMESPACE_END
