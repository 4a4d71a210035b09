// SPDX-License-Identifier: MIT
// Bodies of guo_movement_training.hpp.
#pragma once

#include <motionlang/train/guo_movement_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<ClipWindow> guo_training_windows(const GuoTrainingConfig& config,
                                                             const DescribedMotions& data) {
  return training_windows(data, config.movement.window, "movement.window");
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
