// SPDX-License-Identifier: MIT
// Bodies of text_timeline.hpp.
#pragma once

#include <algorithm>  // all_of, clamp, max
#include <vector>     // actions in turn

#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/compose/in_turn.hpp>
#include <motionlang/compose/long_texts.hpp>
#include <motionlang/compose/natural_lengths.hpp>
#include <motionlang/compose/text_timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::optional<KnownAction> usual_action(const std::string& text, const KnownCaptions& captions) {
  if (const auto natural = natural_length(text))
    return KnownAction{.seconds = natural->seconds + (natural->from_rest ? standing_lead_in : 0),
                       .repeats = false,
                       .then = natural->then};
  const auto texts = actions_in_turn(text);
  if (texts.size() == 1) return captions.action(text);
  auto all = usual_action(texts.back(), captions);
  if (!all) return std::nullopt;
  all->seconds = 0;
  for (const std::string& t : texts) all->seconds += usual_seconds(t, captions);
  return all;
}

MOTIONLANG_BODY double usual_seconds(const std::string& text, const KnownCaptions& captions) {
  constexpr double shortest = 1.2, shortest_repeated = 4;
  const auto action = usual_action(text, captions);
  if (!action || captions.empty()) return text_seconds;
  return std::clamp(action->seconds, action->repeats ? shortest_repeated : shortest, longest_whole_text);
}

MOTIONLANG_BODY std::vector<std::string> known_in_turn(const std::string& text, const KnownCaptions& captions) {
  constexpr double same = 0.85, nearly_same = 0.75;
  const auto likeness = [&](const std::string& action) {
    const auto near = captions.nearest(action, 1);
    return near.empty() ? 0.0 : near.front().likeness;
  };
  const auto all_are = [&](const std::vector<std::string>& actions, double least) {
    return actions.size() > 1 && std::all_of(actions.begin(), actions.end(),
                                             [&](const std::string& action) { return likeness(action) >= least; });
  };
  auto listed = listed_in_turn(text);
  if (captions.empty() || listed.size() == 1 || likeness(text) >= same) return {text};
  if (all_are(listed, nearly_same)) return listed;
  const auto actions = actions_in_turn(text);
  return all_are(actions, captions.nearness()) ? actions : std::vector<std::string>{text};
}

MOTIONLANG_BODY Timeline text_timeline(const std::string& text, const KnownCaptions& captions,
                                       const TextTimelineOptions& options) {
  const bool too_long = options.end_actions && options.seconds.value_or(0) > longest_whole_text;
  const auto texts = options.in_turn || too_long ? actions_in_turn(text)
                     : options.end_actions       ? known_in_turn(text, captions)
                                                 : std::vector<std::string>{text};
  std::vector<Interval> intervals;
  if (options.seconds) {
    const Interval whole{text, 0, frame_at(*options.seconds, options.fps), BodyParts::all()};
    if (whole.end < std::ssize(texts))
      raise<config_error>(101, "text_timeline: '", text, "' has ", counted(texts.size(), "action"), " in ",
                          counted(whole.end, "frame"));
    intervals = detail::equal_parts(whole, std::ssize(texts));
  }
  Timeline out;
  Index start = 0;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const Index end =
        options.seconds ? intervals[i].end : start + frame_at(usual_seconds(texts[i], captions), options.fps);
    out.intervals.push_back({texts[i], start, end, BodyParts::all()});
    const auto action = usual_action(texts[i], captions);
    // end_actions, which cut_texts calls, ends the natural lengths. It knows when the figure has to stand before them.
    const bool ends =
        options.end_actions && !captions.empty() && action && !action->repeats && !natural_length(texts[i]);
    const Index over = action ? start + frame_at(usual_seconds(texts[i], captions), options.fps) : end;
    if (ends && end >= over + frame_at(1, options.fps)) {
      out.intervals.back().end = over;
      out.intervals.push_back({action->then, over, end, BodyParts::all()});
    }
    start = end;
  }
  return out;
}

MOTIONLANG_BODY bool outlasts_action(const Interval& interval, const KnownCaptions& captions, double fps) {
  const auto action = usual_action(interval.text, captions);
  return action && !action->repeats &&
         static_cast<double>(interval.end - interval.start) / fps > std::max(2 * action->seconds, action->seconds + 2);
}

MOTIONLANG_NAMESPACE_END
