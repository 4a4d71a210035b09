// motionlang train-mdm-actions: MDM on motions of actions.
#include <motionlang/train/mdm_action_training.hpp>

#include "action_options.hpp"
#include "training_command.hpp"

namespace program {

namespace {

struct Options {
  TrainingOptions common;
  LabelOptions labels;
  std::string dataset;
};

void run(const Options& o) {
  auto config = named_preset([&] { return ml::mdm_action_preset(o.common.preset); });
  choose_clips(config.clips, o.dataset, o.common.data);
  if (!configure(config, o.common)) return;
  as_usage([&] { config.require_consistent(); });
  const auto data = read_data(o.labels.sources(o.common), config.data, ml::actor_row_maker(config.clips));
  train(ml::MdmActionTraining<TrainingTape>(config, data), o.common, data);
}

}  // namespace

void add_train_mdm_actions(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand(
      "train-mdm-actions", "Trains MDM on motions of actions, as published. Ctrl-C saves; the same command continues");
  add_training_options(*c, o->common, {"mdm-actions-published", "small"});
  o->labels.add_to(*c);
  add_dataset_option(*c, o->dataset);
  c->callback([o] { run(*o); });
}

}  // namespace program
