// SPDX-License-Identifier: MIT
/// Answers of a language model to the question which body parts an action moves, and a table of such answers. The parts
/// are those of SINC. datasets/body_part_table.hpp reads a table from a file. Without one, body_part_lexicon.hpp
/// guesses.
///
///     parse_body_part_answer("Answer: right leg\nleft leg\nbuttocks")   // global, left leg, right leg
///
/// Source   thesis B.2.1; SINC (Athanasiou et al., ICCV 2023) sinc/tools/frank.py text_list_to_bp
/// Differs  from the code: each line is stripped, so that "- waist" is one; "left shoulder" is understood
#pragma once

#include <optional>       // unknown parts
#include <string>         // answers
#include <string_view>    // answers
#include <unordered_map>  // parts of labels
#include <vector>         // labels

#include <motionlang/kinematics/sinc_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The parts of an answer; nothing if a line is not a part, or if no part is named.
std::optional<SincParts> known_body_part_answer(std::string_view answer);
/// One part per line. Lines about the face, wrists and hands are ignored. Shoulders count as arms, buttocks and waist
/// as the pelvis, and the neck as the torso. Throws config_error 103 for an unknown name, and if no part is named.
SincParts parse_body_part_answer(std::string_view answer);

/// Parts of actions by their labels. The order of the labels is that of the file: lists of partners follow it.
class BodyPartTable {
 public:
  /// If a label is added again, the last one counts. Throws config_error 103.
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
