// SPDX-License-Identifier: MIT
/// The hyperparameters of SINC and TEACH, as config.json of a model folder has them. Presets are in train/presets.hpp.
#pragma once

#include <string>  // names

#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/weights/text_motion_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The features of both, published or with the exact heading. Throws config_error 103 for others.
inline void require_babel_features(const std::string& name) {
  if (name != "smplvelp-published" && name != "smplvelp")
    raise<config_error>(103, "features '", name, "' is not smplvelp-published or smplvelp");
}

struct SincNetworkConfig {
  Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  double dropout = 0.1;
  std::string activation = "gelu";
  std::string texts =
      "joined";  // several labels are one sentence; "separate": texts of their own (SINC-STE); "latents": each its own

  void require_sound() const {
    require_sizes(*this);
    if (texts != "joined" && texts != "separate" && texts != "latents")
      raise<config_error>(103, "texts '", texts, "' is not joined, separate or latents");
  }
  static constexpr auto fields() {
    using C = SincNetworkConfig;
    return motionlang::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers,
                              "num_heads", &C::num_heads, "dropout", &C::dropout, "activation", &C::activation, "texts",
                              &C::texts);
  }
};

struct SincLossesConfig {
  double recons = 1, kl = 32e-5, latent = 1e-5;

  void require_sound() const {
    for (const auto& [name, value] : {std::pair("recons", recons), {"kl", kl}, {"latent", latent}})
      require_value(name, value, value >= 0, "0 or more");
  }
  static constexpr auto fields() {
    using C = SincLossesConfig;
    return motionlang::fields("recons", &C::recons, "kl", &C::kl, "latent", &C::latent);
  }
};

struct SincTrainingConfig {
  std::string features = "smplvelp-published";
  SincNetworkConfig network;
  TextTokensConfig text;
  SincLossesConfig losses;
  OptimiserConfig optimiser;
  ValidationConfig validation;
  SincDataConfig data;

  double longest_seconds() const { return static_cast<double>(data.window) / babel_fps; }
  void require_sound() const { require_babel_features(features); }
  static constexpr auto fields() {
    using C = SincTrainingConfig;
    return motionlang::fields("features", &C::features, "network", &C::network, "text", &C::text, "losses", &C::losses,
                              "optimiser", &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

struct TeachNetworkConfig {
  Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  double dropout = 0.1;
  std::string activation = "gelu";
  Index hist_frames = 5;         // of the past that the text encoder reads
  bool z_prev_text = false;      // it also reads the latent of the past
  bool mask_padding = false;     // true: as in the paper, not as in the published code
  bool teacher_forcing = false;  // the past comes from the data, not from the decoder

  void require_sound() const {
    require_sizes(*this);
    require_value("hist_frames", hist_frames, hist_frames >= 1, "1 or more");
  }
  static constexpr auto fields() {
    using C = TeachNetworkConfig;
    return motionlang::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers,
                              "num_heads", &C::num_heads, "dropout", &C::dropout, "activation", &C::activation,
                              "hist_frames", &C::hist_frames, "z_prev_text", &C::z_prev_text, "mask_padding",
                              &C::mask_padding, "teacher_forcing", &C::teacher_forcing);
  }
};

struct TeachLossesConfig {
  double recons = 1, kl = 1e-5, latent = 1e-5;
  double velocity = 0;             // the published code has the term, with 0.5, but cannot run it
  bool loss_on_transition = true;  // false: reconstructions leave the transition out

  void require_sound() const {
    for (const auto& [name, value] :
         {std::pair("recons", recons), {"kl", kl}, {"latent", latent}, {"velocity", velocity}})
      require_value(name, value, value >= 0, "0 or more");
  }
  static constexpr auto fields() {
    using C = TeachLossesConfig;
    return motionlang::fields("recons", &C::recons, "kl", &C::kl, "latent", &C::latent, "velocity", &C::velocity,
                              "loss_on_transition", &C::loss_on_transition);
  }
};

struct TeachTrainingConfig {
  std::string features = "smplvelp-published";
  TeachNetworkConfig network;
  TextTokensConfig text;
  TeachLossesConfig losses;
  OptimiserConfig optimiser;
  ValidationConfig validation;
  TeachDataConfig data;

  double longest_seconds() const { return static_cast<double>(data.longest) / babel_fps; }
  void require_sound() const {
    require_babel_features(features);
    if (data.shortest < network.hist_frames)
      raise<config_error>(102, "data.shortest is ", data.shortest, ", network.hist_frames ", network.hist_frames,
                          ": the past has more frames than an action may have");
  }
  static constexpr auto fields() {
    using C = TeachTrainingConfig;
    return motionlang::fields("features", &C::features, "network", &C::network, "text", &C::text, "losses", &C::losses,
                              "optimiser", &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

MOTIONLANG_NAMESPACE_END
