// SPDX-License-Identifier: MIT
/// The members of the object that a JSON file consists of, found without reading their values: a large file of many
/// entries opens quickly and stays on the disk, an entry is parsed when it is asked for.
///
///     const auto file = JsonMembers::open("annotations.json");
///     for (const std::string& id : file.keys()) use(file.load(id));
#pragma once

#include <memory>         // owner of the text
#include <unordered_map>  // places of the members

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class JsonMembers {
 public:
  /// Throws io_error 401; 403 if the file is not an object, if a name stands twice, and at the end of the file where
  /// something is not closed. Mistakes inside of a value show when it is loaded.
  static JsonMembers open(const FilePath& path) {
    const auto file = MappedFile::open(path);
    return JsonMembers(detail::as_text(file->bytes()), path.string(), file);
  }
  static JsonMembers from_text(std::string text, std::string name = "JSON") {
    const auto kept = std::make_shared<const std::string>(std::move(text));
    return JsonMembers(*kept, std::move(name), kept);
  }

  const std::string& name() const { return name_; }
  /// In the order of the file.
  const std::vector<std::string>& keys() const { return keys_; }
  bool has(const std::string& key) const { return parts_.contains(key); }
  /// Throws config_error 103 if there is no such member, io_error 403 with line and column if its value is malformed.
  nlohmann::json load(const std::string& key) const {
    const auto found = parts_.find(key);
    if (found == parts_.end()) raise<config_error>(103, name_, ": has no member '", key, "'");
    return detail::parse_json_part(text_, found->second.begin, found->second.size, name_);
  }
  /// Where a member stands, for the messages of a JsonView of it: "annotations.json: 00001".
  std::string place(const std::string& key) const { return name_ + ": " + key; }

 private:
  struct Part {
    std::size_t begin, size;
  };

  JsonMembers(std::string_view text, std::string name, std::shared_ptr<const void> owner)
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

  void add_member() {
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
      fail(start, concat_text("the name '", key, "' stands twice, first with the value at ",
                              detail::json_place(text_, first->second.begin)));
    keys_.push_back(key);
  }
  /// To the place behind a value: brackets are counted and strings stepped over. What stands between them is for the
  /// parser.
  void skip_value() {
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
  void skip_string() {
    const std::size_t end = detail::json_string_end(text_, at_);
    if (end == text_.npos) fail(at_, "a string has no end");
    at_ = end;
  }

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_blanks() {
    while (peek() == ' ' || peek() == '\t' || peek() == '\r' || peek() == '\n') ++at_;
  }
  bool accept(char c) {
    skip_blanks();
    return peek() == c && (++at_, true);
  }
  void expect(char c) {
    if (!accept(c)) fail(at_, concat_text("expected '", c, "'"));
  }
  [[noreturn]] void fail(std::size_t at, std::string_view what) const { detail::raise_json(text_, at, name_, what); }

  std::string_view text_;
  std::string name_;
  std::shared_ptr<const void> owner_;
  std::size_t at_ = 0;
  std::vector<std::string> keys_;
  std::unordered_map<std::string, Part> parts_;
};

MOTIONLANG_NAMESPACE_END
