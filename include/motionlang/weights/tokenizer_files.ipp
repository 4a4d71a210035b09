// SPDX-License-Identifier: MIT
// Bodies of tokenizer_files.hpp.
#pragma once

#include <unordered_set>  // repeated pieces

#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/gzip.hpp>
#include <motionlang/weights/tokenizer_files.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> parse_vocabulary(std::string_view text, std::string_view name) {
  std::vector<std::string> pieces;
  std::unordered_set<std::string_view> seen;
  detail::for_each_line(text, [&](std::string_view piece, Index line) {
    const char* wrong = piece.empty() ? "an empty line" : !is_utf8(piece) ? "not UTF-8" : nullptr;
    if (wrong != nullptr) raise<io_error>(403, name, ":", line, ": ", std::string_view(wrong));
    if (!seen.insert(piece).second) raise<io_error>(403, name, ":", line, ": piece '", piece, "' is duplicated");
    pieces.emplace_back(piece);
  });
  return pieces;
}

namespace detail {

MOTIONLANG_BODY std::pair<std::string, std::string> parse_merge(std::string_view line, std::string_view name,
                                                                Index number) {
  const std::size_t blank = line.find(' ');
  const bool two = blank != line.npos && blank > 0 && blank + 1 < line.size() && line.find(' ', blank + 1) == line.npos;
  if (!two || !is_utf8(line))
    raise<io_error>(403, name, ":", number, ": '", utf8_head(line, 40), "' is not two symbols with one blank between");
  return {std::string(line.substr(0, blank)), std::string(line.substr(blank + 1))};
}

}  // namespace detail

MOTIONLANG_BODY BytePairMerges parse_merges(std::string_view text, std::string_view name, std::size_t most) {
  BytePairMerges merges;
  std::unordered_set<std::string_view> seen;
  bool ended = false;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    ended = ended || line.empty() || merges.size() == most;
    if (ended || line.starts_with("#version") || (number == 1 && line.starts_with("\"bpe_simple_vocab"))) return;
    merges.push_back(detail::parse_merge(line, name, number));
    if (!seen.insert(line).second) raise<io_error>(403, name, ":", number, ": '", line, "' is duplicated");
  });
  return merges;
}

MOTIONLANG_BODY std::vector<std::string> read_vocabulary(const FilePath& path) {
  return parse_vocabulary(read_text(path), path.string());
}

MOTIONLANG_BODY BytePairMerges read_merges(const FilePath& path, std::size_t most) {
  return parse_merges(read_text(path), path.string(), most);
}

MOTIONLANG_NAMESPACE_END
