// SPDX-License-Identifier: MIT
/// The hyperparameters of Guo's evaluator in one structure, for both stages of its training, and their presets.
///
///     GuoTrainingConfig config = guo_preset("guo-published", GuoStage::matching);
///
/// Source   Guo et al., "Generating diverse and natural 3D human motions from text" (CVPR 2022), section 5.2;
///          text-to-motion train_decomp_v3.py, train_tex_mot_match.py with the options of its README
#pragma once

#include <string>   // names
#include <utility>  // names of sizes

#include <motionlang/core/require_value.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/optim/optimiser_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The part to train. The matching pair needs the convolutions of the movement stage.
enum class GuoStage { movement, matching };

/// The autoencoder of movements.
struct GuoMovementConfig {
  Index hidden = 512, latent = 512;
  Index window = 24;  // frames
  double dropout = 0.2, sparsity = 0.001, smooth = 0.001;
  double feature_bias = 5;  // the deviations of root and contacts are divided by it, twice as published

  void require_sound() const {
    for (const auto& [name, size] : {std::pair("hidden", hidden), {"latent", latent}})
      require_value(name, size, size >= 1 && size <= 65'536, "1 to 65536");
    require_value("window", window, window >= 8 && window % 4 == 0, "a multiple of 4 from 8 on");
    require_value("dropout", dropout, dropout >= 0 && dropout < 1, "0 or more, and less than 1");
    require_value("feature_bias", feature_bias, feature_bias > 0, "a number above 0");
    for (const auto& [name, value] : {std::pair("sparsity", sparsity), {"smooth", smooth}})
      require_value(name, value, value >= 0, "0 or more");
  }
  static constexpr auto fields() {
    using C = GuoMovementConfig;
    return motionlang::fields("hidden", &C::hidden, "latent", &C::latent, "window", &C::window, "dropout", &C::dropout,
                              "sparsity", &C::sparsity, "smooth", &C::smooth, "feature_bias", &C::feature_bias);
  }
};

/// The encoders of texts and motions.
struct GuoMatchingConfig {
  Index text_hidden = 512, motion_hidden = 1024, embedding = 512;
  Index word_width = 300;  // of random word vectors, where none are given
  double margin = 10;
  bool zero_shift = true;  // as published, the shift of negatives may be 0, so that one step in seven parts the pairs

  void require_sound() const {
    for (const auto& [name, size] : {std::pair("text_hidden", text_hidden),
                                     {"motion_hidden", motion_hidden},
                                     {"embedding", embedding},
                                     {"word_width", word_width}})
      require_value(name, size, size >= 1 && size <= 65'536, "1 to 65536");
    require_value("margin", margin, margin > 0, "a number above 0");
  }
  static constexpr auto fields() {
    using C = GuoMatchingConfig;
    return motionlang::fields("text_hidden", &C::text_hidden, "motion_hidden", &C::motion_hidden, "embedding",
                              &C::embedding, "word_width", &C::word_width, "margin", &C::margin, "zero_shift",
                              &C::zero_shift);
  }
};

struct GuoTrainingConfig {
  std::string features = "guoh3d";  // or kit
  GuoMovementConfig movement;
  GuoMatchingConfig matching;
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  void require_sound() const {
    if (features != "guoh3d" && features != "kit")
      raise<config_error>(103, "features '", features, "' is not guoh3d or kit, which the evaluator reads");
  }
  static constexpr auto fields() {
    using C = GuoTrainingConfig;
    return motionlang::fields("features", &C::features, "movement", &C::movement, "matching", &C::matching, "optimiser",
                              &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

/// "guo-published": the released programs, also for KIT; "small": minutes on two cores. Throws config_error 103.
GuoTrainingConfig guo_preset(const std::string& name, GuoStage stage);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/guo_config.ipp>
#endif
