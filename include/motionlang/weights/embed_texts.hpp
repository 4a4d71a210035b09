// SPDX-License-Identifier: MIT
/// The embeddings of many texts, in batches: the caches that TMR and STMC read.
///
///     const auto clip = load_text_encoder<B>("ViT-B-32.pt", clip_sentences());
///     embed_texts<B>(clip, texts_to_embed("annotations.json")).write("text_embeddings", "ViT-B/32");
#pragma once

#include <algorithm>   // min
#include <filesystem>  // a file of texts
#include <span>        // texts
#include <string>      // texts
#include <vector>      // texts

#include <motionlang/core/progress.hpp>
#include <motionlang/weights/embedding_cache.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The texts of an annotation file (.json of TMR and STMC) in its order, or the lines of any other file without blank
/// lines. Throws io_error 401, 403.
std::vector<std::string> texts_to_embed(const std::filesystem::path& file);

/// batch   texts to encode together
/// Throws  what EmbeddingCache::add throws; cancelled
template <Backend B, TextEncoder<B> E>
EmbeddingCache embed_texts(const E& encoder, std::span<const std::string> texts, Index batch = 32,
                           Progress progress = {}) {
  const std::string probe = texts.empty() ? "" : texts.front();
  EmbeddingCache cache(encoder.template encode<B>(std::span(&probe, 1)).tokens.width());
  const Index count = std::ssize(texts);
  for (Index at = 0; at < count; at += batch) {
    const auto part =
        texts.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(std::min(batch, count - at)));
    cache.add<B>(encoder, part);
    progress(at + std::ssize(part), count);
  }
  return cache;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/embed_texts.ipp>
#endif
