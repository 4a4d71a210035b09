// SPDX-License-Identifier: MIT
/// Body parts for the texts of a timeline file that name none: from the answers of a language model, else guessed from
/// their words.
///
///     auto timelines = timelines_of_text(file, {.fps = 20});
///     for (const std::string& note : fill_missing_parts(timelines, file, &answers)) use(note);
///
/// Without it such texts move the whole body.
/// Source  SINC (Athanasiou et al., ICCV 2023), thesis B.2.1; STMC, thesis 6.2.2: parts by GPT-3
#pragma once

#include <string>       // notes
#include <string_view>  // files
#include <vector>       // timelines

#include <motionlang/compose/timeline.hpp>
#include <motionlang/datasets/body_part_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// SINC's parts as STMC's. Legs and pelvis become the legs; the torso becomes spine and head.
BodyParts as_body_parts(const SincParts& parts);

/// The timelines of a file, which was read without `as_published`. answers: null to guess all texts.
/// result  a sentence for each text, about the parts that it got and why
/// Throws  what timelines_of_text throws
std::vector<std::string> fill_missing_parts(std::vector<Timeline>& timelines, std::string_view file,
                                            const BodyPartAnswers* answers = nullptr);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/missing_parts.ipp>
#endif
