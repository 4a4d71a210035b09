// motionlang train-mdm: MDM on texts.
#include "train_diffusion.hpp"

namespace program {

void add_train_mdm(CLI::App& app) {
  add_diffusion<ml::MdmSystem>(
      app, "train-mdm", "Trains MDM on texts, as published. Ctrl-C saves; the same command continues",
      {"mdm-published", "mdm-published-kit", "mdm50-published", "mdm50-published-bert", "small"}, &ml::mdm_preset,
      "CLIP ViT-B/32 for text.encoder = clip, or DistilBERT for distilbert: ViT-B-32.pt, a folder of Hugging Face, or "
      "the .npy file of an embedding cache");
}

}  // namespace program
