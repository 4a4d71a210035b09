// SPDX-License-Identifier: MIT
/// The published checkpoint of Guo's evaluator.
///
///     const auto evaluator = load_guo_evaluator<B>(open_weights("text_mot_match/model/finest.tar", {.path = ""}));
///
/// Source  Guo et al. (CVPR 2022), networks/evaluator_wrapper.py; spec evaluation-guo.md 2
#pragma once

#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/weights/detail/run_reader.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes of the networks in a file, from the shapes of its tensors. Throws io_error 406, 407.
inline GuoEvaluatorConfig guo_evaluator_config(const TensorSet& file) {
  const RunFolder no_options{};
  const detail::RunReader t(no_options, file, "");
  const std::string movement = "movement_encoder.main.", text = "text_encoder.";
  return {.features = t.size(movement + "0.weight", 1) + 4,
          .movement_hidden = t.size(movement + "0.weight", 0),
          .movement_latent = t.size(movement + "3.weight", 0),
          .word = t.size(text + "pos_emb.weight", 0),
          .pos = t.size(text + "pos_emb.weight", 1),
          .text_hidden = t.size(text + "hidden", 2),
          .motion_hidden = t.size("motion_encoder.hidden", 2),
          .embedding = t.size(text + "output_net.3.weight", 0)};
}

/// The networks, ready to run. States of optimisers beside them are passed over. Throws io_error 406, 407,
/// numeric_error 301.
template <Backend B>
GuoEvaluator<B> load_guo_evaluator(const TensorSet& file) {
  const auto room = detail::room_of(file);
  NoInit zeros;
  GuoEvaluator<B> networks(guo_evaluator_config(file), zeros);
  detail::load_run_module(networks, file, "", [](const std::string& name) { return name.starts_with("opt_"); });
  prepare(networks);
  return networks;
}

MOTIONLANG_NAMESPACE_END
