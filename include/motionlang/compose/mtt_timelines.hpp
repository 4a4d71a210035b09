// SPDX-License-Identifier: MIT
/// Random timelines for evaluation from a list of texts: the generator of STMC's multi-track data set MTT. The data set
/// itself is not part of this library. With its 60 texts, the generator gives its 500 timelines byte for byte.
///
///     const auto texts = parse_mtt_texts("gallop in a ring # legs\nflick a switch # right arm\n...");
///     const MttFiles files = mtt_files(mtt_timelines(texts));     // MTT, and its two baselines
///
/// Each timeline has three intervals: two on one track, back to back, and one beside them on a second track. The third
/// has other body parts than the intervals that it overlaps.
/// Source  thesis 6.3.1; STMC (Petrovich et al., CVPR workshops 2024) mtt/sampling_timelines.py
/// Differs from the thesis: durations have a deviation of 1.2 s, not 1.0, and are at most 9.2 s. The parts must only
/// differ from those of the window that was chosen for the third interval, which is where it lies
#pragma once

#include <array>        // weights, windows
#include <cstdint>      // seeds
#include <span>         // texts
#include <string>       // names
#include <string_view>  // files
#include <vector>       // timelines

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A text and the body parts that it moves.
struct MttText {
  std::string text;
  BodyParts parts;
};

/// Lines "text # part # part"; blank lines are skipped. Throws timeline_error 501 without a part or for a text that is
/// not UTF-8, 503, 507.
std::vector<MttText> parse_mtt_texts(std::string_view file, std::string_view name = "texts");

struct MttOptions {
  Index count = 500;
  std::int64_t seed = 1234;
  double mean = 6, std = 1.2, cap = 9.2;  // of durations, seconds
  std::array<Index, body_part_count> weights = {1, 1, 3, 1,
                                                1};  // how often a text with this part is chosen; by BodyPart
};

/// Throws config_error 101 if the texts and weights give no pair, 102 if they leave none for the second track
std::vector<TimelineInSeconds> mtt_timelines(std::span<const MttText> texts, const MttOptions& options = {});

/// The contents of the files of timelines (timeline_text.hpp), as published.
struct MttFiles {
  std::string multi_track;   // MTT.txt
  std::string single_track;  // the same texts on one track, for DiffCollage (baselines.hpp)
  std::string one_text;      // one sentence for each timeline (baselines.hpp)
};
/// Throws timeline_error 510 if a text contains '#' or a line end.
MttFiles mtt_files(std::span<const TimelineInSeconds> timelines);

/// The numbers of the texts of a timeline, interval by interval, in the list that they were drawn from. Throws
/// config_error 102 for a text that the list lacks.
std::vector<Index> mtt_labels(std::span<const MttText> texts, const TimelineInSeconds& timeline);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/mtt_timelines.ipp>
#endif
