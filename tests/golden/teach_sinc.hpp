// TEACH and SINC of golden cases: models from the config, gradients and one step of the optimiser.
#pragma once

#include <motionlang/optim/adamw.hpp>
#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/teach.hpp>

#include "geometry.hpp"
#include "part_vectors.hpp"
#include "text_motion.hpp"

namespace golden {

/// Sizes and switches that both systems have; training cases alone have a motion encoder.
template <class Config>
Config text_motion_config(const Case& c) {
  const auto config = c.config();
  Config out;
  out.nfeats = config["nfeats"].template as<Index>();
  out.text_dim = config["text_dim"].template as<Index>();
  out.latent_dim = config["latent_dim"].template as<Index>();
  out.ff_size = config["ff_size"].template as<Index>();
  out.num_layers = config["num_layers"].template as<Index>();
  out.num_heads = config["num_heads"].template as<Index>();
  out.motion_encoder = !c.names("weights/motionencoder.").empty();
  out.max_len = position_rows;
  return out;
}
template <ml::Backend B>
ml::Teach<B> teach_model(const Case& c) {
  auto config = text_motion_config<ml::TeachConfig>(c);
  config.hist_frames = c.config()["hist_frames"].as<Index>();
  config.z_prev_text = c.config().value_or("z_prev_text", false);
  ml::Philox rng;
  ml::Teach<B> m(config, rng);
  ml::load_module(m, c.file(), "weights/");
  return m;
}
inline ml::SincMode sinc_mode(const ml::JsonView& config) {
  const auto name = config.value_or("mode", std::string("single"));
  if (name == "single") return ml::SincMode::single;
  if (name == "ste") return ml::SincMode::separate_texts;
  if (name == "separate") return ml::SincMode::separate_latents;
  ml::raise<ml::config_error>(103, "unknown mode '", name, "'");
}
template <ml::Backend B>
ml::Sinc<B> sinc_model(const Case& c) {
  auto config = text_motion_config<ml::SincConfig>(c);
  config.mode = sinc_mode(c.config());
  config.legacy_ste_mask = c.config().value_or("legacy_ste_mask", true);
  ml::Philox rng;
  ml::Sinc<B> m(config, rng);
  ml::load_module(m, c.file(), "weights/");
  return m;
}

/// The texts of a batch. The file has the states of padding, too; the last of them is all that is ever seen.
template <ml::Backend B>
ml::SincTexts<B> sinc_texts(const Case& c) {
  const auto states = tensor<B, 3>(c, "in/text_hidden");
  ml::SincTexts<B> texts{packed<B>(c, "text_hidden", "text_mask")};
  if (c.has("in/sample_of_text")) texts.motion = c.values<Index>("in/sample_of_text");
  texts.end = ml::last_row(ml::from_equal(states));
  texts.padded_tokens = states.size(1);
  return texts;
}

/// Writes the results of one training step: the terms of the loss and their sum, the gradients, and the parameters
/// after the step, named `after_`. A parameter without a gradient in the file must have none.
template <ml::AutodiffBackend A, class M>
void out_training_step(Case& c, M& model, const ml::LossTerms<A>& terms) {
  for (const auto& term : terms.terms) out(c, term.name, term.value);
  const auto loss = terms.total();
  out(c, "loss", loss);
  const auto gradients = ml::backward(loss);
  ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
    if (gradients.find(t.data()) == nullptr) return;
    const auto g = gradients[t];
    c.grad(path, g.shape(), g.span());
  });
  const auto config = c.config();
  ml::AdamW<A> adam(
      {.lr = config["lr"].template as<double>(), .weight_decay = config["weight_decay"].template as<double>()});
  adam.step(model, gradients);
  ml::visit_tensors(model, [&](const std::string& path, const auto& t) { out_if_wanted(c, "after_" + path, t); });
}
inline ml::TemosLossOptions loss_weights(const ml::JsonView& config, ml::TemosLossOptions options) {
  options.recons = config["lmd_recons"].as<double>();
  options.kl = config["lmd_kl"].as<double>();
  options.latent = config["lmd_latent"].as<double>();
  return options;
}

/// (sequences, latent) where the case has an axis of one between them.
template <ml::Backend B>
void out_rows(Case& c, const std::string& name, const ml::Tensor<B, 2>& t) {
  if (c.wants(name)) c.out(name, {t.size(0), 1, t.size(1)}, t.span());
}

/// One text of a generation case, in/text_hidden_I (tokens, width).
template <ml::Backend B>
ml::Sequences<B> one_text(const Case& c, Index i) {
  const auto rows = tensor<B, 2>(c, "in/text_hidden_" + std::to_string(i));
  return {rows, ml::Offsets{rows.size(0)}};
}
/// All of them.
template <ml::Backend B>
ml::Sequences<B> all_texts(const Case& c) {
  std::vector<ml::Tensor<B, 2>> rows;
  std::vector<Index> lengths;
  for (Index i = 0; c.has("in/text_hidden_" + std::to_string(i)); ++i) {
    rows.push_back(one_text<B>(c, i).rows);
    lengths.push_back(rows.back().size(0));
  }
  return {ml::concat(std::span<const ml::Tensor<B, 2>>(rows), 0), ml::Offsets(lengths)};
}
/// noise/eps_0, eps_1, ... as rows.
template <ml::Backend B>
ml::Tensor<B, 2> all_noise(const Case& c) {
  std::vector<ml::Tensor<B, 2>> list;
  for (Index i = 0; c.has("noise/eps_" + std::to_string(i)); ++i)
    list.push_back(golden::rows<B>(c, "noise/eps_" + std::to_string(i)));
  return ml::concat(std::span<const ml::Tensor<B, 2>>(list), 0);
}
template <ml::Backend B>
ml::Normalizer<B> statistics(const Case& c, double eps) {
  return {tensor<B, 1>(c, "in/mean"), tensor<B, 1>(c, "in/std"), eps};
}
template <class S>
void out_motion(Case& c, const ml::SmplVelpMotion<S>& motion, const std::string& suffix = "") {
  out_list<S>(c, "rots" + suffix, motion.rotations);
  out_list<S>(c, "trans" + suffix, motion.trans);
}

}  // namespace golden
