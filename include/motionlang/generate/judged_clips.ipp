// SPDX-License-Identifier: MIT
// Bodies of judged_clips.hpp.
#pragma once

#include <algorithm>  // any_of, max

#include <motionlang/core/quantile.hpp>
#include <motionlang/generate/judged_clips.hpp>
#include <motionlang/kinematics/floor_fix.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool stands_on_floor(const CaptionedSegment& segment) {
  for (const std::string& caption : segment.captions) {
    for (const char* thing :
         {"climb", "ladder", "stair", "stool", "step up", "step down", "platform", "slope", "uphill", "downhill",
          "uneven", "swing on", "hang", "bar", "seat", "chair", "three steps", "sit"})
      if (caption.find(thing) != std::string::npos) return false;
  }
  return std::abs(quantile(heights_over_floor(segment.motion), 0.05)) < 0.04;
}

MOTIONLANG_BODY RecordedFigures judge_recordings(const std::vector<CaptionedSegment>& segments) {
  RecordedFigures out;
  for (const char* name : {"longest time above the floor, s", "time sunk in, s", "still share",
                           "turned on flat soles, degrees", "flights off their arc, m", "flights, s",
                           "stand_on_floor: largest change, mm", "lift_sunken_feet: largest change, mm"})
    out.measures.push_back({name});
  for (const JudgedVerb& v : judged_verbs()) out.verbs.push_back({v.name});
  const EyeLimits limits;
  for (const CaptionedSegment& s : segments) {
    const bool grounded = stands_on_floor(s);
    const MotionTrace t = trace_motion(s.motion);
    (grounded ? out.segments : out.elsewhere) += 1;
    if (grounded) {
      const double hover = longest_hover(t), sunken = sunken_seconds(t), still = still_share(t);
      out.hovering += hover > limits.hover, out.sinking += sunken > limits.sunken, out.statues += still > limits.still;
      const auto changed = [&](const Motion& by) {
        double change = 0;
        const auto before = s.motion.positions(), after = by.positions();
        for (std::size_t i = 0; i < before.size(); ++i) change = std::max(change, norm(after[i] - before[i]));
        return 1000 * change;
      };
      std::size_t m = 0;
      for (const double value : {hover, sunken, still, turned_on_flat_soles(t)})
        out.measures[m++].values.push_back(value);
      for (const Flight& f : flights(t, 0.08))
        out.measures[4].values.push_back(f.off_arc), out.measures[5].values.push_back(f.seconds);
      out.measures[6].values.push_back(changed(stand_on_floor(s.motion)));
      out.measures[7].values.push_back(changed(lift_sunken_feet(s.motion)));
    }
    for (std::size_t v = 0; v < judged_verbs().size(); ++v) {
      const JudgedVerb& verb = judged_verbs()[v];
      if (!std::any_of(s.captions.begin(), s.captions.end(), [&](const auto& c) { return says(verb, c); })) continue;
      RecordedVerb& of = out.verbs[v];
      const Verdict judged = verdict({{{verb.name, verb.name}}, t.seconds()}, s.motion);
      ++of.segments;
      if (judged.why_not.empty())
        ++of.done;
      else
        of.why_not.push_back(s.clip + ": " + judged.why_not);
      of.speed.push_back(judged.speed), of.air.push_back(judged.air), of.turned.push_back(judged.turned);
    }
  }
  for (double* share : {&out.hovering, &out.sinking, &out.statues})
    *share /= static_cast<double>(std::max<std::size_t>(1, out.segments));
  return out;
}

MOTIONLANG_NAMESPACE_END
