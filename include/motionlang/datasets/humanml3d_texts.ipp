// SPDX-License-Identifier: MIT
// Bodies of humanml3d_texts.hpp.
#pragma once

#include <cmath>    // isnan
#include <utility>  // exchange

#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/humanml3d_texts.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/text/mirror_caption.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A time in seconds, 0 for "nan". Throws io_error 403 with the place.
inline double caption_time(std::string_view field, std::string_view name, Index line) {
  field = trim(field);
  double seconds = 0;
  const auto [end, status] = detail::from_chars(field.data(), field.data() + field.size(), seconds);
  if (status == std::errc{} && end == field.data() + field.size()) {
    if (std::isnan(seconds)) return 0;
    if (seconds >= 0 && std::isfinite(seconds)) return seconds;
  }
  raise<io_error>(403, name, ":", line, ": '", utf8_head(field, 40), "' is not a time");
}

inline std::vector<TaggedWord> tagged_words(std::string_view field) {
  std::vector<TaggedWord> words;
  for (field = trim(field); !field.empty();) {
    const std::string_view token = field.substr(0, std::min(field.find(' '), field.size()));
    const std::size_t slash = token.rfind('/');
    words.push_back(
        {std::string(token.substr(0, slash)), std::string(slash == token.npos ? "" : token.substr(slash + 1))});
    field = trim(field.substr(token.size()));
  }
  return words;
}

/// The time in Python's notation: "0.0", "2.5".
inline std::string time_text(double seconds) {
  const std::string text = concat_text(seconds);
  return text.find_first_of(".e") == text.npos ? text + ".0" : text;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<MotionCaption> parse_captions(std::string_view text, std::string_view name) {
  std::vector<MotionCaption> captions;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    std::string_view fields[3];  // end, start, words
    for (std::string_view& field : fields) {
      const std::size_t mark = line.rfind('#');
      if (mark == line.npos) return;
      field = line.substr(mark + 1);
      line = line.substr(0, mark);
    }
    captions.push_back({std::string(detail::trim(line)), detail::tagged_words(fields[2]),
                        detail::caption_time(fields[1], name, number), detail::caption_time(fields[0], name, number)});
  });
  return captions;
}

MOTIONLANG_BODY std::vector<MotionCaption> read_captions(const FilePath& path) {
  return parse_captions(detail::as_text(MappedFile::open(path)->bytes()), path.string());
}

MOTIONLANG_BODY std::string format_captions(std::span<const MotionCaption> captions, std::string_view name) {
  std::string out;
  auto require = [&](bool holds, const std::string& text) {
    if (!holds) raise<timeline_error>(510, name, ": '", text, "' is not allowed in a file of captions");
  };
  for (const MotionCaption& c : captions) {
    require(c.text.find_first_of("#\r\n") == c.text.npos && detail::trim(c.text) == c.text, c.text);
    out += c.text + '#';
    for (std::size_t i = 0; i < c.words.size(); ++i) {
      const auto& [word, tag] = c.words[i];
      const bool plain = (word + tag).find_first_of("# \t\r\n\v\f") == word.npos;
      require(
          plain && !(word + tag).empty() && tag.find('/') == tag.npos && (!tag.empty() || word.find('/') == word.npos),
          word + "/" + tag);
      out += (i > 0 ? " " : "") + word + (tag.empty() ? "" : "/" + tag);
    }
    for (const double seconds : {c.start, c.end}) {
      if (!(seconds >= 0 && std::isfinite(seconds)))
        raise<io_error>(403, name, ": '", c.text, "': ", seconds, " is not a time");
      out += '#' + detail::time_text(seconds);
    }
    out += '\n';
  }
  return out;
}

MOTIONLANG_BODY MotionCaption mirrored(MotionCaption caption) {
  caption.text = mirror_caption(caption.text);
  std::vector<TaggedWord> words;
  for (TaggedWord& w : std::exchange(caption.words, {})) {
    const bool in_parts =
        !words.empty() && w.word == "clockwise" && (words.back().word == "counter" || words.back().word == "anti");
    if (in_parts) {
      words.back() = std::move(w);  // "counter clockwise" becomes "clockwise"
    } else {
      words.push_back({mirror_caption(w.word), std::move(w.tag)});
    }
  }
  caption.words = std::move(words);
  return caption;
}

MOTIONLANG_BODY std::vector<HumanMl3dSource> parse_humanml3d_index(std::string_view text, std::string_view name) {
  constexpr std::string_view head = "source_path,start_frame,end_frame,new_name";
  std::vector<HumanMl3dSource> rows;
  bool has_head = false;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    line = detail::trim(line);
    if (line.empty()) return;
    if (!std::exchange(has_head, true)) {
      if (line != head) raise<io_error>(403, name, ":", number, ": expected '", head, "'");
      return;
    }
    std::vector<std::string_view> fields;
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t end = std::min(line.find(',', at), line.size());
      fields.push_back(detail::trim(line.substr(at, end - at)));
      at = end + 1;
    }
    if (fields.size() != 4)
      raise<io_error>(403, name, ":", number, ": ", counted(fields.size(), "field"), ", 4 are expected");
    auto frame = [&](std::string_view field) {
      Index value = 0;
      const auto [end, status] = detail::from_chars(field.data(), field.data() + field.size(), value);
      if (status != std::errc{} || end != field.data() + field.size() || value < -1)
        raise<io_error>(403, name, ":", number, ": '", utf8_head(field, 40), "' is not a frame");
      return value;
    };
    rows.push_back({std::string(fields[0]), frame(fields[1]), frame(fields[2]), std::string(fields[3])});
  });
  if (!has_head) raise<io_error>(403, name, ":1: expected '", head, "'");
  return rows;
}

MOTIONLANG_BODY std::vector<HumanMl3dSource> read_humanml3d_index(const FilePath& path) {
  return parse_humanml3d_index(detail::as_text(MappedFile::open(path)->bytes()), path.string());
}

MOTIONLANG_NAMESPACE_END
