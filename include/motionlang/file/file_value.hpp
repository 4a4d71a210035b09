// SPDX-License-Identifier: MIT
/// Single values of a file, flat: each with the keys that lead to it.
#pragma once

#include <cstdint>  // integers
#include <string>   // paths
#include <variant>  // values
#include <vector>   // lists

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A truth value, a number or a text, and the keys from the root of the file to it: "hyper_parameters/layers/0".
struct FileValue {
  std::string path;
  std::variant<bool, std::int64_t, double, std::string> value;
};
inline std::string to_string(const FileValue& v) {
  return std::visit([](const auto& value) { return concat_text(value); }, v.value);
}
/// The value at a path, or null.
inline const FileValue* find_value(const std::vector<FileValue>& values, std::string_view path) {
  for (const FileValue& v : values) {
    if (v.path == path) return &v;
  }
  return nullptr;
}

MOTIONLANG_NAMESPACE_END
