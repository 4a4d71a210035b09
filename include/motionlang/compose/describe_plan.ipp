// SPDX-License-Identifier: MIT
// Bodies of describe_plan.hpp.
#pragma once

#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/compose/describe_plan.hpp>
#include <motionlang/core/formatted.hpp>
#include <motionlang/core/utf8.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string names_of_parts(BodyParts parts, const BodyPartition& body) {
  std::vector<std::string> names;
  for (int p = 0; p < body.size(); ++p) {
    if (const auto part = static_cast<BodyPart>(p); parts.has(part)) names.push_back(body.name(part));
  }
  return join_text(names);
}

}  // namespace detail

MOTIONLANG_BODY std::string describe_timeline(const Timeline& timeline, double fps) {
  const auto seconds = [fps](Index frame) { return static_cast<double>(frame) / fps; };
  std::string out = formatted("timeline: %s, %.2f s\n", counted(std::ssize(timeline.intervals), "text").c_str(),
                              seconds(timeline.end()));
  for (const Interval& i : timeline.intervals)
    out += formatted("  %6.2f - %6.2f s  %s\n", seconds(i.start), seconds(i.end), printable(i.text).c_str());
  return out;
}

MOTIONLANG_BODY std::string describe_plan(const TimelinePlan& plan, double fps) {
  const auto seconds = [fps](Index frame) { return static_cast<double>(frame) / fps; };
  std::string out;
  for (const Interval& i : plan.timeline.intervals)
    out += formatted("  %6.2f - %6.2f s  %-40s %s\n", seconds(i.start), seconds(i.end),
                     i.text.empty() ? "(no text: moves freely)" : printable(i.text).c_str(),
                     detail::names_of_parts(i.parts, plan.timeline.body).c_str());
  for (int p = 0; p < plan.timeline.body.size(); ++p) {
    const auto own = static_cast<BodyPart>(p);
    out += formatted("  %-10s", plan.timeline.body.name(own).c_str());
    for (const PartInterval& part : plan.merged) {
      if (part.part != own) continue;
      const std::string& text = plan.timeline.intervals[static_cast<std::size_t>(part.owner)].text;
      out += formatted(" [%.2f-%.2f %s]", seconds(part.range.start), seconds(part.range.end),
                       text.empty() ? "-" : printable(text).c_str());
    }
    out += "\n";
  }
  return out;
}

MOTIONLANG_BODY std::string describe_plans(std::span<const Timeline> timelines, const PlanReportOptions& options) {
  const double fps = options.fps;
  std::string out;
  for (std::size_t m = 0; m < timelines.size(); ++m) {
    const Timeline timeline = options.cut_texts ? cut_texts(timelines[m], fps) : timelines[m];
    const auto plan = plan_timeline(timeline, {.overlap = frame_at(options.overlap, fps),
                                               .hidden = HiddenTexts::ignore,
                                               .longest_crop = options.longest_crop});
    const auto texts = timelines[m].intervals.size(), pieces = timeline.intervals.size();
    out += formatted("timeline %zu: %s, %.2f s, %s", m, counted(plan.frames, "frame").c_str(),
                     static_cast<double>(plan.frames) / fps, counted(texts, "text").c_str());
    if (pieces != texts) out += formatted(" cut into %zu", pieces);
    out += "\n" + describe_plan(plan, fps);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
