// SPDX-License-Identifier: MIT
/// The single values of a file in a flat list, each with its keys.
#pragma once

#include <cstdint>      // integers
#include <string>       // paths
#include <string_view>  // paths
#include <variant>      // values
#include <vector>       // lists

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A truth value, a number or a text, with the keys from the root of the file: "hyper_parameters/layers/0".
struct FileValue {
  std::string path;
  std::variant<bool, std::int64_t, double, std::string> value;
};
std::string to_string(const FileValue& v);
/// The value at a path, or null.
const FileValue* find_value(const std::vector<FileValue>& values, std::string_view path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/file_value.ipp>
#endif
