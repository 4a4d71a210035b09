// SPDX-License-Identifier: MIT
// Bodies of text_motion_model.hpp.
#pragma once

#include <algorithm>  // is_sorted

#include <motionlang/weights/diffusion_folder.hpp>
#include <motionlang/weights/text_motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline TemosNetwork temos_network(const std::string& name, const char* key) {
  if (name == "transformer") return TemosNetwork::transformer;
  if (name == "gru") return TemosNetwork::gru;
  if (name == "none") return TemosNetwork::none;
  raise<config_error>(103, key, " '", name, "' is not transformer, gru or none");
}

/// latent_dim, ff_size, num_layers, num_heads, dropout and activation of a configuration as those of the system.
template <class Sizes, class Network>
Sizes babel_sizes(const Network& n, Index width, Index text_width) {
  Sizes c;
  c.nfeats = width, c.text_dim = text_width;
  c.latent_dim = n.latent_dim, c.ff_size = n.ff_size, c.num_layers = n.num_layers, c.num_heads = n.num_heads;
  c.dropout = n.dropout, c.activation = parse_activation(n.activation);
  return c;
}

MOTIONLANG_BODY WordVectors word_vectors_of(const WeightFile& weights) {
  const FileValue* list = weights.value(vector_words_entry);
  return list == nullptr ? WordVectors() : listed_word_vectors(weights, to_string(*list), word_vector_tensors);
}

}  // namespace detail

MOTIONLANG_BODY TmrConfig TrainedSystem<Tmr>::sizes(const TextMotionConfig& c, Index width) {
  const auto& n = c.network;
  if (n.motion_encoder != "transformer" || n.motion_decoder != "transformer")
    raise<config_error>(102, "TMR has transformers; network.motion_encoder and motion_decoder are for TEMOS");
  return {.motion_nfeats = width,
          .text_nfeats = c.text.width,
          .latent_dim = n.latent_dim,
          .ff_size = n.ff_size,
          .num_layers = n.num_layers,
          .num_heads = n.num_heads,
          .text_layers = n.text_layers,
          .text_heads = n.text_heads,
          .dropout = n.dropout,
          .activation = parse_activation(n.activation),
          .vae = n.vae};
}

MOTIONLANG_BODY TemosConfig TrainedSystem<Temos>::sizes(const TextMotionConfig& c, Index width) {
  const auto& n = c.network;
  return {.nfeats = width,
          .text_dim = c.text.width,
          .latent_dim = n.latent_dim,
          .ff_size = n.ff_size,
          .num_layers = n.num_layers,
          .num_heads = n.num_heads,
          .text_layers = n.text_layers,
          .text_heads = n.text_heads,
          .dropout = n.dropout,
          .activation = parse_activation(n.activation),
          .vae = n.vae,
          .motion_encoder = detail::temos_network(n.motion_encoder, "network.motion_encoder"),
          .motion_decoder = detail::temos_network(n.motion_decoder, "network.motion_decoder")};
}

MOTIONLANG_BODY SincConfig TrainedSystem<Sinc>::sizes(const SincTrainingConfig& c, Index width) {
  auto out = detail::babel_sizes<SincConfig>(c.network, width, c.text.width);
  const std::string& texts = c.network.texts;
  out.mode = texts == "separate"  ? SincMode::separate_texts
             : texts == "latents" ? SincMode::separate_latents
                                  : SincMode::single;
  out.legacy_ste_mask = false;  // it needs the states of a language model at places of padding
  return out;
}

MOTIONLANG_BODY TeachConfig TrainedSystem<Teach>::sizes(const TeachTrainingConfig& c, Index width) {
  auto out = detail::babel_sizes<TeachConfig>(c.network, width, c.text.width);
  out.hist_frames = c.network.hist_frames, out.z_prev_text = c.network.z_prev_text;
  out.mask_padding = c.network.mask_padding;
  return out;
}

MOTIONLANG_BODY nlohmann::ordered_json similarity_json(const SimilarityScale& scale) {
  return {{"shares", scale.shares}, {"cosines", scale.cosines}, {"least", scale.least}, {"missed", scale.missed},
          {"fooled", scale.fooled}, {"pairs", scale.pairs},     {"texts", scale.texts}, {"strangers", scale.strangers}};
}

MOTIONLANG_BODY SimilarityScale read_similarity(const JsonView& view) {
  SimilarityScale out{.shares = view["shares"].as<std::vector<double>>(),
                      .cosines = view["cosines"].as<std::vector<double>>(),
                      .least = view["least"].as<double>(),
                      .missed = view.value_or("missed", 0.0),
                      .fooled = view.value_or("fooled", 0.0),
                      .pairs = view.value_or("pairs", Index{0}),
                      .texts = view.value_or("texts", Index{0}),
                      .strangers = view.value_or("strangers", Index{0})};
  if (out.shares.size() != out.cosines.size() || !std::is_sorted(out.shares.begin(), out.shares.end()) ||
      !std::is_sorted(out.cosines.begin(), out.cosines.end()))
    raise<config_error>(107, view.path(), ": ", counted(out.shares.size(), "share"), " and ",
                        counted(out.cosines.size(), "cosine"), ", expected as many of both, ascending");
  return out;
}

MOTIONLANG_BODY LanguageModelFiles read_language_model_files(const std::filesystem::path& folder) {
  const auto config = folder / "config.json";
  const auto document = read_json(config);
  LanguageModelFiles out{folder, bert_config(JsonView(document, config.string()), "distilbert"),
                         std::make_shared<const AnyTokenizer>(read_tokenizer(folder))};
  if (out.tokenizer->size() > out.sizes.vocabulary)
    raise<config_error>(102, folder.string(), ": a tokenizer of ", counted(out.tokenizer->size(), "piece"),
                        ", the network knows ", out.sizes.vocabulary);
  return out;
}

MOTIONLANG_BODY void write_language_model_files(const std::filesystem::path& folder, const LanguageModelFiles& files) {
  std::filesystem::create_directories(folder);
  for (const auto& from : detail::text_encoder_files(files.folder, /*weights=*/false))
    write_file(folder / from.filename(), std::string_view(read_file(from)));
}

MOTIONLANG_BODY TextMotionFile read_text_motion_config(const std::filesystem::path& folder) {
  if (RunFolder run = find_run(folder); run.system == "tmr") {
    const TextMotionConfig config;  // as published
    return {"tmr", motion_features(config.features).fps, config, {}, {}, std::move(run)};
  }
  const auto path = (folder / "config.json").string();
  const auto model = read_model_folder(folder);
  if (model.system != "tmr" && model.system != "temos")
    raise<config_error>(103, path, ": system '", model.system, "' is not tmr or temos");
  auto file = text_model_file<TextMotionConfig>(model, path);
  if (file.config.text.finetune) file.language = read_language_model_files(folder / "text_encoder");
  return file;
}

MOTIONLANG_NAMESPACE_END
