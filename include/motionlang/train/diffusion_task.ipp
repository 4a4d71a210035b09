// SPDX-License-Identifier: MIT
// Bodies of diffusion_task.hpp.
#pragma once

#include <motionlang/train/diffusion_task.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY Index training_steps(Index updates, Index epochs, Index per_epoch) {
  return updates > 0 ? (updates / per_epoch + 1) * per_epoch : epochs * per_epoch;
}

MOTIONLANG_BODY Index step_with_last(Index step, Index per_epoch, Index with_last) {
  return step / per_epoch * with_last + step % per_epoch;
}

MOTIONLANG_BODY ModelFolder described_diffusion(const std::string& system, const DiffusionRun& run,
                                                const std::map<std::string, std::string>& about) {
  ModelFolder out = described_model(system, about);
  out.features = run.features;
  out.fps = run.fps;
  out.text_encoder = run.text_encoder;
  out.config = diffusion_options(run);
  return out;
}

MOTIONLANG_BODY DiffusionDraws diffusion_draws(const Philox& rng, Index first, Index count, Index steps, double drop) {
  auto of_step = rng.split("t"), of_drop = rng.split("drop");
  DiffusionDraws out;
  for (Index i = 0; i < first + count; ++i) {
    const auto t = static_cast<Index>(of_step.below(static_cast<std::uint32_t>(steps)));
    const bool dropped = of_drop.uniform() < drop;
    if (i < first) continue;
    out.t.push_back(t);
    out.kept.push_back(!dropped);
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY GaussianDiffusion diffusion_of(const DiffusionProcessConfig& c) {
  DiffusionRun run;
  run.steps = c.steps, run.schedule = c.schedule;
  return run.diffusion();
}

MOTIONLANG_NAMESPACE_END
