// SPDX-License-Identifier: MIT
// Bodies of stmc_training_notes.hpp.
#pragma once

#include <cmath>  // floor

#include <motionlang/metrics/motion_quality.hpp>
#include <motionlang/text/known_words.hpp>
#include <motionlang/train/stmc_training_notes.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::map<std::string, std::string> stmc_training_notes(const TrainingSet& data) {
  double skate = 0, jitter = 0;
  for (const CaptionedSegment& s : data.segments()) {
    const auto q = motion_quality(s.motion);
    skate += q.feet.speed;
    jitter += q.jitter;
  }
  const auto n = static_cast<double>(data.segments().size());
  return {{"real.skate", concat_text(skate / n)},
          {"real.jitter", concat_text(jitter / n)},
          {"data", concat_text(data.segments().size(), " captioned segments, ", std::floor(data.seconds() / 6) / 10,
                               " minutes")},
          {known_words_entry, listed_words(data.all_captions())},
          {"version", MOTIONLANG_VERSION}};
}

MOTIONLANG_NAMESPACE_END
