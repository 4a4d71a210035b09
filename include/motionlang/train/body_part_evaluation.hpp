// SPDX-License-Identifier: MIT
/// How often a labeller of body parts agrees with people: SINC's table B.1, for answers of a language model, for the
/// lexicon of this library, and for the speeds of recorded motions.
///
///     const PartAccuracy a = part_accuracy(truth, [&](const std::string& label) { return table.parts(label); });
///     use(a.of_parts, a.mean());
///
/// Source  thesis B.2.1, table B.1
#pragma once

#include <array>       // accuracies
#include <functional>  // labellers
#include <numeric>     // mean
#include <optional>    // labels without an answer
#include <span>        // rows
#include <string>      // labels
#include <vector>      // motions

#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/compose/text_sinc_parts.hpp>
#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/datasets/body_part_lines.hpp>
#include <motionlang/datasets/described_motions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct PartAccuracy {
  std::array<double, sinc_part_count> of_parts{};  // 0 to 1
  Index items = 0;                                 // that were compared

  double mean() const { return std::accumulate(of_parts.begin(), of_parts.end(), 0.0) / sinc_part_count; }
};

/// Labels for which the labeller returns nothing are left out. Throws numeric_error 302 if a part counts in no item.
PartAccuracy part_accuracy(const BodyPartTruth& truth,
                           const std::function<std::optional<SincParts>(const std::string& label)>& labeller);

/// The answers as a labeller. An answer in free words is read by the lexicon.
std::function<std::optional<SincParts>(const std::string& label)> answered_parts(const BodyPartAnswers& answers);

/// The baseline of velocities: every motion of one label is an item, with the parts that move fast in it.
/// features  of the motions, with SMPL's joints
PartAccuracy velocity_part_accuracy(const BodyPartTruth& truth, const std::vector<DescribedMotion>& motions,
                                    const std::string& features, double threshold = 0.65);

/// A row of table B.1.
struct LabellerAccuracy {
  std::string labeller;
  PartAccuracy accuracy;
};
/// The rows: velocities and answers if these are given, and the lexicon.
/// motions  of `labelled_motions`
std::vector<LabellerAccuracy> labeller_accuracies(const BodyPartTruth& truth,
                                                  const std::vector<DescribedMotion>* motions,
                                                  const BodyPartAnswers* answers);
/// The table as text, below the number of labels.
std::string labellers_table(const BodyPartTruth& truth, std::span<const LabellerAccuracy> rows);

/// All motions of BABEL with single labels, for the row of velocities. Throws as read_babel_motions.
std::vector<DescribedMotion> labelled_motions(const BabelSources& sources, Progress progress);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/body_part_evaluation.ipp>
#endif
