// The hyperparameters of SINC and TEACH: JSON by their fields, the published values as presets.
#pragma once

#include <string>

#include "../usage_error.hpp"
#include "text_motion_config.hpp"

namespace program {

/// Frames per second of both.
inline constexpr double babel_fps = 30;

/// The rotations of both, published or with the exact heading. Throws config_error 103 for others.
inline void require_babel_features(const std::string& name) {
  if (name != "smplvelp-published" && name != "smplvelp")
    ml::raise<ml::config_error>(103, "features '", name, "' is not smplvelp-published or smplvelp");
}

/// latent_dim, ff_size, num_layers, num_heads, dropout and activation of a configuration as those of the system.
template <class System, class Network>
System babel_network(const Network& n, ml::Index width, ml::Index text_width) {
  System c;
  c.nfeats = width, c.text_dim = text_width;
  c.latent_dim = n.latent_dim, c.ff_size = n.ff_size, c.num_layers = n.num_layers, c.num_heads = n.num_heads;
  c.dropout = n.dropout, c.activation = ml::parse_activation(n.activation);
  return c;
}

/// How clips are split at random.
template <class Data>
DataConfig lots_of(const Data& c) {
  return {.test_share = c.test_share, .validation_share = c.validation_share, .split_seed = c.split_seed};
}

struct SincNetworkConfig {
  ml::Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  double dropout = 0.1;
  std::string activation = "gelu";

  void require_sound() const { require_sizes(*this); }
  static constexpr auto fields() {
    using C = SincNetworkConfig;
    return ml::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers, "num_heads",
                      &C::num_heads, "dropout", &C::dropout, "activation", &C::activation);
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
    return ml::fields("recons", &C::recons, "kl", &C::kl, "latent", &C::latent);
  }
};

struct SincDataConfig {
  std::string types = "seg+seq+spatial_pairs";       // what is learnt, in any order; or with separate_pairs
  ml::Index shortest = 15, window = 300;             // frames; of longer ones, `window` from a random place
  ml::Index longest = 800;                           // of what is validated with
  ml::Index simultaneous_max = 4;                    // labels at the same time
  double proportion = 0.5;                           // of single actions that are combined with one of other body parts
  bool random = false;                               // with any action, and random parts
  double test_share = 0.2, validation_share = 0.05;  // as in DataConfig
  std::uint64_t split_seed = 1;

  void require_sound() const {
    lots_of(*this).require_sound();
    require_value("shortest", shortest, shortest >= 1, "1 or more");
    require_value("window", window, window >= shortest, "shortest or more");
    require_value("longest", longest, longest >= shortest, "shortest or more");
    require_value("simultaneous_max", simultaneous_max, simultaneous_max >= 2, "2 or more");
    require_value("proportion", proportion, proportion >= 0 && proportion <= 1, "0 to 1");
  }
  static constexpr auto fields() {
    using C = SincDataConfig;
    return ml::fields("types", &C::types, "shortest", &C::shortest, "window", &C::window, "longest", &C::longest,
                      "simultaneous_max", &C::simultaneous_max, "proportion", &C::proportion, "random", &C::random,
                      "test_share", &C::test_share, "validation_share", &C::validation_share, "split_seed",
                      &C::split_seed);
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
    return ml::fields("features", &C::features, "network", &C::network, "text", &C::text, "losses", &C::losses,
                      "optimiser", &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

struct TeachNetworkConfig {
  ml::Index latent_dim = 256, ff_size = 1024, num_layers = 6, num_heads = 4;
  double dropout = 0.1;
  std::string activation = "gelu";
  ml::Index hist_frames = 5;     // of the past that a text is encoded with
  bool z_prev_text = false;      // the latent of the past, too
  bool mask_padding = false;     // true: as the paper has it, not the published code
  bool teacher_forcing = false;  // the past as it is in the data, not as it was decoded

  void require_sound() const {
    require_sizes(*this);
    require_value("hist_frames", hist_frames, hist_frames >= 1, "1 or more");
  }
  static constexpr auto fields() {
    using C = TeachNetworkConfig;
    return ml::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers, "num_heads",
                      &C::num_heads, "dropout", &C::dropout, "activation", &C::activation, "hist_frames",
                      &C::hist_frames, "z_prev_text", &C::z_prev_text, "mask_padding", &C::mask_padding,
                      "teacher_forcing", &C::teacher_forcing);
  }
};

struct TeachLossesConfig {
  double recons = 1, kl = 1e-5, latent = 1e-5;
  double velocity = 0;             // published code has the term, with 0.5, but cannot run it
  bool loss_on_transition = true;  // false: reconstructions leave the transition out

  void require_sound() const {
    for (const auto& [name, value] :
         {std::pair("recons", recons), {"kl", kl}, {"latent", latent}, {"velocity", velocity}})
      require_value(name, value, value >= 0, "0 or more");
  }
  static constexpr auto fields() {
    using C = TeachLossesConfig;
    return ml::fields("recons", &C::recons, "kl", &C::kl, "latent", &C::latent, "velocity", &C::velocity,
                      "loss_on_transition", &C::loss_on_transition);
  }
};

struct TeachDataConfig {
  ml::Index shortest = 15, longest = 750;            // frames of either action, the second with its transition
  double test_share = 0.2, validation_share = 0.05;  // as in DataConfig
  std::uint64_t split_seed = 1;

  void require_sound() const {
    lots_of(*this).require_sound();
    require_value("shortest", shortest, shortest >= 1, "1 or more");
    require_value("longest", longest, longest >= shortest, "shortest or more");
  }
  static constexpr auto fields() {
    using C = TeachDataConfig;
    return ml::fields("shortest", &C::shortest, "longest", &C::longest, "test_share", &C::test_share,
                      "validation_share", &C::validation_share, "split_seed", &C::split_seed);
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
      ml::raise<ml::config_error>(102, "data.shortest is ", data.shortest, ", network.hist_frames ",
                                  network.hist_frames, ": the past has more frames than an action may have");
  }
  static constexpr auto fields() {
    using C = TeachTrainingConfig;
    return ml::fields("features", &C::features, "network", &C::network, "text", &C::text, "losses", &C::losses,
                      "optimiser", &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

/// The sizes and the rates of the small TMR and TEMOS.
template <class Config>
Config small_babel() {
  const TextMotionConfig small = small_text_motion();
  Config c;
  c.features = "smplvelp";
  c.network.latent_dim = small.network.latent_dim, c.network.ff_size = small.network.ff_size;
  c.network.num_layers = small.network.num_layers;
  c.text = small.text, c.optimiser = small.optimiser, c.validation = small.validation;
  return c;
}

/// "sinc-published": spec sinc.md 2, 3, 5. "small" combines no actions, for which a table of body parts is needed.
/// Throws usage_error 103.
inline SincTrainingConfig sinc_preset(const std::string& name) {
  auto c = small_babel<SincTrainingConfig>();
  c.data.proportion = 0;
  if (name == "small") return c;
  if (name != "sinc-published") ml::raise<usage_error>(103, "--preset '", name, "' is not sinc-published or small");
  c = {};
  c.optimiser.lr = 3e-4, c.optimiser.schedule = "step", c.optimiser.epochs = 1001, c.optimiser.seed = 42;
  c.validation.every = 25;
  return c;
}
/// "teach-published": spec teach.md 2, 3, 4. Throws usage_error 103.
inline TeachTrainingConfig teach_preset(const std::string& name) {
  if (name == "small") return small_babel<TeachTrainingConfig>();
  if (name != "teach-published") ml::raise<usage_error>(103, "--preset '", name, "' is not teach-published or small");
  TeachTrainingConfig c;
  c.optimiser.lr = 7e-5, c.optimiser.batch = 8, c.optimiser.epochs = 1001, c.optimiser.seed = 42;
  return c;
}

}  // namespace program
