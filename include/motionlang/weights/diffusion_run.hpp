// SPDX-License-Identifier: MIT
/// The published diffusion models from the folders of their repositories: STMC's MDM-SMPL, MDM, MotionDiffuse. Also
/// from model folders made of them (weights/diffusion_folder.hpp).
///
///     const auto stmc = load_diffusion_run<B>("models/mdm-smpl_clip_smplrifke_humanml3d",
///                                             {.text_encoder = "ViT-B-32.pt"});
///     const auto features = stmc.generate(timeline, Philox{.seed = 7});        // (frames, stmc.layout.size)
///
/// Sizes       from the shapes of the tensors; options that also state them must agree. Number of heads, steps,
///             schedule and representation come from the options, else they are as published
/// Statistics  from the checkpoint (STMC), mean and std beside it (MDM: those of HumanML3D, which are not in its
///             folder)
/// Source      STMC src/model/mdm_smpl.py, MDM model/mdm.py, MotionDiffuse text2motion/models/transformer.py
/// Throws      io_error 401 for a missing file, with its name; 404 for unsupported variants; 406, 407 for tensors;
///             config_error 102 if options and tensors differ, 101, 103, 107
#pragma once

#include <motionlang/diffusion/any_denoiser.hpp>
#include <motionlang/systems/stmc.ipp>
#include <motionlang/weights/checkpoint_options.hpp>
#include <motionlang/weights/detail/run_reader.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The configuration of a model from its files, before memory is allocated. `system` names the member that is used.
struct DiffusionRun {
  std::string system;  // stmc, mdm, motiondiffuse
  std::string prefix;  // of the names of the denoiser's tensors
  MdmSmplConfig mdm_smpl{};
  MdmConfig mdm{};
  MotionDiffuseConfig motiondiffuse{};
  Index steps = 1000;
  std::string schedule = "cosine";  // or linear, chen (Chen 2023)
  double fps = 20;
  std::string features;               // smplrifke, guoh3dfeats
  std::string text_encoder = "clip";  // or bert, none; word_pieces: a small DistilBERT that was trained with the model

  Index width() const {
    return system == "stmc" ? mdm_smpl.nfeats : system == "mdm" ? mdm.nfeats : motiondiffuse.input_feats;
  }
  Index text_width() const {
    return system == "stmc" ? mdm_smpl.tx_dim : system == "mdm" ? mdm.text_dim : motiondiffuse.clip_dim;
  }
  GaussianDiffusion diffusion() const;
  FeatureLayout layout() const;
};

template <Backend B>
using PublishedStmc = Stmc<B, AnyDenoiser<B>, AnyTextEncoder<B>>;

namespace detail {

void read_mdm(DiffusionRun& out, const RunReader& r);

RunReader reader_of(const RunFolder& run, const TensorSet& weights);

/// Tensors that checkpoints also hold: tables of positions, CLIP, SMPL, optimisers.
inline bool is_beside(std::string_view name) {
  return name.ends_with("sequence_pos_encoder.pe") || begins_with_any(name, {"clip.", "clip_model.", "rot2xyz."});
}

/// Ready for inference.
template <Module M>
void load_denoiser(M& module, const TensorSet& file, const std::string& prefix) {
  const auto beside = [&](const std::string& name) {
    return is_beside(std::string_view(name).substr(prefix.size())) ||
           begins_with_any(name, {"motion_normalizer.", "text_normalizer."});
  };
  load_run_module(module, file, prefix, beside, LoadFor::inference);
}

std::filesystem::path find_text_encoder(const std::filesystem::path& model, const std::string& kind);

/// The vocabulary of a model that has CLIP in its checkpoint.
std::filesystem::path clip_vocabulary_of(const std::filesystem::path& model);

/// The checkpoint: the entry of the file that holds the model's tensors.
WeightFile run_weights(const RunFolder& run);

template <Backend B>
AnyDenoiser<B> make_denoiser(const DiffusionRun& run, const TensorSet& weights) {
  const auto room = room_of(weights);
  NoInit zeros;
  AnyDenoiser<B> out;
  if (run.system == "stmc")
    out.mdm_smpl.emplace(run.mdm_smpl, zeros);
  else if (run.system == "mdm")
    out.mdm.emplace(run.mdm, zeros);
  else
    out.motiondiffuse.emplace(run.motiondiffuse, zeros);
  return out;
}

/// The original run inside a model folder of ours.
RunFolder published_run(const RunFolder& run);

template <Backend B>
Normalizer<B> motion_normalizer(const RunFolder& run, const TensorSet& weights, Index width,
                                const CheckpointOptions& options) {
  return run_normalizer<B>(
      run, weights, width, {"motion_stats.", "meta.", "stats.", ""},
      concat_text("the motions: put mean and std of the data set there (",
                  run.system == "mdm" ? "Mean.npy and Std.npy, in HumanML3D's own folder" : "meta/mean.npy and std.npy",
                  "), or name their folder"),
      options.statistics);
}

/// For STMC; null for the other systems.
template <Backend B>
std::optional<Normalizer<B>> text_normalizer(const RunFolder& run, const TensorSet& weights,
                                             const DiffusionRun& about) {
  if (about.system != "stmc") return std::nullopt;
  if (auto packed = find_normalizer<B>(weights, about.text_width(), {"text_normalizer."})) return packed;
  return folder_normalizer<B>(run, about.text_width(), {"text_stats."},
                              "the texts: text_stats/mean.pt and std.pt are missing");
}

/// Throws io_error 404 for models with unsupported texts.
TextEncoderOptions wanted_text_encoder(const RunFolder& run, const DiffusionRun& about);
/// Throws config_error 102 if the text encoder at `named` is not the network that the model needs.
void require_text_encoder(const RunFolder& run, const DiffusionRun& about, const std::string& named, bool clip);

template <Backend B>
AnyTextEncoder<B> encoder_of(const RunFolder& run, const TensorSet& weights, const DiffusionRun& about,
                             const CheckpointOptions& options) {
  const TextEncoderOptions wanted = wanted_text_encoder(run, about);
  const bool motiondiffuse = about.system == "motiondiffuse";
  const std::string named = options.text_encoder.string();
  if (named.empty() && motiondiffuse && weights.find("clip.token_embedding.weight") != nullptr)
    return load_clip_encoder<B>(weights, clip_vocabulary_of(run.folder).parent_path(), wanted);
  auto encoder = load_text_encoder<B>(
      named.empty() ? FilePath(find_text_encoder(run.folder, about.text_encoder)) : options.text_encoder, wanted);
  require_text_encoder(run, about, named, encoder.network.is_clip());
  return encoder;
}

}  // namespace detail

/// Reads the configuration of a run of stmc, mdm or motiondiffuse from its options and tensors.
DiffusionRun diffusion_run(const RunFolder& run, const TensorSet& weights);

/// A model that is ready to generate.
template <Backend B>
PublishedStmc<B> load_diffusion_run(const RunFolder& given, const CheckpointOptions& options = {}) {
  const RunFolder run = detail::published_run(given);
  const WeightFile weights = detail::run_weights(run);
  const DiffusionRun about = diffusion_run(run, weights);
  const bool stmc = about.system == "stmc";
  Normalizer<B> motion = detail::motion_normalizer<B>(run, weights, about.width(), options);
  AnyTextEncoder<B> encoder = detail::encoder_of<B>(run, weights, about, options);
  auto text = detail::text_normalizer<B>(run, weights, about);
  AnyDenoiser<B> denoiser = detail::make_denoiser<B>(about, weights);
  if (denoiser.mdm_smpl) detail::load_denoiser(*denoiser.mdm_smpl, weights, about.prefix);
  if (denoiser.mdm) detail::load_denoiser(*denoiser.mdm, weights, about.prefix);
  if (denoiser.motiondiffuse) detail::load_denoiser(*denoiser.motiondiffuse, weights, about.prefix);
  return {.denoiser = std::move(denoiser),
          .text_encoder = std::move(encoder),
          .motion_normalizer = std::move(motion),
          .text_normalizer = text ? std::move(*text) : Normalizer<B>::identity(about.text_width()),
          .diffusion = about.diffusion(),
          .layout = about.layout(),
          .guidance = about.system == "motiondiffuse" ? 1.0 : 2.5,
          .sampling = stmc ? published_stmc_sampling : SamplingOptions{},
          .fps = about.fps};
}
template <Backend B>
PublishedStmc<B> load_diffusion_run(const FilePath& folder, const CheckpointOptions& options = {}) {
  return load_diffusion_run<B>(find_run(folder), options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/diffusion_run.ipp>
#endif
