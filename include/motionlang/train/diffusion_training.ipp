// SPDX-License-Identifier: MIT
// Bodies of diffusion_training.hpp.
#pragma once

#include <motionlang/train/diffusion_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY Index training_steps(Index updates, Index epochs, Index per_epoch) {
  return updates > 0 ? (updates / per_epoch + 1) * per_epoch : epochs * per_epoch;
}

MOTIONLANG_BODY Index step_with_last(Index step, Index per_epoch, Index with_last) {
  return step / per_epoch * with_last + step % per_epoch;
}

}  // namespace detail

MOTIONLANG_BODY GaussianDiffusion diffusion_of(const DiffusionProcessConfig& c) {
  DiffusionRun run;
  run.steps = c.steps, run.schedule = c.schedule;
  return run.diffusion();
}

MOTIONLANG_NAMESPACE_END
