// SPDX-License-Identifier: MIT
/// The hyperparameters of ACTOR and of the classifiers that judge it, as config.json of a model folder has them.
/// Presets are in train/presets.hpp.
#pragma once

#include <string>  // names

#include <motionlang/core/require_value.hpp>
#include <motionlang/datasets/actor_clips.hpp>
#include <motionlang/optim/optimiser_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// In a network of `frames`, latent_dim is the width of a latent, ff_size that of the GRUs, and nothing is dropped.
struct ActorNetworkConfig {
  Index latent_dim = 256, ff_size = 1024, num_layers = 8, num_heads = 4;
  double dropout = 0.1;
  std::string activation = "gelu";           // core/activation.hpp; of the transformers
  std::string encoder = "tokens";            // "average", "gru", "fully_connected", "frames"
  std::string decoder = "transformer";       // "gru", "fully_connected", "autoregressive", "frames"
  std::string conditioning = "action_bias";  // "concat_bias", "zandtime", "time_encoding"
  bool concatenate_time = true;  // GRU and autoregressive decoder: the input of each frame includes its time

  void require_sound() const { require_sizes(*this); }
  static constexpr auto fields() {
    using C = ActorNetworkConfig;
    return motionlang::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers,
                              "num_heads", &C::num_heads, "dropout", &C::dropout, "activation", &C::activation,
                              "encoder", &C::encoder, "decoder", &C::decoder, "conditioning", &C::conditioning,
                              "concatenate_time", &C::concatenate_time);
  }
};

/// Points are the 24 joints of our own skeleton, or those of the user's body (features/actor_points.hpp).
struct ActorLossConfig {
  double rc = 1, rcxyz = 1, kl = 1e-5, vel = 0, velxyz = 0;
  std::string points = "joints";  // or, of the body that the files name, "vertices", "smpl", "a2m", "a2mpl", "vibe"
  bool vertstrans = false;        // points of a body include the path of the root, as joints do

  void require_sound() const {
    for (const auto& [name, value] :
         {std::pair("rc", rc), {"rcxyz", rcxyz}, {"kl", kl}, {"vel", vel}, {"velxyz", velxyz}})
      require_value(name, value, value >= 0, "0 or more");
  }
  /// Throws config_error 101 if there is nothing to train on.
  void require_any() const {
    if (rc + rcxyz + kl + vel + velxyz == 0)
      raise<config_error>(101, "losses.rc, rcxyz, kl, vel and velxyz are 0, expected one above 0");
  }
  static constexpr auto fields() {
    using C = ActorLossConfig;
    return motionlang::fields("rc", &C::rc, "rcxyz", &C::rcxyz, "kl", &C::kl, "vel", &C::vel, "velxyz", &C::velxyz,
                              "points", &C::points, "vertstrans", &C::vertstrans);
  }
};

struct ActorTrainingConfig {
  ActorClipsConfig clips;
  ActorNetworkConfig network;
  ActorLossConfig losses;
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  static constexpr auto fields() {
    using C = ActorTrainingConfig;
    return motionlang::fields("clips", &C::clips, "network", &C::network, "losses", &C::losses, "optimiser",
                              &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

struct ClassifierConfig {
  std::string kind = "gru";  // on positions of joints; or "stgcn", on rotations
  ActorClipsConfig clips;
  Index hidden_size = 128, num_layers = 2;  // of the GRU
  bool drawn_state = false;                 // the GRU starts from normal noise, also after training, not from zeros
  Index width = 64;                         // of the first blocks of ST-GCN; later ones have two and four times as much
  double generated_share = 0;               // the share of the training motions that the ACTOR of --generated makes
  std::string generated_kind = "sampled";   // or "denoised", "interpolated", made from recorded ones
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  static constexpr auto fields() {
    using C = ClassifierConfig;
    return motionlang::fields("kind", &C::kind, "clips", &C::clips, "hidden_size", &C::hidden_size, "num_layers",
                              &C::num_layers, "drawn_state", &C::drawn_state, "width", &C::width, "generated_share",
                              &C::generated_share, "generated_kind", &C::generated_kind, "optimiser", &C::optimiser,
                              "validation", &C::validation, "data", &C::data);
  }
};

MOTIONLANG_NAMESPACE_END
