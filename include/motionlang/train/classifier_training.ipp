// SPDX-License-Identifier: MIT
// Bodies of classifier_training.hpp.
#pragma once

#include <motionlang/train/classifier_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void require_generated_settings(const ClassifierConfig& config, bool generated) {
  const double share = config.generated_share;
  const std::string& kind = config.generated_kind;
  if (share < 0 || share > 1) raise<config_error>(101, "generated_share ", share, " is not in [0, 1]");
  if ((share > 0) != generated)
    raise<config_error>(102, "generated_share = ", share, ", and `generated` is ", generated ? "given" : "not given",
                        ": one needs the other");
  if (kind != "sampled" && kind != "denoised" && kind != "interpolated")
    raise<config_error>(103, "generated_kind '", kind, "' is not sampled, denoised or interpolated");
}

MOTIONLANG_BODY ActorClipsConfig clips_for_generator(const ClassifierConfig& config,
                                                     const ActorClipsConfig& generator) {
  ActorClipsConfig clips = config.clips;
  require_same_clips(generator, clips);
  if (config.generated_kind != "sampled") {
    clips.pose = generator.pose;
    clips.translation = generator.translation;
    clips.global = generator.global;
    clips.camera = generator.camera;
  }
  return clips;
}

MOTIONLANG_NAMESPACE_END
