// SPDX-License-Identifier: MIT
// Bodies of text_motion_file.hpp.
#pragma once

#include <motionlang/weights/text_motion_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY TemosConfig temos_config(const RunReader& r) {
  auto network = [&](const std::string& module, const char* transformer) {
    if (r.has(module + ".gru.weight_ih_l0")) return TemosNetwork::gru;
    return r.has(module + transformer) ? TemosNetwork::transformer : TemosNetwork::none;
  };
  auto c = temos_sizes<TemosConfig>(r);
  c.vae = r.has("textencoder.mu_token");
  c.motion_encoder = network("motionencoder", ".skel_embedding.weight");
  c.motion_decoder = network("motiondecoder", ".final_layer.weight");
  return c;
}

MOTIONLANG_BODY TmrConfig tmr_config(const RunReader& r) {
  const std::string stack = "motion_encoder.seqTransEncoder.layers.";
  return {.motion_nfeats = r.size("motion_encoder.projection.weight", 1, {"model/motion_encoder/nfeats"}),
          .text_nfeats = r.size("text_encoder.projection.weight", 1, {"model/text_encoder/nfeats"}),
          .latent_dim = r.size("motion_encoder.projection.weight", 0, {"model/motion_encoder/latent_dim"}),
          .ff_size = r.size(stack + "0.linear1.weight", 0, {"model/motion_encoder/ff_size"}),
          .num_layers = r.count(stack, ".linear1.weight", {"model/motion_encoder/num_layers"}),
          .num_heads = r.number({"model/motion_encoder/num_heads"}, 4, 1024),
          .activation = parse_activation(r.one_of("model/motion_encoder/activation", "gelu", {"gelu", "relu"})),
          .vae = r.size("motion_encoder.tokens", 0) == 2};
}

MOTIONLANG_BODY bool beside_temos(const std::string& name) {
  return name.ends_with("sequence_pos_encoding.pe") ||
         begins_with_any(name, {"textencoder.text_model.", "_losses.", "metrics.", "losses.", "motion_normalizer."});
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
