// SPDX-License-Identifier: MIT
// Bodies of diffusion_presets.hpp.
#pragma once

#include <motionlang/train/diffusion_presets.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The text encoder and the training of every small model.
template <class Config>
void make_small(Config& c) {
  c.text.encoder = "word_pieces";
  c.text.vocabulary = 400;
  c.optimiser.lr = 5e-4, c.optimiser.clip_norm = 1, c.optimiser.ema = 0.999;
  c.optimiser.schedule = "cosine", c.optimiser.warmup = 100;
  c.optimiser.batch = 16, c.optimiser.epochs = 60;
  c.updates = 0;
  c.validation = {.every = 5};
  c.data.mirror = true;
}

}  // namespace detail

MOTIONLANG_BODY MdmSmplTrainingConfig mdm_smpl_preset(const std::string& name) {
  MdmSmplTrainingConfig c;
  c.optimiser.batch = 128, c.optimiser.epochs = 10'000;
  if (name == "mdm-smpl-published") return c;
  if (name == "mdm-smpl-paper") {
    c.network.ff_size = 1024, c.network.num_heads = 4;
    c.diffusion.schedule = "chen";
    return c;
  }
  if (name != "small")
    raise<config_error>(103, "preset '", name, "' is not mdm-smpl-published, mdm-smpl-paper or small");
  detail::make_small(c);
  c.network.latent_dim = 128, c.network.ff_size = 384, c.network.num_layers = 4, c.network.num_heads = 4;
  c.network.dropout = 0.05;
  return c;
}

MOTIONLANG_BODY MdmTrainingConfig mdm_preset(const std::string& name) {
  MdmTrainingConfig c;
  c.diffusion.steps = 1000;
  c.updates = 600'000;
  c.optimiser.weight_decay = 0, c.optimiser.batch = 64, c.optimiser.seed = 10;
  c.validation.every = 0;
  if (name == "mdm-published") return c;
  if (name == "mdm-published-kit") {
    c.features = "kit";
    return c;
  }
  c.diffusion.steps = 50;
  c.network.mask_frames = true;
  if (name == "small") {
    detail::make_small(c);
    c.ema_warmup = true;
    c.network.latent_dim = 128, c.network.ff_size = 256, c.network.num_layers = 4;
    c.network.dropout = 0.05;
    return c;
  }
  c.optimiser.ema = 0.9999;
  if (name == "mdm50-published") return c;
  if (name == "mdm50-published-bert") {
    c.network.arch = "trans_dec", c.text.encoder = "distilbert";
    return c;
  }
  raise<config_error>(103, "preset '", name,
                      "' is not mdm-published, mdm-published-kit, mdm50-published, mdm50-published-bert or small");
}

MOTIONLANG_BODY MotionDiffuseTrainingConfig motiondiffuse_preset(const std::string& name) {
  MotionDiffuseTrainingConfig c;
  c.diffusion = {.steps = 1000, .schedule = "linear"};
  c.text.drop = 0;
  c.optimiser.lr = 2e-4, c.optimiser.weight_decay = 0, c.optimiser.clip_norm = 0.5;
  c.optimiser.batch = 128, c.optimiser.epochs = 50 * 25;
  c.validation.every = 0;
  if (name == "motiondiffuse-published") return c;
  if (name == "motiondiffuse-paper") {
    c.optimiser.batch = 1024, c.optimiser.epochs = 50 * 200;
    return c;
  }
  if (name != "small")
    raise<config_error>(103, "preset '", name, "' is not motiondiffuse-published, motiondiffuse-paper or small");
  detail::make_small(c);
  c.diffusion.steps = 100;
  c.feat_bias = 5;
  c.network = {.latent_dim = 128,
               .ff_size = 256,
               .num_layers = 4,
               .num_heads = 4,
               .text_latent_dim = 64,
               .text_ff_size = 128,
               .num_text_layers = 1,
               .text_num_heads = 4};
  return c;
}

MOTIONLANG_BODY MdmActionTrainingConfig mdm_action_preset(const std::string& name) {
  MdmActionTrainingConfig c;
  c.clips.camera = true;
  c.diffusion.steps = 1000;
  c.updates = 600'000;
  c.optimiser.weight_decay = 0, c.optimiser.batch = 64, c.optimiser.seed = 10;
  c.validation.every = 0;
  c.data = {.min_seconds = 0.2, .max_seconds = 1000};
  if (name == "mdm-actions-published") return c;
  if (name != "small") raise<config_error>(103, "preset '", name, "' is not mdm-actions-published or small");
  c.clips.fps = 15;
  c.diffusion.steps = 50;
  c.network.latent_dim = 128, c.network.ff_size = 256, c.network.num_layers = 4;
  c.updates = 0;
  c.optimiser.lr = 5e-4, c.optimiser.clip_norm = 1, c.optimiser.ema = 0.999;
  c.optimiser.schedule = "cosine", c.optimiser.warmup = 100, c.optimiser.batch = 20, c.optimiser.epochs = 60;
  c.validation.every = 5;
  return c;
}

MOTIONLANG_NAMESPACE_END
