// SPDX-License-Identifier: MIT
/// The answer to a text: the nearest clips with scores that mean something, the words that the model does not know, and
/// if any clip shows the text at all.
///
///     const MotionSearch moves(index);
///     const TextAnswer answer = answer_text(moves, tmr, "a person jumps", {.top = 10});
///     if (!answer.shown) std::cout << "no clip shows this\n";
///     for (std::size_t i = 0; i < answer.hits.size(); ++i)
///       use(clip_of(index, answer.hits[i]).path, answer.scores[i]);
#pragma once

#include <motionlang/search/search.hpp>
#include <motionlang/search/search_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TextAnswer {
  std::vector<MotionHit> hits{};  // best first
  /// A number from 0 to 1 for each hit. If the model has a scale (metrics/similarity_scale.hpp), it is the share of
  /// pairs of a text and a motion of something else that are farther apart. Otherwise, and for captions: score_of.
  std::vector<double> scores{};
  bool calibrated = false;             // true if the scores are such shares
  std::vector<UnknownWord> unheard{};  // words that the model knows nothing about
  /// False if no clip shows the text: no clip reaches the cosine from which a motion shows a text, the model learned
  /// from nothing like it, or it knows no word of the text. Always true for captions, and for models that cannot tell
  /// unless no word is known.
  bool shown = true;
};

/// Throws what search, SearchEncoder::meant and SearchEncoder::encode_texts throw.
TextAnswer answer_text(const MotionSearch& found, const SearchEncoder& encoder, const std::string& text,
                       const SearchOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/text_answer.ipp>
#endif
