// SPDX-License-Identifier: MIT
// Bodies of presets.hpp.
#pragma once

#include <cmath>  // sqrt

#include <motionlang/train/presets.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline TextMotionConfig small_text_motion() {
  TextMotionConfig c;
  c.network = {.latent_dim = 128, .ff_size = 256, .num_layers = 2};
  c.text = {.encoder = "word_pieces", .width = 128, .vocabulary = 400};
  c.optimiser = {.lr = 5e-4, .clip_norm = 1, .schedule = "cosine", .warmup = 100, .epochs = 60};
  c.validation = {.every = 2, .keep_best = true};
  c.data.mirror = true;
  return c;
}

/// The sizes and the rates of the small TMR and TEMOS.
template <class Config>
Config small_babel() {
  const TextMotionConfig small = small_text_motion();
  Config c;
  c.features = "smplvelp";
  c.network.latent_dim = small.network.latent_dim, c.network.ff_size = small.network.ff_size;
  c.network.num_layers = small.network.num_layers;
  c.text = small.text, c.optimiser = small.optimiser, c.validation = small.validation;
  return c;
}

}  // namespace detail

MOTIONLANG_BODY TextMotionConfig tmr_preset(const std::string& name) {
  TextMotionConfig c;
  if (name == "small") {
    c = detail::small_text_motion();
    c.validation.watch = "retrieval";
    return c;
  }
  if (name == "tmr-published") return c;
  raise<config_error>(103, "preset '", name, "' is not tmr-published or small");
}

MOTIONLANG_BODY TextMotionConfig temos_preset(const std::string& name) {
  TextMotionConfig c;
  if (name == "small")
    c = detail::small_text_motion();
  else if (name != "temos-published")
    raise<config_error>(103, "preset '", name, "' is not temos-published or small");
  c.features = name == "small" ? "smplvelp" : "rifke64";
  c.losses.contrastive_loss = "none";
  if (name != "small") {
    c.optimiser.epochs = 1001;
    c.data.min_seconds = 0.8, c.data.max_seconds = 40;  // 10 to 500 frames
  }
  return c;
}

MOTIONLANG_BODY SincTrainingConfig sinc_preset(const std::string& name) {
  auto c = detail::small_babel<SincTrainingConfig>();
  c.data.proportion = 0;
  if (name == "small") return c;
  if (name != "sinc-published" && name != "sinc-paper")
    raise<config_error>(103, "preset '", name, "' is not sinc-published, sinc-paper or small");
  c = {};
  c.optimiser.lr = 3e-4, c.optimiser.schedule = "step", c.optimiser.epochs = 1001, c.optimiser.seed = 42;
  c.validation.every = 25;
  if (name == "sinc-paper") {
    c.optimiser.schedule = "constant", c.optimiser.batch = 64, c.optimiser.epochs = 500;
    c.losses = {.recons = 1, .kl = 1, .latent = 1};
    c.data.longest = 600, c.data.shuffle = true;
  }
  return c;
}

MOTIONLANG_BODY TeachTrainingConfig teach_preset(const std::string& name) {
  if (name == "small") return detail::small_babel<TeachTrainingConfig>();
  if (name != "teach-published" && name != "teach-paper")
    raise<config_error>(103, "preset '", name, "' is not teach-published, teach-paper or small");
  TeachTrainingConfig c;
  c.optimiser.lr = 7e-5, c.optimiser.batch = 8, c.optimiser.epochs = 1001, c.optimiser.seed = 42;
  if (name == "teach-paper") {
    c.optimiser.lr = 1e-4, c.optimiser.batch = 32;
    c.network.mask_padding = true;
  }
  return c;
}

MOTIONLANG_BODY ActorTrainingConfig actor_preset(const std::string& name) {
  ActorTrainingConfig c;
  c.optimiser.batch = 20, c.optimiser.epochs = 5000, c.optimiser.seed = 10;
  c.validation.every = 0;
  c.data = {.min_seconds = 0.2, .max_seconds = 1000};
  if (name == "actor-published") return c;
  if (name == "actor-published-ntu13") {
    c.optimiser.epochs = 2000;
    return c;
  }
  if (name == "actor-published-uestc") {
    c.optimiser.epochs = 1000;
    c.data.min_seconds = 45 / c.clips.fps;
    return c;
  }
  if (name == "actor-variable") {
    c.clips.num_frames = -2;
    c.optimiser.epochs = 100;
    return c;
  }
  if (name != "small")
    raise<config_error>(103, "preset '", name,
                        "' is not actor-published, actor-published-ntu13, actor-published-uestc, actor-variable or "
                        "small");
  c.clips.fps = 15;
  c.network = {.latent_dim = 128, .ff_size = 256, .num_layers = 3};
  c.optimiser = {
      .lr = 5e-4, .clip_norm = 1, .schedule = "cosine", .warmup = 100, .batch = 20, .epochs = 60, .seed = 10};
  c.validation = {.every = 2};
  return c;
}

MOTIONLANG_BODY ClassifierConfig classifier_preset(const std::string& name) {
  ClassifierConfig c;
  c.optimiser.batch = 64, c.optimiser.epochs = 100;
  c.data = {.min_seconds = 0.2, .max_seconds = 1000};
  if (name == "stgcn-published") {
    c.kind = "stgcn";
    c.clips.translation = false;
    return c;
  }
  if (name == "gru-published") {
    c.drawn_state = true;
    return c;
  }
  if (name != "small") raise<config_error>(103, "preset '", name, "' is not stgcn-published, gru-published or small");
  c.clips.fps = 15;
  c.optimiser.lr = 1e-3, c.optimiser.clip_norm = 1, c.optimiser.schedule = "cosine";
  c.validation.keep_best = true;
  return c;
}

MOTIONLANG_BODY Tm2tTrainingConfig tm2t_preset(const std::string& name, Tm2tStage stage) {
  Tm2tTrainingConfig c;
  const bool tokenizer = stage == Tm2tStage::tokenizer;
  c.validation.keep_best = true;
  if (name == "small") {
    c.tokenizer = {.channels = {128, 128}, .codes = 128, .residual_blocks = 2, .adversarial = 0, .discriminator = 64};
    c.motion_to_text = {.latent_dim = 128, .ff_size = 256, .num_layers = 2, .num_heads = 4};
    c.text_to_motion = {.latent_dim = 128,
                        .ff_size = 256,
                        .num_layers = 2,
                        .num_heads = 4,
                        .text_hidden = 64,
                        .motion_hidden = 128,
                        .word_width = 64};
    c.optimiser = {.lr = 5e-4,
                   .weight_decay = 0,
                   .clip_norm = 1,
                   .schedule = "cosine",
                   .warmup = 100,
                   .epochs = tokenizer ? 10 : 60};
    c.data.mirror = true;
    return c;
  }
  if (name != "tm2t-published" && name != "tm2t-published-kit" && name != "tm2t-paper")
    raise<config_error>(103, "preset '", name, "' is not tm2t-published, tm2t-published-kit, tm2t-paper or small");
  c.optimiser = {.lr = tokenizer ? 1e-4 : 2e-4, .weight_decay = 0, .batch = tokenizer ? 128 : 64, .epochs = 300};
  if (stage == Tm2tStage::text_to_motion) c.optimiser.clip_norm = 0.5;
  if (name == "tm2t-published-kit") {
    c.features = "kit";
    c.motion_to_text.num_layers = 3;
  }
  if (name == "tm2t-paper") {
    c.optimiser.lr = 2e-4;
    c.tokenizer.adversarial = 0;
    c.tokenizer.feature_bias = std::sqrt(5);  // it divides twice
    c.text_to_motion.forced_first = c.text_to_motion.forced_last = 0.4;
  }
  return c;
}

MOTIONLANG_NAMESPACE_END
