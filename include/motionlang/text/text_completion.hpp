// SPDX-License-Identifier: MIT
/// Texts that a model knows, for somebody who has begun to write one.
///
///     for (const KnownText& known : known_texts(captions, "walk b", 8)) offer(known.text);  // "walk backwards", ...
#pragma once

#include <string>  // texts
#include <vector>  // texts

#include <motionlang/text/known_captions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A caption that a model learned from, and its action.
struct KnownText {
  std::string text;
  KnownAction action{};
};

/// At most `count` captions, each once. First come those that begin with the text, then those of which a word begins
/// with its last word and that have its other words, then those nearest in meaning. Capital letters do not matter. An
/// empty text gives the first captions.
std::vector<KnownText> known_texts(const KnownCaptions& captions, const std::string& begun, Index count);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/text_completion.ipp>
#endif
