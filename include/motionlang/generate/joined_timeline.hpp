// SPDX-License-Identifier: MIT
/// The texts of a timeline as one sentence, for SINC with another conjunction than its usual one.
///
///     const Timeline joined = joined_timeline(timeline, LabelSentences(Conjunction::while_));
///     generate_motion(*sinc, joined, {.seed = 7});                                  // "walk while wave"
///
/// Source  thesis B.2.2; SINC sinc/model/sinc.py rule_based_concat
#pragma once

#include <motionlang/compose/timeline.hpp>
#include <motionlang/datasets/label_sentences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One text for the whole body, from the first frame to the end of the timeline. Without texts, an empty timeline.
/// Throws config_error 103 for a sentence whose words are not tagged, if others are.
Timeline joined_timeline(const Timeline& timeline, const LabelSentences& sentence_of);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/joined_timeline.ipp>
#endif
