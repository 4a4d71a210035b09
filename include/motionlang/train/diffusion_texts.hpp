// SPDX-License-Identifier: MIT
/// The vectors of the texts of a training of a diffusion model, from an encoder that is not trained.
///
///     const auto texts = diffusion_texts<B>("mdm", config.text, false, "ViT-B-32.pt", data);
///     texts.encode(std::vector<std::string>{"a person walks"});
#pragma once

#include <filesystem>  // files
#include <functional>  // an encoder of any kind
#include <memory>      // an encoder of any kind
#include <span>        // texts
#include <string>      // texts

#include <motionlang/weights/diffusion_run.hpp>
#include <motionlang/weights/diffusion_training_config.hpp>
#include <motionlang/weights/text_states.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct DiffusionTexts {
  /// The vectors of texts; none if the model learns its own text encoder.
  std::function<TextFeatures<B>(std::span<const std::string>)> encode{};
  Index width = 0;  // of a vector
};

/// Throws config_error 102 if the configuration and the place of a text encoder contradict each other.
void require_text_source(const DiffusionTextConfig& text, const std::filesystem::path& from, bool states);

namespace detail {

/// The description of a model with these texts, as its reader has it.
DiffusionRun described_texts(const std::string& system, const DiffusionTextConfig& text, bool states);

/// All different texts, and "".
std::vector<std::string> texts_with_empty(const DescribedMotions& data);

}  // namespace detail

/// A system reads CLIP's vector of each text, its 77 states (MotionDiffuse), or the states of DistilBERT (MDM's
/// decoder). Vectors are computed once; CLIP's states take too much memory for that, so they are computed at each step.
/// from     the text encoder; or the .npy file of an embedding cache, except for MotionDiffuse
/// states   of all tokens
/// Throws   config_error 102 if the configuration and the file contradict each other, 103 for a text that a cache
///          lacks, and what the readers throw
template <Backend B>
DiffusionTexts<B> diffusion_texts(const std::string& system, const DiffusionTextConfig& text, bool states,
                                  const std::filesystem::path& from, const DescribedMotions& data) {
  require_text_source(text, from, states);
  if (text.encoder == "word_pieces") return {};
  const auto kept = [](EmbeddingCache cache) {
    const auto shared = std::make_shared<const EmbeddingCache>(std::move(cache));
    return DiffusionTexts<B>{[shared](std::span<const std::string> texts) { return shared->encode<B>(texts); },
                             shared->width()};
  };
  const auto all = detail::texts_with_empty(data);
  if (from.extension() == ".npy")
    return kept(states_of<B>(EmbeddingCache::read(from.parent_path(), from.stem().string()), all));
  const DiffusionRun about = detail::described_texts(system, text, states);
  const RunFolder place{
      .folder = from.string(), .system = system, .options_file = {}, .options = {}, .weights = {}, .parts = {}};
  auto encoder = load_text_encoder<B>(FilePath(from), detail::wanted_text_encoder(place, about));
  detail::require_text_encoder(place, about, from.string(), encoder.network.is_clip());
  if (system != "motiondiffuse") return kept(states_of<B>(encoder, all));
  const auto shared = std::make_shared<const AnyTextEncoder<B>>(std::move(encoder));
  const auto of = [shared](std::span<const std::string> texts) { return shared->template encode<B>(texts); };
  const std::string probe;
  return {of, of(std::span(&probe, 1)).tokens.width()};
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/diffusion_texts.ipp>
#endif
