// SPDX-License-Identifier: MIT
/// Vectors of texts that are not trained: states of a language model for a text encoder, and one vector for each text
/// to find texts with the same meaning.
///
///     const EmbeddingCache states = token_states<B>("distilbert-base-uncased", texts);
///     const EmbeddingCache sentences = sentence_vectors<B>("all-mpnet-base-v2", data);
#pragma once

#include <filesystem>  // where a text encoder is
#include <functional>  // an encoder of any kind
#include <map>         // texts about the same frames
#include <memory>      // an encoder of any kind
#include <span>        // texts
#include <string>      // texts

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/text/bag_of_words.hpp>
#include <motionlang/weights/embedding_cache.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>
#include <motionlang/weights/text_motion_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if a model learns and reads word pieces, false for the states of a language model. `from`: as for token_states.
/// Throws config_error 103 for another encoder, 102 if `from` and the encoder contradict each other.
bool reads_pieces(const TextTokensConfig& text, const std::filesystem::path& from);

/// The states of these texts from a text encoder or a cache, 64 texts at a time.
template <Backend B, class Encoder>
EmbeddingCache states_of(const Encoder& encoder, std::span<const std::string> texts) {
  constexpr std::size_t at_once = 64;
  EmbeddingCache out(0);
  for (std::size_t at = 0; at < texts.size(); at += at_once) {
    const auto part = texts.subspan(at, std::min(at_once, texts.size() - at));
    if (at == 0) out = EmbeddingCache(encoder.template encode<B>(part.first(1)).tokens.width());
    out.add<B>(encoder, part);
  }
  return out;
}

/// A function that returns the states of texts from a language model or a cache.
using TextStates = std::function<EmbeddingCache(std::span<const std::string>)>;

namespace detail {

template <Backend B>
TextStates states_from(const std::filesystem::path& from, const TextEncoderOptions& options) {
  const auto ask = [](auto encoder) {
    return [encoder = std::make_shared<const decltype(encoder)>(std::move(encoder))](
               std::span<const std::string> texts) { return states_of<B>(*encoder, texts); };
  };
  if (from.extension() != ".npy") return ask(load_text_encoder<B>(from, options));
  return ask(EmbeddingCache::read(from.parent_path(), from.stem().string()));
}

/// Every text with all texts that are about the same frames anywhere, a line each.
std::map<std::string, std::string> texts_beside(const DescribedMotions& data);

/// The bag of words of a text and of the texts about the same frames.
struct WordsTogether {
  BagOfWords words;
  std::map<std::string, std::string> joined;

  template <Backend B>
  TextFeatures<B> encode(std::span<const std::string> texts) const {
    std::vector<std::string> together;
    for (const std::string& t : texts) together.push_back(joined.at(t));
    return words.encode<B>(together);
  }
};

}  // namespace detail

/// `from` is a folder of Hugging Face (DistilBERT), or the .npy file of an embedding cache. Throws what the readers
/// throw; the returned function throws config_error 103 for a text that a cache lacks.
template <Backend B>
TextStates text_states(const std::filesystem::path& from) {
  return detail::states_from<B>(from, {});
}

/// The states of all `texts`; `from` as above. Throws what the readers throw, config_error 103 for a text that a cache
/// lacks.
template <Backend B>
EmbeddingCache token_states(const std::filesystem::path& from, std::span<const std::string> texts) {
  return text_states<B>(from)(texts);
}

/// A unit vector for each text of the data. `from`: a sentence encoder (a folder of MPNet) or a cache as above. With
/// "", the vector is the bag of words of all texts about the same frames, so that different wordings are alike.
template <Backend B>
EmbeddingCache sentence_vectors(const std::filesystem::path& from, const DescribedMotions& data) {
  const auto texts = all_texts(data);
  if (from.empty())
    return states_of<B>(
        detail::WordsTogether{BagOfWords(std::span<const std::string>(texts)), detail::texts_beside(data)}, texts);
  return detail::states_from<B>(from, {.text = {.pooling = Pooling::mean, .normalize = true}})(texts);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/text_states.ipp>
#endif
