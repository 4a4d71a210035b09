// SPDX-License-Identifier: MIT
/// STMC after an edit of its timelines: everything that the edit cannot change is reused from the run before.
///
///     StmcRecord<B> record;
///     auto motion = generate_recorded(stmc, timelines, Philox{.seed = 7}, {.steps = 10}, record);
///     timelines[0].intervals[2].text = "run";
///     StmcReuse reuse;
///     // The bits of generate(timelines, ...). The second call makes a motion that differs only near the edit.
///     motion = regenerate(stmc, record, timelines, {}, &reuse);
///     motion = regenerate(stmc, record, timelines, {.within = 20}, &reuse);
///
/// The limit of reuse (compose/edits.hpp): an edit spreads by one crop with every step. Overlapping neighbours form a
/// chain of crops, so nothing is reused after as many steps as the chain has crops beside the edit. With 100 steps, a
/// few per cent of the work can be reused; with 10 steps and a long timeline much of it. Timelines of the batch that
/// were not edited cost nothing, and with overlap 0 neither do texts behind a cut that nothing spans. The option
/// `within` approximates: frames further than that from the edit keep their clean estimates of every step, as in
/// inpainting. The frames between are fitted to them.
/// Memory   a record has (steps, frames, 205) values: 20 MB for 12 s and 100 steps, 2 MB with 10
#pragma once

#include <motionlang/compose/edits.hpp>
#include <motionlang/systems/stmc.ipp>
#include <motionlang/systems/stmc_reuse.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The record of a run for use after an edit.
template <Backend B>
struct StmcRecord {
  std::vector<Timeline> timelines{};
  Philox rng{};
  StmcOptions options{};           // without progress
  Index rows = 0;                  // of every timeline
  std::vector<Tensor<B, 2>> x0{};  // after each step: clean estimate (timelines * rows, features), normalised
  bool exact = true;               // false: not the result of a run without a record, because of `within`
};

struct RegenerateOptions {
  std::optional<Index> within{};  // frames; approximation: frames further from the edit do not change
  Progress progress{};
};

namespace detail {

/// The clean estimates of a run. Those that can differ from the recorded ones are computed, the others copied.
template <Backend B, class D>
class Regeneration {
 public:
  Regeneration(const StmcRecord<B>& before, EditSpread spread, const Collage<B, D>& collage)
      : before_(before), spread_(std::move(spread)), needed_(collage) {
    for (const TimelinePlan& p : collage.plan().timelines) reuse_.frames += p.frames;
  }

  template <class Whole>
  Tensor<B, 2> operator()(const Collage<B, D>& collage, const Whole& whole, const Tensor<B, 2>& x, Index t) {
    const std::size_t step = x0_.size();
    if (step == 0 || spread_.advance()) {
      if (spread_.frames() > 0) needed_ = collage.with_plan(spread_.needed());
      find_rows(collage);
      if (reuse_.everywhere == 0 && spread_.frames() > 0 && spread_.everywhere())
        reuse_.everywhere = static_cast<Index>(step) + 1;
    }
    const bool nothing = spread_.frames() == 0;
    reuse_.work += nothing ? 0 : needed_.batch_rows();
    reuse_.whole_work += collage.batch_rows();
    const auto made = nothing ? Tensor<B, 2>::zeros(x.shape()) : whole(needed_, x, t);
    x0_.push_back(gather(concat(0, before_.x0[step], made), rows_));
    return x0_.back();
  }

  std::vector<Tensor<B, 2>> x0() && { return std::move(x0_); }
  StmcReuse reuse() const {
    StmcReuse r = reuse_;
    r.kept = r.frames - spread_.frames();
    r.steps = std::ssize(x0_);
    r.exact = before_.exact && !spread_.limited();
    return r;
  }

 private:
  /// For every row of x0 its place: among the recorded ones, or after them among the new ones.
  void find_rows(const Collage<B, D>& collage) {
    const Index recorded = before_.x0.front().size(0);
    rows_.clear();
    for (Index r = 0; r < collage.rows(); ++r) {
      const Index m = r / collage.stride(), f = r % collage.stride();
      rows_.push_back(spread_.differs(static_cast<std::size_t>(m), f) ? recorded + r : m * before_.rows + f);
    }
  }

  const StmcRecord<B>& before_;
  EditSpread spread_;
  Collage<B, D> needed_;
  std::vector<Index> rows_;
  std::vector<Tensor<B, 2>> x0_;
  StmcReuse reuse_;
};

template <Backend B, Denoiser<B> D>
void require_own_results(const Collage<B, D>& collage) {
  if (!collage.can_divide())
    raise<config_error>(102,
                        "edits: this denoiser's result for a crop depends on the other crops, so nothing can be kept");
}

/// A step of plms uses earlier ones, also those of frames that an edit changes later.
inline void require_own_steps(const SamplingOptions& sampling) {
  if (sampling.sampler == SamplingOptions::Sampler::plms)
    raise<config_error>(102,
                        "edits: nothing of a run with the sampler plms can be kept; ddpm and ddim can be recorded");
}

}  // namespace detail

/// The motions of stmc.generate(timelines, rng, options), and a record of the run. Throws as it does, and config_error
/// 102 if crops depend on each other (BatchMates) or the sampler is plms.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> generate_recorded(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                                            const Philox& rng, const StmcOptions& options, StmcRecord<B>& record) {
  detail::require_own_steps(options.sampling.value_or(stmc.sampling));
  StmcRecord<B> made{.timelines = {timelines.begin(), timelines.end()}, .rng = rng, .options = options};
  made.options.progress = {};
  const auto note = [&](const Collage<B, D>& collage, const auto& whole, const Tensor<B, 2>& x, Index t) {
    detail::require_own_results(collage);
    made.rows = collage.stride();
    made.x0.push_back(whole(collage, x, t));
    return made.x0.back();
  };
  const auto noise = [&](Index draw, const Shape& shape) { return stmc.noise(rng, draw, shape); };
  auto motions = stmc.generate_from(timelines, noise, options, note);
  record = std::move(made);
  return motions;
}

/// The motions of other timelines with seed and options of the record, computed from the record as far as possible. The
/// record is then that of this run. Throws as generate does, and config_error 102 if the record has another number of
/// steps.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> regenerate(const Stmc<B, D, E>& stmc, StmcRecord<B>& record,
                                     std::span<const Timeline> timelines, const RegenerateOptions& how = {},
                                     StmcReuse* reuse = nullptr) {
  StmcOptions options = record.options;
  detail::require_own_steps(options.sampling.value_or(stmc.sampling));
  options.progress = how.progress;
  const auto steps = stmc.process(options.steps).steps();
  if (std::ssize(record.x0) != steps)
    raise<config_error>(102, "regenerate: the record has ", record.x0.size(), " steps, a run of this model ", steps);
  const DenoiserTraits traits = stmc.denoiser.traits();
  const Index reads = traits.uses_lengths ? 0 : traits.crop_frames;
  std::optional<detail::Regeneration<B, D>> run;
  const auto estimate = [&](const Collage<B, D>& collage, const auto& whole, const Tensor<B, 2>& x, Index t) {
    if (!run) {
      detail::require_own_results(collage);
      const BatchPlan before = plan_timelines(record.timelines, stmc.plan_options(options));
      run.emplace(record, EditSpread(before, record.rows, collage.plan(), collage.stride(), reads, how.within),
                  collage);
    }
    return (*run)(collage, whole, x, t);
  };
  Index rows = 0;
  const auto noise = [&](Index draw, const Shape& shape) {
    return rows = shape[1], stmc.noise(record.rng, draw, shape);
  };
  auto motions = stmc.generate_from(timelines, noise, options, estimate);
  const StmcReuse found = run->reuse();
  if (reuse != nullptr) *reuse = found;
  options.progress = {};
  record = {{timelines.begin(), timelines.end()}, record.rng, options, rows, std::move(*run).x0(), found.exact};
  return motions;
}

MOTIONLANG_NAMESPACE_END
