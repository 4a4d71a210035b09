// SPDX-License-Identifier: MIT
/// The text of a JSON document that may hold what people and files wrote.
#pragma once

#include <string>  // text

#include <motionlang/file/json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// In one line, or in lines with this indent. Bytes that are not UTF-8 are replaced; nothing is thrown.
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
