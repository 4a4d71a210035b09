// SPDX-License-Identifier: MIT
// Bodies of cut_texts.hpp.
#pragma once

#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/compose/handovers.hpp>
#include <motionlang/compose/long_texts.hpp>
#include <motionlang/compose/natural_lengths.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Timeline cut_texts(const Timeline& timeline, double fps) {
  const Timeline ended = end_actions(timeline, fps);
  return divide_long_texts(cut_at_handovers(ended, frame_at(shortest_part, fps)), frame_at(longest_whole_text, fps));
}

MOTIONLANG_NAMESPACE_END
