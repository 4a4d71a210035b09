// SPDX-License-Identifier: MIT
/// TEMOS and TMR from their published checkpoints: sizes come from the shapes of the tensors.
///
///     const auto tmr = tmr_network<B>(open_weights(folder), find_run(folder));   // last_weights/*.pt, or a .ckpt
///     const auto temos = temos_network<B>(open_weights("last.ckpt"));    // with statistics: weights/vae_run.hpp
///
/// Heads    from the options of the run, else 4 as in both papers' models, because shapes do not show them. TEMOS'
///          options ask for 6 under a misspelled name, which its code ignores
/// Ignored  tables of positions, DistilBERT (textencoder.text_model.*), sums of losses and metrics, statistics
/// Throws   io_error 406, 407 if names or shapes do not match; numeric_error 301 for NaN and infinity; config_error 101
///          if the heads do not divide the width, 102 if options and tensors differ, or if the file is too small for a
///          network of its sizes
/// Source   TEMOS temos/model/temos.py, TMR src/model/temos.py and src/model/tmr.py: names of the modules
#pragma once

#include <motionlang/systems/temos.hpp>
#include <motionlang/systems/tmr.hpp>
#include <motionlang/weights/detail/run_reader.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The common part of the configurations of TEMOS, TEACH and SINC.
template <class Config>
Config temos_sizes(const RunReader& r) {
  const std::string stack = "textencoder.seqTransEncoder.layers.";
  Config c;
  c.nfeats = r.size("motiondecoder.final_layer.weight", 0);
  c.text_dim = r.size("textencoder.projection.1.weight", 1);
  c.latent_dim = r.size("textencoder.projection.1.weight", 0, {"model/latent_dim"});
  c.ff_size = r.size(stack + "0.linear1.weight", 0, {"model/ff_size"});
  c.num_layers = r.count(stack, ".linear1.weight", {"model/num_layers"});
  c.num_heads = r.number({"model/num_heads"}, 4, 1024);
  c.activation = parse_activation(r.one_of("model/activation", "gelu", {"gelu", "relu"}));
  return c;
}
TemosConfig temos_config(const RunReader& r);

TmrConfig tmr_config(const RunReader& r);

/// True for tensors of a checkpoint that are not the model's.
bool beside_temos(const std::string& name);

}  // namespace detail

/// `run` holds the options, if there are any.
template <Backend B>
Temos<B> temos_network(const TensorSet& file, const RunFolder& run = {}) {
  const TemosConfig config = detail::temos_config(detail::RunReader(run, file, ""));
  const auto room = detail::room_of(file);
  NoInit zeros;
  Temos<B> model(config, zeros);
  detail::load_run_module(model, file, "", detail::beside_temos);
  return model;
}
template <Backend B>
Tmr<B> tmr_network(const TensorSet& file, const RunFolder& run = {}) {
  const TmrConfig config = detail::tmr_config(detail::RunReader(run, file, ""));
  const auto room = detail::room_of(file);
  NoInit zeros;
  Tmr<B> model(config, zeros);
  detail::load_run_module(model, file, "", [](const std::string& name) {
    return name.ends_with(".pe") || detail::begins_with_any(name, {"stats.", "meta."});
  });
  return model;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/text_motion_file.ipp>
#endif
