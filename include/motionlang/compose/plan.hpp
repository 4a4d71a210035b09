// SPDX-License-Identifier: MIT
/// From timelines to the integers of a composition: the crops to denoise, and the frames of each crop that are added to
/// or subtracted from frames of the motion, for each body part. There are no tensors here.
///
/// Source     thesis 6.2.3; STMC (Petrovich et al. 2024); reference: nv-tlabs/stmc src/stmc.py process_timelines
/// Notation   a, b -> start, end of an interval; T -> frames; O, l, r -> Overlap; x -> cut
/// Property   For every body part and frame, additions minus subtractions = 1, however close the cuts are. This holds
///            if extension and transition crops are both on or both off; see net_weights
/// Differs    from the reference, if the options say so: gaps are filled with the unconditional text "" (the reference
///            stops), and transitions at which no part changes can be left out
#pragma once

#include <span>         // several timelines
#include <string_view>  // texts of crops

#include <motionlang/compose/overlap.hpp>
#include <motionlang/compose/plan_options.hpp>
#include <motionlang/compose/sinc_assignment.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A range of the timeline that the denoiser sees as one sequence. Crops without frames (overlap 0) are kept, so that
/// numbers agree with the reference; they have no effect.
struct Crop {
  Index interval = 0;  // -1: a transition, with the unconditional text
  FrameRange range;
  bool is_transition() const { return interval < 0; }
  bool operator==(const Crop&) const = default;
};

/// A part belongs to one text for a range of frames. Neighbours have different owners.
struct PartInterval {
  BodyPart part{};
  Index owner = 0;
  FrameRange range;
  bool operator==(const PartInterval&) const = default;
};

/// The frames `from` of a crop become the frames `to` of the motion, for the features of one part.
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

/// Throws timeline_error 505 at a piece without a text.
void require_text(const Piece& piece);

/// Throws timeline_error 508 at a crop of more than `longest` frames (0: any number).
void check_crops(const TimelinePlan& plan, Index longest);

/// A plan with its pieces, which have no owners yet. Throws timeline_error 503 ... 505, 507, config_error 101.
TimelinePlan pieces_of(Timeline timeline, const PlanOptions& options);

/// Derives the plan from the owners of the pieces. Throws timeline_error 506, 508.
void finish_plan(TimelinePlan& plan, const PlanOptions& options);

}  // namespace detail

/// The plan of one timeline. `ties` decides between equal base texts: FirstWins, or a generator (see PlanOptions and
/// sinc_assignment.hpp).
/// Throws     timeline_error 503 (parts of another body), 504, 505 (gap), 506 (hidden text), 507, 508 (crop too long),
///            config_error 101
template <Shuffler G>
TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options, G& ties) {
  TimelinePlan plan = detail::pieces_of(std::move(timeline), options);
  for (const Piece& piece : plan.pieces) {
    detail::require_text(piece);
    plan.owners.push_back(assign_parts(plan.timeline, piece.intervals, ties));
  }
  detail::finish_plan(plan, options);
  return plan;
}
TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options = {});

/// Puts plans into one batch.
BatchPlan batch_plans(std::vector<TimelinePlan> plans);

/// Plans of all timelines, in order, with one generator.
template <Shuffler G>
BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options, G& ties) {
  std::vector<TimelinePlan> plans;
  for (const Timeline& t : timelines) plans.push_back(plan_timeline(t, options, ties));
  return batch_plans(std::move(plans));
}
BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options = {});

/// Smallest and largest number of additions minus subtractions over all parts and frames. Both are 1 in a plan that
/// extends and has transition crops, or does neither.
struct NetWeights {
  int smallest = 0, largest = 0;
};
NetWeights net_weights(const TimelinePlan& plan);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/plan.ipp>
#endif
