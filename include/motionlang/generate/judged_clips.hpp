// SPDX-License-Identifier: MIT
/// Judges recorded motions by the rules for generated ones. The limits of the judge come from this, and it shows how
/// often each rule agrees with the captions of recordings.
///
///     const TrainingSet set("captions.tsv", "clips", {});
///     const RecordedFigures f = judge_recordings(set.segments());
#pragma once

#include <motionlang/datasets/training_set.hpp>
#include <motionlang/generate/judged_prompts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The recordings with a caption that names a verb.
struct RecordedVerb {
  std::string name{};
  std::size_t segments = 0, done = 0;
  std::vector<std::string> why_not{};            // of those that fail: "cmu-daz/01_01: turned 201.00"
  std::vector<double> speed{}, air{}, turned{};  // as in Verdict
};

/// A measurement over all recordings.
struct RecordedMeasure {
  std::string name{};
  std::vector<double> values{};
};

struct RecordedFigures {
  std::size_t segments = 0;   // that are on the floor
  std::size_t elsewhere = 0;  // left out: on stairs, ladders, stools, or with a floor that is more than 4 cm off
  double hovering = 0, sinking = 0, statues = 0;  // shares
  std::vector<RecordedMeasure> measures{};        // limited by EyeLimits, or changed by fix_floor
  std::vector<RecordedVerb> verbs{};
};

/// True if the person stands on the floor. Then no caption names a thing to stand on or to hang from. Also, the lowest
/// twentieth of the heights above the floor is within 4 cm of it.
bool stands_on_floor(const CaptionedSegment& segment);

/// Judges the segments that are on the floor.
RecordedFigures judge_recordings(const std::vector<CaptionedSegment>& segments);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/judged_clips.ipp>
#endif
