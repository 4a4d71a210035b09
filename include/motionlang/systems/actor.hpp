// SPDX-License-Identifier: MIT
/// ACTOR: motions of any duration for an action. This header assembles it from vae/, nn/sequence_vae.hpp and
/// features/actor_points.hpp.
///
///     const std::vector<Index> actions{3, 7}, durations{60, 90};
///     const auto motions = generate(actor, actions, durations, rng, {.samples = 5});   // motions[2 sample + action]
///     const auto cleaned = denoise(actor, motions, labels);
///     const auto line = interpolate_actions(actor, 3, 7, 5, 60, rng);
///
/// Source  Petrovich, Black, Varol: "Action-conditioned 3D human motion synthesis with transformer VAE" (ICCV 2021);
///         thesis, chapter 3
#pragma once

#include <array>  // names

#include <motionlang/features/actor_points.hpp>
#include <motionlang/vae/actor_autoregressive.hpp>
#include <motionlang/vae/actor_decoder.hpp>
#include <motionlang/vae/actor_encoder.hpp>
#include <motionlang/vae/actor_frames.hpp>
#include <motionlang/vae/actor_fully_connected.hpp>
#include <motionlang/vae/actor_gru.hpp>
#include <motionlang/vae/actor_latents.hpp>
#include <motionlang/vae/actor_losses.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The rows of thesis table 3.4, which can be combined, and `frames` of table 3.7, which is both encoder and decoder.
enum class ActorEncoderKind { tokens, average, gru, fully_connected, frames };
enum class ActorDecoderKind { transformer, gru, fully_connected, autoregressive, frames };

inline constexpr std::array actor_encoder_names{"tokens", "average", "gru", "fully_connected", "frames"};
inline constexpr std::array actor_decoder_names{"transformer", "gru", "fully_connected", "autoregressive", "frames"};

/// Published sizes; 13 classes for NTU-13, 40 for UESTC.
struct ActorConfig {
  static constexpr bool is_option = true;  // holds no tensors
  Index njoints = 25, nfeats = 6;          // rows of a frame, and values of each: a translation is a row
  Index num_classes = 12;
  Index latent_dim = 256, ff_size = 1024, num_layers = 8, num_heads = 4;  // of frames, ff_size is the width of GRUs
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  ActorEncoderKind encoder = ActorEncoderKind::tokens;
  ActorDecoderKind decoder = ActorDecoderKind::transformer;
  ActorConditioning conditioning = ActorConditioning::action_bias;  // of the transformer decoder
  bool concatenate_time = true;                                     // gru and autoregressive: frames include their time
  Index num_frames = 60;                                            // of fully connected networks
  Index max_len = 5000;
  bool operator==(const ActorConfig&) const = default;
};

/// The names are those of the published checkpoints, which also contain tables of positions.
template <Backend B>
struct Actor {
  std::optional<ActorEncoder<B>> encoder;
  std::optional<ActorAverageEncoder<B>> average_encoder;
  std::optional<ActorGruEncoder<B>> gru_encoder;
  std::optional<ActorFullyConnectedEncoder<B>> fc_encoder;
  std::optional<ActorDecoder<B>> decoder;
  std::optional<ActorGruDecoder<B>> gru_decoder;
  std::optional<ActorFullyConnectedDecoder<B>> fc_decoder;
  std::optional<ActorAutoregressiveDecoder<B>> autoregressive_decoder;
  std::optional<ActorFrames<B>> frames;
  ActorConfig config;

  static constexpr auto fields() {
    using M = Actor;
    return motionlang::fields("encoder", &M::encoder, "encoder", &M::average_encoder, "encoder", &M::gru_encoder,
                              "encoder", &M::fc_encoder, "decoder", &M::decoder, "decoder", &M::gru_decoder, "decoder",
                              &M::fc_decoder, "decoder", &M::autoregressive_decoder, "frames", &M::frames, "config",
                              &M::config);
  }
  static std::string official_key(const std::string& path) { return gru_key(path); }

  Actor() = default;
  /// Throws config_error 102 if only one of encoder and decoder is `frames`.
  Actor(const ActorConfig& c, Rng auto& rng) : config(c) {
    if ((c.encoder == ActorEncoderKind::frames) != (c.decoder == ActorDecoderKind::frames))
      raise<config_error>(102, "Actor: encoder ", actor_encoder_names[static_cast<std::size_t>(c.encoder)],
                          ", decoder ", actor_decoder_names[static_cast<std::size_t>(c.decoder)],
                          ": frames is both of them, or none");
    const Index features = c.njoints * c.nfeats, classes = c.num_classes, width = c.latent_dim;
    const TransformerConfig t{.d_model = width,
                              .heads = c.num_heads,
                              .d_ff = c.ff_size,
                              .layers = c.num_layers,
                              .activation = c.activation,
                              .dropout = c.dropout};
    if (c.encoder == ActorEncoderKind::tokens) encoder.emplace(features, classes, t, c.max_len, rng);
    if (c.encoder == ActorEncoderKind::average) average_encoder.emplace(features, t, c.max_len, rng);
    if (c.encoder == ActorEncoderKind::gru)
      gru_encoder.emplace(features, classes, width, c.num_layers, c.concatenate_time, rng);
    if (c.encoder == ActorEncoderKind::fully_connected) fc_encoder.emplace(features, c.num_frames, classes, width, rng);
    if (c.decoder == ActorDecoderKind::transformer)
      decoder.emplace(features, classes, t, c.max_len, c.conditioning, rng);
    if (c.decoder == ActorDecoderKind::gru)
      gru_decoder.emplace(features, classes, width, c.num_layers, c.concatenate_time, rng);
    if (c.decoder == ActorDecoderKind::fully_connected) fc_decoder.emplace(features, c.num_frames, classes, width, rng);
    if (c.decoder == ActorDecoderKind::autoregressive)
      autoregressive_decoder.emplace(features, classes, t, c.max_len, c.concatenate_time, rng);
    if (c.decoder == ActorDecoderKind::frames) frames.emplace(features, classes, width, c.ff_size, c.num_layers, rng);
  }

  /// x: frames of `actor_frame_features`; one action per motion. padded_frames: see ActorAverageEncoder.
  /// -> a latent for each motion; of `frames`, for each frame
  /// Throws shape_error 203 for an action that is not a class.
  LatentGaussian<B> encode(const Sequences<B>& x, std::span<const Index> actions, const Context& context = {},
                           Index padded_frames = 0) const {
    if (frames) return frames->encode(x, actions);
    if (average_encoder) return (*average_encoder)(x, context, padded_frames);
    if (gru_encoder) return (*gru_encoder)(x, actions);
    if (fc_encoder) return (*fc_encoder)(x, actions, config.num_classes);
    return (*encoder)(x, actions, context);
  }
  /// The distribution from which the divergence is taken; none: standard normal.
  std::optional<LatentGaussian<B>> prior(const Sequences<B>& x, std::span<const Index> actions) const {
    if (frames) return frames->expect(x, actions);
    return {};
  }
  /// z (motions, latent_dim) to motions of these lengths; of `frames`, z has a row for each frame.
  Sequences<B> decode(const Tensor<B, 2>& z, std::span<const Index> actions, const Offsets& lengths,
                      const Context& context = {}) const {
    if (frames) return frames->decode(z, actions, lengths);
    if (gru_decoder) return (*gru_decoder)(z, actions, lengths);
    if (fc_decoder) return (*fc_decoder)(z, actions, lengths, config.njoints * config.nfeats);
    if (autoregressive_decoder) return (*autoregressive_decoder)(z, actions, lengths);
    return (*decoder)(z, actions, lengths, context);
  }
  /// decode for a training step: an autoregressive decoder reads the true frames before each frame.
  Sequences<B> teach(const Tensor<B, 2>& z, std::span<const Index> actions, const Sequences<B>& x,
                     const Context& context = {}) const {
    if (frames) return frames->teach(z, actions, x);
    return autoregressive_decoder ? autoregressive_decoder->teach(z, actions, x, context)
                                  : decode(z, actions, x.offsets, context);
  }
  /// Throws config_error 102 for a model without one latent for a whole motion. `what` needs it.
  void require_one_latent(const char* what) const {
    if (frames) raise<config_error>(102, what, ": the model has a latent for each frame, expected one for each motion");
  }
};

namespace detail {

/// Rows of noise for generate, in a single draw.
template <Backend B, class G>
Tensor<B, 2> actor_noise(const Actor<B>& actor, Index rows, G& rng) {
  const Shape shape{rows, actor.config.latent_dim};
  std::vector<typename B::scalar> noise(static_cast<std::size_t>(shape.count()));
  rng.normal(std::span<typename B::scalar>(noise));
  return Tensor<B, 2>::from(noise, shape);
}

}  // namespace detail

/// Motions in the order sample, action. durations: frames for each action, or for each motion.
/// rng     its normal values are taken in one draw; with TorchRandom they are those of the published program
/// Throws  shape_error 203 for an action that is not a class, 204 for another number of durations, config_error 101 for
///         invalid options, 102 for noise that is shared where each frame has a latent
template <Backend B, class G>
Sequences<B> generate(const Actor<B>& actor, std::span<const Index> actions, std::span<const Index> durations, G& rng,
                      const ActorSampling& o = {}) {
  const auto n = std::ssize(actions), given = std::ssize(durations);
  if (given != n && given != n * o.samples)
    raise<shape_error>(204, "generate: ", given, " durations for ", n, " actions and ", o.samples, " samples of each");
  std::vector<Index> labels, lengths;
  for (Index i = 0; i < n * o.samples; ++i) {
    labels.push_back(actions[static_cast<std::size_t>(i % n)]);
    lengths.push_back(durations[static_cast<std::size_t>(i % given)]);
  }
  const Offsets offsets(lengths);
  if (actor.frames) {
    if (o.samples < 1) raise<config_error>(101, "generate: ", o.samples, " samples, expected 1 or more");
    if (o.across_samples != NoiseSharing::random || o.across_actions != NoiseSharing::random)
      actor.require_one_latent("generate: shared noise");
    return actor.frames->generate(detail::actor_noise(actor, offsets.rows(), rng) * o.fact, labels, offsets);
  }
  const auto z = actor_latents(detail::actor_noise(actor, o.noise_rows(n), rng), n, o);
  return actor.decode(z, labels, offsets);
}

/// Encodes and decodes motions, which removes their noise. Source  thesis 3.3.4
template <Backend B>
Sequences<B> denoise(const Actor<B>& actor, const Sequences<B>& motions, std::span<const Index> actions) {
  return actor.decode(actor.encode(motions, actions).mu, actions, motions.offsets);
}

/// Motions between two of one action: `steps` latents on the line from one to the other, all of `length` frames.
/// Throws  config_error 102 for a model with a latent for each frame, and what interpolate_rows throws
template <Backend B>
Sequences<B> interpolate_motions(const Actor<B>& actor, const Sequences<B>& two_motions, Index action, Index steps,
                                 Index length) {
  actor.require_one_latent("interpolate_motions");
  const PoolVector<Index> both(2, action);
  const auto mu = actor.encode(two_motions, both).mu;
  const auto line = interpolate_rows(slice(mu, 0, 0, 1), slice(mu, 0, 1, 2), steps);
  return actor.decode(line, PoolVector<Index>(static_cast<std::size_t>(steps), action), Offsets::equal(steps, length));
}

/// Motions between two actions, from one latent. Its memory in the decoder changes in `steps` steps from one action to
/// the other. All have `length` frames. The first and the last are those of generate.
/// Throws  config_error 102 for a decoder that is not a transformer, because its frames read the number of the action.
///         What generate and interpolate_rows throw
template <Backend B, class G>
Sequences<B> interpolate_actions(const Actor<B>& actor, Index from, Index to, Index steps, Index length, G& rng) {
  if (!actor.decoder)
    raise<config_error>(102, "interpolate_actions: actions ", from, " and ", to,
                        ": only a transformer decoder interpolates between actions");
  const Index width = actor.config.latent_dim, both[] = {from, to};
  const auto z = broadcast_to<2>(detail::actor_noise(actor, 1, rng), {2, width});
  const auto ends = actor.decoder->memory(z, both).rows;
  const Index tokens = ends.size(0) / 2;  // of one memory
  const auto flat = reshape<2>(ends, {2, tokens * width});
  const auto line = interpolate_rows(slice(flat, 0, 0, 1), slice(flat, 0, 1, 2), steps);
  return (*actor.decoder)(Sequences<B>(reshape<2>(line, {steps * tokens, width}), Offsets::equal(steps, tokens)),
                          Offsets::equal(steps, length));
}

MOTIONLANG_NAMESPACE_END
