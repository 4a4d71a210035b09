// motionlang train-tm2t: motions as tokens, motions to texts, texts to motions; one stage at a time.
#include <cstdio>
#include <map>
#include <optional>

#include <motionlang/train/tm2t_describer_training.hpp>
#include <motionlang/train/tm2t_tokenizer_training.hpp>
#include <motionlang/train/tm2t_transformer_training.hpp>
#include <motionlang/train/tm2t_writer_training.hpp>
#include <motionlang/weights/tm2t_run.hpp>

#include "../usage_error.hpp"
#include "training_command.hpp"

namespace program {

namespace {

using B = TrainingBackend;

struct Options {
  TrainingOptions common;
  ml::Tm2tStage stage = ml::Tm2tStage::tokenizer;
  CaptionOptions texts;
  std::filesystem::path statistics, tokenizer, describer, words;
};

/// The folder from an option that this stage needs.
const std::filesystem::path& needed(const std::filesystem::path& folder, const char* option, const char* what) {
  if (folder.empty()) ml::raise<usage_error>(102, option, " is required: the folder of ", what);
  return folder;
}

/// The models and words that the stages after the tokenizer start from. None for the tokenizer itself.
std::optional<ml::TokenizedData<B>> models_before(const Options& o, const ml::Tm2tTrainingConfig& config) {
  if (o.stage == ml::Tm2tStage::tokenizer) return std::nullopt;
  ml::GloVe words({"sos", "eos", "unk"}, std::vector<float>(3), 1);
  if (!o.words.empty()) words = ml::read_glove(o.words / "our_vab");
  if (o.stage == ml::Tm2tStage::text_to_motion && config.text_to_motion.aligned()) {
    const auto& folder = needed(o.describer, "--describer",
                                "a model from motions to texts, for inverse alignment "
                                "(--set text_to_motion.alignment=false: without)");
    auto run = ml::load_tm2t_describer<B>(ml::find_run(folder),
                                          {.tokenizer = o.tokenizer.string(), .words = o.words.string()});
    return ml::TokenizedData<B>{std::move(run.model), std::move(run.words)};
  }
  return ml::TokenizedData<B>{
      ml::load_tm2t_tokenizer<B>(ml::find_run(needed(o.tokenizer, "--tokenizer", "a motion tokenizer"))),
      std::move(words)};
}

void run(const Options& o) {
  ml::DataSources sources = o.texts.sources(o.common);
  auto config = named_preset([&] { return ml::tm2t_preset(o.common.preset, o.stage); });
  if (const std::string found = ml::ready_made_features(sources); !found.empty()) config.features = found;
  if (!configure(config, o.common)) return;
  auto before = models_before(o, config);
  if (before)
    config.features =
        before->model.statistics.mean.size(0) == 251 ? "kit" : "guoh3d";  // the features that the tokenizer reads
  const auto data = read_data(sources, config.data, ml::row_maker(config.features));
  if (!before) {
    const auto statistics = ml::tm2t_statistics<B>(data, o.statistics, config.tokenizer.feature_bias);
    return train(ml::Tm2tTokenizerTraining<TrainingTape>(config, data, statistics), o.common, data);
  }
  const bool drawn_words = o.words.empty() && before->model.m2t_transformer.encoder.layer_stack.empty();
  if (drawn_words)
    before->words =
        ml::words_of(data, config.text_to_motion.word_width, ml::Philox{.seed = config.optimiser.seed}.split("words"));
  {
    ProgressBar bar("tokenizing");
    before->tokenize(data, bar);
  }
  std::printf("%s, %s\n", ml::counted(before->words.size(), "word").c_str(),
              ml::counted(before->model.vocabulary().codes, "motion token").c_str());
  if (o.stage == ml::Tm2tStage::motion_to_text)
    train(ml::Tm2tDescriberTraining<TrainingTape>(config, data, *before), o.common, data);
  else if (config.text_to_motion.network == "transformer")
    train(ml::Tm2tTransformerTraining<TrainingTape>(config, data, *before), o.common, data);
  else
    train(ml::Tm2tWriterTraining<TrainingTape>(config, data, *before), o.common, data);
}

}  // namespace

void add_train_tm2t(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand("train-tm2t",
                                   "Trains one stage of TM2T, which captions motions and generates them from texts. "
                                   "Ctrl-C saves; the same command continues");
  const std::map<std::string, ml::Tm2tStage> stages{{"tokenizer", ml::Tm2tStage::tokenizer},
                                                    {"motion-to-text", ml::Tm2tStage::motion_to_text},
                                                    {"text-to-motion", ml::Tm2tStage::text_to_motion}};
  c->add_option("--stage", o->stage, "Stage: tokenizer (motions as tokens), then motion-to-text, then text-to-motion")
      ->required()
      ->transform(CLI::CheckedTransformer(stages).description("tokenizer, motion-to-text or text-to-motion"));
  add_training_options(*c, o->common, {"tm2t-published", "tm2t-published-kit", "tm2t-paper", "small"});
  o->texts.add_to(*c);
  folder_option(*c, "--statistics", o->statistics,
                "Tokenizer stage: folder with Mean.npy and Std.npy of the features. The default is the statistics of "
                "the training motions");
  folder_option(*c, "--tokenizer", o->tokenizer,
                "Other stages: folder of the tokenizer, from the first stage or as published");
  folder_option(*c, "--describer", o->describer,
                "Stage text-to-motion: folder of motion-to-text, or M2T_... as published, for inverse alignment. Its "
                "words are used, and its tokenizer unless --tokenizer names one");
  folder_option(
      *c, "--text-encoder", o->words,
      "Folder of word vectors (our_vab_data.npy). The default is the words of the texts, with random vectors");
  c->callback([o] { run(*o); });
}

}  // namespace program
