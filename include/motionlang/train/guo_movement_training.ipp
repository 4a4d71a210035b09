// SPDX-License-Identifier: MIT
// Bodies of guo_movement_training.hpp.
#pragma once

#include <algorithm>  // max_element

#include <motionlang/train/guo_movement_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<ClipWindow> guo_training_windows(const GuoTrainingConfig& config,
                                                             const DescribedMotions& data) {
  std::vector<Index> lengths;
  for (const DescribedMotion& m : data.training) lengths.push_back(std::ssize(m.rows) / data.width);
  auto out = tm2t_windows(lengths, config.movement.window);
  if (out.empty())
    raise<config_error>(
        102, "no motion to train on has more than movement.window = ", counted(config.movement.window, "frame"),
        lengths.empty() ? std::string()
                        : concat_text("; the longest has ", *std::max_element(lengths.begin(), lengths.end())));
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
