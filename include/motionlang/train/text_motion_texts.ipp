// SPDX-License-Identifier: MIT
// Bodies of text_motion_texts.hpp.
#pragma once

#include <motionlang/train/text_motion_texts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void require_finetuned(const TextTokensConfig& text, const std::filesystem::path& text_encoder) {
  if (text.encoder != "distilbert" || !std::filesystem::is_directory(text_encoder))
    raise<config_error>(102, "text.finetune trains DistilBERT: text.encoder is '", text.encoder, "', `text_encoder` '",
                        text_encoder.string(), "', expected distilbert and its folder");
}

MOTIONLANG_BODY void require_pieces(const TextTokensConfig& text, const TextMotionFiles& files) {
  if (!files.word_vectors.empty() && !reads_pieces(text, files.text_encoder))
    raise<config_error>(102, files.word_vectors.string(),
                        ": `word_vectors` are for text.encoder word_pieces, not for '", text.encoder, "'");
}

MOTIONLANG_NAMESPACE_END
