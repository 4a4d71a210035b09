// SPDX-License-Identifier: MIT
// Bodies of stmc_file.hpp.
#pragma once

#include <motionlang/weights/stmc_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline double metadata_real(const Metadata& metadata, const std::string& key, double least, double largest,
                            const std::string& file) {
  const auto x = metadata_number<double>(metadata, key, file);
  if (!(x >= least && x <= largest))
    raise<config_error>(101, file, ": metadata '", key, "' = ", x, " is not in ", least, " ... ", largest);
  return x;
}

/// "ddpm 20"; the number is left out for all steps.
inline std::string sampling_text(const StmcModelConfig& c) {
  const std::string_view sampler = to_string(c.sampler);
  return c.sampling_steps == 0 ? std::string(sampler) : concat_text(sampler, ' ', c.sampling_steps);
}

inline void check_sampling_steps(const StmcModelConfig& c, const std::string& where) {
  if (c.sampling_steps < 0 || c.sampling_steps > c.diffusion_steps)
    raise<config_error>(101, where, ": ", counted(c.sampling_steps, "step"), " of sampling, the process has ",
                        c.diffusion_steps);
}

inline void read_sampling(const Metadata& metadata, StmcModelConfig& c, const std::string& file) {
  const std::string wanted = metadata_text(metadata, "sampling", sampling_text({}));
  const std::size_t space = std::min(wanted.find(' '), wanted.size());
  c.sampler = parse_sampler(std::string_view(wanted).substr(0, space), file + ": metadata 'sampling':");
  if (space == wanted.size()) return;
  c.sampling_steps = number_in_metadata<Index>(std::string_view(wanted).substr(space + 1), "sampling", file);
  check_sampling_steps(c, file);
}

MOTIONLANG_BODY void add_metadata(Metadata& metadata, const Metadata& about, std::string_view whose,
                                  const std::string& file) {
  for (const auto& [key, value] : about) {
    if (!metadata.emplace(key, value).second)
      raise<config_error>(102, file, ": metadata '", key, "' belongs to the ", whose, " and cannot be given");
  }
}

}  // namespace detail

MOTIONLANG_BODY std::map<std::string, std::string> stmc_metadata(const StmcModelConfig& c, const WordPiece& tokenizer) {
  detail::check_sampling_steps(c, "stmc_metadata");
  std::string vocabulary;
  for (const std::string& piece : tokenizer.vocabulary()) vocabulary += (vocabulary.empty() ? "" : "\n") + piece;
  auto text = [](auto n) { return concat_text(n); };
  return {
      {"model", "stmc"},
      {"format", "1"},
      {"features", "smplrifke"},
      {"fps", text(c.fps)},
      {"denoiser.nfeats", text(c.denoiser.nfeats)},
      {"denoiser.latent_dim", text(c.denoiser.latent_dim)},
      {"denoiser.ff_size", text(c.denoiser.ff_size)},
      {"denoiser.num_layers", text(c.denoiser.num_layers)},
      {"denoiser.num_heads", text(c.denoiser.num_heads)},
      {"denoiser.nb_registers", text(c.denoiser.nb_registers)},
      {"denoiser.activation", std::string(to_string(c.denoiser.activation))},
      {"denoiser.max_len", text(c.denoiser.max_len)},
      {"text.width", text(c.text.width)},
      {"text.heads", text(c.text.heads)},
      {"text.d_ff", text(c.text.d_ff)},
      {"text.layers", text(c.text.layers)},
      {"text.out", text(c.text.out)},
      {"text.longest", text(c.text.longest)},
      {"text.vocabulary", vocabulary},
      {"diffusion.schedule", "cosine"},
      {"diffusion.steps", text(c.diffusion_steps)},
      {"diffusion.noise_scale", c.noise_scale == NoiseScale::posterior_std ? "posterior_std" : "posterior_variance"},
      {"sampling", detail::sampling_text(c)},
      {"guidance", text(c.guidance)}};
}

MOTIONLANG_BODY StmcModelConfig stmc_config(const SafetensorsFile& file) {
  const auto& m = file.metadata();
  const std::string& name = file.name();
  require_stmc_file(file);
  if (detail::metadata_text(m, "features", "") != "smplrifke" ||
      detail::metadata_text(m, "diffusion.schedule", "") != "cosine") {
    raise<config_error>(103, name, ": features '", detail::metadata_text(m, "features", ""), "' or schedule '",
                        detail::metadata_text(m, "diffusion.schedule", ""), "' is unknown");
  }
  const std::string scale = detail::metadata_text(m, "diffusion.noise_scale", "posterior_std");
  if (scale != "posterior_std" && scale != "posterior_variance")
    raise<config_error>(103, name, ": diffusion.noise_scale '", scale,
                        "' is neither posterior_std nor posterior_variance");
  auto size = [&](const std::string& key, Index largest) { return detail::metadata_size(m, key, largest, name); };
  StmcModelConfig c;
  c.denoiser.nfeats = size("denoiser.nfeats", 4096);
  if (const Index features = smplrifke_layout().size; c.denoiser.nfeats != features)
    raise<config_error>(101, name, ": denoiser.nfeats is ", c.denoiser.nfeats, ", smplrifke has ",
                        counted(features, "feature"));
  c.denoiser.latent_dim = size("denoiser.latent_dim", 8192);
  c.denoiser.ff_size = size("denoiser.ff_size", 32768);
  c.denoiser.num_layers = size("denoiser.num_layers", 256);
  c.denoiser.num_heads = detail::metadata_heads(m, "denoiser.num_heads", c.denoiser.latent_dim, name);
  c.denoiser.nb_registers = detail::metadata_size(m, "denoiser.nb_registers", 256, name, 0);
  c.text = caption_encoder_config(file);
  c.denoiser.tx_dim = c.text.out;
  const std::string activation = detail::metadata_text(m, "denoiser.activation", "gelu");
  if (activation != "gelu" && activation != "relu")
    raise<config_error>(103, name, ": denoiser.activation '", activation, "' is neither gelu nor relu");
  c.denoiser.activation = parse_activation(activation);
  if (m.contains("denoiser.max_len")) c.denoiser.max_len = size("denoiser.max_len", 8192);
  c.diffusion_steps = size("diffusion.steps", c.denoiser.max_len);  // a row of the table of positions tells the step
  c.fps = detail::metadata_real(m, "fps", 1, 1000, name);
  c.guidance = detail::metadata_real(m, "guidance", 0, 1000, name);
  c.noise_scale = scale == "posterior_std" ? NoiseScale::posterior_std : NoiseScale::posterior_variance;
  detail::read_sampling(m, c, name);
  return c;
}

MOTIONLANG_BODY void check_sizes(const SafetensorsFile& file, const StmcModelConfig& c, Index vocabulary,
                                 Index vector_width) {
  const MdmSmplConfig& d = c.denoiser;
  if (d.nb_registers > 0) detail::check_shape(file, "denoiser.registers", {d.nb_registers, d.latent_dim});
  detail::check_shape(file, "denoiser.skel_embedding.weight", {d.latent_dim, d.nfeats});
  detail::check_shape(file, "denoiser.tx_embedding.0.weight", {2 * d.latent_dim, d.tx_dim});
  detail::check_layers(file, "denoiser.seqTransEncoder", d.num_layers, d.latent_dim, d.ff_size);
  check_sizes(file, c.text, vocabulary, vector_width);
}

MOTIONLANG_NAMESPACE_END
