// SPDX-License-Identifier: MIT
/// TEMOS and TMR from their published checkpoints: sizes come from the shapes of the tensors.
///
///     const auto temos = load_temos<B>(open_weights("kit-mmm-xyz/3l49g7hv"));            // io/weight_file.hpp: a run folder
///     const auto tmr = load_tmr<B>(open_weights("models/tmr_humanml3d_guoh3dfeats"));    // or a .ckpt, or .safetensors
///     const auto states = load_text_network<DistilBert<B>>(config, temos_file);          // TEMOS' checkpoints hold DistilBERT
///
/// Heads    do not show in shapes. 4 is what both papers' models have; TEMOS' configurations ask for 6 under a misspelled name
/// Ignored  tables of positions, DistilBERT (textencoder.text_model.*), sums of losses (_losses.*)
/// Throws   io_error 406, 407 if names or shapes do not match; numeric_error 301 for a number that is none; config_error 101 if the
///          heads do not divide the width
/// Source   spec temos.md 3.1, tmr.md 3.1
#pragma once

#include <motionlang/io/detail/shape_reader.hpp>
#include <motionlang/systems/temos.hpp>
#include <motionlang/systems/tmr.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

inline TemosConfig temos_config_of(const TensorSet& file, Index heads = 4) {
  const detail::ShapeReader shapes(file);
  auto network = [&](const std::string& module, const char* transformer) {
    if (shapes.has(module + ".gru.weight_ih_l0")) return TemosNetwork::gru;
    return shapes.has(module + transformer) ? TemosNetwork::transformer : TemosNetwork::none;
  };
  const std::string stack = "textencoder.seqTransEncoder";
  return {.nfeats = shapes.size("motiondecoder.final_layer.weight", 0),
          .text_dim = shapes.size("textencoder.projection.1.weight", 1),
          .latent_dim = shapes.size("textencoder.projection.1.weight", 0),
          .ff_size = shapes.size(stack + ".layers.0.linear1.weight", 0),
          .num_layers = shapes.layers(stack),
          .num_heads = heads,
          .vae = shapes.has("textencoder.mu_token"),
          .motion_encoder = network("motionencoder", ".skel_embedding.weight"),
          .motion_decoder = network("motiondecoder", ".final_layer.weight")};
}

template <Backend B>
Temos<B> load_temos(const TensorSet& file, Index heads = 4) {
  NoInit zeros;
  Temos<B> model(temos_config_of(file, heads), zeros);
  detail::load_with_company(model, file, [](const std::string& name) {
    return name.ends_with("sequence_pos_encoding.pe") || name.starts_with("textencoder.text_model.") ||
           name.starts_with("_losses.");
  });
  return model;
}

inline TmrConfig tmr_config_of(const TensorSet& file, Index heads = 4) {
  const detail::ShapeReader shapes(file);
  const std::string stack = "motion_encoder.seqTransEncoder";
  return {.motion_nfeats = shapes.size("motion_encoder.projection.weight", 1),
          .text_nfeats = shapes.size("text_encoder.projection.weight", 1),
          .latent_dim = shapes.size("motion_encoder.projection.weight", 0),
          .ff_size = shapes.size(stack + ".layers.0.linear1.weight", 0),
          .num_layers = shapes.layers(stack),
          .num_heads = heads,
          .vae = shapes.size("motion_encoder.tokens", 0) == 2};
}

template <Backend B>
Tmr<B> load_tmr(const TensorSet& file, Index heads = 4) {
  NoInit zeros;
  Tmr<B> model(tmr_config_of(file, heads), zeros);
  detail::load_with_company(model, file, [](const std::string& name) { return name.ends_with(".pe"); });
  return model;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
