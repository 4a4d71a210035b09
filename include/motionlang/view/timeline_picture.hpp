// SPDX-License-Identifier: MIT
/// Timelines as a picture: a bar for each text over time, and below them the text that each body part follows.
///
/// Source  thesis figure 6.5: timelines, and the body part timelines that are made of them
#pragma once

#include <span>    // timelines
#include <string>  // SVG

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Timelines below each other, as SVG. The caller cuts texts that a model needs cut (compose/cut_texts.hpp). Throws
/// config_error 101 without a timeline, and what plan_timeline throws, except that texts may be hidden.
/// fps   of the timelines
std::string timelines_svg(std::span<const Timeline> timelines, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/timeline_picture.ipp>
#endif
