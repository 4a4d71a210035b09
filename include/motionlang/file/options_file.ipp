// SPDX-License-Identifier: MIT
// Bodies of options_file.hpp.
#pragma once

#include <algorithm>  // replace
#include <map>        // lines of keys
#include <optional>   // a key without its value

#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/file/options_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string below(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : concat_text(path, "/", key);
}

/// Collects values. A text of options is small; it is refused if it is large, or if its paths or values take much
/// memory.
class OptionValues {
 public:
  OptionValues(std::string_view text, std::string_view file) : file_(file) {
    if (text.size() > most_text)
      raise<io_error>(405, file_, ": ", counted(text.size(), "byte"), " of options, at most ", most_text);
  }
  template <class T>
  void add(const std::string& path, T value) {
    spend(path);
    values_.push_back({path, std::move(value)});
  }
  /// Throws io_error 403 if the key at the end of the path was in an earlier line.
  void add_key(const std::string& path, std::size_t line) {
    spend(path);
    const auto [first, is_new] = lines_.emplace(path, line);
    if (!is_new) raise<io_error>(403, file_, ":", line, ": '", path, "' is duplicated, first in line ", first->second);
  }
  /// Converts a plain or quoted text to its value; nothing if it means that there is no value.
  void add_text(const std::string& path, std::string_view text);
  /// Appends to the last text. True if it was a text.
  bool append_to_last(std::string_view text);

  bool empty() const { return values_.empty(); }
  std::vector<FileValue> take() { return std::move(values_); }

 private:
  static constexpr std::size_t most_text = std::size_t{1} << 20;
  void spend(const std::string& path) {
    const std::size_t cost = 3 * sizeof(FileValue) + path.size();
    if (cost > left_) raise<io_error>(405, file_, ": more options than a file of options has");
    left_ -= cost;
  }
  std::string_view file_;
  std::map<std::string, std::size_t> lines_;  // of keys
  std::vector<FileValue> values_;
  std::size_t left_ = std::size_t{24} << 20;  // bytes
};

inline bool is_quoted(std::string_view text) {
  return text.size() >= 2 && text.front() == text.back() && (text.front() == '"' || text.front() == '\'');
}

/// The text between the quotes: '' is one quote in the single kind, a backslash takes the next character in the
/// double kind.
inline std::string unquoted(std::string_view text) {
  const char quote = text.front();
  text = text.substr(1, text.size() - 2);
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == (quote == '"' ? '\\' : '\'') && i + 1 < text.size();
    if (!escape) {
      out += text[i];
      continue;
    }
    const char c = text[++i];
    out += quote == '"' && c == 'n' ? '\n' : quote == '"' && c == 't' ? '\t' : c;
  }
  return out;
}

inline void OptionValues::add_text(const std::string& path, std::string_view text) {
  if (text == "null" || text == "~" || text == "{}") return;
  if (text == "true" || text == "false") return add(path, text == "true");
  const char* const end = text.data() + text.size();
  const auto all_of_it = [&](const std::from_chars_result& r) { return r.ec == std::errc{} && r.ptr == end; };
  std::int64_t integer = 0;
  const auto whole = detail::from_chars(text.data(), end, integer);
  if (!text.empty() && all_of_it(whole)) return add(path, integer);
  if (whole.ec == std::errc::result_out_of_range && whole.ptr == end) return add(path, std::string(text));
  double real = 0;
  const bool number = !text.empty() && text.find_first_not_of("0123456789+-.eE") == text.npos;
  if (number && all_of_it(detail::from_chars(text.data(), end, real))) return add(path, real);
  add(path, is_quoted(text) ? unquoted(text) : std::string(text));
}

inline bool OptionValues::append_to_last(std::string_view text) {
  std::string* last = values_.empty() ? nullptr : std::get_if<std::string>(&values_.back().value);
  if (last == nullptr) return false;
  last->append(" ").append(text);
  if (is_quoted(*last)) *last = unquoted(*last);
  return true;
}

class YamlReader {
 public:
  YamlReader(std::string_view text, std::string_view file) : values(text, file), file_(file) {
    levels_.push_back({0, "", false, 0});
    while (!text.empty()) {
      ++line_;
      const std::size_t end = std::min(text.find('\n'), text.size());
      read_line(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }
  OptionValues values;

 private:
  static constexpr std::size_t deepest = 64;
  struct Level {
    std::size_t indent;
    std::string path;
    bool list;
    std::size_t items;
  };
  struct Folded {  // a text that may continue in the next line: programs fold long ones
    std::size_t indent;
    char quote;  // in which it is still; else 0
  };
  struct Pending {  // a key whose value follows on the next lines
    std::size_t indent;
    std::string path;
  };

  [[noreturn]] void fail(int id, std::string_view what) const { raise<io_error>(id, file_, ":", line_, ": ", what); }

  static bool is_quote(char c) { return c == '"' || c == '\''; }
  static std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \r"), last = text.find_last_not_of(" \r");
    return first == text.npos ? std::string_view() : text.substr(first, last - first + 1);
  }
  /// The position after the quote that ends the quoted text around `at`; the size of the text if there is none.
  static std::size_t quote_end(std::string_view text, char quote, std::size_t at) {
    for (; at < text.size(); ++at) {
      const bool twice = text.substr(at).starts_with("''");
      if (quote == '"' ? text[at] == '\\' : twice)
        ++at;
      else if (text[at] == quote)
        return at + 1;
    }
    return text.size();
  }
  /// open   the quote of a text that continues from an earlier line; else 0
  static std::string_view without_comment(std::string_view line, char open) {
    for (std::size_t i = open == 0 ? 0 : quote_end(line, open, 0); i < line.size();) {
      const bool begins = i == 0 || std::string_view(" [,{").find(line[i - 1]) != std::string_view::npos;
      if (line[i] == '#' && (i == 0 || line[i - 1] == ' ')) return line.substr(0, i);
      i = begins && is_quote(line[i]) ? quote_end(line, line[i], i + 1) : i + 1;
    }
    return line;
  }

  void read_line(std::string_view line) {
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const bool goes_on = folded_ && indent > folded_->indent;
    const std::string_view text = trimmed(without_comment(line, goes_on ? folded_->quote : '\0'));
    if (text.empty() || text == "---" || text == "...") return;
    if (text[0] == '\t') fail(403, "a tab as indentation");
    if (goes_on && (folded_->quote != 0 || key_end(text) == text.npos) && values.append_to_last(text)) {
      if (folded_->quote != 0 && text.back() == folded_->quote) folded_.reset();
      return;
    }
    folded_.reset();
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
    if (text.empty() || text[0] == '[' || text[0] == '{') return text.npos;
    const std::size_t from = is_quote(text[0]) ? quote_end(text, text[0], 1) : 0;
    for (std::size_t at = text.find(':', from); at != text.npos; at = text.find(':', at + 1)) {
      if (at + 1 == text.size() || text[at + 1] == ' ') return at;
    }
    return text.npos;
  }
  /// The path of the key before a colon, in a mapping at `path`.
  std::string key_path(const std::string& path, std::string_view text) {
    text = trimmed(text);
    std::string out = below(path, is_quoted(text) ? unquoted(text) : std::string(text));
    values.add_key(out, line_);
    return out;
  }
  void read_key(std::string_view text, std::size_t indent) {
    const std::size_t colon = key_end(text);
    if (colon == text.npos) fail(403, "a key with a colon expected");
    read_value(key_path(levels_.back().path, text.substr(0, colon)), trimmed(text.substr(colon + 1)), indent);
  }

  void read_value(const std::string& path, std::string_view text, std::size_t indent) {
    if (text.starts_with('!') || text.starts_with('&'))
      text = trimmed(text.substr(std::min(text.find(' '), text.size())));
    if (text.empty()) {
      pending_ = Pending{indent, path};
    } else if (text[0] == '|' || text[0] == '>' || text[0] == '*') {
      fail(404, "texts of several lines and references are not read");
    } else if ((text[0] == '[' && text.back() == ']') || (text[0] == '{' && text.back() == '}')) {
      read_brackets(path, text);
    } else {
      values.add_text(path, text);
      const bool open = is_quote(text[0]) && quote_end(text, text[0], 1) == text.size() && text.back() != text[0];
      if (text[0] != '[' && text[0] != '{') folded_ = Folded{indent, open ? text[0] : '\0'};
    }
  }
  /// A list or a mapping in one line.
  void read_brackets(const std::string& path, std::string_view text) {
    const bool mapping = text[0] == '{';
    text = text.substr(1, text.size() - 2);
    for (std::size_t i = 0; !trimmed(text).empty(); ++i) {
      const std::size_t comma = comma_outside_quotes(text);
      std::string_view element = trimmed(text.substr(0, comma));
      std::string place;
      if (mapping) {
        const std::size_t colon = key_end(element);
        if (colon == element.npos) fail(403, "a key with a colon expected in the braces");
        place = key_path(path, element.substr(0, colon));
        element = trimmed(element.substr(colon + 1));
      } else {
        place = below(path, concat_text(i));
      }
      if (element.starts_with('[') || element.starts_with('{')) fail(404, "brackets in brackets are not read");
      if (!mapping || !element.empty()) values.add_text(place, element);
      text.remove_prefix(std::min(comma + 1, text.size()));
    }
  }
  static std::size_t comma_outside_quotes(std::string_view text) {
    char before = ':';  // no blank
    for (std::size_t i = 0; i < text.size();) {
      if (text[i] == ',') return i;
      const std::size_t next = before == ':' && is_quote(text[i]) ? quote_end(text, text[i], i + 1) : i + 1;
      if (text[i] != ' ') before = text[i];
      i = next;
    }
    return text.size();
  }

  std::string_view file_;
  std::size_t line_ = 0;
  std::vector<Level> levels_;
  std::optional<Pending> pending_;
  std::optional<Folded> folded_;
};

/// The beginning of an opt.txt; in YAML, a line of three dashes may be part of the file.
inline constexpr std::string_view option_banner = "----";

/// "key: value" on each line; True and False are truth values.
inline std::vector<FileValue> parse_option_lines(std::string_view text, std::string_view name) {
  OptionValues out(text, name);
  for_each_line(text, [&](std::string_view line, Index number) {
    const std::size_t last = line.find_last_not_of(" \t");
    line = line.substr(0, last + 1);  // npos + 1 = 0
    if (line.empty() || line.starts_with(option_banner)) return;
    const std::size_t colon = line.find(':');
    if (colon == line.npos || colon == 0) raise<io_error>(403, name, ":", number, ": 'key: value' expected");
    const std::string key(line.substr(0, colon));
    out.add_key(key, static_cast<std::size_t>(number));
    line.remove_prefix(std::min(line.find_first_not_of(' ', colon + 1), line.size()));
    if (line == "True" || line == "False")
      out.add(key, line == "True");
    else
      out.add_text(key, line);
  });
  return out.take();
}

inline void add_json_values(const nlohmann::json& value, const std::string& path, OptionValues& out) {
  if (value.is_boolean()) out.add(path, value.get<bool>());
  if (value.is_number_integer()) out.add_text(path, value.dump());
  if (value.is_number_float()) out.add(path, value.get<double>());
  if (value.is_string()) out.add(path, value.get<std::string>());
  if (!value.is_structured()) return;
  for (const auto& member : value.items()) add_json_values(member.value(), below(path, member.key()), out);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<FileValue> parse_options(std::string_view text, std::string_view name) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != text.npos && text.substr(first).starts_with(detail::option_banner))
    return detail::parse_option_lines(text, name);
  if (first == text.npos || text[first] != '{') return detail::YamlReader(text, name).values.take();
  detail::OptionValues out(text, name);
  detail::add_json_values(parse_json(text, name), "", out);
  return out.take();
}

MOTIONLANG_BODY std::vector<FileValue> read_options(const FilePath& path) {
  return parse_options(read_file(path), path.string());
}

MOTIONLANG_BODY const FileValue* find_option(const std::vector<FileValue>& values, std::string_view path) {
  const FileValue* found = find_value(values, path);
  for (int step = 0; found != nullptr && step < 8; ++step) {
    const std::string* text = std::get_if<std::string>(&found->value);
    if (text == nullptr || !text->starts_with("${") || !text->ends_with('}')) return found;
    std::string target = text->substr(2, text->size() - 3);
    std::replace(target.begin(), target.end(), '.', '/');
    found = find_value(values, target);
  }
  return nullptr;
}

MOTIONLANG_NAMESPACE_END
