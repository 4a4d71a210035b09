// SPDX-License-Identifier: MIT
// Bodies of tmr_training.hpp.
#pragma once

#include <motionlang/train/tmr_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TmrLossOptions tmr_loss_options(const TextMotionConfig& c) {
  const auto& l = c.losses;
  const auto kind = l.contrastive_loss == "info_nce" ? ContrastiveLoss::info_nce
                    : l.contrastive_loss == "margin" ? ContrastiveLoss::margin
                                                     : ContrastiveLoss::none;
  if (kind == ContrastiveLoss::none && l.contrastive_loss != "none")
    raise<config_error>(103, "losses.contrastive_loss '", l.contrastive_loss, "' is not info_nce, margin or none");
  if (l.learned_temperature && kind != ContrastiveLoss::info_nce)
    raise<config_error>(102, "losses.learned_temperature is for info_nce; losses.contrastive_loss is '",
                        l.contrastive_loss, "'");
  if (l.strangers > 0 && kind != ContrastiveLoss::info_nce)
    raise<config_error>(102, "losses.strangers is for info_nce; losses.contrastive_loss is '", l.contrastive_loss, "'");
  return {.recons = l.recons,
          .kl = l.kl,
          .latent = l.embedding ? l.latent : 0,
          .contrastive = l.contrastive,
          .contrastive_loss = kind,
          .temperature = l.temperature,
          .threshold = l.threshold,
          .margin = l.margin,
          .cross_modal_kl = l.cross_modal_kl,
          .gaussian_kl = l.gaussian_kl};
}

MOTIONLANG_NAMESPACE_END
