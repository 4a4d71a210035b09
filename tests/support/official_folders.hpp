// SPDX-License-Identifier: MIT
/// Folders as the official repositories of the diffusion models leave them, with drawn weights: the same files under
/// the same names, tensors under the official keys and with what checkpoints hold besides.
#pragma once

#include <fstream>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/weights/diffusion_run.hpp>

#include "torch_archive.hpp"

namespace official {

namespace ml = motionlang;
namespace fs = std::filesystem;
using B = ml::EigenBackend<float>;
using ml::Index;

struct Sizes {
  ml::MdmSmplConfig mdm_smpl{};
  ml::MdmConfig mdm{};
  ml::MotionDiffuseConfig motiondiffuse{};
  ml::ClipTextConfig clip{};
  Index stmc_steps = 100, steps = 1000;
};
inline Sizes published() { return {}; }
inline Sizes small() {
  return {.mdm_smpl = {.tx_dim = 12, .latent_dim = 32, .ff_size = 48, .num_layers = 2, .num_heads = 4},
          .mdm = {.text_dim = 12, .latent_dim = 32, .ff_size = 48, .num_layers = 2},
          .motiondiffuse = {.latent_dim = 32,
                            .ff_size = 48,
                            .num_layers = 2,
                            .clip_dim = 64,
                            .text_latent_dim = 16,
                            .num_text_layers = 1,
                            .text_ff_size = 24},
          .clip = {.vocabulary = 520, .width = 64, .heads = 1, .d_ff = 96, .layers = 1, .out = 12},
          .stmc_steps = 5,
          .steps = 24};
}

inline void write_text(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}
inline void write_bytes(const fs::path& path, const std::vector<std::byte>& bytes) {
  fs::create_directories(path.parent_path());
  ml::write_file(path, bytes);
}
template <ml::Module M>
void add_module(TorchArchive& archive, const M& module, const std::string& prefix = "") {
  ml::TensorStore store;
  store.add_module(module, prefix);
  for (const ml::TensorView& t : store.views()) archive.tensor(t.name, t);
}
inline void add_zeros(TorchArchive& archive, const std::string& name, const ml::Shape& shape) {
  ml::TensorStore store;
  store.add(name, shape, std::span<const float>(std::vector<float>(static_cast<std::size_t>(shape.count()))),
            ml::DType::F32);
  archive.tensor(name, store.views().front());
}

/// Statistics that a test can tell from others.
inline ml::Normalizer<B> statistics(Index width, std::uint64_t seed) {
  ml::Philox rng{.seed = seed};
  auto out = ml::Normalizer<B>::identity(width);
  out.mean = ml::normal_init<B, 1>({width}, 0.5, rng);
  out.std = ml::uniform_init<B, 1>({width}, 0.5, rng) + 1.0;
  return out;
}
inline ml::TensorView view_of(const ml::Tensor<B, 1>& t) {
  return {.name = "", .dtype = ml::DType::F32, .shape = t.shape(), .bytes = std::as_bytes(t.span())};
}
inline void write_npy_statistics(const fs::path& folder, const ml::Normalizer<B>& n, const char* mean,
                                 const char* std) {
  fs::create_directories(folder);
  ml::write_npy(folder / mean, ml::NpyArray::of(n.mean.span(), {n.mean.count()}));
  ml::write_npy(folder / std, ml::NpyArray::of(n.std.span(), {n.std.count()}));
}

inline ml::ClipText<B> clip(const Sizes& s) {
  ml::Philox rng{.seed = 11};
  return {s.clip, rng};
}
inline const char* bpe_vocabulary = "\"bpe_simple_vocab_16e6.txt#version: 0.2\nw a\nwa l\nl k</w>\nwal k</w>\n";
/// OpenAI's two files.
inline void write_clip(const fs::path& folder, const Sizes& s) {
  TorchArchive archive;
  add_module(archive, clip(s));
  add_zeros(archive, "visual.proj", {2, 2});
  write_bytes(folder / "ViT-B-32.pt", archive.finish());
  write_text(folder / "bpe_simple_vocab_16e6.txt", bpe_vocabulary);
}
inline ml::AnyTextEncoder<B> clip_encoder(const Sizes& s, const ml::TextEncoderOptions& wanted) {
  ml::ClipTokenizerOptions options;
  options.longest = *wanted.limits.longest, options.truncate = true;
  return {ml::ClipTokenizer(ml::parse_merges(bpe_vocabulary), options), ml::AnyTextNetwork<B>{clip(s)}, wanted.text};
}

inline ml::MdmSmplDenoiser<B> mdm_smpl(const Sizes& s) {
  ml::Philox rng{.seed = 21};
  return {s.mdm_smpl, rng};
}
/// config.json, logs/checkpoints/last.ckpt, motion_stats, text_stats.
inline void write_stmc_run(const fs::path& folder, const Sizes& s) {
  const auto& c = s.mdm_smpl;
  write_text(folder / "config.json",
             ml::concat_text(R"({"data": {"motion_loader": {"fps": 20.0, "nfeats": )", c.nfeats,
                             R"(, "base_dir": "datasets/motions/AMASS"}, "text_encoder": {"modelname": "ViT-B/32"}},
 "diffusion": {"_target_": "src.model.diffusion.GaussianDiffusion", "timesteps": )",
                             s.stmc_steps, R"(, "prediction": "x", "lr": 0.0001, "denoiser": {"latent_dim": )",
                             c.latent_dim, R"(, "ff_size": )", c.ff_size, R"(, "num_layers": )", c.num_layers,
                             R"(, "num_heads": )", c.num_heads, R"(, "dropout": 0.1, "nb_registers": )", c.nb_registers,
                             R"(, "activation": "gelu"}}, "seed": 1234})"));
  TorchArchive archive;
  archive.number("epoch", 9999);
  archive.begin("state_dict");
  add_module(archive, mdm_smpl(s), "denoiser.");
  add_module(archive, statistics(c.nfeats, 1), "motion_normalizer.");
  add_module(archive, statistics(c.tx_dim, 2), "text_normalizer.");
  archive.end();
  write_bytes(folder / "logs/checkpoints/last.ckpt", archive.finish());
  for (const auto& [name, n] :
       {std::pair{"motion_stats", statistics(c.nfeats, 1)}, {"text_stats", statistics(c.tx_dim, 2)}}) {
    write_bytes(folder / name / "mean.pt", TorchArchive::of_tensor(view_of(n.mean)));
    write_bytes(folder / name / "std.pt", TorchArchive::of_tensor(view_of(n.std)));
  }
}

inline ml::MdmDenoiser<B> mdm(const Sizes& s) {
  ml::Philox rng{.seed = 31};
  return {s.mdm, rng};
}
/// args.json with the keys of newer runs, model000475000.pt and, beside it, an older one; Mean.npy and Std.npy of the
/// data set.
inline void write_mdm_run(const fs::path& folder, const Sizes& s) {
  const auto& c = s.mdm;
  write_text(folder / "args.json",
             ml::concat_text(
                 R"({"arch": ")",
                 c.arch == ml::MdmArch::trans_dec ? "trans_dec"
                 : c.arch == ml::MdmArch::gru     ? "gru"
                                                  : "trans_enc",
                 R"(", "cond_mask_prob": 0.1, "context_len": 0, "dataset": "humanml", "diffusion_steps": )", s.steps,
                 R"(, "emb_trans_dec": )", c.class_token != ml::MdmClassToken::none, R"(, "lambda_fc": 0.0,
 "latent_dim": )",
                 c.latent_dim, R"(, "layers": )", c.num_layers, R"(, "mask_frames": false, "noise_schedule": "cosine",
 "pos_embed_max_len": 5000, "pred_len": 0, "sigma_small": true, "text_encoder_type": "clip",
 "unconstrained": false})"));
  TorchArchive archive;
  add_module(archive, mdm(s));
  add_zeros(archive, "sequence_pos_encoder.pe", {7, 1, c.latent_dim});
  add_zeros(archive, "embed_timestep.sequence_pos_encoder.pe", {7, 1, c.latent_dim});
  write_bytes(folder / "model000475000.pt", archive.finish());
  TorchArchive older;
  add_zeros(older, "nothing", {1});
  write_bytes(folder / "model000050000.pt", older.finish());
  write_npy_statistics(folder, statistics(c.nfeats, 3), "Mean.npy", "Std.npy");
}

inline ml::MdmDenoiser<B> mdm_actions(const Sizes& s, ml::MdmCondition condition = ml::MdmCondition::action) {
  ml::MdmConfig c = s.mdm;
  c.nfeats = 150, c.condition = condition, c.num_actions = 12, c.crop_frames = 60;
  ml::Philox rng{.seed = 32};
  return {c, rng};
}
/// args.json and a checkpoint of a model of HumanAct12; there are no statistics.
/// said   more of args.json: ", \"unconstrained\": true"
inline void write_mdm_action_run(const fs::path& folder, const Sizes& s, double cond_mask_prob = 0,
                                 ml::MdmCondition condition = ml::MdmCondition::action, const std::string& said = "") {
  write_text(folder / "args.json",
             ml::concat_text(R"({"arch": "trans_enc", "cond_mask_prob": )", cond_mask_prob,
                             R"(, "dataset": "humanact12", "diffusion_steps": )", s.steps, R"(, "latent_dim": )",
                             s.mdm.latent_dim, R"(, "layers": )", s.mdm.num_layers,
                             R"(, "noise_schedule": "cosine", "num_frames": 60)", said, "}"));
  TorchArchive archive;
  add_module(archive, mdm_actions(s, condition));
  add_zeros(archive, "sequence_pos_encoder.pe", {7, 1, s.mdm.latent_dim});
  add_zeros(archive, "rot2xyz.smpl_model.faces", {2, 3});
  write_bytes(folder / "model000350000.pt", archive.finish());
}

inline ml::MotionDiffuseDenoiser<B> motiondiffuse(const Sizes& s) {
  ml::Philox rng{.seed = 41};
  return {s.motiondiffuse, rng};
}
/// opt.txt, model/latest.tar with CLIP inside, meta; CLIP's vocabulary beside them.
inline void write_motiondiffuse_run(const fs::path& folder, const Sizes& s) {
  const auto& c = s.motiondiffuse;
  write_text(folder / "opt.txt",
             ml::concat_text(
                 "------------ Options -------------\nbatch_size: 128\ndataset_name: t2m\ndiffusion_steps: ", s.steps,
                 "\nfeat_bias: 5\nis_train: True\nlatent_dim: ", c.latent_dim,
                 "\nname: t2m_motiondiffuse\n-------------- End ----------------\n"));
  TorchArchive archive;
  archive.begin("opt_encoder");
  archive.number("step", 1);
  archive.end();
  archive.number("ep", 40);
  archive.begin("encoder");
  add_module(archive, motiondiffuse(s));
  add_module(archive, clip(s), "clip.");
  add_zeros(archive, "clip.visual.proj", {2, 2});
  archive.end();
  write_bytes(folder / "model/latest.tar", archive.finish());
  write_npy_statistics(folder / "meta", statistics(c.input_feats, 4), "mean.npy", "std.npy");
  write_text(folder / "bpe_simple_vocab_16e6.txt", bpe_vocabulary);
}

/// The model that loading a folder must give, made of the same parts without any file.
inline ml::PublishedStmc<B> expected(const std::string& system, const Sizes& s) {
  const bool stmc = system == "stmc", mdm_run = system == "mdm";
  ml::AnyDenoiser<B> denoiser;
  if (stmc) denoiser.mdm_smpl = mdm_smpl(s);
  if (mdm_run) denoiser.mdm = mdm(s);
  if (!stmc && !mdm_run) denoiser.motiondiffuse = motiondiffuse(s);
  const auto linear = ml::GaussianDiffusion(ml::LinearSchedule{.steps = s.steps});
  return {.denoiser = std::move(denoiser),
          .text_encoder = clip_encoder(s, stmc      ? ml::clip_sentences()
                                          : mdm_run ? ml::clip_sentences(22)
                                                    : ml::clip_states()),
          .motion_normalizer = statistics(stmc ? 205 : s.mdm.nfeats, stmc      ? 1
                                                                     : mdm_run ? 3
                                                                               : 4),
          .text_normalizer = stmc      ? statistics(s.mdm_smpl.tx_dim, 2)
                             : mdm_run ? ml::Normalizer<B>::identity(s.mdm.text_dim)
                                       : ml::Normalizer<B>::identity(s.motiondiffuse.clip_dim),
          .diffusion = stmc      ? ml::GaussianDiffusion(ml::CosineSchedule{.steps = s.stmc_steps})
                       : mdm_run ? ml::GaussianDiffusion(ml::CosineSchedule{.steps = s.steps})
                                 : linear,
          .layout = stmc ? ml::smplrifke_layout() : ml::guoh3dfeats_layout(),
          .guidance = system == "motiondiffuse" ? 1.0 : 2.5,
          .sampling = stmc ? ml::published_stmc_sampling : ml::SamplingOptions{}};
}

}  // namespace official
