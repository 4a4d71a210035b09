// ACTOR's networks in golden cases: built from the config, and the layouts of their tensors.
#pragma once

#include <motionlang/systems/actor.hpp>

#include "tensors.hpp"

namespace golden {

using ml::Index;

inline ml::ActorConfig actor_config(const Case& c) {
  const auto config = c.config();
  const auto width = config["latent_dim"].as<Index>();
  ml::ActorConfig out{.njoints = config["njoints"].as<Index>(),
                      .nfeats = config["nfeats"].as<Index>(),
                      .num_classes = config["num_classes"].as<Index>(),
                      .latent_dim = width,
                      .ff_size = config.value_or("ff_size", Index{1024}),
                      .num_layers = config["num_layers"].as<Index>(),
                      .num_heads = config.value_or("num_heads", Index{width % 4 == 0 ? 4 : 1}),
                      .activation = ml::parse_activation(config.value_or("activation", std::string("gelu"))),
                      .concatenate_time = config.value_or("concatenate_time", true)};
  const std::string ablation = config.contains("ablation") && !config["ablation"].is_null()
                                   ? config["ablation"].as<std::string>()
                                   : std::string();
  if (ablation == "average_encoder") out.encoder = ml::ActorEncoderKind::average;
  if (ablation == "zandtime") out.conditioning = ml::ActorConditioning::zandtime;
  if (ablation == "concat_bias") out.conditioning = ml::ActorConditioning::concat_bias;
  if (ablation == "time_encoding") out.conditioning = ml::ActorConditioning::time_encoding;
  return out;
}

/// A part of the case's model, filled from its weights.
template <class M>
M loaded(const Case& c, M part, const std::string& prefix = "weights/") {
  ml::load_module(part, c.file(), prefix);
  return part;
}

/// [batch, joints, features, frames] and its mask to the valid frames.
template <ml::Backend B>
ml::Sequences<B> motions(const Case& c, const std::string& name = "in/x") {
  const auto s = c.shape(name);
  const auto mask = c.values<unsigned char>("in/mask");
  return ml::from_padded(ml::reshape<3>(mdm_rows(tensor<B, 4>(c, name)), {s[0], s[3], s[1] * s[2]}),
                         std::span<const unsigned char>(mask));
}
/// Back to [batch, rows, numbers, frames], 0 behind the ends.
template <ml::Backend B>
ml::Tensor<B, 4> motion_layout(const ml::Sequences<B>& x, Index numbers, Index frames) {
  const auto padded = ml::to_padded(x, 0, frames);
  return ml::permute(ml::reshape<4>(padded, {x.count(), frames, x.width() / numbers, numbers}), {0, 2, 3, 1});
}
/// [time, batch, width] of packed rows, 0 behind the ends.
template <ml::Backend B>
ml::Tensor<B, 3> time_first(const ml::Sequences<B>& x, Index time) {
  return ml::permute(ml::to_padded(x, 0, time), {1, 0, 2});
}

inline ml::Offsets offsets_of(const Case& c) { return ml::Offsets(c.values<Index>("in/lengths")); }

}  // namespace golden
