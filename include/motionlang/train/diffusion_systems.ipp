// SPDX-License-Identifier: MIT
// Bodies of diffusion_systems.hpp.
#pragma once

#include <motionlang/train/diffusion_systems.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY MdmArch parse_mdm_arch(const std::string& name) {
  if (name == "trans_enc") return MdmArch::trans_enc;
  if (name == "trans_dec") return MdmArch::trans_dec;
  if (name == "gru") return MdmArch::gru;
  raise<config_error>(103, "network.arch = ", name, "; there are trans_enc, trans_dec and gru");
}

MOTIONLANG_BODY MdmSmplConfig network_sizes(const MdmSmplTrainingConfig& c, Index width, Index text_width) {
  const auto& n = c.network;
  MdmSmplConfig out;
  out.nfeats = width, out.tx_dim = text_width;
  out.latent_dim = n.latent_dim, out.ff_size = n.ff_size;
  out.num_layers = n.num_layers, out.num_heads = n.num_heads;
  out.nb_registers = n.nb_registers, out.dropout = n.dropout;
  out.max_len = std::max(out.max_len, c.diffusion.steps);
  return out;
}

MOTIONLANG_BODY MdmConfig network_sizes(const MdmTrainingConfig& c, Index width, Index text_width) {
  const auto& n = c.network;
  MdmConfig out;
  out.nfeats = width, out.text_dim = text_width;
  out.arch = parse_mdm_arch(n.arch);
  out.text_sequence = MdmSystem::states(c);
  if (n.emb_trans_dec) out.class_token = out.text_sequence ? MdmClassToken::time_only : MdmClassToken::time_plus_text;
  out.latent_dim = n.latent_dim, out.ff_size = n.ff_size;
  out.num_layers = n.num_layers, out.num_heads = n.num_heads;
  out.dropout = n.dropout, out.mask_frames = n.mask_frames;
  out.max_len = std::max(out.max_len, c.diffusion.steps);
  return out;
}

MOTIONLANG_BODY MotionDiffuseConfig network_sizes(const MotionDiffuseTrainingConfig& c, Index width, Index text_width) {
  const auto& n = c.network;
  MotionDiffuseConfig out;
  out.input_feats = width, out.clip_dim = text_width;
  out.num_frames = MotionDiffuseSystem::longest;
  out.latent_dim = n.latent_dim, out.ff_size = n.ff_size;
  out.num_layers = n.num_layers, out.num_heads = n.num_heads;
  out.text_latent_dim = n.text_latent_dim, out.text_ff_size = n.text_ff_size;
  out.num_text_layers = n.num_text_layers, out.text_num_heads = n.text_num_heads;
  out.no_eff = n.no_eff;
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
