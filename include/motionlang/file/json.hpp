// SPDX-License-Identifier: MIT
/// JSON documents: reading with positions in the messages, and typed access that names the way to a wrong value. The
/// only header that includes nlohmann/json.hpp; it costs a translation unit 1.5 s, so include it in few.
///
///     const nlohmann::json document = read_json("config.json");
///     const JsonView config(document, "config.json");
///     const int width = config["model"]["latent_dim"].as<int>();
///     const double rate = config["optim"].value_or("lr", 1e-4);
#pragma once

#include <algorithm>    // count
#include <cmath>        // isfinite
#include <concepts>     // kinds of numbers
#include <map>          // objects of one kind
#include <string>       // texts
#include <string_view>  // names
#include <utility>      // in_range
#include <vector>       // lists

#include <nlohmann/json.hpp>

#include <motionlang/core/shape.hpp>
#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Deepest nesting that is read: what works on documents later recurses.
inline constexpr int max_json_depth = 256;

namespace detail {

/// Line and column of a byte of the text, "3:14".
inline std::string json_place(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const std::size_t line = before.rfind('\n') + 1;  // npos + 1 = 0
  return concat_text(std::count(before.begin(), before.end(), '\n') + 1, ":", before.size() - line + 1);
}
/// Throws io_error 403 with line and column of a byte of the text.
[[noreturn]] inline void raise_json(std::string_view text, std::size_t byte, std::string_view name,
                                    std::string_view what) {
  raise<io_error>(403, name, ":", json_place(text, byte), ": ", what);
}

/// Position behind the string that begins at a quote; npos if it has no end.
inline std::size_t json_string_end(std::string_view text, std::size_t quote) {
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
/// Throws io_error 403 for a name that stands twice in an object of the well-formed document in a part of the text.
inline void refuse_json_repetition(std::string_view text, std::size_t begin, std::size_t size, std::string_view name) {
  std::vector<std::map<std::string, std::size_t>> objects;  // around the place: names and where they are
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
                 concat_text("the name '", key, "' stands twice, first at ", json_place(text, first->second)));
  }
}

/// Reads the document in `size` bytes of a text from `begin` on; messages give the place in the whole text.
inline nlohmann::json parse_json_part(std::string_view text, std::size_t begin, std::size_t size,
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

/// Reads a document. `name` stands in messages. Throws io_error 403 with line and column, also where a name stands
/// twice in an object.
inline nlohmann::json parse_json(std::string_view text, std::string_view name = "JSON") {
  return detail::parse_json_part(text, 0, text.size(), name);
}

/// Reads a file. Throws io_error 401, 403.
inline nlohmann::json read_json(const FilePath& path) { return parse_json(read_file(path), path.string()); }

/// A value inside a document that lives elsewhere, together with the way to it: "config.json: model.layers[2].width".
/// Every access to a value of the wrong kind throws config_error 107 with that way.
class JsonView {
 public:
  explicit JsonView(const nlohmann::json& document, std::string name = "JSON")
      : value_(&document), path_(std::move(name)) {}
  JsonView(nlohmann::json&&, std::string = {}) = delete;  // a view does not keep its document

  const nlohmann::json& json() const { return *value_; }
  const std::string& path() const { return path_; }

  bool is_null() const { return value_->is_null(); }
  bool is_object() const { return value_->is_object(); }
  bool is_array() const { return value_->is_array(); }
  bool is_string() const { return value_->is_string(); }
  bool is_number() const { return value_->is_number(); }

  /// Whether this is an object with that member.
  bool contains(const std::string& key) const { return value_->is_object() && value_->contains(key); }
  JsonView operator[](const std::string& key) const {
    if (!value_->is_object()) fail("an object");
    const auto member = value_->find(key);
    if (member == value_->end()) raise<config_error>(107, path_, ": has no member '", key, "'");
    return {*member, path_ + (is_root_ ? ": " : ".") + key, Inner{}};
  }
  JsonView operator[](Index i) const {
    if (i < 0 || i >= size()) raise<config_error>(107, path_, ": no element ", i, " among ", size());
    return {(*value_)[static_cast<std::size_t>(i)], concat_text(path_, is_root_ ? ": [" : "[", i, "]"), Inner{}};
  }
  /// Number of elements of an array.
  Index size() const {
    if (!value_->is_array()) fail("an array");
    return static_cast<Index>(value_->size());
  }
  /// Names of the members of an object, sorted.
  std::vector<std::string> keys() const {
    if (!value_->is_object()) fail("an object");
    std::vector<std::string> out;
    for (const auto& member : value_->items()) out.push_back(member.key());
    return out;
  }

  /// bool, integers, float, double, std::string, and vectors and maps of these. A number with a fraction is no integer
  /// and an integer has to fit.
  template <class T>
  T as() const {
    T out{};
    get(out);
    return out;
  }
  /// The member `key` if it is there and not null, else `otherwise`.
  template <class T>
  T value_or(const std::string& key, T otherwise) const {
    return contains(key) && !(*value_)[key].is_null() ? (*this)[key].as<T>() : otherwise;
  }
  std::string value_or(const std::string& key, const char* otherwise) const {
    return value_or(key, std::string(otherwise));
  }

 private:
  struct Inner {};
  JsonView(const nlohmann::json& value, std::string path, Inner)
      : value_(&value), path_(std::move(path)), is_root_(false) {}

  [[noreturn]] void fail(std::string_view wanted) const {
    raise<config_error>(107, path_, ": expected ", wanted, ", found ", value_->type_name());
  }

  void get(bool& out) const {
    if (!value_->is_boolean()) fail("true or false");
    out = value_->get<bool>();
  }
  void get(std::string& out) const {
    if (!value_->is_string()) fail("a string");
    out = value_->get_ref<const std::string&>();
  }
  template <std::floating_point T>
  void get(T& out) const {
    if (!value_->is_number()) fail("a number");
    out = value_->get<T>();
  }
  template <std::integral T>
  void get(T& out) const {
    if (value_->is_number_float()) return get_whole(out);
    if (!value_->is_number_integer()) fail("an integer");
    const bool fits = value_->is_number_unsigned() ? std::in_range<T>(value_->get<std::uint64_t>())
                                                   : std::in_range<T>(value_->get<std::int64_t>());
    if (!fits) raise<config_error>(107, path_, ": ", value_->dump(), " is out of range");
    out = value_->get<T>();
  }
  /// 20.0 where 20 is due: Python writes such numbers.
  template <std::integral T>
  void get_whole(T& out) const {
    const auto number = value_->get<double>();
    if (!(std::abs(number) < 0x1p53) || number != std::trunc(number)) fail("an integer");
    if (!std::in_range<T>(static_cast<std::int64_t>(number))) fail("a smaller integer");
    out = static_cast<T>(number);
  }
  template <class T>
  void get(std::vector<T>& out) const {
    for (Index i = 0; i < size(); ++i) out.push_back((*this)[i].as<T>());
  }
  template <class T>
  void get(std::map<std::string, T>& out) const {
    for (const std::string& key : keys()) out[key] = (*this)[key].template as<T>();
  }

  const nlohmann::json* value_;
  std::string path_;
  bool is_root_ = true;
};

MOTIONLANG_NAMESPACE_END
