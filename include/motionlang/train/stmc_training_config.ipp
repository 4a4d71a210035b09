// SPDX-License-Identifier: MIT
// Bodies of stmc_training_config.hpp.
#pragma once

#include <tuple>  // sizes

#include <motionlang/train/stmc_training_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void StmcLossConfig::require_sound() const {
  for (const auto& [name, value] :
       {std::pair("velocity", velocity), {"root", root}, {"foot", foot}, {"text", text}, {"verb", verb}})
    require_value(name, value, value >= 0, "0 or more");
  require_value("snr_cap", snr_cap, snr_cap >= 1, "1 or more");
}

MOTIONLANG_BODY void StmcSamplingConfig::require_sound() const {
  require_value("steps", steps, steps >= 0, "0 or more");
  require_value("guidance", guidance, guidance >= 0, "0 or more");
}

MOTIONLANG_BODY void StmcTrainingConfig::require_sound() const {
  require_value("vocabulary", vocabulary, vocabulary >= 1, "1 or more");
  require_value("text_steps", text_steps, text_steps >= 0, "0 or more");
  require_value("noise_focus", noise_focus, noise_focus >= 0 && noise_focus <= 1, "0 to 1");
  require_value("pose_scale", pose_scale, pose_scale > 0, "a number above 0");
  require_value("practice", practice, practice > 0, "a number above 0");
  require_value("updates", updates, updates >= 0, "0 or more");
}

MOTIONLANG_BODY void StmcTrainingConfig::require_consistent() const {
  require_sound();
  network.require_sound(), text.require_sound(), diffusion.require_sound(), sampling.require_sound();
  samples.require_sound(), losses.require_sound(), optimiser.require_sound();
  optimiser.rate(0, 1);  // an unknown schedule
  if (diffusion.schedule != "cosine")
    raise<config_error>(102, "diffusion.schedule = ", diffusion.schedule, "; that of the bundled model is cosine");
  for (const auto& [name, width, heads] : {std::tuple("network.latent_dim", network.latent_dim, network.num_heads),
                                           {"text.width", text.width, text.heads}}) {
    if (width % heads != 0 || width % 2 != 0)
      raise<config_error>(102, name, " = ", width, " is odd or no multiple of ", counted(heads, "head"));
  }
  if (sampling.steps > diffusion.steps)
    raise<config_error>(102, "sampling.steps = ", sampling.steps, ", diffusion.steps = ", diffusion.steps);
  if (samples.longest < samples.shortest)
    raise<config_error>(102, "samples.longest = ", samples.longest, ", samples.shortest = ", samples.shortest);
  if (practised.empty() && practice != StmcTrainingConfig{}.practice)
    raise<config_error>(102, "practice = ", practice, ", and practised names no words");
}

MOTIONLANG_BODY StmcModelConfig StmcTrainingConfig::model() const {
  StmcModelConfig out;
  out.denoiser.tx_dim = text.out;
  out.denoiser.latent_dim = network.latent_dim, out.denoiser.ff_size = network.ff_size;
  out.denoiser.num_layers = network.num_layers, out.denoiser.num_heads = network.num_heads;
  out.denoiser.nb_registers = network.nb_registers, out.denoiser.dropout = network.dropout;
  out.text = text;
  out.diffusion_steps = diffusion.steps;
  out.sampling_steps = sampling.steps, out.guidance = sampling.guidance;
  return out;
}

namespace detail {

MOTIONLANG_BODY std::map<std::string, std::string> stmc_settings(const StmcTrainingConfig& config,
                                                                 const std::string& fingerprint) {
  std::map<std::string, std::string> out{{"training.data", fingerprint},
                                         {"training.practised", join_text(config.practised)}};
  for (const auto& [name, value] : config_texts(config)) {
    const bool of_steps = name != "updates" && name != "optimiser.epochs" && !name.starts_with("sampling.") &&
                          !name.starts_with("practised");
    if (of_steps) out["training." + name] = value;
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
