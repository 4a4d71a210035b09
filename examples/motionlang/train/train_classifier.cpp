// motionlang train-classifier: what tells actions apart, and so judges generated motions.
#include "action_task.hpp"
#include "training_command.hpp"

namespace program {

namespace {

struct Options {
  TrainingOptions common;
  LabelOptions labels;
  std::filesystem::path generated;
};

void run(const Options& o) {
  auto config = classifier_preset(o.common.preset);
  if (!configure(config, o.common)) return;
  std::optional<ActorModel<TrainingBackend>> generator;
  if (!o.generated.empty()) generator.emplace(o.generated);
  const auto read = [&](const RowMaker& rows) {
    return read_data(o.common, o.labels.sources(o.common), config.data, rows);
  };
  const auto data = read(actor_row_maker(config.clips));
  Trainer trainer(ClassifierTask(config, data, std::move(generator), read));
  trainer.run(o.common.run, [] {});
  const auto folder = o.common.run.out / "model";
  save_action_model(folder, trainer.task().result(), "classifier", trainer.task().file(), about(o.common, data));
  tell_results(o.common, folder);
}

}  // namespace

void add_train_classifier(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand("train-classifier",
                                   "Trains a classifier of actions, by which evaluate judges ACTOR; Ctrl-C saves");
  add_training_options(*c, o->common, {"small", "stgcn-published", "gru-published"});
  o->labels.add_to(*c);
  c->add_option("--generated", o->generated,
                "Model of train-actor that makes a part of the motions (generated_share): sampled, or of the recorded "
                "ones denoised or interpolated (generated_kind)")
      ->check(CLI::ExistingDirectory);
  c->callback([o] { run(*o); });
}

}  // namespace program
