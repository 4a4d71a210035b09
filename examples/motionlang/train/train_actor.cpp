// motionlang train-actor: motions for actions.
#include <cstdio>

#include <motionlang/train/actor_training.hpp>

#include "action_options.hpp"
#include "training_command.hpp"

namespace program {

namespace {

struct Options {
  TrainingOptions common;
  LabelOptions labels;
  std::string dataset;
  std::filesystem::path from;
  ml::ActorBodyFiles files;
};

void run(const Options& o) {
  auto config = named_preset([&] { return ml::actor_preset(o.common.preset); });
  ml::choose_points(config, o.files);
  choose_clips(config.clips, o.dataset, o.common.data);
  if (!configure(config, o.common)) return;
  config.losses.require_any();
  std::printf("points   %s\n", ml::points_text(config, o.files).c_str());
  const auto data = read_data(o.labels.sources(o.common), config.data, ml::actor_row_maker(config.clips));
  std::optional<ml::ActorModel<TrainingBackend>> from;
  if (!o.from.empty()) from.emplace(o.from);
  train(ml::ActorTraining<TrainingTape>(config, data, std::move(from), o.files), o.common, data);
}

}  // namespace

void add_train_actor(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand(
      "train-actor", "Trains ACTOR, which generates motions from actions. Ctrl-C saves; the same command continues");
  add_training_options(
      *c, o->common, {"actor-published", "actor-published-ntu13", "actor-published-uestc", "actor-variable", "small"});
  o->labels.add_to(*c);
  add_dataset_option(*c, o->dataset);
  folder_option(*c, "--from", o->from,
                "Model to start with, trained here or published, to train on many lengths after those of 60 frames");
  file_option(*c, "--body", o->files.body,
              "File of SMPL, whose points are compared: losses.points = vertices (the default with it, as "
              "published), smpl, a2m, a2mpl, vibe");
  file_option(*c, "--joint-regressor", o->files.regressor,
              "File J_regressor_extra.npy of SPIN or VIBE, for losses.points = a2m, a2mpl, vibe");
  c->callback([o] { run(*o); });
}

}  // namespace program
