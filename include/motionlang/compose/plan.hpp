// SPDX-License-Identifier: MIT
/// From timelines to the integers of a composition: which crops to denoise, and which frames of which crop are added to
/// and subtracted from which frames of the motion, for each body part. No tensors here.
///
/// Source     STMC (Petrovich et al. 2024), section 3.3; spec stmc.md 3; reference: nv-tlabs/stmc src/stmc.py
/// Notation   a, b -> start, end of an interval; T -> frames; O, l, r -> Overlap; x -> cut
/// Property   for every body part and frame, additions minus subtractions = 1, however close the cuts are, if extension
///            and transition crops are both on or both off; see net_weights
/// Differs    from the reference, where told to: gaps are filled with the unconditional text "" (the reference stops),
///            and transitions at which no part changes can be left out
#pragma once

#include <algorithm>    // lower_bound, max
#include <limits>       // net weights
#include <span>         // several timelines
#include <string_view>  // texts of crops

#include <motionlang/compose/overlap.hpp>
#include <motionlang/compose/plan_options.hpp>
#include <motionlang/compose/sinc_assignment.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A stretch of the timeline that the denoiser sees as one sequence. Crops without frames (overlap 0) are kept, so that
/// numbers agree with the reference; they take part in nothing.
struct Crop {
  Index interval = 0;  // -1: a transition, with the unconditional text
  FrameRange range;
  bool is_transition() const { return interval < 0; }
  bool operator==(const Crop&) const = default;
};

/// A part belongs to one text for a stretch; neighbours have different owners.
struct PartInterval {
  BodyPart part{};
  Index owner = 0;
  FrameRange range;
  bool operator==(const PartInterval&) const = default;
};

/// Frames `from` of a crop go to frames `to` of the motion, for the features of one part.
struct Slice {
  BodyPart part{};
  Index crop = 0;
  FrameRange from, to;
  bool operator==(const Slice&) const = default;
};

/// A window in which a part changes its owner, for interpolation instead of blending (the SINC+lerp baseline).
struct LerpWindow {
  BodyPart part{};
  Index transition = 0;
  FrameRange range;
  bool operator==(const LerpWindow&) const = default;
};

/// Everything about one timeline. All lists are sorted by part, then by time.
struct TimelinePlan {
  Timeline timeline;                 // gaps filled
  Index frames = 0;                  // T
  std::vector<Piece> pieces;         // between cuts
  std::vector<PartOwners> owners;    // on each piece
  std::vector<PartInterval> merged;  // before extension
  std::vector<Crop> crops;           // one for each interval, then the transitions by time
  std::vector<Slice> add, subtract;
  std::vector<LerpWindow> lerp;  // also without transition crops

  /// "" for transitions.
  std::string_view text(const Crop& crop) const {
    if (crop.is_transition()) return {};
    return timeline.intervals[static_cast<std::size_t>(crop.interval)].text;
  }
};

/// Several timelines that are sampled together. The crops of timeline m have the numbers first_crop[m] ...
/// first_crop[m + 1] - 1 in the batch; slices count crops from the first one of their timeline.
struct BatchPlan {
  std::vector<TimelinePlan> timelines;
  std::vector<Index> first_crop{0};
  Index frames = 0;  // of the longest timeline

  Index crops() const { return first_crop.back(); }
};

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
  }
  if (timeline.end() == 0) raise<timeline_error>(504, "plan_timeline: the timeline has no frame");
}

/// Owners piece by piece, in time order. Throws timeline_error 505 at a piece without a text.
template <Shuffler G>
void assign_pieces(TimelinePlan& plan, G& ties) {
  plan.pieces = elementary_pieces(plan.timeline);
  const Index first = plan.pieces.empty() ? plan.frames : plan.pieces.front().start;
  if (first > 0) raise<timeline_error>(505, "plan_timeline: no text covers frames 0 to ", first);
  for (const Piece& piece : plan.pieces) {
    if (piece.intervals.empty()) {
      raise<timeline_error>(505, "plan_timeline: no text covers frames ", piece.start, " to ", piece.end);
    }
    plan.owners.push_back(assign_parts(plan.timeline, piece.intervals, ties));
  }
}

/// Joins neighbouring pieces of a part that have the same owner.
inline void merge_pieces(TimelinePlan& plan) {
  for (std::size_t p = 0; p < body_part_count; ++p) {
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

/// The cuts at which a transition is made, ascending: all but the first and the last. Throws timeline_error 506 at one
/// where no part changes its owner, or leaves it out.
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

/// Throws timeline_error 508 at a crop of more than `longest` frames (0: any number).
inline void check_crops(const TimelinePlan& plan, Index longest) {
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

/// For each stretch of a part: its extended frames are added from the crop of its owner; where it starts, the window of
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

}  // namespace detail

/// The plan of one timeline. `ties` decides between equal base texts: FirstWins, or a generator (see PlanOptions and
/// sinc_assignment.hpp).
/// Throws     timeline_error 504, 505 (gap), 506 (hidden text), 507, 508 (crop too long), config_error 101
template <Shuffler G>
TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options, G& ties) {
  detail::check_timeline(timeline);
  const Overlap overlap = Overlap::of_frames(options.overlap);
  TimelinePlan plan;
  if (options.gaps == Gaps::fill) fill_gaps(timeline);
  plan.timeline = std::move(timeline);
  plan.frames = plan.timeline.end();
  detail::assign_pieces(plan, ties);
  detail::merge_pieces(plan);
  const std::vector<Index> cuts = detail::transition_cuts(plan, options.hidden);
  detail::make_crops(plan, cuts, overlap, options);
  detail::make_slices(plan, cuts, overlap, options);
  return plan;
}
inline TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options = {}) {
  FirstWins ties;
  return plan_timeline(std::move(timeline), options, ties);
}

/// Puts plans into one batch.
inline BatchPlan batch_plans(std::vector<TimelinePlan> plans) {
  BatchPlan batch;
  batch.timelines = std::move(plans);
  for (const TimelinePlan& plan : batch.timelines) {
    batch.first_crop.push_back(batch.first_crop.back() + std::ssize(plan.crops));
    batch.frames = std::max(batch.frames, plan.frames);
  }
  return batch;
}

/// Plans of all timelines, in order, with one generator.
template <Shuffler G>
BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options, G& ties) {
  std::vector<TimelinePlan> plans;
  for (const Timeline& t : timelines) plans.push_back(plan_timeline(t, options, ties));
  return batch_plans(std::move(plans));
}
inline BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options = {}) {
  FirstWins ties;
  return plan_timelines(timelines, options, ties);
}

/// Smallest and largest number of additions minus subtractions over all parts and frames. Both are 1 in a plan that
/// extends and has transition crops, or does neither.
struct NetWeights {
  int smallest = 0, largest = 0;
};
inline NetWeights net_weights(const TimelinePlan& plan) {
  NetWeights net{std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  for (int p = 0; p < body_part_count; ++p) {
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
