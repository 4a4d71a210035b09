#include "model_summary.hpp"

#include <motionlang/weights/mdm_action_run.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/tm2t_run.hpp>
#include <motionlang/weights/vae_run.hpp>

namespace program {

namespace {

namespace ml = motionlang;
using Lines = std::vector<std::pair<std::string, std::string>>;

template <class Config>
std::string transformer(const Config& c) {
  return ml::concat_text("latent ", c.latent_dim, ", feed-forward ", c.ff_size, ", ",
                         ml::counted(c.num_layers, "layer"), ", ", ml::counted(c.num_heads, "head"));
}

Lines actor(const ml::RunFolder& run, const ml::WeightFile& weights) {
  constexpr const char* encoders[] = {"tokens for each class", "average", "GRU", "fully connected"};
  constexpr const char* decoders[] = {"transformer", "GRU", "fully connected", "autoregressive"};
  const ml::detail::RunReader r(run, weights, "");
  const ml::ActorConfig c = ml::detail::actor_config(r);
  return {{"actions", ml::concat_text(ml::counted(c.num_classes, "class", "classes"),
                                      run.option("dataset") ? " of " + r.text("dataset", "") : "")},
          {"motions", ml::concat_text(ml::counted(c.njoints, "row"), " of ", ml::counted(c.nfeats, "number"),
                                      " a frame (", r.text("pose_rep", "rot6d"), ")")},
          {"networks", ml::concat_text("encoder ", encoders[static_cast<std::size_t>(c.encoder)], ", decoder ",
                                       decoders[static_cast<std::size_t>(c.decoder)], "; ", transformer(c))}};
}

/// TEMOS, TEACH, SINC.
Lines lightning(const ml::RunFolder& run, const ml::WeightFile& weights) {
  const std::string system = ml::lightning_system(weights);
  const ml::detail::RunReader r(run, weights, "");
  const auto c = ml::detail::temos_config(r);
  const auto kind = [](ml::TemosNetwork n) {
    return n == ml::TemosNetwork::transformer ? "transformer" : n == ml::TemosNetwork::gru ? "GRU" : "none";
  };
  const bool inside = weights.find("textencoder.text_model.embeddings.word_embeddings.weight") != nullptr;
  return {{"model of", system},
          {"motions", ml::concat_text(ml::counted(c.nfeats, "number"), " a frame, ",
                                      r.real("data/framerate", system == "temos" ? 12.5 : 30), " frames per second")},
          {"texts", ml::concat_text("states of ", ml::counted(c.text_dim, "number"), ", DistilBERT ",
                                    inside ? "in the checkpoint" : "elsewhere")},
          {"networks", ml::concat_text("motion encoder ", kind(c.motion_encoder), ", decoder ", kind(c.motion_decoder),
                                       c.vae ? ", " : ", deterministic, ", transformer(c))}};
}

Lines tmr(const ml::RunFolder& run, const ml::WeightFile& weights) {
  const auto c = ml::detail::tmr_config(ml::detail::RunReader(run, weights, ""));
  return {{"motions", ml::concat_text(ml::counted(c.motion_nfeats, "number"), " a frame")},
          {"texts", ml::concat_text("states of ", ml::counted(c.text_nfeats, "number"))},
          {"networks", ml::concat_text(transformer(c), c.vae ? "" : ", deterministic")}};
}

/// A folder of TM2T holds one of its models; packed, and of our training, what that one was made with, too.
Lines tm2t(const ml::RunFolder& run) {
  const ml::WeightFile weights = ml::detail::tm2t_weights(run);
  Lines out;
  const auto say = [&](const char* part, const char* key, std::string value, std::string networks) {
    out.emplace_back("part", part);
    if (key[0] != '\0') out.emplace_back(key, std::move(value));
    out.emplace_back("networks", std::move(networks));
  };
  if (weights.find("t2m_model.motion_decoder_step.input_emb.weight") != nullptr) {
    const auto c = ml::detail::tm2t_gru_config(ml::detail::RunReader(run, weights, "t2m_model."));
    say("from texts to motions", "texts", ml::concat_text("word vectors of ", ml::counted(c.word, "number")),
        ml::concat_text("recurrent, ", ml::counted(c.layers, "layer"), " of ", c.motion_hidden, ", ",
                        c.late ? "late" : "early", " attention; writes ", ml::counted(c.symbols, "symbol")));
  }
  for (const char* name : {"m2t_transformer", "t2m_transformer"}) {
    const ml::detail::RunReader r(run, weights, std::string(name) + ".");
    if (!r.has("encoder.layer_stack.0.slf_attn.w_qs.weight")) continue;
    const char* target = r.has("trg_word_prj.weight") ? "trg_word_prj.weight" : "decoder.trg_word_emb.weight";
    say(name[0] == 'm' ? "from motions to texts" : "from texts to motions, by transformers", "", "",
        ml::concat_text("transformer of width ", r.size(target, 1), ", ",
                        r.count("encoder.layer_stack.", ".slf_attn.w_qs.weight", {}), " + ",
                        r.count("decoder.layer_stack.", ".slf_attn.w_qs.weight", {}), " layers; writes ",
                        ml::counted(r.size(target, 0), "symbol")));
  }
  if (weights.find("quantizer.embedding.weight") != nullptr) {
    const auto c = ml::detail::tm2t_tokenizer_config(ml::detail::RunReader(run, weights, ""));
    say("motion tokenizer", "motions", ml::concat_text(ml::counted(c.features, "number"), " a frame"),
        ml::concat_text(ml::counted(c.codes, "code"), ", ", ml::counted(c.channels.size(), "halving"),
                        " of the length, ", ml::counted(c.residual_blocks, "residual block")));
  }
  return out;
}

Lines mdm_of_actions(const ml::RunFolder& run) {
  const ml::WeightFile weights = ml::detail::run_weights(run);
  ml::DiffusionRun about;
  ml::detail::read_mdm(about, ml::detail::reader_of(run, weights));
  const bool none = about.mdm.condition == ml::MdmCondition::none;
  return {{"actions", none ? "any" : ml::counted(about.mdm.num_actions, "class", "classes")},
          {"motions", ml::concat_text(ml::counted(about.mdm.nfeats, "number"), " a frame")},
          {"diffusion", ml::concat_text(about.schedule, ", ", ml::counted(about.steps, "step"))},
          {"networks", transformer(about.mdm)}};
}

/// "latent_dim 64, ff_size 128, ..."
std::string members(const nlohmann::ordered_json& object) {
  return ml::join_text(object.items(), ", ", [](const auto& member) {
    const auto& value = member.value();
    return member.key() + " " + (value.is_string() ? value.template get<std::string>() : value.dump());
  });
}

/// Of a training of ours: what its configuration says.
Lines trained(const ml::RunFolder& run) {
  const ml::ModelFolder model = ml::read_model_folder(run.folder);
  Lines out{{"motions", ml::concat_text(model.features, ", ", model.fps, " frames per second")},
            {"text encoder", model.text_encoder}};
  if (model.others.contains("labels"))
    out.emplace_back("actions", ml::join_text(model.others.at("labels").get<std::vector<std::string>>()));
  for (const char* part : {"clips", "network", "losses"}) {
    if (model.config.contains(part) && model.config.at(part).is_object())
      out.emplace_back(part, members(model.config.at(part)));
  }
  if (model.config.contains("kind")) out.emplace_back("network", model.config.at("kind").get<std::string>());
  return out;
}

}  // namespace

Lines model_summary(const ml::RunFolder& run) {
  if (run.system == "motionlang") return trained(run);
  if (run.weights.empty() && run.system != "tmr") return {};
  if (run.system == "tm2t") return tm2t(run);
  if (run.system == "mdm") return mdm_of_actions(run);
  if (run.system != "actor" && run.system != "temos" && run.system != "tmr") return {};
  const ml::WeightFile weights = ml::open_weights(run.weights.empty() ? run.folder : run.weights);
  return run.system == "actor"   ? actor(run, weights)
         : run.system == "temos" ? lightning(run, weights)
                                 : tmr(run, weights);
}

}  // namespace program
