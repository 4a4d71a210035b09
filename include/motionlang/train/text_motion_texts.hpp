// SPDX-License-Identifier: MIT
/// The texts of a training of TMR or TEMOS as vectors: states of a language model unless the model reads word pieces,
/// and one vector for each text that tells which texts mean the same.
#pragma once

#include <filesystem>  // folders
#include <optional>    // states
#include <utility>     // move

#include <motionlang/weights/text_motion_model.hpp>
#include <motionlang/weights/text_states.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The places of text encoders and statistics; "" means none.
struct TextMotionFiles {
  std::filesystem::path text_encoder{};      // DistilBERT: a folder, or the .npy file of an embedding cache
  std::filesystem::path sentence_encoder{};  // MPNet, likewise; without it, texts are compared by their words
  std::filesystem::path statistics{};        // folder with mean and deviation of the features
  std::filesystem::path word_vectors{};      // of words beyond those of the texts (weights/word_vector_file.hpp)
};

template <Backend B>
struct TextMotionTexts {
  std::optional<EmbeddingCache> states{};      // of a language model that is not trained
  EmbeddingCache sentences{0};                 // unit vectors
  WordVectors vectors{};                       // for a model that reads word pieces
  std::optional<LanguageModel<B>> language{};  // that is trained with the model
};

/// Throws config_error 102 if vectors of words are for a model that reads the states of a language model.
void require_pieces(const TextTokensConfig& text, const TextMotionFiles& files);
/// Throws config_error 102 if text.finetune lacks a DistilBERT.
void require_finetuned(const TextTokensConfig& text, const std::filesystem::path& text_encoder);

/// The DistilBERT that is trained with the model, where text.finetune asks for it. Throws config_error 102 without its
/// folder, and what the readers throw.
template <Backend B>
std::optional<LanguageModel<B>> finetuned_language_model(const TextTokensConfig& text,
                                                         const std::filesystem::path& text_encoder) {
  if (!text.finetune) return {};
  require_finetuned(text, text_encoder);
  return read_language_model<B>(text_encoder);
}

/// Throws what reads_pieces and the readers throw.
template <Backend B>
TextMotionTexts<B> text_motion_texts(const TextTokensConfig& text, const TextMotionFiles& files,
                                     const DescribedMotions& data, std::optional<LanguageModel<B>> language) {
  TextMotionTexts<B> out;
  require_pieces(text, files);
  if (!files.word_vectors.empty()) out.vectors = read_word_vectors(files.word_vectors);
  if (!reads_pieces(text, files.text_encoder) && !language)
    out.states = token_states<B>(files.text_encoder, all_texts(data));
  out.sentences = sentence_vectors<B>(files.sentence_encoder, data);
  out.language = std::move(language);
  return out;
}
template <Backend B>
TextMotionTexts<B> text_motion_texts(const TextTokensConfig& text, const TextMotionFiles& files,
                                     const DescribedMotions& data) {
  return text_motion_texts<B>(text, files, data, finetuned_language_model<B>(text, files.text_encoder));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/text_motion_texts.ipp>
#endif
