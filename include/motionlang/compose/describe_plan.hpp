// SPDX-License-Identifier: MIT
/// The plan of a timeline as text: when each text moves which body parts, and which text each body part follows.
#pragma once

#include <string>  // lines

#include <motionlang/compose/plan.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The texts of a timeline: a line with their number and the length of all, then one for each with its seconds.
/// fps  frames per second of the timeline
std::string describe_timeline(const Timeline& timeline, double fps);

/// A line for each text with its seconds and body parts, then one for each body part with the stretches of its texts.
/// fps  frames per second of the plan
std::string describe_plan(const TimelinePlan& plan, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/describe_plan.ipp>
#endif
