// SPDX-License-Identifier: MIT
// Bodies of file_value.hpp.
#pragma once

#include <motionlang/core/error.hpp>
#include <motionlang/file/file_value.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string to_string(const FileValue& v) {
  return std::visit([](const auto& value) { return concat_text(value); }, v.value);
}

MOTIONLANG_BODY const FileValue* find_value(const std::vector<FileValue>& values, std::string_view path) {
  for (const FileValue& v : values) {
    if (v.path == path) return &v;
  }
  return nullptr;
}

MOTIONLANG_NAMESPACE_END
