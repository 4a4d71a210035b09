// SPDX-License-Identifier: MIT
/// Laws of TextEncoder:
///
///     count     one sequence of tokens for every text, none for no text
///     alone     a text has the same bits alone, among others in any order, and twice in one call
///     empty     "" is a text like any other
#pragma once

#include <doctest/doctest.h>

#include <motionlang/text/text_encoder.hpp>

#include "../support/tensors.hpp"

namespace laws {

namespace ml = motionlang;

template <ml::Backend B, ml::TextEncoder<B> E>
void text_encoder_laws(const E& encoder) {
  const std::vector<std::string> texts{"walk forward", "", "sit down and raise both arms", "walk forward", "!?"};
  const ml::TextFeatures<B> all = encoder.template encode<B>(texts);
  REQUIRE(all.count() == std::ssize(texts));
  CHECK(tensors::same_bits(all.tokens[0], all.tokens[3]));
  const std::vector<std::string> reversed(texts.rbegin(), texts.rend());
  const ml::TextFeatures<B> backwards = encoder.template encode<B>(reversed);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const ml::TextFeatures<B> alone = encoder.template encode<B>(std::span(texts).subspan(i, 1));
    REQUIRE(alone.count() == 1);
    const auto at = static_cast<ml::Index>(i);
    CHECK(tensors::same_bits(alone.tokens[0], all.tokens[at]));
    CHECK(tensors::same_bits(backwards.tokens[all.count() - 1 - at], all.tokens[at]));
    CHECK(all.tokens.offsets.length(at) > 0);
  }
  CHECK(encoder.template encode<B>(std::span<const std::string>()).count() == 0);
}

}  // namespace laws
