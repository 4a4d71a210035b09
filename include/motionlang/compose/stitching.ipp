// SPDX-License-Identifier: MIT
// Bodies of stitching.hpp.
#pragma once

#include <motionlang/compose/stitching.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY CropRows CropRows::of(const BatchPlan& plan, Index crop_frames) {
  CropRows out;
  out.stride = plan.frames + crop_frames;
  std::vector<Index> lengths;
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    for (const Crop& c : plan.timelines[m].crops) {
      const Index n = crop_frames > 0 && c.range.size() > 0 ? crop_frames : c.range.size();
      for (Index i = 0; i < n; ++i) out.rows.push_back(static_cast<Index>(m) * out.stride + c.range.start + i);
      lengths.push_back(n);
    }
  }
  out.offsets = Offsets(lengths);
  return out;
}

namespace detail {

MOTIONLANG_BODY PartMoves moves_of_part(const BatchPlan& plan, const Offsets& crops, Index stride, BodyPart part) {
  PartMoves out;
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    auto take = [&](const std::vector<Slice>& slices, signed char sign) {
      for (const Slice& slice : slices) {
        if (slice.part != part) continue;
        const Index from = crops.begin(plan.first_crop[m] + slice.crop) + slice.from.start;
        for (Index i = 0; i < slice.to.size(); ++i) {
          out.from.push_back(from + i);
          out.to.push_back(static_cast<Index>(m) * stride + slice.to.start + i);
          out.sign.push_back(sign);
        }
      }
    };
    take(plan.timelines[m].add, 1);
    take(plan.timelines[m].subtract, -1);
  }
  return out;
}

MOTIONLANG_BODY void check_layout(const FeatureLayout& layout, const BatchPlan& plan) {
  layout.validate();
  for (const TimelinePlan& p : plan.timelines) {
    if (p.timeline.body == layout.body) continue;
    raise<config_error>(102, "FeatureLayout '", layout.name, "' is of a body of ", layout.body, "; the timeline's has ",
                        p.timeline.body);
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
