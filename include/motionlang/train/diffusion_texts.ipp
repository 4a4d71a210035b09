// SPDX-License-Identifier: MIT
// Bodies of diffusion_texts.hpp.
#pragma once

#include <motionlang/train/diffusion_texts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void require_text_source(const DiffusionTextConfig& text, const std::filesystem::path& from,
                                         bool states) {
  const bool pieces = text.encoder == "word_pieces";
  if (pieces != from.empty())
    raise<config_error>(102, pieces ? "`text_encoder` is for text.encoder = clip or distilbert"
                                    : concat_text("text.encoder = ", text.encoder,
                                                  " needs `text_encoder`, a file, a folder or a cache; without one: "
                                                  "text.encoder = word_pieces"));
  if (states && text.encoder == "clip" && from.extension() == ".npy")
    raise<config_error>(102, from.string(),
                        ": a cache does not say where texts end, which MotionDiffuse needs: name "
                        "CLIP itself");
}

namespace detail {

MOTIONLANG_BODY DiffusionRun described_texts(const std::string& system, const DiffusionTextConfig& text, bool states) {
  DiffusionRun out;
  out.system = system;
  out.text_encoder = text.encoder == "distilbert" ? "bert" : text.encoder;
  out.mdm.text_sequence = states && system == "mdm";
  return out;
}

MOTIONLANG_BODY std::vector<std::string> texts_with_empty(const DescribedMotions& data) {
  auto texts = all_texts(data);
  if (texts.empty() || !texts.front().empty()) texts.insert(texts.begin(), "");
  return texts;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
