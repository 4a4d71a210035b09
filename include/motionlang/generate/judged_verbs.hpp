// SPDX-License-Identifier: MIT
/// Rules that judge motions as strictly as a viewer: a rule says when a motion does what a verb says. The thresholds
/// come from recorded motions: see the table that `motionlang judge --clips` prints.
///
///     const auto reason = find_verb("raise the right arm").why_not(trace_motion(motion));    // "" if it does
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
  std::string rule{};  // as printed in a table
  /// The reason why a motion does not do it: "turned 401 degrees". "" if it does.
  std::function<std::string(const MotionTrace&)> why_not{};
  bool rests = false;               // may be as still as a standing person
  std::vector<std::string> said{};  // captions of recorded motions that show it: texts, or "*text*" for a part of one
};

/// All verbs.
const std::vector<JudgedVerb>& judged_verbs();
/// Null for an unknown name.
const JudgedVerb* known_verb(std::string_view name);
/// Throws config_error 103 for an unknown name.
const JudgedVerb& find_verb(std::string_view name);

/// The reason why a motion does not do what the verb says, or what looks wrong (look_wrong); "" if there is none. Wrong
/// are hovering, sinking in, flights that are not arcs, and turning on flat soles. It is also wrong to stand like a
/// statue although the verb moves.
std::string why_not_done(const JudgedVerb& verb, const MotionTrace& trace, const EyeLimits& limits = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/judged_verbs.ipp>
#endif
