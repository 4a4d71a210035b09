// SPDX-License-Identifier: MIT
/// The denoising step of STMC: all crops of all timelines go through the network in ragged batches, and are guided and
/// stitched.
///
/// It does not depend on the feature type or the network: any layout with a partition into parts, any `Denoiser`.
#pragma once

#include <motionlang/compose/recalled_motions.hpp>
#include <motionlang/compose/stitching.hpp>
#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/diffusion/guidance.hpp>
#include <motionlang/diffusion/sampler.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The results of one step, for callers who want to see them. Rows are those of the crops, in batch order.
template <Backend B>
struct CollageStep {
  Tensor<B, 2> crops, cond, null, guided, x0;
};

namespace detail {

/// Jobs that go through the network together: sequences of frames, each with one or several texts.
struct JobBatch {
  std::vector<Index> rows;  // of x
  Offsets frames, uses;     // uses: the texts of each sequence
  std::vector<Index> texts;
};
struct JobBatches {
  std::vector<JobBatch> batches;
  std::vector<Index> cond, null;  // for every row of the crops its row in all batches, with its text and without
};
struct JobOptions {
  bool guided = true;
  bool divide = true;  // a sequence has the same result in any batch
  Index rows_at_once = 0;
};

/// texts: of every crop; null: the unconditional one.
JobBatches plan_jobs(const CropRows& crops, std::span<const Index> texts, Index null, const JobOptions& options);

/// The text of every crop as a number. Equal texts have the same number, and "" has that of the unconditional text.
std::vector<Index> texts_of_crops(const BatchPlan& plan, Index null);

/// Throws shape_error 204 unless there is a text for every interval, and one unconditional one.
void check_texts(const BatchPlan& plan, Index texts, Index nulls);

/// The rows of crops of fixed size, without the rows behind their own frames.
CropRows own_frames(const BatchPlan& plan, Index stride, Index crop_frames);

Offsets joined(const Offsets& a, const Offsets& b);

}  // namespace detail

/// Source  thesis 6.2.3, figure 6.3 c; STMC (Petrovich et al. 2024) src/model/gaussian.py p_sample_stmc
/// Cost    One call of the network per step and `rows_at_once` frames, so its memory does not grow with the timelines.
///         Sequences with the same frames and the same text go through it once. These are both calls of guidance if a
///         crop's text is "", and the unconditional calls of texts that begin and end together. Work of a denoiser that
///         depends on the frames of a crop but not on its text is done once, too. The longest sequences come first, so
///         that threads end together. Crops without frames are left out. Texts, offsets and index lists are prepared
///         here, not in the loop.
template <Backend B, Denoiser<B> D>
class Collage {
 public:
  /// text: features of every interval of every timeline, in order; null: of "" (one). The denoiser must outlive the
  /// collage. rows_at_once: frames of a batch, more only if one crop has more; 0: any number. No result depends on it.
  /// Throws shape_error 204 if the number of texts is wrong, timeline_error 508 if a crop is too long for the denoiser,
  /// and config_error 101 for a negative rows_at_once.
  Collage(const D& denoiser, BatchPlan plan, FeatureLayout layout, const TextFeatures<B>& text,
          const TextFeatures<B>& null, double guidance, Index rows_at_once = usual_rows_at_once)
      : denoiser_(&denoiser),
        plan_(std::move(plan)),
        layout_(std::move(layout)),
        texts_{
            {concat(0, text.tokens.rows, null.tokens.rows), detail::joined(text.tokens.offsets, null.tokens.offsets)},
            text.end_position,
            std::max(text.padded_tokens, null.padded_tokens)},
        guidance_(guidance),
        rows_at_once_(rows_at_once) {
    if (rows_at_once < 0) raise<config_error>(101, "Collage: ", rows_at_once, " rows at once");
    texts_.end_position.insert(texts_.end_position.end(), null.end_position.begin(), null.end_position.end());
    detail::check_texts(plan_, text.count(), null.count());
    prepare_step();
  }
  /// From now on, the clean estimates of crops follow these motions (compose/recalled_motions.hpp).
  /// recall  the share of a motion in 0 ... 1; the network's is the rest
  /// Throws  config_error 101 for another share, shape_error 205 for motions with other features
  void follow(std::vector<RecalledMotion<B>> motions, double recall = usual_recall) {
    if (!(recall >= 0 && recall <= 1)) raise<config_error>(101, "Collage: a recall of ", recall, " is not in 0 ... 1");
    for (const RecalledMotion<B>& m : motions) {
      if (m.rows.size(1) != layout_.size)
        raise<shape_error>(205, "Collage: a motion to follow is ", m.rows.shape(), ", the collage has ",
                           counted(layout_.size, "feature"));
    }
    recalled_ = std::move(motions);
    recall_ = recall;
    prepare_recall();
  }
  /// The same with only some of the crops and slices of its plan (compose/edits.hpp).
  Collage with_plan(BatchPlan plan) const {  // NOLINT(performance-unnecessary-value-param): it is moved from
    Collage out = *this;
    out.plan_ = std::move(plan);
    out.prepare_step();
    return out;
  }

  const BatchPlan& plan() const { return plan_; }
  const Offsets& crop_offsets() const { return crops_.offsets; }
  /// Rows of x per timeline, and of all timelines together.
  Index stride() const { return motion_.stride; }
  Index rows() const { return motion_.stride * static_cast<Index>(plan_.timelines.size()); }
  /// Rows that go through the network in a step, without tokens for time and text.
  Index batch_rows() const {
    Index rows = 0;
    for (const Batch& b : batches_) rows += repeat_lengths(b.frames, b.uses).rows();
    return rows;
  }

  /// True if a sequence has the same result in any batch of these texts.
  bool can_divide() const {
    const BatchMates mates = denoiser_->traits().mates;
    const Offsets& texts = texts_.tokens.offsets;
    return mates == BatchMates::none ||
           (mates == BatchMates::longest_text &&
            (texts_.padded_tokens >= texts.longest() || texts.rows() == texts.count() * texts.longest()));
  }

  /// x (rows, features) at network step t -> composite clean estimate. If the network predicts something else than x0,
  /// `to_x0` converts its output for the crops: to_x0(output rows, crop rows).
  template <class F>
  CollageStep<B> step(const Tensor<B, 2>& x, Index t, F to_x0) const {
    CollageStep<B> s;
    s.crops = gather(x, crops_.rows);
    const auto out = denoised(x, t);
    s.cond = gather(out, cond_);
    s.null = guidance_ == 1 ? s.cond : gather(out, null_);
    s.guided = guidance_ == 1 ? s.cond : guide(s.cond, s.null, guidance_);
    s.x0 = stitch_(recalled(to_x0(s.guided, s.crops)));
    return s;
  }
  CollageStep<B> step(const Tensor<B, 2>& x, Index t) const {
    return step(x, t, [](const Tensor<B, 2>& output, const Tensor<B, 2>&) { return output; });
  }
  /// Stitches any values of the crops.
  Tensor<B, 2> stitch(const Tensor<B, 2>& crops) const { return stitch_(crops); }

 private:
  /// Jobs that go through the network together: sequences of frames, each with one or several texts.
  struct Batch {
    std::vector<Index> rows;  // of x
    Offsets frames, uses;     // uses: the texts of each sequence
    decltype(encoded_text<B>(std::declval<const D&>(), TextFeatures<B>())) text;
  };

  void prepare_step() {
    const DenoiserTraits traits = denoiser_->traits();
    for (const TimelinePlan& p : plan_.timelines) detail::check_crops(p, traits.longest());
    const bool fixed = traits.crop_frames > 0;
    motion_ = CropRows::of(plan_, traits.crop_frames);
    // With a mask, a crop of fixed size shrinks to its own frames again: masked frames are ignored.
    crops_ = fixed && traits.uses_lengths ? detail::own_frames(plan_, motion_.stride, traits.crop_frames) : motion_;
    stitch_ = Stitcher<B>(plan_, layout_, crops_.offsets, motion_.stride);
    build_batch();
    prepare_recall();
  }

  /// The values of remembered motions in the rows of the crops, and the share that stays the network's.
  void prepare_recall() {
    using S = typename B::scalar;
    follows_ = !recalled_.empty() && recall_ > 0;
    if (!follows_) return;
    const auto width = static_cast<std::size_t>(layout_.size);
    std::vector<S> own(static_cast<std::size_t>(crops_.offsets.rows()), S{1}), values(own.size() * width);
    for (const RecalledMotion<B>& m : recalled_) {
      const Index rows = crops_.offsets.length(m.crop);
      for (Index f = 0; f < std::min(rows, m.rows.size(0)); ++f) {
        const auto row = static_cast<std::size_t>(crops_.offsets.begin(m.crop) + f);
        own[row] = static_cast<S>(1 - recall_);
        const auto from = m.rows.span().subspan(static_cast<std::size_t>(f) * width, width);
        for (std::size_t i = 0; i < width; ++i) values[row * width + i] = static_cast<S>(recall_) * from[i];
      }
    }
    own_share_ = Tensor<B, 2>::from(own, {std::ssize(own), 1});
    recalled_share_ = Tensor<B, 2>::from(values, {std::ssize(own), layout_.size});
  }
  Tensor<B, 2> recalled(Tensor<B, 2> x0) const {
    if (!follows_) return x0;
    return x0 * own_share_ + recalled_share_;
  }

  /// The outputs of the network for all jobs, one after the other.
  Tensor<B, 2> denoised(const Tensor<B, 2>& x, Index t) const {
    const auto of = [&](const Batch& b) {
      const PoolVector<Index> steps(static_cast<std::size_t>(b.uses.rows()), t);
      return denoise_with_texts(*denoiser_, Sequences<B>(gather(x, b.rows), b.frames), b.uses, steps, b.text).rows;
    };
    if (batches_.size() == 1) return of(batches_.front());
    PoolVector<Tensor<B, 2>> parts;
    parts.reserve(batches_.size());
    for (const Batch& b : batches_) parts.push_back(of(b));
    return concat(std::span<const Tensor<B, 2>>(parts), 0);
  }

  void build_batch() {
    const Index null = texts_.count() - 1;
    auto jobs = detail::plan_jobs(crops_, detail::texts_of_crops(plan_, null), null,
                                  {.guided = guidance_ != 1, .divide = can_divide(), .rows_at_once = rows_at_once_});
    cond_ = std::move(jobs.cond), null_ = std::move(jobs.null);
    batches_.clear();
    for (detail::JobBatch& b : jobs.batches) {
      batches_.push_back({std::move(b.rows), std::move(b.frames), std::move(b.uses),
                          encoded_text<B>(*denoiser_, gather(texts_, b.texts))});
    }
  }

  const D* denoiser_;
  BatchPlan plan_;
  FeatureLayout layout_;
  TextFeatures<B> texts_;  // of all intervals, then the unconditional one
  double guidance_;
  Index rows_at_once_;
  CropRows motion_, crops_;
  Stitcher<B> stitch_;
  std::vector<RecalledMotion<B>> recalled_{};
  double recall_ = 0;
  bool follows_ = false;                         // whether a crop of this plan follows a motion
  Tensor<B, 2> own_share_{}, recalled_share_{};  // (rows of the crops, 1) and (..., features)
  std::vector<Batch> batches_;
  std::vector<Index> cond_, null_;  // for every row of the crops its row in all batches, with its text and without
};

/// x0 of all timelines at index t of the process.
template <Backend B, Denoiser<B> D>
Tensor<B, 2> clean_motion(const Collage<B, D>& collage, const GaussianDiffusion& diffusion, Prediction prediction,
                          const Tensor<B, 2>& x, Index t) {
  const auto to_clean = [&](const Tensor<B, 2>& output, const Tensor<B, 2>& crops) {
    return to_x0(diffusion, prediction, output, crops, std::span<const Index>(&t, 1));
  };
  return collage.step(x, diffusion.network_t(t), to_clean).x0;
}

/// The whole reverse process with any clean_motion(x, t). noise(0) is the initial x; noise(1), noise(2), ... belong to
/// the steps. All have the shape (rows, features).
/// -> clean motions (rows, features), normalised. Rows behind a timeline's end mean nothing. `watch(t, step)` sees
/// every step. Throws `cancelled` if progress returns false.
template <Backend B, class Clean, class Noise, class Watch = IgnoreSteps>
Tensor<B, 2> sample_clean_motions(const GaussianDiffusion& diffusion, const Clean& clean_motion, Noise&& noise,
                                  const SamplingOptions& options = {}, Progress progress = {},
                                  const Watch& watch = {}) {
  return sample<B, 2>(diffusion, clean_motion, noise, options, Prediction::x0, progress, watch);
}
template <Backend B, Denoiser<B> D, class Noise, class Watch = IgnoreSteps>
Tensor<B, 2> sample_collage(const Collage<B, D>& collage, const GaussianDiffusion& diffusion, Prediction prediction,
                            Noise&& noise, const SamplingOptions& options = {}, Progress progress = {},
                            const Watch& watch = {}) {
  const auto clean = [&](const Tensor<B, 2>& x, Index t) { return clean_motion(collage, diffusion, prediction, x, t); };
  return sample_clean_motions<B>(diffusion, clean, noise, options, progress, watch);
}

/// Every interval of a plan as a motion of its own, for text-to-motion without a timeline and for the SINC baselines.
/// With `frames` > 0 all of them have that many frames.
BatchPlan independent_plan(const BatchPlan& plan, Index frames = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/collage.ipp>
#endif
