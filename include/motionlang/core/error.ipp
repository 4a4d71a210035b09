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

MOTIONLANG_BODY std::string ModulePath::text() {
  std::string path;
  const ModuleStep* around = nullptr;
  for (const ModuleStep& step : steps()) {
    std::string name = step.name;
    if (step.module != nullptr) {
      if (around != nullptr) name = around->path_to(around->module, step.module, step.type);
      around = &step;
    }
    if (!path.empty() && !name.empty()) path += '.';
    path += name;
  }
  return path;
}

MOTIONLANG_BODY std::string error_text(std::string_view family, int id, std::initializer_list<TextPart> parts) {
  std::string text = concat_text("[motionlang.", family, ".", id, "] ") + printable(concat_parts(parts), "\n");
#ifdef MOTIONLANG_DIAGNOSTICS
  const std::string path = ModulePath::text();
  if (!path.empty()) text += "; at " + path;
#endif
  return text;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
