// SPDX-License-Identifier: MIT
// Bodies of error.hpp.
#pragma once

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string concat_parts(std::initializer_list<TextPart> parts) {
  std::string out;
  for (const TextPart& p : parts) p.append(out, p.value);
  return out;
}

MOTIONLANG_BODY std::string error_text(std::string_view family, int id, std::initializer_list<TextPart> parts) {
  std::string text = concat_text("[motionlang.", family, ".", id, "] ") + printable(concat_parts(parts), "\n");
#ifdef MOTIONLANG_DIAGNOSTICS
  const auto& path = ModulePath::names();
  for (std::size_t i = 0; i < path.size(); ++i) text += (i == 0 ? "; at " : ".") + path[i];
#endif
  return text;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
