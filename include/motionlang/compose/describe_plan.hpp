// SPDX-License-Identifier: MIT
/// The plan of a timeline as text: when each text moves which body parts, and which text each body part follows.
#pragma once

#include <span>    // timelines
#include <string>  // lines

#include <motionlang/compose/plan.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The texts of a timeline: a line with their number and the length of all, then one for each with its seconds.
/// fps  frames per second of the timeline
std::string describe_timeline(const Timeline& timeline, double fps);

/// A line for each text with its seconds and body parts, then one for each body part with the stretches of its texts.
/// fps  frames per second of the plan
std::string describe_plan(const TimelinePlan& plan, double fps);

/// Options of a report on the plans of timelines.
struct PlanReportOptions {
  double fps = 20;         // of the timelines
  double overlap = 0.5;    // seconds that neighbouring texts share around a cut
  bool cut_texts = true;   // as generate_motion does
  Index longest_crop = 0;  // frames that the model accepts; 0: any
};
/// For each timeline a line with its number, frames, seconds and texts, and its plan below. Texts may be hidden. Throws
/// what cut_texts and plan_timeline throw.
std::string describe_plans(std::span<const Timeline> timelines, const PlanReportOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/describe_plan.ipp>
#endif
