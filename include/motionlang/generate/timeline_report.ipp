// SPDX-License-Identifier: MIT
// Bodies of timeline_report.hpp.
#pragma once

#include <motionlang/compose/detail/timeline_parser.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/generate/text_warnings.hpp>
#include <motionlang/generate/timeline_report.hpp>
#include <motionlang/view/track.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The numbers of the texts that a warning is about. It begins with the place of one text, which is taken out of the
/// message, or else with the words of a text, which may stand there several times.
inline nlohmann::ordered_json warned_texts(const Timeline& timeline, std::string_view source, std::string& message) {
  nlohmann::ordered_json texts = nlohmann::ordered_json::array();
  const auto begins = [&](const std::string& with) { return message.compare(0, with.size(), with) == 0; };
  for (std::size_t i = 0; i < timeline.intervals.size(); ++i) {
    const Interval& interval = timeline.intervals[i];
    const std::string place = concat_text(source, ":", interval.place.line, ":", interval.place.column, ": ");
    if (begins(place)) {
      message.erase(0, place.size());
      return nlohmann::ordered_json::array({i});
    }
    if (begins(concat_text("'", interval.text, "'"))) texts.push_back(i);
  }
  return texts;
}

inline nlohmann::ordered_json part_names(BodyParts parts, const BodyPartition& body) {
  if (parts == body.all()) return nlohmann::ordered_json::array({whole_body});
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  for (const BodyPart p : listed_parts(parts)) names.push_back(to_string(p));
  return names;
}

}  // namespace detail

MOTIONLANG_BODY std::string timeline_report(const MotionModel& model, std::string_view text,
                                            const GenerateOptions& options) {
  constexpr std::string_view source = "timeline";
  const auto [frames, timeline] =
      detail::parse_timeline_in_both(text, TimelineTextOptions{.fps = model.fps(), .name = source});
  nlohmann::ordered_json texts = nlohmann::ordered_json::array(), warnings = nlohmann::ordered_json::array();
  std::vector<std::string> messages;
  for (const IntervalInSeconds& i : timeline.intervals) {
    texts.push_back(
        {{"text", i.text}, {"start", i.start}, {"end", i.end}, {"parts", detail::part_names(i.parts, timeline.body)}});
    for (std::string& m : text_warnings(model, i.text)) {
      if (std::find(messages.begin(), messages.end(), m) == messages.end()) messages.push_back(std::move(m));
    }
  }
  for (std::string& m : timeline_warnings(model, std::span(&frames, 1), options, false,
                                          {.source = source, .in_turn = "a text for each action"}))
    messages.push_back(std::move(m));
  for (std::string& m : messages) {
    nlohmann::ordered_json about = detail::warned_texts(frames, source, m);
    warnings.push_back({{"texts", std::move(about)}, {"message", m}});
  }
  const nlohmann::ordered_json report{{"fps", model.fps()},
                                      {"seconds", timeline.end()},
                                      {"texts", std::move(texts)},
                                      {"warnings", std::move(warnings)}};
  return detail::json_text(report);
}

MOTIONLANG_BODY std::string known_texts_report(std::span<const KnownText> texts) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const KnownText& t : texts)
    out.push_back({{"text", t.text}, {"seconds", t.action.seconds}, {"repeats", t.action.repeats}});
  return detail::json_text(out);
}

MOTIONLANG_NAMESPACE_END
