// SPDX-License-Identifier: MIT
/// A language model's answers about body parts from a file: label -> answers, of which SINC takes the third.
///
///     {"wave right hand": ["", "", "Answer: right arm"], ...}
///
/// Source  SINC (Athanasiou et al., ICCV 2023); spec sinc.md 6.1. The published table is the user's to supply.
#pragma once

#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/file/json_members.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Throws io_error 401, 403 (JsonMembers), config_error 107 if there is no such answer, 103 if it names no part.
inline BodyPartTable read_body_part_table(const JsonMembers& file, Index answer = 2) {
  BodyPartTable table;
  for (const std::string& label : file.keys()) {
    const nlohmann::json answers = file.load(label);
    table.add(label, JsonView(answers, file.place(label))[answer].as<std::string>());
  }
  return table;
}
inline BodyPartTable open_body_part_table(const FilePath& path, Index answer = 2) {
  return read_body_part_table(JsonMembers::open(path), answer);
}

MOTIONLANG_NAMESPACE_END
