// SPDX-License-Identifier: MIT
/// The training of a tiny STMC model, on the clips of training_set.hpp.
#pragma once

#include <motionlang/train/stmc_training.hpp>

namespace small {

inline motionlang::StmcTrainingConfig stmc_training() {
  return {.model = {.denoiser = {.latent_dim = 16, .ff_size = 24, .num_layers = 1, .num_heads = 2},
                    .text = {.width = 8, .heads = 2, .d_ff = 12, .layers = 1, .out = 8},
                    .diffusion_steps = 20},
          .vocabulary = 40,
          .steps = 8,
          .batch = 3,
          .warmup = 2,
          .samples = {.longest = 40}};
}

}  // namespace small
