// SPDX-License-Identifier: MIT
/// Remembered motions for the texts of a collage, which its clean estimates follow.
///
/// A network that was trained on few gestures makes poses that are right and hardly move. A model may therefore
/// remember some motions. In every step, the clean estimate of a crop whose text has one is drawn towards it:
///
///     x0 = (1 - recall) x0 + recall remembered
///
/// The frames of a crop before and after its text have the first and the last row, with its speed. Other crops are the
/// network's, so it makes the passages between texts. Stitching combines the motion with the texts of other parts.
///
/// Source  ours; the idea is that of replacing known parts of a clean estimate (Lugmayr et al. 2022, "RePaint")
#pragma once

#include <algorithm>  // clamp
#include <cmath>      // erfc
#include <vector>     // motions

#include <motionlang/compose/motion_recall.hpp>
#include <motionlang/compose/plan.hpp>
#include <motionlang/features/normalizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A remembered motion in a crop of a batch.
template <Backend B>
struct RecalledMotion {
  Index crop = 0;       // in the batch
  Tensor<B, 2> rows{};  // (frames of the crop, features), normalised
};

/// The motions for all texts of a plan. The first value of a timeline's noise chooses among several, so the same noise
/// gives the same motion, alone and in a batch.
/// noise  the initial one, (timelines * stride, features)
template <Backend B>
std::vector<RecalledMotion<B>> recalled_motions(const MotionRecall& memory, const BatchPlan& plan,
                                                const Tensor<B, 2>& noise, Index stride,
                                                const Normalizer<B>& normalizer) {
  using S = typename B::scalar;
  std::vector<RecalledMotion<B>> out;
  const Index width = noise.size(1);
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    const TimelinePlan& p = plan.timelines[m];
    const auto z = noise.span()[m * static_cast<std::size_t>(stride * width)];
    const double choice = std::erfc(-static_cast<double>(z) / std::sqrt(2.0)) / 2;  // uniform in 0 ... 1
    for (std::size_t c = 0; c < p.crops.size(); ++c) {
      const Crop& crop = p.crops[c];
      if (crop.is_transition() || crop.range.size() == 0) continue;
      const Interval& text = p.timeline.intervals[static_cast<std::size_t>(crop.interval)];
      const Index frames = text.end - text.start;
      const std::vector<double> values = memory.features(text.text, frames, choice);
      if (values.empty()) continue;
      if (std::ssize(values) != frames * width)
        raise<shape_error>(205, "recalled_motions: ", values.size(), " values for '", text.text, "', ",
                           counted(frames, "frame"), " of ", counted(width, "feature"), " have ", frames * width);
      std::vector<S> rows;
      rows.reserve(static_cast<std::size_t>(crop.range.size() * width));
      for (Index f = crop.range.start; f < crop.range.end; ++f) {
        const auto* from = values.data() + std::clamp(f - text.start, Index{0}, frames - 1) * width;
        rows.insert(rows.end(), from, from + width);
      }
      out.push_back({.crop = plan.first_crop[m] + static_cast<Index>(c),
                     .rows = normalizer.normalize(Tensor<B, 2>::from(rows, {crop.range.size(), width}))});
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
