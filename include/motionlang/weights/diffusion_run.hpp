// SPDX-License-Identifier: MIT
/// The published diffusion models from the folders in which their repositories leave them: STMC's MDM-SMPL, MDM,
/// MotionDiffuse. And from model folders of ours that were made of them (weights/diffusion_folder.hpp).
///
///     const auto stmc = load_diffusion_run<B>("models/mdm-smpl_clip_smplrifke_humanml3d", {.text_encoder =
///     "ViT-B-32.pt"});
///     const auto features = stmc.generate(timeline, Philox{.seed = 7});        // (frames, stmc.layout.size)
///
/// Sizes       from the shapes of the tensors; where options state them, too, both have to agree. Number of heads,
///             steps, schedule and representation from the options, else as published
/// Statistics  from the checkpoint (STMC), mean and std beside it (MDM: those of HumanML3D, which are not in its
///             folder)
/// Source      spec mdm.md 2.1, 2.2, 3.5, 3.6, 4.4; stmc.md 6
/// Throws      io_error 401 for a file that is missing, naming it; 404 for variants that are not supported; 406, 407
///             for tensors; config_error 102 where options and tensors differ, 101, 103, 107
#pragma once

#include <motionlang/diffusion/any_denoiser.hpp>
#include <motionlang/systems/stmc.hpp>
#include <motionlang/weights/detail/run_reader.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// What the files say about a model, before memory is taken for it. The member that `system` names counts.
struct DiffusionRun {
  std::string system;  // stmc, mdm, motiondiffuse
  std::string prefix;  // of the names of the denoiser's tensors
  MdmSmplConfig mdm_smpl{};
  MdmConfig mdm{};
  MotionDiffuseConfig motiondiffuse{};
  Index steps = 1000;
  std::string schedule = "cosine";  // or linear
  double fps = 20;
  std::string features;               // smplrifke, guoh3dfeats
  std::string text_encoder = "clip";  // or bert, none

  Index width() const {
    return system == "stmc" ? mdm_smpl.nfeats : system == "mdm" ? mdm.nfeats : motiondiffuse.input_feats;
  }
  Index text_width() const {
    return system == "stmc" ? mdm_smpl.tx_dim : system == "mdm" ? mdm.text_dim : motiondiffuse.clip_dim;
  }
  GaussianDiffusion diffusion() const {
    return schedule == "linear" ? GaussianDiffusion(LinearSchedule{.steps = steps})
                                : GaussianDiffusion(CosineSchedule{.steps = steps});
  }
  FeatureLayout layout() const {
    if (features == "smplrifke") return smplrifke_layout();
    return width() == Guoh3dSlots{21}.size() ? guoh3dfeats_layout(kit_part_of_joint) : guoh3dfeats_layout();
  }
};

struct DiffusionRunOptions {
  FilePath text_encoder = "";  // a folder or a file; looked for beside the model unless given
  FilePath statistics = "";    // a folder with mean and std, .pt or .npy; else that of the model
};

template <Backend B>
using PublishedStmc = Stmc<B, AnyDenoiser<B>, AnyTextEncoder<B>>;

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
  out.mdm_smpl.max_len = std::max(out.mdm_smpl.max_len, out.steps);
  out.fps = r.real("data/motion_loader/fps", 20);
  out.features = "smplrifke";
}

inline void read_mdm(DiffusionRun& out, const RunReader& r) {
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
  const bool text = r.has("embed_text.weight"), action = r.has("embed_action.action_embedding");
  c.condition = text ? MdmCondition::text : action ? MdmCondition::action : MdmCondition::none;
  if (action) c.num_actions = r.size("embed_action.action_embedding", 0);
  if (text) c.text_dim = r.size("embed_text.weight", 1);
  out.text_encoder = !text ? "none" : r.one_of("text_encoder_type", "clip", {"clip", "bert"});
  c.text_sequence = decoder && out.text_encoder == "bert";
  if (decoder && r.flag("emb_trans_dec", false))
    c.class_token = out.text_encoder == "bert" ? MdmClassToken::time_only : MdmClassToken::time_plus_text;
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
}

/// HumanML3D's vector of 22 joints, or KIT's of 21.
inline void read_representation(DiffusionRun& out, const std::string& where) {
  const Index kit = Guoh3dSlots{21}.size(), human = Guoh3dSlots{22}.size();
  if (out.width() != kit && out.width() != human)
    raise<io_error>(404, where, ": motions of ", counted(out.width(), "number"), " a frame, known are ", human,
                    " (HumanML3D) and ", kit, " (KIT-ML)");
  out.features = "guoh3dfeats";
  out.fps = out.width() == kit ? 12.5 : 20;
}

inline RunReader reader_of(const RunFolder& run, const TensorSet& weights) {
  return reader_of(run, weights,
                   run.system == "stmc"  ? "skel_embedding.weight"
                   : run.system == "mdm" ? "input_process.poseEmbedding.weight"
                                         : "joint_embed.weight");
}

/// Tensors that checkpoints hold besides: tables of positions, CLIP, SMPL, optimisers.
inline bool is_beside(std::string_view name) {
  return name.ends_with("sequence_pos_encoder.pe") || begins_with_any(name, {"clip.", "clip_model.", "rot2xyz."});
}

/// Ready for inference.
template <Module M>
void load_denoiser(M& module, const TensorSet& file, const std::string& prefix) {
  const auto beside = [&](const std::string& name) {
    return is_beside(std::string_view(name).substr(prefix.size())) ||
           begins_with_any(name, {"motion_normalizer.", "text_normalizer."});
  };
  load_run_module(module, file, prefix, beside, LoadFor::inference);
}

/// Where a text encoder is looked for, relative to the folder of the model and to the one around it.
inline constexpr const char* clip_places[] = {"text_encoder", "clip", "ViT-B-32.pt", "clip-vit-base-patch32"};
inline constexpr const char* bert_places[] = {"text_encoder", "distilbert-base-uncased"};

inline std::filesystem::path find_text_encoder(const std::filesystem::path& model, const std::string& kind) {
  std::vector<std::string> tried;
  const auto places = kind == "clip" ? std::span<const char* const>(clip_places) : bert_places;
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
                                 : "the folder distilbert-base-uncased",
                  "; looked for ", join_text(tried));
}

/// The vocabulary of a model that has CLIP in its checkpoint.
inline std::filesystem::path clip_vocabulary_of(const std::filesystem::path& model) {
  for (const auto& folder : {model, model / "text_encoder", model / "clip", folder_around(model)}) {
    for (const char* name : clip_vocabularies) {
      if (file_exists(folder / name)) return folder / name;
    }
  }
  raise<io_error>(401, model.string(),
                  ": CLIP is in the checkpoint, its vocabulary is not: put "
                  "bpe_simple_vocab_16e6.txt.gz (of github.com/openai/CLIP) there, or name a text encoder");
}

/// The checkpoint: the entry of the file that holds the model's tensors.
inline WeightFile run_weights(const RunFolder& run) {
  if (run.weights.extension() == ".safetensors") return open_weights(run.weights);  // of ours
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

template <Backend B>
AnyDenoiser<B> make_denoiser(const DiffusionRun& run, const TensorSet& weights) {
  const auto room = room_of(weights);
  NoInit zeros;
  AnyDenoiser<B> out;
  if (run.system == "stmc")
    out.mdm_smpl.emplace(run.mdm_smpl, zeros);
  else if (run.system == "mdm")
    out.mdm.emplace(run.mdm, zeros);
  else
    out.motiondiffuse.emplace(run.motiondiffuse, zeros);
  return out;
}

/// Of a model folder of ours the run that is in it.
inline RunFolder published_run(const RunFolder& run) {
  RunFolder out = run;
  if (run.system == "motionlang") {
    const FileValue* system = run.option("system");
    out.system = system == nullptr ? "" : to_string(*system);
    out.options = options_of_config(run);
  }
  if (out.system != "stmc" && out.system != "mdm" && out.system != "motiondiffuse")
    raise<io_error>(404, run.folder.string(), ": ",
                    out.system.empty() ? "of no system that is known" : "of " + out.system,
                    "; diffusion models are those of stmc, mdm and motiondiffuse");
  if (run.weights.empty())
    raise<io_error>(401, run.folder.string(), ": no checkpoint of ", out.system,
                    " (see weights/run_folder.hpp for its name)");
  return out;
}

template <Backend B>
Normalizer<B> motion_normalizer(const RunFolder& run, const TensorSet& weights, Index width,
                                const DiffusionRunOptions& options) {
  return run_normalizer<B>(
      run, weights, width, {"motion_stats.", "meta.", "stats.", ""},
      concat_text("the motions: put mean and std of the data set there (",
                  run.system == "mdm" ? "Mean.npy and Std.npy, in HumanML3D's own folder" : "meta/mean.npy and std.npy",
                  "), or name their folder"),
      options.statistics);
}

/// Of STMC; the others have none.
template <Backend B>
std::optional<Normalizer<B>> text_normalizer(const RunFolder& run, const TensorSet& weights,
                                             const DiffusionRun& about) {
  if (about.system != "stmc") return std::nullopt;
  if (auto packed = find_normalizer<B>(weights, about.text_width(), {"text_normalizer."})) return packed;
  return folder_normalizer<B>(run, about.text_width(), {"text_stats."},
                              "the texts: text_stats/mean.pt and std.pt are missing");
}

template <Backend B>
AnyTextEncoder<B> encoder_of(const RunFolder& run, const TensorSet& weights, const DiffusionRun& about,
                             const DiffusionRunOptions& options) {
  if (about.text_encoder == "none")
    raise<io_error>(404, run.folder.string(),
                    ": a model without texts: actions and unconditional motions are not supported");
  if (about.text_encoder == "bert" && !about.mdm.text_sequence)
    raise<io_error>(404, run.folder.string(), ": texts of DistilBERT without a decoder (trans_dec)");
  const bool motiondiffuse = about.system == "motiondiffuse";
  const TextEncoderOptions wanted = about.text_encoder == "bert" ? TextEncoderOptions{}
                                    : motiondiffuse              ? clip_states()
                                    : about.system == "mdm"      ? clip_sentences(22)
                                                                 : clip_sentences();
  const std::string named = options.text_encoder.string();
  if (named.empty() && motiondiffuse && weights.find("clip.token_embedding.weight") != nullptr)
    return load_clip_encoder<B>(weights, clip_vocabulary_of(run.folder).parent_path(), wanted);
  auto encoder = load_text_encoder<B>(
      named.empty() ? FilePath(find_text_encoder(run.folder, about.text_encoder)) : options.text_encoder, wanted);
  if (const bool clip = encoder.network.is_clip(); clip != (about.text_encoder == "clip"))
    raise<config_error>(102, run.folder.string(), ": needs ", about.text_encoder == "clip" ? "CLIP" : "DistilBERT",
                        " as its text encoder, ", named, " is ", clip ? "CLIP" : "of the BERT family");
  return encoder;
}

}  // namespace detail

/// What options and tensors say of a run of stmc, mdm or motiondiffuse.
inline DiffusionRun diffusion_run(const RunFolder& run, const TensorSet& weights) {
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

/// A model that is ready to generate.
template <Backend B>
PublishedStmc<B> load_diffusion_run(const RunFolder& given, const DiffusionRunOptions& options = {}) {
  const RunFolder run = detail::published_run(given);
  const WeightFile weights = detail::run_weights(run);
  const DiffusionRun about = diffusion_run(run, weights);
  const bool stmc = about.system == "stmc";
  Normalizer<B> motion = detail::motion_normalizer<B>(run, weights, about.width(), options);
  AnyTextEncoder<B> encoder = detail::encoder_of<B>(run, weights, about, options);
  auto text = detail::text_normalizer<B>(run, weights, about);
  AnyDenoiser<B> denoiser = detail::make_denoiser<B>(about, weights);
  if (denoiser.mdm_smpl) detail::load_denoiser(*denoiser.mdm_smpl, weights, about.prefix);
  if (denoiser.mdm) detail::load_denoiser(*denoiser.mdm, weights, about.prefix);
  if (denoiser.motiondiffuse) detail::load_denoiser(*denoiser.motiondiffuse, weights, about.prefix);
  return {.denoiser = std::move(denoiser),
          .text_encoder = std::move(encoder),
          .motion_normalizer = std::move(motion),
          .text_normalizer = text ? std::move(*text) : Normalizer<B>::identity(about.text_width()),
          .diffusion = about.diffusion(),
          .layout = about.layout(),
          .guidance = about.system == "motiondiffuse" ? 1.0 : 2.5,
          .sampling = {.noise_scale = stmc ? NoiseScale::posterior_variance : NoiseScale::posterior_std},
          .fps = about.fps};
}
template <Backend B>
PublishedStmc<B> load_diffusion_run(const FilePath& folder, const DiffusionRunOptions& options = {}) {
  return load_diffusion_run<B>(find_run(folder), options);
}

MOTIONLANG_NAMESPACE_END
