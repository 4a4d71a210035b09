// motionlang train-mdm-smpl: the denoiser that STMC composes.
#include "train_diffusion.hpp"

namespace program {

void add_train_mdm_smpl(CLI::App& app) {
  add_diffusion<ml::MdmSmplSystem>(
      app, "train-mdm-smpl",
      "Trains MDM-SMPL, the model of STMC, as published. Ctrl-C saves; the same command continues",
      {"mdm-smpl-published", "mdm-smpl-paper", "small"}, &ml::mdm_smpl_preset,
      "CLIP ViT-B/32 for text.encoder = clip: ViT-B-32.pt, the folder clip-vit-base-patch32, or the .npy file of an "
      "embedding cache");
}

}  // namespace program
