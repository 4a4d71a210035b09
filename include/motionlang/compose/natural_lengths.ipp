// SPDX-License-Identifier: MIT
// Bodies of natural_lengths.hpp.
#pragma once

#include <algorithm>  // any_of
#include <array>      // words
#include <vector>     // words

#include <motionlang/compose/natural_lengths.hpp>
#include <motionlang/core/text_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The words of a text in lower case.
inline std::vector<std::string> lower_case_words(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    const char l = lower(c);
    if ((l >= 'a' && l <= 'z') || (l >= '0' && l <= '9') || l == '\'')
      words.back() += l;
    else if (!words.back().empty())
      words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

/// Words of actions that continue, or that need another action.
inline constexpr std::array continuing_words{
    "again",   "and",    "then",         "while",   "times", "twice", "repeatedly", "keep", "keeps",
    "circles", "circle", "continuously", "several", "many",  "jacks", "rope",       "walk", "walks",
    "walking", "run",    "runs",         "running", "u",     "wide",  "curve"};

}  // namespace detail

MOTIONLANG_BODY std::optional<NaturalLength> natural_length(std::string_view text) {
  const auto words = detail::lower_case_words(text);
  const auto says = [&](std::initializer_list<std::string_view> any) {
    return std::any_of(words.begin(), words.end(),
                       [&](const std::string& w) { return std::find(any.begin(), any.end(), w) != any.end(); });
  };
  if (std::any_of(detail::continuing_words.begin(), detail::continuing_words.end(),
                  [&](const char* w) { return says({w}); }))
    return {};
  const bool arm = says({"arm", "arms", "hand", "hands"});
  if (says({"turn", "turns", "turning"}) && says({"left", "right", "around"}) && !arm)
    return NaturalLength{2.4, "stand still"};
  if (says({"raise", "raises", "raising", "lift", "lifts", "lifting"}) && arm) {
    const bool both = says({"both", "arms", "hands"}), left = says({"left"});
    return NaturalLength{2.2,
                         both   ? "hold both arms up"
                         : left ? "hold the left arm up"
                                : "hold the right arm up",
                         true};
  }
  if (says({"sit", "sits", "sitting"}) && says({"down"})) return NaturalLength{2.8, "sit quietly"};
  if (says({"stand", "stands", "get", "gets"}) && says({"up"})) return NaturalLength{2.4, "stand still"};
  if (says({"jump", "jumps", "leap", "leaps"}) && !(says({"up"}) && says({"down"})))
    return NaturalLength{2.4, "stand still"};
  if (says({"bend", "bends", "bending", "bow", "bows", "bowing"}) && !says({"knees", "knee", "arm", "arms"}))
    return NaturalLength{2.2, "stand still", true};
  if (says({"kick", "kicks", "punch", "punches", "throw", "throws"})) return NaturalLength{2.4, "stand still"};
  return {};
}

MOTIONLANG_BODY Timeline end_actions(const Timeline& timeline, double fps) {
  if (!(timeline.body == BodyPartition{})) return timeline;
  Timeline out{{}, timeline.body};
  for (const Interval& whole : timeline.intervals) {
    const auto natural = natural_length(whole.text);
    Interval action = whole;
    if (natural && natural->from_rest && whole.start == 0 && whole.parts == BodyParts::all() &&
        whole.end >= frame_at(2, fps)) {
      out.intervals.push_back(whole);
      out.intervals.back().text = "stand still";
      out.intervals.back().end = action.start = frame_at(standing_lead_in, fps);
    }
    out.intervals.push_back(action);
    if (!natural || action.end - action.start < frame_at(natural->seconds + 1, fps)) continue;
    Interval rest = action;
    out.intervals.back().end = rest.start = action.start + frame_at(natural->seconds, fps);
    rest.text = natural->then;
    out.intervals.push_back(std::move(rest));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
