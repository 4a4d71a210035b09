// SPDX-License-Identifier: MIT
// Bodies of plan.hpp.
#pragma once

#include <algorithm>  // lower_bound, max
#include <limits>     // net weights

#include <motionlang/compose/plan.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string quoted(const Interval& i) { return concat_text("'", i.text, "' (", i.start, " to ", i.end, ")"); }

/// " (line 3, column 1)", nothing if the interval was not read from a text.
inline std::string place_of(const Interval& i) {
  return i.place.line == 0 ? "" : concat_text(" (line ", i.place.line, ", column ", i.place.column, ")");
}

inline void check_timeline(const Timeline& timeline) {
  if (timeline.intervals.empty()) raise<timeline_error>(507, "plan_timeline: no interval");
  for (const Interval& i : timeline.intervals) {
    if (i.start < 0 || i.end < i.start || i.end > latest_time) {
      raise<timeline_error>(504, "plan_timeline: ", quoted(i), " is not a range of frames of the motion");
    }
    if ((i.parts.bits & ~timeline.body.all().bits) != 0) {
      raise<timeline_error>(503, "plan_timeline: ", quoted(i), " moves other body parts than ", timeline.body);
    }
  }
  if (timeline.end() == 0) raise<timeline_error>(504, "plan_timeline: the timeline has no frame");
}

MOTIONLANG_BODY void require_text(const Piece& piece) {
  if (!piece.intervals.empty()) return;
  raise<timeline_error>(505, "plan_timeline: no text covers frames ", piece.start, " to ", piece.end);
}

/// Joins neighbouring pieces of a part that have the same owner.
inline void merge_pieces(TimelinePlan& plan) {
  const auto parts = static_cast<std::size_t>(plan.timeline.body.size());
  for (std::size_t p = 0; p < parts; ++p) {
    for (std::size_t k = 0; k < plan.pieces.size(); ++k) {
      const Piece& piece = plan.pieces[k];
      const Index owner = plan.owners[k][p];
      if (k > 0 && plan.owners[k - 1][p] == owner)
        plan.merged.back().range.end = piece.end;
      else
        plan.merged.push_back({static_cast<BodyPart>(p), owner, {piece.start, piece.end}});
    }
  }
}

/// The cuts with a transition, ascending: all except the first and the last. At a cut where no part changes its owner,
/// it throws timeline_error 506 or leaves the cut out.
inline std::vector<Index> transition_cuts(const TimelinePlan& plan, HiddenTexts hidden) {
  std::vector<Index> cuts;
  for (std::size_t k = 1; k < plan.pieces.size(); ++k) {
    const Index cut = plan.pieces[k].start;
    if (plan.owners[k] != plan.owners[k - 1]) {
      cuts.push_back(cut);
    } else if (hidden == HiddenTexts::refuse) {
      for (const Interval& i : plan.timeline.intervals) {
        if (i.start != cut && i.end != cut) continue;
        raise<timeline_error>(506, "plan_timeline: ", quoted(i), " owns no body part at frame ", cut,
                              ": other texts hide it; give it parts that no text with fewer parts takes", place_of(i));
      }
    }
  }
  return cuts;
}

MOTIONLANG_BODY void check_crops(const TimelinePlan& plan, Index longest) {
  for (const Crop& c : plan.crops) {
    if (longest == 0 || c.range.size() <= longest) continue;
    raise<timeline_error>(508, "timeline: '", plan.text(c), "' needs a crop of ", counted(c.range.size(), "frame"),
                          " with its overlap; the denoiser accepts ", longest,
                          c.is_transition() ? ""
                                            : place_of(plan.timeline.intervals[static_cast<std::size_t>(c.interval)]) +
                                                  ". Divide it into shorter ones");
  }
}

inline void make_crops(TimelinePlan& plan, const std::vector<Index>& cuts, const Overlap& overlap,
                       const PlanOptions& options) {
  for (std::size_t i = 0; i < plan.timeline.intervals.size(); ++i) {
    const FrameRange range{plan.timeline.intervals[i].start, plan.timeline.intervals[i].end};
    plan.crops.push_back({static_cast<Index>(i), options.extend ? overlap.extend(range, plan.frames) : range});
  }
  if (options.transition_crops) {
    for (Index cut : cuts) plan.crops.push_back({-1, overlap.window(cut, plan.frames)});
  }
  check_crops(plan, options.longest_crop);
}

/// For each stretch of a part, its extended frames are added from the crop of its owner. At its start, the window of
/// the transition, which both neighbours have added, is subtracted once.
inline void make_slices(TimelinePlan& plan, const std::vector<Index>& cuts, const Overlap& overlap,
                        const PlanOptions& options) {
  const auto texts = static_cast<Index>(plan.timeline.intervals.size());
  for (const PartInterval& m : plan.merged) {
    const FrameRange to = options.extend ? overlap.extend(m.range, plan.frames) : m.range;
    const Index begin = plan.crops[static_cast<std::size_t>(m.owner)].range.start;
    plan.add.push_back({m.part, m.owner, {to.start - begin, to.end - begin}, to});

    const auto cut = std::lower_bound(cuts.begin(), cuts.end(), m.range.start);
    if (cut == cuts.end() || *cut != m.range.start) continue;  // the beginning
    const Index transition = cut - cuts.begin();
    const FrameRange window = overlap.window(*cut, plan.frames);
    plan.lerp.push_back({m.part, transition, window});
    if (options.transition_crops) plan.subtract.push_back({m.part, texts + transition, {0, window.size()}, window});
  }
}

MOTIONLANG_BODY TimelinePlan pieces_of(Timeline timeline, const PlanOptions& options) {
  check_timeline(timeline);
  Overlap::of_frames(options.overlap);
  TimelinePlan plan;
  if (options.gaps == Gaps::fill) fill_gaps(timeline);
  plan.timeline = std::move(timeline);
  plan.frames = plan.timeline.end();
  plan.pieces = elementary_pieces(plan.timeline);
  const Index first = plan.pieces.empty() ? plan.frames : plan.pieces.front().start;
  if (first > 0) raise<timeline_error>(505, "plan_timeline: no text covers frames 0 to ", first);
  return plan;
}

MOTIONLANG_BODY void finish_plan(TimelinePlan& plan, const PlanOptions& options) {
  const Overlap overlap = Overlap::of_frames(options.overlap);
  merge_pieces(plan);
  const std::vector<Index> cuts = transition_cuts(plan, options.hidden);
  make_crops(plan, cuts, overlap, options);
  make_slices(plan, cuts, overlap, options);
}

}  // namespace detail

MOTIONLANG_BODY TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options) {
  FirstWins ties;
  return plan_timeline(std::move(timeline), options, ties);
}

MOTIONLANG_BODY BatchPlan batch_plans(std::vector<TimelinePlan> plans) {
  BatchPlan batch;
  batch.timelines = std::move(plans);
  for (const TimelinePlan& plan : batch.timelines) {
    batch.first_crop.push_back(batch.first_crop.back() + std::ssize(plan.crops));
    batch.frames = std::max(batch.frames, plan.frames);
  }
  return batch;
}

MOTIONLANG_BODY BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options) {
  FirstWins ties;
  return plan_timelines(timelines, options, ties);
}

MOTIONLANG_BODY NetWeights net_weights(const TimelinePlan& plan) {
  NetWeights net{std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  for (int p = 0; p < plan.timeline.body.size(); ++p) {
    std::vector<std::pair<Index, int>> steps{{0, 0}, {plan.frames, 0}};  // frame, change of the weight
    const auto count = [&](const std::vector<Slice>& slices, int weight) {
      for (const Slice& s : slices) {
        if (s.part != static_cast<BodyPart>(p)) continue;
        steps.emplace_back(s.to.start, weight), steps.emplace_back(s.to.end, -weight);
      }
    };
    count(plan.add, 1), count(plan.subtract, -1);
    detail::sort(steps, [](const auto& a, const auto& b) { return a < b; });
    int weight = 0;
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
      weight += steps[i].second;
      if (steps[i].first == steps[i + 1].first) continue;
      net = {std::min(net.smallest, weight), std::max(net.largest, weight)};
    }
  }
  return net;
}

MOTIONLANG_NAMESPACE_END
