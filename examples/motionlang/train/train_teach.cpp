// motionlang train-teach: motions for actions in sequence.
#include <motionlang/train/teach_training.hpp>

#include "train_babel.hpp"

namespace program {

void add_train_teach(CLI::App& app) {
  const auto o = std::make_shared<BabelOptions>();
  CLI::App* c = add_babel_options(
      app, "train-teach",
      "Trains TEACH, which generates motions from actions one after another. Ctrl-C saves; the same command continues",
      *o, {"teach-published", "teach-paper", "small"});
  c->callback([o] {
    run_babel(
        *o, named_preset([&] { return ml::teach_preset(o->common.preset); }), &ml::teach_reader,
        [&](const ml::TeachTrainingConfig& config, const ml::DescribedMotions& data, const ml::TextStates& states) {
          return ml::TeachTraining<TrainingTape>(config, data, states, o->statistics);
        });
  });
}

}  // namespace program
