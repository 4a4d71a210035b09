// SPDX-License-Identifier: MIT
/// Counts the answers to a perceptual study: votes, majorities, mean ranks and ratings, with intervals. Raters who fail
/// catch trials are left out.
///
///     const StudyCounts counts = count_study(study, answers);
///     for (const PairCount& p : counts.pairs) use(p.preferred.share);      // of a against b
///
/// Source  TEMOS (Petrovich et al., ECCV 2022), appendix C: a majority vote for each item, a tie gives both 0.5; the
///         answers of raters who fail a catch trial are discarded. STMC (thesis 6.3.4): preferred or similar. TM2T (Guo
///         et al., ECCV 2022), figure 4: how often each method has each rank
/// Differs the papers print no intervals. Here shares have the 95 % interval of Wilson (1927) over the items, means the
///         one of metrics/summary.hpp over the items
#pragma once

#include <array>    // ratings
#include <cstddef>  // sizes
#include <span>     // answers
#include <string>   // names
#include <vector>   // counts

#include <motionlang/metrics/study.hpp>
#include <motionlang/metrics/summary.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A share of a number of cases, with the ends of its 95 % interval.
struct StudyShare {
  double share = 0, low = 0, high = 1;
};
/// Wilson's interval with z = 1.96: (p + z^2/2n +- z sqrt(p (1 - p) / n + z^2 / 4n^2)) / (1 + z^2/n). `part` may count
/// halves. 0 and [0, 1] if `total` is 0.
StudyShare wilson_share(double part, double total);

/// A rater's file.
struct StudyRater {
  std::string name;
  std::size_t answers = 0, caught = 0, passed = 0;  // caught: answered catch trials, passed: the right ones of them
  bool kept = false;
};

/// The comparison of two systems.
struct PairCount {
  int a = 0, b = 0;  // a < b
  std::size_t items = 0;
  std::size_t votes_a = 0, votes_none = 0, votes_b = 0;
  std::size_t items_a = 0, items_tied = 0, items_b = 0;  // by majority; "no preference" decides nothing
  StudyShare preferred{};                                // items for a; a tie counts half
  StudyShare preferred_or_similar{};                     // items for a, and ties
};
/// The ranks of a system, of 1 (best) to the number of systems.
struct RankCount {
  int system = 0;
  std::vector<std::size_t> places{};  // how often it has each rank
  MeanInterval rank{};                // over the items, of each the mean over its raters
  /// The share of a rank. Place 0 is rank 1. Throws shape_error 203 for a place behind the last rank.
  double share(std::size_t place) const;
};
struct RatingCount {
  int system = 0;
  std::array<std::size_t, 5> ratings{};  // how often each
  MeanInterval rating{};                 // over the items
};

struct StudyCounts {
  std::vector<StudyRater> raters{};  // in the order of the answers
  double raters_for_item = 0;        // kept answers for each trial that counts and has any
  std::vector<PairCount> pairs{};
  std::vector<RankCount> ranks{};
  std::vector<RatingCount> ratings{};
};

/// A catch trial is passed if the right system is preferred, ranked first, or rated 4 or 5 and the others 1 or 2.
/// Raters are kept if they pass this share of the catch trials that they answered, and answered one if there are any.
StudyCounts count_study(const Study& study, std::span<const StudyAnswers> answers, double pass_share = 1);

/// A line for each rater who is left out, and one about the others.
/// files  of the raters' answers
std::string describe_raters(const StudyCounts& counts, std::span<const std::string> files);

/// The counts of a study's kind as a table in Markdown: pairs of systems, or a row for each system.
std::string study_table(const Study& study, const StudyCounts& counts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/study_counts.ipp>
#endif
