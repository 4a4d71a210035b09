// SPDX-License-Identifier: MIT
// Bodies of sampler.hpp.
#pragma once

#include <algorithm>  // find

#include <motionlang/diffusion/respacing.hpp>
#include <motionlang/diffusion/sampler.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GaussianDiffusion with_steps(const GaussianDiffusion& process, Index steps) {
  if (steps == 0 || steps == process.steps()) return process;
  return process.respaced(respace(process.steps(), std::vector<Index>{steps}));
}

MOTIONLANG_BODY std::string_view to_string(SamplingOptions::Sampler sampler) {
  return sampler_names.at(static_cast<std::size_t>(sampler));
}

MOTIONLANG_BODY SamplingOptions::Sampler parse_sampler(std::string_view name, std::string_view where) {
  const auto found = std::find(sampler_names.begin(), sampler_names.end(), name);
  if (found == sampler_names.end())
    raise<config_error>(103, where, " '", name, "' is not one of ", join_text(sampler_names));
  return static_cast<SamplingOptions::Sampler>(found - sampler_names.begin());
}

MOTIONLANG_BODY NoiseScale parse_noise_scale(std::string_view name, std::string_view where) {
  if (name == "paper") return NoiseScale::posterior_std;
  if (name == "published") return published_stmc_sampling.noise_scale;
  raise<config_error>(103, where, " '", name, "' is neither paper nor published");
}

MOTIONLANG_NAMESPACE_END
