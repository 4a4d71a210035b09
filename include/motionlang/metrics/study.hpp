// SPDX-License-Identifier: MIT
/// Perceptual studies: what raters compare, the order in which they see it, and their answers.
///
///     const Study study = parse_study(read_file("study.tsv"), StudyKind::pairs, "study.tsv");
///     const auto trials = study_trials(study, 7);          // the order of seed 7: trials and sides are shuffled
///
/// Table   columns are separated by tabs, the first line has their names. `text` is what a motion should show, `motion`
///         a motion that texts describe, `timeline` a file of a timeline, `role` one of
///             (empty)      the answer counts
///             warmup       comes first and does not count
///             catch NAME   has a known answer: the column NAME is right
///         Every other column is a system. Its cells are files of motions or, if there is a column `motion`, texts. A
///         cell may be empty. Lines that start with # are comments
/// Source  TEMOS (Petrovich et al., ECCV 2022), section 4.3 and appendix C: pairs with swapped sides, three warm-ups,
///         two catch trials; agreement from 1 to 5. STMC (thesis 6.3.2): the same, with "no preference". TM2T (Guo et
///         al., ECCV 2022), appendix E: descriptions of a motion are ranked
#pragma once

#include <cstddef>      // sizes
#include <cstdint>      // seeds
#include <span>         // answers
#include <string>       // texts
#include <string_view>  // tables
#include <vector>       // trials

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// `pairs`: which of two is better. `ranking`: all in order. `rating`: one at a time, from 1 to 5.
enum class StudyKind { pairs, ranking, rating };
/// Throws config_error 103 for another name than pairs, ranking and rating.
StudyKind parse_study_kind(std::string_view name);
std::string to_string(StudyKind kind);

enum class StudyRole { counted, warmup, catch_trial };

/// A line of the table.
struct StudyItem {
  StudyRole role = StudyRole::counted;
  int right = -1;                      // of a catch trial: the system that is right
  std::string text{};                  // "": none
  std::string motion{}, timeline{};    // files; "": none
  std::vector<std::string> choices{};  // of each system; "": it has none
};

struct Study {
  StudyKind kind = StudyKind::pairs;
  std::vector<std::string> systems{};
  std::vector<StudyItem> items{};
  bool ranks_texts = false;       // choices are texts that describe `motion`
  std::uint64_t fingerprint = 0;  // of the table and the kind
};

/// Throws io_error 403, with the name and the line, for a table without systems, an unknown role, and a line with more
/// cells than columns. Also for a line with fewer choices than the kind compares, and for a catch trial whose right
/// system has no choice.
Study parse_study(std::string_view table, StudyKind kind, std::string_view name = "study");

/// The choices of an item that are shown together, from left to right.
struct StudyTrial {
  std::size_t item = 0;
  std::vector<int> shown{};  // systems
  bool operator==(const StudyTrial&) const = default;
};
/// The trials in the order of a seed: warm-ups first, in the order of the table, then all others, shuffled. Pairs are
/// all pairs of systems; catch trials pair the right system with each other one.
std::vector<StudyTrial> study_trials(const Study& study, std::uint64_t seed);

/// "12 trials, 3 warm-ups and 2 catch trials"
std::string describe_trials(const Study& study, std::span<const StudyTrial> trials);

/// The answer to a trial. Places are numbers of shown choices from the left, from 0.
struct StudyAnswer {
  std::size_t trial = 0;
  std::vector<int> places{};  // pairs: the better one, or none without preference; ranking: from best to worst
  int rating = 0;             // 1 to 5
  double seconds = 0;
};
/// The file that a page saves for one rater.
struct StudyAnswers {
  std::string rater{};
  std::uint64_t seed = 0;
  std::vector<StudyAnswer> answers{};  // at most one for each trial
};

/// Reads what a page saves: lines "study", "kind", "seed" and "rater" with their values, then "trial answer seconds",
/// separated by tabs. An answer has places separated by commas, "-" without a preference, or a rating. If a trial is
/// answered again, the last answer counts. Throws io_error 403, with name and line, for another form, for answers to
/// another study, and for an answer that its trial does not have. Seconds are finite and not negative.
StudyAnswers parse_study_answers(std::string_view text, const Study& study, std::string_view name = "answers");

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/study.ipp>
#endif
