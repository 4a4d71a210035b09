// SPDX-License-Identifier: MIT
// Bodies of json_members.hpp.
#pragma once

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/json_members.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY JsonMembers JsonMembers::open(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return JsonMembers(detail::as_text(file->bytes()), path.string(), file);
}

MOTIONLANG_BODY JsonMembers JsonMembers::from_text(std::string text, std::string name) {
  const auto kept = std::make_shared<const std::string>(std::move(text));
  return JsonMembers(*kept, std::move(name), kept);
}

MOTIONLANG_BODY const JsonMembers::Part& JsonMembers::part(const std::string& key) const {
  const auto found = parts_.find(key);
  if (found == parts_.end()) raise<config_error>(103, name_, ": has no member '", key, "'");
  return found->second;
}

MOTIONLANG_BODY nlohmann::json JsonMembers::load(const std::string& key) const {
  const Part& p = part(key);
  return detail::parse_json_part(text_, p.begin, p.size, name_);
}

MOTIONLANG_BODY JsonMembers JsonMembers::members(const std::string& key) const {
  const Part& p = part(key);
  return JsonMembers(text_.substr(p.begin, p.size), place(key), owner_);
}

MOTIONLANG_BODY JsonMembers::JsonMembers(std::string_view text, std::string name, std::shared_ptr<const void> owner)
    : text_(text), name_(std::move(name)), owner_(std::move(owner)) {
  if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // byte order mark
  expect('{');
  if (!accept('}')) {
    do add_member();
    while (accept(','));
    expect('}');
  }
  skip_blanks();
  if (at_ != text_.size()) fail(at_, "something follows the object");
}

MOTIONLANG_BODY void JsonMembers::add_member() {
  skip_blanks();
  const std::size_t start = at_;
  if (peek() != '"') fail(at_, "expected a name in quotes");
  skip_string();
  const auto key = detail::parse_json_part(text_, start, at_ - start, name_).get<std::string>();
  expect(':');
  skip_blanks();
  const std::size_t value = at_;
  skip_value();
  if (at_ == value) fail(at_, "expected a value");
  const auto [first, is_new] = parts_.emplace(key, Part{value, at_ - value});
  if (!is_new)
    fail(start, concat_text("the name '", key, "' is duplicated, first with the value at ",
                            detail::json_place(text_, first->second.begin)));
  keys_.push_back(key);
}

MOTIONLANG_BODY void JsonMembers::skip_value() {
  if (peek() != '{' && peek() != '[' && peek() != '"') {
    at_ = std::min(text_.find_first_of(",:{}[]\" \t\r\n", at_), text_.size());
    return;
  }
  int depth = 0;
  do {
    const char c = peek();
    if (at_ == text_.size()) fail(at_, "the text ends inside of a value");
    if (c == '"') {
      skip_string();
    } else {
      depth += (c == '{' || c == '[') - (c == '}' || c == ']');
      ++at_;
    }
  } while (depth > 0);
}

MOTIONLANG_BODY void JsonMembers::skip_string() {
  const std::size_t end = detail::json_string_end(text_, at_);
  if (end == text_.npos) fail(at_, "a string has no end");
  at_ = end;
}

MOTIONLANG_BODY void JsonMembers::skip_blanks() {
  while (peek() == ' ' || peek() == '\t' || peek() == '\r' || peek() == '\n') ++at_;
}

MOTIONLANG_BODY bool JsonMembers::accept(char c) {
  skip_blanks();
  return peek() == c && (++at_, true);
}

MOTIONLANG_BODY void JsonMembers::expect(char c) {
  if (!accept(c)) fail(at_, concat_text("expected '", c, "'"));
}

MOTIONLANG_NAMESPACE_END
