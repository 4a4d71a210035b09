// SPDX-License-Identifier: MIT
/// The hyperparameters of TEMOS and TMR, as config.json of a model folder has them: one structure for both. The
/// defaults are those of the published TMR; others are in train/presets.hpp.
#pragma once

#include <string>  // names

#include <motionlang/core/require_value.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/optim/optimiser_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TextMotionNetworkConfig {
  Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  Index text_layers = 0, text_heads = 0;  // of the text encoder alone; 0: as many as the others
  double dropout = 0.1;
  std::string activation = "gelu";  // core/activation.hpp
  bool vae = true;
  std::string motion_encoder = "transformer", motion_decoder = "transformer";  // or "gru"; encoder "none": TEMOS alone

  void require_sound() const {
    require_sizes(*this);
    require_value("text_layers", text_layers, text_layers >= 0 && text_layers <= 256, "0 to 256");
    require_value("text_heads", text_heads, text_heads >= 0 && text_heads <= 65'536, "0 to 65536");
  }
  static constexpr auto fields() {
    using C = TextMotionNetworkConfig;
    return motionlang::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers,
                              "num_heads", &C::num_heads, "text_layers", &C::text_layers, "text_heads", &C::text_heads,
                              "dropout", &C::dropout, "activation", &C::activation, "vae", &C::vae, "motion_encoder",
                              &C::motion_encoder, "motion_decoder", &C::motion_decoder);
  }
};

/// The form in which the model's text encoder receives texts.
struct TextTokensConfig {
  std::string encoder =
      "distilbert";           // states of a language model (a folder or a cache), or "word_pieces": learned here
  Index width = 768;          // of a token
  Index vocabulary = 800;     // of word pieces; with vectors of words, all words that occur twice instead
  bool finetune = false;      // DistilBERT is also trained
  double hidden_words = 0.3;  // training: probability that only the vector of a word is used, if it has one
  double strange_words = 0;   // training of TMR with word pieces: probability that a text gets words of other subjects
  std::string known_captions{};  // an STMC file whose captions tell what a query means, from the folder that holds
                                 // config.json; only for TMR, "": none

  void require_sound() const {
    require_value("width", width, width >= 1 && width <= 65'536, "1 to 65536");
    require_value("hidden_words", hidden_words, hidden_words >= 0 && hidden_words <= 1, "0 to 1");
    require_value("strange_words", strange_words, strange_words >= 0 && strange_words <= 1, "0 to 1");
  }
  static constexpr auto fields() {
    using C = TextTokensConfig;
    return motionlang::fields("encoder", &C::encoder, "width", &C::width, "vocabulary", &C::vocabulary, "finetune",
                              &C::finetune, "hidden_words", &C::hidden_words, "strange_words", &C::strange_words,
                              "known_captions", &C::known_captions);
  }
};

/// Weights of the terms; the rows of thesis tables 4.3 and 5.3 switch terms off here.
struct TextMotionLossConfig {
  double recons = 1, kl = 1e-5, latent = 1e-5, contrastive = 0.1;
  std::string contrastive_loss = "info_nce";  // "margin", "none"; TEMOS has none
  double temperature = 0.1;
  bool learned_temperature = false;  // for info_nce; training starts from that value, as for CLIP
  double threshold = 0.8;            // texts more similar than that are not negatives; 0: all are
  double margin = 10;
  Index strangers = 0;  // for info_nce and word pieces: texts in a step that no motion shows (text/stranger_texts.hpp)
  bool cross_modal_kl = true, gaussian_kl = true, embedding = true;  // the terms that kl and latent weight

  void require_sound() const {
    for (const auto& [name, value] : {std::pair("recons", recons),
                                      {"kl", kl},
                                      {"latent", latent},
                                      {"contrastive", contrastive},
                                      {"margin", margin}})
      require_value(name, value, value >= 0, "0 or more");
    require_value("strangers", strangers, strangers >= 0 && strangers <= 65'536, "0 to 65536");
  }
  static constexpr auto fields() {
    using C = TextMotionLossConfig;
    return motionlang::fields("recons", &C::recons, "kl", &C::kl, "latent", &C::latent, "contrastive", &C::contrastive,
                              "contrastive_loss", &C::contrastive_loss, "temperature", &C::temperature,
                              "learned_temperature", &C::learned_temperature, "threshold", &C::threshold, "margin",
                              &C::margin, "strangers", &C::strangers, "cross_modal_kl", &C::cross_modal_kl,
                              "gaussian_kl", &C::gaussian_kl, "embedding", &C::embedding);
  }
};

struct TextMotionConfig {
  std::string features = "guoh3d";  // a name of motion_features.hpp
  TextMotionNetworkConfig network;
  TextTokensConfig text;
  TextMotionLossConfig losses;
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  static constexpr auto fields() {
    using C = TextMotionConfig;
    return motionlang::fields("features", &C::features, "network", &C::network, "text", &C::text, "losses", &C::losses,
                              "optimiser", &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

MOTIONLANG_NAMESPACE_END
