// motionlang train-tmr: texts and motions in one space.
#include <motionlang/train/tmr_training.hpp>

#include "train_text_motion.hpp"

namespace program {

void add_train_tmr(CLI::App& app) {
  add_text_motion<ml::TmrTraining<TrainingTape>>(
      app, "train-tmr", "Trains TMR, which finds motions by texts. Ctrl-C saves; the same command continues",
      "tmr-published", &ml::tmr_preset);
}

}  // namespace program
