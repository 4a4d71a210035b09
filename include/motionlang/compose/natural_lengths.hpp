// SPDX-License-Identifier: MIT
/// Actions that begin and end. A denoiser that has more time than an action takes repeats it, slows it down, or begins
/// in the middle. So a text becomes several: standing, the action for its usual time, and what follows.
///
///     const auto length = natural_length("sit down");                     // 2.8 s, then "sit quietly"
///     const Timeline both = end_actions(parse_timeline("sit down # 0 # 8\n"), 20);
///
/// Source  lengths: the third quartile of the segments with such captions in examples/training/captions.tsv; of a jump,
///         that of the jumps which the bundled weights remember
#pragma once

#include <optional>     // other texts
#include <string>       // what follows
#include <string_view>  // texts

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The usual duration of an action, and a text for the time after it.
struct NaturalLength {
  double seconds = 0;
  std::string then{};
  bool from_rest = false;  // raising arms, bending: starts from standing
};

/// The length of an English text of one action that ends: turning, raising arms, sitting down, standing up, jumping,
/// bending, kicking, punching and throwing. Nothing for other texts, and for those with "again", "and", "while",
/// "times", ...
std::optional<NaturalLength> natural_length(std::string_view text);

/// The seconds of "stand still" before an action that starts from rest.
inline constexpr double standing_lead_in = 0.5;

/// Every text that lasts at least a second longer than its action becomes the action and what follows it, with the same
/// parts. An action from rest gets a standing_lead_in if it lasts two seconds, has all parts and starts the timeline.
/// This is for the human body; other timelines stay as they are.
Timeline end_actions(const Timeline& timeline, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/natural_lengths.ipp>
#endif
