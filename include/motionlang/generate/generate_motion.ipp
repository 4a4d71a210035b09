// SPDX-License-Identifier: MIT
// Bodies of the templates of generate_motion.hpp, for every backend, denoiser and text encoder. Any header may include
// them.
#pragma once

#include <algorithm>  // max
#include <set>        // texts

#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/generate/arm_overlay.hpp>
#include <motionlang/generate/detail/kept_clip.hpp>
#include <motionlang/generate/generate_motion.hpp>
#include <motionlang/generate/shared_motions.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/systems/sinc_baseline.hpp>
#include <motionlang/systems/stmc_keep.hpp>
#include <motionlang/weights/stmc_record.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The noise of a file: noise/000 is the initial one. Throws io_error 401 ... 407.
template <Backend B>
auto noise_of_file(const FilePath& path) {
  return [file = SafetensorsFile::open(path)](Index draw, const Shape& shape) {
    const auto& view = file.tensor(numbered_name("noise", static_cast<std::size_t>(draw)));
    if (view.shape != shape)
      raise<io_error>(407, file.name(), ": ", view.name, " is ", view.shape, ", this timeline needs ", shape);
    return Tensor<B, 3>::from(values_of<typename B::scalar>(view), shape);
  };
}

/// One call of generate_motions.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
class GenerateRun {
 public:
  GenerateRun(const Stmc<B, D, E>& model, const GenerateOptions& options) : model_(model), o_(options) {
    require_steps(o_, model_.diffusion.steps());
    require_one_source(o_);
    how_.overlap = frame_at(o_.overlap, model_.fps);
    how_.hidden = HiddenTexts::ignore;  // hidden_text_warnings report them
    how_.guidance = o_.guidance;
    how_.recall = o_.recall.value_or(usual_recall);
    how_.steps = o_.steps;
    how_.sampling = model_.sampling;
    if (o_.sampler) how_.sampling->sampler = *o_.sampler;
    if (o_.noise_scale) how_.sampling->noise_scale = *o_.noise_scale;
    if (o_.keep) keep_on_model();
  }

  /// Throws option_error 102 if a motion depends on others of the list, so that no part of the list can be made alone.
  void require_own_motions(std::span<const Timeline> timelines) const {
    if (timelines.size() + o_.before.size() < 2) return;
    const BatchMates mates = model_.denoiser.traits().mates;
    bool one_token = mates != BatchMates::longest_text;
    if (!one_token) {
      std::set<std::string> texts{""};
      for (const std::span<const Timeline> list : {o_.before, timelines}) {
        for (const Timeline& t : cut(list, o_.cut_texts)) {
          for (const Interval& i : t.intervals) texts.insert(i.text);
        }
      }
      const std::vector<std::string> all(texts.begin(), texts.end());
      one_token = model_.text_encoder.template encode<B>(std::span(all)).tokens.offsets.longest() <= 1;
    }
    detail::require_own_motions(mates, one_token);
  }

  std::vector<Motion> operator()(std::span<const Timeline> timelines) const {
    if (o_.notes != nullptr) *o_.notes = {.layout = model_.layout.name};
    std::vector<Motion> collages, motions;
    const Arms arms = arms_of(timelines);
    Steps first{&o_.progress, 0, arms.texts.empty() ? 1 : 2}, second{&o_.progress, 1, 2};
    Sampling how{Philox{.seed = o_.seed}, how_, o_.cut_texts};
    how.options.progress = first;
    how.options.first = sequences_before(how.options);
    for (const Tensor<B, 2>& f : features(timelines, how)) {
      const std::vector<double> rows(f.span().begin(), f.span().end());
      if (o_.notes != nullptr) o_.notes->features.push_back(rows);
      collages.push_back(motion_of(rows));
    }
    how.options.progress = second;
    how.options.first = std::ssize(arms_of(o_.before).texts);
    overlay(arms, collages, how);
    for (Motion& motion : collages) {
      if (o_.keep) motion = in_its_place(std::move(motion), clip_, clip_frames_, o_);
      motions.push_back(finish_motion(std::move(motion), o_));
      if (o_.keep && o_.notes != nullptr)
        o_.notes->kept_moved =
            std::max(o_.notes->kept_moved, farthest_from(motions.back(), clip_, clip_frames_, *o_.keep));
    }
    return motions;
  }

 private:
  using Features = std::vector<Tensor<B, 2>>;

  /// The sampling of a run. A reused run has it in its record.
  struct Sampling {
    Philox rng{};
    StmcOptions options{};
    bool cut = true;
  };

  Motion motion_of(std::span<const double> rows) const {
    return motion_of_features(model_.layout.name, rows, model_.layout.size, model_.fps);
  }

  /// Counts the steps of one of several runs for the caller.
  struct Steps {
    const Progress* caller;
    Index run, runs;
    bool operator()(Index done, Index total) const { return (*caller)(run * total + done, runs * total), true; }
  };

  /// The texts of arms in the timelines: the timeline of each, and its motion alone.
  struct Arms {
    std::vector<std::pair<std::size_t, ArmText>> texts{};
    std::vector<Timeline> alone{};
  };
  Arms arms_of(std::span<const Timeline> timelines) const {
    Arms out;
    const bool possible = o_.overlay_arms && !o_.keep && o_.noise.string().empty() && model_.layout.name == "smplrifke";
    for (std::size_t m = 0; possible && m < timelines.size(); ++m) {
      for (ArmText& text : arm_texts(timelines[m], frame_at(shortest_part, model_.fps))) {
        out.alone.push_back(text.alone);
        out.texts.emplace_back(m, std::move(text));
      }
    }
    return out;
  }
  /// Lays the arms' own motions over the motions of the timelines, at the times where the collage lost their texts.
  void overlay(const Arms& arms, std::vector<Motion>& motions, const Sampling& how) const {
    if (arms.texts.empty()) return;
    const Features features = model_.generate(cut(arms.alone, how.cut), how.rng, how.options);
    for (std::size_t i = 0; i < arms.texts.size(); ++i) {
      const auto& [m, text] = arms.texts[i];
      const Motion alone = motion_of(std::vector<double>(features[i].span().begin(), features[i].span().end()));
      if (is_arm_lost(motions[m], alone, text)) motions[m] = lay_arm_over(motions[m], alone, text);
    }
  }

  /// (frames, features) of each timeline, not normalised. Sets the sampling of a reused run.
  Features features(std::span<const Timeline> timelines, Sampling& how) const {
    if (!o_.reuse.string().empty()) return reused(timelines, how);
    const std::vector<Timeline> texts = cut(timelines, o_.cut_texts);
    const Philox& rng = how.rng;
    if (o_.keep) return around(texts, how);
    if (o_.mode == StmcMode::sinc || o_.mode == StmcMode::sinc_lerp) return stitched_once(texts, how);
    if (!o_.noise.string().empty()) return model_.generate_from(texts, noise_of_file<B>(o_.noise), how.options);
    if (o_.record.string().empty()) return model_.generate(texts, rng, how.options);
    StmcRecord<B> record;
    Features out = generate_recorded<B>(model_, texts, rng, how.options, record);
    save(record, o_.cut_texts);
    return out;
  }

  /// The number of sequences that the timelines before these have in the list.
  Index sequences_before(const StmcOptions& options) const {
    if (o_.before.empty() || (o_.mode != StmcMode::sinc && o_.mode != StmcMode::sinc_lerp))
      return std::ssize(o_.before);
    const BatchPlan plan = plan_timelines(cut(o_.before, o_.cut_texts), sinc_plan_options(model_, options));
    return std::ssize(crop_lengths(plan));
  }

  std::vector<Timeline> cut(std::span<const Timeline> timelines, bool wanted) const {
    std::vector<Timeline> out;
    for (const Timeline& t : timelines) {
      const bool stmc = o_.mode == StmcMode::stmc;
      out.push_back(!stmc ? timeline_of_mode(o_.mode, t, model_.fps) : wanted ? cut_texts(t, model_.fps) : t);
    }
    return out;
  }

  /// By SINC: every text is sampled alone.
  Features stitched_once(std::span<const Timeline> texts, const Sampling& how) const {
    const SincCuts cuts = o_.mode == StmcMode::sinc ? SincCuts::hard : SincCuts::interpolated;
    if (o_.noise.string().empty()) return sinc_baseline(model_, texts, how.rng, how.options, cuts);
    return sinc_baseline_from(model_, plan_timelines(texts, sinc_plan_options(model_, how.options)),
                              noise_of_file<B>(o_.noise), how.options, cuts);
  }

  /// The clip that is kept, on the joints and at the rate of the model, and its features.
  void keep_on_model() {
    const MotionFeatures& own = features_of_layout(model_.layout.name, model_.layout.size);
    clip_ = resample(on_joints_of(own, o_.keep->motion), model_.fps);
    const auto rows = own.from_motion(clip_);
    clip_rows_.assign(rows.begin(), rows.end());
    clip_frames_ = std::ssize(rows) / model_.layout.size;
  }
  Features around(std::span<const Timeline> timelines, const Sampling& how) const {
    std::vector<KeptMotion<B>> kept;
    for (const Timeline& t : timelines) {
      auto& own = kept.emplace_back();
      own.features = Tensor<B, 2>::from(clip_rows_, {clip_frames_, model_.layout.size});
      for (const IndexRange& range : kept_frames(*o_.keep, clip_frames_, t.end(), model_.fps))
        own.parts.push_back({range, o_.keep->parts});
    }
    return generate_around<B>(model_, timelines, how.rng, how.options, std::span<const KeptMotion<B>>(kept));
  }

  /// Uses the record of an earlier run for the parts that were not edited.
  Features reused(std::span<const Timeline> timelines, Sampling& sampling) const {
    const auto file = SafetensorsFile::open(o_.reuse);
    auto record = load_stmc_record<B>(file, model_);
    const bool was_cut = file.metadata().contains("cut_texts") && file.metadata().at("cut_texts") == "1";
    RegenerateOptions how{.within = {}, .progress = sampling.options.progress};
    if (o_.keep_beyond) how.within = frame_at(*o_.keep_beyond, model_.fps);
    StmcReuse reuse;
    Features out = regenerate<B>(model_, record, cut(timelines, was_cut), how, &reuse);
    if (!o_.record.string().empty()) save(record, was_cut);
    if (o_.notes != nullptr) o_.notes->reuse = reuse, o_.notes->seed = record.rng.seed;
    sampling = {record.rng, record.options, was_cut};
    return out;
  }
  void save(const StmcRecord<B>& record, bool was_cut) const {
    save_stmc_record(o_.record, record, model_, {{"cut_texts", was_cut ? "1" : "0"}});
  }

  const Stmc<B, D, E>& model_;
  const GenerateOptions& o_;
  StmcOptions how_{};
  Motion clip_{};
  std::vector<typename B::scalar> clip_rows_{};
  Index clip_frames_ = 0;  // that the features have
};

}  // namespace detail

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
void require_own_motions(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                         const GenerateOptions& options) {
  detail::GenerateRun<B, D, E>(stmc, options).require_own_motions(timelines);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Motion> generate_motions(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                                     const GenerateOptions& options) {
  const auto make = [&](std::span<const Timeline> part, const GenerateOptions& how) {
    return detail::GenerateRun<B, D, E>(stmc, how)(part);
  };
  if (options.communicator.size() == 1) return make(timelines, options);
  return shared_motions(timelines, options, make, [&] { require_own_motions(stmc, timelines, options); });
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Motion generate_motion(const Stmc<B, D, E>& stmc, const Timeline& timeline, const GenerateOptions& options) {
  return generate_motions(stmc, std::span(&timeline, 1), options).front();
}

MOTIONLANG_NAMESPACE_END
