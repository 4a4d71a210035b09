// SPDX-License-Identifier: MIT
/// The hyperparameters of TM2T's three stages in one structure. Presets are in train/presets.hpp.
#pragma once

#include <string>  // names
#include <vector>  // channels

#include <motionlang/core/require_value.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/optim/optimiser_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The part to train. Each stage needs those before it.
enum class Tm2tStage { tokenizer, motion_to_text, text_to_motion };

struct Tm2tTokenizerConfig {
  std::vector<Index> channels{1024, 1024};  // each halves the number of frames
  Index codes = 1024, residual_blocks = 3;
  double beta = 1;
  Index window = 64;            // frames
  double feature_bias = 5;      // the deviations of root and contacts are divided by it, twice as published
  double adversarial = 0.5;     // weight of the discriminator; 0: none
  Index adversarial_from = 10;  // epoch
  Index discriminator = 512;    // its first number of channels

  void require_sound() const {
    require_value("channels", channels.size(), channels.size() == 2, "two numbers: four frames become a token");
    for (const Index c : channels) require_value("channels", c, c >= 1 && c <= 65'536, "1 to 65536");
    for (const auto& [name, size] : {std::pair("codes", codes), {"discriminator", discriminator}})
      require_value(name, size, size >= 2 && size <= 65'536, "2 to 65536");
    require_value("residual_blocks", residual_blocks, residual_blocks >= 1 && residual_blocks <= 256, "1 to 256");
    require_value("window", window, window >= 4 && window % 4 == 0, "a multiple of 4");
    require_value("feature_bias", feature_bias, feature_bias > 0, "a number above 0");
    for (const auto& [name, value] : {std::pair("beta", beta), {"adversarial", adversarial}})
      require_value(name, value, value >= 0, "0 or more");
    require_value("adversarial_from", adversarial_from, adversarial_from >= 0, "0 or more");
  }
  static constexpr auto fields() {
    using C = Tm2tTokenizerConfig;
    return motionlang::fields("channels", &C::channels, "codes", &C::codes, "residual_blocks", &C::residual_blocks,
                              "beta", &C::beta, "window", &C::window, "feature_bias", &C::feature_bias, "adversarial",
                              &C::adversarial, "adversarial_from", &C::adversarial_from, "discriminator",
                              &C::discriminator);
  }
};

/// The transformer.
struct Tm2tDescriberConfig {
  Index latent_dim = 512, ff_size = 2048, num_layers = 4,
        num_heads = 8;  // layers of the encoder, and of the decoder
  double dropout = 0.1;
  double smoothing = 0;  // of labels; the published program has 0.1, but switched off
  bool tokens = true;    // false: it reads features, four frames side by side ("w/o MT")

  void require_sound() const {
    require_sizes(*this);
    require_value("latent_dim", latent_dim, latent_dim % num_heads == 0, "a multiple of num_heads");
    require_value("smoothing", smoothing, smoothing >= 0 && smoothing < 1, "0 or more, and less than 1");
  }
  static constexpr auto fields() {
    using C = Tm2tDescriberConfig;
    return motionlang::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers,
                              "num_heads", &C::num_heads, "dropout", &C::dropout, "smoothing", &C::smoothing, "tokens",
                              &C::tokens);
  }
};

/// The recurrent network, or the transformer of the paper's baseline (T), which has no inverse alignment.
struct Tm2tWriterConfig {
  std::string network = "gru";  // or "transformer", which has the next five sizes
  Index latent_dim = 512, ff_size = 2048, num_layers = 3, num_heads = 8;
  double dropout = 0.1;
  Index text_hidden = 512, motion_hidden = 1024, layers = 1;
  Index word_width = 300;  // of random word vectors, where none are given
  bool late = false;       // attention after the recurrent network
  double forced_first = 0.9,
         forced_last = 0.1;  // the share of batches that see the true tokens: in epoch 0, and from forced_epochs on
  Index forced_epochs = 35;
  bool alignment = true;     // inverse alignment: a second update, by the describer
  Index alignment_from = 0;  // epoch

  bool aligned() const { return alignment && network == "gru"; }
  void require_sound() const {
    if (network != "gru" && network != "transformer")
      raise<config_error>(103, "network '", network, "' is not gru or transformer");
    require_sizes(*this);
    require_value("latent_dim", latent_dim, latent_dim % num_heads == 0, "a multiple of num_heads");
    for (const auto& [name, size] :
         {std::pair("text_hidden", text_hidden), {"motion_hidden", motion_hidden}, {"word_width", word_width}})
      require_value(name, size, size >= 1 && size <= 65'536, "1 to 65536");
    require_value("layers", layers, layers >= 1 && layers <= 64, "1 to 64");
    for (const auto& [name, share] : {std::pair("forced_first", forced_first), {"forced_last", forced_last}})
      require_value(name, share, share >= 0 && share <= 1, "0 to 1");
    require_value("alignment_from", alignment_from, alignment_from >= 0, "0 or more");
  }
  static constexpr auto fields() {
    using C = Tm2tWriterConfig;
    return motionlang::fields("network", &C::network, "latent_dim", &C::latent_dim, "ff_size", &C::ff_size,
                              "num_layers", &C::num_layers, "num_heads", &C::num_heads, "dropout", &C::dropout,
                              "text_hidden", &C::text_hidden, "motion_hidden", &C::motion_hidden, "layers", &C::layers,
                              "word_width", &C::word_width, "late", &C::late, "forced_first", &C::forced_first,
                              "forced_last", &C::forced_last, "forced_epochs", &C::forced_epochs, "alignment",
                              &C::alignment, "alignment_from", &C::alignment_from);
  }
};

struct Tm2tTrainingConfig {
  std::string features = "guoh3d";  // or kit
  Tm2tTokenizerConfig tokenizer;
  Tm2tDescriberConfig motion_to_text;
  Tm2tWriterConfig text_to_motion;
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  void require_sound() const {
    if (features != "guoh3d" && features != "kit")
      raise<config_error>(103, "features '", features, "' is not guoh3d or kit, which TM2T reads");
  }
  static constexpr auto fields() {
    using C = Tm2tTrainingConfig;
    return motionlang::fields("features", &C::features, "tokenizer", &C::tokenizer, "motion_to_text",
                              &C::motion_to_text, "text_to_motion", &C::text_to_motion, "optimiser", &C::optimiser,
                              "validation", &C::validation, "data", &C::data);
  }
};

MOTIONLANG_NAMESPACE_END
