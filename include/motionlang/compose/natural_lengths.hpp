// SPDX-License-Identifier: MIT
/// Actions that end: a denoiser that has more time than an action takes does it again, or slowly. Such a text becomes
/// two, the action for as long as people take and what they do afterwards.
///
///     const auto length = natural_length("sit down");                     // 2.8 s, then "sit quietly"
///     const Timeline both = end_actions(parse_timeline("sit down # 0 # 8\n"), 20);
///
/// Source  lengths: the third quartile of the segments with such captions in examples/training/captions.tsv
#pragma once

#include <optional>     // other texts
#include <string>       // what follows
#include <string_view>  // texts

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// How long an action takes, and a text of what somebody does then.
struct NaturalLength {
  double seconds = 0;
  std::string then{};
};

/// That of an English text of one action that ends: turning, raising arms, sitting down, standing up, jumping, bending,
/// kicking, punching and throwing. Nothing for other texts, and for those with "again", "and", "while", "times", ...
std::optional<NaturalLength> natural_length(std::string_view text);

/// Every text that lasts at least a second longer than its action becomes the action and what follows it, with the same
/// parts. For the human body; other timelines stay as they are.
Timeline end_actions(const Timeline& timeline, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/natural_lengths.ipp>
#endif
