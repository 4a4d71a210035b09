// SPDX-License-Identifier: MIT
/// Values of a composition: crops cut out of a motion, and a motion put together from crops, per body part and
/// interval.
///
/// All index lists are made once per plan; cutting and stitching are then gathers and scatters of whole rows.
#pragma once

#include <motionlang/compose/plan.hpp>
#include <motionlang/features/layout.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// 1 in the columns of a part, else 0: (1, features).
template <Backend B>
Tensor<B, 2> part_mask(const FeatureLayout& layout, BodyPart part) {
  std::vector<typename B::scalar> mask(static_cast<std::size_t>(layout.size));
  for (const IndexRange& r : layout.ranges(part)) {
    for (Index i = r.begin; i < r.end; ++i) mask[static_cast<std::size_t>(i)] = 1;
  }
  return Tensor<B, 2>::from(mask, {1, layout.size});
}

}  // namespace detail

/// The crops of a batch as sequences, in batch order. Motions of the batch lie one after the other, `stride` rows each.
struct CropRows {
  std::vector<Index> rows;  // of the motions, for each row of the crops
  Offsets offsets;          // of the crops
  Index stride = 0;

  /// With crop_frames > 0 every crop has exactly that many frames, whatever follows its range (MDM); the motions need
  /// as many rows behind their end. A crop without frames has no rows.
  static CropRows of(const BatchPlan& plan, Index crop_frames = 0) {
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
};

/// Puts crops together: for each body part the additions of the plan, then its subtractions.
///     motion[to, part] = sum crops[from, part] - sum transitions[from, part]
/// Source  STMC, section 3.3, "spatio-temporal stitching"; spec stmc.md 4 step 5
template <Backend B>
class Stitcher {
 public:
  Stitcher() = default;
  /// `crops`: offsets of the crops in batch order; `stride`: rows per motion. Throws config_error 102 for a layout that
  /// does not give each number to one body part.
  Stitcher(const BatchPlan& plan, const FeatureLayout& layout, const Offsets& crops, Index stride)
      : rows_(static_cast<Index>(plan.timelines.size()) * stride), features_(layout.size) {
    layout.validate();
    for (int p = 0; p < body_part_count; ++p) {
      Part part;
      part.mask = detail::part_mask<B>(layout, static_cast<BodyPart>(p));
      std::vector<typename B::scalar> sign;
      for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
        auto take = [&](const std::vector<Slice>& slices, double s) {
          for (const Slice& slice : slices) {
            if (slice.part != static_cast<BodyPart>(p)) continue;
            const Index from = crops.begin(plan.first_crop[m] + slice.crop) + slice.from.start;
            for (Index i = 0; i < slice.to.size(); ++i) {
              part.from.push_back(from + i);
              part.to.push_back(static_cast<Index>(m) * stride + slice.to.start + i);
              sign.push_back(static_cast<typename B::scalar>(s));
            }
          }
        };
        take(plan.timelines[m].add, 1);
        take(plan.timelines[m].subtract, -1);
      }
      part.sign = Tensor<B, 2>::from(sign, {static_cast<Index>(sign.size()), 1});
      parts_.push_back(std::move(part));
    }
  }

  /// crops (rows of all crops, features) -> (motions * stride, features); rows that nothing is added to are 0.
  Tensor<B, 2> operator()(const Tensor<B, 2>& crops) const {
    auto motion = Tensor<B, 2>::zeros({rows_, features_});
    for (const Part& p : parts_)
      motion = std::move(motion) + scatter_add(gather(crops, p.from) * p.sign, p.to, rows_) * p.mask;
    return motion;
  }

 private:
  struct Part {
    std::vector<Index> from, to;
    Tensor<B, 2> sign, mask;  // (rows, 1), (1, features)
  };
  Index rows_ = 0, features_ = 0;
  std::vector<Part> parts_;
};

/// Hard cuts softened afterwards (the SINC+lerp baseline): in every window of the plan the part is interpolated
/// linearly between the values at the window's first and last frame.
///     w v_first + (1 - w) v_last,   w = linspace(1, 0, window)
/// All windows read the hard-cut motion; where they overlap the later one wins. Source: spec stmc.md 5.
/// Throws config_error 102 for a layout that does not give each number to one body part.
template <Backend B>
Tensor<B, 2> interpolate_transitions(const BatchPlan& plan, const FeatureLayout& layout, const Tensor<B, 2>& motion,
                                     Index stride) {
  using S = typename B::scalar;
  layout.validate();
  const auto read = motion.span();
  std::vector<S> out(read.begin(), read.end());
  const auto width = static_cast<std::size_t>(layout.size);
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    for (const LerpWindow& window : plan.timelines[m].lerp) {
      const auto first = m * static_cast<std::size_t>(stride) + static_cast<std::size_t>(window.range.start);
      const auto n = static_cast<std::size_t>(window.range.size());
      for (std::size_t i = 0; i < n; ++i) {
        const S w = n == 1 ? S(1) : S(1) - static_cast<S>(i) / static_cast<S>(n - 1);
        for (const IndexRange& r : layout.ranges(window.part)) {
          for (auto c = static_cast<std::size_t>(r.begin); c < static_cast<std::size_t>(r.end); ++c) {
            out[(first + i) * width + c] = w * read[first * width + c] + (S(1) - w) * read[(first + n - 1) * width + c];
          }
        }
      }
    }
  }
  return Tensor<B, 2>::from(out, motion.shape());
}

MOTIONLANG_NAMESPACE_END
