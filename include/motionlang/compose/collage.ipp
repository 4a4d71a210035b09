// SPDX-License-Identifier: MIT
// Bodies of collage.hpp.
#pragma once

#include <limits>  // any number of rows
#include <map>     // equal sequences

#include <motionlang/compose/collage.hpp>
#include <motionlang/core/sort.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Frames of a crop with a text, which the network reads as one sequence.
struct CropJob {
  Index first, length, text;                         // first: row of the motions
  auto operator<=>(const CropJob&) const = default;  // NOLINT(modernize-use-nullptr): there is no 0
};

/// For a network whose sequences depend on each other: as published, all crops in their order, and then the same
/// without their texts.
inline JobBatches two_calls(const CropRows& crops, std::span<const Index> texts, Index null, bool guided) {
  JobBatches out;
  const Index rows = crops.offsets.rows();
  for (const bool with_text : {true, false}) {
    if (!with_text && !guided) break;
    std::vector<Index> lengths, which;
    for (Index i = 0; i < crops.offsets.count(); ++i) {
      if (crops.offsets.length(i) == 0) continue;
      lengths.push_back(crops.offsets.length(i));
      which.push_back(with_text ? texts[static_cast<std::size_t>(i)] : null);
    }
    const Offsets frames(lengths);
    out.batches.push_back({crops.rows, frames, Offsets::equal(frames.count(), 1), which});
    for (Index r = 0; r < rows; ++r) (with_text ? out.cond : out.null).push_back(with_text ? r : rows + r);
  }
  return out;
}

MOTIONLANG_BODY JobBatches plan_jobs(const CropRows& crops, std::span<const Index> texts, Index null,
                                     const JobOptions& options) {
  if (!options.divide) return two_calls(crops, texts, null, options.guided);
  std::vector<std::pair<CropJob, CropJob>> pairs;  // with its text, and without
  std::map<CropJob, Index> begin;                  // the first row of each job in the batch
  for (Index i = 0; const Index text : texts) {
    const Index length = crops.offsets.length(i);
    const Index first = length == 0 ? 0 : crops.rows[static_cast<std::size_t>(crops.offsets.begin(i))];
    pairs.push_back({{first, length, text}, {first, length, null}});
    ++i;
    if (length == 0) continue;
    begin[pairs.back().first];
    if (options.guided) begin[pairs.back().second];
  }
  std::vector<CropJob> jobs;
  jobs.reserve(begin.size());
  for (const auto& [job, at] : begin) jobs.push_back(job);
  sort(jobs, [](const CropJob& a, const CropJob& b) { return a.length != b.length ? a.length > b.length : a < b; });

  const Index most = options.rows_at_once > 0 ? options.rows_at_once : std::numeric_limits<Index>::max();
  JobBatches out;
  std::vector<Index> rows, lengths, uses, which;  // of the next batch
  Index results = 0, before = 0;                  // rows of its results, and of all earlier batches
  const CropJob* last = nullptr;                  // of the batch
  const auto end_batch = [&] {
    out.batches.push_back({rows, Offsets(lengths), Offsets(uses), which});
    before += results;
    results = 0, last = nullptr;
    rows.clear(), lengths.clear(), uses.clear(), which.clear();
  };
  for (const CropJob& job : jobs) {
    if (last != nullptr && results + job.length > most) end_batch();
    begin[job] = before + results;
    results += job.length;
    which.push_back(job.text);
    if (last != nullptr && last->first == job.first && last->length == job.length) {
      ++uses.back();
    } else {
      for (Index r = 0; r < job.length; ++r) rows.push_back(job.first + r);
      lengths.push_back(job.length);
      uses.push_back(1);
    }
    last = &job;
  }
  end_batch();
  for (const auto& [with, without] : pairs) {
    for (Index r = 0; r < with.length; ++r) {
      out.cond.push_back(begin[with] + r);
      if (options.guided) out.null.push_back(begin[without] + r);
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<Index> texts_of_crops(const BatchPlan& plan, Index null) {
  std::vector<Index> out;
  std::map<std::string_view, Index> known{{"", null}};
  Index first = 0;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Crop& c : p.crops)
      out.push_back(c.is_transition() ? null : known.emplace(p.text(c), first + c.interval).first->second);
    first += static_cast<Index>(p.timeline.intervals.size());
  }
  return out;
}

MOTIONLANG_BODY void check_texts(const BatchPlan& plan, Index texts, Index nulls) {
  Index intervals = 0;
  for (const TimelinePlan& p : plan.timelines) intervals += static_cast<Index>(p.timeline.intervals.size());
  if (texts == intervals && nulls == 1) return;
  raise<shape_error>(204, "Collage: ", counted(texts, "text"), " for ", counted(intervals, "interval"), "; ",
                     counted(nulls, "unconditional text"));
}

MOTIONLANG_BODY CropRows own_frames(const BatchPlan& plan, Index stride, Index crop_frames) {
  CropRows out = CropRows::of(plan);
  for (Index& row : out.rows) {  // the same frames in motions with more rows
    const Index m = row / plan.frames;
    row += m * crop_frames;
  }
  out.stride = stride;
  return out;
}

MOTIONLANG_BODY Offsets joined(const Offsets& a, const Offsets& b) {
  std::vector<Index> lengths;
  for (const Offsets* o : {&a, &b}) {
    for (Index i = 0; i < o->count(); ++i) lengths.push_back(o->length(i));
  }
  return Offsets(lengths);
}

}  // namespace detail

MOTIONLANG_BODY BatchPlan independent_plan(const BatchPlan& plan, Index frames) {
  std::vector<TimelinePlan> alone;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Interval& i : p.timeline.intervals) {
      const BodyPartition& body = p.timeline.body;
      alone.push_back(plan_timeline({{{i.text, 0, frames > 0 ? frames : i.end - i.start, body.all()}}, body}));
    }
  }
  return batch_plans(std::move(alone));
}

MOTIONLANG_NAMESPACE_END
