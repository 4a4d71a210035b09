// SPDX-License-Identifier: MIT
// Bodies of diffusion_training_config.hpp.
#pragma once

#include <motionlang/weights/diffusion_training_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline void require_clip_or_pieces(const DiffusionTextConfig& text) {
  if (text.encoder == "distilbert")
    raise<config_error>(102, "text.encoder = distilbert is for MDM with network.arch = trans_dec");
}
inline void require_guo_features(const std::string& features) {
  if (features != "guoh3d" && features != "kit")
    raise<config_error>(103, "features '", features, "' are not guoh3d or kit");
}

}  // namespace detail

MOTIONLANG_BODY void MdmSmplTrainingConfig::require_consistent() const {
  detail::require_clip_or_pieces(text);
  if (features != "smplrifke") raise<config_error>(103, "features '", features, "' are not smplrifke");
  if (diffusion.schedule == "linear")
    raise<config_error>(102, "diffusion.schedule = linear; that of MDM-SMPL is cosine or chen");
  require_value("items.longest", items.longest, items.longest >= items.shortest, "items.shortest or more");
}

MOTIONLANG_BODY void MdmTrainingConfig::require_consistent() const {
  detail::require_guo_features(features);
  if (text.encoder == "distilbert" && network.arch != "trans_dec") detail::require_clip_or_pieces(text);
  if (network.emb_trans_dec && network.arch != "trans_dec")
    raise<config_error>(102, "network.emb_trans_dec is for network.arch = trans_dec, not ", network.arch);
  if (network.mask_frames && network.arch == "gru")
    raise<config_error>(102, "network.mask_frames has no meaning for network.arch = gru");
  if (diffusion.schedule == "chen")
    raise<config_error>(102, "diffusion.schedule = chen; that of MDM is cosine or linear");
}

MOTIONLANG_BODY void MotionDiffuseTrainingConfig::require_consistent() const {
  detail::require_guo_features(features);
  detail::require_clip_or_pieces(text);
  require_value("text.drop", text.drop, text.drop == 0, "0: MotionDiffuse has no guidance");
  require_value("feat_bias", feat_bias, feat_bias > 0, "a number above 0");
  if (diffusion.schedule != "linear")
    raise<config_error>(102, "diffusion.schedule = ", diffusion.schedule, "; that of MotionDiffuse is linear");
}

MOTIONLANG_BODY void MdmActionTrainingConfig::require_consistent() const {
  if (clips.pose != "rot6d" || !clips.translation || !clips.global || !clips.camera)
    raise<config_error>(102,
                        "MDM's motions of actions have clips.pose = rot6d, clips.translation, clips.global and "
                        "clips.camera = true");
  if (clips.num_frames < 2)
    raise<config_error>(102, "clips.num_frames = ", clips.num_frames, "; MDM's motions have one length, 2 or more");
  if (network.mask_frames || network.emb_trans_dec)
    raise<config_error>(102, "network.mask_frames and network.emb_trans_dec are for texts");
  require_value("drop", drop, drop >= 0 && drop < 1, "0 or more, and less than 1");
  if (diffusion.schedule == "chen")
    raise<config_error>(102, "diffusion.schedule = chen; that of MDM is cosine or linear");
}

MOTIONLANG_NAMESPACE_END
