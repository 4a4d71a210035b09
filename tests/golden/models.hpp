// The denoisers of golden cases: built from the config, filled from weights/, conditioned from in/.
#pragma once

#include <motionlang/diffusion/mdm.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/diffusion/motiondiffuse.hpp>

#include "tensors.hpp"

namespace golden {

using ml::Index;

/// A denoiser with its statistics, under the keys of the Lightning checkpoint.
template <ml::Backend B>
struct MdmSmplModel {
  ml::MdmSmplDenoiser<B> denoiser;
  ml::Normalizer<B> motion_normalizer, text_normalizer;

  static constexpr auto fields() {
    using M = MdmSmplModel;
    return ml::fields("denoiser", &M::denoiser, "motion_normalizer", &M::motion_normalizer, "text_normalizer",
                      &M::text_normalizer);
  }
};

/// The variables of a model on an Autodiff backend are made by conversion, so models are built on the inner one.
template <ml::Backend B>
MdmSmplModel<B> mdm_smpl_model(const Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  MdmSmplModel<B> m{
      ml::MdmSmplDenoiser<B>({.nfeats = config["nfeats"].template as<Index>(),
                              .tx_dim = config["tx_dim"].template as<Index>(),
                              .latent_dim = config["latent_dim"].template as<Index>(),
                              .ff_size = config["ff_size"].template as<Index>(),
                              .num_layers = config["num_layers"].template as<Index>(),
                              .num_heads = config["num_heads"].template as<Index>(),
                              .nb_registers = config["nb_registers"].template as<Index>(),
                              .activation = ml::parse_activation(config["activation"].template as<std::string>()),
                              .max_len = position_rows},
                             rng),
      ml::Normalizer<B>::identity(config["nfeats"].template as<Index>()),
      ml::Normalizer<B>::identity(config["tx_dim"].template as<Index>())};
  if (c.has("weights/motion_normalizer.mean"))
    ml::load_module(m, c.file(), "weights/");
  else
    ml::load_module(m.denoiser, c.file(), "weights/denoiser.");
  return m;
}

template <ml::Backend B>
ml::MdmDenoiser<B> mdm_model(const Case& c) {
  const auto config = c.config();
  const auto arch = config["arch"].as<std::string>(), condition = config["cond_mode"].as<std::string>();
  const auto token =
      config.value_or("emb_trans_dec", true) ? config.value_or("class_token", std::string("none")) : "none";
  const bool bert = config.value_or("text_encoder_type", std::string("clip")) == "bert";
  ml::Philox rng;
  ml::MdmDenoiser<B> m({.nfeats = config["njoints"].as<Index>() * config["nfeats"].as<Index>(),
                        .arch = arch == "trans_dec" ? ml::MdmArch::trans_dec
                                : arch == "gru"     ? ml::MdmArch::gru
                                                    : ml::MdmArch::trans_enc,
                        .condition = condition == "text"     ? ml::MdmCondition::text
                                     : condition == "action" ? ml::MdmCondition::action
                                                             : ml::MdmCondition::none,
                        .text_dim = bert ? 768 : 512,
                        .text_sequence = bert,
                        .num_actions = config.value_or("num_actions", Index{1}),
                        .class_token = token == "time_only"        ? ml::MdmClassToken::time_only
                                       : token == "time_plus_text" ? ml::MdmClassToken::time_plus_text
                                                                   : ml::MdmClassToken::none,
                        .latent_dim = config["latent_dim"].as<Index>(),
                        .ff_size = config["ff_size"].as<Index>(),
                        .num_layers = config["num_layers"].as<Index>(),
                        .num_heads = config["num_heads"].as<Index>(),
                        .activation = ml::parse_activation(config["activation"].as<std::string>()),
                        .mask_frames = config.value_or("mask_frames", false),
                        .crop_frames = config.value_or("crop_frames", Index{0}),
                        .max_len = position_rows},
                       rng);
  ml::load_module(m, c.file(), "weights/");
  return m;
}

template <ml::Backend B>
ml::MotionDiffuseDenoiser<B> motiondiffuse_model(const Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::MotionDiffuseDenoiser<B> m({.input_feats = config["input_feats"].as<Index>(),
                                  .num_frames = config["num_frames"].as<Index>(),
                                  .latent_dim = config["latent_dim"].as<Index>(),
                                  .ff_size = config["ff_size"].as<Index>(),
                                  .num_layers = config["num_layers"].as<Index>(),
                                  .num_heads = config["num_heads"].as<Index>(),
                                  .text_latent_dim = config["text_latent_dim"].as<Index>(),
                                  .num_text_layers = config["num_text_layers"].as<Index>(),
                                  .text_num_heads = config["text_num_heads"].as<Index>(),
                                  .text_ff_size = config["text_ff_size"].as<Index>(),
                                  .activation = ml::parse_activation(config["activation"].as<std::string>()),
                                  .no_eff = config.value_or("no_eff", false)},
                                 rng);
  ml::load_module(m, c.file(), "weights/");
  return m;
}

/// text [B, width], or [B, L, width] with a mask.
template <ml::Backend B>
ml::TextFeatures<B> text_features(const Case& c, const std::string& text = "in/text",
                                  const std::string& mask = "in/text_mask") {
  if (c.shape(text).rank() == 2) return ml::TextFeatures<B>::pooled(tensor<B, 2>(c, text));
  const auto x = tensor<B, 3>(c, text);
  if (!c.has(mask)) return {ml::from_equal(x)};
  const auto valid = c.values<unsigned char>(mask);
  return {.tokens = ml::from_padded(x, std::span<const unsigned char>(valid)), .padded_tokens = x.size(1)};
}
/// The condition of an MDM: in/text, one-hot rows of in/action (they pick a learned vector), or as many rows that the
/// model ignores.
template <ml::Backend B>
ml::TextFeatures<B> mdm_condition(const Case& c, const ml::MdmConfig& config, Index sequences) {
  if (config.condition == ml::MdmCondition::text) return text_features<B>(c);
  const Index width = config.condition == ml::MdmCondition::action ? config.num_actions : 1;
  std::vector<typename B::scalar> one_hot(static_cast<std::size_t>(sequences * width));
  if (config.condition == ml::MdmCondition::action) {
    Index row = 0;
    for (const Index action : c.values<Index>("in/action"))
      one_hot.at(static_cast<std::size_t>(row++ * width + action)) = 1;
  }
  return ml::TextFeatures<B>::pooled(ml::Tensor<B, 2>::from(one_hot, {sequences, width}));
}
/// One vector as the features of one text.
template <ml::Backend B>
ml::TextFeatures<B> one_text(const Case& c, const std::string& name) {
  return ml::TextFeatures<B>::pooled(
      ml::Tensor<B, 2>::from(c.values<typename B::scalar>(name), {1, c.shape(name).count()}));
}
template <ml::Backend B>
ml::TextFeatures<B> zero_text(const ml::TextFeatures<B>& text) {
  return {text.tokens.with(ml::Tensor<B, 2>::zeros(text.tokens.rows.shape())), text.end_position};
}
/// clip_rows [B, R, width] and end_position.
template <ml::Backend B>
ml::TextFeatures<B> clip_features(const Case& c, const std::string& rows = "in/clip_rows",
                                  const std::string& end = "in/end_position") {
  const auto shape = c.shape(rows);
  const auto values = c.values<typename B::scalar>(rows);
  const Index texts = shape.rank() == 3 ? shape[0] : 1, tokens = shape[shape.rank() - 2];
  return {ml::from_equal(ml::Tensor<B, 3>::from(values, {texts, tokens, shape.back()})), c.values<Index>(end)};
}

}  // namespace golden
