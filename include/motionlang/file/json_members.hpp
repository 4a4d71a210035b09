// SPDX-License-Identifier: MIT
/// The members of a JSON file that is one object, found without reading their values. A large file of many entries
/// opens quickly and stays on the disk. An entry is parsed when it is requested.
///
///     const auto file = JsonMembers::open("annotations.json");
///     for (const std::string& id : file.keys()) use(file.load(id));
#pragma once

#include <memory>         // owner of the text
#include <string>         // names
#include <string_view>    // text
#include <unordered_map>  // places of the members
#include <vector>         // names

#include <motionlang/file/json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class JsonMembers {
 public:
  /// Throws io_error 401, and 403 if the file is not an object, if a name is duplicated, or if something is not closed
  /// at the end. Mistakes inside a value show when it is loaded.
  static JsonMembers open(const FilePath& path);
  static JsonMembers from_text(std::string text, std::string name = "JSON");

  const std::string& name() const { return name_; }
  /// In the order of the file.
  const std::vector<std::string>& keys() const { return keys_; }
  bool has(const std::string& key) const { return parts_.contains(key); }
  /// Throws config_error 103 if there is no such member, io_error 403 with line and column if its value is malformed.
  nlohmann::json load(const std::string& key) const;
  /// The members of a member that is an object itself. Throws what load and open throw.
  JsonMembers members(const std::string& key) const;
  /// The place of a member, for the messages of its JsonView: "annotations.json: 00001".
  std::string place(const std::string& key) const { return name_ + ": " + key; }

 private:
  struct Part {
    std::size_t begin, size;
  };

  JsonMembers(std::string_view text, std::string name, std::shared_ptr<const void> owner);
  const Part& part(const std::string& key) const;

  void add_member();
  /// Moves past a value: counts brackets and skips strings. The parser checks everything between them.
  void skip_value();
  void skip_string();

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_blanks();
  bool accept(char c);
  void expect(char c);
  [[noreturn]] void fail(std::size_t at, std::string_view what) const { detail::raise_json(text_, at, name_, what); }

  std::string_view text_;
  std::string name_;
  std::shared_ptr<const void> owner_;
  std::size_t at_ = 0;
  std::vector<std::string> keys_;
  std::unordered_map<std::string, Part> parts_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/json_members.ipp>
#endif
