// SPDX-License-Identifier: MIT
/// The timeline of a text without times: how long its action takes, and what follows if there is more time.
///
///     const auto captions = load_known_captions(path, stmc.text_encoder);
///     const auto usual = text_timeline("kick", captions, {});                  // as long as a kick
///     const auto longer = text_timeline("kick", captions, {.seconds = 4});     // one kick, then "stand still"
///
/// Without captions a text lasts text_seconds, if nothing else is wanted.
#pragma once

#include <optional>  // times that are left out
#include <string>    // texts

#include <motionlang/compose/timeline.hpp>
#include <motionlang/text/known_captions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Seconds of a text that no rule is about.
inline constexpr double text_seconds = 5;

struct TextTimelineOptions {
  std::optional<double> seconds{};  // none: those that the action takes
  double fps = 20;
  bool end_actions = true;  // what ends is not made longer: another text follows
  bool in_turn = false;     // the actions of the text follow each other (compose/in_turn.hpp)
};

/// The action of a text: by its words (compose/natural_lengths.hpp), whose times were tried with a model; if they say
/// nothing, by the captions near it. Several actions in turn take the sum of their times, and end like the last one.
std::optional<KnownAction> usual_action(const std::string& text, const KnownCaptions& captions);

/// Seconds for a text: at least 1.2 for an action that ends, and 4 for one that repeats; at most longest_whole_text.
/// text_seconds if the action is not known, or no captions are.
double usual_seconds(const std::string& text, const KnownCaptions& captions);

/// The actions of a text that no caption says as a whole (likeness below 0.85), if captions know each of them: "walk
/// forward, wave and sit down". Commas separate actions if each has a caption nearly like it (0.75). Otherwise the
/// text.
std::vector<std::string> known_in_turn(const std::string& text, const KnownCaptions& captions);

/// The whole body does what the text says. Actions that are known are made in turn (known_in_turn). All actions are, if
/// they last longer than longest_whole_text, because a text that is cut would start again. If an action ends and has
/// at least a second more than it takes, the text of what follows takes the rest, unless no captions are known. All of
/// this is only done if actions end.
Timeline text_timeline(const std::string& text, const KnownCaptions& captions, const TextTimelineOptions& options = {});

/// True if the action of the text ends, and the interval is more than twice as long and more than two seconds longer.
bool outlasts_action(const Interval& interval, const KnownCaptions& captions, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/text_timeline.ipp>
#endif
