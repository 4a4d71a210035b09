// SPDX-License-Identifier: MIT
/// MDM, the Human Motion Diffusion Model, in its three architectures.
#pragma once

#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/nn/gru.hpp>
#include <motionlang/nn/positional_encoding.hpp>
#include <motionlang/nn/timestep_embedding.hpp>
#include <motionlang/nn/transformer_decoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class MdmArch { trans_enc, trans_dec, gru };
enum class MdmCondition { text, action, none };
/// The rows before the frames in trans_dec: none, the time embedding with the text's (all checkpoints of 2022-2023), or
/// the time embedding alone (DistilBERT models).
enum class MdmClassToken { none, time_plus_text, time_only };

struct MdmConfig {
  static constexpr bool is_option = true;  // holds no tensors
  Index nfeats = 263;                      // joints times features of the published layout
  MdmArch arch = MdmArch::trans_enc;
  MdmCondition condition = MdmCondition::text;
  Index text_dim = 512;        // CLIP; 768 for DistilBERT
  bool text_sequence = false;  // every token is a memory row (DistilBERT, trans_dec)
  Index num_actions = 1;
  MdmClassToken class_token = MdmClassToken::none;
  Index latent_dim = 512;
  Index ff_size = 1024;
  Index num_layers = 8;
  Index num_heads = 4;
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  bool mask_frames = false;    // newer models: padded frames are not attended to
  bool gru_over_batch = true;  // the released gru runs its recurrence over the batch index; false: over time
  Index crop_frames = 196;     // released models were trained on exactly this many frames
  Index max_len = 1024;
};

/// e = time MLP(pe[t]) + text projection(m * text): one conditioning vector per sequence. m = 0, that is, zero
/// features, gives the unconditional call; the projection's bias remains. Actions are one-hot features.
///     trans_enc   [e, frames] + positions -> post-norm encoder -> frames
///     trans_dec   frames (+ class token) + positions attend to e (or to every text token plus time)
///     gru         GRU(Linear([features, e]) + positions)
/// Source  Tevet et al. (2023), section 3; GuyTevet/motion-diffusion-model model/mdm.py, whose keys are the field names
/// Shapes  a published motion [batch, J, C, frames] is frames rows of J * C features here
template <Backend B>
struct MdmDenoiser {
  Linear<B> pose_embedding;
  TimestepEmbedding<B> embed_timestep;
  std::optional<Linear<B>> embed_text;
  std::optional<Tensor<B, 2>> action_embedding;  // (actions, latent)
  std::optional<TransformerEncoder<B>> seqTransEncoder;
  std::optional<TransformerDecoder<B>> seqTransDecoder;
  std::optional<Gru<B>> gru;
  Linear<B> pose_final;
  PositionTable<B> positions;
  MdmConfig config;

  static constexpr auto fields() {
    using M = MdmDenoiser;
    return motionlang::fields("input_process.poseEmbedding", &M::pose_embedding, "embed_timestep", &M::embed_timestep,
                              "embed_text", &M::embed_text, "embed_action.action_embedding", &M::action_embedding,
                              "seqTransEncoder", &M::seqTransEncoder, "seqTransDecoder", &M::seqTransDecoder, "gru",
                              &M::gru, "output_process.poseFinal", &M::pose_final, "positions", &M::positions, "config",
                              &M::config);
  }
  /// The official name of a parameter. Those of the GRU are numbered, not nested.
  static std::string official_key(const std::string& path) { return gru_key(path); }

  MdmDenoiser() = default;
  MdmDenoiser(const MdmConfig& c, Rng auto& rng)
      : pose_embedding(c.nfeats + (c.arch == MdmArch::gru ? c.latent_dim : 0), c.latent_dim, rng),
        embed_timestep(c.latent_dim, rng),
        pose_final(c.latent_dim, c.nfeats, rng),
        positions(c.max_len, c.latent_dim),
        config(c) {
    const TransformerConfig transformer{.d_model = c.latent_dim,
                                        .heads = c.num_heads,
                                        .d_ff = c.ff_size,
                                        .layers = c.num_layers,
                                        .activation = c.activation,
                                        .dropout = c.dropout};
    if (c.condition == MdmCondition::text) embed_text.emplace(c.text_dim, c.latent_dim, rng);
    if (c.condition == MdmCondition::action)
      action_embedding = normal_init<B, 2>({c.num_actions, c.latent_dim}, 1, rng);
    if (c.arch == MdmArch::trans_enc) seqTransEncoder.emplace(transformer, rng);
    if (c.arch == MdmArch::trans_dec) seqTransDecoder.emplace(transformer, rng);
    if (c.arch == MdmArch::gru) gru.emplace(c.latent_dim, c.latent_dim, c.num_layers, rng);
  }

  DenoiserTraits traits() const {
    const bool mixes = config.arch == MdmArch::gru && config.gru_over_batch;
    return {.crop_frames = config.crop_frames,
            .uses_lengths = config.mask_frames,
            .empty_text_is_null = true,
            .mates = mixes ? BatchMates::all : BatchMates::none};
  }

  Tensor<B, 2> time_tokens(std::span<const Index> t) const { return embed_timestep(positions.rows(), t); }

  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    const Index n = x.count();
    if (static_cast<Index>(t.size()) != n || (config.condition != MdmCondition::none && text.count() != n)) {
      raise<shape_error>(204, "MdmDenoiser: ", n, " sequences, ", text.count(), " texts, ", t.size(), " steps");
    }
    const auto time = time_tokens(t);
    if (config.arch == MdmArch::gru) return recurrent(x, conditioned(time, text));
    const auto frames = x.with(pose_embedding(x.rows));
    auto dropped = [&](const Sequences<B>& s) { return s.with(dropout(s.rows, config.dropout, context)); };
    if (config.arch == MdmArch::trans_enc) {
      const Sequences<B> token(conditioned(time, text), Offsets::equal(n, 1));
      const auto tokens = dropped(add_positions(concat_tokens(token, frames), positions.rows()));
      return pose_final(last_rows((*seqTransEncoder)(tokens, context), x.offsets));
    }
    const auto memory =
        config.text_sequence ? text_memory(time, text) : Sequences<B>(conditioned(time, text), Offsets::equal(n, 1));
    auto queries = frames;
    if (config.class_token != MdmClassToken::none) {
      const auto token = config.class_token == MdmClassToken::time_only ? time : conditioned(time, text);
      queries = concat_tokens(Sequences<B>(token, Offsets::equal(n, 1)), frames);
    }
    queries = dropped(add_positions(queries, positions.rows()));
    return pose_final(last_rows((*seqTransDecoder)(queries, memory, context), x.offsets));
  }

 private:
  /// e, one per sequence.
  Tensor<B, 2> conditioned(const Tensor<B, 2>& time, const TextFeatures<B>& text) const {
    if (embed_text) return time + (*embed_text)(text.tokens.rows);
    if (action_embedding) return time + matmul(text.tokens.rows, *action_embedding);
    return time;
  }
  /// Every projected text token plus the time embedding of its sequence.
  Sequences<B> text_memory(const Tensor<B, 2>& time, const TextFeatures<B>& text) const {
    return text.tokens.with((*embed_text)(text.tokens.rows) + repeat_for_rows(time, text.tokens.offsets));
  }
  Sequences<B> recurrent(const Sequences<B>& x, const Tensor<B, 2>& e) const {
    const auto input =
        add_positions(x.with(pose_embedding(concat(1, x.rows, repeat_for_rows(e, x.offsets)))), positions.rows());
    const Index n = x.count(), frames = x.offsets.longest();
    if (x.offsets.rows() != n * frames) raise<shape_error>(207, "MdmDenoiser: the gru needs sequences of one length");
    std::vector<Tensor<B, 2>> steps;
    if (config.gru_over_batch) {
      for (Index s = 0; s < n; ++s) steps.push_back(input[s]);
      return x.with(pose_final(concat(std::span<const Tensor<B, 2>>((*gru)(steps)), 0)));
    }
    std::vector<Index> at(static_cast<std::size_t>(n)), back;
    for (Index f = 0; f < frames; ++f) {
      for (Index s = 0; s < n; ++s) at[static_cast<std::size_t>(s)] = s * frames + f;
      steps.push_back(gather(input.rows, at));
    }
    for (Index s = 0; s < n; ++s) {
      for (Index f = 0; f < frames; ++f) back.push_back(f * n + s);
    }
    return x.with(pose_final(gather(concat(std::span<const Tensor<B, 2>>((*gru)(steps)), 0), back)));
  }
};

MOTIONLANG_NAMESPACE_END
