// SPDX-License-Identifier: MIT
// Bodies of model_summary.hpp.
#pragma once

#include <motionlang/core/utf8.hpp>
#include <motionlang/weights/diffusion_run.hpp>
#include <motionlang/weights/known_systems.hpp>
#include <motionlang/weights/mdm_action_run.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/model_summary.hpp>
#include <motionlang/weights/tm2t_run.hpp>
#include <motionlang/weights/vae_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <class Config>
std::string transformer_sizes(const Config& c) {
  return concat_text("latent ", c.latent_dim, ", feed-forward ", c.ff_size, ", ", counted(c.num_layers, "layer"), ", ",
                     counted(c.num_heads, "head"));
}

inline ModelSummary actor_summary(const RunFolder& run, const WeightFile& weights) {
  constexpr const char* encoders[] = {"tokens for each class", "average", "GRU", "fully connected"};
  constexpr const char* decoders[] = {"transformer", "GRU", "fully connected", "autoregressive"};
  const RunReader r(run, weights, "");
  const ActorConfig c = actor_config(r);
  return {{"actions", concat_text(counted(c.num_classes, "class", "classes"),
                                  run.option("dataset") ? " of " + r.text("dataset", "") : "")},
          {"motions", concat_text(counted(c.njoints, "row"), " of ", counted(c.nfeats, "number"), " a frame (",
                                  r.text("pose_rep", "rot6d"), ")")},
          {"networks", concat_text("encoder ", encoders[static_cast<std::size_t>(c.encoder)], ", decoder ",
                                   decoders[static_cast<std::size_t>(c.decoder)], "; ", transformer_sizes(c))}};
}

/// TEMOS, TEACH, SINC.
inline ModelSummary lightning_summary(const RunFolder& run, const WeightFile& weights) {
  const std::string system = lightning_system(weights);
  const RunReader r(run, weights, "");
  const auto c = temos_config(r);
  const auto kind = [](TemosNetwork n) {
    return n == TemosNetwork::transformer ? "transformer" : n == TemosNetwork::gru ? "GRU" : "none";
  };
  const bool inside = weights.find("textencoder.text_model.embeddings.word_embeddings.weight") != nullptr;
  return {{"model of", system},
          {"motions", concat_text(counted(c.nfeats, "number"), " a frame, ",
                                  r.real("data/framerate", system == "temos" ? 12.5 : 30), " frames per second")},
          {"texts", concat_text("states of ", counted(c.text_dim, "number"), ", DistilBERT ",
                                inside ? "in the checkpoint" : "elsewhere")},
          {"networks", concat_text("motion encoder ", kind(c.motion_encoder), ", decoder ", kind(c.motion_decoder),
                                   c.vae ? ", " : ", deterministic, ", transformer_sizes(c))}};
}

inline ModelSummary tmr_summary(const RunFolder& run, const WeightFile& weights) {
  const auto c = tmr_config(RunReader(run, weights, ""));
  return {{"motions", concat_text(counted(c.motion_nfeats, "number"), " a frame")},
          {"texts", concat_text("states of ", counted(c.text_nfeats, "number"))},
          {"networks", concat_text(transformer_sizes(c), c.vae ? "" : ", deterministic")}};
}

/// A folder of TM2T holds one of its models. A packed folder, and one of our trainings, also has the models behind it.
inline ModelSummary tm2t_summary(const RunFolder& run) {
  const WeightFile weights = tm2t_weights(run);
  ModelSummary out;
  const auto say = [&](const char* part, const char* key, std::string value, std::string networks) {
    out.emplace_back("part", part);
    if (key[0] != '\0') out.emplace_back(key, std::move(value));
    out.emplace_back("networks", std::move(networks));
  };
  if (weights.find("t2m_model.motion_decoder_step.input_emb.weight") != nullptr) {
    const auto c = tm2t_gru_config(RunReader(run, weights, "t2m_model."));
    say("from texts to motions", "texts", concat_text("word vectors of ", counted(c.word, "number")),
        concat_text("recurrent, ", counted(c.layers, "layer"), " of ", c.motion_hidden, ", ", c.late ? "late" : "early",
                    " attention; writes ", counted(c.symbols, "symbol")));
  }
  for (const char* name : {"m2t_transformer", "t2m_transformer"}) {
    const RunReader r(run, weights, std::string(name) + ".");
    if (!r.has("encoder.layer_stack.0.slf_attn.w_qs.weight")) continue;
    const char* target = r.has("trg_word_prj.weight") ? "trg_word_prj.weight" : "decoder.trg_word_emb.weight";
    say(name[0] == 'm' ? "from motions to texts" : "from texts to motions, by transformers", "", "",
        concat_text("transformer of width ", r.size(target, 1), ", ",
                    r.count("encoder.layer_stack.", ".slf_attn.w_qs.weight", {}), " + ",
                    r.count("decoder.layer_stack.", ".slf_attn.w_qs.weight", {}), " layers; writes ",
                    counted(r.size(target, 0), "symbol")));
  }
  if (weights.find("quantizer.embedding.weight") != nullptr) {
    const auto c = tm2t_tokenizer_config(RunReader(run, weights, ""));
    say("motion tokenizer", "motions", concat_text(counted(c.features, "number"), " a frame"),
        concat_text(counted(c.codes, "code"), ", ", counted(c.channels.size(), "halving"), " of the length, ",
                    counted(c.residual_blocks, "residual block")));
  }
  return out;
}

inline ModelSummary mdm_action_summary(const RunFolder& run) {
  const WeightFile weights = run_weights(run);
  DiffusionRun about;
  read_mdm(about, reader_of(run, weights));
  const bool none = about.mdm.condition == MdmCondition::none;
  return {{"actions", none ? "any" : counted(about.mdm.num_actions, "class", "classes")},
          {"motions", concat_text(counted(about.mdm.nfeats, "number"), " a frame")},
          {"diffusion", concat_text(about.schedule, ", ", counted(about.steps, "step"))},
          {"networks", transformer_sizes(about.mdm)}};
}

/// "latent_dim 64, ff_size 128, ..."
inline std::string json_members(const nlohmann::ordered_json& object) {
  return join_text(object.items(), ", ", [](const auto& member) {
    const auto& value = member.value();
    return member.key() + " " + (value.is_string() ? value.template get<std::string>() : value.dump());
  });
}

/// The summary of a training of ours, from its configuration.
inline ModelSummary trained_summary(const RunFolder& run) {
  const ModelFolder model = read_model_folder(run.folder);
  ModelSummary out{{"motions", concat_text(model.features, ", ", model.fps, " frames per second")},
                   {"text encoder", model.text_encoder}};
  if (model.others.contains("labels"))
    out.emplace_back("actions", join_text(model.others.at("labels").get<std::vector<std::string>>()));
  for (const char* part : {"clips", "network", "losses"}) {
    if (model.config.contains(part) && model.config.at(part).is_object())
      out.emplace_back(part, json_members(model.config.at(part)));
  }
  if (model.config.contains("kind")) out.emplace_back("network", model.config.at("kind").get<std::string>());
  return out;
}

}  // namespace detail

MOTIONLANG_BODY ModelSummary model_summary(const RunFolder& run) {
  if (run.system == "motionlang") return detail::trained_summary(run);
  if (run.weights.empty() && run.system != "tmr") return {};
  if (run.system == "tm2t") return detail::tm2t_summary(run);
  if (run.system == "mdm") return detail::mdm_action_summary(run);
  if (run.system != "actor" && run.system != "temos" && run.system != "tmr") return {};
  const WeightFile weights = open_weights(run.weights.empty() ? run.folder : run.weights);
  return run.system == "actor"   ? detail::actor_summary(run, weights)
         : run.system == "temos" ? detail::lightning_summary(run, weights)
                                 : detail::tmr_summary(run, weights);
}

MOTIONLANG_BODY std::string describe_folder(const FilePath& folder) {
  const RunFolder run = find_run(folder);
  std::string out, system = run.system;
  const auto say = [&](std::string key, const std::string& value) {
    key.resize(std::max<std::size_t>(key.size() + 1, 25), ' ');
    if (!value.empty()) out += "  " + key + printable(value) + "\n";
  };
  say("system", system);
  if (system.empty()) return out;
  say("options", run.options_file.string());
  say("weights", run.weights.string());
  for (const auto& [part, file] : run.parts) say(part, file.string());
  if (system == "motionlang" || run.packed) {
    const ModelFolder model = read_model_folder(folder);
    if (!run.packed) say("model of", system = model.system);
    say("license", model.license);
    say("provenance", model.provenance);
  }
  if (system == "mdm" && run.system == "mdm" && is_mdm_action_run(run)) system = "mdm of actions";
  if (!is_diffusion_system(system)) {
    const auto summary = [&] {
      for (const auto& [key, value] : model_summary(run)) say(key, value);
    };
    detail::guard<error>(summary,
                         [&](const error& e) {  // tensors are missing: the rest can still be shown
                           say("not a whole model", e.what());
                           return true;
                         });
    return out;
  }
  const RunFolder inner = detail::published_run(run);
  const DiffusionRun about = diffusion_run(inner, detail::run_weights(inner));
  say("motions", concat_text(about.features, ", ", counted(about.width(), "number"), " a frame, ", about.fps,
                             " frames per second"));
  say("diffusion", concat_text(about.schedule, ", ", counted(about.steps, "step")));
  say("text encoder", about.text_encoder);
  return out;
}

MOTIONLANG_NAMESPACE_END
