// SPDX-License-Identifier: MIT
/// A published diffusion model as a model folder of ours: one file of weights with the statistics, its sizes, its
/// licence.
///
///     pack_diffusion_run<B>(find_run("mdm/humanml_trans_enc_512"), "mdm", {.license = "MIT", .provenance =
///     "github.com/..."}); const auto stmc = load_diffusion_run<B>("mdm");
#pragma once

#include <motionlang/weights/diffusion_run.hpp>
#include <motionlang/weights/model_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct PackOptions {
  std::string license, provenance;
  DiffusionRunOptions sources{};
  bool text_encoder = false;  // copied into the folder
  FilePath tokenizer = "";    // of TM2T: the folder of its motion tokenizer, looked for beside the model unless given
};

namespace detail {

/// The options that `diffusion_run` reads, under the names that the systems give them.
inline nlohmann::ordered_json diffusion_options(const DiffusionRun& run) {
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
  return out;
}

/// The files of a text encoder that reading it takes. `weights`: not only those of its tokenizer.
inline std::vector<std::filesystem::path> text_encoder_files(const std::filesystem::path& path, bool weights = true) {
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

/// Whether a tensor of the checkpoint belongs to the model: of what is beside it only CLIP's text tower.
inline bool is_packed(const std::string& name, const DiffusionRun& run) {
  if (name.starts_with("clip.")) return run.system == "motiondiffuse" && !name.starts_with("clip.visual.");
  return name.starts_with(run.prefix) && !is_beside(std::string_view(name).substr(run.prefix.size())) &&
         !begins_with_any(name, {"motion_normalizer.", "text_normalizer."});
}

}  // namespace detail

/// Throws what load_diffusion_run and write_model_folder throw.
template <Backend B>
void pack_diffusion_run(const RunFolder& given, const FilePath& path, const PackOptions& options) {
  const RunFolder run = detail::published_run(given);
  const WeightFile weights = detail::run_weights(run);
  const DiffusionRun about = diffusion_run(run, weights);
  const Normalizer<B> motion = detail::motion_normalizer<B>(run, weights, about.width(), options.sources);
  const auto text = detail::text_normalizer<B>(run, weights, about);
  TensorStore statistics;
  statistics.add_module(motion, "motion_normalizer.");
  if (text) statistics.add_module(*text, "text_normalizer.");
  std::vector<TensorView> tensors = statistics.views();
  for (const TensorView& t : weights.tensors()) {
    if (detail::is_packed(t.name, about)) tensors.push_back(t);
  }
  std::vector<std::filesystem::path> files;
  const std::string encoder = options.sources.text_encoder.string();
  if (options.text_encoder && about.system == "motiondiffuse" && encoder.empty())
    files = {detail::clip_vocabulary_of(run.folder)};
  else if (options.text_encoder)
    files = detail::text_encoder_files(encoder.empty() ? detail::find_text_encoder(run.folder, about.text_encoder)
                                                       : std::filesystem::path(encoder));
  ModelFolder model;
  model.system = about.system;
  model.license = options.license;
  model.provenance = options.provenance;
  model.features = about.features;
  model.text_encoder = about.text_encoder;
  model.fps = about.fps;
  model.config = detail::diffusion_options(about);
  write_model_folder(path, model, tensors, files);
}

MOTIONLANG_NAMESPACE_END
