// SPDX-License-Identifier: MIT
// Bodies of diffusion_folder.hpp.
#pragma once

#include <motionlang/weights/diffusion_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY nlohmann::ordered_json diffusion_options(const DiffusionRun& run) {
  nlohmann::ordered_json out;
  if (run.system == "stmc") {
    const MdmSmplConfig& c = run.mdm_smpl;
    out["data"]["motion_loader"] = {{"fps", run.fps}, {"nfeats", c.nfeats}};
    out["diffusion"] = {{"timesteps", run.steps}, {"prediction", "x"}};
    out["diffusion"]["denoiser"] = {{"latent_dim", c.latent_dim},
                                    {"ff_size", c.ff_size},
                                    {"num_layers", c.num_layers},
                                    {"num_heads", c.num_heads},
                                    {"nb_registers", c.nb_registers},
                                    {"tx_dim", c.tx_dim},
                                    {"activation", std::string(to_string(c.activation))}};
    if (run.schedule != "cosine") out["diffusion"]["noise_schedule"] = run.schedule;
  } else if (run.system == "mdm") {
    const MdmConfig& c = run.mdm;
    out = {{"arch", c.arch == MdmArch::gru         ? "gru"
                    : c.arch == MdmArch::trans_dec ? "trans_dec"
                                                   : "trans_enc"},
           {"latent_dim", c.latent_dim},
           {"layers", c.num_layers},
           {"emb_trans_dec", c.class_token != MdmClassToken::none},
           {"mask_frames", c.mask_frames},
           {"text_encoder_type", run.text_encoder},
           {"diffusion_steps", run.steps},
           {"noise_schedule", run.schedule}};
    if (c.num_heads != MdmConfig{}.num_heads) out["num_heads"] = c.num_heads;
  } else {
    const MotionDiffuseConfig& c = run.motiondiffuse;
    out = {{"latent_dim", c.latent_dim},
           {"ff_size", c.ff_size},
           {"num_layers", c.num_layers},
           {"num_heads", c.num_heads},
           {"text_latent_dim", c.text_latent_dim},
           {"num_text_layers", c.num_text_layers},
           {"text_num_heads", c.text_num_heads},
           {"text_ff_size", c.text_ff_size},
           {"no_eff", c.no_eff},
           {"diffusion_steps", run.steps}};
  }
  if (run.text_encoder == "word_pieces") out["text_encoder_type"] = run.text_encoder;
  return out;
}

MOTIONLANG_BODY std::vector<std::filesystem::path> text_encoder_files(const std::filesystem::path& path, bool weights) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  const auto folder = is_folder ? path : path.parent_path();
  std::vector<std::filesystem::path> out;
  for (const char* name : {"config.json", "tokenizer.json", "tokenizer_config.json", "vocab.txt", "vocab.json",
                           "merges.txt", clip_vocabularies[0], clip_vocabularies[1]}) {
    if (file_exists(folder / name)) out.push_back(folder / name);
  }
  if (!is_folder) {
    out.push_back(path);
    return out;
  }
  if (!weights) return out;
  const RunFolder run = motionlang::find_run(path);
  if (!run.weights.empty()) out.push_back(run.weights);
  for (const auto& [part, file] : run.parts) out.push_back(file);
  if (run.weights.string().ends_with(".index.json")) {
    for (const auto& p : listed(folder)) {
      if (p.extension() == ".safetensors" || p.extension() == ".bin") out.push_back(p);
    }
  }
  return out;
}

MOTIONLANG_BODY bool is_packed(const std::string& name, const DiffusionRun& run) {
  if (name.starts_with("clip.")) return run.system == "motiondiffuse" && !name.starts_with("clip.visual.");
  return name.starts_with(run.prefix) && !is_beside(std::string_view(name).substr(run.prefix.size())) &&
         !begins_with_any(name, {"motion_normalizer.", "text_normalizer."});
}

MOTIONLANG_BODY void write_diffusion_folder(const FilePath& path, const RunFolder& run, const TensorSet& weights,
                                            const DiffusionRun& about, std::vector<TensorView> tensors,
                                            const PackOptions& options) {
  for (const TensorView& t : weights.tensors()) {
    if (is_packed(t.name, about)) tensors.push_back(t);
  }
  std::vector<std::filesystem::path> files;
  const std::string encoder = options.sources.text_encoder.string();
  if (options.text_encoder && about.system == "motiondiffuse" && encoder.empty())
    files = {clip_vocabulary_of(run.folder)};
  else if (options.text_encoder)
    files = text_encoder_files(encoder.empty() ? find_text_encoder(run.folder, about.text_encoder)
                                               : std::filesystem::path(encoder));
  ModelFolder model;
  model.system = about.system;
  model.license = options.license;
  model.provenance = options.provenance;
  model.features = about.features;
  model.text_encoder = about.text_encoder;
  model.fps = about.fps;
  model.config = diffusion_options(about);
  write_model_folder(path, model, tensors, files);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
