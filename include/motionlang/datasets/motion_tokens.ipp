// SPDX-License-Identifier: MIT
// Bodies of motion_tokens.hpp.
#pragma once

#include <array>     // digits
#include <charconv>  // ids
#include <cmath>     // floor

#include <motionlang/core/numpy_random.hpp>
#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/motion_tokens.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/text/glove.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TokenLines parse_token_lines(std::string_view text, Index codes, std::string_view name) {
  TokenLines out;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    line = detail::trim(line);
    if (line.empty()) return;
    out.emplace_back();
    while (!line.empty()) {
      const std::string_view field = line.substr(0, line.find_first_of(" \t"));
      Index id = -1;
      const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), id);
      if (status != std::errc{} || end != field.data() + field.size() || id < 0 || id >= codes)
        raise<io_error>(403, name, ":", number, ": '", utf8_head(field, 40), "' is not a token of ",
                        counted(codes, "code"));
      out.back().push_back(id);
      line = detail::trim(line.substr(field.size()));
    }
  });
  return out;
}

MOTIONLANG_BODY TokenLines read_token_lines(const FilePath& path, Index codes) {
  return parse_token_lines(detail::as_text(MappedFile::open(path)->bytes()), codes, path.string());
}

MOTIONLANG_BODY std::string format_token_lines(const TokenLines& lines) {
  std::string out;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) out += (i > 0 ? " " : "") + std::to_string(line[i]);
    if (!line.empty()) out += '\n';
  }
  return out;
}

MOTIONLANG_BODY std::vector<TokenEntry> token_entries(const std::string& id, std::span<const MotionCaption> captions,
                                                      TokenLines lines, const TokenEntryOptions& options) {
  std::vector<TokenEntry> out;
  TokenEntry whole{id, {}, {}};
  for (const MotionCaption& c : captions) {
    if (c.of_whole_clip()) {
      whole.captions.push_back(c);
      continue;
    }
    TokenEntry part{id, {}, {c}};
    const auto token = [&](double seconds) { return std::floor(seconds * options.tokens_per_second); };
    bool any = options.cut_again && !lines.empty() && token(c.start) < token(c.end);
    for (const auto& line : lines) {
      auto at = [&](double seconds) {
        return line.begin() + static_cast<Index>(std::min(std::max(0.0, seconds * options.tokens_per_second),
                                                          static_cast<double>(line.size())));
      };
      const auto first = at(c.start), last = std::max(first, at(c.end));
      part.lines.emplace_back(first, last);
      any = any || first != last;
    }
    if (options.cut_again) lines = part.lines;
    if (!any) continue;
    for (const double time : {c.start, c.end}) {
      std::array<char, 400> digits{};  // the largest double has 309 before the point
      char *const first = digits.data(), *const last = first + digits.size();
      part.name.append("_").append(first, detail::to_chars(first, last, time, std::chars_format::fixed, 6).ptr);
    }
    out.push_back(std::move(part));
  }
  if (whole.captions.empty()) return out;
  whole.lines = std::move(lines);
  out.push_back(std::move(whole));
  return out;
}

MOTIONLANG_BODY TokenDrop token_drop(NumpyRandom& random) {
  if (random.randint(0, 3) != 2) return TokenDrop::none;
  return random.randint(0, 2) == 0 ? TokenDrop::last : TokenDrop::first;
}

MOTIONLANG_BODY std::vector<Index> marked_tokens(std::span<const Index> tokens, const MotionVocabulary& vocabulary,
                                                 TokenDrop drop) {
  if (drop != TokenDrop::none && tokens.empty()) raise<shape_error>(207, "marked_tokens: no token to drop");
  if (drop == TokenDrop::first) tokens = tokens.subspan(1);
  if (drop == TokenDrop::last) tokens = tokens.first(tokens.size() - 1);
  std::vector<Index> out{vocabulary.begin()};
  out.insert(out.end(), tokens.begin(), tokens.end());
  out.push_back(vocabulary.end());
  return out;
}

MOTIONLANG_BODY std::vector<Index> marked_words(const GloVe& glove, std::span<const TaggedWord> words, Index longest) {
  std::vector<Index> out;
  for (const TaggedWord& w : GloVe::framed(words, longest)) out.push_back(glove.id(w.word));
  return out;
}

MOTIONLANG_NAMESPACE_END
