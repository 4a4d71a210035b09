// SPDX-License-Identifier: MIT
// Bodies of mdm_action_training.hpp.
#pragma once

#include <motionlang/train/mdm_action_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY MdmConfig network_sizes(const MdmActionTrainingConfig& c, Index actions) {
  const auto& n = c.network;
  MdmConfig out;
  out.nfeats = c.clips.width();
  out.arch = parse_mdm_arch(n.arch);
  out.condition = c.unconstrained ? MdmCondition::none : MdmCondition::action;
  out.num_actions = c.unconstrained ? 1 : actions;
  out.latent_dim = n.latent_dim, out.ff_size = n.ff_size;
  out.num_layers = n.num_layers, out.num_heads = n.num_heads;
  out.dropout = n.dropout;
  out.crop_frames = c.clips.num_frames;
  out.max_len = std::max({out.max_len, c.diffusion.steps, c.clips.num_frames + 1});
  return out;
}

MOTIONLANG_BODY ModelFolder described_mdm_actions(const MdmActionTrainingConfig& c, const MdmConfig& sizes,
                                                  const std::vector<std::string>& labels,
                                                  const std::map<std::string, std::string>& about) {
  DiffusionRun run;
  run.system = "mdm", run.text_encoder = "none";
  run.mdm = sizes;
  run.steps = c.diffusion.steps, run.schedule = c.diffusion.schedule;
  run.features = "actor", run.fps = c.clips.fps;
  ModelFolder out = described_diffusion("mdm", run, about);
  out.config["unconstrained"] = c.unconstrained;
  out.config["cond_mask_prob"] = c.drop;
  out.config["num_actions"] = sizes.num_actions;
  out.config["num_frames"] = sizes.crop_frames;
  out.config["fps"] = c.clips.fps;
  if (!c.unconstrained) out.config["labels"] = labels;
  out.others["training"] = config_json(c);
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
