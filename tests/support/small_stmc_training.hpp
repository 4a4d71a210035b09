// SPDX-License-Identifier: MIT
/// The training of a tiny STMC model, on the clips of training_set.hpp.
#pragma once

#include <motionlang/train/stmc_training.hpp>

namespace small {

inline motionlang::StmcTrainingConfig stmc_training() {
  return {.network = {.latent_dim = 16, .ff_size = 24, .num_layers = 1, .num_heads = 2},
          .text = {.width = 8, .heads = 2, .d_ff = 12, .layers = 1, .out = 8},
          .vocabulary = 40,
          .diffusion = {.steps = 20},
          .sampling = {.steps = 0, .guidance = 2.5},
          .samples = {.longest = 40},
          .updates = 8,
          .optimiser = {
              .lr = 4e-4, .clip_norm = 1, .ema = 0.999, .schedule = "cosine", .warmup = 2, .batch = 3, .seed = 1}};
}

}  // namespace small
