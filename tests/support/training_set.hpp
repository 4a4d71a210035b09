// SPDX-License-Identifier: MIT
/// The training set of a few made-up clips, read once.
#pragma once

#include "../../examples/motionlang/train/training_data.hpp"
#include "captioned_clips.hpp"

namespace captioned {

inline const program::TrainingSet& training_set() {
  static const program::TrainingSet set = [] {
    const Clips clips;
    return program::TrainingSet(clips.captions, clips.folder.path, {});
  }();
  return set;
}

}  // namespace captioned
