// motionlang train-teach: motions from actions one after the other.
#include "teach_task.hpp"
#include "train_babel.hpp"

namespace program {

void add_train_teach(CLI::App& app) {
  const auto o = std::make_shared<BabelOptions>();
  CLI::App* c = add_babel_options(
      app, "train-teach",
      "Trains TEACH, which makes motions from actions one after the other; Ctrl-C saves, the same command goes on", *o,
      "teach-published");
  c->callback([o] {
    run_babel<ml::Teach>(*o, teach_preset(o->common.preset), &teach_reader,
                         [&](const TeachTrainingConfig& config, const DescribedMotions& data,
                             const TextStates& states) { return TeachTask(config, data, states, o->statistics); });
  });
}

}  // namespace program
