// SPDX-License-Identifier: MIT
/// TEACH and SINC from their published checkpoints: sizes come from the shapes of the tensors.
///
///     const auto teach = teach_network<B>(open_weights("last.ckpt"), find_run(folder));
///     const auto sinc = sinc_network<B>(open_weights("last.ckpt"));
///
/// Heads    from the options of the run, else 4, because shapes do not show them. The options ask for 6 under a
///          misspelled name, which the code ignores
/// Ignored  tables of positions, DistilBERT (textencoder.text_model.*), sums of losses, metrics, SINC's eval_model.*
/// Throws   as weights/text_motion_file.hpp
/// Source   TEACH teach/model/teach.py, SINC sinc/model/sinc.py: names of the modules; tensors of their checkpoints
#pragma once

#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/teach.hpp>
#include <motionlang/weights/text_motion_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool beside_teach_and_sinc(const std::string& name) {
  return beside_temos(name) || name.starts_with("eval_model.");
}

}  // namespace detail

/// hist_frames and z_prev_text come from the options of the run, else they are 5 and false, because shapes do not show
/// them.
template <Backend B>
Teach<B> teach_network(const TensorSet& file, const RunFolder& run = {}) {
  const detail::RunReader r(run, file, "");
  auto config = detail::temos_sizes<TeachConfig>(r);
  config.hist_frames = r.number({"model/hist_frames"}, config.hist_frames, 1024);
  config.z_prev_text = r.flag("model/z_prev_text", false);
  config.motion_encoder = r.has("motionencoder.mu_token");
  config.unused_encoder = r.has("textencoder.motionTransEncoder.layers.0.linear1.weight");
  const auto room = detail::room_of(file);
  NoInit zeros;
  Teach<B> model(config, zeros);
  detail::load_run_module(model, file, "", detail::beside_teach_and_sinc);
  return model;
}
/// `mode` is not visible in the tensors; released models take one sentence.
template <Backend B>
Sinc<B> sinc_network(const TensorSet& file, const RunFolder& run = {}, SincMode mode = SincMode::single) {
  const detail::RunReader r(run, file, "");
  auto config = detail::temos_sizes<SincConfig>(r);
  config.mode = mode;
  config.motion_encoder = r.has("motionencoder.mu_token");
  const auto room = detail::room_of(file);
  NoInit zeros;
  Sinc<B> model(config, zeros);
  detail::load_run_module(model, file, "", detail::beside_teach_and_sinc);
  return model;
}

MOTIONLANG_NAMESPACE_END
