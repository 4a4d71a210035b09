// SPDX-License-Identifier: MIT
/// A perceptual study as one self-contained HTML page. A rater sees trial after trial, with the figures beside each
/// other, and saves the answers as a file, which metrics/study.hpp reads.
///
///     const Study study = parse_study(table, StudyKind::pairs);
///     const StudyFiles files{.motion = [](const std::string& file) { return read_motions(file)[0]; }};
///     write_file("study.html", study_html(study, files, {.seed = 7}));
#pragma once

#include <cstdint>     // seeds
#include <functional>  // files
#include <string>      // texts
#include <vector>      // tracks

#include <motionlang/kinematics/motion.hpp>
#include <motionlang/metrics/study.hpp>
#include <motionlang/view/track.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct StudyPageOptions {
  std::string title = "Which motion is better?";
  std::string question{};      // "": that of the kind
  std::string instructions{};  // on the first page; "": those of the kind
  std::uint64_t seed = 0;      // of the order
  bool show_text = true;       // else only the motions, as in a study of realism
  bool no_preference = false;  // pairs: a third answer
};

/// Reads the files that the table names.
struct StudyFiles {
  std::function<Motion(const std::string&)> motion{};
  std::function<std::vector<Track>(const std::string&)> timeline{};  // none: timelines are not shown
};

/// "Which motion corresponds better to the text?" and its kin.
std::string study_question(const Study& study, bool show_text = true);

/// The page contains no names of systems or files. Throws what `files` throws, and as viewer_html.
std::string study_html(const Study& study, const StudyFiles& files, const StudyPageOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/study_page.ipp>
#endif
