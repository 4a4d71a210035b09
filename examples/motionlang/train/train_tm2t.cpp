// motionlang train-tm2t: motions as words, motions to texts, texts to motions; a stage at a time.
#include <motionlang/weights/tm2t_run.hpp>

#include "../usage_error.hpp"
#include "model_description.hpp"
#include "text_motion_model.hpp"
#include "tm2t_task.hpp"
#include "training_command.hpp"

namespace program {

namespace {

using B = TrainingBackend;

struct Options {
  TrainingOptions common;
  Tm2tStage stage = Tm2tStage::tokenizer;
  CaptionOptions texts;
  std::filesystem::path statistics, tokenizer, describer, words;
};

/// What a stage has trained with what was trained before: a folder as `pack` makes it, which generate and describe
/// read.
struct Tm2tModel {
  const ml::MotionTokenizer<B>& tokenizer;
  const ml::Normalizer<B>& statistics;
  const ml::GloVe* words = nullptr;
  const ml::Seq2SeqTransformer<B>* describer = nullptr;
  const ml::Seq2SeqGru<B>* writer = nullptr;
};

void save_tm2t(const Options& o, const Tm2tTrainingConfig& config, const DescribedMotions& data, const Tm2tModel& m) {
  const auto folder = o.common.run.out / "model";
  ml::TensorStore store;
  store.add_module(m.tokenizer);
  store.add_module(m.statistics, "motion_normalizer.");
  if (m.describer != nullptr) store.add_module(*m.describer, "m2t_transformer.");
  if (m.writer != nullptr) store.add_module(*m.writer, "t2m_model.");
  auto model = described_model("tm2t", about(o.common, data));
  model.features = "guoh3dfeats";
  model.fps = data.fps;
  model.text_encoder = m.words != nullptr ? "glove" : "";
  if (m.describer != nullptr)
    model.config["n_head"] = m.describer->encoder.layer_stack.at(0).slf_attn.heads;  // which no tensor shows
  model.others["training"] = config_json(config);
  if (m.words != nullptr) {
    std::filesystem::create_directories(folder / "text_encoder");
    ml::write_glove(folder / "text_encoder/our_vab", *m.words);
  }
  overwrite_model(folder, model, store);
  tell_results(o.common, folder);
}

/// The folder that an option names, which this stage needs.
const std::filesystem::path& needed(const std::filesystem::path& folder, const char* option, const char* what) {
  if (folder.empty()) ml::raise<usage_error>(102, option, " is required: the folder of ", what);
  return folder;
}

/// What the stages behind the tokenizer go on from, except the motions.
std::optional<TokenizedData> models_before(const Options& o, const Tm2tTrainingConfig& config) {
  if (o.stage == Tm2tStage::tokenizer) return std::nullopt;
  ml::GloVe words({"sos", "eos", "unk"}, std::vector<float>(3), 1);
  if (!o.words.empty()) words = ml::read_glove(o.words / "our_vab");
  if (o.stage == Tm2tStage::text_to_motion && config.text_to_motion.alignment) {
    const auto& folder = needed(o.describer, "--describer",
                                "a model from motions to texts, for inverse alignment "
                                "(--set text_to_motion.alignment=false: without)");
    auto run = ml::load_tm2t_describer<B>(ml::find_run(folder),
                                          {.tokenizer = o.tokenizer.string(), .words = o.words.string()});
    return TokenizedData{std::move(run.model), std::move(run.words)};
  }
  return TokenizedData{
      ml::load_tm2t_tokenizer<B>(ml::find_run(needed(o.tokenizer, "--tokenizer", "a motion tokenizer"))),
      std::move(words)};
}

void run(const Options& o) {
  DataSources sources = o.texts.sources(o.common);
  auto config = tm2t_preset(o.common.preset, o.stage);
  if (const std::string found = ready_made_features(sources); !found.empty()) config.features = found;
  if (!configure(config, o.common)) return;
  auto before = models_before(o, config);
  if (before)
    config.features = before->model.statistics.mean.size(0) == 251 ? "kit" : "guoh3d";  // what the tokenizer reads
  const auto data = read_data(o.common, sources, config.data, row_maker(config.features));
  if (!before) {
    Trainer trainer(TokenizerTask(config, data, tm2t_statistics(data, o.statistics, config.tokenizer.feature_bias)));
    trainer.run(o.common.run, [] {});
    return save_tm2t(o, config, data, {trainer.task().result(), trainer.task().statistics()});
  }
  const bool drawn_words = o.words.empty() && before->model.m2t_transformer.encoder.layer_stack.empty();
  if (drawn_words)
    before->words =
        words_of(data, config.text_to_motion.word_width, ml::Philox{.seed = config.optimiser.seed}.split("words"));
  {
    ProgressBar bar("tokenizing");
    before->tokenize(data, bar);
  }
  std::printf("%s, %s\n", ml::counted(before->words.size(), "word").c_str(),
              ml::counted(before->model.vocabulary().codes, "motion token").c_str());
  const ml::Tm2t<B>& known = before->model;
  if (o.stage == Tm2tStage::motion_to_text) {
    Trainer trainer(DescriberTask(config, data, *before));
    trainer.run(o.common.run, [] {});
    return save_tm2t(o, config, data, {known.tokenizer, known.statistics, &before->words, &trainer.task().result()});
  }
  Trainer trainer(WriterTask(config, data, *before));
  trainer.run(o.common.run, [] {});
  const bool describes = config.text_to_motion.alignment;
  save_tm2t(o, config, data,
            {known.tokenizer, known.statistics, &before->words, describes ? &known.m2t_transformer : nullptr,
             &trainer.task().result()});
}

}  // namespace

void add_train_tm2t(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand("train-tm2t",
                                   "Trains TM2T, which describes motions and makes them from texts, a stage at a time; "
                                   "Ctrl-C saves, the same command goes on");
  const std::map<std::string, Tm2tStage> stages{{"tokenizer", Tm2tStage::tokenizer},
                                                {"motion-to-text", Tm2tStage::motion_to_text},
                                                {"text-to-motion", Tm2tStage::text_to_motion}};
  c->add_option("--stage", o->stage, "tokenizer (motions as words), then motion-to-text, then text-to-motion")
      ->required()
      ->transform(CLI::CheckedTransformer(stages).description("tokenizer, motion-to-text or text-to-motion"));
  add_training_options(*c, o->common, {"tm2t-published", "tm2t-published-kit", "small"});
  o->texts.add_to(*c);
  c->add_option("--statistics", o->statistics,
                "Of the tokenizer: folder with Mean.npy and Std.npy of the features; those of the motions to train on "
                "unless given")
      ->check(CLI::ExistingDirectory);
  c->add_option("--tokenizer", o->tokenizer,
                "Of the other stages: folder of the tokenizer, of the first stage or as published")
      ->check(CLI::ExistingDirectory);
  c->add_option("--describer", o->describer,
                "Of text-to-motion: folder of motion-to-text, or M2T_... as published, for inverse alignment; its "
                "words and, unless "
                "--tokenizer names it, its tokenizer are taken")
      ->check(CLI::ExistingDirectory);
  c->add_option("--text-encoder", o->words,
                "Folder of word vectors (our_vab_data.npy ...); the words of the texts, with vectors that are drawn, "
                "unless given")
      ->check(CLI::ExistingDirectory);
  c->callback([o] { run(*o); });
}

}  // namespace program
