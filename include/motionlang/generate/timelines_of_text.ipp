// SPDX-License-Identifier: MIT
// Bodies of timelines_of_text.hpp.
#pragma once

#include <motionlang/generate/timelines_of_text.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Timeline> timelines_of_text(std::string_view text, const TimelineTextOptions& options) {
  if (!is_text_list(text, {.name = options.name})) return parse_timelines(text, options);
  std::vector<Timeline> out;
  for (const auto& t : parse_text_list(text, options)) out.push_back({{{t.text, 0, t.frames, BodyParts::all()}}});
  return out;
}

MOTIONLANG_NAMESPACE_END
