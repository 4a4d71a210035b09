// SPDX-License-Identifier: MIT
/// JSON documents: reading with positions in messages, and typed access that names the path to a wrong value. This is
/// the only header that includes nlohmann/json.hpp. That adds 1.5 s to a translation unit, so include it in few.
///
///     const nlohmann::json document = read_json("config.json");
///     const JsonView config(document, "config.json");
///     const int width = config["model"]["latent_dim"].as<int>();
///     const double rate = config["optim"].value_or("lr", 1e-4);
#pragma once

#include <cmath>        // trunc
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

/// The deepest nesting that is read, because work on documents is recursive.
inline constexpr int max_json_depth = 256;

namespace detail {

/// Line and column of a byte of the text, "3:14".
std::string json_place(std::string_view text, std::size_t byte);
/// Throws io_error 403 with line and column of a byte of the text.
[[noreturn]] void raise_json(std::string_view text, std::size_t byte, std::string_view name, std::string_view what);

/// The position after the string that begins at a quote; npos if it has no end.
std::size_t json_string_end(std::string_view text, std::size_t quote);

/// Reads the document in `size` bytes of a text, starting at `begin`. Messages give the place in the whole text.
nlohmann::json parse_json_part(std::string_view text, std::size_t begin, std::size_t size, std::string_view name);

}  // namespace detail

/// Reads a document. Messages contain `name`. Throws io_error 403 with line and column, also for a duplicate name in an
/// object.
nlohmann::json parse_json(std::string_view text, std::string_view name = "JSON");

/// Reads a file. Throws io_error 401, 403.
nlohmann::json read_json(const FilePath& path);

/// A value inside a document that lives elsewhere, with the path to it: "config.json: model.layers[2].width". Every
/// access to a value of the wrong kind throws config_error 107 with that path.
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

  /// True if this is an object with that member.
  bool contains(const std::string& key) const;
  JsonView operator[](const std::string& key) const;
  JsonView operator[](Index i) const;
  /// Number of elements of an array.
  Index size() const;
  /// Names of the members of an object, sorted.
  std::vector<std::string> keys() const;

  /// Reads bool, integers, float, double, std::string, and vectors and maps of these. A number with a fraction is not
  /// an integer, and an integer must fit.
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
  std::string value_or(const std::string& key, const char* otherwise) const;

 private:
  struct Inner {};
  JsonView(const nlohmann::json& value, std::string path, Inner)
      : value_(&value), path_(std::move(path)), is_root_(false) {}

  [[noreturn]] void fail(std::string_view wanted) const;

  void get(bool& out) const;
  void get(std::string& out) const;
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
  /// Reads 20.0 as an integer, because Python writes such numbers.
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

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/json.ipp>
#endif
