// motionlang train-temos: motions from texts.
#include <motionlang/train/temos_training.hpp>

#include "train_text_motion.hpp"

namespace program {

void add_train_temos(CLI::App& app) {
  add_text_motion<ml::TemosTraining<TrainingTape>>(
      app, "train-temos", "Trains TEMOS, which generates motions from texts. Ctrl-C saves; the same command continues",
      "temos-published", &ml::temos_preset);
}

}  // namespace program
