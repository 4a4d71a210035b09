// SPDX-License-Identifier: MIT
// Bodies of kept_clip_text.hpp.
#pragma once

#include <algorithm>  // min

#include <motionlang/compose/detail/seconds_text.hpp>
#include <motionlang/compose/timeline.hpp>
#include <motionlang/core/option_error.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/generate/kept_clip_text.hpp>
#include <motionlang/kinematics/delayed.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::pair<double, double> parse_kept_range(std::string_view range) {
  range = detail::trim(range);
  const std::size_t dash = std::min(range.find('-'), range.size());
  const auto from = detail::parse_seconds(range.substr(0, dash));
  const auto to = detail::parse_seconds(range.substr(std::min(dash + 1, range.size())));
  if (!from || !to || *from >= *to)
    raise<option_error>(101, "`keep_seconds`: '", range, "' is not a time range like 0-1.5");
  return {*from, *to};
}

MOTIONLANG_BODY BodyParts parse_kept_parts(std::string_view names) {
  for (BodyParts out{};;) {
    const std::string_view name = detail::trim(names.substr(0, names.find(',')));
    const auto part = parse_body_part(name);
    if (!part) raise<option_error>(103, "`keep_parts`: '", name, "' is not one of ", join_text(body_part_names));
    out = out.with(*part);
    if (names.find(',') == names.npos) return out;
    names.remove_prefix(names.find(',') + 1);
  }
}

MOTIONLANG_BODY Motion kept_part(const Motion& motion, double from, double to, double start) {
  const auto frame = [&](double at) { return std::min(frame_at(at, motion.fps), motion.frames()); };
  return delayed(crop(motion, frame(from), frame(to)), start);
}

MOTIONLANG_NAMESPACE_END
