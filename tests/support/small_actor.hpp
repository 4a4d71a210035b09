// SPDX-License-Identifier: MIT
/// Small models of ACTOR with every network, and motions for them.
#pragma once

#include <motionlang/backend/eigen.hpp>
#include <motionlang/systems/actor.hpp>

#include "tensors.hpp"

namespace small_actor {

namespace ml = motionlang;
using ml::ActorConditioning, ml::ActorConfig, ml::ActorDecoderKind, ml::ActorEncoderKind, ml::Index, ml::Offsets;
using B = ml::EigenBackend<float>;

inline ActorConfig small() {
  return {.njoints = 3, .num_classes = 4, .latent_dim = 16, .ff_size = 24, .num_layers = 2, .num_frames = 5};
}
inline ml::Actor<B> model_of(const ActorConfig& config) {
  ml::Philox rng{.seed = 1};
  return {config, rng};
}
inline ml::Sequences<B> motions(std::initializer_list<Index> lengths) {
  const Offsets offsets(lengths);
  return {tensors::normal<B, 2>({offsets.rows(), 18}, 2), offsets};
}

/// All variants of the thesis' table 3.4, and mixtures of their encoders and decoders.
inline std::vector<ActorConfig> variants() {
  std::vector<ActorConfig> out;
  auto add = [&](ActorEncoderKind encoder, ActorDecoderKind decoder,
                 ActorConditioning conditioning = ActorConditioning::action_bias, bool time = true) {
    ActorConfig c = small();
    c.encoder = encoder, c.decoder = decoder, c.conditioning = conditioning, c.concatenate_time = time;
    out.push_back(c);
  };
  add(ActorEncoderKind::tokens, ActorDecoderKind::transformer);
  add(ActorEncoderKind::tokens, ActorDecoderKind::transformer, ActorConditioning::concat_bias);
  add(ActorEncoderKind::tokens, ActorDecoderKind::transformer, ActorConditioning::zandtime);
  add(ActorEncoderKind::tokens, ActorDecoderKind::transformer, ActorConditioning::time_encoding);
  add(ActorEncoderKind::average, ActorDecoderKind::transformer);
  add(ActorEncoderKind::gru, ActorDecoderKind::gru);
  add(ActorEncoderKind::gru, ActorDecoderKind::gru, ActorConditioning::action_bias, false);
  add(ActorEncoderKind::tokens, ActorDecoderKind::gru);
  add(ActorEncoderKind::gru, ActorDecoderKind::transformer);
  add(ActorEncoderKind::fully_connected, ActorDecoderKind::fully_connected);
  add(ActorEncoderKind::tokens, ActorDecoderKind::autoregressive);
  return out;
}

}  // namespace small_actor
