// SPDX-License-Identifier: MIT
// Bodies of tm2t_tokens.hpp.
#pragma once

#include <motionlang/train/tm2t_tokens.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TokenizedBatch tokenized_batch(const TokenizedMotions& of, const MotionVocabulary& vocabulary,
                                               std::span<const Index> which, Philox* draw) {
  std::vector<std::vector<Index>> tokens, written;
  const auto below = [&](std::size_t n) { return draw == nullptr ? 0 : draw->below(static_cast<std::uint32_t>(n)); };
  for (const Index i : which) {
    const auto& texts = of[static_cast<std::size_t>(i)];
    const TokenizedText& text = texts[below(texts.size())];
    const auto& line = text.lines[below(text.lines.size())];
    const bool drop = draw != nullptr && line.size() > 1 && below(3) == 2;
    const auto what = !drop ? TokenDrop::none : below(2) == 0 ? TokenDrop::last : TokenDrop::first;
    tokens.push_back(marked_tokens(line, vocabulary, what));
    written.push_back(text.words);
  }
  return {IdSequences::from(tokens), IdSequences::from(written)};
}

MOTIONLANG_NAMESPACE_END
