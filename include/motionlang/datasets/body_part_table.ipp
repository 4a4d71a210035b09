// SPDX-License-Identifier: MIT
// Bodies of body_part_table.hpp.
#pragma once

#include <motionlang/datasets/body_part_table.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/file/json_members.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY BodyPartTable read_body_part_table(const JsonMembers& file, Index answer) {
  BodyPartTable table;
  for (const std::string& label : file.keys()) {
    const nlohmann::json answers = file.load(label);
    table.add(label, JsonView(answers, file.place(label))[answer].as<std::string>());
  }
  return table;
}

MOTIONLANG_BODY BodyPartTable open_body_part_table(const FilePath& path, Index answer) {
  return read_body_part_table(JsonMembers::open(path), answer);
}

MOTIONLANG_NAMESPACE_END
