// A trained TEMOS or TMR with what belongs to it: word pieces where it has no language model, statistics of the
// features, its configuration. How it is made, and its folder.
//
//     config.json            weights/model_folder.hpp, with the configuration of the training; "vocabulary" of word
//                            pieces; "about"
//     weights.safetensors    the published names, words.embedding.weight, motion_normalizer.mean,
//                            motion_normalizer.std, log_temperature; textencoder.text_model.* of a DistilBERT that was
//                            trained with it, as in TEMOS
//     text_encoder/          its config.json and tokenizer
//
// And TMR as it was published: HumanML3D's features, the states of DistilBERT, statistics in stats/mean.pt and
// stats/std.pt.
#pragma once

#include <filesystem>
#include <optional>

#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/systems/temos.hpp>
#include <motionlang/systems/tmr.hpp>
#include <motionlang/text/word_piece_tokens.hpp>
#include <motionlang/weights/embedding_cache.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>
#include <motionlang/weights/text_motion_file.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "model_description.hpp"
#include "text_motion_config.hpp"

namespace program {

/// What a DistilBERT needs besides its weights.
struct LanguageModelFiles {
  std::filesystem::path folder;
  ml::BertConfig sizes;
  std::shared_ptr<const ml::AnyTokenizer> tokenizer;
};
/// From config.json and the tokenizer of a folder. Throws io_error 401, config_error 103 for another network, 102 if
/// they do not fit.
LanguageModelFiles read_language_model_files(const std::filesystem::path& folder);
/// Copies all but the weights into a folder, which is made. Throws io_error 401.
void write_language_model_files(const std::filesystem::path& folder, const LanguageModelFiles& files);

/// DistilBERT that is trained with the model.
template <ml::Backend B>
struct LanguageModel {
  ml::DistilBert<B> text_model;
  LanguageModelFiles files;

  static constexpr auto fields() {
    using M = LanguageModel;
    return ml::fields("text_model", &M::text_model, "files", &M::files);
  }
  LanguageModel() = default;
  /// Without numbers; they are in a file.
  explicit LanguageModel(LanguageModelFiles f) : files(std::move(f)) {
    ml::NoInit zeros;
    text_model = ml::DistilBert<B>(files.sizes, zeros);
  }

  ml::Sequences<B> operator()(std::span<const std::string> texts, const ml::Context& context) const {
    return text_model(ml::tokenize(*files.tokenizer, texts), context).tokens;
  }
};
/// A folder of Hugging Face. Throws what the readers throw.
template <ml::Backend B>
LanguageModel<B> read_language_model(const std::filesystem::path& folder) {
  LanguageModel<B> m;
  m.files = read_language_model_files(folder);
  m.text_model = ml::load_text_network<ml::DistilBert<B>>(m.files.sizes, ml::open_weights(folder));
  return m;
}

template <ml::Backend B, template <class> class System>
struct TextMotionModel {
  System<B> system;
  std::optional<ml::WordPieceTokens<B>> words{};
  std::optional<LanguageModel<B>> language{};
  ml::Normalizer<B> motion_normalizer;
  std::optional<ml::Tensor<B, 0>> log_temperature{};  // of the contrastive loss, where it is learned

  static constexpr auto fields() {
    using M = TextMotionModel;
    return ml::fields("", &M::system, "words", &M::words, "textencoder", &M::language, "motion_normalizer",
                      &M::motion_normalizer, "log_temperature", &M::log_temperature);
  }
  static std::string official_key(const std::string& path) {
    if constexpr (requires { System<B>::official_key(path); })
      return System<B>::official_key(path);
    else
      return path;
  }

  /// Whether it needs no states of a language model.
  bool reads_texts() const { return words || language; }
  /// What the text encoder reads: rows of word pieces, or the states of a language model: its own, or `states`, which
  /// has all texts.
  ml::Sequences<B> tokens(std::span<const std::string> texts, const ml::EmbeddingCache* states,
                          const ml::Context& context = {}) const {
    if (words) return (*words)(texts).tokens;
    if (language) return (*language)(texts, context);
    if (states == nullptr)
      ml::raise<ml::config_error>(102, "this model reads the states of a language model: --text-encoder names it");
    return states->encode<B>(texts).tokens;
  }
};

/// Word pieces among the settings of a training, if there are some.
template <ml::Backend B>
void add_pieces(std::map<std::string, std::string>& settings, const std::optional<ml::WordPieceTokens<B>>& words) {
  if (!words) return;
  std::string& pieces = settings["text.pieces"];
  for (const auto& p : words->tokenizer.vocabulary()) pieces += p + "\n";
}

template <ml::Backend B>
using TmrModel = TextMotionModel<B, ml::Tmr>;
template <ml::Backend B>
using TemosModel = TextMotionModel<B, ml::Temos>;

template <template <class> class System>
constexpr const char* system_name() {
  return std::is_same_v<System<ml::EigenBackend<float>>, ml::Tmr<ml::EigenBackend<float>>> ? "tmr" : "temos";
}

inline ml::TemosNetwork temos_network(const std::string& name, const char* key) {
  if (name == "transformer") return ml::TemosNetwork::transformer;
  if (name == "gru") return ml::TemosNetwork::gru;
  if (name == "none") return ml::TemosNetwork::none;
  ml::raise<ml::config_error>(103, key, " '", name, "' is not transformer, gru or none");
}

/// New weights. Throws config_error 101, 102, 103 for sizes and options that cannot be.
template <template <class> class System, ml::Backend B>
TextMotionModel<B, System> make_text_motion(const TextMotionConfig& c, ml::Index width,
                                            std::optional<ml::WordPiece> pieces, const ml::Philox& rng) {
  TextMotionModel<B, System> m;
  auto init = rng.split("system"), words = rng.split("words");
  const auto& n = c.network;
  if constexpr (std::is_same_v<System<B>, ml::Tmr<B>>) {
    if (n.motion_encoder != "transformer" || n.motion_decoder != "transformer")
      ml::raise<ml::config_error>(102, "TMR has transformers; network.motion_encoder and motion_decoder are of TEMOS");
    if (c.losses.learned_temperature) m.log_temperature = ml::Tensor<B, 0>(std::log(c.losses.temperature));
    m.system = System<B>({.motion_nfeats = width,
                          .text_nfeats = c.text.width,
                          .latent_dim = n.latent_dim,
                          .ff_size = n.ff_size,
                          .num_layers = n.num_layers,
                          .num_heads = n.num_heads,
                          .dropout = n.dropout,
                          .activation = ml::parse_activation(n.activation),
                          .vae = n.vae},
                         init);
  } else {
    m.system = System<B>({.nfeats = width,
                          .text_dim = c.text.width,
                          .latent_dim = n.latent_dim,
                          .ff_size = n.ff_size,
                          .num_layers = n.num_layers,
                          .num_heads = n.num_heads,
                          .dropout = n.dropout,
                          .activation = ml::parse_activation(n.activation),
                          .vae = n.vae,
                          .motion_encoder = temos_network(n.motion_encoder, "network.motion_encoder"),
                          .motion_decoder = temos_network(n.motion_decoder, "network.motion_decoder")},
                         init);
  }
  if (pieces) m.words.emplace(std::move(*pieces), c.text.width, words);
  m.motion_normalizer = ml::Normalizer<B>::identity(width);
  return m;
}

/// How clips become rows of features that the library names.
inline RowMaker row_maker(const std::string& features) {
  const ml::MotionFeatures& f = ml::motion_features(features);
  return {std::string(f.name), f.width, f.fps, f.from_motion};
}

/// What config.json says.
template <class Config>
struct TextModelFile {
  std::string system;
  double fps = 0;
  Config config;
  std::optional<ml::WordPiece> pieces;
  std::optional<LanguageModelFiles> language{};  // that was trained with it
  std::optional<ml::RunFolder> published{};      // where it is not of our training
};
using TextMotionFile = TextModelFile<TextMotionConfig>;

/// Of a config.json that somebody has read; `path` stands in messages. Throws config_error 101, 103, 107, io_error 403.
template <class Config>
TextModelFile<Config> text_model_file(const ml::ModelFolder& model, const std::string& path) {
  TextModelFile<Config> file{model.system, model.fps, {}, {}};
  const nlohmann::json config = model.config, others = model.others;
  read_config(file.config, ml::JsonView(config, path + ": config"));
  if (others.contains("vocabulary")) {
    const ml::JsonView view(others, path);
    file.pieces = ml::WordPiece(view["vocabulary"].as<std::vector<std::string>>(), path + ": vocabulary");
  }
  return file;
}
/// Of a folder of train-tmr or train-temos, or of a published TMR. Throws io_error 401, 403, config_error 103, 107.
TextMotionFile read_text_motion_config(const std::filesystem::path& folder);

/// Writes config.json and weights.safetensors, over those that are there. `about`: license, provenance, data, command,
/// ...
template <template <class> class System, ml::Backend B, class Config>
void save_text_motion(const std::filesystem::path& folder, const TextMotionModel<B, System>& model,
                      const Config& config, double fps, const std::map<std::string, std::string>& about) {
  ml::TensorStore store;
  store.add_module(model);
  auto description = described_model(system_name<System>(), about);
  description.features = config.features;
  description.fps = fps;
  description.text_encoder = config.text.encoder;
  description.config = config_json(config);
  if (model.words) description.others["vocabulary"] = model.words->tokenizer.vocabulary();
  if (model.language) write_language_model_files(folder / "text_encoder", model.language->files);
  overwrite_model(folder, description, store);
}
/// Throws what the readers throw; io_error 401 if there are no statistics, config_error 102 for features of another
/// width.
template <ml::Backend B>
TmrModel<B> load_published_tmr(const ml::TensorSet& weights, const ml::RunFolder& run,
                               const ml::MotionFeatures& features) {
  TmrModel<B> m;
  m.system = ml::load_tmr<B>(weights, run);
  const ml::Index width = m.system.config.motion_nfeats;
  if (width != features.width)
    ml::raise<ml::config_error>(102, run.folder.string(), ": a model of features of ", ml::counted(width, "number"),
                                ", '", features.name, "' has ", features.width);
  auto statistics = ml::detail::find_normalizer<B>(weights, width, {"stats.", ""});
  if (!statistics)
    ml::raise<ml::io_error>(401, run.folder.string(),
                            ": no statistics of the motions: stats/mean.pt and std.pt are missing");
  m.motion_normalizer = std::move(*statistics);
  ml::prepare(m);
  return m;
}
/// The model with weights of a file that somebody has opened. Throws what the readers throw; config_error 102 for one
/// of the other system.
template <template <class> class System, ml::Backend B>
TextMotionModel<B, System> load_text_motion(const ml::TensorSet& weights, const TextMotionFile& file) {
  if (file.system != system_name<System>())
    ml::raise<ml::config_error>(102, weights.name(), ": a model of ", file.system, ", not ", system_name<System>());
  if constexpr (std::is_same_v<System<B>, ml::Tmr<B>>) {
    if (file.published)
      return load_published_tmr<B>(weights, *file.published, ml::motion_features(file.config.features));
  }
  const auto room = ml::detail::room_of(weights);
  auto model = make_text_motion<System, B>(file.config, ml::motion_features(file.config.features).width, file.pieces,
                                           ml::Philox{});
  if (file.language) model.language.emplace(*file.language);
  ml::load_module(model, weights);
  ml::prepare(model);
  return model;
}
/// The model of a folder.
template <template <class> class System, ml::Backend B>
TextMotionModel<B, System> load_text_motion(const std::filesystem::path& folder, const TextMotionFile& file) {
  return load_text_motion<System, B>(ml::open_weights(folder), file);
}

}  // namespace program
