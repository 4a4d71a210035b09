// SPDX-License-Identifier: MIT
/// Answers of a language model to the question which body parts an action moves, as the parts of SINC; and a table
/// of such answers. Read from a file by datasets/body_part_table.hpp; without a table, body_part_lexicon.hpp guesses.
///
///     parse_body_part_answer("Answer: right leg\nleft leg\nbuttocks")   // global, left leg, right leg
///
/// Source   thesis B.2.1; SINC (Athanasiou et al., ICCV 2023) sinc/tools/frank.py text_list_to_bp
/// Differs  from the code: each line is stripped, so that "- waist" is one; "left shoulder" is understood
#pragma once

#include <string>         // answers
#include <string_view>    // answers
#include <unordered_map>  // parts of labels
#include <vector>         // labels

#include <motionlang/kinematics/sinc_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One part per line; those of the face, wrists and hands say nothing; shoulders are arms, buttocks and waist the
/// pelvis, the neck is the torso. Throws config_error 103 for a name that is not one, and if no part is named.
SincParts parse_body_part_answer(std::string_view answer);

/// Parts of actions by their labels. The order of the labels is that of the file: lists of partners follow it.
class BodyPartTable {
 public:
  /// The last one counts if a label is added again. Throws config_error 103.
  void add(const std::string& label, std::string_view answer);

  const std::vector<std::string>& labels() const { return labels_; }
  /// Throws config_error 103 if the label is not in the table.
  const SincParts& parts(const std::string& label) const;

 private:
  std::vector<std::string> labels_;
  std::unordered_map<std::string, SincParts> parts_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/body_part_answers.ipp>
#endif
