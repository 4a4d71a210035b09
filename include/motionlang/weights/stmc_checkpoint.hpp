// SPDX-License-Identifier: MIT
/// STMC from one place: a file of ours, a folder of train-stmc, the published run folder, or that of MDM or
/// MotionDiffuse, which STMC composes as well.
///
///     const auto stmc = load_stmc<B>("models/mdm-smpl_clip_smplrifke_humanml3d", {.text_encoder = "ViT-B-32.pt"});
///     const Motion motion = generate_motion(stmc, timeline, {.seed = 7});
///
/// One type holds whatever is found there. `load_stmc<B>(file)` of weights/stmc_file.hpp, without options, reads our
/// files alone: it needs no JSON, and a program with it compiles much faster.
/// Source  Petrovich et al. (CVPR Workshops 2024); Tevet et al. (ICLR 2023); Zhang et al. (TPAMI 2024)
#pragma once

#include <motionlang/core/option_error.hpp>
#include <motionlang/text/caption_encoder.hpp>
#include <motionlang/weights/diffusion_run.hpp>
#include <motionlang/weights/stmc_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The text encoder of ours, or one that is published. Exactly one is set.
template <Backend B>
struct StmcTextEncoder {
  std::optional<CaptionEncoder<B>> captions{};
  std::optional<AnyTextEncoder<B>> published{};

  /// The weights of published text encoders are in files of their own.
  static constexpr auto fields() { return motionlang::fields("captions", &StmcTextEncoder::captions); }

  template <class To>
  requires std::same_as<To, B> TextFeatures<To> encode(std::span<const std::string> texts)
  const { return captions ? captions->template encode<To>(texts) : published->template encode<To>(texts); }
};

template <Backend B>
using StmcCheckpoint = Stmc<B, AnyDenoiser<B>, StmcTextEncoder<B>>;

/// path    a .safetensors file of ours, or a folder (weights/run_folder.hpp)
/// Throws  io_error 401 for a file that is missing, naming it, 403 to 407 for files and tensors, 404 for a model of
///         another system; option_error 102 for options to a file of ours, which has its own; config_error 101, 102,
///         103, 107; numeric_error 301
template <Backend B>
StmcCheckpoint<B> load_stmc(const FilePath& path, const CheckpointOptions& options) {
  const StmcPlace place = stmc_place(path);
  const auto any = [](auto&& stmc, AnyDenoiser<B> denoiser, StmcTextEncoder<B> text) -> StmcCheckpoint<B> {
    return {.denoiser = std::move(denoiser),
            .text_encoder = std::move(text),
            .motion_normalizer = std::move(stmc.motion_normalizer),
            .text_normalizer = std::move(stmc.text_normalizer),
            .diffusion = std::move(stmc.diffusion),
            .layout = std::move(stmc.layout),
            .guidance = stmc.guidance,
            .sampling = stmc.sampling,
            .steps = stmc.steps,
            .fps = stmc.fps,
            .memory = std::move(stmc.memory)};
  };
  if (place.run) {
    PublishedStmc<B> stmc = load_diffusion_run<B>(*place.run, options);
    AnyDenoiser<B> denoiser = std::move(stmc.denoiser);
    StmcTextEncoder<B> text{.published = std::move(stmc.text_encoder)};
    return any(std::move(stmc), std::move(denoiser), std::move(text));
  }
  if (!options.text_encoder.string().empty() || !options.statistics.string().empty())
    raise<option_error>(102, place.file.string(),
                        ": `text_encoder` and `statistics` are for published models; this one has its own");
  Stmc<B> stmc = load_stmc<B>(FilePath(place.file));
  AnyDenoiser<B> denoiser{.mdm_smpl = std::move(stmc.denoiser)};
  StmcTextEncoder<B> text{.captions = std::move(stmc.text_encoder)};
  return any(std::move(stmc), std::move(denoiser), std::move(text));
}

/// The captions that a model of ours learned from, if its file has them. Throws what stored_known_captions throws.
template <Backend B>
KnownCaptions load_known_captions(const FilePath& path, const StmcCheckpoint<B>& stmc) {
  if (stmc.memory && stmc.memory->known() != nullptr) return *stmc.memory->known();  // read with the memory
  const StmcPlace place = stmc_place(path);
  if (place.run || !stmc.text_encoder.captions) return {};
  return load_known_captions(FilePath(place.file), *stmc.text_encoder.captions);
}

MOTIONLANG_NAMESPACE_END
