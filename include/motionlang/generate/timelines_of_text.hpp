// SPDX-License-Identifier: MIT
/// Every timeline of a text, for both kinds of lines.
///
///     const auto timelines = timelines_of_text(read_file("moves.txt"), {.fps = 20, .name = "moves.txt"});
#pragma once

#include <motionlang/compose/timeline_text.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// In frames. Timelines are separated by blank lines (parse_timelines). A list of lines "text # duration"
/// (parse_text_list) has one timeline for each line, on the whole body. Throws timeline_error 5xx with line and column.
std::vector<Timeline> timelines_of_text(std::string_view text, const TimelineTextOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/timelines_of_text.ipp>
#endif
