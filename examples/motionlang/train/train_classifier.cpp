// motionlang train-classifier: a classifier of actions, which judges generated motions.
#include <motionlang/train/classifier_training.hpp>

#include "action_options.hpp"
#include "training_command.hpp"

namespace program {

namespace {

struct Options {
  TrainingOptions common;
  LabelOptions labels;
  std::string dataset;
  std::filesystem::path generated;
};

void run(const Options& o) {
  auto config = named_preset([&] { return ml::classifier_preset(o.common.preset); });
  choose_clips(config.clips, o.dataset, o.common.data);
  if (!configure(config, o.common)) return;
  std::optional<ml::ActorModel<TrainingBackend>> generator;
  if (!o.generated.empty()) generator.emplace(o.generated);
  const auto read = [&](const ml::RowMaker& rows) { return read_data(o.labels.sources(o.common), config.data, rows); };
  const auto data = read(ml::actor_row_maker(config.clips));
  train(ml::ClassifierTraining<TrainingTape>(config, data, std::move(generator), read), o.common, data);
}

}  // namespace

void add_train_classifier(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand(
      "train-classifier",
      "Trains a classifier of actions, which evaluate uses to judge ACTOR. Ctrl-C saves; the same command continues");
  add_training_options(*c, o->common, {"small", "stgcn-published", "gru-published"});
  o->labels.add_to(*c);
  add_dataset_option(*c, o->dataset);
  folder_option(*c, "--generated", o->generated,
                "Model of train-actor that makes a share of the motions (generated_share). generated_kind chooses "
                "sampled motions, or recorded ones that are denoised or interpolated");
  c->callback([o] { run(*o); });
}

}  // namespace program
