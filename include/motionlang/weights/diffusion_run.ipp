// SPDX-License-Identifier: MIT
// Bodies of diffusion_run.hpp.
#pragma once

#include <motionlang/weights/diffusion_run.hpp>
#include <motionlang/weights/known_systems.hpp>
#include <motionlang/weights/own_text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GaussianDiffusion DiffusionRun::diffusion() const {
  if (schedule == "linear") return GaussianDiffusion(LinearSchedule{.steps = steps});
  if (schedule == "chen") return GaussianDiffusion(ChenCosineSchedule{.steps = steps});
  return GaussianDiffusion(CosineSchedule{.steps = steps});
}

MOTIONLANG_BODY FeatureLayout DiffusionRun::layout() const {
  if (features == "smplrifke") return smplrifke_layout();
  return width() == Guoh3dSlots{21}.size() ? guoh3dfeats_layout(kit_part_of_joint) : guoh3dfeats_layout();
}

namespace detail {

inline void read_stmc(DiffusionRun& out, const RunReader& r) {
  const std::string layer = "seqTransEncoder.layers.";
  out.mdm_smpl = {
      .nfeats = r.size("skel_embedding.weight", 1, {"diffusion/denoiser/nfeats", "data/motion_loader/nfeats"}),
      .tx_dim = r.size("tx_embedding.0.weight", 1, {"diffusion/denoiser/tx_dim"}),
      .latent_dim = r.size("skel_embedding.weight", 0, {"diffusion/denoiser/latent_dim"}),
      .ff_size = r.size(layer + "0.linear1.weight", 0, {"diffusion/denoiser/ff_size"}),
      .num_layers = r.count(layer, ".linear1.weight", {"diffusion/denoiser/num_layers"}),
      .num_heads = r.number({"diffusion/denoiser/num_heads"}, 8, 1024),
      .nb_registers = r.size_if_any("registers", 0, {"diffusion/denoiser/nb_registers"}),
      .activation = parse_activation(r.one_of("diffusion/denoiser/activation", "gelu", {"gelu", "relu"}))};
  out.steps =
      r.number({"diffusion/timesteps", "diffusion/schedule/timesteps", "diffusion/schedule/steps"}, 100, 10'000);
  r.one_of("diffusion/prediction", "x", {"x"});
  out.schedule = r.one_of("diffusion/noise_schedule", "cosine", {"cosine", "chen"});
  out.text_encoder = r.one_of("text_encoder_type", "clip", {"clip", "word_pieces"});
  out.mdm_smpl.max_len = std::max(out.mdm_smpl.max_len, out.steps);
  out.fps = r.real("data/motion_loader/fps", 20);
  out.features = "smplrifke";
}

MOTIONLANG_BODY void read_mdm(DiffusionRun& out, const RunReader& r) {
  MdmConfig& c = out.mdm;
  const bool decoder = r.has("seqTransDecoder.layers.0.linear1.weight"), recurrent = r.has("gru.weight_ih_l0");
  c.arch = recurrent ? MdmArch::gru : decoder ? MdmArch::trans_dec : MdmArch::trans_enc;
  const std::string stated = r.text("arch", "");
  const std::string_view found = recurrent ? "gru" : decoder ? "trans_dec" : "trans_enc";
  if (!stated.empty() && stated != found)
    raise<config_error>(102, r.place("arch"), " is '", stated, "', the tensors are those of ", found);
  if (r.number({"context_len"}, 0, 100'000, 0) > 0)
    raise<io_error>(404, r.place("context_len"), ": models that continue a motion (DiP) are not supported");
  const std::string layers = recurrent ? "gru.weight_ih_l"
                             : decoder ? "seqTransDecoder.layers."
                                       : "seqTransEncoder.layers.";
  c.nfeats = r.size("output_process.poseFinal.weight", 0);
  c.latent_dim = r.size("input_process.poseEmbedding.weight", 0, {"latent_dim"});
  c.num_layers = r.count(layers, recurrent ? "" : ".linear1.weight", {"layers"});
  if (!recurrent) c.ff_size = r.size(layers + "0.linear1.weight", 0);
  c.num_heads = r.number({"num_heads"}, c.num_heads, 1024);  // as published 4, which the options do not say
  const bool text = r.has("embed_text.weight"), action = r.has("embed_action.action_embedding");
  c.condition = text ? MdmCondition::text : action ? MdmCondition::action : MdmCondition::none;
  if (action) c.num_actions = r.size("embed_action.action_embedding", 0);
  if (text) c.text_dim = r.size("embed_text.weight", 1);
  out.text_encoder = !text ? "none" : r.one_of("text_encoder_type", "clip", {"clip", "bert", "word_pieces"});
  c.text_sequence = decoder && out.text_encoder != "clip";
  if (decoder && r.flag("emb_trans_dec", false))
    c.class_token = c.text_sequence ? MdmClassToken::time_only : MdmClassToken::time_plus_text;
  c.mask_frames = r.flag("mask_frames", false);
  out.steps = r.number({"diffusion_steps"}, 1000, 10'000);
  out.schedule = r.one_of("noise_schedule", "cosine", {"cosine", "linear"});
  c.max_len = std::max({c.max_len, out.steps, c.crop_frames + 1});
}

inline void read_motiondiffuse(DiffusionRun& out, const RunReader& r) {
  MotionDiffuseConfig& c = out.motiondiffuse;
  const std::string block = "temporal_decoder_blocks.", layer = "textTransEncoder.layers.";
  c.input_feats = r.size("joint_embed.weight", 1);
  c.num_frames = r.size("sequence_embedding", 0);
  c.latent_dim = r.size("sequence_embedding", 1, {"latent_dim"});
  c.ff_size = r.size(block + "0.ffn.linear1.weight", 0, {"ff_size"});
  c.num_layers = r.count(block, ".ffn.linear1.weight", {"num_layers"});
  c.num_heads = r.number({"num_heads"}, 8, 1024);
  c.clip_dim = r.size("text_pre_proj.weight", 1);
  c.text_latent_dim = r.size("text_pre_proj.weight", 0, {"text_latent_dim"});
  c.text_ff_size = r.size(layer + "0.linear1.weight", 0, {"text_ff_size"});
  c.num_text_layers = r.count(layer, ".linear1.weight", {"num_text_layers"});
  c.text_num_heads = r.number({"text_num_heads"}, 4, 1024);
  c.no_eff = r.flag("no_eff", false);
  out.steps = r.number({"diffusion_steps"}, 1000, 10'000);
  out.schedule = "linear";
  out.text_encoder = r.one_of("text_encoder_type", "clip", {"clip", "word_pieces"});
}

/// HumanML3D's vector of 22 joints, or KIT's of 21.
inline void read_representation(DiffusionRun& out, const std::string& where) {
  const Index kit = Guoh3dSlots{21}.size(), human = Guoh3dSlots{22}.size();
  if (out.width() != kit && out.width() != human)
    raise<io_error>(404, where, ": motions of ", counted(out.width(), "number"), " a frame, expected ", human,
                    " (HumanML3D) and ", kit, " (KIT-ML)");
  out.features = "guoh3dfeats";
  out.fps = out.width() == kit ? 12.5 : 20;
}

MOTIONLANG_BODY RunReader reader_of(const RunFolder& run, const TensorSet& weights) {
  return reader_of(run, weights,
                   run.system == "stmc"  ? "skel_embedding.weight"
                   : run.system == "mdm" ? "input_process.poseEmbedding.weight"
                                         : "joint_embed.weight");
}

/// The places of a text encoder, relative to the folder of the model and to its parent.
inline constexpr const char* clip_places[] = {"text_encoder", "clip", "ViT-B-32.pt", "clip-vit-base-patch32"};

inline constexpr const char* bert_places[] = {"text_encoder", "distilbert-base-uncased"};

inline constexpr const char* own_places[] = {"text_encoder"};

MOTIONLANG_BODY std::filesystem::path find_text_encoder(const std::filesystem::path& model, const std::string& kind) {
  std::vector<std::string> tried;
  const auto places = kind == "clip"          ? std::span<const char* const>(clip_places)
                      : kind == "word_pieces" ? std::span<const char* const>(own_places)
                                              : bert_places;
  for (const auto& folder : {model, folder_around(model)}) {
    for (const char* name : places) {
      std::error_code ignored;
      if (std::filesystem::exists(folder / name, ignored)) return folder / name;
      tried.push_back((folder / name).string());
    }
  }
  raise<io_error>(401, model.string(), ": its text encoder is not in the folder: give ",
                  kind == "clip" ? "CLIP ViT-B/32 (ViT-B-32.pt with bpe_simple_vocab_16e6.txt.gz, or the folder "
                                   "clip-vit-base-patch32)"
                  : kind == "word_pieces" ? "the folder text_encoder that its training wrote"
                                          : "the folder distilbert-base-uncased",
                  "; looked for ", join_text(tried));
}

MOTIONLANG_BODY std::filesystem::path clip_vocabulary_of(const std::filesystem::path& model) {
  for (const auto& folder : {model, model / "text_encoder", model / "clip", folder_around(model)}) {
    for (const char* name : clip_vocabularies) {
      if (file_exists(folder / name)) return folder / name;
    }
  }
  raise<io_error>(401, model.string(),
                  ": CLIP is in the checkpoint, its vocabulary is not: put "
                  "bpe_simple_vocab_16e6.txt.gz (of github.com/openai/CLIP) there, or name a text encoder");
}

MOTIONLANG_BODY WeightFile run_weights(const RunFolder& run) {
  if (run.weights.extension() == ".safetensors") return open_weights(run.weights);  // one of ours
  if (run.system == "motiondiffuse") return open_weights(run.weights, {.path = "encoder"});
  const FileValue* average = run.option("use_ema");
  if (run.system == "mdm" && average != nullptr && std::get_if<bool>(&average->value) &&
      std::get<bool>(average->value)) {
    const WeightFile plain = open_weights(run.weights, {.path = ""});
    for (const TensorView& t : plain.tensors()) {
      if (t.name.starts_with("model_avg.")) return open_weights(run.weights, {.path = "model_avg"});
    }
  }
  return open_weights(run.weights);
}

MOTIONLANG_BODY RunFolder published_run(const RunFolder& run) {
  RunFolder out = run;
  if (run.system == "motionlang") {
    const FileValue* system = run.option("system");
    out.system = system == nullptr ? "" : to_string(*system);
    out.options = options_of_config(run);
  }
  if (!is_diffusion_system(out.system))
    raise<io_error>(404, run.folder.string(), ": ", out.system.empty() ? "of no known system" : "of " + out.system,
                    "; diffusion models are those of stmc, mdm and motiondiffuse");
  if (run.weights.empty())
    raise<io_error>(401, run.folder.string(), ": no checkpoint of ", out.system,
                    " (see weights/run_folder.hpp for its name)");
  return out;
}

MOTIONLANG_BODY TextEncoderOptions wanted_text_encoder(const RunFolder& run, const DiffusionRun& about) {
  if (about.text_encoder == "none")
    raise<io_error>(404, run.folder.string(),
                    ": a model without texts: actions and unconditional motions are not supported");
  if (about.text_encoder == "bert" && !about.mdm.text_sequence)
    raise<io_error>(404, run.folder.string(), ": texts of DistilBERT without a decoder (trans_dec)");
  const bool motiondiffuse = about.system == "motiondiffuse";
  if (about.text_encoder == "word_pieces") {
    const bool states = motiondiffuse || about.mdm.text_sequence;
    return {.text = {.pooling = states ? Pooling::none : Pooling::mean},
            .limits = {.longest = own_text_longest, .truncate = true}};
  }
  return about.text_encoder == "bert" ? TextEncoderOptions{}
         : motiondiffuse              ? clip_states()
         : about.system == "mdm"      ? clip_sentences(22)
                                      : clip_sentences();
}

MOTIONLANG_BODY void require_text_encoder(const RunFolder& run, const DiffusionRun& about, const std::string& named,
                                          bool clip) {
  if (clip != (about.text_encoder == "clip"))
    raise<config_error>(102, run.folder.string(), ": needs ", about.text_encoder == "clip" ? "CLIP" : "DistilBERT",
                        " as its text encoder, ", named, " is ", clip ? "CLIP" : "of the BERT family");
}

}  // namespace detail

MOTIONLANG_BODY DiffusionRun diffusion_run(const RunFolder& run, const TensorSet& weights) {
  const detail::RunReader r = detail::reader_of(run, weights);
  DiffusionRun out;
  out.system = run.system;
  out.prefix = r.prefix();
  if (run.system == "stmc") {
    detail::read_stmc(out, r);
    if (const Index wanted = smplrifke_layout().size; out.width() != wanted)
      raise<io_error>(404, weights.name(), ": motions of ", counted(out.width(), "number"), " a frame, smplrifke has ",
                      wanted);
  } else {
    run.system == "mdm" ? detail::read_mdm(out, r) : detail::read_motiondiffuse(out, r);
    detail::read_representation(out, weights.name());
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
