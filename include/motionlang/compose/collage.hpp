// SPDX-License-Identifier: MIT
/// The denoising step of STMC: all crops of all timelines through the network in one ragged batch, guided, stitched.
///
/// Independent of the feature type and of the network: any layout with a partition into parts, any `Denoiser`.
#pragma once

#include <motionlang/compose/combine.hpp>
#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/diffusion/guidance.hpp>
#include <motionlang/diffusion/sampler.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// What one step computed, for those who want to see it. Rows are those of the crops, in batch order.
template <Backend B>
struct CollageStep {
  Tensor<B, 2> crops, cond, null, guided, x0;
};

/// Source  STMC (Petrovich et al. 2024), algorithm 1; spec stmc.md 4 and 6
/// Cost    crops whose text is "" go through the network once: both calls of guidance would give the same. Texts,
///         offsets and index lists are prepared here, not in the loop.
template <Backend B, Denoiser<B> D>
class Collage {
 public:
  /// text: features of every interval of every timeline, in order; null: of "" (one). The denoiser must outlive the
  /// collage. Throws shape_error 204 if the number of texts is another, timeline_error 508 if a crop is too long for
  /// the denoiser.
  Collage(const D& denoiser, BatchPlan plan, const FeatureLayout& layout, const TextFeatures<B>& text,
          const TextFeatures<B>& null, double guidance)
      : denoiser_(&denoiser), plan_(std::move(plan)), guidance_(guidance) {
    const DenoiserTraits traits = denoiser.traits();
    for (const TimelinePlan& p : plan_.timelines) detail::check_crops(p, traits.longest());
    const bool fixed = traits.crop_frames > 0;
    motion_ = CropRows::of(plan_, traits.crop_frames);
    // With a mask, a crop of fixed size shrinks to its own frames again: masked frames take no part.
    crops_ = fixed && traits.uses_lengths ? own_frames(traits.crop_frames) : motion_;
    stitch_ = Stitcher<B>(plan_, layout, crops_.offsets, motion_.stride);
    build_batch(text, null);
  }

  const BatchPlan& plan() const { return plan_; }
  const Offsets& crop_offsets() const { return crops_.offsets; }
  /// Rows of x per timeline, and of all timelines together.
  Index stride() const { return motion_.stride; }
  Index rows() const { return motion_.stride * static_cast<Index>(plan_.timelines.size()); }

  /// x (rows, features) at network step t -> composite clean estimate. `to_x0` turns the network's output for the crops
  /// into x0 where it predicts something else: to_x0(output rows, crop rows).
  template <class F>
  CollageStep<B> step(const Tensor<B, 2>& x, Index t, F to_x0) const {
    CollageStep<B> s;
    s.crops = gather(x, crops_.rows);
    const PoolVector<Index> steps(static_cast<std::size_t>(batch_offsets_.count()), t);
    const Sequences<B> batch(base_.empty() ? s.crops : gather(x, batch_rows_), batch_offsets_);
    const auto out = (*denoiser_)(batch, steps, batch_text_).rows;
    if (base_.empty()) {
      s.cond = s.null = s.guided = out;
    } else {
      s.cond = slice(out, 0, 0, crops_.offsets.rows());
      s.null = gather(out, base_);
      s.guided = guide(s.cond, s.null, guidance_);
    }
    s.x0 = stitch_(to_x0(s.guided, s.crops));
    return s;
  }
  CollageStep<B> step(const Tensor<B, 2>& x, Index t) const {
    return step(x, t, [](const Tensor<B, 2>& output, const Tensor<B, 2>&) { return output; });
  }
  /// Stitches any values of the crops.
  Tensor<B, 2> stitch(const Tensor<B, 2>& crops) const { return stitch_(crops); }

 private:
  CropRows own_frames(Index crop_frames) const {
    CropRows out = CropRows::of(plan_);
    for (Index& row : out.rows) {  // the same frames in motions with more rows
      const Index m = row / plan_.frames;
      row += m * crop_frames;
    }
    out.stride = motion_.stride;
    return out;
  }

  /// The batch: all crops with their texts, then every crop with a text once more without it.
  void build_batch(const TextFeatures<B>& text, const TextFeatures<B>& null) {
    std::vector<Index> which, lengths, again;
    Index next_text = 0, crop = 0;
    for (const TimelinePlan& p : plan_.timelines) {
      for (const Crop& c : p.crops) {
        const bool own_text = !c.is_transition();
        which.push_back(own_text ? next_text + c.interval : -1);
        if (own_text && !p.text(c).empty()) again.push_back(crop);
        ++crop;
      }
      next_text += static_cast<Index>(p.timeline.intervals.size());
    }
    if (text.count() != next_text || null.count() != 1) {
      raise<shape_error>(204, "Collage: ", text.count(), " texts for ", next_text, " intervals; ", null.count(),
                         " unconditional texts");
    }
    if (guidance_ == 1) again.clear();
    batch_rows_ = crops_.rows;
    for (Index i = 0; i < crop; ++i) lengths.push_back(crops_.offsets.length(i));
    if (!again.empty()) {
      base_.resize(static_cast<std::size_t>(crops_.offsets.rows()));
      for (std::size_t r = 0; r < base_.size(); ++r) base_[r] = static_cast<Index>(r);
      for (Index i : again) {
        which.push_back(-1);
        lengths.push_back(crops_.offsets.length(i));
        for (Index r = crops_.offsets.begin(i); r < crops_.offsets.end(i); ++r) {
          base_[static_cast<std::size_t>(r)] = static_cast<Index>(batch_rows_.size());
          batch_rows_.push_back(crops_.rows[static_cast<std::size_t>(r)]);
        }
      }
    }
    batch_offsets_ = Offsets(lengths);
    // The unconditional text is number `next_text` of the joined features.
    for (Index& i : which) i = i < 0 ? next_text : i;
    TextFeatures<B> all{
        {concat(0, text.tokens.rows, null.tokens.rows), joined(text.tokens.offsets, null.tokens.offsets)},
        text.end_position};
    all.end_position.insert(all.end_position.end(), null.end_position.begin(), null.end_position.end());
    batch_text_ = encoded_text<B>(*denoiser_, gather(all, which));
  }
  static Offsets joined(const Offsets& a, const Offsets& b) {
    std::vector<Index> lengths;
    for (const Offsets* o : {&a, &b}) {
      for (Index i = 0; i < o->count(); ++i) lengths.push_back(o->length(i));
    }
    return Offsets(lengths);
  }

  const D* denoiser_;
  BatchPlan plan_;
  double guidance_;
  CropRows motion_, crops_;
  Stitcher<B> stitch_;
  std::vector<Index> batch_rows_, base_;  // base_: for every row of the crops, where its unconditional result is
  Offsets batch_offsets_;
  decltype(encoded_text<B>(std::declval<const D&>(), TextFeatures<B>())) batch_text_;
};

/// The whole reverse process. noise(0) is the initial x, noise(1), noise(2), ... belong to the steps; all of shape
/// (rows, features).
/// -> clean motions (rows, features), normalised; rows behind a timeline's end mean nothing. `watch(t, step)` sees
/// every step. Throws `cancelled` if progress says so.
template <Backend B, Denoiser<B> D, class Noise, class Watch = IgnoreSteps>
Tensor<B, 2> sample_collage(const Collage<B, D>& collage, const GaussianDiffusion& diffusion, Prediction prediction,
                            Noise&& noise, const SamplingOptions& options = {}, Progress progress = {},
                            const Watch& watch = {}) {
  auto network = [&](const Tensor<B, 2>& x, Index t) {
    return collage
        .step(x, diffusion.network_t(t),
              [&](const Tensor<B, 2>& output, const Tensor<B, 2>& crops) {
                return to_x0(diffusion, prediction, output, crops, std::span<const Index>(&t, 1));
              })
        .x0;
  };
  auto step_noise = [&](Index draw) { return noise(draw + 1); };
  const StepOptions step{.noise_scale = options.noise_scale, .clip = options.clip};
  if (options.sampler == SamplingOptions::Sampler::ddim) {
    return sample_ddim<B, 2>(diffusion, noise(0), network, step_noise, options.eta, step, detail::KeepX0{}, progress,
                             watch);
  }
  return sample_ancestral<B, 2>(diffusion, noise(0), network, step_noise, step, detail::KeepX0{}, progress, -1, watch);
}

/// Every interval of a plan as a motion of its own, for text-to-motion without a timeline and for the SINC baselines.
/// With `frames` > 0 all of them have that many frames.
inline BatchPlan independent_plan(const BatchPlan& plan, Index frames = 0) {
  std::vector<TimelinePlan> alone;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Interval& i : p.timeline.intervals) {
      alone.push_back(plan_timeline({{{i.text, 0, frames > 0 ? frames : i.end - i.start, BodyParts::all()}}}));
    }
  }
  return batch_plans(std::move(alone));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
