// SPDX-License-Identifier: MIT
/// The run folder of any published system as a model folder of ours: one file of weights with the statistics, licence,
/// provenance.
///
///     pack_run<B>(find_run("pretrained/temos"), "temos", {.license = "...", .provenance = "github.com/Mathux/TEMOS",
///                                                         .sources = {.statistics = "deps/.../kit-amass-xyz"}});
///     const auto temos = load_temos_run<B>("temos");            // as from the run itself
///
/// STMC, MDM and MotionDiffuse for texts are packed as in weights/diffusion_folder.hpp. ACTOR, TEMOS, TEACH, SINC, TMR,
/// TM2T and MDM for actions are packed with all their options, in a config.json that says "published"; find_run reads
/// such a folder as one of the system.
/// Left out   everything outside the model: SMPL, losses, metrics, optimisers
#pragma once

#include <motionlang/weights/diffusion_folder.hpp>
#include <motionlang/weights/mdm_action_run.hpp>
#include <motionlang/weights/tm2t_run.hpp>
#include <motionlang/weights/vae_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Options for the packed folder.
struct PackedFiles {
  ModelFolder model{};
  std::vector<WeightFile> weights{};  // with different names
  std::vector<std::filesystem::path> text_encoder{};
};
template <Backend B>
struct PackedParts : PackedFiles {
  std::optional<Normalizer<B>> statistics{};
};
/// `tensors` holds the statistics.
void write_packed(const FilePath& path, const RunFolder& run, PackedFiles& parts, std::vector<TensorView> tensors,
                  const PackOptions& options);

template <Backend B>
void add_lightning(PackedParts<B>& out, const RunFolder& run, const PackOptions& options) {
  require_checkpoint(run, "temos", "checkpoints/last.ckpt");
  const TensorSet& weights = out.weights.emplace_back(open_weights(run.weights));
  const TemosRunOptions sources{.text_encoder = options.sources.text_encoder, .statistics = options.sources.statistics};
  out.model.system = lightning_system(weights);
  out.model.fps = RunReader(run, weights, "").real("data/framerate", out.model.system == "temos" ? 12.5 : 30);
  out.model.text_encoder = "distilbert";
  out.statistics = temos_normalizer<B>(run, weights, sources);
  const bool inside = weights.find("textencoder.text_model.embeddings.word_embeddings.weight") != nullptr;
  if (options.text_encoder) out.text_encoder = text_encoder_files(temos_text_folder(run, sources), !inside);
}

template <Backend B>
void add_tmr(PackedParts<B>& out, const RunFolder& run) {
  const TensorSet& weights = out.weights.emplace_back(open_weights(run.folder));
  if (weights.find("stats.mean") == nullptr || weights.find("stats.std") == nullptr)
    raise<io_error>(401, run.folder.string(), ": no statistics of the motions: stats/mean.pt and std.pt are missing");
  out.model.features = "guoh3dfeats";
  out.model.text_encoder = "distilbert";
}

template <Backend B>
void add_tm2t(PackedParts<B>& out, const RunFolder& run, const PackOptions& options) {
  const Tm2tRunOptions sources{.tokenizer = options.tokenizer, .words = options.sources.text_encoder};
  const RunFolder tokenizer_run = tm2t_tokenizer_run(run, sources);
  out.weights.push_back(tm2t_weights(run));
  if (!tokenizer_run.packed) out.weights.push_back(tm2t_weights(tokenizer_run));
  const TensorSet& weights = out.weights.back();
  const Index features = tm2t_tokenizer_config(RunReader(tokenizer_run, weights, "")).features;
  out.statistics = tm2t_normalizer<B>(tokenizer_run, weights, features);
  out.model.features = "guoh3dfeats";
  out.model.fps = features == 251 ? 12.5 : 20;
  if (!options.text_encoder) return;
  for (const char* end : {"_data.npy", "_words.pkl", "_idx.pkl"})
    out.text_encoder.emplace_back(tm2t_words(run, sources).string() + end);
}

}  // namespace detail

/// Throws what the readers of the system and write_model_folder throw; io_error 404 for a folder of another system.
template <Backend B>
void pack_run(const RunFolder& run, const FilePath& path, const PackOptions& options) {
  detail::PackedParts<B> parts;
  parts.model.system = run.system;
  if (run.system == "actor") {
    detail::require_checkpoint(run, "actor", "checkpoint_0000.pth.tar");
    parts.weights.push_back(open_weights(run.weights));
  } else if (run.system == "temos") {
    detail::add_lightning(parts, run, options);
  } else if (run.system == "tmr") {
    detail::add_tmr(parts, run);
  } else if (is_tm2t_generator(run) || is_tm2t_describer(run)) {
    detail::add_tm2t(parts, run, options);
  } else if (is_mdm_action_run(run)) {
    parts.weights.push_back(detail::run_weights(run));
  } else {
    return pack_diffusion_run<B>(run, path, options);
  }
  TensorStore statistics;
  if (parts.statistics) statistics.add_module(*parts.statistics, "motion_normalizer.");
  detail::write_packed(path, run, parts, statistics.views(), options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/pack_run.ipp>
#endif
