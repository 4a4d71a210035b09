// SPDX-License-Identifier: MIT
// Bodies of bvh_text.hpp.
#pragma once

#include <algorithm>  // count, min
#include <cmath>      // isfinite, pow, round

#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/text_encoding.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/text_scanner.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/formats/bvh_text.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

class BvhParser {
 public:
  BvhParser(std::string_view text, std::string_view name) : scan_(text, name) { bvh_.name = name; }

  Bvh parse() && {
    scan_.expect("hierarchy");
    do {
      root();
    } while (same_word(scan_.peek(), "root"));
    scan_.expect("motion");
    motion();
    if (const std::string& number = scan_.decimal_comma(); !number.empty())
      note("numbers have decimal commas: '", number, "' is read as with a point");
    if (!joined_.empty()) note("names of several words are joined: '", joined_, "'");
    if (latin1_ > 0) note(counted(latin1_, "name"), latin1_ == 1 ? " is" : " are", " not UTF-8, read as ISO 8859-1");
    return std::move(bvh_);
  }

 private:
  /// Reads one tree, without recursion: `open` holds the node of every open brace.
  void root() {
    scan_.expect("root");
    std::vector<int> open{node(-1, false)};
    while (!open.empty()) {
      const int current = open.back();
      BvhNode& here = bvh_.nodes[static_cast<std::size_t>(current)];
      const std::string_view word = scan_.word("'}'");
      if (word == "}") {
        if (!has_offset_.back()) scan_.fail(403, "'", here.name, "' has no OFFSET");
        open.pop_back();
        has_offset_.pop_back();
      } else if (same_word(word, "offset")) {
        here.offset = {scan_.number("an offset"), scan_.number("an offset"), scan_.number("an offset")};
        has_offset_.back() = true;
      } else if (same_word(word, "channels") && !here.end_site) {
        channels(here);
      } else if (same_word(word, "joint") && !here.end_site) {
        open.push_back(node(current, false));
      } else if (same_word(word, "end") && !here.end_site) {
        open.push_back(node(current, true));
      } else {
        scan_.fail(403, "'", TextScanner::shortened(word), "' does not belong in '", here.name, "'");
      }
    }
  }
  /// Reads name and opening brace; returns the number of the new node.
  int node(int parent, bool end_site) {
    std::string name;
    bool several = false;
    for (std::string_view w = scan_.word("'{'"); w != "{"; w = scan_.word("'{'")) {
      if (w == "}") scan_.fail(403, "expected '{', found '}'");
      if (!name.empty()) name += '_', several = true;
      name += w;
    }
    if (name.empty()) scan_.fail(403, "a joint without a name");
    if (!is_utf8(name)) name = from_latin1(name), ++latin1_;
    if (several && !end_site && joined_.empty()) joined_ = TextScanner::shortened(name);
    if (bvh_.nodes.size() == max_text_joints) scan_.fail(405, "more than ", max_text_joints, " joints");
    bvh_.nodes.push_back({.name = std::move(name), .parent = parent, .end_site = end_site});
    has_offset_.push_back(false);
    return static_cast<int>(bvh_.nodes.size()) - 1;
  }
  void channels(BvhNode& joint) {
    const auto count = scan_.count<std::size_t>("the number of channels");
    for (std::size_t i = 0; i < count; ++i) {
      joint.channels.push_back(channel());
      if (std::count(joint.channels.begin(), joint.channels.end(), joint.channels.back()) > 1)
        scan_.fail(403, "joint '", TextScanner::shortened(joint.name), "' has a channel twice");
    }
  }
  BvhChannel channel() {
    const std::string_view word = scan_.word("a channel");
    const int axis = lower(word[0]) - 'x';
    const bool rotation = same_word(word.substr(1), "rotation");
    if (axis < 0 || axis > 2 || (!rotation && !same_word(word.substr(1), "position"))) {
      scan_.fail(403, "'", TextScanner::shortened(word), "' is not a channel");
    }
    return static_cast<BvhChannel>(axis + (rotation ? 3 : 0));
  }

  void motion() {
    label("frames");
    bvh_.frames = scan_.count<Index>("the number of frames");
    scan_.expect("frame");
    label("time");
    const std::string printed(scan_.peek());
    bvh_.frame_time = scan_.number("the frame time");
    if (!(bvh_.frame_time > 0)) scan_.fail(403, "the frame time is ", bvh_.frame_time, " seconds");
    if (const double rate = rounded_rate(printed, bvh_.frame_time); rate > 0) {
      note("the frame time ", printed, " s is read as that of ", rate, " frames per second");
      bvh_.frame_time = 1 / rate;
    }
    constexpr double slow = 5;
    if (bvh_.frame_time > slow)
      note("a frame takes ", bvh_.frame_time, " s, as if the rate stood where the frame time should");
    rows(static_cast<std::size_t>(bvh_.frames), static_cast<std::size_t>(bvh_.channels()));
  }
  /// The usual number of frames per second for a rounded time of three to five decimals: 60 for 0.0167. 0 if there is
  /// none, or if the time is that of a whole number.
  static double rounded_rate(std::string_view printed, double time) {
    const std::size_t point = printed.find_first_of(".,");
    const std::size_t decimals = point == printed.npos ? 0 : printed.size() - point - 1;
    const bool exact = std::abs(1 / time - std::round(1 / time)) < 1e-6 / time;
    if (decimals < 3 || decimals > 5 || printed.find_first_of("eE") != printed.npos || exact) return 0;
    const double half = 0.5 * std::pow(10.0, -static_cast<double>(decimals));
    for (const double rate : {24.0, 30.0, 60.0, 120.0, 240.0}) {
      if (std::abs(1 / rate - time) <= 1.0001 * half) return rate;
    }
    return 0;
  }
  /// Some programs write a row more or less than declared, or something else after the table. If every row is a line,
  /// it is clear what belongs to it: the rest is left out, with a note.
  void rows(std::size_t frames, std::size_t columns) {
    if (frames != 0 && columns == 0) scan_.fail(403, counted(frames, "frame"), ", but no channels");
    const std::string declared = concat_text(counted(frames, "declared frame"), " of ", counted(columns, "channel"));
    // Each value takes at least two bytes, one of them a blank (which the last may lack).
    if (frames != 0) bvh_.values.reserve(std::min(frames, (scan_.bytes_left() + 1) / 2 / columns) * columns);
    bool are_lines = true, whole = true;
    std::size_t row = 0;
    while (whole && columns != 0 && (frames == 0 || row < frames) && at_number()) {
      for (std::size_t c = 0; c < columns && whole; ++c) {
        if (scan_.at_end() || (c + 1 < columns && is_cut_off())) {
          whole = false;
          continue;
        }
        bvh_.values.push_back(value(row, columns));
        if (c == 0 && !scan_.began_line()) are_lines = false;
      }
      if (whole) ++row;
    }
    if (row < frames && (row == 0 || !are_lines) && scan_.at_end())
      scan_.fail(402, "the text is too short for the ", declared, ": it has ", counted(bvh_.values.size(), "number"));
    if (row == 0 && frames != 0) scan_.number("a value of the motion");  // throws, because there is none
    if (!scan_.at_end()) {
      const std::string_view extra = scan_.word("the end");
      if (!are_lines || !scan_.began_line())
        scan_.fail(403, "'", TextScanner::shortened(extra), "' follows the ",
                   row < frames ? counted(row, "whole frame") + " among " : "", declared);
      note("ignored: everything after the ", counted(row, "frame"), ", from '", TextScanner::shortened(extra), "' on");
    }
    if (row != frames) note("it has ", counted(row, "whole frame"), ", not the ", declared);
    bvh_.frames = static_cast<Index>(row);
    bvh_.values.resize(row * columns);
    fill_gaps(columns);
  }
  /// A number, or where a recording has gaps, no number: that of the frame before, and in the first frame 0.
  double value(std::size_t row, std::size_t columns) {
    const std::string_view w = scan_.peek();
    const std::string_view sign = w.starts_with('-') || w.starts_with('+') ? w.substr(0, 1) : w.substr(0, 0);
    const std::string_view word = w.substr(sign.size());
    const bool gap = same_word(word, "nan") || same_word(word.substr(0, 4), "nan(") ||  // of C, and of Microsoft
                     same_word(word, "1.#qnan") || same_word(word, "1.#ind");
    if (!gap) return scan_.number("a value of the motion");
    scan_.word("a value of the motion");
    gaps_.push_back(bvh_.values.size());
    return row == 0 ? 0 : bvh_.values[bvh_.values.size() - columns];
  }
  /// Gaps from the first frame on get the first number behind them.
  void fill_gaps(std::size_t columns) {
    while (!gaps_.empty() && gaps_.back() >= bvh_.values.size()) gaps_.pop_back();  // of a row that is cut off
    if (gaps_.empty()) return;
    std::vector<bool> gap(bvh_.values.size(), false);
    for (const std::size_t at : gaps_) gap[at] = true;
    for (std::size_t c = 0; c < columns; ++c) {
      std::size_t first = c;
      while (first < gap.size() && gap[first]) first += columns;
      if (first >= gap.size()) continue;
      for (std::size_t at = c; at < first; at += columns) bvh_.values[at] = bvh_.values[first];
    }
    note(counted(gaps_.size(), "value"), gaps_.size() == 1 ? " is" : " are",
         " not a number: that of the frame before stands in");
  }
  /// True if the text ends with the next word, which may be half a number; then moves past it.
  bool is_cut_off() {
    constexpr std::size_t longest = 64;
    if (scan_.bytes_left() > longest) return false;
    const std::size_t word = scan_.peek().size();  // moves to it
    if (word < scan_.bytes_left()) return false;
    scan_.word("a value of the motion");
    return true;
  }
  /// True if the next word is a number, or stands for one that is not finite.
  bool at_number() {
    const std::string_view w = scan_.peek();
    return !w.empty() && (std::string_view("0123456789.,+-").find(w[0]) != w.npos || same_word(w.substr(0, 3), "nan") ||
                          same_word(w.substr(0, 3), "inf"));
  }
  template <class... T>
  void note(const T&... text) {
    bvh_.notes.push_back(concat_text(text...));
  }
  /// "Frames:", "FRAMES :", "frames".
  void label(std::string_view lower_case) {
    if (!scan_.skip_prefix(lower_case)) scan_.expect(lower_case);
    scan_.skip_prefix(":");
  }

  TextScanner scan_;
  Bvh bvh_;
  std::vector<bool> has_offset_;     // of the nodes that are open
  std::size_t latin1_ = 0;           // names in another encoding than UTF-8
  std::string joined_{};             // the first name of several words
  std::vector<std::size_t> gaps_{};  // values that are not numbers
};

}  // namespace detail

MOTIONLANG_BODY Bvh parse_bvh(std::string_view text, std::string_view name) {
  return detail::BvhParser(text, name).parse();
}

MOTIONLANG_BODY Bvh read_bvh(const FilePath& path) {
  return parse_bvh(detail::as_text(MappedFile::open(path)->bytes()), path.string());
}

namespace detail {

/// Fixed notation, no exponent; never "-0.000000".
inline void append_fixed(std::string& out, double value, int decimals) {
  char digits[400];  // the largest double has 309 digits before the point
  const auto end = detail::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals).ptr;
  const std::string_view text(digits, static_cast<std::size_t>(end - digits));
  const bool zero = text.find_first_not_of("-0.") == text.npos;
  out += zero && text[0] == '-' ? text.substr(1) : text;
}
inline void append_fixed(std::string& out, const Vec3<double>& v) {
  for (const double value : {v.x, v.y, v.z}) {
    out += ' ';
    append_fixed(out, value, 6);
  }
}

inline void append_node(std::string& out, const BvhNode& node, int depth) {
  const std::string indent(static_cast<std::size_t>(depth), '\t');
  out += indent + (node.end_site ? "End " : depth == 0 ? "ROOT " : "JOINT ") + node.name + '\n';
  out += indent + "{\n" + indent + "\tOFFSET";
  append_fixed(out, node.offset);
  out += '\n';
  if (node.end_site) return;
  out += indent + "\tCHANNELS " + std::to_string(node.channels.size());
  for (const BvhChannel c : node.channels) {
    out += ' ';
    out += static_cast<char>('X' + axis_of(c));
    out += is_rotation(c) ? "rotation" : "position";
  }
  out += '\n';
}

}  // namespace detail

MOTIONLANG_BODY std::string format_bvh(const Bvh& file) {
  const auto require_finite = [&](double number, const auto&... what) {
    if (!std::isfinite(number)) raise<numeric_error>(301, "BVH: motion '", file.name, "': ", what..., " is ", number);
  };
  require_finite(file.frame_time, "the frame time");
  if (!(file.frame_time >= 1e-9))
    raise<numeric_error>(302, "BVH: motion '", file.name, "': the frame time is ", file.frame_time,
                         " s, expected 1e-09 or more");
  std::string out = "HIERARCHY\n";
  std::vector<int> open;  // nodes whose brace is not closed
  auto close = [&] {
    open.pop_back();
    out += std::string(open.size(), '\t') + "}\n";
  };
  for (std::size_t n = 0; n < file.nodes.size(); ++n) {
    const BvhNode& node = file.nodes[n];
    while (!open.empty() && open.back() != node.parent) close();
    for (const double x : {node.offset.x, node.offset.y, node.offset.z})
      require_finite(x, "a number of the offset of '", node.name, "'");
    detail::append_node(out, node, static_cast<int>(open.size()));
    open.push_back(static_cast<int>(n));
  }
  while (!open.empty()) close();
  out += "MOTION\nFrames: " + std::to_string(file.frames) + "\nFrame Time: ";
  std::string time;
  detail::append_fixed(time, file.frame_time, 9);
  while (time.back() == '0' && time.size() - time.find('.') > 7) time.pop_back();
  out += time + '\n';
  const Index columns = file.channels();
  for (Index f = 0; f < file.frames; ++f) {
    for (Index c = 0; c < columns; ++c) {
      const double value = file.values[static_cast<std::size_t>(f * columns + c)];
      require_finite(value, "number ", c, " of frame ", f);
      detail::append_fixed(out, value, 6);
      out += c + 1 < columns ? ' ' : '\n';
    }
  }
  return out;
}

MOTIONLANG_BODY void write_bvh(const FilePath& path, const Bvh& file) { write_file(path, format_bvh(file)); }

MOTIONLANG_NAMESPACE_END
