// SPDX-License-Identifier: MIT
/// The output of a text encoder, and input of a denoiser: token vectors for every text.
#pragma once

#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct TextFeatures {
  Sequences<B> tokens;                // one sequence per text; a pooled encoder gives one row each
  std::vector<Index> end_position{};  // of each text: the row of its end token, for models that read it (MotionDiffuse)
  Index padded_tokens = 0;            // for a batch that is padded beyond its longest text: MDM-SMPL counts padding

  Index count() const { return tokens.count(); }

  /// From one vector per text.
  static TextFeatures pooled(const Tensor<B, 2>& rows) { return {{rows, Offsets::equal(rows.size(0), 1)}}; }
};

/// Selects texts by number, with repetition.
template <Backend B>
TextFeatures<B> gather(const TextFeatures<B>& text, std::span<const Index> which) {
  TextFeatures<B> out;
  for (Index i : which) {
    if (i < 0 || i >= text.count()) raise<shape_error>(203, "gather: text ", i, " of ", text.count());
    if (!text.end_position.empty()) out.end_position.push_back(text.end_position[static_cast<std::size_t>(i)]);
  }
  out.tokens = detail::some_sequences(text.tokens, which);
  out.padded_tokens = text.padded_tokens;
  return out;
}

MOTIONLANG_NAMESPACE_END
