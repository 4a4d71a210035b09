// motionlang train-motiondiffuse.
#include "train_diffusion.hpp"

namespace program {

void add_train_motiondiffuse(CLI::App& app) {
  add_diffusion<ml::MotionDiffuseSystem>(
      app, "train-motiondiffuse", "Trains MotionDiffuse, as published. Ctrl-C saves; the same command continues",
      {"motiondiffuse-published", "motiondiffuse-paper", "small"}, &ml::motiondiffuse_preset,
      "CLIP ViT-B/32 for text.encoder = clip: ViT-B-32.pt, or the folder clip-vit-base-patch32. All states of each "
      "text "
      "are computed at each step");
}

}  // namespace program
