// SPDX-License-Identifier: MIT
/// MDM-SMPL: the denoiser of the STMC paper.
#pragma once

#include <algorithm>  // max
#include <optional>   // registers

#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/nn/positional_encoding.hpp>
#include <motionlang/nn/timestep_embedding.hpp>
#include <motionlang/nn/transformer_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Published sizes (27 M parameters).
struct MdmSmplConfig {
  static constexpr bool is_option = true;  // holds no tensors
  Index nfeats = 205;
  Index tx_dim = 512;
  Index latent_dim = 512;
  Index ff_size = 2048;
  Index num_layers = 8;
  Index num_heads = 8;
  Index nb_registers = 2;  // may be 0
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  Index max_len = 1024;  // of a sequence with its tokens, and of the diffusion steps

  /// Frames that fit after the tokens of time and of a text of one token.
  Index longest_crop() const { return max_len - 2 - nb_registers; }
};

/// The sequence [time, text ..., registers, frames] plus sinusoidal positions goes through a pre-norm transformer
/// encoder. The frames are the last rows of the result.
/// Source   thesis 6.2.4 ("Multi-track timeline control", Petrovich et al. 2024); nv-tlabs/stmc src/model/mdm_smpl.py,
///          whose state-dict keys (after "denoiser.") are the field names
/// Caution  Texts of several tokens are placed as the published code pads them: frames follow the longest text of the
///          batch. So such a sequence depends on the rest of its batch. Texts of one token (CLIP, ours) do not
/// Differs  from MDM: pre-norm, a text projection of two layers, register tokens, masks (here: packed sequences)
template <Backend B>
struct MdmSmplDenoiser {
  std::optional<Tensor<B, 2>> registers;  // (nb_registers, latent_dim); without any, files have no such tensor
  Linear<B> text_in, text_out;
  LayerNorm<B> text_norm;
  Linear<B> skel_embedding;
  TimestepEmbedding<B> timestep_encoder;
  TransformerEncoder<B> seqTransEncoder;
  Linear<B> to_skel_layer;
  PositionTable<B> positions;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = MdmSmplDenoiser;
    return motionlang::fields("registers", &M::registers, "tx_embedding.0", &M::text_in, "tx_embedding.2", &M::text_out,
                              "tx_embedding.3", &M::text_norm, "skel_embedding", &M::skel_embedding, "timestep_encoder",
                              &M::timestep_encoder, "seqTransEncoder", &M::seqTransEncoder, "to_skel_layer",
                              &M::to_skel_layer, "positions", &M::positions, "dropout_p", &M::dropout_p);
  }
  MdmSmplDenoiser() = default;
  MdmSmplDenoiser(const MdmSmplConfig& c, Rng auto& rng)
      : registers(c.nb_registers > 0 ? std::optional(normal_init<B, 2>({c.nb_registers, c.latent_dim}, 1, rng))
                                     : std::nullopt),
        text_in(c.tx_dim, 2 * c.latent_dim, rng),
        text_out(2 * c.latent_dim, c.latent_dim, rng),
        text_norm(c.latent_dim),
        skel_embedding(c.nfeats, c.latent_dim, rng),
        timestep_encoder(c.latent_dim, rng),
        seqTransEncoder({.d_model = c.latent_dim,
                         .heads = c.num_heads,
                         .d_ff = c.ff_size,
                         .layers = c.num_layers,
                         .activation = c.activation,
                         .norm_first = true,
                         .dropout = c.dropout},
                        rng),
        to_skel_layer(c.latent_dim, c.nfeats, rng),
        positions(c.max_len, c.latent_dim),
        dropout_p(c.dropout) {}

  /// The frames that fit after the tokens for time and text and the registers.
  DenoiserTraits traits() const {
    return {.longest_crop =
                MdmSmplConfig{.nb_registers = register_count(), .max_len = positions.rows().size(0)}.longest_crop(),
            .mates = BatchMates::longest_text};
  }

  Index register_count() const { return registers ? registers->size(0) : 0; }
  /// (sequences, latent)
  Tensor<B, 2> time_tokens(std::span<const Index> t) const { return timestep_encoder(positions.rows(), t); }
  /// Token by token.
  Sequences<B> text_tokens(const TextFeatures<B>& text) const {
    return text.tokens.with(text_norm(text_out(text_in(text.tokens.rows, Activation::gelu))));
  }
  /// The tokens of the texts, which are the same at every step.
  struct EncodedText {
    Sequences<B> tokens;
    Index padded_tokens = 0;  // as in TextFeatures

    Index places() const { return std::max(padded_tokens, tokens.offsets.longest()); }
  };
  EncodedText encode(const TextFeatures<B>& text) const { return {text_tokens(text), text.padded_tokens}; }

  /// The input of the first layer.
  Sequences<B> sequence(const Sequences<B>& x, std::span<const Index> t, const EncodedText& text) const {
    check_counts(x.count(), t, text);
    const auto tokens = concat_tokens(head_tokens(t, text), x.with(skel_embedding(x.rows)));
    return add_positions(tokens, positions.rows(), gaps(text));
  }
  Sequences<B> sequence(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text) const {
    return sequence(x, t, encode(text));
  }
  /// Sequence i with each of the texts uses.begin(i) ... uses.end(i) - 1, without dropout. Work that they share is done
  /// once. t: a step for each text. Throws shape_error 204 for other numbers of sequences, texts or steps.
  Sequences<B> operator()(const Sequences<B>& x, const Offsets& uses, std::span<const Index> t,
                          const EncodedText& text) const {
    const ModuleScope scope(*this);
    check_counts(uses.rows(), t, text);
    const Offsets lengths = repeat_lengths(x.offsets, uses);
    const auto heads = add_positions(head_tokens(t, text), positions.rows(), gaps(text));
    const PoolVector<PositionGap> before(static_cast<std::size_t>(x.count()),
                                         {0, 1 + text.places() + register_count()});
    const auto frames = add_positions(x.with(skel_embedding(x.rows)), positions.rows(), before);
    return to_skel_layer(last_rows(seqTransEncoder.with_tails(heads, frames, uses), lengths));
  }
  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    return (*this)(x, t, encode(text), context);
  }
  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const EncodedText& text,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    auto tokens = sequence(x, t, text);
    if (context.dropout) tokens = tokens.with(dropout(tokens.rows, dropout_p, context));
    return to_skel_layer(last_rows(seqTransEncoder(tokens, context), x.offsets));
  }

 private:
  static void check_counts(Index n, std::span<const Index> t, const EncodedText& text) {
    if (text.tokens.count() == n && static_cast<Index>(t.size()) == n) return;
    raise<shape_error>(204, "MdmSmplDenoiser: ", n, " sequences, ", text.tokens.count(), " texts, ", t.size(),
                       " steps");
  }
  /// The rows before the frames, without positions.
  Sequences<B> head_tokens(std::span<const Index> t, const EncodedText& text) const {
    const Sequences<B> time(time_tokens(t), Offsets::equal(text.tokens.count(), 1));
    if (!registers) return concat_tokens(time, text.tokens);
    return concat_tokens(time, text.tokens, repeat_sequence(*registers, text.tokens.count()));
  }
  /// Rows after a text have the positions that follow the longest text of the batch and its padding.
  static PoolVector<PositionGap> gaps(const EncodedText& text) {
    const Offsets& texts = text.tokens.offsets;
    PoolVector<PositionGap> out;
    for (Index s = 0; s < texts.count(); ++s) out.push_back({1 + texts.length(s), text.places() - texts.length(s)});
    return out;
  }
};

MOTIONLANG_NAMESPACE_END
