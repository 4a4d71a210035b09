// SPDX-License-Identifier: MIT
/// The denoising step of STMC: all crops of all timelines through the network in ragged batches, guided, stitched.
///
/// Independent of the feature type and of the network: any layout with a partition into parts, any `Denoiser`.
#pragma once

#include <limits>  // any number of rows
#include <map>     // equal sequences

#include <motionlang/compose/stitching.hpp>
#include <motionlang/core/rows_together.hpp>
#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/diffusion/guidance.hpp>
#include <motionlang/diffusion/sampler.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// What one step computed, for those who want to see it. Rows are those of the crops, in batch order.
template <Backend B>
struct CollageStep {
  Tensor<B, 2> crops, cond, null, guided, x0;
};

/// Source  STMC (Petrovich et al. 2024), algorithm 1; spec stmc.md 4 and 6
/// Cost    one call of the network per step and `rows_at_once` frames: what the network holds at a time does not grow
///         with the timelines. Sequences of the same frames and the same text go through it once: both calls of
///         guidance of a crop whose text is "", and the unconditional calls of texts that begin and end together; what
///         a denoiser can compute for the frames of a crop whatever its text is computed once as well. The longest come
///         first, so that threads end together; crops without frames are left out. Texts, offsets and index lists are
///         prepared here, not in the loop.
template <Backend B, Denoiser<B> D>
class Collage {
 public:
  /// text: features of every interval of every timeline, in order; null: of "" (one). The denoiser must outlive the
  /// collage. rows_at_once: frames of a batch, more only if one crop has more; 0: any number. No result depends on it.
  /// Throws shape_error 204 if the number of texts is another, timeline_error 508 if a crop is too long for the
  /// denoiser, config_error 101 for a negative rows_at_once.
  Collage(const D& denoiser, BatchPlan plan, const FeatureLayout& layout, const TextFeatures<B>& text,
          const TextFeatures<B>& null, double guidance, Index rows_at_once = usual_rows_at_once)
      : denoiser_(&denoiser),
        plan_(std::move(plan)),
        layout_(layout),
        texts_{{concat(0, text.tokens.rows, null.tokens.rows), joined(text.tokens.offsets, null.tokens.offsets)},
               text.end_position,
               std::max(text.padded_tokens, null.padded_tokens)},
        guidance_(guidance),
        rows_at_once_(rows_at_once) {
    if (rows_at_once < 0) raise<config_error>(101, "Collage: ", rows_at_once, " rows at once");
    texts_.end_position.insert(texts_.end_position.end(), null.end_position.begin(), null.end_position.end());
    check_texts(text.count(), null.count());
    prepare_step();
  }
  /// The same with some crops and slices of its plan only (compose/edits.hpp).
  Collage with_plan(BatchPlan plan) const {
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

  /// Whether a sequence has the same result in any batch of these texts.
  bool can_divide() const {
    const BatchMates mates = denoiser_->traits().mates;
    const Offsets& texts = texts_.tokens.offsets;
    return mates == BatchMates::none ||
           (mates == BatchMates::longest_text &&
            (texts_.padded_tokens >= texts.longest() || texts.rows() == texts.count() * texts.longest()));
  }

  /// x (rows, features) at network step t -> composite clean estimate. `to_x0` turns the network's output for the crops
  /// into x0 where it predicts something else: to_x0(output rows, crop rows).
  template <class F>
  CollageStep<B> step(const Tensor<B, 2>& x, Index t, F to_x0) const {
    CollageStep<B> s;
    s.crops = gather(x, crops_.rows);
    const auto out = denoised(x, t);
    s.cond = gather(out, cond_);
    s.null = guidance_ == 1 ? s.cond : gather(out, null_);
    s.guided = guidance_ == 1 ? s.cond : guide(s.cond, s.null, guidance_);
    s.x0 = stitch_(to_x0(s.guided, s.crops));
    return s;
  }
  CollageStep<B> step(const Tensor<B, 2>& x, Index t) const {
    return step(x, t, [](const Tensor<B, 2>& output, const Tensor<B, 2>&) { return output; });
  }
  /// Stitches any values of the crops.
  Tensor<B, 2> stitch(const Tensor<B, 2>& crops) const { return stitch_(crops); }

 private:
  /// Frames of a crop with a text: what the network sees as one sequence.
  struct Job {
    Index first, length, text;  // first: row of the motions
    auto operator<=>(const Job&) const = default;
  };
  /// Jobs that go through the network together: sequences of frames, each with one or several texts.
  struct Batch {
    std::vector<Index> rows;  // of x
    Offsets frames, uses;     // uses: the texts of each sequence
    decltype(encoded_text<B>(std::declval<const D&>(), TextFeatures<B>())) text;
  };

  void check_texts(Index texts, Index nulls) const {
    Index intervals = 0;
    for (const TimelinePlan& p : plan_.timelines) intervals += static_cast<Index>(p.timeline.intervals.size());
    if (texts == intervals && nulls == 1) return;
    raise<shape_error>(204, "Collage: ", texts, " texts for ", intervals, " intervals; ", nulls,
                       " unconditional texts");
  }

  void prepare_step() {
    const DenoiserTraits traits = denoiser_->traits();
    for (const TimelinePlan& p : plan_.timelines) detail::check_crops(p, traits.longest());
    const bool fixed = traits.crop_frames > 0;
    motion_ = CropRows::of(plan_, traits.crop_frames);
    // With a mask, a crop of fixed size shrinks to its own frames again: masked frames take no part.
    crops_ = fixed && traits.uses_lengths ? own_frames(traits.crop_frames) : motion_;
    stitch_ = Stitcher<B>(plan_, layout_, crops_.offsets, motion_.stride);
    build_batch();
  }

  CropRows own_frames(Index crop_frames) const {
    CropRows out = CropRows::of(plan_);
    for (Index& row : out.rows) {  // the same frames in motions with more rows
      const Index m = row / plan_.frames;
      row += m * crop_frames;
    }
    out.stride = motion_.stride;
    return out;
  }

  /// What the network makes of all jobs, one after the other.
  Tensor<B, 2> denoised(const Tensor<B, 2>& x, Index t) const {
    const detail::RowsTogether in_any_batch(detail::RowsTogether::many);
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

  /// For every crop its text as a number of texts_: equal texts have the same, "" that of the unconditional one.
  std::vector<Index> texts_of_crops() const {
    const Index null = texts_.count() - 1;
    std::vector<Index> out;
    std::map<std::string_view, Index> known{{"", null}};
    Index first = 0;
    for (const TimelinePlan& p : plan_.timelines) {
      for (const Crop& c : p.crops)
        out.push_back(c.is_transition() ? null : known.emplace(p.text(c), first + c.interval).first->second);
      first += static_cast<Index>(p.timeline.intervals.size());
    }
    return out;
  }

  void build_batch() {
    const detail::RowsTogether in_any_batch(detail::RowsTogether::many);
    const Index null = texts_.count() - 1;
    std::vector<std::pair<Job, Job>> crops;  // with its text, and without
    std::map<Job, Index> begin;              // of all jobs, where their rows begin in the batch
    for (Index i = 0; const Index text : texts_of_crops()) {
      const Index length = crops_.offsets.length(i);
      const Index first = length == 0 ? 0 : crops_.rows[static_cast<std::size_t>(crops_.offsets.begin(i))];
      crops.push_back({{first, length, text}, {first, length, null}});
      ++i;
      if (length == 0) continue;
      begin[crops.back().first];
      if (guidance_ != 1) begin[crops.back().second];
    }
    batches_.clear(), cond_.clear(), null_.clear();
    if (!can_divide()) return build_two_calls(crops);
    std::vector<Job> jobs;
    for (const auto& [job, at] : begin) jobs.push_back(job);
    detail::sort(jobs, [](const Job& a, const Job& b) { return a.length != b.length ? a.length > b.length : a < b; });

    const Index most = rows_at_once_ > 0 ? rows_at_once_ : std::numeric_limits<Index>::max();
    std::vector<Index> rows, lengths, uses, which;  // of the next batch
    Index results = 0, before = 0;                  // rows of its results, and of those of the batches so far
    const Job* last = nullptr;                      // of the batch
    const auto end_batch = [&] {
      batches_.push_back({rows, Offsets(lengths), Offsets(uses), encoded_text<B>(*denoiser_, gather(texts_, which))});
      before += results;
      results = 0, last = nullptr;
      rows.clear(), lengths.clear(), uses.clear(), which.clear();
    };
    for (const Job& job : jobs) {
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
    for (const auto& [with, without] : crops) {
      for (Index r = 0; r < with.length; ++r) {
        cond_.push_back(begin[with] + r);
        if (guidance_ != 1) null_.push_back(begin[without] + r);
      }
    }
  }
  /// Where a sequence depends on the others: as published, all crops in their order, and then the same without their
  /// texts.
  void build_two_calls(std::span<const std::pair<Job, Job>> crops) {
    const Index rows = crops_.offsets.rows();
    for (Index call = 0; call < (guidance_ == 1 ? 1 : 2); ++call) {
      std::vector<Index> lengths, which;
      for (const auto& [with, without] : crops) {
        if (with.length == 0) continue;
        lengths.push_back(with.length);
        which.push_back(call == 0 ? with.text : without.text);
      }
      const Offsets frames(lengths);
      batches_.push_back(
          {crops_.rows, frames, Offsets::equal(frames.count(), 1), encoded_text<B>(*denoiser_, gather(texts_, which))});
      for (Index r = 0; r < rows; ++r) (call == 0 ? cond_ : null_).push_back(call * rows + r);
    }
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
  FeatureLayout layout_;
  TextFeatures<B> texts_;  // of all intervals, then the unconditional one
  double guidance_;
  Index rows_at_once_;
  CropRows motion_, crops_;
  Stitcher<B> stitch_;
  std::vector<Batch> batches_;
  std::vector<Index> cond_, null_;  // for every row of the crops its row of all batches, with its text and without
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

/// The whole reverse process with any clean_motion(x, t). noise(0) is the initial x, noise(1), noise(2), ... belong to
/// the steps; all of shape (rows, features).
/// -> clean motions (rows, features), normalised; rows behind a timeline's end mean nothing. `watch(t, step)` sees
/// every step. Throws `cancelled` if progress says so.
template <Backend B, class Clean, class Noise, class Watch = IgnoreSteps>
Tensor<B, 2> sample_clean_motions(const GaussianDiffusion& diffusion, const Clean& clean_motion, Noise&& noise,
                                  const SamplingOptions& options = {}, Progress progress = {},
                                  const Watch& watch = {}) {
  auto step_noise = [&](Index draw) { return noise(draw + 1); };
  const StepOptions step{.noise_scale = options.noise_scale, .clip = options.clip};
  if (options.sampler == SamplingOptions::Sampler::ddim) {
    return sample_ddim<B, 2>(diffusion, noise(0), clean_motion, step_noise, options.eta, step, detail::KeepX0{},
                             progress, watch);
  }
  return sample_ancestral<B, 2>(diffusion, noise(0), clean_motion, step_noise, step, detail::KeepX0{}, progress, -1,
                                watch);
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
inline BatchPlan independent_plan(const BatchPlan& plan, Index frames = 0) {
  std::vector<TimelinePlan> alone;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Interval& i : p.timeline.intervals) {
      alone.push_back(plan_timeline({{{i.text, 0, frames > 0 ? frames : i.end - i.start, BodyParts::all()}}}));
    }
  }
  return batch_plans(std::move(alone));
}

MOTIONLANG_NAMESPACE_END
