// SPDX-License-Identifier: MIT
/// Guesses from a text which body parts it moves, with a small lexicon of English words. A convenience for timelines
/// without parts; a person, a table or a language model (SINC, STMC) does better.
///
///     guess_body_parts("waves with the left hand")   // left arm
///     guess_body_parts("kick twice")                 // legs
///
/// Rule   Every known word adds its parts. Words of one arm mean the right one unless "left arm", "left hand", ... is
///        written. "both", "left and right" or a plural mean both arms. Without a known word, the text moves all parts.
///
/// In another body the words of its BodyPartition add their parts, and so do names and synonyms of parts.
#pragma once

#include <string_view>  // text

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

BodyParts guess_body_parts(std::string_view text);
/// The parts of another body.
BodyParts guess_body_parts(std::string_view text, const BodyPartition& body);

/// Guesses the parts of all intervals that have none.
template <class T>
void guess_missing_parts(BasicTimeline<T>& timeline) {
  for (auto& i : timeline.intervals) {
    if (i.parts.empty()) i.parts = guess_body_parts(i.text, timeline.body);
  }
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/body_part_lexicon.ipp>
#endif
