// Reading what the user wrote: timelines, or plain texts with durations.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/compose/in_turn.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/file/file.hpp>

namespace program {

namespace ml = motionlang;

/// What stands for standard input where a timeline file is wanted.
inline constexpr const char* standard_input = "-";

/// In the order of the names.
inline std::vector<ml::BodyPart> listed(ml::BodyParts parts) {
  std::vector<ml::BodyPart> out;
  for (int p = 0; p < ml::body_part_count; ++p) {
    if (const auto part = static_cast<ml::BodyPart>(p); parts.has(part)) out.push_back(part);
  }
  return out;
}

/// A timeline file, or standard input, as messages name it.
inline std::string timeline_source(const std::string& path) { return path == standard_input ? "standard input" : path; }

inline std::string read_timeline_text(const std::string& path) {
  constexpr std::uintmax_t longest = 64 << 20;
  if (path != standard_input) {
    std::error_code none;
    if (const auto size = std::filesystem::file_size(path, none); !none && size > longest)
      ml::raise<ml::io_error>(405, path, ": ", ml::counted(size, "byte"), ", a timeline has at most ", longest);
    return ml::read_file(path);
  }
  return {std::istreambuf_iterator<char>(std::cin), {}};
}

/// Every timeline of a text, in frames. A list of "text # duration" gives one timeline for each line, on the whole
/// body.
/// Throws timeline_error 5xx with line and column.
inline std::vector<ml::Timeline> timelines_of(const std::string& text, const ml::TimelineTextOptions& options) {
  if (!ml::is_text_list(text, {.name = options.name})) return ml::parse_timelines(text, options);
  std::vector<ml::Timeline> out;
  for (const auto& t : ml::parse_text_list(text, options))
    out.push_back({{{t.text, 0, t.frames, ml::BodyParts::all()}}});
  return out;
}
/// Those of a file or of standard input.
inline std::vector<ml::Timeline> read_timelines(const std::string& path, double fps) {
  const std::string text = read_timeline_text(path), name = timeline_source(path);
  return timelines_of(text, {.fps = fps, .name = name});
}

/// Texts cut, as `generate` does unless told not to.
inline void cut_texts(std::vector<ml::Timeline>& timelines, double fps) {
  for (ml::Timeline& t : timelines) t = ml::cut_texts(t, fps);
}

/// A line about each text that is too long to be done as a whole.
inline std::string told_long_texts(const std::vector<ml::Timeline>& timelines, double fps) {
  std::string out;
  for (const ml::Timeline& t : timelines) {
    for (const ml::Interval& i : t.intervals) {
      if (i.end - i.start > ml::frame_at(ml::longest_whole_text, fps))
        out += ml::concat_text("'", i.text, "': ", static_cast<double>(i.end - i.start) / fps,
                               " s are made in parts of at most ", ml::longest_whole_text,
                               " s, which is what models learn from\n");
    }
  }
  return out;
}

inline constexpr const char* in_turn_help =
    "A text of several actions ('walk forward, then sit down; wave') is done one action after the other, in equal "
    "shares of its time";

/// The actions of each text one after the other, and a line about each text that has several.
inline std::string in_turn(std::vector<ml::Timeline>& timelines, double fps) {
  std::string out;
  for (ml::Timeline& t : timelines) {
    for (const ml::Interval& i : t.intervals) {
      const auto actions = ml::actions_in_turn(i.text);
      if (actions.size() == 1) continue;
      const auto quoted = [](const std::string& action) { return ml::concat_text("'", action, "'"); };
      out += ml::concat_text(quoted(i.text), ": ", static_cast<double>(i.end - i.start) / fps, " s for ",
                             ml::join_text(actions, ", then ", quoted), "\n");
    }
    t = ml::in_turn(t);
  }
  return out;
}
/// A line about each text of several actions, if they are not done in turn.
inline std::string told_several_actions(const std::vector<ml::Timeline>& timelines) {
  std::string out;
  for (const ml::Timeline& t : timelines) {
    for (const ml::Interval& i : t.intervals) {
      if (const auto count = ml::actions_in_turn(i.text).size(); count > 1)
        out +=
            ml::concat_text("'", i.text, "' is made as one text, of which a model may do a part; --in-turn makes its ",
                            ml::counted(count, "action"), " one after the other\n");
    }
  }
  return out;
}

/// Calls f(piece, owners) for every piece of a timeline that has texts: which of them moves each part.
template <class F>
void for_each_owned_piece(const ml::Timeline& timeline, F f) {
  ml::FirstWins ties;
  for (const ml::Piece& piece : ml::elementary_pieces(timeline)) {
    if (!piece.intervals.empty()) f(piece, ml::assign_parts(timeline, piece.intervals, ties));
  }
}

/// "FILE:LINE:COLUMN: 'TEXT'"
inline std::string placed(const ml::Interval& i, const std::string& source) {
  return ml::concat_text(source, ":", i.place.line, ":", i.place.column, ": '", i.text, "'");
}

/// A line for each text of a few body parts, as far as its words tell, that takes all of them from a text that needs
/// others.
inline std::string told_whole_body_texts(const std::vector<ml::Timeline>& timelines, const std::string& source) {
  std::string out;
  for (const ml::Timeline& t : timelines) {
    const auto interval = [&](ml::Index i) -> const ml::Interval& { return t.intervals[static_cast<std::size_t>(i)]; };
    std::vector<bool> told(t.intervals.size());
    for_each_owned_piece(t, [&](const ml::Piece& piece, const auto& owners) {
      const ml::Index owner = owners.front();
      if (std::ranges::count(owners, owner) != std::ssize(owners) || told[static_cast<std::size_t>(owner)]) return;
      const ml::BodyParts guessed = ml::guess_body_parts(interval(owner).text);
      const auto other = std::ranges::find_if(piece.intervals, [&](ml::Index i) {
        return (ml::guess_body_parts(interval(i).text).bits & ~guessed.bits) != 0;
      });
      if (other == piece.intervals.end()) return;
      told[static_cast<std::size_t>(owner)] = true;
      out += ml::concat_text(placed(interval(owner), source), " moves the whole body, also while '",
                             interval(*other).text, "' lasts; with '# ", ml::join_text(listed(guessed), " # "),
                             "' it would leave that the rest\n");
    });
  }
  return out;
}

/// A line for each text that moves nothing at any time: others with fewer parts, or as many and later in the file, take
/// all that it has.
inline std::string told_hidden_texts(const std::vector<ml::Timeline>& timelines, const std::string& source) {
  std::string out;
  for (const ml::Timeline& t : timelines) {
    std::vector<bool> moves(t.intervals.size());
    for_each_owned_piece(t, [&](const ml::Piece&, const auto& owners) {
      for (const ml::Index owner : owners) moves[static_cast<std::size_t>(owner)] = true;
    });
    for (std::size_t i = 0; i < moves.size(); ++i) {
      if (!moves[i]) out += placed(t.intervals[i], source) + " moves nothing: other texts take all its body parts\n";
    }
  }
  return out;
}

}  // namespace program
