// motionlang train-evaluator: the networks of Guo et al. that judge generated motions; one stage at a time.
#include <cstdio>
#include <map>
#include <optional>

#include <motionlang/datasets/described_words.hpp>
#include <motionlang/train/guo_matching_training.hpp>
#include <motionlang/train/guo_movement_training.hpp>

#include "../usage_error.hpp"
#include "training_command.hpp"

namespace program {

namespace {

struct Options {
  TrainingOptions common;
  ml::GuoStage stage = ml::GuoStage::movement;
  CaptionOptions texts;
  std::filesystem::path statistics, movement, words;
};

void run(const Options& o) {
  using B = TrainingBackend;
  ml::DataSources sources = o.texts.sources(o.common);
  auto config = named_preset([&] { return ml::guo_preset(o.common.preset, o.stage); });
  if (const std::string found = ml::ready_made_features(sources); !found.empty()) config.features = found;
  if (!configure(config, o.common)) return;
  const bool matching = o.stage == ml::GuoStage::matching;
  if (matching && o.movement.empty())
    ml::raise<usage_error>(102, "--movement is required: the folder of the movement stage, or latest.tar as published");
  const auto data = read_data(sources, config.data, ml::row_maker(config.features));
  if (!matching) {
    const auto statistics = ml::tm2t_statistics<B>(data, o.statistics, config.movement.feature_bias);
    return train(ml::GuoMovementTraining<TrainingTape>(config, data, statistics), o.common, data);
  }
  const auto autoencoder = ml::load_movement_autoencoder<B>(o.movement);
  auto statistics = ml::guo_statistics_near<B>(ml::movement_autoencoder_path(o.movement), data.width);
  if (!o.statistics.empty()) statistics = ml::tm2t_statistics<B>(data, o.statistics, config.movement.feature_bias);
  if (!statistics)
    ml::raise<usage_error>(102, "--statistics is required: ", o.movement.string(),
                           " has no meta/mean.npy beside its latest.tar");
  const ml::GloVe words = o.words.empty() ? ml::words_of(data, config.matching.word_width,
                                                         ml::Philox{.seed = config.optimiser.seed}.split("words"))
                                          : ml::read_glove(o.words / "our_vab");
  std::printf("%s\n", ml::counted(words.size(), "word").c_str());
  const ml::GuoMatchingParts<B> parts{autoencoder.movement_enc, *std::move(statistics), words};
  train(ml::GuoMatchingTraining<TrainingTape>(config, data, parts), o.common, data);
}

}  // namespace

void add_train_evaluator(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand("train-evaluator",
                                   "Trains the networks of Guo et al., by which evaluate --evaluator judges motions of "
                                   "texts. Ctrl-C saves; the same "
                                   "command continues");
  const std::map<std::string, ml::GuoStage> stages{{"movement", ml::GuoStage::movement},
                                                   {"matching", ml::GuoStage::matching}};
  c->add_option("--stage", o->stage, "Stage: movement (the autoencoder of movements), then matching (the evaluator)")
      ->required()
      ->transform(CLI::CheckedTransformer(stages).description("movement or matching"));
  add_training_options(*c, o->common, {"guo-published", "small"});
  o->texts.add_to(*c);
  c->add_option("--statistics", o->statistics,
                "Folder with Mean.npy and Std.npy of the features. The default is the statistics of the training "
                "motions; for matching those of --movement")
      ->check(CLI::ExistingDirectory);
  c->add_option("--movement", o->movement,
                "Stage matching: folder of the first stage, or latest.tar of Decomp_SP001_SM001_H512 as published")
      ->check(CLI::ExistingPath);
  c->add_option(
       "--text-encoder", o->words,
       "Stage matching: folder of word vectors (our_vab_data.npy). The default is the words of the texts, with "
       "random vectors")
      ->check(CLI::ExistingDirectory);
  c->callback([o] { run(*o); });
}

}  // namespace program
