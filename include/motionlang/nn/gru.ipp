// SPDX-License-Identifier: MIT
// Bodies of gru.hpp.
#pragma once

#include <motionlang/nn/gru.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string gru_key(const std::string& path, std::string_view name) {
  const std::string nested = concat_text(name, ".layers.");
  const auto at = path.find(nested);
  if (at == path.npos || (at > 0 && path[at - 1] != '.')) return path;
  const auto number = at + nested.size(), dot = path.find('.', number);
  return concat_text(path.substr(0, at), name, path.substr(dot), "_l", path.substr(number, dot - number));
}

MOTIONLANG_NAMESPACE_END
