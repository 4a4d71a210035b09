// SPDX-License-Identifier: MIT
// Bodies of missing_parts.hpp.
#pragma once

#include <optional>  // answers

#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/generate/missing_parts.hpp>
#include <motionlang/generate/text_warnings.hpp>
#include <motionlang/generate/timelines_of_text.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY BodyParts as_body_parts(const SincParts& parts) {
  using enum SincPart;
  BodyParts out;
  if (has(parts, left_arm)) out = out.with(BodyPart::left_arm);
  if (has(parts, right_arm)) out = out.with(BodyPart::right_arm);
  if (has(parts, global) || has(parts, left_leg) || has(parts, right_leg)) out = out.with(BodyPart::legs);
  if (has(parts, torso)) out = out.with(BodyPart::spine).with(BodyPart::head);
  return out;
}

namespace detail {

inline std::optional<BodyParts> answered_body_parts(const std::string& text, const BodyPartAnswers* answers) {
  if (answers == nullptr) return std::nullopt;
  for (const auto& [label, answer] : *answers) {
    if (label != text) continue;
    if (const auto parts = known_body_part_answer(answer)) return as_body_parts(*parts);
  }
  return std::nullopt;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::string> fill_missing_parts(std::vector<Timeline>& timelines, std::string_view file,
                                                            const BodyPartAnswers* answers) {
  std::vector<std::string> notes;
  if (is_text_list(file)) return notes;  // single texts, which move the whole body
  const auto written = timelines_of_text(file, {.fps = 1000, .as_published = true});
  for (std::size_t t = 0; t < timelines.size(); ++t) {
    for (std::size_t i = 0; i < timelines[t].intervals.size(); ++i) {
      Interval& interval = timelines[t].intervals[i];
      if (!written[t].intervals[i].parts.empty()) continue;
      const auto answered = detail::answered_body_parts(interval.text, answers);
      interval.parts = answered ? *answered : guess_body_parts(interval.text, timelines[t].body);
      notes.push_back(concat_text("'", interval.text, "' moves ", join_text(listed_parts(interval.parts)),
                                  answered ? ", by the answer of a language model" : ", guessed from its words"));
    }
  }
  return notes;
}

MOTIONLANG_NAMESPACE_END
