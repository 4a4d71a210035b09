// SPDX-License-Identifier: MIT
/// Cuts crops out of a motion, and puts a motion together from crops, per body part and interval.
///
/// All index lists are made once per plan. Cutting and stitching are then gathers and scatters of whole rows.
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

  /// With crop_frames > 0 every crop has exactly that many frames, whatever follows its range (MDM). The motions then
  /// need as many rows behind their end. A crop without frames has no rows.
  static CropRows of(const BatchPlan& plan, Index crop_frames = 0);
};

namespace detail {

/// Rows of crops that are added to rows of motions for one part, with the factor 1 or -1.
struct PartMoves {
  std::vector<Index> from, to;
  std::vector<signed char> sign;
};
PartMoves moves_of_part(const BatchPlan& plan, const Offsets& crops, Index stride, BodyPart part);

/// Throws config_error 102 unless the layout gives each value to one body part of the body of the timelines.
void check_layout(const FeatureLayout& layout, const BatchPlan& plan);

}  // namespace detail

/// Puts crops together: for each body part the additions of the plan, then its subtractions.
///     motion[to, part] = sum crops[from, part] - sum transitions[from, part]
/// Source  thesis 6.2.3, "Spatial (body-part) stitching", "Temporal stitching"; STMC src/stmc.py
///         combine_features_intervals
template <Backend B>
class Stitcher {
 public:
  Stitcher() = default;
  /// `crops`: offsets of the crops in batch order; `stride`: rows per motion. Throws config_error 102 for a layout that
  /// does not give each value to one body part, and for a layout of another body.
  Stitcher(const BatchPlan& plan, const FeatureLayout& layout, const Offsets& crops, Index stride)
      : rows_(static_cast<Index>(plan.timelines.size()) * stride), features_(layout.size) {
    detail::check_layout(layout, plan);
    for (int p = 0; p < layout.body.size(); ++p) {
      Part part;
      part.mask = detail::part_mask<B>(layout, static_cast<BodyPart>(p));
      auto moves = detail::moves_of_part(plan, crops, stride, static_cast<BodyPart>(p));
      const std::vector<typename B::scalar> sign(moves.sign.begin(), moves.sign.end());
      part.from = std::move(moves.from), part.to = std::move(moves.to);
      part.sign = Tensor<B, 2>::from(sign, {static_cast<Index>(sign.size()), 1});
      parts_.push_back(std::move(part));
    }
  }

  /// crops (rows of all crops, features) -> (motions * stride, features). Rows to which nothing is added are 0.
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

/// Softens hard cuts (the SINC+lerp baseline): in every window of the plan the part is interpolated
/// linearly between the values at the window's first and last frame.
///     w v_first + (1 - w) v_last,   w = linspace(1, 0, window)
/// All windows read the hard-cut motion. Where they overlap, the later one wins. Source: STMC src/stmc.py. Throws
/// config_error 102 for a layout that does not give each value to one body part, and for a layout of another body.
template <Backend B>
Tensor<B, 2> interpolate_transitions(const BatchPlan& plan, const FeatureLayout& layout, const Tensor<B, 2>& motion,
                                     Index stride) {
  using S = typename B::scalar;
  detail::check_layout(layout, plan);
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

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/stitching.ipp>
#endif
