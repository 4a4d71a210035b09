// SPDX-License-Identifier: MIT
/// Run folders of ACTOR, TEMOS, TEACH and SINC as their repositories leave them, with drawn weights.
#pragma once

#include <motionlang/weights/vae_run.hpp>

#include "official_folders.hpp"

namespace official {

/// Every value of a module, in the order of its tensors.
template <class M>
std::vector<float> all_numbers(const M& model) {
  std::vector<float> out;
  ml::visit_tensors(
      model, [&](const std::string&, const auto& t) { out.insert(out.end(), t.span().begin(), t.span().end()); });
  return out;
}

inline ml::ActorConfig small_actor() { return {.latent_dim = 16, .ff_size = 24, .num_layers = 2}; }
inline ml::Actor<B> actor(const ml::ActorConfig& c) {
  ml::Philox rng{.seed = 51};
  return {c, rng};
}
/// opt.yaml and two checkpoints, of which the second counts.
inline void write_actor_run(const fs::path& folder, const ml::ActorConfig& c, const std::string& extra = "",
                            const std::string& pose = "rot6d") {
  write_text(
      folder / "opt.yaml",
      ml::concat_text(
          "activation: gelu\narchiname: transformer\nbatch_size: 20\ndataset: humanact12\nglob: true\nglob_rot:\n"
          "- 3.141592653589793\n- 0\n- 0\njointstype: vertices\nlambdas:\n  kl: 1.0e-05\nlatent_dim: ",
          c.latent_dim, "\nlosses:\n- rc\n- kl\nmodeltype: cvae\nnum_frames: 60\nnum_layers: ", c.num_layers,
          "\npose_rep: ", pose, "\ntranslation: true\n"));
  TorchArchive older, archive;
  add_zeros(older, "nothing", {1});
  write_bytes(folder / "checkpoint_0900.pth.tar", older.finish());
  add_module(archive, actor(c));
  add_zeros(archive, "encoder.sequence_pos_encoder.pe", {5, 1, c.latent_dim});
  add_zeros(archive, "decoder.sequence_pos_encoder.pe", {5, 1, c.latent_dim});
  if (!extra.empty()) add_zeros(archive, extra, {1});
  write_bytes(folder / "checkpoint_5000.pth.tar", archive.finish());
}

inline const char* bert_vocabulary = "[PAD]\n[UNK]\n[CLS]\n[SEP]\n[MASK]\na\nwalk\n";
inline ml::TemosConfig small_temos(Index nfeats = 64) {
  return {.nfeats = nfeats, .text_dim = 64, .latent_dim = 16, .ff_size = 24, .num_layers = 2};
}
inline ml::Temos<B> temos(const ml::TemosConfig& c) {
  ml::Philox rng{.seed = 61};
  return {c, rng};
}
/// .hydra/config.yaml and checkpoints/last.ckpt of TEMOS, TEACH or SINC with a small DistilBERT inside.
template <ml::Module M, class Config>
void write_lightning_run(const fs::path& folder, const M& model, const Config& c, double fps,
                         const std::string& extra = "") {
  write_text(folder / ".hydra/config.yaml",
             ml::concat_text("data:\n  dataname: kit-amass-xyz\n  framerate: ", fps, "\nmodel:\n  latent_dim: ",
                             c.latent_dim, "\n  ff_size: ", c.ff_size, "\n  num_layers: ", c.num_layers,
                             "\n  num_head: 6\n  vae: true\n  textencoder:\n    latent_dim: ${model.latent_dim}\n"));
  ml::Philox rng{.seed = 62};
  const ml::DistilBert<B> words(
      {.vocabulary = 7, .width = c.text_dim, .heads = 1, .d_ff = 32, .layers = 1, .positions = 16}, rng);
  TorchArchive archive;
  archive.number("epoch", 999);
  archive.begin("state_dict");
  add_module(archive, model);
  add_module(archive, words, "textencoder.text_model.");
  for (const char* name : {"textencoder", "motionencoder", "motiondecoder"})
    add_zeros(archive, std::string(name) + ".sequence_pos_encoding.pe", {5, 1, c.latent_dim});
  add_zeros(archive, "_losses.losses_train.total", {});
  if (!extra.empty()) add_zeros(archive, extra, {c.latent_dim});
  archive.end();
  write_bytes(folder / "checkpoints/last.ckpt", archive.finish());
}
inline void write_temos_run(const fs::path& folder, const ml::TemosConfig& c, const std::string& extra = "") {
  write_lightning_run(folder, temos(c), c, 12.5, extra);
}
inline ml::TeachConfig small_teach() {
  return {.text_dim = 64, .latent_dim = 16, .ff_size = 24, .num_layers = 2, .unused_encoder = true};
}
inline ml::Teach<B> teach(const ml::TeachConfig& c) {
  ml::Philox rng{.seed = 71};
  return {c, rng};
}
inline ml::SincConfig small_sinc() { return {.text_dim = 64, .latent_dim = 16, .ff_size = 24, .num_layers = 2}; }
inline ml::Sinc<B> sinc(const ml::SincConfig& c) {
  ml::Philox rng{.seed = 81};
  return {c, rng};
}
inline void write_temos_statistics(const fs::path& folder, Index width) {
  const std::string kind = width == 135 ? "rfeats" : "jfeats";
  const auto n = statistics(width, 6);
  write_bytes(folder / (kind + "_mean.pt"), TorchArchive::of_tensor(view_of(n.mean)));
  write_bytes(folder / (kind + "_std.pt"), TorchArchive::of_tensor(view_of(n.std)));
}

}  // namespace official
