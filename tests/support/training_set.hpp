// SPDX-License-Identifier: MIT
/// The training set of a few made-up clips, read once.
#pragma once

#include <motionlang/datasets/training_set.hpp>

#include "captioned_clips.hpp"

namespace captioned {

inline const motionlang::TrainingSet& training_set() {
  static const motionlang::TrainingSet set = [] {
    const Clips clips;
    return motionlang::TrainingSet(clips.captions, clips.folder.path, {});
  }();
  return set;
}

}  // namespace captioned
