// SPDX-License-Identifier: MIT
/// The names of action classes in data sets, by their numbers.
/// Source  thesis 3.3.1; ACTOR src/datasets/humanact12poses.py, ntu13.py and uestc.py
#pragma once

#include <iterator>     // ssize
#include <string>       // labels
#include <string_view>  // names
#include <vector>       // labels

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

inline constexpr std::string_view humanact12_actions[] = {
    "warm_up", "walk",   "run",  "jump", "drink", "lift_dumbbell", "sit", "eat", "turn steering wheel",
    "phone",   "boxing", "throw"};

/// The class names of a data set. None if it has only numbers, or another number of classes.
inline std::vector<std::string> action_labels(std::string_view dataset, Index classes) {
  if (dataset != "humanact12" || classes != std::ssize(humanact12_actions)) return {};
  return {std::begin(humanact12_actions), std::end(humanact12_actions)};
}

MOTIONLANG_NAMESPACE_END
