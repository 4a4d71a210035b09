// SPDX-License-Identifier: MIT
/// The hyperparameters of the trainings of MDM-SMPL, MDM and MotionDiffuse. config.json of a model folder has them as
/// "training". Presets are in train/diffusion_presets.hpp.
#pragma once

#include <string>  // names

#include <motionlang/core/require_value.hpp>
#include <motionlang/datasets/actor_clips.hpp>
#include <motionlang/datasets/data_config.hpp>
#include <motionlang/optim/optimiser_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The source of the texts' vectors.
///     clip         CLIP ViT-B/32, which is not trained
///     distilbert   its token states, not trained; for the decoder of MDM
///     word_pieces  a small DistilBERT that is trained with the denoiser, on word pieces of the training texts
struct DiffusionTextConfig {
  std::string encoder = "clip";
  double drop = 0.1;  // the share of samples that learn without a text, for guidance
  // of word_pieces
  Index width = 128, ff_size = 256, num_layers = 2, num_heads = 4, vocabulary = 800;
  double dropout = 0.1;

  void require_sound() const {
    if (encoder != "clip" && encoder != "distilbert" && encoder != "word_pieces")
      raise<config_error>(103, "encoder '", encoder, "' is not clip, distilbert or word_pieces");
    require_value("drop", drop, drop >= 0 && drop < 1, "0 or more, and less than 1");
    for (const auto& [name, size] : {std::pair("width", width), {"ff_size", ff_size}, {"num_heads", num_heads}})
      require_value(name, size, size >= 1 && size <= 65'536, "1 to 65536");
    require_value("num_layers", num_layers, num_layers >= 1 && num_layers <= 256, "1 to 256");
    require_value("dropout", dropout, dropout >= 0 && dropout < 1, "0 or more, and less than 1");
  }
  static constexpr auto fields() {
    using C = DiffusionTextConfig;
    return motionlang::fields("encoder", &C::encoder, "drop", &C::drop, "width", &C::width, "ff_size", &C::ff_size,
                              "num_layers", &C::num_layers, "num_heads", &C::num_heads, "vocabulary", &C::vocabulary,
                              "dropout", &C::dropout);
  }
};

/// The noising process.
struct DiffusionProcessConfig {
  Index steps = 100;
  std::string schedule = "cosine";  // of Nichol and Dhariwal; MotionDiffuse: "linear"; MDM-SMPL: or "chen"

  void require_sound() const {
    require_value("steps", steps, steps >= 1 && steps <= 10'000, "1 to 10000");
    if (schedule != "cosine" && schedule != "linear" && schedule != "chen")
      raise<config_error>(103, "schedule '", schedule, "' is not cosine, linear or chen");
  }
  static constexpr auto fields() {
    using C = DiffusionProcessConfig;
    return motionlang::fields("steps", &C::steps, "schedule", &C::schedule);
  }
};

struct MdmSmplNetworkConfig {
  Index latent_dim = 512, ff_size = 2048, num_layers = 8, num_heads = 8, nb_registers = 2;
  double dropout = 0.1;

  void require_sound() const {
    require_sizes(*this);
    require_value("nb_registers", nb_registers, nb_registers >= 0 && nb_registers <= 64, "0 to 64");
  }
  static constexpr auto fields() {
    using C = MdmSmplNetworkConfig;
    return motionlang::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers,
                              "num_heads", &C::num_heads, "nb_registers", &C::nb_registers, "dropout", &C::dropout);
  }
};

struct MdmNetworkConfig {
  std::string arch = "trans_enc";  // "trans_dec", "gru"
  Index latent_dim = 512, ff_size = 1024, num_layers = 8, num_heads = 4;
  double dropout = 0.1;
  bool mask_frames = false;    // padded frames are not attended to, as in newer models
  bool emb_trans_dec = false;  // trans_dec: a token before the frames

  void require_sound() const {
    require_sizes(*this);
    if (arch != "trans_enc" && arch != "trans_dec" && arch != "gru")
      raise<config_error>(103, "arch '", arch, "' is not trans_enc, trans_dec or gru");
  }
  static constexpr auto fields() {
    using C = MdmNetworkConfig;
    return motionlang::fields("arch", &C::arch, "latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers",
                              &C::num_layers, "num_heads", &C::num_heads, "dropout", &C::dropout, "mask_frames",
                              &C::mask_frames, "emb_trans_dec", &C::emb_trans_dec);
  }
};

struct MotionDiffuseNetworkConfig {
  Index latent_dim = 512, ff_size = 1024, num_layers = 8, num_heads = 8;
  Index text_latent_dim = 256, text_ff_size = 2048, num_text_layers = 4, text_num_heads = 4;
  double dropout = 0;   // as published, there is none
  bool no_eff = false;  // standard attention, which masks nothing in the released code

  void require_sound() const {
    require_sizes(*this);
    require_value("dropout", dropout, dropout == 0, "0: MotionDiffuse has no dropout");
    for (const auto& [name, size] : {std::pair("text_latent_dim", text_latent_dim),
                                     {"text_ff_size", text_ff_size},
                                     {"text_num_heads", text_num_heads}})
      require_value(name, size, size >= 1 && size <= 65'536, "1 to 65536");
    require_value("num_text_layers", num_text_layers, num_text_layers >= 1 && num_text_layers <= 256, "1 to 256");
  }
  static constexpr auto fields() {
    using C = MotionDiffuseNetworkConfig;
    return motionlang::fields("latent_dim", &C::latent_dim, "ff_size", &C::ff_size, "num_layers", &C::num_layers,
                              "num_heads", &C::num_heads, "text_latent_dim", &C::text_latent_dim, "text_ff_size",
                              &C::text_ff_size, "num_text_layers", &C::num_text_layers, "text_num_heads",
                              &C::text_num_heads, "dropout", &C::dropout, "no_eff", &C::no_eff);
  }
};

/// The frames of MDM-SMPL that a text is learned with.
struct MdmSmplItemConfig {
  double transitions = 0.5;           // the share of samples without text that are any short part of the whole motion
  Index shortest = 10, longest = 60;  // frames of such a part
  double cut = 0.1;                   // the largest share of frames that is cut off at the ends of other motions

  void require_sound() const {
    require_value("transitions", transitions, transitions >= 0 && transitions <= 1, "0 to 1");
    require_value("shortest", shortest, shortest >= 1, "1 or more");
    require_value("cut", cut, cut >= 0 && cut < 1, "0 or more, and less than 1");
  }
  static constexpr auto fields() {
    using C = MdmSmplItemConfig;
    return motionlang::fields("transitions", &C::transitions, "shortest", &C::shortest, "longest", &C::longest, "cut",
                              &C::cut);
  }
};

struct MdmSmplTrainingConfig {
  std::string features = "smplrifke";
  MdmSmplNetworkConfig network;
  DiffusionTextConfig text;
  DiffusionProcessConfig diffusion;
  MdmSmplItemConfig items;
  Index updates = 0;  // at least so many, in whole epochs; 0: optimiser.epochs decides
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  /// Throws config_error 101, 102, 103 if settings contradict each other.
  void require_consistent() const;
  static constexpr auto fields() {
    using C = MdmSmplTrainingConfig;
    return motionlang::fields("features", &C::features, "network", &C::network, "text", &C::text, "diffusion",
                              &C::diffusion, "items", &C::items, "updates", &C::updates, "optimiser", &C::optimiser,
                              "validation", &C::validation, "data", &C::data);
  }
};

struct MdmTrainingConfig {
  std::string features = "guoh3d";  // or "kit"
  MdmNetworkConfig network;
  DiffusionTextConfig text;
  DiffusionProcessConfig diffusion;
  Index updates = 0;        // as above
  bool ema_warmup = false;  // the running average soon forgets the initial weights; as published it does not
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  /// Throws config_error 101, 102, 103 if settings contradict each other.
  void require_consistent() const;
  static constexpr auto fields() {
    using C = MdmTrainingConfig;
    return motionlang::fields("features", &C::features, "network", &C::network, "text", &C::text, "diffusion",
                              &C::diffusion, "updates", &C::updates, "ema_warmup", &C::ema_warmup, "optimiser",
                              &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

struct MotionDiffuseTrainingConfig {
  std::string features = "guoh3d";  // or "kit"
  MotionDiffuseNetworkConfig network;
  DiffusionTextConfig text;
  DiffusionProcessConfig diffusion;
  double feat_bias = 25;  // divides the deviations of the root and of the contacts, so that these count more
  Index updates = 0;      // as above
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  /// Throws config_error 101, 102, 103 if settings contradict each other.
  void require_consistent() const;
  static constexpr auto fields() {
    using C = MotionDiffuseTrainingConfig;
    return motionlang::fields("features", &C::features, "network", &C::network, "text", &C::text, "diffusion",
                              &C::diffusion, "feat_bias", &C::feat_bias, "updates", &C::updates, "optimiser",
                              &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

/// Weights of the terms of MDM's loss on motions of actions.
struct MdmActionLossConfig {
  double rcxyz = 1, vel = 1, fc = 1;

  void require_sound() const {
    for (const auto& [name, value] : {std::pair("rcxyz", rcxyz), {"vel", vel}, {"fc", fc}})
      require_value(name, value, value >= 0, "0 or more");
  }
  static constexpr auto fields() {
    using C = MdmActionLossConfig;
    return motionlang::fields("rcxyz", &C::rcxyz, "vel", &C::vel, "fc", &C::fc);
  }
};

struct MdmActionTrainingConfig {
  ActorClipsConfig clips;  // 6D rotations and path, in the world of the camera
  MdmNetworkConfig network;
  DiffusionProcessConfig diffusion;
  MdmActionLossConfig losses;
  double drop = 0;             // the share of samples that learn without an action, for guidance
  bool unconstrained = false;  // without actions
  Index updates = 0;           // as above
  OptimiserConfig optimiser;
  ValidationConfig validation;
  DataConfig data;

  /// Throws config_error 101, 102, 103 if settings contradict each other.
  void require_consistent() const;
  static constexpr auto fields() {
    using C = MdmActionTrainingConfig;
    return motionlang::fields("clips", &C::clips, "network", &C::network, "diffusion", &C::diffusion, "losses",
                              &C::losses, "drop", &C::drop, "unconstrained", &C::unconstrained, "updates", &C::updates,
                              "optimiser", &C::optimiser, "validation", &C::validation, "data", &C::data);
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/diffusion_training_config.ipp>
#endif
