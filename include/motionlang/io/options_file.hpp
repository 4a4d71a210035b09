// SPDX-License-Identifier: MIT
/// Options of a training run, flat: config.json, args.json (JSON), opt.yaml, config.yaml (YAML).
///
///     const auto options = read_options("run/opt.yaml");
///     const FileValue* width = find_value(options, "model/latent_dim");
///
/// Of YAML the part that programs write: nested mappings and lists by indentation, plain and quoted texts, numbers, flat lists in
/// brackets, tags (which are ignored). No texts of several lines, no references.
#pragma once

#include <charconv>  // numbers
#include <optional>  // a key without its value

#include <motionlang/io/file_value.hpp>
#include <motionlang/io/json.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

inline std::string below(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : concat_text(path, "/", key);
}

class YamlReader {
 public:
  YamlReader(std::string_view text, std::string_view file) : file_(file) {
    levels_.push_back({0, "", false, 0});
    while (!text.empty()) {
      ++line_;
      const std::size_t end = std::min(text.find('\n'), text.size());
      read_line(without_comment(text.substr(0, end)));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }
  std::vector<FileValue> values;

 private:
  static constexpr std::size_t deepest = 64;
  struct Level {
    std::size_t indent;
    std::string path;
    bool list;
    std::size_t items;
  };
  struct Pending {  // a key whose value follows on the next lines
    std::size_t indent;
    std::string path;
  };

  [[noreturn]] void fail(int id, std::string_view what) const { raise<io_error>(id, file_, ":", line_, ": ", what); }

  static std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \r"), last = text.find_last_not_of(" \r");
    return first == text.npos ? std::string_view() : text.substr(first, last - first + 1);
  }
  static std::string_view without_comment(std::string_view line) {
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (quote != 0) {
        if (line[i] == quote) quote = 0;
      } else if ((line[i] == '"' || line[i] == '\'') && (i == 0 || line[i - 1] == ' ')) {
        quote = line[i];
      } else if (line[i] == '#' && (i == 0 || line[i - 1] == ' ')) {
        return line.substr(0, i);
      }
    }
    return line;
  }

  void read_line(std::string_view line) {
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const std::string_view text = trimmed(line);
    if (text.empty() || text == "---" || text == "...") return;
    if (text[0] == '\t') fail(403, "a tab as indentation");
    const bool item = is_item(text);
    if (pending_) {
      const bool inside = indent > pending_->indent || (item && indent == pending_->indent);
      if (inside) levels_.push_back({indent, pending_->path, item, 0});
      pending_.reset();
      if (levels_.size() > deepest) fail(405, "nested too deeply");
    }
    while (levels_.size() > 1 &&
           (levels_.back().indent > indent || (levels_.back().indent == indent && levels_.back().list && !item))) {
      levels_.pop_back();
    }
    if (levels_.size() == 1 && item && values.empty()) levels_.back().list = true;
    if (levels_.back().indent != indent || levels_.back().list != item)
      fail(403, "indentation that fits no line above");
    item ? read_item(text, indent) : read_key(text, indent);
  }
  static bool is_item(std::string_view text) { return text == "-" || text.starts_with("- "); }

  void read_item(std::string_view text, std::size_t indent) {
    Level& list = levels_.back();
    const std::string path = below(list.path, concat_text(list.items++));
    const std::string_view rest = trimmed(text.substr(1));
    const std::size_t inner = indent + static_cast<std::size_t>(rest.data() - text.data());
    if (rest.empty()) {
      pending_ = Pending{indent, path};
    } else if (is_item(rest) || key_end(rest) != rest.npos) {
      levels_.push_back({inner, path, is_item(rest), 0});
      if (levels_.size() > deepest) fail(405, "nested too deeply");
      is_item(rest) ? read_item(rest, inner) : read_key(rest, inner);
    } else {
      read_value(path, rest, indent);
    }
  }
  /// Position of the colon behind a key.
  static std::size_t key_end(std::string_view text) {
    std::size_t from = 0;
    if (text[0] == '"' || text[0] == '\'') from = std::min(text.find(text[0], 1), text.size());
    for (std::size_t at = text.find(':', from); at != text.npos; at = text.find(':', at + 1)) {
      if (at + 1 == text.size() || text[at + 1] == ' ') return at;
    }
    return text.npos;
  }
  void read_key(std::string_view text, std::size_t indent) {
    const std::size_t colon = key_end(text);
    if (colon == text.npos) fail(403, "a key with a colon expected");
    read_value(below(levels_.back().path, unquoted(trimmed(text.substr(0, colon)))), trimmed(text.substr(colon + 1)),
               indent);
  }

  void read_value(const std::string& path, std::string_view text, std::size_t indent) {
    if (text.starts_with('!') || text.starts_with('&'))
      text = trimmed(text.substr(std::min(text.find(' '), text.size())));
    if (text.empty()) {
      pending_ = Pending{indent, path};
    } else if (text[0] == '|' || text[0] == '>' || text[0] == '*') {
      fail(404, "texts of several lines and references are not read");
    } else if (text[0] == '[' && text.back() == ']') {
      text = text.substr(1, text.size() - 2);
      for (std::size_t i = 0; !trimmed(text).empty(); ++i) {
        const std::size_t comma = std::min(text.find(','), text.size());
        const std::string_view element = trimmed(text.substr(0, comma));
        if (element.starts_with('[') || element.starts_with('{')) fail(404, "brackets in brackets are not read");
        add(below(path, concat_text(i)), element);
        text.remove_prefix(std::min(comma + 1, text.size()));
      }
    } else {
      add(path, text);
    }
  }
  static std::string_view unquoted(std::string_view text) {
    const bool quoted =
        text.size() >= 2 && text.front() == text.back() && (text.front() == '"' || text.front() == '\'');
    return quoted ? text.substr(1, text.size() - 2) : text;
  }
  void add(const std::string& path, std::string_view text) {
    if (text == "null" || text == "~" || text == "{}") return;
    if (text == "true" || text == "false") return values.push_back({path, text == "true"});
    const char* const end = text.data() + text.size();
    std::int64_t integer = 0;
    if (std::from_chars(text.data(), end, integer).ptr == end) return values.push_back({path, integer});
    double real = 0;
    const bool number = text.find_first_not_of("0123456789+-.eE") == text.npos;
    if (number && std::from_chars(text.data(), end, real).ptr == end) return values.push_back({path, real});
    values.push_back({path, std::string(unquoted(text))});
  }

  std::string_view file_;
  std::size_t line_ = 0;
  std::vector<Level> levels_;
  std::optional<Pending> pending_;
};

inline void add_json_values(const nlohmann::json& value, const std::string& path, std::vector<FileValue>& out) {
  if (value.is_boolean()) out.push_back({path, value.get<bool>()});
  if (value.is_number_integer()) out.push_back({path, value.get<std::int64_t>()});
  if (value.is_number_float()) out.push_back({path, value.get<double>()});
  if (value.is_string()) out.push_back({path, value.get<std::string>()});
  if (!value.is_structured()) return;
  for (const auto& member : value.items()) add_json_values(member.value(), below(path, member.key()), out);
}

}  // namespace detail

/// The values of a text, JSON if it begins with a brace. `name` stands in messages.
/// Throws  io_error 403 with the line if it is malformed, 404 for YAML that is not read
inline std::vector<FileValue> parse_options(std::string_view text, std::string_view name) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == text.npos || text[first] != '{') return detail::YamlReader(text, name).values;
  std::vector<FileValue> out;
  detail::add_json_values(parse_json(text, name), "", out);
  return out;
}
/// Throws io_error 401, and as above.
inline std::vector<FileValue> read_options(const FilePath& path) {
  return parse_options(read_file(path), path.string());
}

}  // namespace motionlang::inline MOTIONLANG_ABI
