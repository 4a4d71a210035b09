// SPDX-License-Identifier: MIT
// Bodies of id_list.hpp.
#pragma once

#include <algorithm>  // none_of, min

#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/id_list.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY bool is_clip_id(std::string_view id) {
  if (id.empty() || id.front() == '/' || trim(id) != id || id.find('\\') != id.npos) return false;
  for (std::size_t at = 0; at <= id.size();) {
    const std::size_t end = std::min(id.find('/', at), id.size());
    const std::string_view part = id.substr(at, end - at);
    if (part.empty() || part == "." || part == "..") return false;
    at = end + 1;
  }
  return std::none_of(id.begin(), id.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::string> parse_ids(std::string_view text, std::string_view name) {
  std::vector<std::string> ids;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    const std::string_view id = detail::trim(line);
    if (id.empty()) return;
    if (!detail::is_clip_id(id)) raise<io_error>(403, name, ":", number, ": '", id, "' is not an id of a clip");
    ids.emplace_back(id);
  });
  return ids;
}

MOTIONLANG_BODY std::vector<std::string> read_ids(const FilePath& path) {
  return parse_ids(detail::as_text(MappedFile::open(path)->bytes()), path.string());
}

MOTIONLANG_BODY void write_ids(const FilePath& path, std::span<const std::string> ids) {
  std::string text;
  for (const std::string& id : ids) {
    if (!detail::is_clip_id(id)) raise<io_error>(403, path.string(), ": '", id, "' is not an id of a clip");
    text += id + '\n';
  }
  write_file(path, text);
}

MOTIONLANG_NAMESPACE_END
