// SPDX-License-Identifier: MIT
// Bodies of actor_training.hpp.
#pragma once

#include <motionlang/train/actor_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void choose_points(ActorTrainingConfig& config, const ActorBodyFiles& files) {
  if (!files.body.empty() && config.losses.points == "joints") config.losses.points = "vertices";
}

MOTIONLANG_BODY std::string points_text(const ActorTrainingConfig& config, const ActorBodyFiles& files) {
  if (config.losses.rcxyz == 0 && config.losses.velxyz == 0) return "none: rotations alone are compared";
  if (!files.body.empty()) return config.losses.points + " of " + files.body.string();
  return "24 joints of our own skeleton, in place of the published vertices of SMPL, which need a body";
}

MOTIONLANG_BODY void require_body_files(const ActorTrainingConfig& config, const ActorBodyFiles& files) {
  const std::string& points = config.losses.points;
  if ((points != "joints") != !files.body.empty())
    raise<config_error>(102, "losses.points = ", points, ", and `body` is '", files.body.string(),
                        "': points of a body need one, joints have none");
  if (config.losses.vertstrans && files.body.empty())
    raise<config_error>(102, "losses.vertstrans is for points of a body; joints follow the path anyway");
  if (!files.body.empty() && config.clips.is_xyz())
    raise<config_error>(102, "losses.points = ", points, " are made of rotations; clips.pose is xyz");
  if (files.body.empty() && !files.regressor.empty())
    raise<config_error>(102, "losses.points = joints has no use for `regressor` ", files.regressor.string());
}

MOTIONLANG_NAMESPACE_END
