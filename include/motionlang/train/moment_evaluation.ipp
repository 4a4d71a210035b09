// SPDX-License-Identifier: MIT
// Bodies of moment_evaluation.hpp.
#pragma once

#include <motionlang/core/formatted.hpp>
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

MOTIONLANG_BODY JoinedClips as_joined(const DescribedMotion& sequence) {
  JoinedClips out{sequence.rows, {}, {}};
  for (const DescribedText& t : sequence.texts) out.stretches.push_back(t.frames), out.texts.push_back(t.text);
  return out;
}

MOTIONLANG_BODY std::string moments_table(const MomentFigures& figures) {
  constexpr double overlaps[] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  std::string out = formatted("  %-22s", "windows");
  for (const double least : overlaps) out += formatted(" %7.1f", least);
  for (const MomentAnswers& a : figures.answers) {
    out += formatted("\n  %-22s", a.windows.c_str());
    for (const double least : overlaps)
      out += formatted(" %7.2f", 100 * localisation_accuracy(a.found, figures.wanted, least));
  }
  return out + "\n";
}

MOTIONLANG_NAMESPACE_END
