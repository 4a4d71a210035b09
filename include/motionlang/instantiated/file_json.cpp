// SPDX-License-Identifier: MIT
// Bodies of the headers in file/ that need nlohmann_json, compiled once for motionlang::instantiated.
#include <motionlang/file/fields_json.ipp>
#include <motionlang/file/json.ipp>
#include <motionlang/file/json_members.ipp>
#include <motionlang/file/options_file.ipp>
