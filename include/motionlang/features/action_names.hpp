// SPDX-License-Identifier: MIT
/// What the classes of data sets of actions are called, by their numbers.
/// Source  spec actor.md 8.1
#pragma once

#include <string_view>  // names

#include <motionlang/version.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

inline constexpr std::string_view humanact12_actions[] = {
    "warm_up", "walk",   "run",  "jump", "drink", "lift_dumbbell", "sit", "eat", "turn steering wheel",
    "phone",   "boxing", "throw"};

}  // namespace motionlang::inline MOTIONLANG_ABI
