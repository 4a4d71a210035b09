// SPDX-License-Identifier: MIT
/// The concept of a text encoder.
#pragma once

#include <span>    // texts
#include <string>  // texts

#include <motionlang/nn/text_features.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Turns texts into vectors: a sequence of tokens for each, or a single row if it pools.
/// Laws     a text gives the same features alone and among others; "" is a text like any other
/// Models   CaptionEncoder, and yours
template <class E, class B>
concept TextEncoder = requires(const E& e, std::span<const std::string> texts) {
  { e.template encode<B>(texts) } -> std::same_as<TextFeatures<B>>;
};

MOTIONLANG_NAMESPACE_END
