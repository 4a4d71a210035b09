// Vectors of texts that are not trained here: states of a language model for the text encoder, and one vector for each
// text that says which texts mean the same.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/embedding_cache.hpp>

#include "described_motions.hpp"
#include "text_motion_config.hpp"

namespace program {

namespace ml = motionlang;

/// Whether a model reads word pieces, which it learns, and not the states of a language model; `from`: as token_states
/// takes it. Throws config_error 103 for another encoder, 102 if `from` and the encoder contradict each other.
bool reads_pieces(const TextTokensConfig& text, const std::filesystem::path& from);

/// The states of texts, for which a language model or a cache is asked again and again.
using TextStates = std::function<ml::EmbeddingCache(std::span<const std::string>)>;
/// `from` as below. Throws what the readers throw; the function config_error 103 for a text that a cache lacks.
TextStates text_states(const std::filesystem::path& from);

/// The states of all `texts`. `from` is a folder of Hugging Face (DistilBERT), or the .npy file of an embedding cache,
/// which has to have them. Throws what the readers throw, config_error 103 for a text that a cache lacks.
ml::EmbeddingCache token_states(const std::filesystem::path& from, std::span<const std::string> texts);

/// What a text encoder, or a cache, says of these texts.
template <class Encoder>
ml::EmbeddingCache states_of(const Encoder& encoder, std::span<const std::string> texts) {
  using B = ml::EigenBackend<float>;
  constexpr std::size_t at_once = 64;
  ml::EmbeddingCache out(0);
  for (std::size_t at = 0; at < texts.size(); at += at_once) {
    const auto part = texts.subspan(at, std::min(at_once, texts.size() - at));
    if (at == 0) out = ml::EmbeddingCache(encoder.template encode<B>(part.first(1)).tokens.width());
    out.add<B>(encoder, part);
  }
  return out;
}

/// A unit vector for each text of the data: of a sentence encoder (a folder of MPNet) or a cache as above; "": of the
/// bag of words of all texts that somewhere are about the same frames, so that wordings of one thing are alike.
ml::EmbeddingCache sentence_vectors(const std::filesystem::path& from, const DescribedMotions& data);

}  // namespace program
