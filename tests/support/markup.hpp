// SPDX-License-Identifier: MIT
/// Checks on SVG and HTML that the library writes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

/// True if every tag is closed in the right order and every ampersand starts an entity. For XML without CDATA.
inline bool is_well_formed(std::string_view xml) {
  std::vector<std::string> open;
  for (std::size_t at = 0; at < xml.size(); ++at) {
    if (xml[at] == '&' && xml.substr(at, 12).find(';') == std::string_view::npos) return false;
    if (xml[at] == '>') return false;  // tags are consumed below; texts escape it
    if (xml[at] != '<') continue;
    const std::size_t end = xml.find('>', at);
    if (end == std::string_view::npos) return false;
    const std::string_view tag = xml.substr(at + 1, end - at - 1);
    at = end;
    if (tag.find('<') != std::string_view::npos) return false;
    const std::string name(tag.substr(0, tag.find_first_of(" \n")));
    if (tag.ends_with('/')) continue;
    if (!name.starts_with('/')) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name.substr(1)) {
      return false;
    } else {
      open.pop_back();
    }
  }
  return open.empty();
}

inline int occurrences(std::string_view text, std::string_view word) {
  int n = 0;
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) ++n;
  return n;
}
