// SPDX-License-Identifier: MIT
/// Questions and answers about body parts in files, and the table that is made of the answers.
///
///     {"label": "wave", "prompt": "Instructions: ..."}            a line for each question
///     {"label": "wave", "answer": "right arm"}                    a line for each answer
///     {"wave": ["", "", "right arm"], ...}                        the table, which datasets/body_part_table.hpp reads
///     wave <tab> 0 <tab> 0 <tab> 0 <tab> 1 <tab> 0 <tab> 0        what people say, in the order of sinc_part_names
///
/// In what people say, 0.5 stands for a part that may move or not; it does not count.
/// Source  thesis B.2.1, table B.1; SINC (Athanasiou et al., ICCV 2023)
#pragma once

#include <span>         // labels
#include <string>       // answers
#include <string_view>  // texts
#include <utility>      // answers
#include <vector>       // answers

#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/compose/body_part_prompts.hpp>
#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Answers in order: a label, and what the model said.
using BodyPartAnswers = std::vector<std::pair<std::string, std::string>>;

/// A line of JSON for each label.
std::string body_part_questions(std::span<const std::string> labels, BodyPartPrompt form);
/// Throws io_error 403 for a line that is not JSON, config_error 107 if it lacks a text for label or answer.
BodyPartAnswers parse_body_part_answers(std::string_view text, std::string_view name = "answers");
/// Answers in the lines above or in a table of SINC's form, by what the file holds. Throws io_error 401, 403,
/// config_error 107.
BodyPartAnswers read_body_part_answers(const FilePath& path);
/// The labels without an answer that names a part, in their order.
std::vector<std::string> unanswered_labels(std::span<const std::string> labels, const BodyPartAnswers& answers);
/// The table as SINC has it. A label with several answers gets the last one.
std::string body_part_table_text(const BodyPartAnswers& answers);

/// The parts that people name for labels, (labels, 6).
struct BodyPartTruth {
  std::vector<std::string> labels;
  std::vector<double> wanted;
};
/// Lines that begin with # are comments. Throws io_error 403 with the line for other fields than a label and six of 0,
/// 0.5 and 1.
BodyPartTruth parse_body_part_truth(std::string_view text, std::string_view name = "truth");

/// The labels on the lines of a text, sorted, without empty lines.
std::vector<std::string> parse_label_list(std::string_view text);
/// Labels of BABEL as train-sinc takes them: those of segments and, without segments, of whole sequences; sorted. No
/// motion is read.
std::vector<std::string> babel_labels(const FilePath& babel, const FilePath& spelling = "");

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/body_part_lines.ipp>
#endif
