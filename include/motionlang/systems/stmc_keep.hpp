// SPDX-License-Identifier: MIT
/// STMC around an existing motion: frames or body parts of it are kept, and texts make the rest.
///
///     KeptMotion<B> clip{features};                            // (frames, 205), not normalised
///     // Its first and last second; the model makes the frames between. Or its path and steps; texts move the rest.
///     clip.parts = {{{0, 20}}, {{100, 120}}};
///     clip.parts = {{{0, 120}, BodyParts{}.with(BodyPart::legs)}};
///     const std::span<const KeptMotion<B>> kept(&clip, 1);     // one for each timeline
///     auto motions = generate_around(stmc, std::span(&timeline, 1), Philox{.seed = 7}, {}, kept);
///
/// Rule    after every step the clean estimate is overwritten where a part is kept; x_t is not changed
/// Source  MDM (Tevet et al. 2023), section 3 "Editing", MDM sample/edit.py
/// Note    Features describe the path over the floor by its velocity. So kept frames at the end move as before, but
///         start where the frames before them end. Models that ignore the kept part jump where it begins and ends: use
///         `without_jump` (kinematics/blend.hpp), as the program does
#pragma once

#include <cmath>  // isfinite

#include <motionlang/systems/stmc.ipp>

MOTIONLANG_NAMESPACE_BEGIN

/// Kept frames and body parts. The path over the floor belongs to the part with the path: the legs of a human.
struct KeptPart {
  IndexRange frames;
  BodyParts parts = BodyParts::every();
};

/// The kept part of a motion; nothing without parts. Frame 0 is that of the timeline.
template <Backend B>
struct KeptMotion {
  Tensor<B, 2> features{};  // (frames, features), not normalised
  std::vector<KeptPart> parts{};
};

namespace detail {

/// Positions of all these parts in a feature vector.
std::vector<Index> positions_of(const FeatureLayout& layout, BodyParts parts);

/// Kept normalised features, which replace those of the model.
template <Backend B>
class KeptRows {
 public:
  using S = typename B::scalar;

  /// One motion for each timeline of the plan. Throws config_error 101, 102, shape_error 205, numeric_error 301.
  KeptRows(std::span<const KeptMotion<B>> kept, const BatchPlan& plan, Index stride, const FeatureLayout& layout,
           const Normalizer<B>& normalizer) {
    if (kept.size() != plan.timelines.size())
      raise<config_error>(102, "generate_around: ", kept.size(), " motions to keep for ", plan.timelines.size(),
                          " timelines");
    const Shape shape{std::ssize(kept) * stride, layout.size};
    std::vector<S> open(static_cast<std::size_t>(shape.count()), S{1}), values(open.size(), S{0});
    for (std::size_t m = 0; m < kept.size(); ++m) {
      if (kept[m].parts.empty()) continue;
      require_fitting(kept[m], layout, plan.timelines[m].frames);
      const std::vector<S> rows = normalizer.normalize(kept[m].features).to_vector();
      const std::size_t first = m * static_cast<std::size_t>(stride * layout.size);
      for (const KeptPart& part : kept[m].parts) {
        const std::vector<Index> positions = positions_of(layout, part.parts);
        for (Index f = part.frames.begin; f < part.frames.end; ++f) {
          for (const Index i : positions) {
            const auto at = static_cast<std::size_t>(f * layout.size + i);
            if (!std::isfinite(rows[at]))
              raise<numeric_error>(301, "generate_around: number ", i, " of frame ", f, " that is kept is ", rows[at]);
            values[first + at] = rows[at], open[first + at] = S{0};
          }
        }
      }
    }
    open_ = Tensor<B, 2>::from(open, shape);
    values_ = Tensor<B, 2>::from(values, shape);
  }

  Tensor<B, 2> over(const Tensor<B, 2>& x0) const { return x0 * open_ + values_; }

 private:
  static void require_fitting(const KeptMotion<B>& kept, const FeatureLayout& layout, Index frames) {
    if (kept.features.size(1) != layout.size)
      raise<shape_error>(205, "generate_around: features ", kept.features.shape(), ", the model's '", layout.name,
                         "' are ", layout.size);
    const Index known = kept.features.size(0);
    for (const KeptPart& part : kept.parts) {
      const IndexRange& r = part.frames;
      if (r.begin < 0 || r.size() < 1 || r.end > std::min(known, frames))
        raise<config_error>(101, "generate_around: frames ", r.begin, ":", r.end, " are kept of ", known,
                            " in a timeline of ", frames);
    }
  }

  Tensor<B, 2> open_, values_;  // 1 where nothing is kept, else 0
};

}  // namespace detail

/// As stmc.generate, with one motion to keep for each timeline. Kept values come back unchanged, up to the rounding of
/// the normalisation. Throws as generate does; config_error 101 for frames that a motion or its timeline lacks, 102 for
/// another number of motions, shape_error 205 for other features, numeric_error 301.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> generate_around(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                                          const Philox& rng, const StmcOptions& options,
                                          std::span<const KeptMotion<B>> kept) {
  std::optional<detail::KeptRows<B>> rows;
  const auto estimate = [&](const Collage<B, D>& collage, const auto& whole, const Tensor<B, 2>& x, Index t) {
    if (!rows) rows.emplace(kept, collage.plan(), collage.stride(), stmc.layout, stmc.motion_normalizer);
    return rows->over(whole(collage, x, t));
  };
  return stmc.generate_from(
      timelines, [&](Index draw, const Shape& shape) { return stmc.noise(rng, draw, shape, options.first); }, options,
      estimate);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/systems/stmc_keep.ipp>
#endif
