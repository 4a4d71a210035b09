// SPDX-License-Identifier: MIT
// Bodies of text_warnings.hpp.
#pragma once

#include <algorithm>  // all_of, count, find, find_if
#include <cmath>      // round

#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/compose/in_turn.hpp>
#include <motionlang/compose/natural_lengths.hpp>
#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/text_timeline.hpp>
#include <motionlang/generate/text_warnings.hpp>
#include <motionlang/text/known_words.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Calls f(piece, owners) for every piece of a timeline with texts; `owners` gives the text that moves each part.
template <class F>
void for_each_owned_piece(const Timeline& timeline, F f) {
  FirstWins ties;
  for (const Piece& piece : elementary_pieces(timeline)) {
    if (!piece.intervals.empty()) f(piece, assign_parts(timeline, piece.intervals, ties));
  }
}

/// "FILE:LINE:COLUMN: 'TEXT'"
inline std::string placed_text(const Interval& i, const WarningNames& names) {
  return concat_text(names.source, ":", i.place.line, ":", i.place.column, ": '", i.text, "'");
}

inline std::string in_quotes(const std::string& text) { return concat_text("'", text, "'"); }

/// Warns about words of a text that the tokenizer cannot read.
inline std::vector<std::string> unreadable_word_warnings(const std::string& text) {
  if (text.empty()) return {};
  if (WordPiece::words(text).empty())
    return {in_quotes(text) + ": the model reads no word of it; it knows those of a-z and 0-9"};
  const auto unreadable = unreadable_words(text);
  if (unreadable.empty()) return {};
  return {concat_text(in_quotes(text), ": the model reads a-z and 0-9, not all of ",
                      join_text(unreadable, ", ", in_quotes))};
}

/// A text at each "and", "then", "while", comma, semicolon and full stop.
inline std::vector<std::string> joined_texts(const std::string& text) {
  std::vector<std::string> out(1);
  std::string word;
  for (const char c : text + ' ') {
    const bool ends = c == ',' || c == ';' || c == '.';
    if (c != ' ' && !ends) {
      word += c;
      continue;
    }
    if (word == "and" || word == "then" || word == "while")
      out.emplace_back();
    else if (!word.empty())
      out.back() += (out.back().empty() ? "" : " ") + word;
    if (ends) out.emplace_back();
    word.clear();
  }
  std::erase(out, "");
  return out;
}

/// The texts of the list that say different words, the first of each.
inline std::vector<std::string> of_different_words(const std::vector<NearText>& list, std::size_t most) {
  std::vector<std::vector<std::string>> said;
  std::vector<std::string> out;
  for (const NearText& near : list) {
    auto words = WordPiece::words(near.text);
    std::erase_if(words, is_function_word);
    if (out.size() == most || std::find(said.begin(), said.end(), words) != said.end()) continue;
    said.push_back(std::move(words));
    out.push_back(near.text);
  }
  return out;
}

inline void append_all(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace detail

MOTIONLANG_BODY std::vector<BodyPart> listed_parts(BodyParts parts) {
  std::vector<BodyPart> out;
  for (int p = 0; p < body_part_count; ++p) {
    if (const auto part = static_cast<BodyPart>(p); parts.has(part)) out.push_back(part);
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> unknown_word_warnings(const std::string& text, const KnownWords& known) {
  if (known.empty()) return {};
  auto out = detail::unreadable_word_warnings(text);
  const auto unknown = unknown_words(text, known);
  if (unknown.empty()) return out;
  const auto with_like = [](const UnknownWord& w) {
    return detail::in_quotes(w.word) + (w.like.empty() ? "" : " (did you mean '" + w.like + "'?)");
  };
  out.push_back(concat_text(detail::in_quotes(text), ": the model never learned the word",
                            unknown.size() == 1 ? " " : "s ", join_text(unknown, ", ", with_like)));
  return out;
}

MOTIONLANG_BODY std::vector<std::string> far_text_warnings(const std::string& text, const KnownCaptions& captions,
                                                           const KnownWords& known) {
  if (captions.empty() || text.empty()) return {};
  if (WordPiece::words(text).empty()) return detail::unreadable_word_warnings(text);
  constexpr Index asked = 24;
  const auto near = captions.nearest(text, asked);
  const auto parts = detail::joined_texts(text);
  const bool known_parts = parts.size() > 1 && std::all_of(parts.begin(), parts.end(), [&](const std::string& part) {
                             return captions.knows(part);
                           });
  if (known_parts || near.front().likeness >= captions.nearness()) {
    auto out = detail::unreadable_word_warnings(text);
    for (const MisspelledWord& m : captions.misspelled(text))
      out.push_back(concat_text(detail::in_quotes(text), ": ", detail::in_quotes(m.word), " is read as ",
                                detail::in_quotes(m.read)));
    return out;
  }
  auto out = unknown_word_warnings(text, known);
  out.push_back(concat_text(detail::in_quotes(text), " is far from all that the model learned; the nearest to it: ",
                            join_text(detail::of_different_words(near, 3), ", ", detail::in_quotes)));
  return out;
}

MOTIONLANG_BODY std::vector<std::string> failing_text_warnings(const std::string& text, const KnownCaptions& captions) {
  const auto success = captions.success(text);
  if (!success || *success >= 0.5) return {};
  return {concat_text(detail::in_quotes(text), ": the model often fails at this; ", std::round(100 * *success),
                      " % of the motions that were tried for such texts did what they say")};
}

MOTIONLANG_BODY std::vector<std::string> meaning_warnings(const std::string& text, const KnownCaptions& captions,
                                                          const KnownWords& known) {
  auto out = far_text_warnings(text, captions, known);
  return out.empty() ? failing_text_warnings(text, captions) : out;
}

MOTIONLANG_BODY std::vector<std::string> text_warnings(const MotionModel& model, const std::string& text) {
  auto out = model.captions().empty() ? unknown_word_warnings(text, model.words())
                                      : meaning_warnings(text, model.captions(), model.words());
  if (const auto [pieces, read] = model.length_of(text); pieces > read)
    out.push_back(
        concat_text(detail::in_quotes(text), ": the model reads the first ", read, " of its ", pieces, " word pieces"));
  return out;
}

MOTIONLANG_BODY std::vector<std::string> hidden_text_warnings(std::span<const Timeline> timelines,
                                                              const WarningNames& names) {
  std::vector<std::string> out;
  for (const Timeline& t : timelines) {
    std::vector<bool> moves(t.intervals.size());
    detail::for_each_owned_piece(t, [&](const Piece&, const auto& owners) {
      for (const Index owner : owners) moves[static_cast<std::size_t>(owner)] = true;
    });
    for (std::size_t i = 0; i < moves.size(); ++i) {
      if (!moves[i])
        out.push_back(detail::placed_text(t.intervals[i], names) +
                      " moves nothing: other texts take all its body parts");
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> whole_body_warnings(std::span<const Timeline> timelines,
                                                             const WarningNames& names) {
  std::vector<std::string> out;
  for (const Timeline& t : timelines) {
    const auto interval = [&](Index i) -> const Interval& { return t.intervals[static_cast<std::size_t>(i)]; };
    std::vector<bool> known(t.intervals.size());
    detail::for_each_owned_piece(t, [&](const Piece& piece, const auto& owners) {
      const Index owner = owners.front();
      if (std::count(owners.begin(), owners.end(), owner) != std::ssize(owners) ||
          known[static_cast<std::size_t>(owner)])
        return;
      const BodyParts guessed = guess_body_parts(interval(owner).text);
      const auto other = std::find_if(piece.intervals.begin(), piece.intervals.end(), [&](Index i) {
        return (guess_body_parts(interval(i).text).bits & ~guessed.bits) != 0;
      });
      if (other == piece.intervals.end()) return;
      known[static_cast<std::size_t>(owner)] = true;
      out.push_back(concat_text(detail::placed_text(interval(owner), names), " moves the whole body, also while '",
                                interval(*other).text, "' lasts; with '# ", join_text(listed_parts(guessed), " # "),
                                "' it would leave that the rest"));
    });
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> several_action_warnings(std::span<const Timeline> timelines,
                                                                 const WarningNames& names) {
  std::vector<std::string> out;
  for (const Timeline& t : timelines) {
    for (const Interval& i : t.intervals) {
      if (const auto count = actions_in_turn(i.text).size(); count > 1)
        out.push_back(concat_text(detail::in_quotes(i.text), " is made as one text, of which a model may do a part; ",
                                  names.in_turn, " makes its ", counted(count, "action"), " one after the other"));
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> long_text_warnings(std::span<const Timeline> timelines, double fps) {
  std::vector<std::string> out;
  for (const Timeline& t : timelines) {
    for (const Interval& i : t.intervals) {
      if (i.end - i.start > frame_at(longest_whole_text, fps))
        out.push_back(concat_text(detail::in_quotes(i.text), ": ", static_cast<double>(i.end - i.start) / fps,
                                  " s are made in parts of at most ", longest_whole_text,
                                  " s, which is what models learn from"));
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> outlasting_text_warnings(std::span<const Timeline> timelines,
                                                                  const KnownCaptions& captions, double fps) {
  std::vector<std::string> out;
  if (captions.empty()) return out;
  for (const Timeline& t : timelines) {
    for (const Interval& i : t.intervals) {
      if (!outlasts_action(i, captions, fps)) continue;
      const auto action = *usual_action(i.text, captions);
      out.push_back(concat_text(detail::in_quotes(i.text), " takes about ", std::round(10 * action.seconds) / 10,
                                " s; in ", static_cast<double>(i.end - i.start) / fps,
                                " s a model may repeat it. It could end earlier, before '", action.then, "'"));
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> timeline_warnings(const MotionModel& model,
                                                           std::span<const Timeline> timelines,
                                                           const GenerateOptions& options, bool in_turn,
                                                           const WarningNames& names) {
  std::vector<std::string> out;
  if (model.steps() == 0) return out;
  detail::append_all(out, hidden_text_warnings(timelines, names));
  detail::append_all(out, whole_body_warnings(timelines, names));
  if (!in_turn && !model.words().empty()) detail::append_all(out, several_action_warnings(timelines, names));
  if (options.cut_texts && !model.takes_actions()) detail::append_all(out, long_text_warnings(timelines, model.fps()));
  std::vector<Timeline> made;
  for (const Timeline& t : timelines) made.push_back(options.cut_texts ? end_actions(t, model.fps()) : t);
  detail::append_all(out, outlasting_text_warnings(made, model.captions(), model.fps()));
  return out;
}

MOTIONLANG_BODY std::vector<std::string> divided_text_notes(const std::string& text, const Timeline& timeline,
                                                            double fps) {
  if (timeline.intervals.size() < 2) return {};
  const auto with_seconds = [&](const Interval& i) {
    return concat_text(static_cast<double>(i.end - i.start) / fps, " s of '", i.text, "'");
  };
  return {concat_text(detail::in_quotes(text), ": ", join_text(timeline.intervals, ", then ", with_seconds))};
}

MOTIONLANG_BODY std::vector<std::string> in_turn_notes(std::span<const Timeline> timelines, double fps) {
  std::vector<std::string> out;
  for (const Timeline& t : timelines) {
    for (const Interval& i : t.intervals) {
      const auto actions = actions_in_turn(i.text);
      if (actions.size() > 1)
        out.push_back(concat_text(detail::in_quotes(i.text), ": ", static_cast<double>(i.end - i.start) / fps,
                                  " s for ", join_text(actions, ", then ", detail::in_quotes)));
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
