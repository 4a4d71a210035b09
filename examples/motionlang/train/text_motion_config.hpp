// The hyperparameters of TEMOS and TMR: one structure for both, JSON by its fields, the published values as presets.
#pragma once

#include <string>
#include <vector>

#include "../usage_error.hpp"
#include "config_json.hpp"
#include "described_motions.hpp"
#include "optimiser_config.hpp"

namespace program {

struct TextMotionNetworkConfig {
  ml::Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  double dropout = 0.1;
  std::string activation = "gelu";  // core/activation.hpp
  bool vae = true;
  std::string motion_encoder = "transformer", motion_decoder = "transformer";  // or "gru"; encoder "none": TEMOS alone

  void require_sound() const { require_sizes(*this); }
  static constexpr auto fields() {
    using C = TextMotionNetworkConfig;
    return ml::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers, "num_heads",
                      &C::num_heads, "dropout", &C::dropout, "activation", &C::activation, "vae", &C::vae,
                      "motion_encoder", &C::motion_encoder, "motion_decoder", &C::motion_decoder);
  }
};

/// What texts are before the text encoder of the model sees them.
struct TextTokensConfig {
  std::string encoder =
      "distilbert";            // states of a language model (a folder or a cache), or "word_pieces": learnt here
  ml::Index width = 768;       // of a token
  ml::Index vocabulary = 800;  // of word pieces
  bool finetune = false;       // DistilBERT is trained, too

  void require_sound() const { require_value("width", width, width >= 1 && width <= 65'536, "1 to 65536"); }
  static constexpr auto fields() {
    using C = TextTokensConfig;
    return ml::fields("encoder", &C::encoder, "width", &C::width, "vocabulary", &C::vocabulary, "finetune",
                      &C::finetune);
  }
};

/// Weights of the terms; those of rows of thesis tables 4.3 and 5.3 are switched off here.
struct TextMotionLossConfig {
  double recons = 1, kl = 1e-5, latent = 1e-5, contrastive = 0.1;
  std::string contrastive_loss = "info_nce";  // "margin", "none"; TEMOS has none
  double temperature = 0.1;
  bool learned_temperature = false;  // from that value on, as CLIP does; of info_nce
  double threshold = 0.8;            // texts more similar than that are no negatives; 0: all are
  double margin = 10;
  bool cross_modal_kl = true, gaussian_kl = true, embedding = true;  // the terms that kl and latent weigh

  void require_sound() const {
    for (const auto& [name, value] : {std::pair("recons", recons),
                                      {"kl", kl},
                                      {"latent", latent},
                                      {"contrastive", contrastive},
                                      {"margin", margin}})
      require_value(name, value, value >= 0, "0 or more");
  }
  static constexpr auto fields() {
    using C = TextMotionLossConfig;
    return ml::fields("recons", &C::recons, "kl", &C::kl, "latent", &C::latent, "contrastive", &C::contrastive,
                      "contrastive_loss", &C::contrastive_loss, "temperature", &C::temperature, "learned_temperature",
                      &C::learned_temperature, "threshold", &C::threshold, "margin", &C::margin, "cross_modal_kl",
                      &C::cross_modal_kl, "gaussian_kl", &C::gaussian_kl, "embedding", &C::embedding);
  }
};

struct TextMotionConfig {
  std::string features = "guoh3d";  // motion_features.hpp
  TextMotionNetworkConfig network;
  TextTokensConfig text;
  TextMotionLossConfig losses;
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  static constexpr auto fields() {
    using C = TextMotionConfig;
    return ml::fields("features", &C::features, "network", &C::network, "text", &C::text, "losses", &C::losses,
                      "optimiser", &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

inline TextMotionConfig small_text_motion() {
  TextMotionConfig c;
  c.network = {.latent_dim = 128, .ff_size = 256, .num_layers = 2};
  c.text = {.encoder = "word_pieces", .width = 128, .vocabulary = 400};
  c.optimiser = {.lr = 5e-4, .clip_norm = 1, .schedule = "cosine", .warmup = 100, .epochs = 60};
  c.validation = {.every = 2, .keep_best = true};
  c.data.mirror = true;
  return c;
}

/// "tmr-published": spec tmr.md 2, 6; "small": minutes on a laptop, without a language model. Throws usage_error 103.
inline TextMotionConfig tmr_preset(const std::string& name) {
  TextMotionConfig c;
  if (name == "small") {
    c = small_text_motion();
    c.validation.watch = "retrieval";
    return c;
  }
  if (name == "tmr-published") return c;
  ml::raise<usage_error>(103, "--preset '", name, "' is not tmr-published or small");
}

/// "temos-published": spec temos.md 2, 4.1, 6. Throws usage_error 103.
inline TextMotionConfig temos_preset(const std::string& name) {
  TextMotionConfig c;
  if (name == "small")
    c = small_text_motion();
  else if (name != "temos-published")
    ml::raise<usage_error>(103, "--preset '", name, "' is not temos-published or small");
  c.features = name == "small" ? "smplvelp" : "rifke64";
  c.losses.contrastive_loss = "none";
  if (name != "small") {
    c.optimiser.epochs = 1001;
    c.data.min_seconds = 0.8, c.data.max_seconds = 40;  // 10 to 500 frames
  }
  return c;
}

}  // namespace program
