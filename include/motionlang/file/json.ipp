// SPDX-License-Identifier: MIT
// Bodies of json.hpp.
#pragma once

#include <algorithm>  // count

#include <motionlang/file/json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string json_place(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const std::size_t line = before.rfind('\n') + 1;  // npos + 1 = 0
  return concat_text(std::count(before.begin(), before.end(), '\n') + 1, ":", before.size() - line + 1);
}

MOTIONLANG_BODY void raise_json(std::string_view text, std::size_t byte, std::string_view name, std::string_view what) {
  raise<io_error>(403, name, ":", json_place(text, byte), ": ", what);
}

MOTIONLANG_BODY std::size_t json_string_end(std::string_view text, std::size_t quote) {
  std::size_t at = quote + 1;
  while (at < text.size() && text[at] != '"') at += text[at] == '\\' ? 2 : 1;
  return at < text.size() ? at + 1 : text.npos;
}

/// Number of members of all objects in a document.
inline std::size_t json_members(const nlohmann::json& document) {
  std::size_t count = document.is_object() ? document.size() : 0;
  if (document.is_structured()) {
    for (const auto& value : document) count += json_members(value);
  }
  return count;
}

/// Throws io_error 403 for a name that is duplicated in an object of the well-formed document in a part of the text.
inline void refuse_json_repetition(std::string_view text, std::size_t begin, std::size_t size, std::string_view name) {
  std::vector<std::map<std::string, std::size_t>> objects;  // around the place, with their names
  const std::size_t end = begin + size;
  for (std::size_t at = begin; at < end;) {
    const std::size_t start = at++;
    if (text[start] == '{') objects.emplace_back();
    if (text[start] == '}') objects.pop_back();
    if (text[start] != '"') continue;
    at = json_string_end(text, start);
    const std::size_t next = text.find_first_not_of(" \t\r\n", at);
    if (next >= end || text[next] != ':') continue;  // a value
    const std::string key = nlohmann::json::parse(text.substr(start, at - start)).get<std::string>();
    const auto [first, is_new] = objects.back().emplace(key, start);
    if (!is_new)
      raise_json(text, start, name,
                 concat_text("the name '", key, "' is duplicated, first at ", json_place(text, first->second)));
  }
}

MOTIONLANG_BODY nlohmann::json parse_json_part(std::string_view text, std::size_t begin, std::size_t size,
                                               std::string_view name) {
  const std::string_view part = text.substr(begin, size);
  std::size_t names = 0;
  const auto shallow = [&](int depth, nlohmann::json::parse_event_t event, const nlohmann::json&) {
    names += event == nlohmann::json::parse_event_t::key;
    if (depth > max_json_depth) raise<io_error>(403, name, ": nested deeper than ", max_json_depth, " levels");
    return true;
  };
  const auto malformed = [&](const nlohmann::json::parse_error& e) -> bool {
    const std::string_view message = e.what();
    const std::size_t detail = message.find(": ");  // behind id and position
    raise_json(text, begin + (e.byte == 0 ? 0 : e.byte - 1), name,
               detail == message.npos ? message : message.substr(detail + 2));
  };
  const auto too_large = [&](const nlohmann::json::out_of_range& e) -> bool {  // ... parsing '1e999'
    const std::string_view message = e.what();
    const std::size_t number = message.find('\'') + 1;
    const std::size_t at = part.find(message.substr(number, message.rfind('\'') - number));
    raise_json(text, begin + std::min(at, size), name, "a number beyond the range of double");
  };
  nlohmann::json document;
  const auto parse = [&] { document = nlohmann::json::parse(part, shallow, has_exceptions); };
  guard<nlohmann::json::parse_error>([&] { guard<nlohmann::json::out_of_range>(parse, too_large); }, malformed);
  if (document.is_discarded())
    raise_json(text, begin, name, "not JSON, or a number beyond the range of double");  // no exceptions
  if (names != json_members(document)) refuse_json_repetition(text, begin, size, name);
  return document;
}

}  // namespace detail

MOTIONLANG_BODY nlohmann::json parse_json(std::string_view text, std::string_view name) {
  return detail::parse_json_part(text, 0, text.size(), name);
}

MOTIONLANG_BODY nlohmann::json read_json(const FilePath& path) { return parse_json(read_file(path), path.string()); }

MOTIONLANG_BODY bool JsonView::contains(const std::string& key) const {
  return value_->is_object() && value_->contains(key);
}

MOTIONLANG_BODY JsonView JsonView::operator[](const std::string& key) const {
  if (!value_->is_object()) fail("an object");
  const auto member = value_->find(key);
  if (member == value_->end()) raise<config_error>(107, path_, ": has no member '", key, "'");
  return {*member, path_ + (is_root_ ? ": " : ".") + key, Inner{}};
}

MOTIONLANG_BODY JsonView JsonView::operator[](Index i) const {
  if (i < 0 || i >= size()) raise<config_error>(107, path_, ": no element ", i, " among ", size());
  return {(*value_)[static_cast<std::size_t>(i)], concat_text(path_, is_root_ ? ": [" : "[", i, "]"), Inner{}};
}

MOTIONLANG_BODY Index JsonView::size() const {
  if (!value_->is_array()) fail("an array");
  return static_cast<Index>(value_->size());
}

MOTIONLANG_BODY std::vector<std::string> JsonView::keys() const {
  if (!value_->is_object()) fail("an object");
  std::vector<std::string> out;
  for (const auto& member : value_->items()) out.push_back(member.key());
  return out;
}

MOTIONLANG_BODY std::string JsonView::value_or(const std::string& key, const char* otherwise) const {
  return value_or(key, std::string(otherwise));
}

MOTIONLANG_BODY void JsonView::fail(std::string_view wanted) const {
  raise<config_error>(107, path_, ": expected ", wanted, ", found ", value_->type_name());
}

MOTIONLANG_BODY void JsonView::get(bool& out) const {
  if (!value_->is_boolean()) fail("true or false");
  out = value_->get<bool>();
}

MOTIONLANG_BODY void JsonView::get(std::string& out) const {
  if (!value_->is_string()) fail("a string");
  out = value_->get_ref<const std::string&>();
}

MOTIONLANG_NAMESPACE_END
