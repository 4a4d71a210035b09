// SPDX-License-Identifier: MIT
/// An STMC model in one safetensors file: weights under their names, sizes and vocabulary in the metadata.
///
/// Metadata    model = "stmc", format = "1", denoiser.*, text.*, diffusion.*, features, fps; guidance and sampling
///             ("ddpm 20": sampler and steps), the recommended values, which are optional; and, for readers: license,
///             provenance, data, command, commit. Nothing in the file is executed. Word vectors are stored as in
///             weights/word_vector_file.hpp, with the prefix text_encoder.vectors; the captions of the training as in
///             weights/known_caption_file.hpp
#pragma once

#include <motionlang/systems/stmc.ipp>
#include <motionlang/weights/caption_encoder_file.hpp>
#include <motionlang/weights/metadata_number.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/motion_memory_file.hpp>
#include <motionlang/weights/word_vector_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes of a bundled model: everything that its constructor needs.
struct StmcModelConfig {
  MdmSmplConfig denoiser{};
  CaptionEncoderConfig text{};
  Index diffusion_steps = 100;
  // The recommended sampling:
  NoiseScale noise_scale = NoiseScale::posterior_std;
  SamplingOptions::Sampler sampler = SamplingOptions::Sampler::ddpm;
  Index sampling_steps = 0;  // 0: all
  double guidance = 2.5;
  double fps = 20;
};

namespace detail {

/// The users' entries about a model or a record. Throws config_error 102 for a key that exists already.
void add_metadata(Metadata& metadata, const Metadata& about, std::string_view whose, const std::string& file);

}  // namespace detail

/// The sizes as metadata. `vocabulary` is that of the tokenizer. Throws config_error 101 for more sampling steps than
/// steps.
std::map<std::string, std::string> stmc_metadata(const StmcModelConfig& c, const WordPiece& tokenizer);
/// The sizes that a file declares. Throws config_error 101, 103, 107.
StmcModelConfig stmc_config(const SafetensorsFile& file);

/// A model of the given sizes. `rng` draws the parameters; NoInit leaves them zero.
template <Backend B>
Stmc<B> make_stmc(const StmcModelConfig& c, WordPiece tokenizer, Rng auto rng, WordVectors vectors = {}) {
  auto denoiser_rng = rng.split("denoiser");
  auto text_rng = rng.split("text");
  return {.denoiser = MdmSmplDenoiser<B>(c.denoiser, denoiser_rng),
          .text_encoder = CaptionEncoder<B>(c.text, std::move(tokenizer), text_rng, std::move(vectors)),
          .motion_normalizer = Normalizer<B>::identity(c.denoiser.nfeats),
          .text_normalizer = Normalizer<B>::identity(c.denoiser.tx_dim),
          .diffusion = GaussianDiffusion(CosineSchedule{.steps = c.diffusion_steps}),
          .layout = smplrifke_layout(),
          .guidance = c.guidance,
          .sampling = {.sampler = c.sampler, .noise_scale = c.noise_scale},
          .steps = c.sampling_steps,
          .fps = c.fps};
}

/// Compares the tensors that decide the size of a model with its declared sizes, before memory is allocated for them.
/// Throws io_error 406, 407.
void check_sizes(const SafetensorsFile& file, const StmcModelConfig& c, Index vocabulary, Index vector_width = 0);

/// Reads a model and makes it ready for inference. Throws io_error 401 ... 407, config_error 101, 103, 107,
/// numeric_error 301.
template <Backend B>
Stmc<B> load_stmc(const SafetensorsFile& file) {
  const StmcModelConfig c = stmc_config(file);
  WordPiece tokenizer = detail::metadata_vocabulary(file.metadata(), file.name());
  WordVectors vectors = stored_word_vectors(file, detail::vector_tensors);
  check_sizes(file, c, tokenizer.size(), vectors.width());
  Stmc<B> model = make_stmc<B>(c, std::move(tokenizer), NoInit{}, std::move(vectors));
  KeyReport report = load_module_partly(model, file, "", LoadFor::inference);
  std::erase_if(report.unexpected, [](const std::string& name) {
    return name.starts_with(detail::vector_tensors) || name.starts_with(caption_tensors) ||
           name.starts_with(memory_tensors);
  });
  if (!report.missing.empty() || !report.unexpected.empty()) detail::raise_key_mismatch(file.name(), report);
  if (remembers_motions(file)) {
    const CaptionEncoder<B>& encoder = model.text_encoder;
    model.memory =
        stored_motion_memory(file, stored_known_captions(file, text_vectors(encoder), encoder.vectors), model.fps);
  }
  return model;
}
/// The same from a file. Published models and folders: load_stmc(path, options) of weights/stmc_checkpoint.hpp.
template <Backend B>
Stmc<B> load_stmc(const FilePath& path) {
  return load_stmc<B>(SafetensorsFile::open(path));
}

/// Writes a model. `about` is added to the metadata: license, provenance, data, command, commit. captions: those of its
/// training, if they are to be stored. Throws io_error 401, config_error 102 if `about` would overwrite an entry of the
/// model.
template <Backend B>
void save_stmc(const FilePath& path, const Stmc<B>& model, const StmcModelConfig& config,
               const std::map<std::string, std::string>& about, DType dtype = DType::F16,
               const KnownCaptions& captions = {}) {
  TensorStore store;
  store.add_module(model, "", dtype);
  auto metadata = stmc_metadata(config, model.text_encoder.tokenizer);
  auto tensors = store.views();
  store_word_vectors(tensors, metadata, model.text_encoder.vectors, detail::vector_tensors);
  const StoredCaptions stored(captions);
  stored.add_to(tensors, metadata);
  detail::add_metadata(metadata, about, "model", path.string());
  write_safetensors(path, tensors, metadata);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/stmc_file.ipp>
#endif
