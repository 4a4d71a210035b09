// SPDX-License-Identifier: MIT
/// STMC: spatio-temporal motion collage. It turns a timeline of texts on several tracks into one motion.
///
/// Source  Petrovich, Litany, Iqbal, Black, Varol, Peng, Rempe: "Multi-track timeline control for text-driven 3D human
///         motion generation" (2024). It works at test time with any denoiser of explicit poses, without training
/// Bodies  motionlang::instantiated has those of Stmc<EigenBackend<float>>. If a unit is compiled with
///         MOTIONLANG_INSTANTIATED and uses another Stmc, it must also include <motionlang/systems/stmc.ipp>; otherwise
///         the compiler asks for it
#pragma once

#include <memory>    // shared motions
#include <optional>  // what the caller leaves to the model

#include <motionlang/compose/motion_recall.hpp>
#include <motionlang/compose/plan_options.hpp>
#include <motionlang/compose/timeline.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/diffusion/sampler.hpp>
#include <motionlang/features/layout.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/text/caption_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct BatchPlan;

namespace detail {

/// This type is complete where the bodies of Stmc are.
template <class T>
struct StmcBodies;
/// True if motionlang::instantiated has the bodies.
template <class T>
inline constexpr bool is_compiled_stmc = false;
/// Names the missing header for a function that no library can have compiled. Argument: of that function.
template <class T, class Argument>
struct HasStmcBodies {
  static constexpr bool value = true;
  static_assert(
      requires { sizeof(StmcBodies<T>); },
      "motionlang: for generate_from and sample include <motionlang/systems/stmc.ipp>");
};

}  // namespace detail

struct StmcOptions {
  Index overlap = 10;                // frames around a cut, in total
  std::optional<double> guidance{};  // weight of classifier-free guidance, 1: none; the model's own unless given
  std::optional<Index> steps{};      // of sampling, 0: all of the process; the model's own unless given
  std::optional<SamplingOptions> sampling{};  // the model's own unless given
  Gaps gaps = Gaps::fill;
  HiddenTexts hidden = HiddenTexts::refuse;
  Index rows_at_once = usual_rows_at_once;  // frames through the denoiser together; 0: all. Affects only the memory
  double recall = usual_recall;  // the share of remembered motions in their frames, 0 ... 1; 0: the network alone
  Progress progress{};           // called after every step; may cancel
  Index first = 0;               // the place of the first sequence in a longer list, of which these are a part
};

/// Clean motions, normalised, in consecutive rows.
template <Backend B>
struct CleanMotions {
  Tensor<B, 2> rows{};  // (motions * stride, features); rows behind the end of a motion mean nothing
  Index stride = 0;     // rows of every motion
};

/// The denoiser and encoder may be any models of `Denoiser<B>` and `TextEncoder<B>`.
///
///     auto stmc = load_stmc<EigenBackend<float>>("model.safetensors");
///     auto timeline = parse_timeline("walk forward # 0 # 6 # legs\nraise both arms # 2 # 5 # left arm # right arm\n");
///     Tensor<B, 2> motion = stmc.generate(timeline, Philox{.seed = 7});      // (frames, features)
template <Backend B, Denoiser<B> D = MdmSmplDenoiser<B>, TextEncoder<B> E = CaptionEncoder<B>>
struct Stmc {
  static_assert(
      detail::is_compiled_stmc<Stmc> || requires { sizeof(detail::StmcBodies<Stmc>); },
      "motionlang: for this backend, denoiser or encoder include <motionlang/systems/stmc.ipp>");

  D denoiser;
  E text_encoder;
  Normalizer<B> motion_normalizer, text_normalizer;
  GaussianDiffusion diffusion{CosineSchedule{.steps = 100}};
  FeatureLayout layout = smplrifke_layout();
  double guidance = 2.5;                         // for sampling, if the caller does not set it
  SamplingOptions sampling{};                    // the same
  Index steps = 0;                               // the same; 0: all of the process
  double fps = 20;                               // of its motions
  std::shared_ptr<const MotionRecall> memory{};  // motions that texts recall; null: none

  /// The weights of a text encoder without fields are in files of its own.
  static constexpr auto fields() {
    if constexpr (Module<E>)
      return motionlang::fields("denoiser", &Stmc::denoiser, "text_encoder", &Stmc::text_encoder, "motion_normalizer",
                                &Stmc::motion_normalizer, "text_normalizer", &Stmc::text_normalizer);
    else
      return motionlang::fields("denoiser", &Stmc::denoiser, "motion_normalizer", &Stmc::motion_normalizer,
                                "text_normalizer", &Stmc::text_normalizer);
  }

  /// One motion per timeline, (frames, features), not normalised. All are sampled together. The noise of each depends
  /// only on the generator and its place in the list. Throws timeline_error 504 ... 508, config_error, `cancelled`;
  /// option_error 102 for a part of a list, if the motions of the model depend on each other (BatchMates).
  std::vector<Tensor<B, 2>> generate(std::span<const Timeline> timelines, const Philox& rng,
                                     const StmcOptions& options = {}) const;
  Tensor<B, 2> generate(const Timeline& timeline, const Philox& rng, const StmcOptions& options = {}) const;

  /// The same with the caller's noise: noise(draw, shape) for draw 0 (initial), 1, 2, ... (steps) is a tensor
  /// (sequences, frames, features) of the given shape.
  template <class Noise, bool = detail::HasStmcBodies<Stmc, Noise>::value>
  std::vector<Tensor<B, 2>> generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                          const StmcOptions& options = {}) const;

  /// The same with clean estimates from a function: estimate(collage, whole, x, t) -> x0, all of shape (rows of the
  /// collage, features). whole(collage, x, t) is the estimate of a plain run.
  template <class Noise, class Estimate, bool = detail::HasStmcBodies<Stmc, Noise>::value>
  std::vector<Tensor<B, 2>> generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                          const StmcOptions& options, Estimate&& estimate) const;
  /// The same from a plan made with `plan_options`, for example with other rules for texts that claim the same part.
  template <class Noise, class Estimate, bool = detail::HasStmcBodies<Stmc, Noise>::value>
  std::vector<Tensor<B, 2>> generate_from(BatchPlan plan, Noise&& noise, const StmcOptions& options,
                                          Estimate&& estimate) const;

  /// The same motions before denormalisation.
  template <class Noise, class Estimate, bool = detail::HasStmcBodies<Stmc, Noise>::value>
  CleanMotions<B> sample(BatchPlan plan, Noise&& noise, const StmcOptions& options, Estimate&& estimate) const;
  /// Separates them, not normalised: (frames of its timeline in the plan, features) each.
  std::vector<Tensor<B, 2>> separate(const CleanMotions<B>& clean, const BatchPlan& plan) const;

  /// The options for planning timelines for this model.
  PlanOptions plan_options(const StmcOptions& options) const;

  /// Standard normal values of every sequence from its own stream, so a timeline has the same noise alone and in a
  /// batch. first: as in StmcOptions.
  Tensor<B, 3> noise(const Philox& rng, Index draw, const Shape& shape, Index first = 0) const;

  /// The process with this many evenly chosen steps, all if 0; the model's own number unless given. Throws config_error
  /// 105.
  GaussianDiffusion process(std::optional<Index> wanted) const;

 private:
  /// Features of the text of every interval, and of "". Each text is encoded once.
  struct PlanTexts {
    TextFeatures<B> text, null;
  };
  PlanTexts encode(const BatchPlan& plan) const;
};

/// Generated features (frames, 205) as a motion of the 24-joint skeleton, Y up, metres. Bone lengths are the
/// skeleton's, because the rotations are used and not the predicted positions. Published generation starts facing pi.
template <Backend B>
Motion stmc_motion(const Tensor<B, 2>& features, double fps = 20);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/systems/stmc.ipp>
#endif
