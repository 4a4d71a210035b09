// SPDX-License-Identifier: MIT
// Bodies of guo_evaluator_file.hpp.
#pragma once

#include <motionlang/weights/guo_evaluator_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GuoEvaluatorConfig guo_evaluator_config(const TensorSet& file) {
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

MOTIONLANG_NAMESPACE_END
