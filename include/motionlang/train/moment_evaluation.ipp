// SPDX-License-Identifier: MIT
// Bodies of moment_evaluation.hpp.
#pragma once

#include <motionlang/train/moment_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY JoinedClips join_random_clips(const std::vector<DescribedMotion>& motions, Index width, Index clips,
                                              Philox rng) {
  JoinedClips out;
  std::set<std::string> said;
  for (int tries = 0; tries < 1000 && std::ssize(out.texts) < clips; ++tries) {
    const DescribedMotion& m = motions[rng.below(static_cast<std::uint32_t>(motions.size()))];
    const DescribedText& t = m.texts.front();
    if (!said.insert(t.text).second) continue;
    out.stretches.push_back({std::ssize(out.rows) / width, t.frames.length});
    out.texts.push_back(t.text);
    const auto first = m.rows.begin() + t.frames.first * width;
    out.rows.insert(out.rows.end(), first, first + t.frames.length * width);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
