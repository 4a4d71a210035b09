// SPDX-License-Identifier: MIT
/// The hyperparameters with which the bundled model is trained. The defaults are the preset "bundled" of
/// `motionlang train-mdm-smpl`.
///
///     StmcTrainingConfig config;
///     set_config(config, "optimiser.batch=48");
///     set_config(config, "losses.foot=0.5");
///     config.require_consistent();
#pragma once

#include <map>     // settings
#include <string>  // words
#include <vector>  // words

#include <motionlang/datasets/training_set.hpp>
#include <motionlang/file/fields_json.hpp>
#include <motionlang/weights/diffusion_training_config.hpp>
#include <motionlang/weights/stmc_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Weights of the terms of the loss.
struct StmcLossConfig {
  double velocity = 1;  // differences between neighbouring frames
  double root = 8;      // the four features that move the figure, against 1 for each of the others
  double foot = 0.2;    // the velocity of the feet, (m/s)^2
  double text = 0.2;    // the prediction of a summary of the motion, and of its verb, from a caption's vector
  double verb = 0.25;   // within `text`: the verb, against 1 for the summary
  double snr_cap = 10;  // the largest weight of a sample that shows its motion clearly (detail::snr_weight)

  void require_sound() const;
  static constexpr auto fields() {
    using C = StmcLossConfig;
    return motionlang::fields("velocity", &C::velocity, "root", &C::root, "foot", &C::foot, "text", &C::text, "verb",
                              &C::verb, "snr_cap", &C::snr_cap);
  }
};

/// How the finished model samples, unless its user says otherwise.
struct StmcSamplingConfig {
  Index steps = 20;     // the judge finds most motions right with 20, a fifth of the time of all steps; 0: all
  double guidance = 2;  // and more of them with 2 than with 3

  void require_sound() const;
  static constexpr auto fields() {
    using C = StmcSamplingConfig;
    return motionlang::fields("steps", &C::steps, "guidance", &C::guidance);
  }
};

struct StmcTrainingConfig {
  MdmSmplNetworkConfig network{.latent_dim = 256, .ff_size = 768, .num_layers = 6, .num_heads = 4, .dropout = 0.05};
  CaptionEncoderConfig text{};
  Index vocabulary = 800;  // word pieces to learn; not used with word vectors
  DiffusionProcessConfig diffusion{};
  StmcSamplingConfig sampling{};
  Index text_steps = 3000;   // of the text encoder alone, before the denoiser is trained, at a rate of their own
  double noise_focus = 0.5;  // the share of the samples from the noisiest fifth of the diffusion
  double pose_scale = 1;     // of the deviations of the pose: below 1, motion is larger beside the same noise
  SampleOptions samples{};
  std::vector<std::string> practised{};  // words whose segments are drawn more often
  double practice = 4;                   // this many times as often
  StmcLossConfig losses{};
  Index updates = 16'000;  // exactly so many. 0: optimiser.epochs decides; an epoch has as many samples as segments
  OptimiserConfig optimiser{.lr = 4e-4,
                            .weight_decay = 0.01,
                            .clip_norm = 1,
                            .ema = 0.999,
                            .schedule = "cosine",
                            .warmup = 500,
                            .batch = 32,
                            .seed = 1};

  /// Throws config_error 101, 102, 103 for values out of range, and if settings contradict each other.
  void require_consistent() const;
  void require_sound() const;
  /// The sizes of the model, and how it samples.
  StmcModelConfig model() const;
  static constexpr auto fields() {
    using C = StmcTrainingConfig;
    return motionlang::fields("network", &C::network, "text", &C::text, "vocabulary", &C::vocabulary, "diffusion",
                              &C::diffusion, "sampling", &C::sampling, "text_steps", &C::text_steps, "noise_focus",
                              &C::noise_focus, "pose_scale", &C::pose_scale, "samples", &C::samples, "practised",
                              &C::practised, "practice", &C::practice, "losses", &C::losses, "updates", &C::updates,
                              "optimiser", &C::optimiser);
  }
};

namespace detail {

/// The settings that decide what a step computes, as texts: all but the number of steps and how the model samples.
std::map<std::string, std::string> stmc_settings(const StmcTrainingConfig& config, const std::string& fingerprint);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/stmc_training_config.ipp>
#endif
