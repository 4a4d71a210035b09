// SPDX-License-Identifier: MIT
// Bodies of text_answer.hpp.
#pragma once

#include <algorithm>  // all_of
#include <set>        // words, each once

#include <motionlang/search/text_answer.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// True if the text has words, and the model knows nothing about any of them.
inline bool is_unheard(const std::string& text, const std::vector<UnknownWord>& unheard) {
  std::set<std::string> unknown;
  for (const UnknownWord& w : unheard) unknown.insert(w.word);
  const auto words = WordPiece::words(text);
  return !unheard.empty() &&
         std::all_of(words.begin(), words.end(), [&](const std::string& w) { return unknown.contains(w); });
}

}  // namespace detail

MOTIONLANG_BODY TextAnswer answer_text(const MotionSearch& found, const SearchEncoder& encoder, const std::string& text,
                                       const SearchOptions& options) {
  TextAnswer out;
  std::vector<std::string> meant{text};
  if (options.what != SearchFor::captions) meant = encoder.meant(text);
  const bool learned = !meant.empty();
  if (!learned) meant = {text};
  const bool reworded = meant.size() > 1 || meant.front() != text;
  out.hits = search(found, encode_together(encoder, meant), options);
  if (const KnownWords known = encoder.known_words(); !known.empty()) {
    out.unheard = unknown_words(text, known);
    for (std::string& word : unreadable_words(text)) out.unheard.push_back({std::move(word), ""});
  }
  const SimilarityScale& scale = encoder.similarity();
  out.calibrated = !scale.empty() && options.what != SearchFor::captions;
  for (const MotionHit& hit : out.hits)
    out.scores.push_back(out.calibrated ? share_below(scale, static_cast<double>(hit.score)) : score_of(hit));
  if (options.what == SearchFor::captions) return out;
  out.shown = learned && (reworded || !detail::is_unheard(text, out.unheard));
  if (out.calibrated && (out.hits.empty() || !is_shown(scale, static_cast<double>(out.hits.front().score))))
    out.shown = false;
  return out;
}

MOTIONLANG_NAMESPACE_END
