// SPDX-License-Identifier: MIT
/// Rules by which motions are judged, as strict as an eye: when a motion does what a verb says. Thresholds lie where
/// recorded motions do: see the table that `motionlang judge --clips` prints.
///
///     const auto reason = find_verb("raise the right arm").why_not(trace_motion(motion));    // "" where it does
#pragma once

#include <functional>   // rules
#include <string>       // reasons
#include <string_view>  // names
#include <vector>       // rules

#include <motionlang/metrics/motion_trace.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A verb, and what a motion must do.
struct JudgedVerb {
  std::string name{};
  std::string rule{};  // as a table prints it
  /// Why a motion does not do it: "turned 401 degrees"; "" if it does.
  std::function<std::string(const MotionTrace&)> why_not{};
  bool rests = false;               // may be as still as somebody who stands
  std::vector<std::string> said{};  // captions of recorded motions that show it: texts, or "*text*" within them
};

/// All of them.
const std::vector<JudgedVerb>& judged_verbs();
/// Throws config_error 103 for an unknown name.
const JudgedVerb& find_verb(std::string_view name);

/// Why a motion does not do what the verb says, or what looks wrong about it (look_wrong): hovering, sinking in, flying
/// off the arc, turning on flat soles, and standing like a statue where the verb moves. "" if nothing.
std::string why_not_done(const JudgedVerb& verb, const MotionTrace& trace, const EyeLimits& limits = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/judged_verbs.ipp>
#endif
