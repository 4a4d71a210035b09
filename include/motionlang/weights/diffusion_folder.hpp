// SPDX-License-Identifier: MIT
/// A published diffusion model as a model folder of ours: one file of weights with the statistics, its sizes, its
/// licence.
///
///     pack_diffusion_run<B>(find_run("mdm/humanml_trans_enc_512"), "mdm",
///                           {.license = "MIT", .provenance = "github.com/..."});
///     const auto stmc = load_diffusion_run<B>("mdm");
#pragma once

#include <motionlang/weights/diffusion_run.hpp>
#include <motionlang/weights/model_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct PackOptions {
  std::string license, provenance;
  CheckpointOptions sources{};
  bool text_encoder = false;  // copied into the folder
  FilePath tokenizer = "";    // of TM2T: the folder of its motion tokenizer; by default searched beside the model
};

namespace detail {

/// The options that `diffusion_run` reads, under the option names of the systems.
nlohmann::ordered_json diffusion_options(const DiffusionRun& run);

/// The files of a text encoder. `weights`: with its weights, not only those of its tokenizer.
std::vector<std::filesystem::path> text_encoder_files(const std::filesystem::path& path, bool weights = true);

/// True if a tensor of the checkpoint belongs to the model or to CLIP's text tower beside it.
bool is_packed(const std::string& name, const DiffusionRun& run);

/// Writes the folder. `tensors` holds the statistics.
void write_diffusion_folder(const FilePath& path, const RunFolder& run, const TensorSet& weights,
                            const DiffusionRun& about, std::vector<TensorView> tensors, const PackOptions& options);

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
  detail::write_diffusion_folder(path, run, weights, about, statistics.views(), options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/diffusion_folder.ipp>
#endif
