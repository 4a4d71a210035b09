// SPDX-License-Identifier: MIT
// Bodies of temos_training.hpp.
#pragma once

#include <motionlang/train/temos_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TemosLossOptions temos_loss_options(const TextMotionConfig& c) {
  const auto& l = c.losses;
  if (l.contrastive_loss != "none" || l.learned_temperature)
    raise<config_error>(102, "TEMOS has no contrastive loss; losses.contrastive_loss is '", l.contrastive_loss,
                        "', losses.learned_temperature ", l.learned_temperature);
  return {.recons = l.recons,
          .kl = l.kl,
          .latent = l.latent,
          .cross_modal_kl = l.cross_modal_kl,
          .gaussian_kl = l.gaussian_kl,
          .embedding = l.embedding};
}

MOTIONLANG_NAMESPACE_END
