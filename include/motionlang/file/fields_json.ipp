// SPDX-License-Identifier: MIT
// Bodies of fields_json.hpp.
#pragma once

#include <motionlang/file/fields_json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void require_known_members(const JsonView& view, const std::vector<std::string>& known) {
  for (const std::string& name : view.keys()) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string like = nearest_name(name, known);
    raise<config_error>(103, view.path(), ": has no member '", name, "'; ",
                        like.empty() ? "there are " + join_text(known) : "did you mean '" + like + "'?");
  }
}

MOTIONLANG_BODY nlohmann::json assignment_json(const std::string& assignment, const std::string& name) {
  const std::size_t equals = assignment.find('=');
  if (equals == assignment.npos) raise<config_error>(103, name, ": expected name=value");
  nlohmann::json value = nlohmann::json::parse(assignment.substr(equals + 1), nullptr, /*allow_exceptions=*/false);
  if (value.is_discarded()) value = assignment.substr(equals + 1);
  std::string path = assignment.substr(0, equals);
  for (std::size_t dot; (dot = path.rfind('.')) != path.npos; path.resize(dot))
    value = nlohmann::json::object({{path.substr(dot + 1), value}});
  return nlohmann::json::object({{path, value}});
}

MOTIONLANG_BODY std::map<std::string, std::string> leaf_texts(const nlohmann::ordered_json& document) {
  std::map<std::string, std::string> out;
  const auto flat = nlohmann::json(document).flatten();
  for (const auto& [pointer, value] : flat.items()) {
    std::string name = pointer.substr(1);
    std::replace(name.begin(), name.end(), '/', '.');
    out[name] = value.is_string() ? value.get<std::string>() : value.dump();
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
