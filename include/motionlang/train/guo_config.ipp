// SPDX-License-Identifier: MIT
// Bodies of guo_config.hpp.
#pragma once

#include <motionlang/train/guo_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GuoTrainingConfig guo_preset(const std::string& name, GuoStage stage) {
  const bool movement = stage == GuoStage::movement;
  GuoTrainingConfig c;
  c.data.min_seconds = 0, c.data.max_seconds = 1000;  // the loader of Guo et al. has limits of its own
  if (name == "small") {
    c.movement.hidden = c.movement.latent = 128;
    c.matching = {.text_hidden = 128, .motion_hidden = 128, .embedding = 128, .word_width = 64};
    c.optimiser = {.lr = 5e-4,
                   .weight_decay = 0,
                   .clip_norm = movement ? 0 : 0.5,
                   .schedule = "cosine",
                   .warmup = 100,
                   .batch = movement ? 128 : 32,
                   .epochs = movement ? 10 : 60};
    c.validation.keep_best = !movement;
    c.data.mirror = true;
    return c;
  }
  if (name != "guo-published") raise<config_error>(103, "preset '", name, "' is not guo-published or small");
  c.optimiser = {.lr = 1e-4,
                 .weight_decay = 0,
                 .clip_norm = movement ? 0 : 0.5,
                 .batch = movement ? 128 : 8,
                 .epochs = movement ? 270 : 300};
  c.validation.keep_best = !movement;
  return c;
}

MOTIONLANG_NAMESPACE_END
