// SPDX-License-Identifier: MIT
/// A trained TEMOS, TMR, SINC or TEACH with everything that belongs to it: word pieces if it has no language model,
/// statistics of the features, its configuration. How to make it, and its folder.
///
///     config.json            weights/model_folder.hpp, with the configuration of the training; "vocabulary" of word
///                            pieces; "similarity", the scale of a TMR (metrics/similarity_scale.hpp); "about"
///     weights.safetensors    the published names, words.embedding.weight, motion_normalizer.mean,
///                            motion_normalizer.std, log_temperature; textencoder.text_model.* of a DistilBERT that was
///                            trained with it, as in TEMOS; words.vectors.* of a model with vectors of words
///                            (weights/word_vector_file.hpp)
///     text_encoder/          its config.json and tokenizer
///
///     const auto file = read_text_motion_config(folder);         // also of a published TMR
///     const auto model = load_text_motion<Tmr, B>(folder, file);
///     model.system.encode_text(model.tokens(texts, nullptr));    // &states, unless model.reads_texts()
///
/// A published TMR has HumanML3D's features, the states of DistilBERT, statistics in stats/mean.pt and stats/std.pt.
#pragma once

#include <cmath>       // log
#include <filesystem>  // folders
#include <memory>      // tokenizers
#include <optional>    // what a model may lack

#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/file/fields_json.hpp>
#include <motionlang/metrics/similarity_scale.hpp>
#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/teach.hpp>
#include <motionlang/systems/temos.hpp>
#include <motionlang/systems/tmr.hpp>
#include <motionlang/text/word_piece_tokens.hpp>
#include <motionlang/weights/babel_config.hpp>
#include <motionlang/weights/embedding_cache.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>
#include <motionlang/weights/text_motion_config.hpp>
#include <motionlang/weights/text_motion_file.hpp>
#include <motionlang/weights/trained_model.hpp>
#include <motionlang/weights/weight_file.hpp>
#include <motionlang/weights/word_vector_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The files that a DistilBERT needs besides its weights.
struct LanguageModelFiles {
  static constexpr bool is_option = true;
  std::filesystem::path folder;
  BertConfig sizes;
  std::shared_ptr<const AnyTokenizer> tokenizer;
};
/// From config.json and the tokenizer of a folder. Throws io_error 401, config_error 103 for another network, 102 if
/// they do not fit.
LanguageModelFiles read_language_model_files(const std::filesystem::path& folder);
/// Copies all but the weights into a folder, which is made. Throws io_error 401.
void write_language_model_files(const std::filesystem::path& folder, const LanguageModelFiles& files);

/// A DistilBERT that is trained with the model.
template <Backend B>
struct LanguageModel {
  DistilBert<B> text_model;
  LanguageModelFiles files;

  static constexpr auto fields() {
    using M = LanguageModel;
    return motionlang::fields("text_model", &M::text_model, "files", &M::files);
  }
  LanguageModel() = default;
  /// Without values, which are in a file.
  explicit LanguageModel(LanguageModelFiles f) : files(std::move(f)) {
    NoInit zeros;
    text_model = DistilBert<B>(files.sizes, zeros);
  }

  Sequences<B> operator()(std::span<const std::string> texts, const Context& context) const {
    return text_model(tokenize(*files.tokenizer, texts), context).tokens;
  }
};
/// A folder of Hugging Face. Throws what the readers throw.
template <Backend B>
LanguageModel<B> read_language_model(const std::filesystem::path& folder) {
  LanguageModel<B> m;
  m.files = read_language_model_files(folder);
  m.text_model = load_text_network<DistilBert<B>>(m.files.sizes, open_weights(folder));
  return m;
}

template <Backend B, template <class> class System>
struct TextMotionModel {
  System<B> system;
  std::optional<WordPieceTokens<B>> words{};
  std::optional<LanguageModel<B>> language{};
  Normalizer<B> motion_normalizer;
  std::optional<Tensor<B, 0>> log_temperature{};  // of the contrastive loss, if it is learned

  static constexpr auto fields() {
    using M = TextMotionModel;
    return motionlang::fields("", &M::system, "words", &M::words, "textencoder", &M::language, "motion_normalizer",
                              &M::motion_normalizer, "log_temperature", &M::log_temperature);
  }
  static std::string official_key(const std::string& path) {
    if constexpr (requires { System<B>::official_key(path); })
      return System<B>::official_key(path);
    else
      return path;
  }

  /// True if it needs no states of a language model.
  bool reads_texts() const { return words || language; }
  /// The input of the text encoder: rows of word pieces, or the states of a language model. They come from its own one,
  /// or from `states`, which has all texts.
  Sequences<B> tokens(std::span<const std::string> texts, const EmbeddingCache* states,
                      const Context& context = {}) const {
    if (words) return (*words)(texts, context).tokens;
    if (language) return (*language)(texts, context);
    if (states == nullptr)
      raise<config_error>(102, "this model reads the states of a language model: `text_encoder` names it");
    return states->encode<B>(texts).tokens;
  }
};

template <Backend B>
using TmrModel = TextMotionModel<B, Tmr>;
template <Backend B>
using TemosModel = TextMotionModel<B, Temos>;

/// The differences between the systems that are trained here.
///   name            in config.json
///   Config          the configuration of the training
///   sizes           of the network. Throws config_error 101, 102, 103 for invalid sizes and options.
///   normalizer_eps  of the statistics
///   temperature     of the contrastive loss, if it is learned
///   published       true if a published folder may be read instead of one of ours
template <template <class> class System>
struct TrainedSystem;

template <>
struct TrainedSystem<Tmr> {
  using Config = TextMotionConfig;
  static constexpr const char* name = "tmr";
  static constexpr double normalizer_eps = 1e-12;
  static constexpr bool published = true;
  static TmrConfig sizes(const Config& c, Index width);
  static std::optional<double> temperature(const Config& c) {
    return c.losses.learned_temperature ? std::optional(c.losses.temperature) : std::nullopt;
  }
};
template <>
struct TrainedSystem<Temos> {
  using Config = TextMotionConfig;
  static constexpr const char* name = "temos";
  static constexpr double normalizer_eps = 1e-12;
  static constexpr bool published = false;
  static TemosConfig sizes(const Config& c, Index width);
  static std::optional<double> temperature(const Config&) { return {}; }
};
template <>
struct TrainedSystem<Sinc> {
  using Config = SincTrainingConfig;
  static constexpr const char* name = "sinc";
  static constexpr double normalizer_eps = sinc_eps;
  static constexpr bool published = false;
  static SincConfig sizes(const Config& c, Index width);
  static std::optional<double> temperature(const Config&) { return {}; }
};
template <>
struct TrainedSystem<Teach> {
  using Config = TeachTrainingConfig;
  static constexpr const char* name = "teach";
  static constexpr double normalizer_eps = 1e-12;
  static constexpr bool published = false;
  static TeachConfig sizes(const Config& c, Index width);
  static std::optional<double> temperature(const Config&) { return {}; }
};

/// New weights, with statistics that change nothing. Throws what TrainedSystem::sizes throws.
template <template <class> class System, Backend B>
TextMotionModel<B, System> make_text_motion(const typename TrainedSystem<System>::Config& c, Index width,
                                            std::optional<WordPiece> pieces, const Philox& rng,
                                            WordVectors vectors = {}) {
  using Trained = TrainedSystem<System>;
  TextMotionModel<B, System> m;
  auto init = rng.split("system"), words = rng.split("words");
  const auto sizes = Trained::sizes(c, width);
  if (const auto temperature = Trained::temperature(c)) m.log_temperature = Tensor<B, 0>(std::log(*temperature));
  m.system = System<B>(sizes, init);
  if (pieces) m.words.emplace(std::move(*pieces), c.text.width, words, std::move(vectors), c.text.hidden_words);
  m.motion_normalizer = Normalizer<B>::identity(width);
  m.motion_normalizer.eps = Trained::normalizer_eps;
  return m;
}

/// The contents of config.json.
template <class Config>
struct TextModelFile {
  std::string system;
  double fps = 0;
  Config config;
  std::optional<WordPiece> pieces;
  std::optional<LanguageModelFiles> language{};  // of the trained language model
  std::optional<RunFolder> published{};          // for a published folder
  SimilarityScale similarity{};                  // of a TMR; empty if the file has none
};

/// As config.json has it.
nlohmann::ordered_json similarity_json(const SimilarityScale& scale);
/// Throws config_error 107 for missing members, and for shares and cosines that do not ascend.
SimilarityScale read_similarity(const JsonView& view);

using TextMotionFile = TextModelFile<TextMotionConfig>;

/// Reads the contents of an open config.json; `path` appears in messages. Throws config_error 101, 103, 107, io_error
/// 403.
template <class Config>
TextModelFile<Config> text_model_file(const ModelFolder& model, const std::string& path) {
  TextModelFile<Config> file{model.system, model.fps, {}, {}};
  const nlohmann::json config = model.config, others = model.others;
  read_config(file.config, JsonView(config, path + ": config"));
  if (others.contains("vocabulary")) {
    const JsonView view(others, path);
    file.pieces = WordPiece(view["vocabulary"].as<std::vector<std::string>>(), path + ": vocabulary");
  }
  if (others.contains("similarity")) file.similarity = read_similarity(JsonView(others, path)["similarity"]);
  return file;
}
/// Reads that of a TMR or a TEMOS of our training, or of a published TMR. Throws io_error 401, 403, config_error 103,
/// 107.
TextMotionFile read_text_motion_config(const std::filesystem::path& folder);
/// Reads that of a SINC or a TEACH of our training. Throws io_error 401, 403, config_error 101, 103, 107.
template <class Config>
TextModelFile<Config> read_babel_config(const std::filesystem::path& folder) {
  return text_model_file<Config>(read_model_folder(folder), (folder / "config.json").string());
}

namespace detail {
/// The beginning of the names of the tensors of word vectors, which are constants.
inline constexpr const char* word_vector_tensors = "words.vectors.";

/// Those beside the weights, if there are any. Throws what listed_word_vectors throws.
WordVectors word_vectors_of(const WeightFile& weights);
/// Fills a model, except its vectors of words. Throws what load_module throws.
template <Module M>
void load_text_motion_tensors(M& model, const TensorSet& weights) {
  KeyReport report = load_module_partly(model, weights);
  std::erase_if(report.unexpected, [](const std::string& name) { return name.starts_with(word_vector_tensors); });
  if (!report.missing.empty() || !report.unexpected.empty()) raise_key_mismatch(weights.name(), report);
}
}  // namespace detail

/// Writes config.json and weights.safetensors over the existing ones. `about`: license and provenance, which are
/// required, data, command, ... Throws what overwrite_model throws.
/// similarity  null: none
template <template <class> class System, Backend B>
void save_text_motion(const std::filesystem::path& folder, const TextMotionModel<B, System>& model,
                      const typename TrainedSystem<System>::Config& config, double fps,
                      const std::map<std::string, std::string>& about, const SimilarityScale* similarity = nullptr) {
  TensorStore store;
  store.add_module(model);
  auto description = described_model(TrainedSystem<System>::name, about);
  description.features = config.features;
  description.fps = fps;
  description.text_encoder = config.text.encoder;
  description.config = config_json(config);
  if (model.words) description.others["vocabulary"] = model.words->tokenizer.vocabulary();
  if (similarity != nullptr && !similarity->empty()) description.others["similarity"] = similarity_json(*similarity);
  if (model.language) write_language_model_files(folder / "text_encoder", model.language->files);
  const WordVectors none, &vectors = model.words ? model.words->vectors : none;
  const ModelWordVectors words{vectors, detail::word_vector_tensors};
  overwrite_model(folder, description, store, &words);
}
/// Throws what the readers throw; io_error 401 if there are no statistics, config_error 102 for features of another
/// width.
template <Backend B>
TmrModel<B> load_published_tmr(const TensorSet& weights, const RunFolder& run, const MotionFeatures& features) {
  TmrModel<B> m;
  m.system = tmr_network<B>(weights, run);
  const Index width = m.system.config.motion_nfeats;
  if (width != features.width)
    raise<config_error>(102, run.folder.string(), ": a model of features of ", counted(width, "number"), ", '",
                        features.name, "' has ", features.width);
  auto statistics = detail::find_normalizer<B>(weights, width, {"stats.", ""});
  if (!statistics)
    raise<io_error>(401, run.folder.string(), ": no statistics of the motions: stats/mean.pt and std.pt are missing");
  m.motion_normalizer = std::move(*statistics);
  prepare(m);
  return m;
}
/// The model with the weights of an open file. Throws what the readers throw; config_error 102 for one of another
/// system.
template <template <class> class System, Backend B>
TextMotionModel<B, System> load_text_motion(const WeightFile& weights,
                                            const TextModelFile<typename TrainedSystem<System>::Config>& file) {
  using Trained = TrainedSystem<System>;
  if (file.system != Trained::name)
    raise<config_error>(102, weights.name(), ": a model of ", file.system, ", not ", Trained::name);
  const MotionFeatures& features = motion_features(file.config.features);
  if constexpr (Trained::published) {
    if (file.published) return load_published_tmr<B>(weights, *file.published, features);
  }
  const auto room = detail::room_of(weights);
  auto model =
      make_text_motion<System, B>(file.config, features.width, file.pieces, Philox{}, detail::word_vectors_of(weights));
  if (file.language) model.language.emplace(*file.language);
  detail::load_text_motion_tensors(model, weights);
  prepare(model);
  return model;
}
/// The model of a folder.
template <template <class> class System, Backend B>
TextMotionModel<B, System> load_text_motion(const std::filesystem::path& folder,
                                            const TextModelFile<typename TrainedSystem<System>::Config>& file) {
  return load_text_motion<System, B>(open_weights(folder), file);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/text_motion_model.ipp>
#endif
